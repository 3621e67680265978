// A trajectory: its rows as they stand in the table, and the motion between them.

import { Quaternion, Vector3 } from "three";
import { fromAngles, toAngles, turnAbout, twistOf } from "./attitude.js";
import { omegaOf, ratesOf, symmetric, times } from "./dynamics/body.js";
import { countUpTo, nearTo } from "./dynamics/numbers.js";

const ANGLES = ["phi", "theta", "psi"];
const FINEST = 0.05; // rad: how far the axis turns between two points of its trace
const MOST_POINTS = 20000;
const OMEGA = ["omega1", "omega2", "omega3"];
const FORCE = ["force_x", "force_y", "force_z"];
const RATES = ["phi_rate", "theta_rate", "psi_rate"];
const ENERGIES = ["kinetic", "potential", "energy"];
const UPRIGHT = 1e-9; // of sin(theta): below it phi and psi do not exist apart

const plainDisc = {
  inertia: [1, 1, 1], products: [0, 0, 0], centre: [0, 0, 1], axis: [0, 0, 1],
  solids: [{ kind: "cylinder", radius: 0.5, height: 0.05, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1], place: [0, 0, 1] }],
};

/** The columns of these names side by side, three to a row; null where there are none. */
function sideBySide(columns, names) {
  if (!(names[0] in columns)) return null;
  return Float64Array.from({ length: 3 * columns[names[0]].length }, (_, i) => columns[names[i % 3]][Math.floor(i / 3)]);
}

/** The row of a table of vectors as a vector. */
function vectorAt(table, row) {
  return new Vector3().fromArray(table, 3 * row);
}

/** Tables of a motion have three numbers to a row, side by side; null stands for what is not known. */
export class Motion {
  #trace;

  /**
   * @param facts what `motion_facts` of the Python side gives
   * @param columns numbers of the rows by the names of their columns
   */
  constructor(facts, columns) {
    Object.assign(this, facts); // title, notes, total, stride, extremes
    this.isExact = facts.exact;
    this.t = columns.t;
    this.count = this.t.length;
    this.body = facts.body ?? plainDisc;
    this.axis = new Vector3(...this.body.axis);
    this.attitudes = this.#findAttitudes(columns);
    this.countsTurns = "phi" in columns; // else phi and psi are within half a turn
    this.angles = sideBySide(columns, ANGLES) ?? Float64Array.from(this.attitudes.flatMap(toAngles));
    this.rates = sideBySide(columns, RATES);
    this.omega = sideBySide(columns, OMEGA)
      ?? (this.rates && this.countsTurns ? this.#rowByRow(omegaOf, this.angles, this.rates) : null);
    this.rates ??= this.omega && this.#rowByRow((angles, omega) => ratesOf(angles, omega, UPRIGHT), this.angles, this.omega);
    this.energies = sideBySide(columns, ENERGIES);
    this.spins = this.#findSpins();
    const tensor = facts.body && symmetric(facts.body.inertia, facts.body.products);
    /** In space axes: support force, angular momentum about the pivot, angular velocity. */
    this.vectors = {
      force: sideBySide(columns, FORCE),
      momentum: this.omega && tensor ? this.#inSpace(this.#rowByRow((omega) => times(tensor, omega), this.omega)) : null,
      omega: this.omega && this.#inSpace(this.omega),
    };
  }

  /** A column of a table. */
  column(table, k) {
    return this[table].filter((_, i) => i % 3 === k);
  }

  #findAttitudes({ q0, q1, q2, q3, phi, theta, psi }) {
    if (q0) return Array.from(q0, (w, i) => new Quaternion(q1[i], q2[i], q3[i], w).normalize());
    return Array.from(phi, (_, i) => fromAngles(phi[i], theta[i], psi[i]));
  }

  /** A table of three numbers to a row, by a function of the rows of others. */
  #rowByRow(of, ...tables) {
    const table = new Float64Array(3 * this.count);
    for (let i = 0; i < table.length; i += 3) table.set(of(...tables.map((one) => one.subarray(i, i + 3)), i / 3), i);
    return table;
  }

  /** Vectors in space axes, of vectors in body axes. */
  #inSpace(vectors) {
    return this.#rowByRow((_, row) => vectorAt(vectors, row).applyQuaternion(this.attitudes[row]).toArray(), vectors);
  }

  /**
   * How far the body turns about its axis from each row to the next, whole turns included: a wheel
   * may turn several times from row to row. The attitudes give it but for whole turns; those are
   * taken from the angular velocity, else from the angles.
   */
  #findSpins() {
    const { omega, angles } = this;
    return Array.from({ length: this.count - 1 }, (_, i) => {
      const turn = twistOf(this.attitudes[i].clone().conjugate().multiply(this.attitudes[i + 1]), this.axis);
      const dt = this.t[i + 1] - this.t[i];
      if (omega) {
        const sum = vectorAt(omega, i).add(vectorAt(omega, i + 1));
        return nearTo(turn, (dt / 2) * sum.dot(this.axis));
      }
      if (!this.countsTurns || this.axis.z !== 1) return nearTo(turn, 0);
      const [phi, theta, psi, nextPhi, nextTheta, nextPsi] = angles.subarray(3 * i, 3 * i + 6);
      const height = (Math.cos(theta) + Math.cos(nextTheta)) / 2;
      return nearTo(turn, nextPsi - psi + height * (nextPhi - phi));
    });
  }

  get start() {
    return this.t[0];
  }

  get end() {
    return this.t[this.count - 1];
  }

  /** The last row that is not later than a time, or the first. */
  rowBefore(time) {
    return Math.max(countUpTo(this.t, time) - 1, 0);
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
    return this.#moment(time, i, (time - this.t[i]) / (this.t[i + 1] - this.t[i]));
  }

  atRow(i) {
    return this.#moment(this.t[i], i, 0);
  }

  /** The moment a part of the way from a row to the next. */
  #moment(time, i, part) {
    const isRow = part === 0;
    const attitude = isRow ? this.attitudes[i].clone() : this.#attitudeBetween(i, part);
    const numbers = (table) => table && [...table.subarray(3 * i, 3 * i + 3)].map((value, k) => (
      isRow ? value : value + part * (table[3 * i + 3 + k] - value)
    ));
    const angles = numbers(this.angles);
    return {
      time,
      row: isRow ? i : null,
      attitude,
      angles: isRow ? angles : this.#anglesNear(angles, attitude),
      rates: numbers(this.rates),
      energies: numbers(this.energies),
      omega: numbers(this.omega),
      vectors: Object.fromEntries(Object.entries(this.vectors).map(([name, table]) => [name, numbers(table)])),
    };
  }

  /** Without its spin the body turns little from row to row: that is what slerp is for. */
  #attitudeBetween(i, part) {
    const spin = this.spins[i];
    const unspun = this.attitudes[i + 1].clone().multiply(turnAbout(this.axis, -spin));
    const attitude = this.attitudes[i].clone().slerp(unspun, part);
    return attitude.multiply(turnAbout(this.axis, part * spin));
  }

  /** The angles of an attitude, which count their turns as those between the rows do. */
  #anglesNear([phi, theta, psi], attitude) {
    const found = toAngles(attitude);
    const isUpright = Math.sin(found[1]) < UPRIGHT;
    return isUpright ? [phi, found[1], psi] : [nearTo(found[0], phi), found[1], nearTo(found[2], psi)];
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
