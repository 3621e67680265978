// The second top: a motion kept in grey in the same picture, or shown in a picture beside the first. It stays as it
// was, or it has all numbers of the first top but one.

import { inShort } from "../text.js";
import { Control } from "./controls.js";
import { say } from "./language.js";
import { classOf } from "./panel.js";
import { NUMBERS, complete, consequenceOf, numbersOf, refusal } from "./scene.js";
import { FINE, Track } from "./track.js";

const KEY = "second"; // of the link: the number in which it differs, and its value
const FIRST_DIFFERENCE = "omega3";

export class Second {
  #isChanged = false;
  #names = ""; // in which it may differ

  /** Its state, null if there is no second top. */
  state = null;
  /** The number in which alone it differs from the first; empty if it stays as it was. */
  differs = "";

  /** @param live the live top, whose controls are wired @param prefix of the names of controls */
  constructor(live, prefix) {
    this.live = live;
    this.prefix = prefix;
    const { parts } = live;
    parts.keep.addEventListener("click", () => this.keep(!this.state));
    parts.second_look.append(...["ghost", "beside"].map((look) => new Option(say(`second_${look}`), look)));
    parts.second_look.addEventListener("change", () => {
      if (this.isBeside && !this.differs) this.#differIn(FIRST_DIFFERENCE);
      live.requestMotion();
    });
    parts.differs.addEventListener("change", () => {
      this.#differIn(parts.differs.value);
      live.requestMotion();
    });
  }

  /** Whether it has a picture of its own. */
  get isBeside() {
    return Boolean(this.state) && this.live.parts.second_look.value === "beside";
  }

  /** Keep the motion of the first top as the second, which then is as it was; or remove it. */
  keep(on) {
    const { live } = this;
    this.#begin(on ? { ...live.state } : null);
    this.#differIn("");
    live.parts.second_look.value = "ghost";
    live.requestMotion();
  }

  #begin(state) {
    const { parts } = this.live;
    this.state = state;
    this.#isChanged = true;
    parts.second.hidden = !state;
    parts.keep.setAttribute("aria-pressed", String(Boolean(state)));
    parts.keep.textContent = say(state ? "second_remove" : "second_keep");
  }

  /** Differ in a number alone, whose control stands below; in none: stay as it is. */
  #differIn(name) {
    const { live, live: { parts } } = this;
    this.differs = name;
    parts.second_control.replaceChildren();
    if (!name || !this.state) return;
    const control = new Control(name, `${this.prefix}-second`, (value) => {
      this.state[name] = value;
      this.#isChanged = true;
      live.requestMotion();
    });
    parts.second_control.append(control.element);
    control.setRange(live.controls[name].low, live.controls[name].high);
    control.set(this.state[name]);
    this.follow();
  }

  /** Take the numbers of the first top, but for the one in which it differs. */
  follow() {
    if (!this.state || !this.differs) return;
    const { state } = this.live;
    if (!numbersOf(state).includes(this.differs)) this.#differIn(FIRST_DIFFERENCE);
    const own = { ...state, [this.differs]: this.state[this.differs] };
    this.state = { ...own, ...consequenceOf(own, {}).fields };
    this.#isChanged = true;
  }

  /** Compute its motion in so many points, if that is another one or shall have all points. */
  compute(most) {
    if (!this.state || !(this.#isChanged || (most === FINE && !this.track.isComplete))) return;
    this.track = new Track(this.state, most);
    this.#isChanged = false;
  }

  /** Say how it differs, and what each of two pictures shows. */
  describe(first) {
    const { live, live: { parts } } = this;
    const names = numbersOf(live.state);
    parts.names.hidden = !this.isBeside;
    parts.kept.textContent = this.state ? this.#difference() : "";
    if (!this.state) return;
    if (this.#names !== String(names)) this.#listNumbers(names);
    parts.differs.value = this.differs;
    if (!this.isBeside) return;
    parts.first_name.textContent = this.#nameOf(live.state, first);
    parts.second_name.textContent = this.#nameOf(this.state, this.track);
  }

  /** The numbers of a state as those in which the second top may differ. */
  #listNumbers(names) {
    this.#names = String(names);
    const numbers = names.map((name) => new Option(`${NUMBERS[name].symbol} ${say(`number_${name}`)}`, name));
    this.live.parts.differs.replaceChildren(new Option(say("differs_all"), ""), ...numbers);
  }

  #nameOf(state, track) {
    return [this.differs && valueOf(this.differs, state), classOf(track).name].filter(Boolean).join(": ");
  }

  #difference() {
    const [first, second] = [this.live.state, this.state];
    const look = this.isBeside ? "beside" : "grey";
    const others = numbersOf(second).filter((name) => second[name] !== first[name]);
    if (second.shape !== first.shape) return say(`${look}_another`);
    if (!others.length) return say(`${look}_same`);
    return say(`${look}_numbers`, { numbers: others.map((name) => valueOf(name, second)).join(", ") });
  }

  /** What a link needs to have this second top; empty for one that stays as it was. */
  link() {
    if (!this.state || !this.differs) return "";
    return `${KEY}=${this.differs}:${this.state[this.differs]}${this.isBeside ? "&beside=yes" : ""}`;
  }

  /** Have the second top of a link, if it has one that is possible. */
  readLink(link) {
    const fields = new URLSearchParams(link.replace(/^#/, ""));
    const [name, text = ""] = (fields.get(KEY) ?? "").split(":");
    const isNumber = numbersOf(this.live.state).includes(name) && text.trim() !== "" && !refusal(name, Number(text));
    if (!isNumber) return;
    this.#begin(complete({ ...this.live.state, [name]: Number(text) }));
    this.live.parts.second_look.value = fields.get("beside") === "yes" ? "beside" : "ghost";
    this.#differIn(name);
  }
}

/** A number of a state with its symbol and unit. */
function valueOf(name, state) {
  const { symbol, unit } = NUMBERS[name];
  return `${symbol} = ${inShort(state[name])} ${unit}`;
}
