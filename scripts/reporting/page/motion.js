// A trajectory: its rows as they stand in the table, and the motion between them.

import { Quaternion, Vector3 } from "three";
import { fromAngles, nearTo, toAngles, turnAbout, twistOf, withinHalfTurn } from "./attitude.js";

const ANGLES = ["phi", "theta", "psi"];
const FINEST = 0.05; // rad: how far the axis turns between two points of its trace
const MOST_POINTS = 20000;
const QUATERNION = ["q0", "q1", "q2", "q3"];
const OMEGA = ["omega1", "omega2", "omega3"];
const FORCE = ["force_x", "force_y", "force_z"];
const RATES = ["phi_rate", "theta_rate", "psi_rate"];
const ENERGIES = ["kinetic", "potential", "energy"];
const UPRIGHT = 1e-9; // of sin(theta): below it phi and psi do not exist apart

/** The columns that a motion is made of, where a table has them. */
export const COLUMNS = ["t", ...ANGLES, ...QUATERNION, ...RATES, ...OMEGA, ...FORCE, ...ENERGIES];

const plainDisc = {
  inertia: [1, 1, 1],
  products: [0, 0, 0],
  centre: [0, 0, 1],
  axis: [0, 0, 1],
  solids: [
    { kind: "cylinder", radius: 0.5, height: 0.05, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1], place: [0, 0, 1] },
  ],
};

/** Vectors x, y, z side by side, of columns. */
function sideBySide(columns) {
  return Float64Array.from({ length: 3 * columns[0].length }, (_, i) => columns[i % 3][Math.floor(i / 3)]);
}

/** The row of a table of vectors as a vector. */
function vectorAt(table, row) {
  return new Vector3().fromArray(table, 3 * row);
}

export class Motion {
  #trace;

  /**
   * @param facts what `motion_facts` of the Python side gives
   * @param columns numbers of the rows by the names of their columns, of `COLUMNS`
   */
  constructor(facts, columns) {
    this.title = facts.title;
    this.notes = facts.notes;
    this.total = facts.total;
    this.stride = facts.stride;
    this.extremes = facts.extremes;
    this.isExact = facts.exact;
    this.t = columns.t;
    this.count = this.t.length;
    this.body = facts.body ?? plainDisc;
    this.axis = new Vector3(...this.body.axis);
    this.hasBody = Boolean(facts.body);
    this.attitudes = this.#findAttitudes(columns);
    this.countsTurns = "phi" in columns; // else phi and psi are within half a turn
    this.angles = this.countsTurns ? ANGLES.map((name) => columns[name]) : this.#findAngles();
    this.rates = "phi_rate" in columns ? RATES.map((name) => columns[name]) : null;
    this.omega = "omega1" in columns ? sideBySide(OMEGA.map((name) => columns[name])) : this.#findOmega();
    this.rates ??= this.#findRates();
    this.force = "force_x" in columns ? sideBySide(FORCE.map((name) => columns[name])) : null;
    this.momentum = this.omega && this.hasBody ? this.#findMomentum(this.omega) : null;
    this.turning = this.omega && this.#inSpace(this.omega);
    this.energies = "energy" in columns ? ENERGIES.map((name) => columns[name]) : null;
    this.spins = this.#findSpins(this.omega);
  }

