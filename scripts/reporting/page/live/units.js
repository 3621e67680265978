// Numbers with units, as one types them: "300 rpm", "300 U/min", "20 deg", "3 g cm^2", "0,5".

import { say, spoken } from "./language.js";

const [LENGTH, MASS, TIME, ANGLE] = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];
const DEGREE = Math.PI / 180;

/** Size in SI units, and the exponents of metre, kilogram, second and radian. */
const UNITS = {
  m: [1, LENGTH], cm: [1e-2, LENGTH], mm: [1e-3, LENGTH], km: [1e3, LENGTH], in: [0.0254, LENGTH],
  kg: [1, MASS], g: [1e-3, MASS], mg: [1e-6, MASS],
  s: [1, TIME], ms: [1e-3, TIME], min: [60, TIME], h: [3600, TIME],
  rad: [1, ANGLE], deg: [DEGREE, ANGLE], "°": [DEGREE, ANGLE], Grad: [DEGREE, ANGLE], "degrés": [DEGREE, ANGLE],
  rev: [2 * Math.PI, ANGLE], U: [2 * Math.PI, ANGLE], tr: [2 * Math.PI, ANGLE],
  rpm: [(2 * Math.PI) / 60, [0, 0, -1, 1]], rps: [2 * Math.PI, [0, 0, -1, 1]], Hz: [2 * Math.PI, [0, 0, -1, 1]],
  N: [1, [1, 1, -2, 0]], J: [1, [2, 1, -2, 0]],
};
const WORD = /^\s*([/*·]?)\s*([\p{L}°]+)\s*(?:\^?\s*(-?\d)|([²³]))?/u;
const PER_MINUTE = /^\s*1?\s*\/\s*min\s*$/; // what stands on motors, for turns

/** A product of units as its size and exponents; null if a word is none. */
function readUnit(text) {
  let [size, powers, rest] = [1, [0, 0, 0, 0], text];
  while (rest.trim() !== "") {
    const [all, sign, name, digits, raised] = WORD.exec(rest) ?? [];
    if (!all || !Object.hasOwn(UNITS, name)) return null;
    const [factor, exponents] = UNITS[name];
    const power = (sign === "/" ? -1 : 1) * Number(digits ?? ({ "²": 2, "³": 3 })[raised] ?? 1);
    size *= factor ** power;
    powers = powers.map((value, k) => value + power * exponents[k]);
    rest = rest.slice(all.length);
  }
  return { size, powers };
}

/** Thousands in groups, as one writes them in the language that is spoken: "1,500" or "1.500"; "1 500" in all. */
function grouped() {
  const mark = spoken() === "en" ? "," : ".";
  return new RegExp(`^[+-]?[1-9]\\d{0,2}([${mark}\\s]\\d{3})+(?!\\d)`);
}

/** The number that a text means in a unit: `value`, or the `fault` of the text. */
export function readQuantity(text, unit) {
  const signed = text.trim().replaceAll("\u2212", "-");
  const clean = signed.replace(grouped(), (digits) => digits.replace(/[,.\s]/g, "")).replace(",", ".");
  const [number] = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?/i.exec(clean) ?? [];
  if (number === undefined) return { fault: say("fault_number") };
  const words = clean.slice(number.length);
  if (words.trim() === "") return { value: Number(number) };
  const [given, own] = [readUnit(words.replace(PER_MINUTE, "rpm")), readUnit(unit)];
  if (!given) return { fault: say("fault_no_unit", { unit: words.trim() }) };
  if (given.powers.some((power, k) => power !== own.powers[k])) {
    return { fault: say(unit ? "fault_unit" : "fault_unitless", { unit: words.trim(), own: unit }) };
  }
  return { value: Number(number) * (given.size / own.size) };
}
