// The Taylor series in time of the motion of a rigid body about its pivot.
//
// With the angular momentum L and the upward vertical G in body axes, w = I^-1 L, and the weight per mass g + a
// in the frame of a vibrating pivot,
//
//     L' = L x w + m (g + a) G x r - d w - M w/|w|        G' = G x w        q' = q (0, w)/2
//
// Every coefficient follows from those before it by products of series.

import { times, verticalOf } from "./body.js";

const ORDER = 24;
const COUNT = ORDER + 1;
const ERROR = 1e-17; // of a step, relative

/** Where the series of q0..q3, L1..L3 begin in a table of coefficients. */
export const ROWS = { quaternion: [0, 1, 2, 3].map((k) => k * COUNT), momentum: [4, 5, 6].map((k) => k * COUNT) };
const SIZE = 7 * COUNT;

/** The value of a series at a time from its centre. */
export function valueAt(table, row, time) {
  let value = table[row + ORDER];
  for (let n = ORDER - 1; n >= 0; n -= 1) value = value * time + table[row + n];
  return value;
}

const newRows = (count) => Array.from({ length: count }, () => new Float64Array(COUNT));

export class Series {
  constructor(body) {
    this.body = body;
    this.arm = body.centre.map((value) => body.mass * value);
    [this.omega, this.vertical, this.direction] = [newRows(3), newRows(3), newRows(3)];
    [this.load] = newRows(1);
    [this.speedSquared, this.speed] = newRows(2);
  }

  /**
   * The coefficients of quaternion and momentum about an instant, side by side (see `ROWS`).
   *
   * @param time for the phase of the vibration, s
   */
  expand(time, quaternion, momentum) {
    const { body, arm, omega: [u, v, w], vertical: [x, y, z], load } = this;
    const table = new Float64Array(SIZE);
    const [a, b, c, d, l, m, n] = Array.from({ length: 7 }, (_, k) => table.subarray(k * COUNT, (k + 1) * COUNT));
    [a[0], b[0], c[0], d[0]] = quaternion;
    [l[0], m[0], n[0]] = momentum;
    [x[0], y[0], z[0]] = verticalOf(quaternion);
    this.#expandLoad(time);
    const [r, s, t] = arm;
    const [[i11, i12, i13], [, i22, i23], [, , i33]] = body.inverse;
    const [damping1, damping2, damping3] = body.damping;
    for (let i = 0; i < ORDER; i += 1) {
      u[i] = i11 * l[i] + i12 * m[i] + i13 * n[i];
      v[i] = i12 * l[i] + i22 * m[i] + i23 * n[i];
      w[i] = i13 * l[i] + i23 * m[i] + i33 * n[i];
      let l1 = 0, m1 = 0, n1 = 0, x1 = 0, y1 = 0, z1 = 0, a1 = 0, b1 = 0, c1 = 0, d1 = 0;
      for (let k = 0; k <= i; k += 1) {
        const uk = u[i - k], vk = v[i - k], wk = w[i - k];
        l1 += m[k] * wk - n[k] * vk;
        m1 += n[k] * uk - l[k] * wk;
        n1 += l[k] * vk - m[k] * uk;
        x1 += y[k] * wk - z[k] * vk;
        y1 += z[k] * uk - x[k] * wk;
        z1 += x[k] * vk - y[k] * uk;
        a1 -= b[k] * uk + c[k] * vk + d[k] * wk;
        b1 += a[k] * uk + c[k] * wk - d[k] * vk;
        c1 += a[k] * vk + d[k] * uk - b[k] * wk;
        d1 += a[k] * wk + b[k] * vk - c[k] * uk;
      }
      let gx = load[0] * x[i], gy = load[0] * y[i], gz = load[0] * z[i];
      for (let k = 1; body.isVibrated && k <= i; k += 1) {
        gx += load[k] * x[i - k];
        gy += load[k] * y[i - k];
        gz += load[k] * z[i - k];
      }
      const e = 1 / (i + 1);
      l[i + 1] = e * (l1 + gy * t - gz * s - damping1 * u[i]);
      m[i + 1] = e * (m1 + gz * r - gx * t - damping2 * v[i]);
      n[i + 1] = e * (n1 + gx * s - gy * r - damping3 * w[i]);
      if (body.friction) this.#addFriction(i, l, m, n);
      x[i + 1] = e * x1;
      y[i + 1] = e * y1;
      z[i + 1] = e * z1;
      a[i + 1] = 0.5 * e * a1;
      b[i + 1] = 0.5 * e * b1;
      c[i + 1] = 0.5 * e * c1;
      d[i + 1] = 0.5 * e * d1;
    }
    return table;
  }

