// The numbers of a moment: angles as they stand in the table, rates, angular velocity, energies.

import { extremesOf } from "./dynamics/numbers.js";
import { say } from "./live/language.js";
import { aligned, decimalsFor, inDegrees, inFull, withDecimals } from "./text.js";

const ANGLES = ["phi", "theta", "psi"];

/** Decimals that suit the finite numbers of a table. */
function decimalsOf(table) {
  if (!table) return 0;
  const ends = extremesOf(table.filter(Number.isFinite)).map(Math.abs);
  return decimalsFor(Math.max(0, ...ends.filter(Number.isFinite)));
}

export class Readout {
  /** @param parts the elements to fill, by name @param motion what is shown */
  constructor(parts, motion) {
    this.parts = parts;
    this.motion = motion;
    this.decimals = Object.fromEntries(["rates", "omega", "energies"].map((name) => [name, decimalsOf(motion[name])]));
    parts.omega_row.hidden = !motion.omega;
    parts.energy_row.hidden = !motion.energies;
  }

  show(moment) {
    const { parts, motion, decimals } = this;
    const isOfTable = moment.row !== null;
    const row = moment.row ?? motion.rowBefore(moment.time);
    const numbers = aligned([moment.time, ...moment.angles].map((value) => inFull(value, isOfTable)));
    ["t", ...ANGLES].forEach((name, k) => {
      parts[name].textContent = numbers[k];
    });
    ANGLES.forEach((name, k) => {
      parts[`${name}_degrees`].textContent = inDegrees(moment.angles[k]);
      const rate = moment.rates ? moment.rates[k] : NaN;
      parts[`${name}_rate`].textContent = withDecimals(rate, decimals.rates);
    });
    (moment.omega ?? []).forEach((value, k) => {
      parts[`omega${k + 1}`].textContent = withDecimals(value, decimals.omega);
    });
    (moment.energies ?? []).forEach((value, k) => {
      parts[["kinetic", "potential", "energy"][k]].textContent = withDecimals(value, decimals.energies);
    });
    const number = Math.min(row * motion.stride, motion.total - 1) + 1;
    parts.row.textContent = say(isOfTable ? "row_of" : "row_after", { number, total: motion.total });
  }
}
