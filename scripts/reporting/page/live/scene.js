// What one sets of a live top: its parameters, presets, link and input; no page here.

import { buildShape } from "../exact/shapes.js";
import { makeBody, startFromAngles } from "../exact/motion.js";
import { criticalOmega3, steadyRates } from "../exact/steady_motion.js";

const DEGREE = Math.PI / 180;

/** Which dimensions a shape has, and its name. */
export const SHAPES = {
  inertia: { name: "mass properties", needs: ["mass", "inertia1", "inertia3", "length"] },
  spinning_wheel: { name: "spinning wheel on a rod", needs: ["radius", "thickness", "rod_length", "density"] },
  ring: { name: "ring on a rod", needs: ["radius", "inner_radius", "thickness", "rod_length", "density"] },
  sphere: { name: "ball on a rod", needs: ["radius", "rod_length", "density"] },
  cylinder: { name: "cylinder on its base", needs: ["radius", "thickness", "density"] },
  cone: { name: "cone on its apex", needs: ["radius", "thickness", "density"] },
};

/**
 * The numbers, by their names in the link: symbol, words, unit, and the values that are possible. `log`:
 * the slider goes by ratios. The keys of the program's input are in `KEYS`.
 */
export const NUMBERS = {
  mass: { symbol: "m", words: "mass", unit: "kg", least: 1e-6, log: true },
  inertia1: { symbol: "I₁", words: "inertia across the axis, about the pivot", unit: "kg m²", least: 1e-9, log: true },
  inertia3: { symbol: "I₃", words: "inertia about the axis", unit: "kg m²", least: 1e-9, log: true },
  length: { symbol: "l", words: "pivot to centre of mass", unit: "m", least: 0, log: true },
  radius: { symbol: "r", words: "radius", unit: "m", least: 1e-6, log: true },
  inner_radius: { symbol: "s", words: "inner radius", unit: "m", least: 0, log: true },
  thickness: { symbol: "h", words: "thickness along the axis", unit: "m", least: 1e-6, log: true },
  rod_length: { symbol: "l", words: "length of the rod", unit: "m", least: 0, log: true },
  density: { symbol: "ρ", words: "density", unit: "kg/m³", least: 1e-3, log: true },
  gravity: { symbol: "g", words: "gravity", unit: "m/s²", least: 0, range: [0, 25] },
  theta: { symbol: "θ₀", words: "tilt at the start", unit: "°", least: 0, most: 180, range: [0, 180] },
  omega3: { symbol: "ω₃", words: "spin: angular velocity about the axis", unit: "rad/s" },
  phi_rate: { symbol: "φ′₀", words: "precession rate at the start", unit: "rad/s" },
  theta_rate: { symbol: "θ′₀", words: "nutation rate at the start", unit: "rad/s" },
  nutations: { symbol: "n", words: "nutations shown", unit: "", least: 0.5, most: 200, range: [1, 40] },
};
export const START = ["omega3", "theta", "phi_rate", "theta_rate"];
const LARGEST = 1e9;

const EXAMPLE_1 = { shape: "inertia", mass: 1, inertia1: 0.875, inertia3: 0.25, length: 0.8660254037844387 };
const EXAMPLE_2 = { shape: "spinning_wheel", radius: 0.1, thickness: 0.01, density: 7800, rod_length: 1 };
const AUTHORS = {
  shape: "inertia", mass: 2.450442269800039, inertia1: 0.00614652602674843, inertia3: 0.012252211349000194, length: 1,
};
const AT_REST = { gravity: 9.81, phi_rate: 0, theta_rate: 0, precession: "given", nutations: 6 };
const THRESHOLD_1 = 2 * Math.sqrt(9.81 * EXAMPLE_1.length * EXAMPLE_1.inertia1) / EXAMPLE_1.inertia3;
/** Spin ratio 2 of the wheel: omega3 = 2 sqrt(4 m g l/I3), I3 = m r^2/2. */
const RATIO_2 = 2 * Math.sqrt((8 * 9.81 * EXAMPLE_2.rod_length) / EXAMPLE_2.radius ** 2);
const TIPS = { ...EXAMPLE_1, ...AT_REST, theta: 50, omega3: 30 };

/** The presets: title, what one sees, and the state. */
export const PRESETS = {
  cusp: { title: "Cusps", words: "released at rest", state: { ...TIPS } },
  loop: { title: "Loops", words: "released with backward precession", state: { ...TIPS, phi_rate: -1.2 } },
  wave: { title: "Waves", words: "released with forward precession", state: { ...TIPS, phi_rate: 0.8 } },
  sleeping: {
    title: "Sleeping top", words: "almost upright, spin above the threshold",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 1, omega3: 1.15 * THRESHOLD_1, nutations: 10 },
  },
  falling: {
    title: "Sleeping top, too slow", words: "almost upright, spin below the threshold",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 1, omega3: 0.9 * THRESHOLD_1, nutations: 2 },
  },
  separatrix: {
    title: "Separatrix", words: "rises to the upright and never reaches it",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 120, omega3: THRESHOLD_1 / 2, phi_rate: 6.231976237301238, nutations: 3 },
  },
  slow: {
    title: "Slow steady precession", words: "constant tilt, the small root",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 60, omega3: 18, precession: "slow" },
  },
  fast: {
    title: "Fast steady precession", words: "constant tilt, the large root",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 60, omega3: 18, precession: "fast" },
  },
  example1: {
    title: "Example 1 of the paper", words: "slow top, released at rest",
    state: { ...EXAMPLE_1, ...AT_REST, theta: 11.25, omega3: 1, nutations: 3 },
  },
  example2: {
    title: "Example 2 of the paper", words: "spinning wheel, spin ratio 2",
    state: { ...EXAMPLE_2, ...AT_REST, theta: 11.25, omega3: RATIO_2, nutations: 3 },
  },
  figure11: {
    title: "Figure 11 of the paper", words: "the wheel with the author's inertia, without m l²",
    state: { ...AUTHORS, ...AT_REST, theta: 11.25, omega3: RATIO_2, nutations: 29 },
  },
  pendulum: {
    title: "Plane pendulum", words: "no spin", state: { ...EXAMPLE_1, ...AT_REST, theta: 120, omega3: 0, nutations: 3 },
  },
  cone: {
    title: "Toy top", words: "a wooden cone of 6 cm",
    state: {
      shape: "cone", radius: 0.03, thickness: 0.06, density: 650, ...AT_REST, theta: 20, omega3: 150, nutations: 8,
    },
  },
};