  /** Gravity, and the acceleration of the pivot. */
  #expandLoad(time) {
    const { load, body: { gravity, amplitude, vibrationRate: rate, isVibrated } } = this;
    load[0] = gravity;
    if (!isVibrated) return;
    const [c, s] = [Math.cos(rate * time), Math.sin(rate * time)];
    const turns = [c, -s, -c, s];
    let factor = -amplitude * rate ** 2;
    for (let k = 0; k < COUNT; k += 1) {
      load[k] = factor * turns[k % 4] + (k ? 0 : gravity);
      factor *= rate / (k + 1);
    }
  }

  /** The dry moment, opposite to the angular velocity: by the series of |w|^2, |w| and w/|w|. */
  #addFriction(i, ...momentum) {
    const { omega, direction, speedSquared: p, speed: s, body: { friction } } = this;
    p[i] = 0;
    for (const w of omega) for (let k = 0; k <= i; k += 1) p[i] += w[k] * w[i - k];
    s[i] = i ? p[i] : Math.sqrt(p[0]);
    for (let k = 1; k < i; k += 1) s[i] -= s[k] * s[i - k];
    if (i) s[i] /= 2 * s[0];
    direction.forEach((e, j) => {
      e[i] = omega[j][i];
      for (let k = 1; k <= i; k += 1) e[i] -= s[k] * e[i - k];
      e[i] /= s[0];
      momentum[j][i + 1] -= (friction * e[i]) / (i + 1);
    });
  }
}

/** How far a series reaches, s: its last two terms are below a rounding error there. */
export function reachOf(table, body) {
  const [l, m, n] = ROWS.momentum.map((row) => table[row]);
  const size = Math.hypot(l, m, n) + Math.max(...body.inertia) * body.naturalRate;
  let reach = Infinity;
  for (const order of [ORDER - 1, ORDER]) {
    let largest = 0;
    for (const row of ROWS.quaternion) largest = Math.max(largest, Math.abs(table[row + order]));
    for (const row of ROWS.momentum) largest = Math.max(largest, Math.abs(table[row + order]) / size);
    if (largest > 0) reach = Math.min(reach, (ERROR / largest) ** (1 / order));
  }
  return reach;
}

/** The derivative of the momentum, kg m^2/s^2, but for friction. */
export function torqueOf(body, time, quaternion, momentum, omega = times(body.inverse, momentum)) {
  const load = loadAt(body, time);
  const [x, y, z] = verticalOf(quaternion);
  const [r, s, t] = body.centre.map((value) => body.mass * load * value);
  const [l, m, n] = momentum;
  const [u, v, w] = omega;
  const [d1, d2, d3] = body.damping;
  return [
    m * w - n * v + y * t - z * s - d1 * u,
    n * u - l * w + z * r - x * t - d2 * v,
    l * v - m * u + x * s - y * r - d3 * w,
  ];
}

/** Gravity and the acceleration of the pivot, m/s^2. */
export function loadAt({ gravity, amplitude, vibrationRate, isVibrated }, time) {
  return isVibrated ? gravity - amplitude * vibrationRate ** 2 * Math.cos(vibrationRate * time) : gravity;
}
