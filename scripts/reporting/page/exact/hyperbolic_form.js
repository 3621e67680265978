// The exact solution in hyperbolic functions, for k^2 > 1/2: motions that stay near the upright for a
// long time, up to and including the separatrix: src/exact/hyperbolic_form.f90.
//
// Jacobi's imaginary transformation of the circular form: the nome q' = exp(-pi K/K') <= 0.0433 belongs
// to the complementary modulus and is zero on the separatrix.

import { EPSILON, conjugate, multiply, scale, sign } from "./arithmetic.js";
import { newClock, nome, theta3Constant } from "./theta_functions.js";

/** Index of the last term of a series; the next term is below 2e-22. */
const LAST = 3;
const SQUARES = [0, 1, 4, 9];
const ODD = [1, 3, 5, 7];
const ALTERNATING = [1, -1, 1, -1];

/** Prepares clock and series of a motion with k^2 > 1/2. */
export function prepareHyperbolicForm(start, points) {
  const { complementSquared: kc2, oneMinusU1: m1, onePlusU2: p2 } = points;
  const clock = newClock();
  const k = Math.sqrt(points.kSquared);
  const q = nome(kc2, k);
  const theta3 = theta3Constant(q);
  const coshSumAt0 = 1 + q ** 2 + q ** 6 + q ** 12;
  clock.rate = points.frequency / theta3 ** 2;
  if (q > 0) {
    clock.halfPeriod = -Math.log(q) / 2;
    clock.period = 2 * clock.halfPeriod;
  }

  const bottom = poleAt(q, Math.sqrt(k * points.betaU3MinusU1), Math.sqrt(start.beta * points.onePlusU1));
  const top = poleAt(q, Math.sqrt(k * points.betaU3Minus1), Math.sqrt(start.beta * points.oneMinusU2));

  const upperSign = sign(1, start.bPlusA);
  const lowerSign = sign(1, start.bMinusA);
  clock.upperRate = start.bPlusA / (2 * p2) + upperSign * clock.rate * bottom.slope;
  clock.lowerRate = start.bMinusA / (2 * m1) + lowerSign * clock.rate * top.slope;
  clock.sumRate = clock.upperRate + clock.lowerRate;
  clock.upperStep = 2 * upperSign * bottom.v;
  clock.lowerStep = 2 * lowerSign * top.v;
  clock.upperAmplitude = (Math.sqrt(p2 / 2) * theta3) / bottom.norm;
  clock.lowerAmplitude = (Math.sqrt(m1 / 2) * coshSumAt0) / top.norm;
  clock.start = startArgument(start, points, q, clock.halfPeriod);

  const powers = SQUARES.map((n) => q ** n);
  const times = (...lists) => powers.map((power, n) => lists.reduce((product, list) => product * list[n], power));
  const cosines = (pole) => ODD.map((n) => pole.cosines[n - 1]);
  const sines = (pole, s) => ODD.map((n) => s * pole.sines[n - 1]);
  const [up, low] = [sines(bottom, upperSign), sines(top, lowerSign)];
  const cnFactor = (2 * coshSumAt0) / (Math.sqrt(k) * theta3);
  const form = {
    // U = upperEven + i upperOdd, W = divisor, sn W = sn: series in z from the lower turning point.
    byZ: {
      upperEven: evenSums(q, times(cosines(bottom))),
      upperOdd: oddSums(q, times(up)),
      upperEvenSlope: oddSums(q, times(ODD, cosines(bottom))),
      upperOddSlope: evenSums(q, times(ODD, up)),
      divisor: evenSums(q, powers),
      divisorSlope: oddSums(q, times(ODD)),
      sn: oddSums(q, times(ALTERNATING).map((value) => value / Math.sqrt(k))),
    },
    // L = exp(-|z|) lowerTurn [lowerEven - i lowerOdd] on the way from u1 to u2, its conjugate on the way
    // back; cn W = exp(-|z|) cn: series in y = H - |z| from the upper turning point.
    byY: {
      lowerEven: evenSums(q, times(cosines(top))),
      lowerOdd: oddSums(q, times(low)),
      lowerEvenSlope: oddSums(q, times(ODD, cosines(top))),
      lowerOddSlope: evenSums(q, times(ODD, low)),
      cn: oddSums(q, times(ALTERNATING).map((value) => value * cnFactor)),
    },
    lowerTurn: [2 * top.cosines[0], 2 * lowerSign * top.sines[0]],
    halfDecay: Math.sqrt(q), // exp(-H)
  };
  return { clock, form };
}

