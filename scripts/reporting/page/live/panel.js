// The panel of a live top: what its motion is, in words and numbers, and the readings of a moment.

import { inDegrees, inFigures, inShort, orDash } from "../text.js";
import { say } from "./language.js";
import { numbersOf } from "./scene.js";

const UPRIGHT = (5.01 * Math.PI) / 180; // a top that starts with less tilt is almost upright

/** Name and meaning of the class of a motion; of a top that is almost upright, whether it sleeps. */
export function classOf(track) {
  const { nutation, threshold, start } = track;
  const kind = nutation?.motionClass ?? kindOf(track);
  const name = say(`class_${kind}`);
  const meaning = say(`meaning_${kind}`, { stop: inShort(track.motion.stop) });
  const isUpright = threshold > 0 && start.angle[1] <= UPRIGHT && start.omega[2] !== 0;
  if (!nutation || !isUpright || ["sleeping", "upright", "separatrix"].includes(kind)) return { name, meaning };
  return sleepRatio(track) > 1
    ? { name: say("class_sleeping"), meaning: say("almost_sleeping", { tips: say(`small_${kind}`) }) }
    : { name: say("class_falling"), meaning: say("almost_falling", { meaning }) };
}

/** The kind of a motion that has no nutation. */
function kindOf({ body, motion, span }) {
  if (motion.stop <= span) return "rest";
  if (body.isVibrated) return "vibrated";
  if (body.friction > 0) return "dry";
  if (!body.isConservative) return "damped";
  return body.isSymmetric ? "below" : "body";
}

/** The spin over the threshold of the sleeping top. */
function sleepRatio({ threshold, start }) {
  return Math.abs(start.omega[2]) / threshold;
}

/** What of the sleeping top: threshold, and where the spin is to it. */
function sleepOf(track) {
  const { threshold, isTop } = track;
  if (!isTop) return say("sleep_none");
  if (!(threshold > 0)) return say("sleep_weightless");
  const ratio = sleepRatio(track);
  return say(ratio > 1 ? "sleep_above" : "sleep_below", { ratio: inShort(ratio), threshold: inShort(threshold) });
}

/** Period, range and precession of the nutation, or losses, as terms and values. */
function factsOf(track) {
  const { nutation, roots, thetaMin, thetaMax, energy, span, wanted } = track;
  const facts = [[say("tilt"), say("range", { low: inDegrees(thetaMin, 2), high: inDegrees(thetaMax, 2) })]];
  if (nutation) {
    const { period, phiRateMax, motionClass } = nutation;
    const { precession } = track;
    const isPlane = ["libration", "circulation"].includes(motionClass);
    facts.push(
      [say(isPlane ? "period" : "nutation_period"), Number.isFinite(period) ? `${inShort(period)} s` : say("infinite")],
      [say("precession_per_nutation"), orDash(isPlane ? NaN : precession, (angle) => inDegrees(angle, 2))],
      [say("largest_precession"), orDash(phiRateMax, (rate) => `${inShort(rate)} rad/s`)],
    );
  } else {
    const [first, last] = [energy[0], energy.at(-1)];
    facts.push(
      [say("energy_lost"), `${say("range", { low: inShort(first), high: inShort(last) })} J`],
      [say("spin_at_end"), `${inShort(track.at(span).omega[2])} rad/s`],
    );
  }
  if (track.isTop) facts.push([say("steady_rates"), roots.length ? `${roots.map(inShort).join(say("or"))} rad/s` : say("too_slow")]);
  if (span < wanted) facts.push([say("shown_of_span"), say("first_seconds", { seconds: inShort(span) })]);
  return facts;
}

/** The motion in a sentence, to be spoken. */
export function accountOf(track) {
  const { name, meaning } = classOf(track);
  const facts = factsOf(track).slice(0, 3).map(([term, value]) => `${term} ${value}`);
  return `${name}: ${meaning}; ${facts.join("; ")}. ${sleepOf(track)}`;
}

/** Bring the panel up to the motion of a live top. */
export function fillPanel({ parts, track, controls, state, second }) {
  const { name, meaning } = classOf(track);
  parts.class.textContent = name;
  parts.meaning.textContent = meaning;
  parts.sleep.textContent = sleepOf(track);
  parts.facts.replaceChildren(...factsOf(track).map((fact) => {
    const row = document.createElement("div");
    row.append(...["dt", "dd"].map((tag, k) => Object.assign(document.createElement(tag), { textContent: fact[k] })));
    return row;
  }));
  const isSteady = state.precession !== "given";
  for (const key of ["phi_rate", "theta_rate"]) controls[key].setDisabled(isSteady);
  if (isSteady) {
    controls.phi_rate.set(track.phiRate);
    controls.theta_rate.set(0);
  }
  controls.omega3.markAt(track.threshold > 0 ? track.threshold : null);
  parts.threshold.disabled = !(track.threshold > 0);
  const names = numbersOf(state);
  second.describe(track);
  for (const [key, { element }] of Object.entries(controls)) element.hidden = !names.includes(key);
}

/** The readings of a moment. */
export function showMoment(parts, moment, track) {
  parts.t.textContent = `${inFigures(moment.t)} s`;
  ["phi", "theta", "psi"].forEach((name, k) => {
    parts[name].textContent = inDegrees(moment.angle[k], 2);
    parts[`${name}_rate_now`].textContent = orDash(moment.rate[k], inShort);
  });
  for (const name of ["kinetic", "potential"]) parts[name].textContent = `${inShort(moment[name])} J`;
  parts.energy.textContent = `${inShort(moment.kinetic + moment.potential)} J`;
  parts.time.value = Math.round((Number(parts.time.max) * moment.t) / track.span);
  parts.time.setAttribute("aria-valuetext", `t = ${inShort(moment.t)} s`);
}
