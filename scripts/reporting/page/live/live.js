// A live top: its controls, its stage and its charts, wired together. Whatever one sets, the motion
// is computed anew and shown in the next frame.

import { Quaternion, Vector3 } from "three";
import { speedsFor } from "../player.js";
import { tipOf } from "../stage/solid.js";
import { Stage } from "../stage/stage.js";
import { unitsOf } from "../stage/view.js";
import { Charts, linesOf } from "./charts.js";
import { Clock } from "./clock.js";
import { Control } from "./controls.js";
import { Grip } from "./grip.js";
import { Keeper, STILL } from "./keeper.js";
import { bindKeys } from "./keys.js";
import { fillPanel, showMoment } from "./panel.js";
import { FIRST, PRESETS } from "./presets.js";
import { suitRanges } from "./ranges.js";
import { NUMBERS, SHAPES, complete, consequenceOf, inputOf, linkOf, stateOfLink } from "./scene.js";
import { COARSE, FINE, Track, drawingOf } from "./track.js";
import { Tour } from "./tour.js";
import { accountOf } from "./words.js";

const QUIET = 500; // ms without a change before it is announced and the link holds it
const VECTORS = ["momentum", "omega", "force", "torque", "change"];
const PLOTS = ["theta", "phi", "psi", "energy", "potential", "portrait"];
const SPOKES = 36; // of a cone
const SPHERE = { times: [0, 1, 2, 3, 4, 5], points: [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1] };
let made = 0;

/** Points of a cone about the pivot: its edge, and spokes to it. */
function coneOf(table, perUnit) {
  const edge = new Float32Array(table).map((value) => value * perUnit);
  const count = edge.length / 3;
  const spokes = [];
  for (let k = 0; k <= SPOKES; k += 1) {
    const i = 3 * Math.round(((count - 1) * k) / SPOKES);
    spokes.push(0, 0, 0, edge[i], edge[i + 1], edge[i + 2]);
  }
  return [edge, [...spokes, 0, 0, 0]];
}

/** The time of so many nutations of a state, s; of a motion that has none, as many seconds. */
function timeOf(state, nutations) {
  const { period } = new Track(complete({ ...state, t_end: 1e-6 })).nutation ?? {};
  return Number((nutations * (Number.isFinite(period) ? period : 1)).toPrecision(6));
}

export class LiveTop {
  #frame = 0;
  #isChanged = true;
  #isCoarse = false; // fewer points than there shall be, for speed
  #drawn = "";
  #quiet = 0;

  /**
   * @param section where it goes @param template what it is made of @param state what it begins with
   * @param ownsLink whether the address of the page holds the state
   */
  constructor(section, template, { state = null, ownsLink = false } = {}) {
    made += 1;
    this.section = section;
    this.ownsLink = ownsLink;
    section.append(template.content.cloneNode(true));
    this.parts = Object.fromEntries(
      [...section.querySelectorAll("[data-part]")].map((part) => [part.dataset.part, part]),
    );
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.isCalm = calm;
    this.clock = new Clock();
    this.stage = new Stage(this.parts.stage, { calm });
    this.charts = new Charts(Object.fromEntries(PLOTS.map((name) => [name, this.parts[`plot_${name}`]])));
    this.#makeControls();
    this.#wire();
    this.load(state ?? (ownsLink && stateOfLink(location.hash)) ?? null);
    this.#watch();
    this.#openStage();
    if (calm) this.pause();
    else this.play();
  }

