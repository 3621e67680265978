// What one sets of a live top: its parameters, link and input; no page here.

import { isPossible, makeBody, startFromAngles } from "../dynamics/body.js";
import { buildShape } from "../dynamics/shapes.js";
import { criticalOmega3, steadyRates } from "../dynamics/nutation.js";
import { say } from "./language.js";
import NUMBERS from "./numbers.json";
import PRESETS from "./presets.json";

const DEGREE = Math.PI / 180;
const TOP_DAMPING = ["damping1", "damping3"];
const BODY = ["mass", "inertia1", "inertia2", "inertia3", "centre_x", "centre_y", "centre_z"];
const PRODUCTS = ["product23", "product31", "product12"];
const BODY_LOSSES = ["damping1", "damping2", "damping3"];

/** Which numbers a shape has. */
export const SHAPES = {
  inertia: ["mass", "inertia1", "inertia3", "length", ...TOP_DAMPING],
  spinning_wheel: ["radius", "thickness", "rod_length", "density", ...TOP_DAMPING],
  ring: ["radius", "inner_radius", "thickness", "rod_length", "density", ...TOP_DAMPING],
  sphere: ["radius", "rod_length", "density", ...TOP_DAMPING],
  cylinder: ["radius", "thickness", "density", ...TOP_DAMPING],
  cone: ["radius", "thickness", "density", ...TOP_DAMPING],
  body: [...BODY, ...BODY_LOSSES, "psi"],
  tensor: [...BODY, ...PRODUCTS, ...BODY_LOSSES, "psi"],
};

/**
 * The numbers, by their names in the link: symbol, unit, the part of the panel, the values that are possible, and what each
 * is `first`. `log`: the slider goes by ratios; `range`: its ends, if they do not depend on the body.
 */
export { NUMBERS };
const LARGEST = 1e9;
const THINNEST_RING = 0.99; // the largest hole, as a part of the radius
const START = ["omega3", "theta", "phi_rate", "theta_rate"];
const ALWAYS = [...START, "gravity", "friction", "amplitude", "vibration_rate", "t_end"];

/** The numbers that a state has. */
export function numbersOf({ shape }) {
  return [...SHAPES[shape], ...ALWAYS];
}

const FIRST = Object.fromEntries(Object.entries(NUMBERS).map(([name, { first }]) => [name, first]));

/** A complete state. */
export function complete(state) {
  return { shape: "inertia", precession: "given", ...FIRST, ...state };
}

/** Whether a number may stand for a parameter; else why not. */
export function refusal(name, value) {
  const { least = -LARGEST, most = LARGEST } = NUMBERS[name];
  if (!Number.isFinite(value)) return say("fault_number");
  if (value < least) return say("fault_least", { least });
  if (value > most) return say("fault_most", { most });
  return "";
}

/**
 * What else has to change with some numbers of a state, because there is no such body or the page does not compute
 * it: the `fields`, and the `words` by which the page says so. What a box shows is what is computed.
 */
export function consequenceOf(state, changed) {
  const { shape, radius, inner_radius: inner, inertia1, inertia2, inertia3 } = state;
  if (shape === "ring" && inner > THINNEST_RING * radius) {
    return { fields: { inner_radius: THINNEST_RING * radius }, words: say("limit_ring") };
  }
  if (shape === "tensor" && !isPossible([inertia1, inertia2, inertia3], PRODUCTS.map((name) => state[name]))) {
    const fields = Object.fromEntries(PRODUCTS.map((name) => [name, 0]));
    return { fields, words: say("limit_products") };
  }
  if (!state.friction || state.amplitude * state.vibration_rate === 0) return { fields: {}, words: "" };
  // A body that rests in friction would start again.
  return Object.hasOwn(changed, "friction")
    ? { fields: { amplitude: 0 }, words: say("limit_vibration") }
    : { fields: { friction: 0 }, words: say("limit_friction") };
}

/** Mass properties of a state, about the pivot. */
function massOf(state) {
  const { shape, mass, inertia1, inertia2, inertia3, length, centre_x: x, centre_y: y, centre_z: z } = state;
  if (shape === "inertia") return { mass, inertia: [inertia1, inertia1, inertia3], centre: [0, 0, length] };
  if (shape === "body" || shape === "tensor") {
    const products = shape === "tensor" ? PRODUCTS.map((name) => state[name]) : [0, 0, 0];
    return { mass, inertia: [inertia1, inertia2, inertia3], products, centre: [x, y, z] };
  }
  return buildShape(state);
}

/** The damping about the three axes. */
function dampingOf({ shape, damping1, damping2, damping3 }) {
  return [damping1, SHAPES[shape].includes("damping2") ? damping2 : damping1, damping3];
}

/**
 * What a state means: body, start, threshold spin of the sleeping top, the roots of steady precession, and a
 * sentence where something that is asked for does not exist.
 */
