// How large things are drawn, alike in three dimensions and in two.

import { girthOf, reachOf, tipOf } from "./solid.js";

const LONGEST = 0.9; // of the reach of the body: the longest force, the largest momentum

/** What of space the tip passes through: its least and largest height, its distance from the vertical. */
function roomOf({ points }, tip) {
  let [low, high, aside] = [Infinity, -Infinity, 0];
  for (let i = 0; i < points.length; i += 3) {
    low = Math.min(low, tip * points[i + 2]);
    high = Math.max(high, tip * points[i + 2]);
    aside = Math.max(aside, tip * Math.hypot(points[i], points[i + 1]));
  }
  return { low, high, aside };
}

/**
 * Sizes for a motion, m: how far the body reaches, where its tip is, how long a unit of a vector is;
 * of the part of space to be seen the height of its middle and its radius; and the heights between
 * which the tip stays, if it does so on one side of the pivot.
 */
export function scaleOf(motion) {
  const tip = tipOf(motion.body);
  const reach = Math.max(reachOf(motion.body), tip);
  const { low, high, aside } = roomOf(motion.trace(), tip);
  const [bottom, top] = [Math.min(low, 0), Math.max(high, 0)];
  const radius = Math.min(Math.max(aside, (top - bottom) / 2) + girthOf(motion.body), reach);
  const per = (table) => (table ? (LONGEST * reach) / (motion.largest(table) || 1) : 0);
  return {
    reach,
    tip,
    middle: (bottom + top) / 2,
    radius,
    between: low > 0 || high < 0 ? [low, high] : null,
    force: per(motion.force),
    momentum: per(motion.momentum),
  };
}

/** The view to begin with: azimuth and elevation of the eye, rad. */
export const FIRST_VIEW = { azimuth: -1.05, elevation: 0.32 };