// Sums scaled by exp(-x). With e = exp(-2x) and p = q'/e, both at most 1,
//     sum a(n) p^n exp(-(2n+1)x) cosh (2n+1)x            = near(p) + e far(e)
//     sum a(n) p^n exp(-(2n+1)x) sinh (2n+1)x / (1 - e)  = near(p) + e far(e)

/** The sum of a(n) p^n (1 + e^(2n+1))/2, where p e = q. */
function evenSums(q, a) {
  return { near: a.map((value) => value / 2), far: a.map((value, n) => (value * q ** n) / 2) };
}

/** The sum of a(n) p^n (1 - e^(2n+1))/2 over 1 - e, of a(n)/2 [p^n + q p^(n-1) + ... + q^n + ... + q^n e^n]. */
function oddSums(q, a) {
  const [sums, partial] = [{ near: [], far: [] }, { near: 0, far: 0 }];
  for (let n = LAST; n >= 0; n -= 1) {
    partial.near = a[n] / 2 + q * partial.near;
    sums.near[n] = partial.near;
    sums.far[n] = partial.far;
    partial.far += (q ** n * a[n]) / 2;
  }
  return sums;
}

/**
 * A pole from tan(v) = opposite A(v) / (adjacent B(v)). The ratio of theta functions A/B depends so
 * weakly on v that each iteration gains two digits or more.
 */
function poleAt(q, opposite, adjacent) {
  const mostIterations = 30;
  let [sine, cosine, c] = [opposite, opposite > 0 ? adjacent : 1, 2];
  for (let n = 0; n < mostIterations; n += 1) {
    const previous = c;
    c = (cosine ** 2 - sine ** 2) / (cosine ** 2 + sine ** 2);
    if (Math.abs(c - previous) <= EPSILON) break;
    sine = opposite * seriesA(q, c);
    if (opposite > 0) cosine = adjacent * seriesB(q, c);
  }
  const length = Math.sqrt(sine ** 2 + cosine ** 2);
  const sines = [sine / length];
  const cosines = [cosine / length];
  for (let n = 0; n < 2 * LAST; n += 1) {
    cosines.push(cosines[n] * cosines[0] - sines[n] * sines[0]);
    sines.push(sines[n] * cosines[0] + cosines[n] * sines[0]);
  }
  let [norm, slope] = [0, 0];
  for (let n = 1; n <= LAST; n += 1) {
    norm += q ** (n * n) * cosines[2 * n - 1];
    slope += n * q ** (n * n) * sines[2 * n - 1];
  }
  norm = 1 + 2 * norm;
  return { v: Math.atan2(sine, cosine), sines, cosines, norm, slope: (-4 * slope) / norm };
}

/** A = 1 + sum q^(n(n+1)) A_n(c), A_n = cos((2n+1)v)/cos(v), c = cos(2v). */
function seriesA(q, c) {
  const a1 = 2 * c - 1;
  const a2 = 2 * c * a1 - 1;
  return 1 + q ** 2 * (a1 + q ** 4 * (a2 + q ** 6 * (2 * c * a2 - a1)));
}

/** B = 1 + sum (-1)^n q^(n(n+1)) B_n(c), B_n = sin((2n+1)v)/sin(v), c = cos(2v). */
function seriesB(q, c) {
  const b1 = 2 * c + 1;
  const b2 = 2 * c * b1 - 1;
  return 1 - q ** 2 * (b1 - q ** 4 * (b2 - q ** 6 * (2 * c * b2 - b1)));
}

/** z at the start: 0 at the lower turning point u1, half a period at the upper one, negative on the way down. */
function startArgument(start, { y1, y2, complement: kc }, q, halfPeriod) {
  let z;
  if (!(y1 < 0)) {
    z = 0;
  } else if (!(y2 > 0)) {
    z = halfPeriod;
  } else if (-y1 * kc <= y2) {
    z = inverseSc(q, Math.sqrt(-y1 / y2));
  } else {
    z = halfPeriod - inverseSc(q, Math.sqrt(-y2 / y1) / kc);
  }
  return start.uRate < 0 ? -z : z;
}

