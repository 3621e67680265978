// A trajectory: its rows as they stand in the table, and the motion between them.

import { Quaternion, Vector3 } from "three";
import { fromAngles, nearTo, toAngles, turnAbout, twistOf, withinHalfTurn } from "./attitude.js";

const ANGLES = ["phi", "theta", "psi"];
const FINEST = 0.05; // rad: how far the axis turns between two points of its trace
const MOST_POINTS = 20000;

/** Numbers of a kind, from the base64 of their bytes. */
function unpack(text, Kind) {
  return new Kind(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
}

const plainDisc = {
  inertia: [1, 1, 1],
  centre: [0, 0, 1],
  axis: [0, 0, 1],
  solid: { kind: "cylinder", radius: 0.5, height: 0.05, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1] },
};

/** The row of a table of vectors as a vector. */
function vectorAt(table, row) {
  return new Vector3().fromArray(table, 3 * row);
}

export class Motion {
  #trace;

  /** @param data what `motion_data` of the Python side gives. */
  constructor(data) {
    const { exact, drawn } = data;
    this.title = data.title;
    this.notes = data.notes;
    this.total = data.total;
    this.stride = data.stride;
    this.t = unpack(exact.t, Float64Array);
    this.count = this.t.length;
    this.body = data.body ?? plainDisc;
    this.axis = new Vector3(...this.body.axis);
    this.hasBody = "body" in data;
    this.attitudes = this.#findAttitudes(exact);
    this.countsTurns = "phi" in exact; // else phi and psi are within half a turn
    this.angles = this.countsTurns
      ? ANGLES.map((name) => unpack(exact[name], Float64Array))
      : this.#findAngles();
    this.force = drawn.force ? unpack(drawn.force, Float32Array) : null;
    const omega = drawn.omega ? unpack(drawn.omega, Float32Array) : null;
    this.momentum = omega && this.hasBody ? this.#findMomentum(omega) : null;
    this.spins = this.#findSpins(omega);
  }

  #findAttitudes({ q0, q1, q2, q3, ...angles }) {
    if (q0) {
      const [w, x, y, z] = [q0, q1, q2, q3].map((text) => unpack(text, Float64Array));
      return Array.from(w, (_, i) => new Quaternion(x[i], y[i], z[i], w[i]).normalize());
    }
    const [phi, theta, psi] = ANGLES.map((name) => unpack(angles[name], Float64Array));
    return Array.from(phi, (_, i) => fromAngles(phi[i], theta[i], psi[i]));
  }

  #findAngles() {
    const rows = this.attitudes.map(toAngles);
    return ANGLES.map((_, k) => Float64Array.from(rows, (row) => row[k]));
  }

  /** Angular momentum about the pivot in space axes. */
  #findMomentum(omega) {
    const inertia = new Vector3(...this.body.inertia);
    const table = new Float64Array(3 * this.count);
    this.attitudes.forEach((attitude, i) => {
      vectorAt(omega, i).multiply(inertia).applyQuaternion(attitude).toArray(table, 3 * i);
    });
    return table;
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
      force: this.#vectorBetween(this.force, i, part),
      momentum: this.#vectorBetween(this.momentum, i, part),
    };
  }

  atRow(i) {
    return {
      time: this.t[i],
      row: i,
      attitude: this.attitudes[i].clone(),
      angles: this.angles.map((column) => column[i]),
      force: this.force && vectorAt(this.force, i),
      momentum: this.momentum && vectorAt(this.momentum, i),
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
    const between = this.angles.map((column) => column[i] + part * (column[i + 1] - column[i]));
    const [phi, theta, psi] = toAngles(attitude);
    const upright = Math.sin(theta) < 1e-9;
    return upright
      ? [between[0], theta, between[2]]
      : [nearTo(phi, between[0]), theta, nearTo(psi, between[2])];
  }

  #vectorBetween(table, i, part) {
    return table && vectorAt(table, i).lerp(vectorAt(table, i + 1), part);
  }

  /** The axis of an attitude in space, a unit vector. */
  axisOf(attitude) {
    return this.axis.clone().applyQuaternion(attitude);
  }

  /** The largest size of a table of vectors. */
  largest(table) {
    let square = 0;
    for (let i = 0; i < table.length; i += 3) {
      square = Math.max(square, table[i] ** 2 + table[i + 1] ** 2 + table[i + 2] ** 2);
    }
    return Math.sqrt(square);
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
