// The exact solution in circular functions, for k^2 <= 1/2: src/exact/circular_form.f90.
//
// Jacobi's theta functions have the nome q = exp(-pi K'/K) <= 0.0433. X = 2 q cosh(2 v) of the position
// i v of a pole of the sphere is the solution of an equation, similar to a quadratic one, in the data.

import { EPSILON, quotient, sign } from "./arithmetic.js";
import { HALF_PI, newClock, nome, theta3Constant } from "./theta_functions.js";

/** Highest multiple of 2z in the series; the next term is at most 4e-17. */
const LAST = 3;
const ALTERNATING = [-1, 1, -1, 1]; // (-1)^n for n = 1 ... LAST + 1

/** Prepares clock and series of a motion with k^2 <= 1/2. */
export function prepareCircularForm(start, points) {
  const {
    kSquared: k2, complement: kc, u2MinusU1: d, oneMinusU1: m1, oneMinusU2: d2, onePlusU1: p1, onePlusU2: p2,
    betaU3MinusU1: betaU, betaU3Minus1: betaD3,
  } = points;
  const clock = newClock();
  const q = nome(k2, kc);
  const theta3 = theta3Constant(q);
  const theta4 = Math.sqrt(kc) * theta3;
  clock.rate = points.frequency / theta3 ** 2;
  clock.period = Math.PI;
  clock.halfPeriod = HALF_PI;

  // The poles theta = pi, below the motion, and theta = 0, above it.
  let x = solvePosition(q, quotient(d + (p1 * k2) / (1 + kc), (Math.sqrt(p2) + Math.sqrt(p1 * kc)) ** 2));
  const bottom = poleAt(q, x, Math.sqrt(kc) * Math.sqrt(quotient(betaU, points.betaU3Plus1)));
  x = solvePosition(q, quotient((d * betaD3) / betaU + kc * d, (1 + kc) * (Math.sqrt(m1 * kc) + Math.sqrt(d2)) ** 2));
  const top = poleAt(q, x, Math.sqrt(kc) * Math.sqrt(quotient(betaD3, points.complementSquared * betaU)));

  const upperSign = sign(1, start.bPlusA);
  const lowerSign = sign(1, start.bMinusA);
  clock.upperRate = quotient(start.bPlusA, 2 * p2) + upperSign * clock.rate * bottom.slope;
  clock.lowerRate = quotient(start.bMinusA, 2 * m1) + lowerSign * clock.rate * top.slope;
  clock.sumRate = clock.upperRate + clock.lowerRate;
  // A fast top precesses slowly: the two rates nearly cancel.
  if (d2 > m1 / 4) {
    clock.sumRate = (start.turn - start.a * points.y2) / (p2 * d2)
      + clock.rate * (upperSign * bottom.slope - lowerSign * slopeAtTop(q, top));
  }

  clock.upperAmplitude = (Math.sqrt(p2 / 2) * theta3) / bottom.norm;
  clock.lowerAmplitude = (Math.sqrt(m1 / 2) * theta4) / top.norm;
  clock.start = startArgument(start, points, q);
  const form = {
    upperLeast: Math.sqrt(quotient(p1 * kc, p2)) * bottom.norm,
    lowerLeast: quotient(Math.sqrt(d2) * top.norm, Math.sqrt(m1 * kc)),
    powers: tabulate(q, bottom, top, upperSign, lowerSign, theta3, theta4),
  };
  return { clock, form };
}

