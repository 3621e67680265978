// Numbers and times as words.

const DEGREE = 180 / Math.PI;
const FIGURES = 7;
const FIGURE_SPACE = "\u2007"; // as wide as a digit
const NOTHING = "\u2013";

let mark = "."; // of the decimals

/** Write numbers with this mark before their decimals. */
export function setDecimalMark(character) {
  mark = character;
}

/** An angle in degrees. */
export function inDegrees(angle, decimals = 3) {
  return `${minus((angle * DEGREE).toFixed(decimals))}°`;
}

/** An angle in degrees, with a few figures where it is small. */
export function inFewDegrees(angle) {
  const degrees = angle * DEGREE;
  if (degrees === 0) return "0°";
  const text = Math.abs(degrees) < 0.01 ? degrees.toExponential(1) : degrees.toFixed(2);
  const [mantissa, power] = text.split("e");
  return power ? `${minus(mantissa)} × 10${superscript(power)}°` : `${minus(text)}°`;
}

function superscript(power) {
  const signs = { "-": "⁻", "+": "" };
  return [...power].map((sign) => signs[sign] ?? "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(sign)]).join("");
}

/** A number as it stands in the table, or with the figures that one can read while it moves. */
export function inFull(value, isOfTable) {
  return minus(isOfTable ? String(value) : value.toPrecision(FIGURES));
}

/** A number with a few figures. */
export function inShort(value) {
  return minus(String(Number(value.toPrecision(4))));
}

/** A number with so many figures, zeros at its end too, so that its text keeps its width. */
export function inFigures(value, figures = 4) {
  return minus(value.toPrecision(figures));
}

/** A number with all its digits, as one types it. */
export function inBox(value) {
  return String(value).replace(".", mark);
}

/** How many decimals numbers up to a size need for so many figures. */
export function decimalsFor(size, figures = 6) {
  return Math.min(Math.max(figures - 1 - Math.floor(Math.log10(size || 1)), 0), 9);
}

/** A number in words, as a function writes it; a dash where there is none. */
export function orDash(value, write) {
  return Number.isFinite(value) ? write(value) : NOTHING;
}

/** A number with so many decimals; a dash where there is none. */
export function withDecimals(value, decimals) {
  return orDash(value, () => minus(value.toFixed(decimals)));
}

/** Numbers as texts, filled up so that their decimal points are one above the other. */
export function aligned(texts) {
  const behind = texts.map((text) => (text.includes(mark) ? text.length - text.indexOf(mark) : 0));
  const most = Math.max(...behind);
  return texts.map((text, i) => text + FIGURE_SPACE.repeat(most - behind[i]));
}

/** With a true minus sign, none before a zero, and the decimal mark. */
export function minus(text) {
  return (Number(text) === 0 ? text.replace("-", "") : text.replaceAll("-", "\u2212")).replace(".", mark);
}

/** Put a copy of a template in an element; what of it has a `data-part`, by these names. */
export function fillIn(element, template) {
  element.append(template.content.cloneNode(true));
  return Object.fromEntries([...element.querySelectorAll("[data-part]")].map((part) => [part.dataset.part, part]));
}
