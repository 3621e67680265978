// What the two forms of the exact solution share: src/exact/theta_functions.f90.
//
// Both write the Cayley-Klein components as a steady rotation times a ratio of theta functions of an
// argument z that grows uniformly with time,
//
//     upper = amplitude exp(i phase) U(z)/W(z),    phase = constant + rate t
//
// (lower alike), and u = u1 + (u2-u1) sn^2. They differ in the series for U, L, W: one form in circular
// functions of z, for k^2 <= 1/2, one in hyperbolic functions, for k^2 > 1/2, of the complementary
// modulus. So every nome is at most exp(-pi) = 0.0433, and a few terms of a series suffice.

/** Growth of argument and phases with time; the names are those of `theta_clock_t`. */
export function newClock() {
  return {
    start: 0, rate: 0, period: 0, halfPeriod: 0,
    upperRate: 0, lowerRate: 0, sumRate: 0, upperStep: 0, lowerStep: 0,
    upperAmplitude: 1, lowerAmplitude: 0,
  };
}

export const HALF_PI = Math.PI / 2;

/** The coefficients of the series of the nome in the fourth power of its leading term. */
const NOME_COEFFICIENTS = [1, 2, 15, 150, 1707, 20910];

/** Nome q = exp(-pi K'/K) from k^2 <= 1/2 and the complementary modulus k'. */
export function nome(kSquared, complement) {
  const leading = kSquared / (2 * (1 + complement) * (1 + Math.sqrt(complement)) ** 2);
  const t = leading ** 4;
  return leading * NOME_COEFFICIENTS.reduceRight((q, coefficient) => coefficient + q * t, 0);
}

/** The constant theta_3(q) = 1 + 2 q + 2 q^4 + 2 q^9 + ... */
export function theta3Constant(q) {
  return 1 + 2 * (q + q ** 4 + q ** 9);
}
