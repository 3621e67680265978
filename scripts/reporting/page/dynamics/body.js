// A body on its pivot, and how its motion starts. Angles are phi, theta, psi (z-x-z); quaternions have their
// scalar part first and turn body axes into space axes. SI units, radians. No page here.

const WITHIN_ROUNDING = 1e-12; // numbers of a body that differ by less than this part are equal

/**
 * A body: mass; elements 11, 22, 33 (`inertia`) and 23, 31, 12 (`products`) of its tensor of inertia about the
 * pivot; centre of mass, in body axes; gravity; viscous damping about body x, y, z; dry moment of the pivot; and
 * the amplitude and the rate at which the pivot vibrates along the vertical, z = amplitude cos(rate t).
 */
export function makeBody({
  mass, inertia, products = [0, 0, 0], centre, gravity = 9.81, damping = [0, 0, 0], friction = 0, amplitude = 0,
  vibrationRate = 0,
}) {
  const [a, b, c] = inertia;
  const largest = Math.max(a, b, c);
  const isSmall = (value, size) => Math.abs(value) <= WITHIN_ROUNDING * size;
  const isVibrated = amplitude * vibrationRate !== 0;
  const isSymmetric = isSmall(a - b, largest) && products.every((value) => isSmall(value, largest))
    && centre.slice(0, 2).every((value) => isSmall(value, Math.abs(centre[2])));
  const isConservative = !isVibrated && friction === 0 && damping.every((value) => value === 0);
  return {
    mass, inertia, products, centre, gravity, damping, friction, amplitude, vibrationRate, isVibrated, isSymmetric,
    isConservative,
    /** The symmetric top under gravity alone, its centre of mass at the pivot or above: energy, Lz and L3 are constant. */
    isLagrange: isSymmetric && isConservative && centre[2] >= 0,
    tensor: symmetric(inertia, products),
    inverse: inverseOf(inertia, products),
    inertia1: a,
    inertia3: c,
    mgl: mass * gravity * centre[2],
    /** The rate of small swings, rad/s; of the order of 1/s without weight. */
    naturalRate: Math.sqrt((mass * gravity * Math.hypot(...centre)) / largest),
  };
}

/** A symmetric matrix as three rows, from its elements 11, 22, 33 and 23, 31, 12. */
export function symmetric([a, b, c], [p, q, r]) {
  return [[a, r, q], [r, b, p], [q, p, c]];
}

function inverseOf([a, b, c], [p, q, r]) {
  const minors = [b * c - p * p, c * a - q * q, a * b - r * r];
  const others = [q * r - a * p, r * p - b * q, p * q - c * r];
  const determinant = a * minors[0] + r * others[2] + q * others[1];
  const part = (value) => value / determinant;
  return symmetric(minors.map(part), others.map(part));
}

/** Whether a tensor of inertia is one of a body: positive definite. */
export function isPossible([a, b, c], [p, q, r]) {
  return a > 0 && a * b > r * r && a * (b * c - p * p) + r * (p * q - c * r) + q * (r * p - b * q) > 0;
}

/** A matrix of three rows times a vector. */
export function times([p, q, r], [x, y, z]) {
  return [p[0] * x + p[1] * y + p[2] * z, q[0] * x + q[1] * y + q[2] * z, r[0] * x + r[1] * y + r[2] * z];
}

export function cross([a, b, c], [x, y, z]) {
  return [b * z - c * y, c * x - a * z, a * y - b * x];
}

/** A start from angles and rates; `omega3` is the angular velocity about body z. */
export function startFromAngles({ phi = 0, theta, psi = 0, phiRate = 0, thetaRate = 0, omega3 }) {
  const angle = [phi, theta, psi];
  const [omega1, omega2] = omegaOf(angle, [phiRate, thetaRate, 0]);
  return {
    angle,
    quaternion: quaternionFromAngles(angle),
    omega: [omega1, omega2, omega3],
    phiRate,
  };
}

/** The angular velocity in body axes, from the angles and their rates. */
export function omegaOf([, theta, psi], [phiRate, thetaRate, psiRate]) {
  const [c, s, across] = [Math.cos(psi), Math.sin(psi), phiRate * Math.sin(theta)];
  return [across * s + thetaRate * c, across * c - thetaRate * s, phiRate * Math.cos(theta) + psiRate];
}

/** phi', theta', psi' from the angles and the angular velocity; NaN nearer to a pole, as a sine, than it says. */
export function ratesOf([, theta, psi], [u, v, w], pole) {
  const [c, s, sine] = [Math.cos(psi), Math.sin(psi), Math.sin(theta)];
  const precession = sine > pole ? (u * s + v * c) / sine : NaN;
  return [precession, u * c - v * s, w - precession * Math.cos(theta)];
}

/** Unit quaternion of the angles. */
export function quaternionFromAngles([phi, theta, psi]) {
  const [plus, minus] = [(phi + psi) / 2, (phi - psi) / 2];
  // The double nearest to pi means pi exactly, not an inclination 1e-16 away from it.
  const [c, s] = [theta === Math.PI ? 0 : Math.cos(theta / 2), Math.sin(theta / 2)];
  return [c * Math.cos(plus), s * Math.cos(minus), s * Math.sin(minus), c * Math.sin(plus)];
}

/** A vector in space axes, from one in body axes: q v conj(q), written out. */
export function toSpace([w, x, y, z], [a, b, c]) {
  const [p, q, r] = [y * c - z * b + w * a, z * a - x * c + w * b, x * b - y * a + w * c];
  return [a + 2 * (y * r - z * q), b + 2 * (z * p - x * r), c + 2 * (x * q - y * p)];
}

/** The upward vertical in body axes. */
export function verticalOf([w, x, y, z]) {
  return [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z];
}
