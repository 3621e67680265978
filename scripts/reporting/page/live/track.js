// The exact motion of a state over its span, sampled for what is drawn; and the body that is drawn.

import { ExactMotion } from "../exact/exact_motion.js";
import { toSpace } from "../exact/motion.js";
import { angularMomentum, kineticEnergy, potentialEnergy, supportForce } from "../exact/quantities.js";
import { NUMBERS, resolve } from "./scene.js";

const PER_NUTATION = 60; // points
const PER_TURN = 60; // of precession
const FEWEST = 240;

/** Points at most: while one changes something, and afterwards. */
export const [COARSE, FINE] = [300, 900];
const NO_PERIOD = 2; // natural periods that count as one nutation where the motion has no period
const BODY_Z = [0, 0, 1];

/** The span that is shown, s: so many nutations; natural periods where the axis never returns. */
function spanOf({ body, start, nutation }, nutations) {
  if (Number.isFinite(nutation.period)) return nutations * nutation.period;
  const rate = Math.sqrt((2 * body.mgl) / body.inertia1 + start.a ** 2 + start.swingSquared);
  return nutations * NO_PERIOD * (rate > 0 ? (2 * Math.PI) / rate : 1);
}

/** How many nutations a span (s) of a state has, within what can be shown. */
export function nutationsIn(state, span) {
  const { body, start } = resolve(state);
  const { least, most } = NUMBERS.nutations;
  const nutations = span / spanOf(new ExactMotion(body, start), 1);
  return Math.min(Math.max(Number(nutations.toPrecision(6)), least), most);
}

function countOf({ nutation }, span, most) {
  const turns = Math.abs(nutation.precessionRate * span) / (2 * Math.PI);
  const nutations = Number.isFinite(nutation.period) ? span / nutation.period : 4;
  const wanted = Math.ceil(Math.max(PER_NUTATION * nutations, PER_TURN * turns));
  return Math.min(Math.max(wanted, FEWEST), most) + 1;
}

export class Track {
  /** @param state as scene.js has it @param most points */
  constructor(state, most = FINE) {
    Object.assign(this, resolve(state));
    this.exact = new ExactMotion(this.body, this.start);
    this.nutation = this.exact.nutation;
    this.span = spanOf(this.exact, state.nutations);
    this.#sample(countOf(this.exact, this.span, most));
  }

  #sample(count) {
    const column = () => new Float64Array(count);
    const vectors = () => new Float64Array(3 * count);
    Object.assign(this, { count, t: column(), phi: column(), theta: column(), psi: column() });
    Object.assign(this, { kinetic: column(), potential: column(), energy: column(), thetaRate: column() });
    Object.assign(this, { axis: vectors(), omega: vectors(), omegaBody: vectors(), momentum: vectors() });
    this.force = vectors();
    for (let i = 0; i < count; i += 1) {
      const moment = this.at((this.span * i) / (count - 1));
      this.t[i] = moment.t;
      [this.phi[i], this.theta[i], this.psi[i]] = moment.angle;
      this.thetaRate[i] = moment.rate[1];
      this.kinetic[i] = moment.kinetic;
      this.potential[i] = moment.potential;
      this.energy[i] = moment.kinetic + moment.potential;
      this.axis.set(moment.axis, 3 * i);
      this.omega.set(moment.omegaSpace, 3 * i);
      this.omegaBody.set(moment.omega, 3 * i);
      this.momentum.set(moment.momentum, 3 * i);
      this.force.set(moment.force, 3 * i);
    }
  }

  /** The motion at a time, with energies and vectors in space axes. */
  at(time) {
    const moment = this.exact.at(time);
    const { quaternion, omega } = moment;
    return Object.assign(moment, {
      kinetic: kineticEnergy(this.body, moment),
      potential: potentialEnergy(this.body, moment),
      axis: toSpace(quaternion, BODY_Z),
      omegaSpace: toSpace(quaternion, omega),
      momentum: angularMomentum(this.body, moment),
      force: supportForce(this.body, moment),
    });
  }
}

const THINNEST = 0.04; // no solid is drawn thinner than this part of its largest extent
const DRAWN = {
  spinning_wheel: (s) => ({ kind: "cylinder", radius: s.radius, height: s.thickness }),
  ring: (s) => ({
    kind: "ring", radius: s.radius, inner: Math.min(s.inner_radius, 0.999 * s.radius), height: s.thickness,
  }),
  sphere: (s) => ({ kind: "sphere", radius: s.radius }),
  cylinder: (s) => ({ kind: "cylinder", radius: s.radius, height: s.thickness }),
  cone: (s) => ({ kind: "cone", radius: s.radius, height: s.thickness }),
};
const NO_SUCH_BODY = "No mass distribution has this inertia about the pivot with its centre of mass there. ";

/**
 * The body of a state as the stage draws it, and what to say of it: the shape, or for mass properties the
 * homogeneous cylinder that has them, as in spintop_figures/moving/body.py.
 */
export function drawingOf(state, body) {
  const place = [0, 0, body.length];
  const axes = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const made = (solid, label) => ({
    body: { centre: place, axis: BODY_Z, solids: solid ? [{ ...solid, axes, place }] : [] }, label,
  });
  if (state.shape !== "inertia") {
    const solid = DRAWN[state.shape](state);
    if (solid.height < THINNEST * solid.radius) solid.height = THINNEST * solid.radius;
    return made(solid, "");
  }
  const { mass, inertia1, inertia3, length } = body;
  const central = inertia1 - mass * length ** 2;
  const exists = inertia3 <= 2 * central * (1 + 1e-12);
  const across = exists ? central : inertia1;
  let radius = Math.sqrt((2 * inertia3) / mass);
  let height = Math.sqrt(Math.max(0, (12 * across) / mass - 3 * radius ** 2));
  radius = Math.max(radius, (THINNEST * height) / 2);
  height = Math.max(height, 2 * THINNEST * radius);
  const name = height < radius / 2 ? "disc" : "cylinder";
  return made({ kind: "cylinder", radius, height }, exists
    ? `Drawn: the homogeneous ${name} with this mass and inertia.`
    : `${NO_SUCH_BODY}Drawn: the homogeneous ${name} with these moments about its centre of mass.`);
}