  /** Once the panel and the charts are on the screen: to compile the shaders may take a second. */
  #openStage() {
    requestAnimationFrame(() => setTimeout(() => this.stage.open()));
  }

  #makeControls() {
    const { parts } = this;
    parts.preset.append(
      ...Object.entries(PRESETS).map(([key, { title }]) => new Option(title, key)),
      new Option("as set below", ""),
    );
    parts.shape.append(...Object.entries(SHAPES).map(([key, { name }]) => new Option(name, key)));
    this.controls = {};
    for (const name of Object.keys(NUMBERS)) {
      const control = new Control(name, `live${made}`);
      control.onChange = (key, value) => this.change({ [key]: value });
      this.controls[name] = control;
      parts[NUMBERS[name].part].append(control.element);
    }
    for (const part of ["preset", "shape", "precession", "speed"]) {
      parts[part].id = `live${made}-${part}`;
      this.section.querySelector(`label[data-for=${part}]`).htmlFor = parts[part].id;
    }
  }

  #wire() {
    const { parts } = this;
    parts.preset.addEventListener("change", () => {
      if (parts.preset.value) this.load(PRESETS[parts.preset.value].state, parts.preset.value);
    });
    parts.shape.addEventListener("change", () => {
      this.change({ shape: parts.shape.value });
      suitRanges(this.controls, this.state);
    });
    parts.precession.addEventListener("change", () => this.change({ precession: parts.precession.value }));
    parts.threshold.addEventListener("click", () => {
      this.set({ omega3: Number(this.track.threshold.toPrecision(12)) });
    });
    parts.play.addEventListener("click", () => this.toggle());
    parts.time.addEventListener("input", () => {
      this.seek((Number(parts.time.value) / Number(parts.time.max)) * this.track.span);
    });
    parts.speed.addEventListener("change", () => { this.clock.speed = Number(parts.speed.value); });
    parts.reset.addEventListener("click", () => this.stage.look("reset"));
    parts.screen.hidden = !document.fullscreenEnabled;
    parts.screen.addEventListener("click", () => {
      if (document.fullscreenElement) document.exitFullscreen();
      else this.section.requestFullscreen();
    });
    document.addEventListener("fullscreenchange", () => {
      parts.screen.textContent = document.fullscreenElement ? "Leave full screen" : "Full screen";
    });
    this.tour = new Tour(this);
    parts.keep.addEventListener("click", () => this.keep(!this.kept));
    for (const name of ["body_shown", "trace", "cones", ...VECTORS]) {
      parts[name].addEventListener("change", () => this.#showParts());
    }
    this.keeper = new Keeper(this);
    this.grip = new Grip(this);
    this.charts.onPick = (time) => this.seek(time);
    bindKeys(this.section, this);
  }

  #watch() {
    new ResizeObserver(() => {
      this.charts.resize();
      this.redraw();
    }).observe(this.parts.plots);
    const recolour = () => {
      this.stage.recolour();
      this.redraw();
    };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
    addEventListener("beforeprint", () => this.#putOnPaper());
    addEventListener("afterprint", () => this.redraw());
    if (this.ownsLink) {
      addEventListener("hashchange", () => {
        const state = stateOfLink(location.hash);
        if (state && linkOf(state) !== linkOf(this.state)) this.load(state);
      });
    }
  }

  /** On paper the stage is a picture, and all is in the colours of paper. */
  #putOnPaper() {
    document.documentElement.dataset.paper = "yes";
    this.stage.recolour();
    this.redraw();
    this.stage.open();
    this.parts.still.src = this.stage.still(...STILL);
    delete document.documentElement.dataset.paper;
    this.stage.recolour();
  }

  /** Show a state, with ranges and a speed that suit it. */
  load(state, preset = null) {
    const isFirst = !state;
    const { nutations, ...given } = state ?? PRESETS[FIRST].state;
    this.state = complete(given);
    Object.assign(this.state, consequenceOf(this.state, {}).fields);
    if (nutations) this.state.t_end = timeOf(this.state, nutations);
    this.#namePreset(preset ?? (isFirst ? FIRST : ""));
    this.parts.limits.textContent = "";
    for (const name of Object.keys(NUMBERS)) this.controls[name].set(this.state[name]);
    this.parts.shape.value = this.state.shape;
    this.parts.precession.value = this.state.precession;
    suitRanges(this.controls, this.state);
    this.#isChanged = true;
    this.clock.time = 0;
    this.#compute();
    this.#suitSpeed();
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
    this.#isChanged = true;
    this.#request();
  }

  /** Change parameters, and have their controls show it. */
  set(fields) {
    for (const [name, value] of Object.entries(fields)) this.controls[name].set(value);
    this.change(fields);
  }

  #namePreset(key) {
    this.parts.preset.value = key;
    this.parts.preset_words.textContent = PRESETS[key]?.words ?? "";
  }

  #suitSpeed() {
    const { speeds, initial } = speedsFor(this.track.span);
    this.clock.speed = initial;
    this.parts.speed.replaceChildren(
      ...speeds.map((speed) => new Option(`${speed} ×`, speed, false, speed === initial)),
    );
  }

  /** The motion of the state in so many points at most, and all that is drawn of it but the moment. */
  #compute(most = FINE) {
    const began = performance.now();
    this.#isChanged = false;
    const track = new Track(this.state, most);
    this.#isCoarse = most === COARSE && !track.isComplete;
    this.track = track;
    this.clock.span = track.span;
    this.clock.time = Math.min(this.clock.time, track.span);
    this.#fillStage();
    this.redraw(false);
    fillPanel(this);
    this.#settle();
    const detail = performance.now() - began;
    this.section.dispatchEvent(new CustomEvent("computed", { detail }));
  }

  #fillStage() {
    const { state, track, stage } = this;
    const { body, label } = drawingOf(state, track.body);
    const trace = { times: track.t, points: track.axis };
    const vectors = Object.fromEntries(VECTORS.map((name) => [name, track[name]]));
    const { kept } = this;
    const key = JSON.stringify([body, kept?.drawing]);
    if (key !== this.#drawn) {
      this.#drawn = key;
      this.drawing = body; // the same while the body is the same
      this.tip = tipOf(body);
      const other = kept && { body: kept.drawing, trace: SPHERE, look: "ghost" };
      stage.setTops([{ body, trace: SPHERE, look: "solid" }, other].filter(Boolean), vectors);
      this.#showParts(false);
    }
    stage.setTraces([trace, kept?.trace].filter(Boolean), vectors);
    this.parts.label.textContent = [label, track.lack].filter(Boolean).join(" ");
    this.#setCurves();
  }

  #setCurves() {
    const { track, parts, tip } = this;
    const curves = [];
    if (parts.trace.checked) {
      curves.push({ points: new Float32Array(track.axis).map((value) => value * tip), colour: "faint", width: 1.4 });
    }
    if (parts.cones.checked) {
      const unit = unitsOf([{ body: this.drawing }], { omega: track.omega }).omega;
      for (const [table, colour, frame] of [[track.omega, "omega", "space"], [track.omegaBody, "mark", "body"]]) {
        const [edge, spokes] = coneOf(table, unit);
        curves.push({ points: edge, colour, width: 2, frame }, { points: spokes, colour, width: 0.7, frame });
      }
    }
    this.stage.setCurves(curves);
  }

  /** Show or hide an arrow, the path, or the cones, as its box does. */
  show(name, on) {
    this.parts[name].checked = on;
    this.#showParts();
  }

  #showParts(isShown = true) {
    const { parts, stage } = this;
    stage.setVisible("body", parts.body_shown.checked);
    for (const name of ["trace", ...VECTORS]) stage.setVisible(name, parts[name].checked);
    if (!isShown) return;
    this.#setCurves();
    this.#show();
  }

  /** Keep the motion as a second top in grey, which stays while the sliders change the first; or remove it. */
  keep(on) {
    const { state, track, drawing, parts } = this;
    this.kept = on ? { state: { ...state }, track, drawing, trace: { times: track.t, points: track.axis } } : null;
    parts.keep.setAttribute("aria-pressed", String(on));
    parts.keep.textContent = on ? "Remove the second top" : "Keep as second top";
    this.#fillStage();
    this.redraw();
    fillPanel(this);
  }

  /** Draw the charts, and the moment. */
  redraw(isShown = true) {
    this.charts.draw(this.track, linesOf(this.section), this.kept?.track);
    if (isShown) this.#show();
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
    parts.live.textContent = accountOf(this.track);
    parts.stage.setAttribute("aria-label", `The top in space. ${accountOf(this.track)}`);
    parts.input.textContent = inputOf(this.state);
    if (this.ownsLink) history.replaceState(null, "", `#${linkOf(this.state)}`);
  }

  #request() {
    if (!this.#frame) this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  /** A frame of the screen: what has changed, and the moment. */
  #tick(now) {
    this.#frame = 0;
    if (this.#isChanged) this.#compute(COARSE);
    const began = performance.now();
    const isEnd = this.clock.tick(now);
    if (isEnd) this.keeper.endFilm();
    this.#show();
    this.section.dispatchEvent(new CustomEvent("frame", { detail: performance.now() - began }));
    if (this.clock.playing) this.#request();
  }

  /** Show the moment of the clock. */
  #show() {
    const { parts, track, clock } = this;
    const moment = track.at(clock.time);
    const moments = [moment, this.kept?.track.at(clock.time)].filter(Boolean);
    this.stage.show({
      time: clock.time,
      attitudes: moments.map(({ quaternion: [w, x, y, z] }) => new Quaternion(x, y, z, w)),
      vectors: {
        momentum: new Vector3(...moment.momentum),
        omega: new Vector3(...moment.omegaSpace),
        force: new Vector3(...moment.force),
        torque: new Vector3(...moment.torque),
        change: new Vector3(...moment.change),
      },
    });
    this.charts.show(moment);
    showMoment(parts, moment, track);
  }

  /** The axis at the moment that is shown. */
  axisNow() {
    return new Vector3(...this.track.at(this.clock.time).axis);
  }

  play() {
    this.clock.play();
    this.#showPlay();
    this.#request();
  }

  pause() {
    this.clock.pause();
    this.#showPlay();
  }

  toggle() {
    if (this.clock.playing) this.pause();
    else this.play();
  }

  #showPlay() {
    const { play } = this.parts;
    play.setAttribute("aria-label", this.clock.playing ? "Pause" : "Play");
    play.dataset.state = this.clock.playing ? "playing" : "paused";
  }

  /** Pause at a time. */
  seek(time) {
    this.pause();
    this.clock.time = Math.min(Math.max(time, 0), this.track.span);
    this.#request();
  }

  /** A speed faster, or slower. */
  changeSpeed(by) {
    const { speed } = this.parts;
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.length - 1);
    this.clock.speed = Number(speed.value);
  }
}
