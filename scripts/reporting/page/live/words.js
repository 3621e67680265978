// What a live top does, in words and numbers.

import { CLASS_MEANINGS } from "../exact/nutation.js";
import { inDegrees, inShort } from "../text.js";

const NAMES = {
  loop: "Loops", cusp: "Cusps", wave: "Waves", steady: "Steady precession", sleeping: "Sleeping top", hanging: "Hanging",
  separatrix: "Separatrix", libration: "Plane pendulum", circulation: "Plane pendulum",
};

const UPRIGHT = (5 * Math.PI) / 180; // a top whose tilt becomes less is almost upright

/** Name and meaning of the class of a motion; of a top that is almost upright, whether it sleeps. */
export function classOf(track) {
  const { motionClass, thetaMin } = track.nutation;
  const [name, meaning] = [NAMES[motionClass], CLASS_MEANINGS[motionClass]];
  if (!(track.threshold > 0) || thetaMin > UPRIGHT || ["sleeping", "separatrix"].includes(motionClass)) return { name, meaning };
  const sleeps = sleepRatio(track) > 1 ? "it sleeps: the spin is above the threshold" : "it falls: the spin is below the threshold";
  return { name, meaning: `${meaning}. Almost upright, ${sleeps}` };
}

/** The spin over the threshold of the sleeping top. */
function sleepRatio({ threshold, start }) {
  return Math.abs(start.omega[2]) / threshold;
}

/** What of the sleeping top: threshold, and where the spin is to it. */
export function sleepOf(track) {
  const { threshold } = track;
  if (!(threshold > 0)) return "Without weight a top sleeps at any spin.";
  const ratio = sleepRatio(track);
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
