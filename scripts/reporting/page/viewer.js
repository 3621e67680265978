// One moving top with its controls, wired together.

import { Comparison } from "./comparison.js";
import { bindKeys } from "./keys.js";
import { Player, speedsFor } from "./player.js";
import { Plot } from "./plot.js";
import { Readout } from "./readout.js";
import { Stage } from "./stage/stage.js";
import { accountOf, inShort, momentOf } from "./text.js";

const QUIET = 600; // ms without a change before it is announced
const NEAR = "300px"; // tops that far from the screen are prepared
const VECTORS = ["force", "momentum", "omega"];
const LATER = new Set(["omega"]); // arrows that are shown when they are asked for

export class Viewer {
  #frame = 0;
  #announcing = 0;

  /** @param section where it goes @param motion what it shows @param peers other motions of its scene */
  constructor(section, motion, peers) {
    this.motion = motion;
    const { speeds, initial } = speedsFor(motion.end - motion.start);
    this.player = new Player(motion, initial);
    section.append(document.getElementById("top").content.cloneNode(true));
    this.parts = Object.fromEntries(
      [...section.querySelectorAll("[data-part]")].map((part) => [part.dataset.part, part]),
    );
    this.section = section;
    this.readout = new Readout(this.parts, motion);
    this.stage = new Stage(this.parts.stage, {
      calm: matchMedia("(prefers-reduced-motion: reduce)").matches,
    });
    this.comparison = new Comparison(this.parts, motion, peers, {
      onChange: () => this.#setTops(),
      onPick: (time) => this.#goTo(time),
    });
    this.#fill(speeds);
    this.#wire();
    this.#setTops();
    this.#watch();
    this.comparison.begin();
  }

  #fill(speeds) {
    const { parts, motion } = this;
    parts.account.textContent = accountOf(motion);
    parts.notes.replaceChildren(
      ...motion.notes.map((note) => Object.assign(document.createElement("li"), { textContent: note })),
    );
    parts.stage.setAttribute("aria-label", `The top in space: ${motion.title}`);
    parts.time.max = motion.count - 1;
    parts.speed.append(
      ...speeds.map((speed) => new Option(`${speed} ×`, speed, false, speed === this.player.speed)),
    );
    for (const name of VECTORS) {
      const isThere = Boolean(this.#vectors()[name]);
      parts[name].disabled = !isThere;
      parts[name].checked = isThere && !LATER.has(name);
    }
    const line = { name: "theta", values: motion.angles[1] };
    this.plot = new Plot(parts.chart, motion.t, [line], { span: [motion.start, motion.end] });
  }

  /** All that is shown of the vectors, for the scale of their arrows. */
  #vectors() {
    const { force, momentum, turning } = this.motion;
    return { force, momentum, omega: turning };
  }

  #wire() {
    const { parts, player } = this;
    parts.play.addEventListener("click", () => player.toggle());
    parts.time.addEventListener("input", () => player.goToRow(Number(parts.time.value)));
    parts.speed.addEventListener("change", () => {
      player.speed = Number(parts.speed.value);
    });
    parts.reset.addEventListener("click", () => this.look("reset"));
    for (const name of ["trace", ...VECTORS]) {
      const set = () => this.stage.setVisible(name, parts[name].checked);
      parts[name].addEventListener("change", set);
      set();
    }
    this.plot.onPick = (time) => this.#goTo(time);
    for (const what of ["play", "pause", "time"]) player.addEventListener(what, () => this.#update());
    player.addEventListener("play", () => this.#tick());
    for (const what of ["pause", "time"]) player.addEventListener(what, () => this.#announce());
    bindKeys(this.section, this);
  }

  /** The scene exists while it is on the screen or near: browsers have few WebGL contexts. */
  #watch() {
    new IntersectionObserver(([entry]) => {
      if (entry.isIntersecting) this.#open();
      else this.#close();
    }, { rootMargin: NEAR }).observe(this.section);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.stage.recolour());
  }

  #open() {
    this.stage.open();
    this.parts.flat.hidden = this.stage.dimensions === 3;
  }

  #close() {
    if (!this.stage.dimensions) return;
    this.player.pause();
    this.stage.close();
  }

  /** Put the top on the stage, and the ghost of the motion that it is compared with. */
  #setTops() {
    const { motion, comparison: { pair } } = this;
    const tops = [{ body: motion.body, trace: motion.trace(), look: "solid" }];
    if (pair) tops.push({ body: pair.other.body, trace: pair.other.trace(), look: "ghost" });
    this.stage.setTops(tops, this.#vectors());
    this.#update();
  }

  #goTo(time) {
    this.player.goToRow(this.motion.rowNear(time));
  }

  #tick() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame((now) => {
      this.player.tick(now);
      if (this.player.playing) this.#tick();
    });
  }

  /** Change the view: `turn`, `zoom` or `reset` of the scene. */
  look(how, ...amounts) {
    this.stage.look(how, ...amounts);
  }

  /** A speed faster, or slower. */
  changeSpeed(by) {
    const { speed } = this.parts;
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.length - 1);
    this.player.speed = Number(speed.value);
  }

  /** Bring everything up to the player's time. */
  #update() {
    const { parts, motion, player, comparison } = this;
    const moment = motion.at(player.time);
    this.readout.show(moment);
    comparison.show(moment);
    parts.time.value = moment.row ?? motion.rowBefore(player.time);
    parts.time.setAttribute("aria-valuetext", `t = ${inShort(moment.time)} s`);
    parts.play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    parts.play.dataset.state = player.playing ? "playing" : "paused";
    this.plot.mark(moment.time);
    this.stage.show(this.#staged(moment));
  }

  /** A moment as the stage shows it. */
  #staged(moment) {
    const { time, attitude, vectors } = moment;
    const { pair } = this.comparison;
    return { time, attitudes: pair ? [attitude, pair.otherAt(time).attitude] : [attitude], vectors };
  }

  /** The top as a picture for paper, at its moment, or at its end where it is at its start. */
  still(width, height) {
    const { motion, player, stage } = this;
    const wasOpen = stage.dimensions > 0;
    const moment = motion.at(player.time > motion.start ? player.time : motion.end);
    stage.open();
    stage.show(this.#staged(moment));
    const address = stage.still(width, height);
    if (!wasOpen) stage.close();
    else this.#update();
    return { address, moment };
  }

  /** Say where it is once it has come to rest, and nothing while it moves. */
  #announce() {
    clearTimeout(this.#announcing);
    if (this.player.playing) return;
    this.#announcing = setTimeout(() => {
      this.parts.live.textContent = momentOf(this.motion.at(this.player.time));
    }, QUIET);
  }
}
