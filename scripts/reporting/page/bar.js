// What works the time and the view of a moving top: buttons, a menu of speeds, and the keyboard.

import { say } from "./live/language.js";
import { speedsFor } from "./player.js";
import { inShort } from "./text.js";

const TURN = 0.15; // rad a press
const NEARER = 1 / 1.15; // times the distance
const OWN_KEYS = "select, button, input:not([type=range]), summary, a, pre";
const MOVES_SLIDER = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "PageUp", "PageDown"];

export class Bar {
  /**
   * @param section which obeys keys, but for those that its own controls take
   * @param parts its elements by name @param player of its time @param stage of its view
   * @param go goes by "step", "page" or to the "end"; backward (-1) or forward (1)
   */
  constructor(section, parts, player, stage, go) {
    this.parts = parts;
    this.player = player;
    parts.play.addEventListener("click", () => player.toggle());
    const view = stage.controls;
    parts.reset.addEventListener("click", () => view.reset());
    parts.speed.addEventListener("change", () => { player.speed = Number(parts.speed.value); });
    const actions = {
      "+": () => view.dollyIn(NEARER),
      "=": () => view.dollyIn(NEARER),
      "-": () => view.dollyOut(NEARER),
      "0": () => view.reset(),
      "Shift+ArrowLeft": () => view.rotateLeft(TURN),
      "Shift+ArrowRight": () => view.rotateLeft(-TURN),
      "Shift+ArrowUp": () => view.rotateUp(TURN),
      "Shift+ArrowDown": () => view.rotateUp(-TURN),
      ",": () => this.changeSpeed(-1),
      ".": () => this.changeSpeed(1),
      " ": () => player.toggle(),
      ArrowLeft: () => go("step", -1),
      ArrowRight: () => go("step", 1),
      PageDown: () => go("page", -1),
      PageUp: () => go("page", 1),
      Home: () => go("end", -1),
      End: () => go("end", 1),
    };
    section.addEventListener("keydown", (event) => {
      const { key, target } = event;
      if (event.ctrlKey || event.altKey || event.metaKey || target.closest(OWN_KEYS)) return;
      if (target.matches("input[type=range]") && !event.shiftKey && MOVES_SLIDER.includes(key)) return;
      const action = actions[event.shiftKey && key.startsWith("Arrow") ? `Shift+${key}` : key];
      if (!action) return;
      event.preventDefault();
      action();
    });
  }

  /** Offer the speeds that suit a duration. */
  suit(duration) {
    const { speeds, initial } = speedsFor(duration);
    this.player.speed = initial;
    const options = speeds.map((speed) => new Option(`${inShort(speed)} ×`, speed, false, speed === initial));
    this.parts.speed.replaceChildren(...options);
  }

  /** A speed faster, or slower. */
  changeSpeed(by) {
    const { speed } = this.parts;
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.length - 1);
    this.player.speed = Number(speed.value);
  }

  /** Bring the button of the player up to it. */
  show() {
    const { player: { playing }, parts: { play } } = this;
    play.setAttribute("aria-label", say(playing ? "pause" : "play"));
    play.dataset.state = playing ? "playing" : "paused";
  }
}
