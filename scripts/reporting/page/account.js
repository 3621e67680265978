// A motion in sentences, for those who do not see it.

import { say } from "./live/language.js";
import { inDegrees, inShort } from "./text.js";

const UNITS = { force: "N", momentum: "J s", omega: "rad/s" }; // of the arrows

/** What one would see. */
export function accountOf(motion) {
  const [phi, psi] = [0, 2].map((k) => motion.column("angles", k));
  const [low, high] = motion.extremes.theta.map((angle) => inDegrees(angle, 2));
  const found = [say("account_tilt", { start: inShort(motion.start), end: inShort(motion.end), low, high })];
  if (motion.countsTurns) {
    const [phi0, phi1, psi0, psi1] = [phi[0], phi.at(-1), psi[0], psi.at(-1)].map((angle) => inDegrees(angle, 1));
    found.push(say("account_turns", { phi0, phi1, psi0, psi1 }));
  }
  const longest = Object.entries(UNITS).filter(([name]) => motion.extremes[name])
    .map(([name, unit]) => `${say(`show_${name}`)} ${inShort(motion.extremes[name])} ${unit}`);
  if (longest.length) found.push(say("account_arrows", { arrows: longest.join(", ") }));
  return found.join(" ");
}

/** Where the motion is, by a key of the dictionary with places for the time and the angles. */
export function momentOf(key, { time, angles }) {
  const [phi, theta, psi] = angles.map((angle) => inDegrees(angle, 1));
  return say(key, { time: inShort(time), phi, theta, psi });
}
