// What is drawn of a body and of a trace, and what is in view.

import { countUpTo } from "../../scripts/reporting/page/dynamics/numbers.js";
import { measure } from "../../scripts/reporting/page/stage/body.js";
import { viewOf } from "../../scripts/reporting/page/stage/view.js";
import { equal, near, test } from "./check.js";

const AXES = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** A body with one solid, its centre of mass at a height. */
function bodyOf(solid, height = 1) {
  const solids = solid ? [{ ...solid, axes: AXES, place: [0, 0, height] }] : [];
  return { centre: [0, 0, height], axis: [0, 0, 1], solids };
}

test("solids reach as far as they do", () => {
  const cases = [
    [{ kind: "cylinder", radius: 0.5, height: 0.2 }, Math.hypot(0.5, 1.1), 0.5, 1.1],
    [{ kind: "ring", radius: 0.5, inner: 0.3, height: 0.2 }, Math.hypot(0.5, 1.1), 0.5, 1.1],
    [{ kind: "sphere", radius: 0.5 }, 1.5, 0.5, 1.5],
    [{ kind: "cuboid", edges: [0.6, 0.8, 0.2] }, Math.hypot(0.5, 1.1), 0.5, 1.1],
    [null, 1, 0, 1],
  ];
  for (const [solid, reach, girth, top] of cases) {
    const found = measure(bodyOf(solid));
    near(found.reach, reach, 0.05, `reach of ${solid?.kind}`);
    near(Math.max(0, ...found.rims.map(([, radius]) => radius)), girth, 1e-3, `girth of ${solid?.kind}`);
    near(found.tip, 1.06 * top, 1e-3, `tip of ${solid?.kind}`);
  }
});

test("a cone stands on its apex, which is the pivot", () => {
  const cone = { kind: "cone", radius: 0.4, height: 1.2 };
  const { tip, rims } = measure(bodyOf(cone, 0.9));
  near(Math.min(...rims.map(([height]) => height)), 0, 1e-7, "height of the apex");
  near(tip, 1.06 * 1.2, 1e-6, "tip");
});

test("tops and arrows are in view, wherever they point", () => {
  const body = bodyOf({ kind: "cylinder", radius: 0.2, height: 0.1 });
  const points = [0, 0, 1, 0.6, 0, 0.8];
  const force = Float64Array.from([0, 0, -7, 3, 0, 5, 0, -7, 0]);
  const { middle, radius, perUnit, tip } = viewOf([{ body, trace: { times: [0, 1], points } }], { force, omega: null });
  for (let i = 0; i < force.length; i += 3) {
    const [x, y, z] = [0, 1, 2].map((k) => perUnit.force * force[i + k]);
    equal(Math.hypot(x, y, z - middle) <= radius + 1e-12, true, "whether an arrow is in view");
  }
  near(7 * perUnit.force, 0.8 * tip, 1e-12, "length of the longest arrow");
  equal(Math.hypot(0, tip - middle) <= radius, true, "whether the tip is in view");
  equal(perUnit.omega, 0, "a vector that is not there");
});

test("a wide body is in view to its lowest rim", () => {
  const body = bodyOf({ kind: "cylinder", radius: 3, height: 1 }, 0.5);
  const angle = 0.35;
  const points = [Math.sin(angle), 0, Math.cos(angle)];
  const { middle, radius } = viewOf([{ body, trace: { times: [0], points } }], {});
  for (const [height, side] of [[0, 3], [0, -3], [1, 3], [1, -3]]) {
    const across = height * Math.sin(angle) + side * Math.cos(angle);
    const up = height * Math.cos(angle) - side * Math.sin(angle);
    equal(Math.hypot(across, up - middle) <= radius * (1 + 1e-9), true, "whether a rim is in view");
  }
});

test("numbers up to a value are counted", () => {
  equal([-1, 0, 1.5, 3, 9].map((value) => countUpTo([0, 1, 2, 3], value)), [0, 1, 2, 4, 4]);
});
