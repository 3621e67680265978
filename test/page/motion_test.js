// The motion between rows against motions that are known.

import { fromAngles, toAngles } from "../../scripts/reporting/page/attitude.js";
import { Motion } from "../../scripts/reporting/page/motion.js";
import { equal, near, test } from "./check.js";

const BODY = {
  mass: 2,
  inertia: [3, 3, 0.5],
  centre: [0, 0, 1],
  axis: [0, 0, 1],
  solid: { kind: "cylinder", radius: 0.5, height: 0.1, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1] },
};

function pack(numbers, Kind) {
  const bytes = new Uint8Array(Kind.from(numbers).buffer);
  return btoa(String.fromCharCode(...bytes));
}

/** A motion with these angles at times 0, dt, 2 dt, ...; `form` says what of it the table has. */
function makeMotion(angles, dt, { count = 5, form = "angles", omega = null } = {}) {
  const t = Array.from({ length: count }, (_, i) => i * dt);
  const rows = t.map(angles);
  const exact = { t: pack(t, Float64Array) };
  if (form === "angles") {
    ["phi", "theta", "psi"].forEach((name, k) => {
      exact[name] = pack(rows.map((row) => row[k]), Float64Array);
    });
  } else {
    const attitudes = rows.map((row) => fromAngles(...row));
    for (const [name, part] of [["q0", "w"], ["q1", "x"], ["q2", "y"], ["q3", "z"]]) {
      exact[name] = pack(attitudes.map((attitude) => attitude[part]), Float64Array);
    }
  }
  const drawn = omega ? { omega: pack(t.flatMap(omega), Float32Array) } : {};
  return new Motion({ title: "", total: count, stride: 1, exact, drawn, notes: [], body: BODY });
}

const RATE = 0.4;
const SPIN = 97;
const steady = (t) => [RATE * t, 0.8, SPIN * t];
const steadyOmega = (t) => {
  const [, theta, psi] = steady(t);
  const across = RATE * Math.sin(theta);
  return [across * Math.sin(psi), across * Math.cos(psi), RATE * Math.cos(theta) + SPIN];
};

test("at a row it is the row", () => {
  const motion = makeMotion(steady, 0.1);
  for (let i = 0; i < motion.count; i += 1) {
    const state = motion.at(motion.t[i]);
    equal(state.row, i, "row");
    equal(state.angles, steady(motion.t[i]), "angles");
  }
});

test("between rows a fast top keeps its turns, whatever the table has", () => {
  const dt = 0.25; // nearly four turns of the spin
  const forms = [{}, { omega: steadyOmega }, { form: "quaternion", omega: steadyOmega }];
  for (const form of forms) {
    const motion = makeMotion(steady, dt, form);
    for (const time of [0.3 * dt, 1.5 * dt, 3.9 * dt]) {
      const { row, attitude } = motion.at(time);
      equal(row, null, "row");
      near(Math.abs(attitude.dot(fromAngles(...steady(time)))), 1, 2e-5, `attitude of ${JSON.stringify(Object.keys(form))}`);
    }
  }
  const { angles } = makeMotion(steady, dt).at(1.5 * dt);
  steady(1.5 * dt).forEach((angle, k) => near(angles[k], angle, 0.01));
});

test("a fall through the upright is a fall", () => {
  const fall = (t) => (t < 1 ? [0, 1 - t, 0] : [Math.PI, t - 1, -Math.PI]);
  const motion = makeMotion(fall, 0.4);
  for (const time of [0.9, 1.1]) {
    const [, theta] = motion.at(time).angles;
    near(theta, 0.1, 1e-6, "theta");
  }
});

test("the momentum of a steady precession has its own height", () => {
  const motion = makeMotion(steady, 0.05, { omega: steadyOmega });
  const [a, b] = [0.5, 0.8].map((part) => motion.at(part * 0.05).momentum);
  const across = 3 * RATE * Math.sin(0.8);
  const expected = 0.5 * (RATE * Math.cos(0.8) + SPIN) * Math.cos(0.8) + across * Math.sin(0.8);
  near(a.z, expected, 1e-3);
  near(b.z, expected, 1e-3);
});

test("the trace goes through the rows, and is as long as the motion", () => {
  const motion = makeMotion(steady, 0.5, { count: 9 });
  const { times, points } = motion.trace();
  equal(points.length, 3 * times.length, "length");
  motion.t.forEach((time, i) => {
    const place = times.indexOf(time);
    const axis = motion.axisOf(motion.attitudes[i]);
    near(Math.hypot(...[0, 1, 2].map((k) => points[3 * place + k] - axis.getComponent(k))), 0, 1e-15);
  });
  equal(times.at(-1), motion.end, "end");
});

test("without a body there is no momentum", () => {
  const { t } = makeMotion(steady, 0.1);
  const names = ["phi", "theta", "psi"];
  const exact = { t: pack(t, Float64Array) };
  names.forEach((name, k) => { exact[name] = pack(Array.from(t, (time) => steady(time)[k]), Float64Array); });
  const drawn = { omega: pack(Array.from(t).flatMap(steadyOmega), Float32Array) };
  const motion = new Motion({ title: "", total: 5, stride: 1, exact, drawn, notes: [] });
  equal(motion.momentum, null, "momentum");
  equal(toAngles(motion.at(0).attitude).map((angle) => Number(angle.toFixed(9))), [0, 0.8, 0]);
});
