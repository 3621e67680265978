// What of a motion does not depend on time: range of the nutation angle, period, change of phi and psi
// per nutation, largest rates, and the class of the motion: src/exact/nutation.f90.

import { EPSILON, quotient, sign } from "./arithmetic.js";
import { halfOf } from "./regular_start.js";
import { RESTING } from "./theta_motion.js";

/** One phrase for each class of motion. */
export const CLASS_MEANINGS = {
  loop: "the precession reverses in every nutation",
  cusp: "the precession comes to rest at the upper turning angle",
  wave: "the precession keeps its direction",
  steady: "steady precession: the inclination is constant",
  sleeping: "the axis rests upright",
  hanging: "the axis rests hanging",
  separatrix: "separatrix: the axis approaches the upright asymptotically",
  libration: "plane pendulum, oscillating",
  circulation: "plane pendulum, rotating over the top",
};

/** Tolerance of the classification for rounding errors of the data, in units of their largest terms. */
const DATA_ROUNDING = 8 * EPSILON;
/** A pole that is missed by no more than this, rad, is passed through, if the axis goes so many times as far from it. */
const THROUGH_POLE = 2 ** -35, IN_POLE = 10;

/** The complete quantities of a motion whose theta functions are set up; SI units and radians. */
export function describeNutation(start, points, motion) {
  const isResting = motion.regime === RESTING;
  const nutation = {
    motionClass: classOf(start, points, motion.regime),
    passesTop: !isResting && (reachesTop(start, points)
      || (passesThrough(points.oneMinusU2, points.oneMinusU1) && start.beta * points.oneMinusU2 <= points.betaU3Minus1)),
    passesBottom: !isResting && (reachesBottom(start) || passesThrough(points.onePlusU1, points.onePlusU2)),
    thetaMin: inclination(points.oneMinusU2, points.onePlusU2),
    thetaMax: inclination(points.oneMinusU1, points.onePlusU1),
    deltaU: points.u2MinusU1,
    kSquared: points.kSquared,
    complementSquared: points.complementSquared,
    period: 0, precession: 0, spin: 0, precessionRate: 0, spinRate: 0, phiRateMax: 0, thetaRateMax: 0,
  };
  if (isResting) {
    nutation.thetaMin = inclination(start.oneMinusU, start.onePlusU);
    nutation.thetaMax = nutation.thetaMin;
    nutation.deltaU = 0;
    nutation.spinRate = start.omega3;
    // Without nutation the period is that of infinitely small nutations.
    nutation.period = points.frequency > 0 ? Math.PI / points.frequency : Infinity;
    nutation.spin = wholeTurn(nutation.spinRate, nutation.period);
    return nutation;
  }
  addPrecession(start, motion.clock, nutation);
  const rateAtTop = phiRateAtTop(start, points);
  const rateAtBottom = phiRateAtBottom(start, points);
  nutation.phiRateMax = Math.abs(rateAtTop) > Math.abs(rateAtBottom) ? rateAtTop : rateAtBottom;
  nutation.thetaRateMax = largestThetaRate(points);
  return nutation;
}

/** Period, and the change of phi and psi per period. */
function addPrecession(start, clock, nutation) {
  const spinRate = 2 * halfOf(start) + clock.upperRate - clock.lowerRate;
  if (clock.period > 0) {
    const period = clock.period / clock.rate;
    const topJump = nutation.passesTop ? sign(Math.PI, start.bMinusA) : 0;
    const bottomJump = nutation.passesBottom ? sign(Math.PI, start.bPlusA) : 0;
    let precession = clock.sumRate * period + clock.upperStep + clock.lowerStep - topJump - bottomJump;
    let spin = spinRate * period + clock.upperStep - clock.lowerStep + topJump - bottomJump;
    if (isPlane(start)) precession = 0;
    if (isPlane(start) && !(Math.abs(start.omega3) > 0)) spin = 0;
    Object.assign(nutation, {
      period, precession, spin, precessionRate: precession / period, spinRate: spin / period,
    });
  } else {
    // On the separatrix the mean rates are those at the upright, reached in the limit.
    nutation.period = Infinity;
    nutation.precessionRate = clock.sumRate;
    nutation.spinRate = spinRate;
    nutation.precession = wholeTurn(nutation.precessionRate, nutation.period);
    nutation.spin = wholeTurn(nutation.spinRate, nutation.period);
  }
}

/** Rate times period; zero where the rate is zero and the period infinite. */
function wholeTurn(rate, period) {
  return Math.abs(rate) > 0 ? rate * period : 0;
}

/**
 * The class of a motion. Classes that are limits (cusp, steady, separatrix) apply within the rounding
 * error of data in double precision.
 */
function classOf(start, points, regime) {
  if (regime === RESTING) {
    if (start.sineSquared > 0) return "steady";
    return start.oneMinusU < 1 ? "sleeping" : start.oneMinusU > 1 ? "hanging" : "steady";
  }
  if (isSeparatrix(start, points)) return "separatrix";
  if (isPlane(start)) {
    return points.betaU3Minus1 > start.beta * points.oneMinusU2 ? "circulation" : "libration";
  }
  if (isSteady(start, points)) return "steady";
  if (isCusp(start, points)) return "cusp";
  const rates = [phiRateAtTop(start, points), phiRateAtBottom(start, points)];
  return rates.every((rate) => rate > 0) || rates.every((rate) => rate < 0) ? "wave" : "loop";
}