  #findAttitudes({ q0, q1, q2, q3, phi, theta, psi }) {
    if (q0) return Array.from(q0, (w, i) => new Quaternion(q1[i], q2[i], q3[i], w).normalize());
    return Array.from(phi, (_, i) => fromAngles(phi[i], theta[i], psi[i]));
  }

  #findAngles() {
    const rows = this.attitudes.map(toAngles);
    return ANGLES.map((_, k) => Float64Array.from(rows, (row) => row[k]));
  }

  /** Angular velocity in body axes, from the rates of the angles. */
  #findOmega() {
    if (!this.rates || !this.countsTurns) return null;
    const [, theta, psi] = this.angles;
    const [phiRate, thetaRate, psiRate] = this.rates;
    const table = new Float64Array(3 * this.count);
    for (let i = 0; i < this.count; i += 1) {
      const across = phiRate[i] * Math.sin(theta[i]);
      table[3 * i] = across * Math.sin(psi[i]) + thetaRate[i] * Math.cos(psi[i]);
      table[3 * i + 1] = across * Math.cos(psi[i]) - thetaRate[i] * Math.sin(psi[i]);
      table[3 * i + 2] = phiRate[i] * Math.cos(theta[i]) + psiRate[i];
    }
    return table;
  }

  /** Rates of the angles from the angular velocity; nan where phi and psi do not exist apart. */
  #findRates() {
    if (!this.omega) return null;
    const [, theta, psi] = this.angles;
    const rates = RATES.map(() => new Float64Array(this.count).fill(NaN));
    for (let i = 0; i < this.count; i += 1) {
      const [x, y, z] = this.omega.subarray(3 * i, 3 * i + 3);
      const [s, c] = [Math.sin(psi[i]), Math.cos(psi[i])];
      rates[1][i] = x * c - y * s;
      if (Math.sin(theta[i]) < UPRIGHT) continue;
      rates[0][i] = (x * s + y * c) / Math.sin(theta[i]);
      rates[2][i] = z - rates[0][i] * Math.cos(theta[i]);
    }
    return rates;
  }

  /** Vectors in space axes, of vectors in body axes. */
  #inSpace(vectors) {
    const table = new Float64Array(3 * this.count);
    this.attitudes.forEach((attitude, i) => {
      vectorAt(vectors, i).applyQuaternion(attitude).toArray(table, 3 * i);
    });
    return table;
  }

  /** Angular momentum about the pivot in space axes. */
  #findMomentum(omega) {
    const { inertia, products } = this.body;
    const part = (rate, i) => {
      const [first, k] = [i - (i % 3), i % 3];
      const [next, last] = [(k + 1) % 3, (k + 2) % 3];
      return inertia[k] * rate + products[last] * omega[first + next] + products[next] * omega[first + last];
    };
    return this.#inSpace(omega.map(part));
  }

  /**
   * How far the body turns about its axis from each row to the next, whole turns included: a wheel
   * may turn several times from row to row. The attitudes give it but for whole turns; those are
   * taken from the angular velocity, else from the angles.
   */
  #findSpins(omega) {
    const [phi, theta, psi] = this.angles;
    return Array.from({ length: this.count - 1 }, (_, i) => {
      const turn = twistOf(this.attitudes[i].clone().conjugate().multiply(this.attitudes[i + 1]), this.axis);
      const dt = this.t[i + 1] - this.t[i];
      if (omega) {
        const sum = vectorAt(omega, i).add(vectorAt(omega, i + 1));
        return nearTo(turn, (dt / 2) * sum.dot(this.axis));
      }
      if (!this.countsTurns || this.axis.z !== 1) return withinHalfTurn(turn);
      const height = (Math.cos(theta[i]) + Math.cos(theta[i + 1])) / 2;
      return nearTo(turn, psi[i + 1] - psi[i] + height * (phi[i + 1] - phi[i]));
    });
  }

  get start() {
    return this.t[0];
  }

  get end() {
    return this.t[this.count - 1];
  }

  /** The last row that is not later than a time. */
  rowBefore(time) {
    let [low, high] = [0, this.count - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.t[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** The row that is nearest to a time. */
  rowNear(time) {
    const row = this.rowBefore(time);
    const next = Math.min(row + 1, this.count - 1);
    return this.t[next] - time < time - this.t[row] ? next : row;
  }

  /**
   * The motion at a time: attitude, angles, and the vectors there are, in space axes. At the time of
   * a row it is the row, and `row` its number from 0; between rows `row` is null, and the body turns
   * about its axis at a constant rate while the axis goes along a great circle.
   */
  at(time) {
    const i = this.rowBefore(time);
    if (this.t[i] === time || i === this.count - 1) return this.atRow(i);
    const part = (time - this.t[i]) / (this.t[i + 1] - this.t[i]);
    const attitude = this.#attitudeBetween(i, part);
    return {
      time,
      row: null,
      attitude,
      angles: this.#anglesBetween(i, part, attitude),
      rates: this.#columnsBetween(this.rates, i, part),
      energies: this.#columnsBetween(this.energies, i, part),
      omega: this.#vectorBetween(this.omega, i, part),
      vectors: {
        force: this.#vectorBetween(this.force, i, part),
        momentum: this.#vectorBetween(this.momentum, i, part),
        omega: this.#vectorBetween(this.turning, i, part),
      },
    };
  }

  atRow(i) {
    return {
      time: this.t[i],
      row: i,
      attitude: this.attitudes[i].clone(),
      angles: this.angles.map((column) => column[i]),
      rates: this.rates && this.rates.map((column) => column[i]),
      energies: this.energies && this.energies.map((column) => column[i]),
      omega: this.omega && vectorAt(this.omega, i),
      vectors: {
        force: this.force && vectorAt(this.force, i),
        momentum: this.momentum && vectorAt(this.momentum, i),
        omega: this.turning && vectorAt(this.turning, i),
      },
    };
  }

  /** Without its spin the body turns little from row to row: that is what slerp is for. */
  #attitudeBetween(i, part) {
    const spin = this.spins[i];
    const unspun = this.attitudes[i + 1].clone().multiply(turnAbout(this.axis, -spin));
    const attitude = this.attitudes[i].clone().slerp(unspun, part);
    return attitude.multiply(turnAbout(this.axis, part * spin));
  }

  /** Angles that count their turns as the rows on both sides do. */
  #anglesBetween(i, part, attitude) {
    const between = this.#columnsBetween(this.angles, i, part);
    const [phi, theta, psi] = toAngles(attitude);
    const upright = Math.sin(theta) < UPRIGHT;
    return upright
      ? [between[0], theta, between[2]]
      : [nearTo(phi, between[0]), theta, nearTo(psi, between[2])];
  }

  #columnsBetween(columns, i, part) {
    return columns && columns.map((column) => column[i] + part * (column[i + 1] - column[i]));
  }

  #vectorBetween(table, i, part) {
    return table && vectorAt(table, i).lerp(vectorAt(table, i + 1), part);
  }

  /** The axis of an attitude in space, a unit vector. */
  axisOf(attitude) {
    return this.axis.clone().applyQuaternion(attitude);
  }

  /** The way of the axis: times and unit vectors (x, y, z side by side), finer than the rows. */
  trace() {
    this.#trace ??= this.#findTrace();
    return this.#trace;
  }

  #findTrace() {
    const times = [];
    const points = [];
    const room = Math.max(1, Math.floor(MOST_POINTS / this.count));
    for (let i = 0; i < this.count; i += 1) {
      const here = this.axisOf(this.attitudes[i]);
      const next = i + 1 < this.count ? this.axisOf(this.attitudes[i + 1]) : here;
      const pieces = Math.min(room, Math.max(1, Math.ceil(here.angleTo(next) / FINEST)));
      for (let k = 0; k < (i + 1 < this.count ? pieces : 1); k += 1) {
        const part = k / pieces;
        times.push(k ? this.t[i] + part * (this.t[i + 1] - this.t[i]) : this.t[i]);
        points.push(...(k ? this.axisOf(this.#attitudeBetween(i, part)) : here));
      }
    }
    return { times, points };
  }
}
