// What of the motion of a symmetric top under gravity alone does not depend on time: its class, the range of the
// inclination, the period. With u = cos(theta), a = L3/I1, b = Lz/I1, beta = 2 m g l/I1 and the energy of the
// nutation alpha = theta'^2 + sin(theta)^2 phi'^2 + beta u,
//
//     u'^2 = (1 - u^2)(alpha - beta u) - (b - a u)^2
//
// is a cubic whose roots u1 <= u2 <= 1 <= u3 are the turning points. The period, an elliptic integral, is
// 2 pi over the arithmetic-geometric mean of sqrt(beta (u3 - u1)) and sqrt(beta (u3 - u2)).

const ROUNDING = 32 * Number.EPSILON; // of data, in units of their largest terms
const UNSURE = 1e-13; // of k'^2 and of a nutation: closer roots are equal

/** The arithmetic-geometric mean of two numbers; 0 if one is. */
function meanOf(a, b) {
  let [x, y] = [a, b];
  while (x > 0 && y > 0 && Math.abs(x - y) > 1e-8 * x) [x, y] = [(x + y) / 2, Math.sqrt(x * y)];
  return x > 0 && y > 0 ? (x + y) / 2 : 0;
}

/** The zero of a cubic (its coefficients, lowest first) between a point where it is not negative and one where it is not positive. */
function zeroBetween([c0, c1, c2, c3], positive, negative) {
  let [inside, outside] = [positive, negative];
  let x = (inside + outside) / 2;
  for (let n = 0; n < 200 && x !== inside && x !== outside; n += 1) {
    const value = c0 + x * (c1 + x * (c2 + x * c3));
    if (value > 0) inside = x;
    else outside = x;
    const next = x - value / (c1 + x * (2 * c2 + 3 * x * c3));
    const isInside = (next - inside) * (next - outside) < 0;
    // Every third step is a bisection, for roots that are close.
    x = isInside && n % 3 < 2 ? next : (inside + outside) / 2;
  }
  return outside;
}

/** The quantities of a motion of a Lagrange top; SI units and radians. */
export function describeNutation(body, { angle: [, theta], omega: [w1, w2, omega3], phiRate }) {
  const [u, sine] = [theta === Math.PI ? -1 : Math.cos(theta), theta === Math.PI ? 0 : Math.sin(theta)];
  const beta = (2 * body.mgl) / body.inertia1;
  const a = (body.inertia3 * omega3) / body.inertia1;
  const swing = w1 ** 2 + w2 ** 2;
  const turn = sine ** 2 * phiRate; // b - a u at the start
  const top = { beta, a, swing, turn, u, sine };
  // The cubic in y = u - (that of the start), and how far the poles are.
  const above = 2 * Math.sin(theta / 2) ** 2;
  const below = theta === Math.PI ? 0 : 2 * Math.cos(theta / 2) ** 2;
  const cubic = [
    Math.max(0, sine ** 2 * swing - turn ** 2),
    2 * a * turn - 2 * u * swing - beta * sine ** 2,
    2 * u * beta - swing - a ** 2,
    beta,
  ];
  const size = swing + a ** 2 + 2 * beta;
  const y1 = cubic[0] > 0 || cubic[1] < 0 ? zeroBetween(cubic, 0, -below) : 0;
  const y2 = cubic[0] > 0 || cubic[1] > 0 ? zeroBetween(cubic, 0, above) : 0;
  Object.assign(top, { y1, y2, above, below });
  const motionClass = classOf(top, size);
  // beta (u3 - u2) and beta (u3 - u1), by the sum of the roots
  const toSecond = motionClass === "separatrix" ? 0 : Math.max(0, -cubic[2] - beta * (y1 + 2 * y2));
  const toFirst = Math.max(0, -cubic[2] - beta * (2 * y1 + y2));
  const isConstant = ["steady", "sleeping", "upright", "hanging"].includes(motionClass);
  const inclination = (y) => 2 * Math.atan2(Math.sqrt(Math.max(0, above - y)), Math.sqrt(Math.max(0, below + y)));
  const frequency = meanOf(Math.sqrt(toFirst), Math.sqrt(toSecond));
  // A pendulum swings to both sides in two periods of its inclination.
  const periods = motionClass === "libration" ? 2 : 1;
  return {
    motionClass,
    thetaMin: isConstant ? theta : inclination(y2),
    thetaMax: isConstant ? theta : inclination(y1),
    period: frequency > 0 ? (periods * 2 * Math.PI) / frequency : Infinity,
    phiRateMax: largestPhiRate(top),
    /** Whether the axis passes a pole, where the precession is no number. */
    passesPole: !isConstant && (isRounding(top.turn - a * above, a) || isRounding(top.turn + a * below, a)),
  };
}

/** Whether a difference of terms as large as others is one of rounding. */
function isRounding(difference, ...terms) {
  return Math.abs(difference) <= ROUNDING * Math.max(...terms.map(Math.abs));
}

/** The class of a motion. Classes that are limits apply within the rounding errors of the data. */
function classOf({ beta, a, swing, turn, u, sine, y1, y2, above, below }, size) {
  const [missTop, missBottom] = [turn - a * above, turn + a * below]; // b - a and b + a
  const reachesTop = isRounding(missTop, turn, a * above);
  if (sine === 0 && swing === 0) return u < 0 ? "hanging" : a ** 2 < 2 * beta ? "upright" : "sleeping";
  const excess = swing + beta * (u - 1); // alpha - beta: of the energy over that at the top
  if (reachesTop && a ** 2 < 2 * beta && isRounding(excess, size)) return "separatrix";
  if (turn === 0 && a === 0) return excess > 0 ? "circulation" : beta > 0 ? "libration" : "steady";
  const moment = 2 * a * turn - 2 * u * swing - beta * sine ** 2;
  const isStill = y2 - y1 <= UNSURE || (isRounding(moment, 2 * a * turn, 2 * u * swing, beta * sine ** 2)
    && sine ** 2 * swing - turn ** 2 <= ROUNDING * swing);
  if (isStill) return "steady";
  const atTop = turn - a * y2;
  if (!reachesTop && isRounding(atTop, turn, a * sine ** 2)) return "cusp";
  const rates = [reachesTop ? a : atTop, isRounding(missBottom, turn, a * below) ? -a : turn - a * y1];
  return rates[0] * rates[1] > 0 ? "wave" : "loop";
}

/** phi' where it is largest, at a turning point, rad/s; NaN if that is a pole. */
function largestPhiRate({ a, turn, y1, y2, above, below }) {
  const rates = [y1, y2].map((y) => (turn - a * y) / ((above - y) * (below + y)));
  return Math.abs(rates[0]) > Math.abs(rates[1]) ? rates[0] : rates[1];
}

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
