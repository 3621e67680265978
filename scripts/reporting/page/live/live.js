// A live top: its controls, its picture and its charts, wired together. Whatever one sets, the motion
// is computed anew and shown in the next frame.

import { Vector3 } from "three";
import { Bar } from "../bar.js";
import { Player } from "../player.js";
import { Plot, forgetColours } from "../plot.js";
import { fillIn } from "../text.js";
import { Control, suitRanges } from "./controls.js";
import { Grip } from "./grip.js";
import { fillWords, linkOfLanguage, say } from "./language.js";
import { accountOf, fillPanel, showMoment } from "./panel.js";
import { Picture } from "./picture.js";
import PRESETS from "./presets.json"; // their states, and why it is these numbers; the dictionary says what one sees
import { NUMBERS, SHAPES, complete, consequenceOf, inputOf, linkOf, presetOf, stateOfLink } from "./scene.js";
import { Second } from "./second.js";
import { COARSE, FINE, Track } from "./track.js";

const FIRST = "cusp"; // the preset with which the page begins
const QUIET = 500; // ms without a change before it is announced and the link holds it
const ANGLES = ["theta", "phi", "psi"];
const ENERGIES = { kinetic: "kinetic", potential: "potential", energy: "ink" }; // and the colours of their lines
const PARTS = { step: 1 / 200, page: 1 / 10, end: 1 }; // of the span that keys go
const STILL = [1920, 1080]; // pixels of a picture
let made = 0;

/** The time of so many nutations of a state, s; of a motion that has none, as many seconds. */
function timeOf(state, nutations) {
  const { period } = new Track(complete({ ...state, t_end: 1e-6 })).nutation ?? {};
  return Number((nutations * (Number.isFinite(period) ? period : 1)).toPrecision(6));
}

export class LiveTop {
  #frame = 0;
  #isChanged = true;
  #isCoarse = false; // fewer points than there shall be, for speed
  #quiet = 0;

  /**
   * @param section where it goes @param template what it is made of @param state what it begins with
   * @param ownsLink whether the address of the page holds the state
   */
  constructor(section, template, { state = null, ownsLink = false } = {}) {
    made += 1;
    this.section = section;
    this.ownsLink = ownsLink;
    this.parts = fillIn(section, template);
    fillWords(section);
    this.isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.clock = new Player(0, 1, () => {
      this.bar.show();
      this.#request();
    }, { isEndless: true });
    this.picture = new Picture(this.parts, this.isCalm);
    this.stage = this.picture.stage;
    this.plots = Object.fromEntries([...ANGLES, "energy"].map((name) => [
      name, new Plot(this.parts[`plot_${name}`], (time) => this.clock.seek(time)),
    ]));
    this.bar = new Bar(section, this.parts, this.clock, this.stage, (how, sign) => {
      this.clock.seek(this.clock.time + sign * PARTS[how] * this.track.span);
    });
    this.#makeControls();
    this.#wire();
    const link = ownsLink ? location.hash : "";
    this.load(state ?? stateOfLink(link), { link });
    this.#watch();
    this.#openStage();
    if (this.isCalm) this.clock.pause();
    else this.clock.play();
  }

