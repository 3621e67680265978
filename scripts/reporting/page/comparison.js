// A second motion of the same scene on the stage, as a ghost, and the angles between the two.

import { say } from "./live/language.js";
import { Pair } from "./pair.js";
import { Plot } from "./plot.js";
import { inFewDegrees, inShort } from "./text.js";

const NONE = "";

export class Comparison {
  pair = null;

  /**
   * @param parts the elements of a moving top @param peers of each its `title` and `load`, which
   *   promises its motion; `isExact` says whether it is the exact solution
   * @param onChange called when another motion, or none, is compared @param onPick with a time
   */
  constructor(parts, motion, peers, { onChange, onPick }) {
    Object.assign(this, { parts, motion, peers, onChange });
    this.plot = new Plot(parts.between, onPick);
    parts.versus.hidden = peers.length === 0;
    parts.peer.append(new Option(say("figure_none"), NONE), ...peers.map(({ title }, i) => new Option(title, String(i))));
    parts.peer.addEventListener("change", () => this.choose(parts.peer.value));
  }

  /** Compare with the exact solution, unless this is it. */
  async begin() {
    const exact = this.peers.findIndex(({ isExact }) => isExact);
    if (exact >= 0 && !this.motion.isExact) await this.choose(String(exact));
  }

  async choose(value) {
    this.parts.peer.value = value;
    const peer = value === NONE ? null : this.peers[Number(value)];
    const other = peer && (await peer.load());
    if (this.parts.peer.value !== value) return; // another one was chosen meanwhile
    this.pair = other && new Pair(this.motion, other);
    this.#draw();
    this.onChange();
  }

  #draw() {
    const { parts, pair, motion } = this;
    parts.angles.hidden = !pair;
    if (!pair) return;
    const { times, attitudes, axes, hasRows } = pair.series();
    const inDegrees = (angles) => angles.map((angle) => (angle * 180) / Math.PI);
    const largest = Math.max(...attitudes);
    this.plot.draw([motion.start, motion.end], [
      { t: times, values: inDegrees(axes), colour: "trace", dash: [5, 3] },
      { t: times, values: inDegrees(attitudes), colour: "momentum" },
    ], { range: [0, inDegrees([1.05 * largest || 1])[0]] });
    const when = inShort(times[attitudes.indexOf(largest)]);
    const angle = inFewDegrees(largest);
    parts.farthest.textContent = say("between_largest", { angle, when }) + (hasRows ? "" : say("between_rows"));
    parts.between.setAttribute("aria-label", say("between_label", { angle }));
  }

  /** Bring the numbers up to a moment. */
  show(moment) {
    if (!this.pair) return;
    const [attitude, axis] = this.pair.anglesAt(moment);
    this.parts.between_attitudes.textContent = inFewDegrees(attitude);
    this.parts.between_axes.textContent = inFewDegrees(axis);
    this.plot.place(moment.time);
  }
}
