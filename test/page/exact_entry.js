// The exact solution of tops for the suite that compares it with the program's tables.

import { ExactMotion } from "../../scripts/reporting/page/exact/exact_motion.js";
import { makeBody, startFromAngles } from "../../scripts/reporting/page/exact/motion.js";
import { criticalOmega3, steadyRates, steadyRatesAtSpin } from "../../scripts/reporting/page/exact/steady_motion.js";

/** The motion of a top at some times, and what of it does not depend on time. */
function motionOf({ top, times }) {
  const exact = new ExactMotion(makeBody(top), startFromAngles(top));
  return { regime: exact.theta.regime, nutation: exact.nutation, states: times.map((t) => exact.at(t)) };
}

globalThis.motionsOf = (tops) => JSON.stringify(tops.map(motionOf), (key, value) => (
  typeof value === "number" && !Number.isFinite(value) ? String(value) : value
));
globalThis.steadyMotionOf = (top) => {
  const body = makeBody(top);
  return [criticalOmega3(body), steadyRates(body, top.theta, top.omega3), steadyRatesAtSpin(body, top.theta, top.omega3)];
};
