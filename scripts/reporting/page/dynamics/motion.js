// The motion of a body at any time, by Taylor series that follow one another. They are kept: to evaluate them
// costs little, and the motion is integrated no farther than it is asked for.
//
//     const motion = new Motion(body, start);
//     const { angle, rate, omega, quaternion } = motion.at(t);

import { cross, ratesOf, times, toSpace } from "./body.js";
import { countUpTo, nearTo } from "./numbers.js";
import { ROWS, Series, loadAt, reachOf, torqueOf, valueAt } from "./series.js";

const STOPPED = 1e-9; // of the rate of the motion: a body with dry friction has stopped
const BRAKING = 0.5; // of the time to a standstill: longest step with dry friction
const REVERSALS = 8; // parts of such a step in which the angular velocity is looked at
const PIECES = 4; // of a step, in which the phases of the angles turn by less than half a turn
const FINEST = 12; // halvings of such a piece, at a passage of a pole
const CLEAR = 0.8; // rad: a phase that turns by less between two instants is known
const AT_POLE = 1e-12; // closer to a pole, as a sine, phi and psi do not exist apart

const norm = (vector) => Math.hypot(...vector);
const dot = ([a, b, c], [x, y, z]) => a * x + b * y + c * z;

export class Motion {
  #series;
  #starts = []; // of steps, s
  #tables = []; // of coefficients
  #nodes = [0]; // instants at which the phases are known
  #phases = []; // (phi + psi)/2 and (phi - psi)/2, with all turns, at them

  /** @param most steps at most; where they end, `end` tells */
  constructor(body, { quaternion, omega, angle: [phi, theta, psi] }, most = Infinity) {
    this.body = body;
    this.most = most;
    this.stop = Infinity; // when it came to rest for good, s
    this.#series = new Series(body);
    /** Whether the body only swings about a horizontal principal axis: theta then goes on beyond the poles. */
    this.isPlane = omega[1] === 0 && omega[2] === 0 && phi === 0 && psi === 0 && body.centre[0] === 0
      && body.products[1] === 0 && body.products[2] === 0;
    this.#phases.push(this.isPlane ? [theta / 2, 0] : [(phi + psi) / 2, (phi - psi) / 2]);
    this.#begin(0, quaternion, times(body.tensor, omega));
  }

  /** How far it is integrated, s: at least to a time, unless that takes too many steps. */
  reach(time) {
    while (this.end < time && this.#starts.length < this.most) this.#advance();
    return this.end;
  }

  /** How many steps there are. */
  get count() {
    return this.#starts.length;
  }

  /** A new step from a state. */
  #begin(time, quaternion, momentum) {
    const { body } = this;
    const omega = times(body.inverse, momentum);
    const rate = Math.max(norm(omega), body.naturalRate);
    this.rate = Math.max(this.rate ?? 0, rate); // the largest so far
    if (body.friction && norm(omega) <= STOPPED * this.rate) return this.#leave(time, quaternion, omega, momentum);
    const table = this.#series.expand(time, quaternion, momentum);
    let length = reachOf(table, body);
    if (body.friction) length = this.#lengthWithFriction(table, omega, length);
    return this.#add(time, table, length);
  }

