// What the Fortran of src/exact takes from its language and from src/foundation: signs, quotients and
// complex numbers, which are pairs [real, imaginary] here.

export const EPSILON = 2 ** -52;

/** |a| with the sign of b, that of a negative zero included: Fortran's `sign`. */
export function sign(a, b) {
  return b < 0 || Object.is(b, -0) ? -Math.abs(a) : Math.abs(a);
}

/** a/b, with 0/0 = 0: the limits of the exact solution at rest, at a pole and without gravity. */
export function quotient(a, b) {
  return Math.abs(a) > 0 ? a / b : 0;
}

/** a modulo b with the sign of b: Fortran's `modulo`. */
export function modulo(a, b) {
  return a - b * Math.floor(a / b);
}

/** The nearest integer; halves away from zero, as Fortran's `anint`. */
export function anint(x) {
  return Math.sign(x) * Math.round(Math.abs(x));
}

export function add(x, y) {
  return [x[0] + y[0], x[1] + y[1]];
}

export function subtract(x, y) {
  return [x[0] - y[0], x[1] - y[1]];
}

export function multiply(x, y) {
  return [x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]];
}

/** A real number times a complex one. */
export function scale(r, z) {
  return [r * z[0], r * z[1]];
}

/** i z */
export function timesI(z) {
  return [-z[1], z[0]];
}

export function conjugate(z) {
  return [z[0], -z[1]];
}

/** exp(i phase) */
export function unit(phase) {
  return [Math.cos(phase), Math.sin(phase)];
}

/** The angle of a complex number, rad; 0 of zero. */
export function argument(z) {
  return z[0] === 0 && z[1] === 0 ? 0 : Math.atan2(z[1], z[0]);
}

/** |z| */
export function modulus(z) {
  return Math.sqrt(squared(z));
}

/** |z|^2 */
export function squared(z) {
  return z[0] * z[0] + z[1] * z[1];
}
