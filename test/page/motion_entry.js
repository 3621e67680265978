// The motion of bodies for the suite that compares it with the program's tables.

import { makeBody, startFromAngles } from "../../scripts/reporting/page/dynamics/body.js";
import { Motion } from "../../scripts/reporting/page/dynamics/motion.js";
import { criticalOmega3, describeNutation, steadyRates } from "../../scripts/reporting/page/dynamics/nutation.js";

/** The motion of a body at some times, and the nutation of a symmetric top. */
function motionOf({ body: given, start: angles, times }) {
  const body = makeBody(given);
  const start = startFromAngles(angles);
  const motion = new Motion(body, start);
  const states = times.map((t) => motion.at(t));
  return { stop: motion.stop, count: motion.count, states, nutation: body.isLagrange && describeNutation(body, start) };
}

globalThis.motionsOf = (bodies) => JSON.stringify(bodies.map(motionOf), (key, value) => (
  typeof value === "number" && !Number.isFinite(value) ? String(value) : value
));
globalThis.steadyMotionOf = ({ body: given, theta, omega3 }) => {
  const body = makeBody(given);
  return JSON.stringify([criticalOmega3(body), steadyRates(body, theta, omega3)]);
};
