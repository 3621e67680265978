// What a live top does, in words and numbers.

import { CLASS_MEANINGS } from "../dynamics/nutation.js";
import { inDegrees, inShort } from "../text.js";

const NAMES = {
  loop: "Loops", cusp: "Cusps", wave: "Waves", steady: "Steady precession", sleeping: "Sleeping top", hanging: "Hanging",
  separatrix: "Separatrix", libration: "Plane pendulum", circulation: "Plane pendulum",
};

const UPRIGHT = (5.01 * Math.PI) / 180; // a top that starts with less tilt is almost upright

/** Name and meaning of the class of a motion; of a top that is almost upright, whether it sleeps. */
export function classOf(track) {
  const { nutation, threshold, start } = track;
  if (!nutation) return { name: nameOf(track), meaning: meaningOf(track) };
  const [name, meaning] = [NAMES[nutation.motionClass], CLASS_MEANINGS[nutation.motionClass]];
  const isUpright = threshold > 0 && start.angle[1] <= UPRIGHT && start.omega[2] !== 0;
  if (!isUpright || ["sleeping", "separatrix"].includes(nutation.motionClass)) return { name, meaning };
  return sleepRatio(track) > 1
    ? { name: "Sleeping top", meaning: `almost upright it sleeps, with small ${name.toLowerCase()}: the spin is above the threshold` }
    : { name: "Falling top", meaning: `almost upright it falls: the spin is below the threshold; ${meaning}` };
}

function nameOf({ body, motion, span }) {
  if (motion.stop <= span) return "Comes to rest";
  if (body.isVibrated) return "Vibrating pivot";
  if (body.friction > 0) return "Top with dry friction";
  if (!body.isConservative) return "Damped top";
  return body.isSymmetric ? "Hanging top" : "Body without symmetry";
}

function meaningOf({ body, motion, span }) {
  if (motion.stop <= span) return `from ${inShort(motion.stop)} s on it lies still`;
  if (body.isVibrated) return "the pivot moves up and down; energy is not conserved";
  if (!body.isConservative) return "energy and spin are lost";
  return body.isSymmetric ? "the centre of mass is below the pivot" : "energy and vertical momentum are conserved; the motion is often chaotic";
}

/** The spin over the threshold of the sleeping top. */
function sleepRatio({ threshold, start }) {
  return Math.abs(start.omega[2]) / threshold;
}

/** What of the sleeping top: threshold, and where the spin is to it. */
export function sleepOf(track) {
  const { threshold, isTop } = track;
  if (!isTop) return "A body without symmetry, or below its pivot, has no threshold of sleep.";
  if (!(threshold > 0)) return "Without weight a top sleeps at any spin.";
  const ratio = sleepRatio(track);
  const verdict = ratio > 1 ? "upright it sleeps" : "upright it falls";
  return `Spin ${inShort(ratio)} × the threshold ${inShort(threshold)} rad/s: ${verdict}.`;
}

/** Period, range and precession of the nutation, or losses, as terms and values. */
export function factsOf(track) {
  const { nutation, roots, thetaMin, thetaMax, energy, span, wanted } = track;
  const facts = [["Tilt", `${inDegrees(thetaMin, 2)} to ${inDegrees(thetaMax, 2)}`]];
  if (nutation) {
    const { period, phiRateMax, motionClass } = nutation;
    const { precession } = track;
    const isPlane = ["libration", "circulation"].includes(motionClass);
    facts.push(
      [isPlane ? "Period" : "Nutation period", Number.isFinite(period) ? `${inShort(period)} s` : "infinite"],
      ["Precession per nutation", Number.isFinite(precession) && !isPlane ? inDegrees(precession, 2) : "–"],
      ["Largest precession rate", Number.isFinite(phiRateMax) ? `${inShort(phiRateMax)} rad/s` : "–"],
    );
  } else {
    const [first, last] = [energy[0], energy.at(-1)];
    facts.push(
      ["Energy, start to end", `${inShort(first)} to ${inShort(last)} J`],
      ["Spin at the end", `${inShort(track.at(span).omega[2])} rad/s`],
    );
  }
  if (track.isTop) facts.push(["Steady precession at θ₀", roots.length ? `${roots.map(inShort).join(" or ")} rad/s` : "spin too slow"]);
  if (span < wanted) facts.push(["Shown", `the first ${inShort(span)} s`]);
  return facts;
}

/** The motion in a sentence, to be spoken. */
export function accountOf(track) {
  const { name, meaning } = classOf(track);
  const facts = factsOf(track).slice(0, 3).map(([term, value]) => `${term.toLowerCase()} ${value}`);
  return `${name}: ${meaning}; ${facts.join("; ")}. ${sleepOf(track)}`;
}