/**
 * The argument z <= H/2 at which sn/cn = `target`, by Newton's method in s = sinh(z):
 * s B(c) theta_3 = target C(0) theta_4(c) with c = cosh(2z) = 1 + 2 s^2.
 */
function inverseSc(q, target) {
  const mostIterations = 60;
  const scaled = (target * (1 + q ** 2 + q ** 6 + q ** 12)) / theta3Constant(q);
  // sinh(H/2) = (q^(-1/4) - q^(1/4))/2 bounds the result.
  let s = target;
  const root = Math.sqrt(Math.sqrt(q));
  if (2 * s * root > 1 - root ** 2) s = (1 - root ** 2) / (2 * root);
  for (let n = 0; n < mostIterations; n += 1) {
    const c = 1 + 2 * s ** 2;
    const theta4 = 1 - 2 * (q * c - q ** 4 * (2 * c ** 2 - 1) + q ** 9 * c * (4 * c ** 2 - 3));
    const theta4Slope = -2 * (q - q ** 4 * 4 * c + q ** 9 * (12 * c ** 2 - 3));
    const b = seriesB(q, c);
    const bSlope = -2 * q ** 2 * (1 - q ** 4 * (4 * c + 1));
    const step = -(s * b - scaled * theta4) / (b + 4 * s * (s * bSlope - scaled * theta4Slope));
    s += step;
    if (Math.abs(step) <= 2 * EPSILON * Math.abs(s)) break;
  }
  return Math.asinh(s);
}

/** The theta functions at the argument z, |z| <= H, scaled by exp(-|z|); fromTop is H - |z|. */
export function evaluateHyperbolicForm(form, z, fromTop) {
  // exp(-|z|) and exp(-y): the one that is closer to 1 is computed directly, the other from it.
  let [decay, climb] = [0, 0];
  if (Math.abs(z) < fromTop) {
    decay = Math.exp(-Math.abs(z));
    if (form.halfDecay > 0) climb = form.halfDecay / decay;
  } else {
    climb = Math.exp(-fromTop);
    decay = form.halfDecay / climb;
  }
  const e = decay ** 2;
  const p = climb ** 2;
  const { byZ, byY } = form;

  const oddZ = sign(rise(Math.abs(z), decay), z);
  const divisor = sumSeries(byZ.divisor, e, p);
  const upper = [sumSeries(byZ.upperEven, e, p), oddZ * sumSeries(byZ.upperOdd, e, p)];
  const upperSlope = [oddZ * sumSeries(byZ.upperEvenSlope, e, p), sumSeries(byZ.upperOddSlope, e, p)];

  const oddY = rise(fromTop, climb);
  const even = sumSeries(byY.lowerEven, p, e);
  const odd = -oddY * sumSeries(byY.lowerOdd, p, e);
  let lower = multiply(scale(decay, form.lowerTurn), [even, odd]);
  let lowerSlope = multiply(scale(decay, form.lowerTurn), [
    even - oddY * sumSeries(byY.lowerEvenSlope, p, e), odd + sumSeries(byY.lowerOddSlope, p, e),
  ]);
  if (z < 0) {
    lower = conjugate(lower);
    lowerSlope = scale(-1, conjugate(lowerSlope));
  }
  return {
    upper,
    lower,
    upperSlope,
    lowerSlope,
    divisor,
    divisorSlope: oddZ * sumSeries(byZ.divisorSlope, e, p),
    sn: (oddZ * sumSeries(byZ.sn, e, p)) / divisor,
    cn: (decay * oddY * sumSeries(byY.cn, p, e)) / divisor,
  };
}

/** A sum at e and p. */
function sumSeries({ near: a, far: b }, e, p) {
  return a[0] + p * (a[1] + p * (a[2] + p * a[3])) + e * (b[0] + e * (b[1] + e * (b[2] + e * b[3])));
}

/** 1 - exp(-2x), x >= 0, from the decay exp(-x), to full relative precision. */
function rise(x, decay) {
  if (x >= 0.25) return 1 - decay ** 2;
  // 2 exp(-x) sinh(x)
  return 2 * decay * x * (1 + (x ** 2 / 6) * (1 + (x ** 2 / 20) * (1 + (x ** 2 / 42)
    * (1 + (x ** 2 / 72) * (1 + x ** 2 / 110)))));
}
