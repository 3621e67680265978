// Selects the form in which the exact solution of a case is evaluated: src/exact/theta_motion.f90.

import { anint } from "./arithmetic.js";
import { evaluateCircularForm, prepareCircularForm } from "./circular_form.js";
import { evaluateHyperbolicForm, prepareHyperbolicForm } from "./hyperbolic_form.js";
import { newClock } from "./theta_functions.js";

/** The axis is at rest: upright, hanging, or anywhere without weight and angular velocity. */
export const RESTING = "resting";
/** k^2 <= 1/2: theta functions of the nome in circular functions of time. */
export const CIRCULAR = "circular";
/** k^2 > 1/2, the separatrix included: the complementary nome in hyperbolic functions. */
export const HYPERBOLIC = "hyperbolic";

/** Argument from the upper turning point on the separatrix, which it never reaches. */
const NEVER = 1e6;

/** Selects the form for a case. */
export function chooseRegime(start, points) {
  const atRest = !(start.swingSquared > 0);
  const inBalance = !(start.beta * start.sineSquared > 0);
  if ((atRest && inBalance) || !(points.frequency > 0)) return RESTING;
  return points.kSquared <= 0.5 ? CIRCULAR : HYPERBOLIC;
}

/** The theta functions of one motion. */
export class ThetaMotion {
  constructor(start, points) {
    this.regime = chooseRegime(start, points);
    if (this.regime === RESTING) {
      this.clock = newClock();
      return;
    }
    const prepare = this.regime === CIRCULAR ? prepareCircularForm : prepareHyperbolicForm;
    Object.assign(this, prepare(start, points)); // clock, form
  }

  /**
   * The argument at a time `elapsed` (s) after the start, reduced by whole nutations: z within half a
   * period of zero, half a period minus |z|, and the number of nutations subtracted.
   */
  locate(elapsed) {
    const { clock } = this;
    const argument = clock.start + clock.rate * elapsed;
    if (!(clock.period > 0)) return { z: argument, fromTop: NEVER, nutations: 0 };
    const nutations = anint(argument / clock.period);
    // The bounds matter only for times so large that no digit of z is correct.
    const z = Math.max(-clock.halfPeriod, Math.min(clock.halfPeriod, argument - nutations * clock.period));
    return { z, fromTop: clock.halfPeriod - Math.abs(z), nutations };
  }

  /** The theta functions at the reduced argument z. */
  evaluate(z, fromTop) {
    return this.regime === CIRCULAR
      ? evaluateCircularForm(this.form, z, fromTop)
      : evaluateHyperbolicForm(this.form, z, fromTop);
  }
}
