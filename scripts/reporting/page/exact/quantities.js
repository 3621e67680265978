// Energies, momenta and the support force of a motion: src/top/quantities.f90, for a symmetric top; and the
// effective potential of its inclination.

import { toSpace } from "./motion.js";

/** Kinetic energy, J. */
export function kineticEnergy(body, { omega: [a, b, c] }) {
  return (body.inertia1 * (a * a + b * b) + body.inertia3 * c * c) / 2;
}

/** Potential energy above the height of the pivot, J. */
export function potentialEnergy(body, { angle }) {
  return body.mgl * Math.cos(angle[1]);
}

/** Angular momentum about the pivot in space axes, kg m^2/s. */
export function angularMomentum(body, { omega: [a, b, c], quaternion }) {
  return toSpace(quaternion, [body.inertia1 * a, body.inertia1 * b, body.inertia3 * c]);
}

/** Support force on the body in space axes, N: mass times acceleration, minus the weight. */
export function supportForce(body, { omega: [a, b, c], omegaRate: [da, db], quaternion }) {
  const l = body.length;
  // omega' x r + omega x (omega x r), r = (0, 0, l)
  const force = toSpace(quaternion, [l * (db + a * c), l * (b * c - da), -l * (a * a + b * b)]);
  return [body.mass * force[0], body.mass * force[1], body.mass * (force[2] + body.gravity)];
}

/**
 * The effective potential of the inclination, J: m g l cos(theta) + (Lz - L3 cos(theta))^2/(2 I1 sin(theta)^2).
 * With kinetic energy I1 theta'^2/2 it gives the energy without that of the axial spin, L3^2/(2 I3).
 */
export function effectivePotential(exact, theta) {
  const { body, start } = exact;
  const [s, c] = [Math.sin(theta / 2), Math.cos(theta / 2)];
  // b - a u = (b - a) + a (1 - u) = (b + a) - a (1 + u): the form that cancels less.
  const turn = theta < Math.PI / 2 ? start.bMinusA + 2 * start.a * s * s : start.bPlusA - 2 * start.a * c * c;
  const sine = 2 * s * c;
  const barrier = Math.abs(turn) > 0 ? (body.inertia1 * turn ** 2) / (2 * sine ** 2) : 0;
  return body.mgl * Math.cos(theta) + barrier;
}

/** The energy without that of the axial spin, J, in the same terms. */
export function swingEnergy(exact) {
  const { body, start } = exact;
  return body.mgl * start.u + (body.inertia1 * start.swingSquared) / 2;
}