/** The state with which the page begins. */
export const FIRST = "cusp";

const DEFAULTS = {
  ...EXAMPLE_1, ...AT_REST, theta: 50, omega3: 30, radius: 0.1, inner_radius: 0.05, thickness: 0.02, rod_length: 0.5,
  density: 2700,
};

/** A complete state. */
export function complete(state) {
  return { ...DEFAULTS, ...state };
}

/** Whether a number may stand for a parameter; else why not. */
export function refusal(name, value) {
  const { least = -LARGEST, most = LARGEST } = NUMBERS[name];
  if (!Number.isFinite(value)) return "not a number";
  if (value < least) return `at least ${least}`;
  if (value > most) return `at most ${most}`;
  return "";
}

/** Mass properties of a state, about the pivot. */
function massOf(state) {
  if (state.shape === "inertia") {
    const { mass, inertia1, inertia3, length } = state;
    return { mass, inertia1, inertia3, length };
  }
  const { radius, thickness, density } = state;
  const size = { radius, thickness, innerRadius: Math.min(state.inner_radius, radius), rodLength: state.rod_length };
  return buildShape(state.shape, size, density);
}

/**
 * What a state means: body, start, threshold spin of the sleeping top, the roots of steady precession, and
 * a sentence where something that is asked for does not exist.
 */
export function resolve(state) {
  const body = makeBody({ ...massOf(state), gravity: state.gravity });
  const theta = state.theta === 180 ? Math.PI : state.theta * DEGREE;
  const roots = steadyRates(body, theta, state.omega3);
  let [phiRate, thetaRate, lack] = [state.phi_rate, state.theta_rate, ""];
  if (state.precession !== "given") {
    thetaRate = 0;
    const root = roots[state.precession === "slow" ? 0 : 1];
    phiRate = root ?? 0;
    if (root === undefined) {
      lack = roots.length
        ? "A horizontal axis has no fast precession."
        : "The spin is too slow for steady precession at this tilt; the top is released at rest.";
    }
  }
  const start = startFromAngles({ theta, phiRate, thetaRate, omega3: state.omega3 });
  return { body, start, roots, phiRate, thetaRate, lack, threshold: criticalOmega3(body) };
}

/** The state as a link: what follows the #. */
export function linkOf(state) {
  const names = [...SHAPES[state.shape].needs, "gravity", ...START, "nutations"];
  const fields = [["shape", state.shape], ...names.map((name) => [name, String(state[name])])];
  if (state.precession !== "given") fields.push(["precession", state.precession]);
  return fields.map(([name, value]) => `${name}=${value}`).join("&");
}

/**
 * The state of a link, with the `span` (s) if it gives one instead of a number of nutations; null if it
 * holds none. What it does not hold, or is not possible, is as at first.
 */
export function stateOfLink(link) {
  const fields = new URLSearchParams(link.replace(/^#/, ""));
  const shape = fields.get("shape");
  if (!Object.hasOwn(SHAPES, shape ?? "")) return null;
  const state = complete({ shape });
  for (const [name, text] of fields) {
    if (Object.hasOwn(NUMBERS, name) && text.trim() !== "" && !refusal(name, Number(text))) state[name] = Number(text);
  }
  const span = Number(fields.get("t_end"));
  if (span > 0 && !fields.has("nutations")) state.span = span;
  if (["slow", "fast"].includes(fields.get("precession"))) state.precession = fields.get("precession");
  return state;
}

/** The state as an input of the program. */
export function inputOf(state) {
  const { body, phiRate, thetaRate } = resolve(state);
  const number = (value) => (Number.isInteger(value) ? `${value}.0` : String(value));
  const shape = state.shape === "inertia"
    ? [
      `mass = ${number(body.mass)}`,
      `inertia = ${[body.inertia1, body.inertia1, body.inertia3].map(number).join(", ")}`,
      `length = ${number(body.length)}`,
    ]
    : [`shape = '${state.shape}'`, ...SHAPES[state.shape].needs.map((name) => `${name} = ${number(state[name])}`)];
  const start = [["theta_deg", state.theta], ["omega3", state.omega3]];
  if (phiRate !== 0) start.push(["phi_rate", phiRate]);
  if (thetaRate !== 0) start.push(["theta_rate", thetaRate]);
  const group = (name, lines) => `&${name}\n${lines.map((line) => `    ${line}\n`).join("")}/\n`;
  return [
    group("study", ["title = 'From the live top'"]),
    group("top", [...shape, `gravity = ${number(state.gravity)}`]),
    group("initial", start.map(([name, value]) => `${name} = ${number(value)}`)),
    group("span", [`nutations = ${number(state.nutations)}`]),
  ].join("\n");
}
