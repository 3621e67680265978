// Two motions of one scene: the angles between them.

import { Vector3 } from "three";
import { fromAngles } from "../../scripts/reporting/page/attitude.js";
import { Motion } from "../../scripts/reporting/page/motion.js";
import { Pair, angleBetween, angleOf } from "../../scripts/reporting/page/pair.js";
import { equal, near, test } from "./check.js";

/** A motion at these times, its azimuth ahead by a lead. */
function makeMotion(times, lead) {
  const t = Float64Array.from(times);
  const columns = {
    t,
    phi: t.map((time) => 0.3 * time + lead(time)),
    theta: t.map(() => 0.7),
    psi: t.map((time) => 2 * time),
  };
  return new Motion({ title: "", total: t.length, stride: 1, notes: [] }, columns);
}

const TIMES = [0, 1, 2, 3, 4];

test("angles are right where they are small, and where they are large", () => {
  for (const angle of [0, 1e-13, 1e-6, 1, 3]) {
    near(angleBetween(fromAngles(1, 0.5, 2), fromAngles(1, 0.5, 2 + angle)), angle, 1e-15 + 1e-12 * angle);
    const turned = new Vector3(Math.cos(angle), Math.sin(angle), 0);
    near(angleOf(new Vector3(1, 0, 0), turned), angle, 1e-15 + 1e-12 * angle);
  }
  near(angleBetween(fromAngles(0, 0.5, 0), fromAngles(0, 0.5, 2 * Math.PI)), 0, 1e-14);
});

test("a lead in azimuth is the angle of attitudes; that of axes is smaller", () => {
  const lead = (time) => 0.01 * time;
  const pair = new Pair(makeMotion(TIMES, () => 0), makeMotion(TIMES, lead));
  const { times, attitudes, axes, hasRows } = pair.series();
  equal([times, hasRows], [TIMES, true]);
  times.forEach((time, i) => {
    near(attitudes[i], lead(time), 1e-14);
    near(Math.sin(axes[i] / 2), Math.sin(0.7) * Math.sin(lead(time) / 2), 1e-14);
  });
});

test("where the rows differ one motion is interpolated, and that is known", () => {
  const pair = new Pair(makeMotion(TIMES, () => 0), makeMotion([0, 1.5, 3], () => 0));
  const { times, hasRows } = pair.series();
  equal([times, hasRows], [[0, 1, 2, 3], false]);
  equal(pair.otherAt(4).time, 3, "time of the other after its end");
});
