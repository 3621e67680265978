// Sliders and boxes of the parameters. A slider and a box show one number; both write it.

import { fillIn, inBox } from "../text.js";
import { say } from "./language.js";
import { NUMBERS, refusal, resolve } from "./scene.js";
import { readQuantity } from "./units.js";

const STEPS = 1000;
const ABOUT = 10; // a slider that goes by ratios covers this factor to both sides

/** A round number that is not smaller. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((digit) => digit * power >= value * (1 - 1e-9));
}

export class Control {
  /** @param prefix of the names of elements @param onChange called with the value when one has changed it */
  constructor(name, prefix, onChange) {
    Object.assign(this, { name, onChange });
    const { symbol, unit, log } = NUMBERS[name];
    const words = say(`number_${name}`);
    const id = `${prefix}-${name}`;
    this.isLog = Boolean(log);
    this.element = Object.assign(document.createElement("div"), { className: "control" });
    this.element.dataset.name = name;
    const parts = fillIn(this.element, document.getElementById("control"));
    Object.assign(this, parts); // slider, box, tick, fault
    parts.title.htmlFor = id;
    parts.symbol.textContent = symbol;
    parts.words.textContent = words;
    parts.unit.textContent = unit;
    this.box.id = id;
    this.fault.id = `${id}-fault`;
    this.slider.max = STEPS;
    this.slider.setAttribute("aria-label", `${words}${unit ? `, ${unit}` : ""}`);
    this.slider.addEventListener("input", () => this.#slide());
    this.box.addEventListener("change", () => this.#type());
  }

  /** The values at the ends of the slider. */
  setRange(low, high) {
    [this.low, this.high] = [low, high];
    this.#put(this.value);
  }

  /** A range that suits a value, where it has none of its own. */
  suit(value) {
    const { range } = NUMBERS[this.name];
    if (range) this.setRange(Math.min(range[0], value), Math.max(range[1], value));
    else if (this.isLog) this.setRange((value || 0.1) / ABOUT, (value || 0.1) * ABOUT);
  }

  set(value) {
    this.#write(value);
    this.#put(value);
  }

  setDisabled(on) {
    this.slider.disabled = on;
    this.box.disabled = on;
  }

  /** Mark a value on the slider; none for null. */
  markAt(value) {
    const part = value === null ? -1 : this.#partOf(value);
    this.tick.hidden = !(part >= 0 && part <= 1);
    this.tick.style.left = `calc(${part} * (100% - 1rem) + 0.5rem)`;
  }

  #partOf(value) {
    return this.isLog
      ? Math.log(Math.max(value, 1e-300) / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
  }

  #put(value) {
    if (this.low === undefined || value === undefined) return;
    if (value > this.high || (value < this.low && !(this.isLog && value <= 0))) {
      if (this.isLog) this.suit(value);
      else [this.low, this.high] = [Math.min(this.low, value), Math.max(this.high, value)];
    }
    this.slider.value = Math.round(STEPS * Math.min(Math.max(this.#partOf(value), 0), 1));
  }

  /** Have the box and those who do not see the slider told the value; the title is for a box that is too narrow. */
  #write(value) {
    this.value = value;
    this.box.value = this.box.title = inBox(value);
    this.slider.setAttribute("aria-valuetext", `${inBox(value)} ${NUMBERS[this.name].unit}`);
    this.#say("");
  }

  #slide() {
    const part = Number(this.slider.value) / STEPS;
    const exact = this.isLog ? this.low * (this.high / this.low) ** part : this.low + part * (this.high - this.low);
    const value = Number(exact.toPrecision(5));
    this.#write(Math.abs(value) < 1e-9 * (this.high - this.low) ? 0 : value);
    this.onChange(this.value);
  }

  /** Take what was typed, a number with or without a unit; the box shows the number that is used. */
  #type() {
    const { unit } = NUMBERS[this.name];
    const before = this.value;
    const read = readQuantity(this.box.value, unit);
    const fault = read.fault ?? refusal(this.name, read.value);
    if (!fault) this.set(read.value);
    this.box.value = inBox(this.value);
    this.#say(fault && say("fault", { fault, value: `${inBox(this.value)}${unit && ` ${unit}`}` }));
    if (this.value !== before) this.onChange(this.value);
  }

  #say(fault) {
    this.fault.hidden = !fault;
    this.fault.textContent = fault;
    if (fault) this.box.setAttribute("aria-describedby", this.fault.id);
    else this.box.removeAttribute("aria-describedby");
  }
}

/** Give the sliders ranges that suit a state. */
export function suitRanges(controls, state) {
  const { body, threshold, roots } = resolve(state);
  for (const [name, control] of Object.entries(controls)) control.suit(state[name]);
  const natural = Math.SQRT2 * body.naturalRate || 1;
  const largest = Math.max(...body.inertia);
  const reach = Math.hypot(...body.centre) || 1;
  const losses = {
    damping1: 0.1 * largest * natural, damping2: 0.1 * largest * natural, damping3: 0.1 * body.inertia3 * natural,
    friction: 0.1 * largest * natural ** 2, amplitude: 0.3 * reach, vibration_rate: 40 * natural,
  };
  for (const [name, most] of Object.entries(losses)) controls[name].setRange(0, roundUp(Math.max(most, state[name])));
  const setSymmetric = (name, ...values) => {
    const most = roundUp(Math.max(...values.map(Math.abs)));
    controls[name].setRange(-most, most);
  };
  for (const name of ["centre_x", "centre_y", "centre_z"]) setSymmetric(name, reach, state[name]);
  for (const name of ["product23", "product31", "product12"]) setSymmetric(name, 0.3 * largest, state[name]);
  const spin = roundUp(Math.max(1.6 * threshold, 1.5 * Math.abs(state.omega3), 1));
  controls.omega3.setRange(state.omega3 < 0 ? -spin : 0, spin);
  const fast = state.precession === "fast" ? 1.2 * (roots[1] ?? 0) : 0;
  setSymmetric("phi_rate", 1.2 * natural, 1.5 * state.phi_rate, fast, 1e-3);
  setSymmetric("theta_rate", 2 * natural, 1.5 * state.theta_rate, 1e-3);
}
