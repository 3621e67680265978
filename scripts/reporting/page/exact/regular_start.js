// The start of a symmetric top in quantities that stay regular at the poles: src/exact/regular_start.f90.
//
// Symbols: u = cos(theta); a = I3 omega3/I1; beta = 2 m g l/I1; b = Lz/I1; the attitude as the two
// Cayley-Klein components
//
//     upper = q0 + i q3 = cos(theta/2) exp(i (phi + psi)/2)
//     lower = q1 + i q2 = sin(theta/2) exp(i (phi - psi)/2)
//
// which vanish at theta = pi and at theta = 0. With swing = omega1 + i omega2 they obey
//
//     upper' = i omega3/2 upper - lower conj(swing)/2,   lower' = upper swing/2 - i omega3/2 lower

import { conjugate, multiply, scale, squared, subtract, timesI, unit } from "./arithmetic.js";

/**
 * If the rates of phi and psi exceed the angular velocity by this factor, they cancel each other (the
 * axis is close to a pole), and the angular velocity is more accurate.
 */
const CANCELLING_RATIO = 16;

/** Half the rate of the spin that is linear in time, (omega3 - a)/2, rad/s. */
export function halfOf(start) {
  return (start.omega3 - start.a) / 2;
}

/** The data of the closed form from body and start. */
export function findRegularStart(body, start) {
  const regular = ratesDescribe(start) ? takeAngles(start) : takeQuaternion(start);
  regular.turnsAgainstAngles = opposes(start.quaternion, regular);
  regular.time = start.t;
  regular.a = (body.inertia3 / body.inertia1) * regular.omega3;
  regular.beta = (2 * body.mgl) / body.inertia1;
  const { a, upper, lower, swing } = regular;
  regular.bMinusA = regular.turn - regular.oneMinusU * a;
  regular.bPlusA = regular.turn + regular.onePlusU * a;
  regular.upperRate = scale(0.5, subtract(scale(a, timesI(upper)), multiply(lower, conjugate(swing))));
  regular.lowerRate = scale(0.5, subtract(multiply(upper, swing), scale(a, timesI(lower))));
  regular.upperPhase = (start.angle[0] + start.angle[2]) / 2;
  regular.lowerPhase = (start.angle[0] - start.angle[2]) / 2;
  return regular;
}

/** Whether angles and rates are the more accurate description of the start; else quaternion and omega are. */
function ratesDescribe(start) {
  const [, theta] = start.angle;
  return theta >= 0 && theta <= Math.PI && start.rate.every(Number.isFinite)
    && Math.max(...start.rate.map(Math.abs)) <= CANCELLING_RATIO * Math.max(...start.omega.map(Math.abs))
    && !(start.givesQuaternion && start.givesOmega);
}

function takeAngles(start) {
  const [phi, theta, psi] = start.angle;
  const [phiRate, thetaRate, psiRate] = start.rate;
  const halfSine = Math.sin(theta / 2);
  // The double nearest to pi means pi exactly, not an inclination 1e-16 away from it.
  const halfCosine = theta >= Math.PI ? 0 : Math.cos(theta / 2);
  const sine = 2 * halfSine * halfCosine;

  const oneMinusU = 2 * halfSine ** 2;
  const onePlusU = 2 * halfCosine ** 2;
  const u = (onePlusU - oneMinusU) / 2;
  const sineSquared = sine ** 2;
  const omega3 = start.givesOmega3 || start.givesOmega ? start.omega[2] : psiRate + phiRate * u;
  const uRate = -sine * thetaRate;
  const swingSquared = thetaRate ** 2 + (sine * phiRate) ** 2;
  const turn = sineSquared * phiRate;

  const upperTurn = unit((phi + psi) / 2);
  const lowerTurn = unit((phi - psi) / 2);
  const upper = scale(halfCosine, upperTurn);
  const lower = scale(halfSine, lowerTurn);
  const swing = multiply(multiply([thetaRate, phiRate * sine], lowerTurn), conjugate(upperTurn));
  return { oneMinusU, onePlusU, u, sineSquared, omega3, uRate, swingSquared, turn, upper, lower, swing };
}

function takeQuaternion(start) {
  const length = Math.hypot(...start.quaternion);
  const flip = opposesAngles(start) ? -1 : 1;
  const q = start.quaternion.map((value) => (flip * value) / length);
  const upper = [q[0], q[3]];
  const lower = [q[1], q[2]];
  const swing = [start.omega[0], start.omega[1]];

  const oneMinusU = 2 * squared(lower);
  const onePlusU = 2 * squared(upper);
  const u = (onePlusU - oneMinusU) / 2;
  const sineSquared = oneMinusU * onePlusU;
  const omega3 = start.omega[2];
  const swingSquared = squared(swing);
  // The transverse angular velocity relative to the vertical in body axes, Gamma1 + i Gamma2.
  const along = multiply(conjugate(scale(2, timesI(multiply(lower, conjugate(upper))))), swing);
  const [turn, uRate] = along;
  return { oneMinusU, onePlusU, u, sineSquared, omega3, uRate, swingSquared, turn, upper, lower, swing };
}

/** Whether the quaternion has the sign opposite to that of the angles (q and -q are one attitude). */
function opposesAngles({ quaternion: q, angle: [phi, , psi] }) {
  const [plus, minus] = [(phi + psi) / 2, (phi - psi) / 2];
  return Math.hypot(q[0], q[3]) > Math.hypot(q[1], q[2])
    ? q[0] * Math.cos(plus) + q[3] * Math.sin(plus) < 0
    : q[1] * Math.cos(minus) + q[2] * Math.sin(minus) < 0;
}

/** Whether a quaternion is the negative of the components. */
function opposes(q, { upper, lower }) {
  return upper[0] * q[0] + upper[1] * q[3] + lower[0] * q[1] + lower[1] * q[2] < 0;
}