/** Turns the Fourier series of the theta functions into polynomials in cos 2z. */
function tabulate(q, bottom, top, upperSign, lowerSign, theta3, theta4) {
  const flip = [1, -1, 1, -1]; // a polynomial in -cos 2z: where z is counted from the top
  const series = [1, 2, 3];
  // U = constant + sum [upEven cos 2nz - i upOdd sin 2nz], W = 1 + sum w cos 2nz; L as U, its even part
  // counted from the top.
  const power = series.map((n) => ALTERNATING[n - 1] * q ** (n * n - n));
  const upEven = series.map((n) => power[n - 1] * bottom.sums[n - 1]);
  const upOdd = series.map((n) => power[n - 1] * upperSign * bottom.differences[n - 1]);
  const lowEven = series.map((n) => power[n - 1] * top.sums[n - 1]);
  const lowOdd = series.map((n) => ALTERNATING[n - 1] * power[n - 1] * lowerSign * top.differences[n - 1]);
  const w = series.map((n) => 2 * ALTERNATING[n - 1] * q ** (n * n));
  const twice = (a) => a.map((value, i) => 2 * (i + 1) * value);
  const flipped = (a) => a.map((value, i) => flip[i] * value);

  // sn W = theta_3/theta_2 sum (-1)^n q^(n(n+1)) sin (2n+1)z, in which
  // sin (2n+1)z = sin z [1 + 2 sum_{m<=n} cos 2mz]. cn likewise from the top.
  const theta2 = 1 + q ** 2 + q ** 6 + q ** 12;
  const terms = flip.map((f, n) => f * ((q ** (n * (n + 1)) * theta3) / theta2));
  const sn = ofCosines(
    terms[0] + terms[1] + terms[2] + terms[3],
    [2 * (terms[1] + terms[2] + terms[3]), 2 * (terms[2] + terms[3]), 2 * terms[3]],
  );
  return {
    upperEven: ofSquares(upEven),
    upperOdd: ofSines(upOdd),
    lowerEven: flipped(ofSquares(lowEven)),
    lowerOdd: ofSines(lowOdd),
    upperEvenSlope: ofSines(twice(upEven)),
    upperOddSlope: ofCosines(0, twice(upOdd)),
    lowerEvenSlope: ofSines(twice(lowEven.map((value, i) => ALTERNATING[i] * value))),
    lowerOddSlope: ofCosines(0, twice(lowOdd)),
    divisor: ofCosines(1, w),
    divisorSlope: ofSines(twice(w)),
    sn,
    cn: flipped(sn).map((value) => (theta4 / theta3) * value),
  };
}

/** constant + sum a(n) cos 2nz in powers of cos 2z. */
function ofCosines(constant, [a1, a2, a3]) {
  return [constant - a2, a1 - 3 * a3, 2 * a2, 4 * a3];
}

/** sum a(n) sin 2nz / sin 2z in powers of cos 2z. */
function ofSines([a1, a2, a3]) {
  return [a1 - a3, 2 * a2, 4 * a3, 0];
}

/** 2 sum a(n) sin(nz)^2 / sin(z)^2 in powers of cos 2z. */
function ofSquares([a1, a2, a3]) {
  return [2 * a1 + 4 * a2 + 2 * a3, 4 * a2 + 8 * a3, 8 * a3, 0];
}

/** z at the start: 0 at the lower turning point u1, pi/2 at the upper one, negative on the way down. */
function startArgument(start, points, q) {
  let z;
  if (!(points.y1 < 0)) {
    z = 0;
  } else if (!(points.y2 > 0)) {
    z = HALF_PI;
  } else {
    const kc = points.complement;
    const sn2 = -points.y1 / points.u2MinusU1;
    const dn = Math.sqrt(1 - points.kSquared * sn2);
    // The same equation as for the poles, with X = 2 q cos(2 z).
    const x = solvePosition(q, (points.kSquared * (1 / (1 + kc) - sn2)) / (dn + Math.sqrt(kc)) ** 2);
    z = Math.atan(Math.sqrt(kc) * Math.sqrt(-points.y1 / points.y2) * ratioOfThetas(q, x));
  }
  return start.uRate < 0 ? -z : z;
}

/**
 * Solves sum_{n odd} q^(n^2-n) h_n = excess (1 + sum_{n even} q^(n^2-n) h_n) for X = h_1, with
 * h_n = 2 q^n cosh(2 n v), by Newton's method.
 */
function solvePosition(q, excess) {
  const mostIterations = 30;
  const q2 = q ** 2;
  const q6 = q2 ** 3;
  const q12 = q6 ** 2;
  // The quadratic X - excess (1 - 2 q^4 + q^2 X^2) = 0 by its series.
  const scale = Math.max(1 - 2 * q2 ** 2, 0.2);
  const r = Math.min(excess ** 2 * q2 * scale, 0.2);
  let x = excess * scale * (1 + r * (1 + r * (2 + r * (5 + r * (14 + r * 42)))));
  for (let n = 0; n < mostIterations; n += 1) {
    const odd = x * (1 + q6 * (x ** 2 - 3 * q2));
    const even = 1 + q2 * (x ** 2 - 2 * q2) + q12 * (x ** 4 - 4 * q2 * x ** 2 + 2 * q2 ** 2);
    const oddSlope = 1 + q6 * 3 * (x ** 2 - q2);
    const evenSlope = x * (2 * q2 + q12 * 4 * (x ** 2 - 2 * q2));
    const step = -(odd - excess * even) / (oddSlope - excess * evenSlope);
    x += step;
    if (Math.abs(step) <= 8 * EPSILON * Math.abs(x)) break;
  }
  return x;
}

