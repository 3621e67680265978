// How large things are drawn, alike in three dimensions and in two.

import { reachOf, tipOf } from "./solid.js";

const LONGEST = 0.9; // of the reach of the body: the longest force, the largest momentum

/** Sizes for a motion: how far the body reaches, where its tip is, metres for a unit of a vector. */
export function scaleOf(motion) {
  const reach = Math.max(reachOf(motion.body), tipOf(motion.body));
  const per = (table) => (table ? (LONGEST * reach) / (motion.largest(table) || 1) : 0);
  return {
    reach,
    tip: tipOf(motion.body),
    force: per(motion.force),
    momentum: per(motion.momentum),
  };
}

/** The view to begin with: azimuth and elevation of the eye, rad. */
export const FIRST_VIEW = { azimuth: -1.05, elevation: 0.32 };