export function resolve(state) {
  const body = makeBody({
    ...massOf(state), gravity: state.gravity, damping: dampingOf(state), friction: state.friction, amplitude: state.amplitude,
    vibrationRate: state.vibration_rate,
  });
  const isTop = body.isSymmetric && body.centre[2] >= 0;
  const theta = state.theta === 180 ? Math.PI : state.theta * DEGREE;
  const roots = isTop ? steadyRates(body, theta, state.omega3) : [];
  let [phiRate, thetaRate, lack] = [state.phi_rate, state.theta_rate, ""];
  if (state.precession !== "given") {
    thetaRate = 0;
    const root = roots[state.precession === "slow" ? 0 : 1];
    phiRate = root ?? 0;
    if (root === undefined) lack = lackOfSteadiness(isTop, roots);
  }
  const psi = SHAPES[state.shape].includes("psi") ? state.psi * DEGREE : 0;
  const start = startFromAngles({ theta, psi, phiRate, thetaRate, omega3: state.omega3 });
  const hasThreshold = isTop && body.mgl > 0;
  return { body, start, roots, phiRate, thetaRate, lack, isTop, threshold: hasThreshold ? criticalOmega3(body) : 0 };
}

function lackOfSteadiness(isTop, roots) {
  if (!isTop) return say("steady_symmetric");
  return say(roots.length ? "steady_horizontal" : "steady_slow");
}

/** The state as a link: what follows the #. Losses and drives that are zero are left out. */
export function linkOf(state) {
  const names = numbersOf(state).filter((name) => NUMBERS[name].part !== "losses" || state[name]);
  const fields = [["shape", state.shape], ...names.map((name) => [name, String(state[name])])];
  if (state.precession !== "given") fields.push(["precession", state.precession]);
  return fields.map(([name, value]) => `${name}=${value}`).join("&");
}

/** The preset that has a state; empty if none has. */
export function presetOf(state) {
  const link = linkOf(state);
  return Object.keys(PRESETS).find((key) => linkOf(complete(PRESETS[key])) === link) ?? "";
}

/**
 * The state of a link, with the number of `nutations` if it gives one instead of a time; null if it holds none.
 * What it does not hold, or is not possible, is as at first.
 */
export function stateOfLink(link) {
  const fields = new URLSearchParams(link.replace(/^#/, ""));
  const shape = fields.get("shape");
  if (!Object.hasOwn(SHAPES, shape ?? "")) return null;
  const state = complete({ shape });
  for (const [name, text] of fields) {
    if (Object.hasOwn(NUMBERS, name) && text.trim() !== "" && !refusal(name, Number(text))) state[name] = Number(text);
  }
  const nutations = Number(fields.get("nutations"));
  if (nutations > 0 && nutations <= 200 && !fields.has("t_end")) state.nutations = nutations;
  if (["slow", "fast"].includes(fields.get("precession"))) state.precession = fields.get("precession");
  return state;
}

/** The state as an input of the program. */
export function inputOf(state) {
  const { body, phiRate, thetaRate } = resolve(state);
  const number = (value) => (Number.isInteger(value) ? `${value}.0` : String(value));
  const list = (values) => values.map(number).join(", ");
  const key = (name, ...values) => `${name} = ${list(values)}`;
  const needs = SHAPES[state.shape];
  const [[a, b, c], [p, q, r]] = [body.inertia, body.products];
  const centre = key("centre_of_mass", ...body.centre);
  const moments = [key("mass", body.mass), key("inertia", a, b, c)];
  const top = {
    inertia: [...moments, key("length", body.centre[2])],
    body: [...moments, centre],
    tensor: [
      moments[0], key("inertia_tensor(1,:)", a, r, q), key("inertia_tensor(2,2:3)", b, p), key("inertia_tensor(3,3)", c), centre,
    ],
  }[state.shape] ?? [
    `shape = '${state.shape}'`,
    ...needs.filter((name) => !name.startsWith("damping")).map((name) => key(name, state[name])),
  ];
  top.push(key("gravity", state.gravity));
  if (body.damping.some(Boolean)) top.push(key("damping", ...body.damping));
  const start = [key("theta_deg", state.theta), key("omega3", state.omega3)];
  if (needs.includes("psi") && state.psi !== 0) start.push(key("psi_deg", state.psi));
  if (phiRate !== 0) start.push(key("phi_rate", phiRate));
  if (thetaRate !== 0) start.push(key("theta_rate", thetaRate));
  const effects = body.friction ? [key("friction_torque", body.friction)] : [];
  if (body.isVibrated) {
    effects.push(key("vibration_amplitude", 0, 0, body.amplitude), key("vibration_rate", body.vibrationRate));
  }
  const group = (name, lines) => `&${name}\n${lines.map((line) => `    ${line}\n`).join("")}/\n`;
  return [
    group("study", [`title = '${say("input_title")}'`]),
    group("top", top),
    group("initial", start),
    group("span", [key("t_end", state.t_end)]),
    ...(effects.length ? [group("effects", effects)] : []),
  ].join("\n");
}