/**
 * A/B with A = 1 + sum q^(n^2) a_n and B = 1 + sum (-1)^n q^(n^2) b_n, the theta functions that carry
 * sn/cn at the position X.
 */
function ratioOfThetas(q, x) {
  const a = [1, x - q];
  const b = [1, x + q];
  for (let n = 1; n <= LAST; n += 1) {
    a.push(x * a[n] - q ** 2 * a[n - 1]);
    b.push(x * b[n] - q ** 2 * b[n - 1]);
  }
  let [numerator, denominator] = [1, 1];
  for (let n = 1; n <= LAST + 1; n += 1) {
    numerator += q ** (n * n) * a[n];
    denominator += ALTERNATING[n - 1] * q ** (n * n) * b[n];
  }
  return numerator / denominator;
}

/**
 * A pole from its position X = 2 q cosh(2 v); `scale` is sqrt(k') times the pole's sc(i v) without its i.
 * Of w = q exp(2 v): w^n +- (q^2/w)^n for n = 1 ...; the pole's theta function at u = u2 (u1) and its
 * logarithmic derivative there.
 */
function poleAt(q, x, scale) {
  // Not sqrt(X^2 - 4 q^2): that loses half the digits near v = 0.
  const difference = (x + 2 * q) * scale * ratioOfThetas(q, x);
  const w = (x + difference) / 2;
  const sums = [w + quotient(q ** 2, w)];
  const differences = [difference];
  sums.push(x * sums[0] - 2 * q ** 2);
  differences.push(x * difference);
  for (let n = 2; n <= LAST; n += 1) {
    sums.push(x * sums[n - 1] - q ** 2 * sums[n - 2]);
    differences.push(x * differences[n - 1] - q ** 2 * differences[n - 2]);
  }
  let [norm, slope] = [1, 0];
  for (let n = 1; n <= LAST + 1; n += 1) {
    norm += q ** (n * n - n) * sums[n - 1];
    slope += n * q ** (n * n - n) * differences[n - 1];
  }
  return { sums, differences, norm, slope: (2 * slope) / norm };
}

/** The logarithmic derivative of the upper pole's theta function at u2 instead of u1. */
function slopeAtTop(q, top) {
  let [numerator, denominator] = [0, 1];
  for (let n = 1; n <= LAST + 1; n += 1) {
    const power = ALTERNATING[n - 1] * q ** (n * n - n);
    numerator += n * power * top.differences[n - 1];
    denominator += power * top.sums[n - 1];
  }
  return (-2 * numerator) / denominator;
}

function polynomial(c, x) {
  return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

/**
 * The theta functions at the argument z, |z| <= pi/2; fromTop is pi/2 - |z|. U and L are written from
 * their least values: no digit is lost close to a pole.
 */
export function evaluateCircularForm(form, z, fromTop) {
  const near = Math.sin(Math.min(Math.abs(z), fromTop));
  const far = Math.cos(Math.min(Math.abs(z), fromTop));
  const isLow = Math.abs(z) <= fromTop;
  const sine = sign(isLow ? near : far, z);
  const cosine = isLow ? far : near;
  const cosine2z = (cosine - sine) * (cosine + sine);
  const sine2z = 2 * sine * cosine;
  const { powers } = form;
  const divisor = polynomial(powers.divisor, cosine2z);
  return {
    upper: [
      form.upperLeast - sine ** 2 * polynomial(powers.upperEven, cosine2z),
      -sine2z * polynomial(powers.upperOdd, cosine2z),
    ],
    lower: [
      form.lowerLeast - cosine ** 2 * polynomial(powers.lowerEven, cosine2z),
      -sine2z * polynomial(powers.lowerOdd, cosine2z),
    ],
    upperSlope: [
      -sine2z * polynomial(powers.upperEvenSlope, cosine2z), -polynomial(powers.upperOddSlope, cosine2z),
    ],
    lowerSlope: [
      -sine2z * polynomial(powers.lowerEvenSlope, cosine2z), -polynomial(powers.lowerOddSlope, cosine2z),
    ],
    divisor,
    divisorSlope: -sine2z * polynomial(powers.divisorSlope, cosine2z),
    sn: (sine * polynomial(powers.sn, cosine2z)) / divisor,
    cn: (cosine * polynomial(powers.cn, cosine2z)) / divisor,
  };
}