/** Whether the motion stays in a vertical plane: a = b = 0. */
function isPlane(start) {
  return !(Math.abs(start.bMinusA) + Math.abs(start.bPlusA) > 0);
}

/** Whether the two upper roots coincide (at u = 1), within the rounding error of the data. */
function isSeparatrix(start, points) {
  const { beta } = start;
  return points.kSquared > 0.5 && beta * points.oneMinusU2 + points.betaU3Minus1
    <= DATA_ROUNDING * (start.swingSquared + start.a ** 2 + beta * (2 + Math.abs(points.y1)));
}

/** Whether the inclination is constant within the rounding error of the data. */
function isSteady(start, points) {
  const { u: u0, swingSquared: k0, sineSquared: s2, beta, a, turn } = start;
  const moment = -2 * u0 * k0 - beta * s2 + 2 * a * turn;
  const terms = 2 * Math.abs(u0) * k0 + beta * s2 + 2 * Math.abs(a * turn);
  return Math.abs(moment) <= DATA_ROUNDING * terms
    && 4 * points.frequency * Math.abs(start.uRate) <= DATA_ROUNDING * terms;
}

/** Whether the precession vanishes at the upper turning angle, within the rounding error of the data. */
function isCusp(start, points) {
  return !reachesTop(start, points) && Math.abs(start.turn - start.a * points.y2)
    <= DATA_ROUNDING * (Math.abs(start.turn) + Math.abs(start.a) * start.sineSquared);
}

/** Whether the axis passes through a pole, from the least and the largest 1 - u, or 1 + u, of the motion. */
function passesThrough(nearest, farthest) {
  return 2 * nearest <= THROUGH_POLE ** 2 && nearest * IN_POLE ** 2 <= farthest;
}

/**
 * Whether the axis passes through theta = 0: b = a within the rounding error of the data, and u2 = 1 (not
 * u3 = 1, which lies above a motion that turns earlier).
 */
function reachesTop(start, points) {
  return Math.abs(start.bMinusA) <= DATA_ROUNDING * (Math.abs(start.turn) + start.oneMinusU * Math.abs(start.a))
    && start.beta * points.oneMinusU2 <= points.betaU3Minus1;
}

/** Whether the axis passes through theta = pi: b = -a within the rounding error of the data. */
function reachesBottom(start) {
  return Math.abs(start.bPlusA) <= DATA_ROUNDING * (Math.abs(start.turn) + start.onePlusU * Math.abs(start.a));
}

/** phi' at u2, rad/s; through theta = 0 its limit. */
export function phiRateAtTop(start, points) {
  return reachesTop(start, points)
    ? quotient(start.a, points.onePlusU2)
    : (start.turn - start.a * points.y2) / (points.oneMinusU2 * points.onePlusU2);
}

/** phi' at u1, rad/s; through theta = pi its limit. */
export function phiRateAtBottom(start, points) {
  return reachesBottom(start)
    ? quotient(-start.a, points.oneMinusU1)
    : (start.turn - start.a * points.y1) / (points.oneMinusU1 * points.onePlusU1);
}

/**
 * Largest theta', rad/s. With x = sn^2, D = 1-u2, p = 1+u1 and d = u2-u1, theta'^2 is proportional to
 * x (1-x) (1 - k^2 x) / ((D + d (1-x)) (p + d x)), whose logarithm is concave: the numerator of its
 * derivative has one zero in [0, 1]. Newton's method within a bracket.
 */
function largestThetaRate(points) {
  const [mostIterations, tolerance] = [60, 1e-9]; // The rate depends on the square of its error.
  const d = points.u2MinusU1;
  if (!(d > 0)) return 0;
  const { kSquared: k2, oneMinusU1, oneMinusU2, onePlusU1, onePlusU2 } = points;
  const topAt = (x) => oneMinusU2 + d * (1 - x);
  const bottomAt = (x) => onePlusU1 + d * x;
  let [low, high, x] = [EPSILON ** 2, 1 - EPSILON, 0.5];
  for (let n = 0; n < mostIterations; n += 1) {
    const [top, bottom] = [topAt(x), bottomAt(x)];
    // The derivative of the logarithm, divided by d^2, times x (1-x), and its own derivative: both bounded.
    const value = (onePlusU1 / bottom) * (1 - x) - (oneMinusU2 / top) * x - (k2 * x * (1 - x)) / (1 - k2 * x);
    const slope = (-onePlusU1 * onePlusU2) / bottom ** 2 - (oneMinusU2 * oneMinusU1) / top ** 2
      - (k2 * ((1 - x) ** 2 - (1 - k2) * x ** 2)) / (1 - k2 * x) ** 2;
    if (value > 0) low = x;
    if (value <= 0) high = x;
    let next = x - value / slope;
    if (!(next > low && next < high)) next = (low + high) / 2;
    if (Math.abs(next - x) <= tolerance * Math.min(x, 1 - x)) break;
    x = next;
  }
  // The products are formed in pairs, which are regular where the motion passes a pole.
  return 2 * points.frequency * d * Math.sqrt((1 - k2 * x) * (x / bottomAt(x)) * ((1 - x) / topAt(x)));
}

/** Inclination from 1 - u and 1 + u, rad. */
function inclination(oneMinusU, onePlusU) {
  return 2 * Math.atan2(Math.sqrt(oneMinusU), Math.sqrt(onePlusU));
}
