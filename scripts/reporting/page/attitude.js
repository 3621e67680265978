// Euler's angles z-x-z (phi precession, theta inclination, psi spin; radians) and unit quaternions
// that turn body axes into space axes.

import { Quaternion } from "three";

const TURN = 2 * Math.PI;

/** The attitude with these angles. */
export function fromAngles(phi, theta, psi) {
  const c = Math.cos(theta / 2);
  const s = Math.sin(theta / 2);
  const sum = (phi + psi) / 2;
  const difference = (phi - psi) / 2;
  return new Quaternion(
    s * Math.cos(difference),
    s * Math.sin(difference),
    c * Math.sin(sum),
    c * Math.cos(sum),
  );
}

/**
 * The angles of an attitude: theta from 0 to pi, phi and psi within half a turn. Where the axis is
 * vertical phi and psi do not exist apart; then all of the turn is put into phi.
 */
export function toAngles({ x, y, z, w }) {
  const [across, along] = [Math.hypot(x, y), Math.hypot(z, w)];
  const theta = 2 * Math.atan2(across, along);
  const halfSum = Math.atan2(z, w);
  const halfDifference = Math.atan2(y, x);
  if (across === 0) return [withinHalfTurn(2 * halfSum), theta, 0];
  if (along === 0) return [withinHalfTurn(2 * halfDifference), theta, 0];
  return [withinHalfTurn(halfSum + halfDifference), theta, withinHalfTurn(halfSum - halfDifference)];
}

/** The same angle from -pi to pi. */
export function withinHalfTurn(angle) {
  return angle - TURN * Math.round(angle / TURN);
}

/** The same angle as near as can be to another. */
export function nearTo(angle, other) {
  return angle + TURN * Math.round((other - angle) / TURN);
}

/** The turn by an angle about a unit vector. */
export function turnAbout(axis, angle) {
  return new Quaternion().setFromAxisAngle(axis, angle);
}

/** How far a turn goes about a unit vector, if the rest of it moves that vector as little as can be. */
export function twistOf({ x, y, z, w }, axis) {
  return 2 * Math.atan2(x * axis.x + y * axis.y + z * axis.z, w);
}
