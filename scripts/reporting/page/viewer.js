// One moving top with its controls, wired together.

import { accountOf, momentOf } from "./account.js";
import { Bar } from "./bar.js";
import { Comparison } from "./comparison.js";
import { say } from "./live/language.js";
import { Player } from "./player.js";
import { Plot, forgetColours } from "./plot.js";
import { Readout } from "./readout.js";
import { Stage } from "./stage/stage.js";
import { fillIn, inShort } from "./text.js";

const QUIET = 600; // ms without a change before it is announced
const NEAR = "300px"; // tops that far from the screen are prepared
const VECTORS = ["force", "momentum", "omega"];
const LATER = "omega"; // an arrow that is shown when it is asked for
const PAGES = 10; // of which PageUp and PageDown go one

export class Viewer {
  #frame = 0;
  #announcing = 0;

  /** @param section where it goes @param motion what it shows @param peers other motions of its scene */
  constructor(section, motion, peers) {
    this.motion = motion;
    this.section = section;
    const parts = fillIn(section, document.getElementById("top"));
    this.parts = parts;
    this.readout = new Readout(parts, motion);
    this.stage = new Stage(parts.stage, { calm: matchMedia("(prefers-reduced-motion: reduce)").matches });
    this.player = new Player(motion.start, motion.end, () => this.#update());
    const pick = (time) => this.#goTo(motion.rowNear(time));
    this.comparison = new Comparison(parts, motion, peers, { onChange: () => this.#setTops(), onPick: pick });
    this.plot = new Plot(parts.chart, pick, { isBare: true });
    this.bar = new Bar(section, parts, this.player, this.stage, (how, sign) => this.#go(how, sign));
    this.#fill();
    this.#setTops();
    this.#watch();
    this.comparison.begin();
  }

  #fill() {
    const { parts, motion } = this;
    this.bar.suit(motion.end - motion.start);
    parts.account.textContent = accountOf(motion);
    parts.notes.replaceChildren(
      ...motion.notes.map((note) => Object.assign(document.createElement("li"), { textContent: note })),
    );
    parts.stage.setAttribute("aria-label", `${say("stage")}: ${motion.title}`);
    parts.time.max = motion.count - 1;
    parts.time.addEventListener("input", () => this.#goTo(Number(parts.time.value)));
    for (const name of ["trace", ...VECTORS]) {
      if (name !== "trace") {
        const isThere = Boolean(motion.vectors[name]);
        Object.assign(parts[name], { disabled: !isThere, checked: isThere && name !== LATER });
      }
      const set = () => this.stage.setVisible(name, parts[name].checked);
      parts[name].addEventListener("change", set);
      set();
    }
    const theta = { t: motion.t, values: motion.column("angles", 1), colour: "quiet", width: 1.3 };
    this.plot.draw([motion.start, motion.end], [theta]);
  }

  /** The scene is drawn while it is on the screen or near: browsers have few WebGL contexts. */
  #watch() {
    new IntersectionObserver(([entry]) => {
      if (entry.isIntersecting) this.stage.open();
      else if (this.stage.isOpen) {
        this.player.pause();
        this.stage.close();
      }
    }, { rootMargin: NEAR }).observe(this.section);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      forgetColours();
      this.stage.recolour();
      this.plot.redraw();
      this.comparison.plot.redraw();
    });
  }

  /** Put the top on the stage, and the ghost of the motion that it is compared with. */
  #setTops() {
    const { motion, comparison: { pair } } = this;
    const tops = [{ body: motion.body, trace: motion.trace(), look: "solid" }];
    if (pair) tops.push({ body: pair.other.body, trace: pair.other.trace(), look: "ghost" });
    this.stage.setTops(tops, motion.vectors);
    this.#update();
  }

  /** Pause at a row; one before the first or after the last is the first or the last. */
  #goTo(row) {
    const { t, count } = this.motion;
    this.player.seek(t[Math.min(Math.max(row, 0), count - 1)]);
  }

  /** So many rows further on, or back; between rows the next row counts as one. */
  #go(how, sign) {
    const { motion, player: { time } } = this;
    const rows = { step: 1, page: Math.max(1, Math.round(motion.count / PAGES)), end: motion.count }[how];
    const row = motion.rowBefore(time);
    this.#goTo(row + sign * rows + (motion.t[row] !== time && sign < 0 ? 1 : 0));
  }

  /** Bring everything up to the player's time, now and while it plays. */
  #update() {
    const { parts, motion, player, comparison } = this;
    const moment = motion.at(player.time);
    this.readout.show(moment);
    comparison.show(moment);
    parts.time.value = moment.row ?? motion.rowBefore(player.time);
    parts.time.setAttribute("aria-valuetext", `t = ${inShort(moment.time)} s`);
    this.bar.show();
    this.plot.place(moment.time);
    this.stage.show(this.#staged(moment));
    this.#announce();
    cancelAnimationFrame(this.#frame);
    if (!player.playing) return;
    this.#frame = requestAnimationFrame((now) => {
      player.tick(now);
      if (player.playing) this.#update();
    });
  }

  /** A moment as the stage shows it. */
  #staged({ time, attitude, vectors }) {
    const { pair } = this.comparison;
    return { time, attitudes: pair ? [attitude, pair.otherAt(time).attitude] : [attitude], vectors };
  }

  /** The top as a picture for paper, at its moment, or at its end where it is at its start. */
  still(width, height) {
    const { motion, player, stage } = this;
    const moment = motion.at(player.time > motion.start ? player.time : motion.end);
    return { address: stage.still(width, height, this.#staged(moment)), moment };
  }

  /** Say where it is once it has come to rest, and nothing while it moves. */
  #announce() {
    clearTimeout(this.#announcing);
    if (this.player.playing) return;
    this.#announcing = setTimeout(() => {
      this.parts.live.textContent = momentOf("moment", this.motion.at(this.player.time));
    }, QUIET);
  }
}
