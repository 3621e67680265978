// What is drawn of a body and of a trace, and what is in view.

import { FAINTEST, countUpTo, strengthAt } from "../../scripts/reporting/page/stage/trace.js";
import { reachOf, rimsOf, tipOf, wiresOf } from "../../scripts/reporting/page/stage/solid.js";
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
    [{ kind: "ellipsoid", semiaxes: [0.5, 0.5, 0.1] }, 1.15, 0.5, 1.1],
    [null, 1, 0, 1],
  ];
  for (const [solid, reach, girth, top] of cases) {
    const body = bodyOf(solid);
    near(reachOf(body), reach, 0.05, `reach of ${solid?.kind}`);
    const radii = rimsOf(body).map(([, radius]) => radius);
    near(Math.max(0, ...radii), girth, 1e-3, `girth of ${solid?.kind}`);
    near(tipOf(body), 1.06 * top, 1e-3, `tip of ${solid?.kind}`);
  }
});

test("a cone stands on its apex, which is the pivot", () => {
  const cone = { kind: "cone", radius: 0.4, height: 1.2 };
  const body = bodyOf(cone, 0.9);
  const lowest = Math.min(...wiresOf(cone).flat().map(({ z }) => z));
  near(lowest + 0.9, 0, 1e-12, "height of the apex");
  near(tipOf(body), 1.06 * 1.2, 1e-12, "tip");
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

test("of a trace the past is seen, the older the fainter", () => {
  const times = [0, 1, 2, 3];
  equal([-1, 0, 1.5, 3, 9].map((time) => countUpTo(times, time)), [0, 1, 2, 4, 4]);
  equal(strengthAt(0), 1, "strength now");
  equal([0.01, 0.1, 0.5].every((age, i, ages) => strengthAt(age) > strengthAt(ages[i + 1] ?? 1)), true);
  equal(strengthAt(1) > FAINTEST, true, "whether the oldest is seen");
});
