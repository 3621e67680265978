// One moving top with its controls, wired together.

import { Chart } from "./chart.js";
import { coloursOf } from "./colours.js";
import { bindKeys } from "./keys.js";
import { Player, speedsFor } from "./player.js";
import { Scene2D } from "./scene2d.js";
import { Scene3D, hasWebGL } from "./scene3d.js";
import { accountOf, inDegrees, inFull, inShort, momentOf } from "./text.js";

const QUIET = 600; // ms without a change before it is announced
const NEAR = "300px"; // tops that far from the screen are prepared
const VECTORS = ["force", "momentum"];

export class Viewer {
  #frame = 0;
  #announcing = 0;

  /** @param section where it goes @param motion what it shows */
  constructor(section, motion) {
    this.motion = motion;
    const { speeds, initial } = speedsFor(motion.end - motion.start);
    this.player = new Player(motion, initial);
    section.append(document.getElementById("top").content.cloneNode(true));
    this.parts = Object.fromEntries(
      [...section.querySelectorAll("[data-part]")].map((part) => [part.dataset.part, part]),
    );
    this.section = section;
    this.calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.#fill(speeds);
    this.#wire();
    this.#watch();
    this.#update();
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
      parts[name].disabled = !motion[name];
      parts[name].checked = Boolean(motion[name]);
    }
    this.chart = new Chart(parts.chart, motion);
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
      parts[name].addEventListener("change", () => {
        this.scene?.setVisible(name, parts[name].checked);
        this.#update();
      });
    }
    this.chart.onPick = (row) => player.goToRow(row);
    for (const what of ["play", "pause", "time"]) player.addEventListener(what, () => this.#update());
    player.addEventListener("play", () => this.#tick());
    for (const what of ["pause", "time"]) player.addEventListener(what, () => this.#announce());
    bindKeys(this.section, this);
    // The wheel scrolls the page until one has taken hold of the top.
    parts.stage.addEventListener("wheel", (event) => {
      if (document.activeElement !== parts.stage) event.stopPropagation();
    }, { capture: true, passive: true });
    parts.stage.addEventListener("pointerdown", () => parts.stage.focus({ preventScroll: true }));
  }

  /** The scene exists while it is on the screen or near: browsers have few WebGL contexts. */
  #watch() {
    new IntersectionObserver(([entry]) => {
      if (entry.isIntersecting) this.#open();
      else this.#close();
    }, { rootMargin: NEAR }).observe(this.section);
    new ResizeObserver(() => this.#resize()).observe(this.parts.stage);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.scene?.setColours(coloursOf(this.section));
      this.chart.draw();
      this.#update();
    });
  }

  #open() {
    if (this.scene) return;
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    this.parts.stage.prepend(canvas);
    const Kind = hasWebGL() ? Scene3D : Scene2D;
    this.parts.flat.hidden = Kind === Scene3D;
    const options = { calm: this.calm, onChange: () => this.scene?.draw() };
    this.scene = new Kind(canvas, this.motion, coloursOf(this.section), options);
    for (const name of ["trace", ...VECTORS]) this.scene.setVisible(name, this.parts[name].checked);
    this.#resize();
  }

  #close() {
    if (!this.scene) return;
    this.player.pause();
    this.scene.dispose();
    this.scene = null;
    this.parts.stage.querySelector("canvas").remove();
  }

  #resize() {
    const { clientWidth, clientHeight } = this.parts.stage;
    if (!this.scene || !clientWidth || !clientHeight) return;
    this.scene.resize(clientWidth, clientHeight);
    this.#update();
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
    this.scene?.[how](...amounts);
    this.scene?.draw();
  }

  /** A speed faster, or slower. */
  changeSpeed(by) {
    const { speed } = this.parts;
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.length - 1);
    this.player.speed = Number(speed.value);
  }

  /** Bring everything up to the player's time. */
  #update() {
    const { parts, motion, player } = this;
    const state = motion.at(player.time);
    const row = state.row ?? motion.rowBefore(player.time);
    const isOfTable = state.row !== null;
    parts.t.textContent = inFull(state.time, isOfTable);
    ["phi", "theta", "psi"].forEach((name, k) => {
      parts[name].textContent = inFull(state.angles[k], isOfTable);
      parts[`${name}_degrees`].textContent = inDegrees(state.angles[k]);
    });
    const number = Math.min(row * motion.stride, motion.total - 1) + 1;
    parts.row.textContent = `${isOfTable ? "row" : "after row"} ${number} of ${motion.total}`;
    parts.time.value = row;
    parts.time.setAttribute("aria-valuetext", `t = ${inShort(state.time)} s`);
    parts.play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    parts.play.dataset.state = player.playing ? "playing" : "paused";
    this.chart.mark(row);
    this.scene?.show(state);
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