  /** Once the panel and the charts are on the screen: to compile the shaders may take a second. */
  #openStage() {
    requestAnimationFrame(() => setTimeout(() => this.stage.open()));
  }

  #makeControls() {
    const { parts } = this;
    const prefix = `live${made}`;
    parts.preset.append(
      ...Object.keys(PRESETS).map((key) => new Option(say(`preset_${key}`), key)),
      new Option(say("preset_none"), ""),
    );
    parts.shape.append(...Object.keys(SHAPES).map((key) => new Option(say(`shape_${key}`), key)));
    this.controls = {};
    for (const [name, { part }] of Object.entries(NUMBERS)) {
      this.controls[name] = new Control(name, prefix, (value) => this.change({ [name]: value }));
      parts[part].append(this.controls[name].element);
    }
    this.second = new Second(this, prefix);
  }

  #wire() {
    const { parts } = this;
    parts.preset.addEventListener("change", () => {
      const preset = parts.preset.value;
      if (preset) this.load(PRESETS[preset], { preset });
    });
    parts.shape.addEventListener("change", () => {
      this.change({ shape: parts.shape.value });
      suitRanges(this.controls, this.state);
    });
    parts.precession.addEventListener("change", () => this.change({ precession: parts.precession.value }));
    parts.threshold.addEventListener("click", () => {
      this.set({ omega3: Number(this.track.threshold.toPrecision(12)) });
    });
    parts.time.addEventListener("input", () => {
      this.clock.seek((Number(parts.time.value) / Number(parts.time.max)) * this.track.span);
    });
    parts.screen.hidden = !document.fullscreenEnabled;
    parts.screen.addEventListener("click", () => {
      if (document.fullscreenElement) document.exitFullscreen();
      else this.section.requestFullscreen();
    });
    document.addEventListener("fullscreenchange", () => {
      parts.screen.textContent = say(document.fullscreenElement ? "screen_leave" : "screen");
    });
    parts.link.hidden = !this.ownsLink;
    parts.link.addEventListener("click", () => this.#copy(location.href, "copied_link"));
    parts.copy.addEventListener("click", () => this.#copy(parts.input.textContent, "copied_input"));
    parts.picture.addEventListener("click", () => {
      Object.assign(document.createElement("a"), { href: this.stage.still(...STILL), download: "spintop.png" }).click();
    });
    this.grip = new Grip(this);
  }

  async #copy(text, done) {
    try {
      await navigator.clipboard.writeText(text);
      this.parts.said.textContent = say(done);
    } catch {
      this.parts.said.textContent = say("copy_refused");
    }
  }

  #watch() {
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#recolour());
    addEventListener("beforeprint", () => this.#putOnPaper());
    addEventListener("afterprint", () => this.#recolour());
    addEventListener("hashchange", () => {
      const link = location.hash;
      const state = this.ownsLink && stateOfLink(link);
      if (state && link !== `#${this.link()}`) this.load(state, { link });
    });
  }

  #recolour() {
    forgetColours();
    this.stage.recolour();
    for (const plot of Object.values(this.plots)) plot.redraw();
  }

  /** On paper the stage is a picture, and all is in the colours of paper. */
  #putOnPaper() {
    document.documentElement.dataset.paper = "yes";
    this.#recolour();
    this.parts.still.src = this.stage.still(...STILL);
    delete document.documentElement.dataset.paper;
    this.stage.recolour();
  }

  /** What the address has after its #: the state, the second top, and the language, if it asks for one. */
  link(language = linkOfLanguage()) {
    return [linkOf(this.state), this.second.link(), language].filter(Boolean).join("&");
  }

  /** Show a state, with ranges and a speed that suit it; of a `link` also its second top. */
  load(state, { preset = null, link = "" } = {}) {
    const { nutations, why, ...given } = state ?? PRESETS[FIRST];
    this.state = complete(given);
    Object.assign(this.state, consequenceOf(this.state, {}).fields);
    if (nutations) this.state.t_end = timeOf(this.state, nutations);
    this.#namePreset(preset ?? presetOf(this.state));
    this.parts.limits.textContent = "";
    for (const name of Object.keys(NUMBERS)) this.controls[name].set(this.state[name]);
    this.parts.shape.value = this.state.shape;
    this.parts.precession.value = this.state.precession;
    suitRanges(this.controls, this.state);
    this.second.readLink(link);
    this.second.follow();
    this.clock.time = 0;
    this.#compute();
    this.bar.suit(this.track.span);
    this.#request();
  }

  /** Change parameters. */
  change(fields) {
    Object.assign(this.state, fields);
    const { fields: others, words } = consequenceOf(this.state, fields);
    Object.assign(this.state, others);
    for (const [name, value] of Object.entries(others)) this.controls[name].set(value);
    this.parts.limits.textContent = words;
    this.#namePreset("");
    this.second.follow();
    this.requestMotion();
  }

  /** Change parameters, and have their controls show it. */
  set(fields) {
    for (const [name, value] of Object.entries(fields)) this.controls[name].set(value);
    this.change(fields);
  }

  #namePreset(key) {
    this.parts.preset.value = key;
    this.parts.preset_words.textContent = key && say(`preset_${key}_words`);
  }

  /** The motion of the state in so many points at most, and all that is drawn of it but the moment. */
  #compute(most = FINE) {
    const began = performance.now();
    this.#isChanged = false;
    this.track = new Track(this.state, most);
    this.second.compute(most);
    this.#isCoarse = most === COARSE && !(this.track.isComplete && (this.second.track?.isComplete ?? true));
    this.clock.end = this.track.span;
    this.clock.time = Math.min(this.clock.time, this.track.span);
    this.#fill();
    this.#settle();
    this.section.dispatchEvent(new CustomEvent("computed", { detail: performance.now() - began }));
  }

  /** Bring picture, charts and panel up to the motions. */
  #fill() {
    const { state, track, second } = this;
    const tops = [{ state, track, look: "solid", pane: 0 }];
    if (second.state) {
      const place = second.isBeside ? { look: "solid", pane: 1 } : { look: "ghost", pane: 0 };
      tops.push({ state: second.state, track: second.track, ...place });
    }
    this.picture.fill(tops);
    this.#draw(track, second.state && second.track);
    fillPanel(this);
  }

  /** Draw all charts of a track, and the angles of another beside it. */
  #draw(track, other) {
    const span = [0, track.wanted];
    for (const name of ANGLES) {
      const line = (of, colour) => ({ t: of.t, values: of[name].map((angle) => (angle * 180) / Math.PI), colour });
      const beside = other ? [line(other, "quiet")] : [];
      this.plots[name].draw(span, [...beside, line(track, "trace")], { least: 1e-3 });
    }
    const lines = Object.entries(ENERGIES).map(([name, colour]) => ({ t: track.t, values: track[name], colour }));
    this.plots.energy.draw(span, lines);
  }

  /** Once it is quiet: all points, the words for those who do not see it, the link, and the input. */
  #settle() {
    clearTimeout(this.#quiet);
    this.#quiet = setTimeout(() => {
      if (this.#isCoarse) {
        this.#compute();
        clearTimeout(this.#quiet);
        this.#request();
      }
      this.#tell();
    }, QUIET);
  }

  #tell() {
    const { parts } = this;
    const account = accountOf(this.track);
    parts.live.textContent = account;
    parts.stage.setAttribute("aria-label", `${say("stage")}. ${account}`);
    parts.input.textContent = inputOf(this.state);
    if (this.ownsLink) history.replaceState(null, "", `#${this.link()}`);
  }

  /** Compute the motions anew, for the next frame of the screen. */
  requestMotion() {
    this.#isChanged = true;
    this.#request();
  }

  #request() {
    if (!this.#frame) this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  /** A frame of the screen: what has changed, and the moment. */
  #tick(now) {
    this.#frame = 0;
    if (this.#isChanged) this.#compute(COARSE);
    const began = performance.now();
    this.clock.tick(now);
    this.#show();
    this.section.dispatchEvent(new CustomEvent("frame", { detail: performance.now() - began }));
    if (this.clock.playing) this.#request();
  }

  /** Show the moment of the clock. */
  #show() {
    const moment = this.picture.show(this.clock.time);
    for (const plot of Object.values(this.plots)) plot.place(moment.t);
    showMoment(this.parts, moment, this.track);
  }

  /** The axis at the moment that is shown. */
  axisNow() {
    return new Vector3(...this.track.at(this.clock.time).axis);
  }
}
