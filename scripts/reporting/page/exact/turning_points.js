// The roots of the cubic that bounds the nutation, without cancellation: src/exact/turning_points.f90.
//
// With u = u0 + y the nutation obeys u'^2 = f = beta y^3 + G2 y^2 + G1 y + G0, whose roots are
// u1 <= u0 <= u2 <= 1 <= u3. Every difference of roots that is needed is computed separately.
// Symbols as in regular_start.js.

import { EPSILON, quotient } from "./arithmetic.js";

/** Finds the turning points of a start. */
export function findTurningPoints(start) {
  const { u: u0, a, beta, sineSquared: s2, swingSquared: k0 } = start;
  const g0 = start.uRate ** 2;
  const g1 = -2 * u0 * k0 - beta * s2 + 2 * a * start.turn;
  const g2 = 2 * beta * u0 - k0 - a ** 2;
  const points = upperRootsAreClose(beta, g0, g1, g2)
    ? startFromLowest(start, g0, g1, g2)
    : startFromHighest(start, g0, g1, g2);

  points.onePlusU1 = quotient(start.bPlusA ** 2, points.onePlusU2 * points.betaU3Plus1);
  points.kSquared = quotient(beta * points.u2MinusU1, points.betaU3MinusU1);
  points.complementSquared = quotient(beta * points.oneMinusU2 + points.betaU3Minus1, points.betaU3MinusU1);
  points.complement = Math.sqrt(points.complementSquared);
  points.frequency = Math.sqrt(points.betaU3MinusU1) / 2;
  return points;
}

/**
 * Whether the two upper roots are close together, so that an iteration for the highest one would be slow:
 * the cubic is positive at its inflection, and the start is not itself a root.
 */
function upperRootsAreClose(beta, g0, g1, g2) {
  return g0 > 0 && g2 * (2 * g2 ** 2 - 9 * beta * g1) + 27 * beta ** 2 * g0 > 0;
}

/** The regular case: the highest root first, as Y3 = beta (u3 - u0), which is regular without gravity. */
function startFromHighest(start, g0, g1, g2) {
  const { beta } = start;
  let [y1, y2, u2MinusU1] = [0, 0, 0];
  // The larger root of Y^2 + G2 Y + beta G1: exact for a start at a turning point.
  const discriminant = Math.sqrt(Math.max(g2 ** 2 - 4 * beta * g1, 0));
  let root = g2 <= 0 ? (discriminant - g2) / 2 : (-2 * beta * g1) / (g2 + discriminant);
  if (g0 > 0) {
    root = walkToRoot([beta ** 2 * g0, beta * g1, g2, 1], -1, root);
    const product = -g0 / root;
    const total = (g1 - beta * product) / root;
    u2MinusU1 = Math.sqrt(total ** 2 - 4 * product);
    if (total > 0) {
      y2 = (total + u2MinusU1) / 2;
      y1 = product / y2;
    } else {
      y1 = (total - u2MinusU1) / 2;
      y2 = product / y1;
    }
  } else {
    y1 = Math.min(quotient(g1, root), 0);
    y2 = Math.max(quotient(g1, root), 0);
    u2MinusU1 = y2 - y1;
  }

  const oneMinusU1 = start.oneMinusU - y1;
  let oneMinusU2 = start.oneMinusU - y2;
  const onePlusU2 = start.onePlusU + y2;
  let betaU3Minus1 = root - beta * start.oneMinusU;
  const betaU3MinusU1 = root - beta * y1;
  const betaU3Plus1 = root + beta * start.onePlusU;

  // f(1) = -(b-a)^2 relates the two distances from u = 1: the larger one is accurate.
  if (beta * oneMinusU2 >= betaU3Minus1) {
    betaU3Minus1 = quotient(start.bMinusA ** 2, oneMinusU1 * oneMinusU2);
  } else {
    oneMinusU2 = quotient(start.bMinusA ** 2, oneMinusU1 * betaU3Minus1);
  }
  return { y1, y2, u2MinusU1, oneMinusU1, oneMinusU2, onePlusU2, betaU3Minus1, betaU3MinusU1, betaU3Plus1 };
}

/** Near a double upper root: the lowest root first, then the upper two from their sum and product. */
function startFromLowest(start, g0, g1, g2) {
  const { beta, oneMinusU: sh, onePlusU: ch } = start;
  const energy = start.swingSquared + start.a ** 2;
  const y1 = walkToRoot([g0, g1, g2, beta], 1, -ch);

  // u2 + u3 - 2 in two ways: the one with the smaller terms has less cancellation.
  const excessError = energy / beta + 2 - y1;
  const otherError = (Math.abs(g1) - g0 / y1) / (-beta * y1) + 2 * sh;
  const excess = otherError < excessError
    ? (g1 + g0 / y1) / (beta * y1) - 2 * sh
    : energy / beta - 2 - y1;
  const oneMinusU1 = sh - y1;
  const product = start.bMinusA ** 2 / (beta * oneMinusU1);
  const larger = (Math.abs(excess) + Math.sqrt(excess ** 2 + 4 * product)) / 2;
  const smaller = quotient(product, larger);
  const [u3Minus1, oneMinusU2] = excess >= 0 ? [larger, smaller] : [smaller, larger];

  const y3 = sh + u3Minus1;
  const y2 = -g0 / (beta * y1 * y3);
  return {
    y1, y2, u2MinusU1: y2 - y1, oneMinusU1, oneMinusU2, onePlusU2: ch + y2,
    betaU3Minus1: beta * u3Minus1, betaU3MinusU1: beta * (y3 - y1), betaU3Plus1: beta * (ch + y3),
  };
}

/**
 * Laguerre's method for an outermost real root of sum c[n] x^n, c[3] >= 0, from outside: upward to the
 * lowest root (direction 1) or downward to the highest (direction -1). Only rounding errors carry an
 * iterate past the root; the iteration then settles to relative precision.
 */
function walkToRoot(c, direction, first) {
  const [mostIterations, mostReturns] = [60, 3];
  let [x, returns] = [first, 0];
  for (let n = 0; n < mostIterations; n += 1) {
    const g = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
    const slope = c[1] + x * (2 * c[2] + x * 3 * c[3]);
    const curvature = 2 * c[2] + 6 * c[3] * x;
    const step = -quotient(3 * g, slope + Math.sqrt(Math.max(4 * slope ** 2 - 6 * g * curvature, 0)));
    x += step;
    if (Math.abs(step) <= EPSILON * Math.abs(x)) break;
    if (direction * step < 0) returns += 1;
    if (returns > mostReturns) break;
  }
  return x;
}