  /** A step that ends before the angular velocity reverses: the series has the dry moment of one direction. */
  #lengthWithFriction(table, omega, reach) {
    const { inverse } = this.body;
    const braking = -dot(omega, times(inverse, ROWS.momentum.map((row) => table[row + 1])));
    let length = braking > 0 ? Math.min(reach, (BRAKING * dot(omega, omega)) / braking) : reach;
    for (let [k, before] = [1, omega]; k <= REVERSALS; k += 1) {
      const now = times(inverse, ROWS.momentum.map((row) => valueAt(table, row, (length * k) / REVERSALS)));
      if (dot(now, before) > 0) before = now;
      else [length, k, before] = [(length * Math.max(k - 1, 0.5)) / REVERSALS, 0, omega];
    }
    return length;
  }

  #add(time, table, length) {
    this.#starts.push(time);
    this.#tables.push(table);
    this.end = time + length;
    if (Number.isFinite(length)) {
      for (let k = 1; k <= PIECES; k += 1) this.#follow(time + (length * k) / PIECES, FINEST);
    }
  }

  /** With dry friction at a standstill: it stays there, or goes on in the direction in which it can. */
  #leave(time, quaternion, omega, momentum) {
    const { body } = this;
    const braking = dot(omega, accelerationOf(body, time, { quaternion, momentum, omega }));
    const now = time + (braking < 0 ? -dot(omega, omega) / braking : 0);
    const torque = torqueOf(body, now, quaternion, [0, 0, 0]);
    if (norm(torque) <= body.friction) {
      this.stop = now;
      const still = new Series({ ...body, friction: 0, gravity: 0 }).expand(now, quaternion, [0, 0, 0]);
      return this.#add(now, still, Infinity);
    }
    const acceleration = departure(body, torque);
    const wait = (2 * STOPPED * this.rate) / norm(acceleration);
    return this.#begin(now + wait, quaternion, times(body.tensor, acceleration.map((value) => value * wait)));
  }

  #advance() {
    const time = this.end;
    const { quaternion, momentum } = this.#stateAt(this.#starts.length - 1, time);
    const length = norm(quaternion);
    this.#begin(time, quaternion.map((value) => value / length), momentum);
  }

  #stateAt(step, time) {
    const [table, since] = [this.#tables[step], time - this.#starts[step]];
    const value = (row) => valueAt(table, row, since);
    return { quaternion: ROWS.quaternion.map(value), momentum: ROWS.momentum.map(value) };
  }

  /** The phases at a time close to a known instant. */
  #phasesAt({ quaternion: [w, x, y, z] }, [plus, minus]) {
    if (this.isPlane) return [nearTo(Math.atan2(x, w), plus), 0];
    return [
      Math.hypot(w, z) > AT_POLE ? nearTo(Math.atan2(z, w), plus) : plus,
      Math.hypot(x, y) > AT_POLE ? nearTo(Math.atan2(y, x), minus) : minus,
    ];
  }

  /** Note the phases at a time, and between the last note and it where they turn fast. */
  #follow(time, depth) {
    const [before, phases] = [this.#nodes.at(-1), this.#phases.at(-1)];
    const now = this.#phasesAt(this.#stateAt(this.#starts.length - 1, time), phases);
    if (depth > 0 && now.some((phase, k) => Math.abs(phase - phases[k]) > CLEAR)) {
      this.#follow((before + time) / 2, depth - 1);
      this.#follow(time, depth - 1);
      return;
    }
    this.#nodes.push(time);
    this.#phases.push(now);
  }

  /**
   * The motion at a time, s: angles with all turns of phi and psi, their rates (NaN where they do not exist), the
   * angular velocity in body axes; in space axes the axis, the angular velocity, the angular momentum, the torque
   * of gravity, the derivative of the momentum, and the support force; and the energies.
   */
  at(t) {
    this.reach(t);
    const { body } = this;
    const state = this.#stateAt(Math.max(countUpTo(this.#starts, t) - 1, 0), t);
    const { quaternion, momentum } = state;
    const omega = times(body.inverse, momentum);
    const [plus, minus] = this.#phasesAt(state, this.#phases[Math.max(countUpTo(this.#nodes, t) - 1, 0)]);
    const [w, x, y, z] = quaternion;
    const angle = this.isPlane
      ? [0, 2 * plus, 0]
      : [plus + minus, 2 * Math.atan2(Math.hypot(x, y), Math.hypot(w, z)), plus - minus];
    const centre = toSpace(quaternion, body.centre);
    const load = loadAt(body, t);
    return {
      t, angle, quaternion, omega,
      rate: this.isPlane ? [0, omega[0], 0] : ratesOf(angle, omega, AT_POLE),
      axis: toSpace(quaternion, [0, 0, 1]),
      omegaSpace: toSpace(quaternion, omega),
      momentum: toSpace(quaternion, momentum),
      torque: [-body.mass * load * centre[1], body.mass * load * centre[0], 0],
      ...this.#accelerated(t, state, omega),
      kinetic: dot(omega, momentum) / 2,
      potential: body.mass * body.gravity * centre[2],
    };
  }

  /** Mass times acceleration of the centre of mass, minus the weight, N; and the derivative of the momentum. */
  #accelerated(t, { quaternion, momentum }, omega) {
    const { body } = this;
    const change = t >= this.stop ? [0, 0, 0] : accelerationOf(body, t, { quaternion, momentum, omega });
    const swing = cross(omega, cross(omega, body.centre));
    const acceleration = cross(change, body.centre).map((value, k) => value + swing[k]);
    const [x, y, z] = toSpace(quaternion, acceleration);
    const turned = cross(omega, momentum);
    return {
      force: [body.mass * x, body.mass * y, body.mass * (z + loadAt(body, t))],
      change: toSpace(quaternion, times(body.tensor, change).map((value, k) => value + turned[k])),
    };
  }
}

/** The derivative of the angular velocity in body axes, rad/s^2. */
function accelerationOf(body, time, { quaternion, momentum, omega }) {
  const torque = torqueOf(body, time, quaternion, momentum, omega);
  const speed = body.friction && norm(omega);
  return times(body.inverse, speed > 0 ? torque.map((value, k) => value - (body.friction * omega[k]) / speed) : torque);
}

/**
 * The angular acceleration with which a body departs against dry friction, under a larger torque T: k e with
 * (k I + M) e = T and |e| = 1, whose k is the zero of a function that falls.
 */
function departure({ tensor, friction, inertia }, torque) {
  const excess = norm(torque) - friction;
  let [low, high] = [0, norm(torque) / Math.min(...inertia) * 4];
  let direction = torque;
  for (let n = 0; n < 200 && high - low > 1e-15 * high && excess > 0; n += 1) {
    const k = (low + high) / 2;
    direction = solve(tensor.map((row, i) => row.map((value, j) => k * value + (i === j ? friction : 0))), torque);
    if (norm(direction) > 1) low = k;
    else high = k;
  }
  return direction.map((value) => (value * (low + high)) / 2);
}

/** A symmetric system of three equations, by minors. */
function solve([a, b, c], right) {
  const [p, q, r] = [cross(b, c), cross(c, a), cross(a, b)];
  const determinant = dot(a, p);
  return [0, 1, 2].map((k) => (p[k] * right[0] + q[k] * right[1] + r[k] * right[2]) / determinant);
}
