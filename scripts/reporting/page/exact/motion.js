// Body and start of a symmetric top: `body_t`, `motion_t` and what of `spintop_attitude` they need
// (src/top). Angles are phi, theta, psi; quaternions have their scalar part first and turn body axes
// into space axes. SI units, radians.

/**
 * A body that is symmetric about body z: moments of inertia about the pivot, across and along z; mass;
 * height of the centre of mass on body z; gravity.
 */
export function makeBody({ inertia1, inertia3, mass = 1, length = 0, gravity = 9.81 }) {
  return { inertia1, inertia3, mass, length, gravity, mgl: mass * gravity * length };
}

/**
 * A start from angles and rates. Instead of psi' the angular velocity about body z may be given, as
 * `omega3`; it is then exact, as in an input that gives initial.omega3.
 */
export function startFromAngles({ t = 0, phi = 0, theta, psi = 0, phiRate = 0, thetaRate = 0, psiRate, omega3 }) {
  const givesOmega3 = omega3 !== undefined;
  const angle = [phi, theta, psi];
  const rate = [phiRate, thetaRate, givesOmega3 ? omega3 - phiRate * Math.cos(theta) : (psiRate ?? 0)];
  const omega = omegaFromRates(angle, rate);
  if (givesOmega3) omega[2] = omega3;
  return {
    t, angle, rate, omega, quaternion: quaternionFromAngles(angle),
    givesQuaternion: false, givesOmega: false, givesOmega3,
  };
}

/** Unit quaternion of the angles. */
export function quaternionFromAngles([phi, theta, psi]) {
  const plus = circularOfHalf(phi, psi);
  const minus = circularOfHalf(phi, -psi);
  const half = theta / 2;
  const [c, s] = [Math.cos(half), Math.sin(half)];
  return [c * plus[0], s * minus[0], s * minus[1], c * plus[1]];
}

/** cos((a + b)/2) and sin((a + b)/2), with the rounding error of a + b corrected. */
function circularOfHalf(a, b) {
  const total = a + b;
  const part = total - a;
  const lost = ((a - (total - part)) + (b - part)) / 2; // half the rounding error of the sum, exact (Knuth)
  const [c, s] = [Math.cos(total / 2), Math.sin(total / 2)];
  return [c - lost * s, s + lost * c];
}

/** Angular velocity in body axes from the rates of the angles. */
export function omegaFromRates([, theta, psi], [phiRate, thetaRate, psiRate]) {
  const across = phiRate * Math.sin(theta);
  return [
    across * Math.sin(psi) + thetaRate * Math.cos(psi),
    across * Math.cos(psi) - thetaRate * Math.sin(psi),
    phiRate * Math.cos(theta) + psiRate,
  ];
}

/** A vector in space axes, from one in body axes: q v conj(q), written out. */
export function toSpace([w, x, y, z], [a, b, c]) {
  const [p, q, r] = [y * c - z * b + w * a, z * a - x * c + w * b, x * b - y * a + w * c];
  return [a + 2 * (y * r - z * q), b + 2 * (z * p - x * r), c + 2 * (x * q - y * p)];
}
