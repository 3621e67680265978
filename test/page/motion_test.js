// The motion between rows against motions that are known.

import { fromAngles, toAngles } from "../../scripts/reporting/page/attitude.js";
import { columnsOf } from "../../scripts/reporting/page/data.js";
import { Motion } from "../../scripts/reporting/page/motion.js";
import { equal, near, test } from "./check.js";

const BODY = {
  mass: 2,
  inertia: [3, 3, 0.5],
  products: [0, 0, 0],
  centre: [0, 0, 1],
  axis: [0, 0, 1],
  solids: [
    { kind: "cylinder", radius: 0.5, height: 0.1, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1], place: [0, 0, 1] },
  ],
};
const FACTS = { title: "", total: 5, stride: 1, notes: [], body: BODY };

/** A motion with these angles at times 0, dt, 2 dt, ...; `form` says what of it the table has. */
function makeMotion(angles, dt, { count = 5, form = "angles", omega = null, rates = null } = {}) {
  const t = Float64Array.from({ length: count }, (_, i) => i * dt);
  const columns = { t };
  const add = (names, values) => {
    const rows = Array.from(t, values);
    names.forEach((name, k) => { columns[name] = Float64Array.from(rows, (row) => row[k]); });
  };
  if (form === "angles") add(["phi", "theta", "psi"], angles);
  else add(["q1", "q2", "q3", "q0"], (time) => fromAngles(...angles(time)).toArray());
  if (omega) add(["omega1", "omega2", "omega3"], omega);
  if (rates) add(["phi_rate", "theta_rate", "psi_rate"], rates);
  return new Motion({ ...FACTS, total: count }, columns);
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
  const [a, b] = [0.5, 0.8].map((part) => motion.at(part * 0.05).vectors.momentum);
  const across = 3 * RATE * Math.sin(0.8);
  const expected = 0.5 * (RATE * Math.cos(0.8) + SPIN) * Math.cos(0.8) + across * Math.sin(0.8);
  near(a[2], expected, 1e-3);
  near(b[2], expected, 1e-3);
});

test("the momentum of a body in other than principal axes", () => {
  const body = { ...BODY, inertia: [3, 2, 1], products: [0.1, -0.2, 0.3] };
  const columns = { t: Float64Array.of(0, 1) };
  Object.entries({ q0: 1, q1: 0, q2: 0, q3: 0, omega1: 1, omega2: 10, omega3: 100 }).forEach(([name, value]) => {
    columns[name] = Float64Array.of(value, value);
  });
  const { vectors: { momentum } } = new Motion({ ...FACTS, total: 2, body }, columns);
  [3 + 3 - 20, 0.3 + 20 + 10, -0.2 + 1 + 100].forEach((value, k) => near(momentum[k], value, 1e-12));
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
  const steadily = makeMotion(steady, 0.1);
  const { t } = steadily;
  const [phi, theta, psi] = [0, 1, 2].map((k) => steadily.column("angles", k));
  const [omega1, omega2, omega3] = [0, 1, 2].map((k) => Float64Array.from(t, (time) => steadyOmega(time)[k]));
  const motion = new Motion({ ...FACTS, body: undefined }, { t, phi, theta, psi, omega1, omega2, omega3 });
  equal(motion.vectors.momentum, null, "momentum");
  equal(motion.at(0).omega, steadyOmega(0));
  equal(toAngles(motion.at(0).attitude).map((angle) => Number(angle.toFixed(9))), [0, 0.8, 0]);
});

test("rates give the angular velocity, and it the rates", () => {
  const rates = () => [RATE, 0, SPIN];
  const ofRates = makeMotion(steady, 0.1, { rates });
  const ofOmega = makeMotion(steady, 0.1, { omega: steadyOmega });
  for (const time of ofRates.t) {
    steadyOmega(time).forEach((value, k) => near(ofRates.at(time).omega[k], value, 1e-13));
    rates().forEach((value, k) => near(ofOmega.at(time).rates[k], value, 1e-12));
    near(Math.hypot(...ofRates.at(time).vectors.omega), Math.hypot(...steadyOmega(time)), 1e-12);
  }
  const sleeping = makeMotion(() => [0, 0, 0], 0.1, { omega: () => [0, 0, 5] });
  equal(sleeping.at(0).rates.map(Number.isNaN), [true, false, true], "what does not exist upright");
});

test("columns are read to the last bit, comments left out", () => {
  const text = "# a comment\n# phi: x\nt,status,phi\n0.1,ok,1e-300\n0.30000000000000004,ok,-0\n# status: ok\n";
  const { t, phi } = columnsOf(text, ["t", "phi"]);
  equal([...t], [0.1, 0.1 + 0.2]);
  equal([phi[0], Object.is(phi[1], -0)], [1e-300, true]);
});

test("a name with a comma is one name", () => {
  const name = "theta__top.inertia_tensor(1,2)";
  const text = `t,"${name}",phi\n0.5,,3\n`;
  equal([...columnsOf(text, ["phi"]).phi], [3]);
  const other = columnsOf(`"${name}",t\n2,7\n`, [name, "t"]);
  equal([other[name][0], other.t[0]], [2, 7]);
});

test("the row that is nearest to a time", () => {
  const motion = makeMotion(steady, 0.5);
  equal([-1, 0.2, 0.26, 1.9, 9].map((time) => motion.rowNear(time)), [0, 0, 1, 4, 4]);
});
