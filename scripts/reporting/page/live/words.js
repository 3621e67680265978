// What a live top does, in words and numbers.

import { CLASS_MEANINGS } from "../exact/nutation.js";
import { inDegrees, inShort } from "../text.js";

const NAMES = {
  loop: "Loops", cusp: "Cusps", wave: "Waves", steady: "Steady precession", sleeping: "Sleeping top", hanging: "Hanging",
  separatrix: "Separatrix", libration: "Plane pendulum", circulation: "Plane pendulum",
};

/** Name and meaning of the class of a motion. */
export function classOf({ nutation }) {
  return { name: NAMES[nutation.motionClass], meaning: CLASS_MEANINGS[nutation.motionClass] };
}

/** What of the sleeping top: threshold, and where the spin is to it. */
export function sleepOf({ threshold, start }) {
  if (!(threshold > 0)) return "Without weight a top sleeps at any spin.";
  const ratio = Math.abs(start.omega[2]) / threshold;
  const verdict = ratio > 1 ? "upright it sleeps" : "upright it falls";
  return `Spin ${inShort(ratio)} × the threshold ${inShort(threshold)} rad/s: ${verdict}.`;
}

/** Period, range and precession of the nutation, as terms and values. */
export function factsOf({ nutation, roots }) {
  const { period, thetaMin, thetaMax, precession, phiRateMax } = nutation;
  const isPeriodic = Number.isFinite(period);
  return [
    ["Tilt", `${inDegrees(thetaMin, 2)} to ${inDegrees(thetaMax, 2)}`],
    ["Nutation period", isPeriodic ? `${inShort(period)} s` : "none: infinite"],
    ["Precession per nutation", isPeriodic ? inDegrees(precession, 2) : "–"],
    ["Largest precession rate", `${inShort(phiRateMax)} rad/s`],
    ["Steady precession at θ₀", roots.length ? `${roots.map(inShort).join(" or ")} rad/s` : "spin too slow"],
  ];
}

/** The motion in a sentence, to be spoken. */
export function accountOf(track) {
  const { name, meaning } = classOf(track);
  const facts = factsOf(track).slice(0, 3).map(([term, value]) => `${term.toLowerCase()} ${value}`);
  return `${name}: ${meaning}; ${facts.join("; ")}. ${sleepOf(track)}`;
}
