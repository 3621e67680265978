// Steady motion of a symmetric top: precession at a constant inclination and spin, and the sleeping top:
// src/exact/steady_motion.f90.

/**
 * Rates of steady precession at an inclination for a given axial angular velocity, rad/s: the roots of
 * I1 cos(theta) p^2 - I3 omega3 p + mgl = 0, slow one first. None below the smallest possible omega3, one
 * where the fast one is infinite.
 */
export function steadyRates(body, theta, omega3) {
  return precessionRoots(body.inertia1 * Math.cos(theta), body.inertia3 * omega3, body.mgl);
}

/**
 * Threshold spin of the sleeping top: the least omega3 at which an upright symmetric top is stable,
 * sqrt(4 mgl I1)/I3, rad/s.
 */
export function criticalOmega3(body) {
  return (2 * Math.sqrt(body.mgl * body.inertia1)) / body.inertia3;
}

/** Roots of a p^2 - b p + c = 0 with c >= 0, without cancellation; the one that stays finite for a = 0 first. */
function precessionRoots(a, b, c) {
  const discriminant = b ** 2 - 4 * a * c;
  if (discriminant < 0) return [];
  const larger = b + (b < 0 ? -1 : 1) * Math.sqrt(discriminant);
  if (larger === 0) return [];
  return a === 0 ? [(2 * c) / larger] : [(2 * c) / larger, larger / (2 * a)];
}
