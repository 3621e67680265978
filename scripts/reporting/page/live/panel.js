// The panel of a live top: what its motion is, and the readings of a moment.

import { inDegrees, inFigures, inShort } from "../text.js";
import { numbersOf } from "./scene.js";
import { classOf, factsOf, sleepOf } from "./words.js";

/** Bring the panel up to the motion of a live top. */
export function fillPanel({ parts, track, controls, state, second }) {
  const { name, meaning } = classOf(track);
  parts.class.textContent = name;
  parts.meaning.textContent = meaning;
  parts.sleep.textContent = sleepOf(track);
  const facts = factsOf(track);
  while (parts.facts.children.length > facts.length) parts.facts.lastChild.remove();
  facts.forEach(([term, value], i) => {
    const row = parts.facts.children[i] ?? parts.facts.appendChild(newFact());
    [row.firstChild.textContent, row.lastChild.textContent] = [term, value];
  });
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

function newFact() {
  const row = document.createElement("div");
  row.append(document.createElement("dt"), document.createElement("dd"));
  return row;
}

/** The readings of a moment. */
export function showMoment(parts, moment, track) {
  parts.t.textContent = `${inFigures(moment.t)} s`;
  ["phi", "theta", "psi"].forEach((name, k) => {
    parts[name].textContent = inDegrees(moment.angle[k], 2);
    const rate = moment.rate[k];
    parts[`${name}_rate_now`].textContent = Number.isFinite(rate) ? inShort(rate) : "–";
  });
  for (const name of ["kinetic", "potential"]) parts[name].textContent = `${inShort(moment[name])} J`;
  parts.energy.textContent = `${inShort(moment.kinetic + moment.potential)} J`;
  parts.time.value = Math.round((Number(parts.time.max) * moment.t) / track.span);
  parts.time.setAttribute("aria-valuetext", `t = ${inShort(moment.t)} s`);
}
