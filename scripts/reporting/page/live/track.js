// The motion of a state over its span, sampled for what is drawn; and the body that is drawn.

import { times } from "../dynamics/body.js";
import { Motion } from "../dynamics/motion.js";
import { describeNutation } from "../dynamics/nutation.js";
import { buildShape } from "../dynamics/shapes.js";
import { extremesOf } from "../dynamics/numbers.js";
import { say } from "./language.js";
import { resolve } from "./scene.js";

const PER_TURN = 60; // points, of the fastest turn
const FEWEST = 240;

/** Points and steps at most: while one changes something, and afterwards. */
export const COARSE = { points: 300, steps: 1500 };
export const FINE = { points: 1800, steps: 20000 };
/** Of a moment what is drawn; vectors stand x, y, z side by side. */
const VECTORS = ["axis", "omega", "omegaSpace", "momentum", "force", "torque", "change"];

export class Track {
  /** @param state as scene.js has it @param most points and steps, `COARSE` or `FINE` */
  constructor(state, most = FINE) {
    Object.assign(this, resolve(state));
    this.motion = new Motion(this.body, this.start, most.steps);
    this.wanted = state.t_end;
    /** The span that is shown, s: shorter than is wanted where that takes too many steps. */
    this.span = Math.min(this.motion.reach(state.t_end), state.t_end);
    this.nutation = this.body.isLagrange ? describeNutation(this.body, this.start) : null;
    this.isComplete = this.#countWanted() <= most.points && this.span === this.wanted;
    this.#sample(Math.min(this.#countWanted(), most.points) + 1);
    [this.thetaMin, this.thetaMax] = this.#rangeOfTilt();
  }

  /** So many points as the turns need that are seen: of the nutation, of the axis, of the pivot. */
  #countWanted() {
    const { body, start, span } = this;
    const [l1, l2, l3] = times(body.tensor, start.omega);
    const across = Math.min(body.inertia[0], body.inertia[1]);
    const rate = Math.hypot(l1, l2, l3) / across + 2 * body.naturalRate + (body.isVibrated ? body.vibrationRate : 0);
    return Math.max(FEWEST, Math.ceil((PER_TURN * rate * span) / (2 * Math.PI)));
  }

  #sample(count) {
    this.count = count;
    const moments = Array.from({ length: count }, (_, i) => this.at((this.span * i) / (count - 1)));
    const column = (of) => Float64Array.from(moments, of);
    this.t = column(({ t }) => t);
    [this.phi, this.theta, this.psi] = [0, 1, 2].map((k) => column(({ angle }) => angle[k]));
    this.kinetic = column(({ kinetic }) => kinetic);
    this.potential = column(({ potential }) => potential);
    this.energy = column(({ kinetic, potential }) => kinetic + potential);
    for (const name of VECTORS) {
      this[name] = new Float64Array(3 * count);
      moments.forEach((moment, i) => this[name].set(moment[name], 3 * i));
    }
  }

  /** The least and the largest tilt; that of a pendulum goes on beyond the hanging position. */
  #rangeOfTilt() {
    const { nutation, theta } = this;
    if (!nutation) return extremesOf(theta);
    const { motionClass, thetaMin, thetaMax } = nutation;
    if (!["libration", "circulation"].includes(motionClass)) return [thetaMin, thetaMax];
    return [thetaMin, 2 * Math.PI - thetaMin];
  }

  /** The motion at a time. */
  at(time) {
    return this.motion.at(Math.min(time, this.span));
  }

  /** The precession in a period of the nutation, rad; NaN if there is none or it takes too long. */
  get precession() {
    const { period = Infinity, passesPole } = this.nutation ?? {};
    if (passesPole || !(this.motion.reach(period === Infinity ? 0 : period) >= period)) return NaN;
    return this.motion.at(period).angle[0] - this.start.angle[0];
  }
}

const THINNEST = 0.04; // no solid is drawn thinner than this part of its largest extent

/**
 * The body of a state as the stage draws it, and what to say of it: the shape, or for mass properties the
 * homogeneous solid that has them, as in spintop_figures/moving/body.py.
 */
export function drawingOf(state, body) {
  const place = body.centre;
  const own = { axes: [1, 0, 0, 0, 1, 0, 0, 0, 1], place };
  const made = (solid, label) => ({ body: { centre: place, axis: [0, 0, 1], solids: [{ ...solid, ...own }] }, label });
  const { solid } = buildShape(state) ?? {};
  if (solid?.height < THINNEST * solid?.radius) solid.height = THINNEST * solid.radius;
  if (solid) return made(solid, "");
  const { mass, inertia, centre: [x, y, z] } = body;
  const central = [inertia[0] - mass * (y * y + z * z), inertia[1] - mass * (z * z + x * x), inertia[2] - mass * (x * x + y * y)];
  const [a, b, c] = central;
  const exists = Math.min(a + b - c, b + c - a, c + a - b) >= -1e-12 * Math.max(...inertia);
  const equal = solidOf(mass, exists ? central : inertia);
  return made(equal, say(exists ? "drawn" : "drawn_otherwise", { solid: say(nameOf(equal)) }));
}

/** The homogeneous cylinder with two equal moments across its axis, or the cuboid with three. */
function solidOf(mass, [a, b, c]) {
  if (Math.abs(a - b) > 1e-6 * Math.max(a, b)) {
    const edges = [b + c - a, c + a - b, a + b - c].map((sum) => Math.sqrt(Math.max(0, (6 * sum) / mass)));
    return { kind: "cuboid", edges: edges.map((edge) => Math.max(edge, THINNEST * Math.max(...edges))) };
  }
  const radius = Math.sqrt((2 * c) / mass);
  const height = Math.sqrt(Math.max(0, (12 * a) / mass - 3 * radius ** 2));
  const drawn = Math.max(radius, (THINNEST * height) / 2);
  return { kind: "cylinder", radius: drawn, height: Math.max(height, 2 * THINNEST * drawn) };
}

function nameOf({ kind, height, radius }) { // of the dictionary
  if (kind === "cuboid") return "solid_cuboid";
  return height < radius / 2 ? "solid_disc" : "solid_cylinder";
}
