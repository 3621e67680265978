// The guided tour: six steps, each with a motion to look at and something to try.

import { say } from "./language.js";
import { PRESETS } from "./presets.js";

/** Of each step the preset, and what is shown beside the body. */
export const STEPS = [
  { preset: "cusp", shown: ["trace"] },
  { preset: "loop", shown: ["trace"] },
  { preset: "wave", shown: ["trace", "momentum", "torque", "change"] },
  { preset: "falling", shown: ["trace"] },
  { preset: "fast", shown: ["trace", "omega", "cones"] },
  { preset: "rest", shown: ["trace"] },
];
const ARROWS = ["trace", "momentum", "omega", "force", "torque", "change", "cones"];

export class Tour {
  /** @param live the live top, whose buttons are wired */
  constructor(live) {
    this.live = live;
    const { parts } = live;
    parts.tour_begin.addEventListener("click", () => this.go(0));
    parts.tour_back.addEventListener("click", () => this.go(this.step - 1));
    parts.tour_next.addEventListener("click", () => this.go(this.step + 1));
    parts.tour_end.addEventListener("click", () => this.end());
  }

  /** Show a step; after the last the tour has ended. */
  go(step) {
    if (step >= STEPS.length) {
      this.end();
      return;
    }
    const { live, live: { parts } } = this;
    const { preset, shown } = STEPS[step];
    this.step = step;
    live.load(PRESETS[preset], { preset });
    for (const name of ARROWS) live.picture.check(name, shown.includes(name));
    parts.tour.hidden = false;
    parts.tour_begin.hidden = true;
    parts.tour_count.textContent = say("tour_step", { step: step + 1, count: STEPS.length, title: say(`preset_${preset}`) });
    parts.tour_text.textContent = say(`tour_${preset}`);
    parts.tour_back.disabled = step === 0;
    parts.tour_next.textContent = say(step === STEPS.length - 1 ? "tour_finish" : "tour_next");
    if (!live.isCalm) live.play();
  }

  end() {
    const { parts } = this.live;
    parts.tour.hidden = true;
    parts.tour_begin.hidden = false;
    parts.tour_begin.focus();
  }
}
