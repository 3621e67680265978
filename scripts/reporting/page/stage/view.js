// How large things are drawn, and which part of space is seen.

import { extremesOf } from "../dynamics/numbers.js";
import { measure } from "./body.js";

const HEIGHTS = 33; // of a trace that are looked at
const LONGEST = 0.8; // of the way from the pivot to the tip: the longest arrow of each kind

/** The largest magnitude in a table of vectors, x, y, z side by side. */
function largestOf(table) {
  let square = 0;
  for (let i = 0; i < table.length; i += 3) {
    square = Math.max(square, table[i] ** 2 + table[i + 1] ** 2 + table[i + 2] ** 2);
  }
  return Math.sqrt(square);
}

/** The least and the largest height of a trace of unit vectors. */
function heightsOf(points) {
  return extremesOf(points.filter((_, i) => i % 3 === 2));
}

/** Calls back with the distance from the vertical and the height of all that is to be seen, m. */
function visit(tops, vectors, perUnit, tips, see) {
  see(0, 0);
  tops.forEach(({ body, trace: { points } }, k) => {
    const rims = [[tips[k], 0], ...measure(body).rims];
    const [low, high] = heightsOf(points);
    for (let i = 0; i < HEIGHTS; i += 1) {
      const cosine = low + ((high - low) * i) / (HEIGHTS - 1);
      const sine = Math.sqrt(Math.max(0, 1 - cosine ** 2));
      for (const [height, radius] of rims) {
        for (const side of [radius, -radius]) {
          see(Math.abs(height * sine + side * cosine), height * cosine - side * sine);
        }
      }
    }
  });
  for (const [name, table] of Object.entries(vectors)) {
    if (!table) continue;
    const unit = perUnit[name];
    for (let i = 0; i < table.length; i += 3) {
      see(unit * Math.hypot(table[i], table[i + 1]), unit * table[i + 2]);
    }
  }
}

/** The heights between which the tips stay, if they do so on one side of the pivot. */
function bandOf(tops, tips) {
  const heights = tops.flatMap(({ trace: { points } }, k) => heightsOf(points).map((height) => tips[k] * height));
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  return low > 0 || high < 0 ? [low, high] : null;
}

/** How many panes tops are in: tops of one stand in one picture, and all panes are seen by one eye. */
export function countPanes(tops) {
  return 1 + Math.max(0, ...tops.map(({ pane = 0 }) => pane));
}

/**
 * Where the panes of a canvas are, in its units: side by side, or one above the other on a tall one.
 * Of each the left and upper edge, width and height.
 */
export function placePanes(count, width, height) {
  const isTall = height > width;
  const [across, down] = isTall ? [width, height / count] : [width / count, height];
  return Array.from({ length: count }, (_, k) => (isTall ? [0, k * down, across, down] : [k * across, 0, across, down]));
}

/** How long a unit of each vector is drawn, m. */
export function unitsOf(tops, vectors) {
  const tip = Math.max(...tops.map(({ body }) => measure(body).tip));
  const unitOf = (table) => (table ? (LONGEST * tip) / (largestOf(table) || 1) : 0);
  return Object.fromEntries(Object.entries(vectors).map(([name, table]) => [name, unitOf(table)]));
}

/**
 * Sizes for tops and the vectors that are drawn with them, m: where their tips are; of the part of space to be seen the
 * height of its middle and its radius, so that neither tops nor arrows leave it; and the band of the tips.
 */
export function viewOf(tops, vectors) {
  const tips = tops.map(({ body }) => measure(body).tip);
  const perUnit = unitsOf(tops, vectors);
  let [low, high, radius] = [0, 0, 0];
  visit(tops, vectors, perUnit, tips, (_, height) => {
    [low, high] = [Math.min(low, height), Math.max(high, height)];
  });
  const middle = (low + high) / 2;
  visit(tops, vectors, perUnit, tips, (across, height) => {
    radius = Math.max(radius, Math.hypot(across, height - middle));
  });
  return { tips, tip: Math.max(...tips), perUnit, middle, radius, band: bandOf(tops, tips) };
}
