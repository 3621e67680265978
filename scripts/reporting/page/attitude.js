// Euler's angles z-x-z (phi precession, theta inclination, psi spin; radians) and unit quaternions
// that turn body axes into space axes.

import { Quaternion } from "three";
import { quaternionFromAngles } from "./dynamics/body.js";
import { nearTo } from "./dynamics/numbers.js";

/** The attitude with these angles. */
export function fromAngles(phi, theta, psi) {
  const [w, ...vector] = quaternionFromAngles([phi, theta, psi]);
  return new Quaternion(...vector, w);
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
  if (across === 0) return [nearTo(2 * halfSum, 0), theta, 0];
  if (along === 0) return [nearTo(2 * halfDifference, 0), theta, 0];
  return [nearTo(halfSum + halfDifference, 0), theta, nearTo(halfSum - halfDifference, 0)];
}

/** The turn by an angle about a unit vector. */
export function turnAbout(axis, angle) {
  return new Quaternion().setFromAxisAngle(axis, angle);
}

/** How far a turn goes about a unit vector, if the rest of it moves that vector as little as can be. */
export function twistOf({ x, y, z, w }, axis) {
  return 2 * Math.atan2(x * axis.x + y * axis.y + z * axis.z, w);
}
