// The guided tour: six steps, each with a motion to look at and something to try.

import { PRESETS } from "./presets.js";

/** Of each step the preset, what is shown beside the body, and the words. */
export const STEPS = [
  {
    preset: "cusp", shown: ["trace"],
    words: "A spinning top is released at rest. It does not fall over: it sinks, precesses, and rises again to a cusp, where it rests for an instant. Drag the tip of the axis to release it from another tilt.",
  },
  {
    preset: "loop", shown: ["trace"],
    words: "Pushed backward at the start, the cusps become loops. Move the slider of the precession rate φ′₀ to the right: loops, cusps, waves.",
  },
  {
    preset: "wave", shown: ["trace", "momentum", "torque", "change"],
    words: "Gravity exerts a torque (from the pivot). It is the change of the angular momentum (the same arrow, at its tip): the top yields at a right angle to gravity.",
  },
  {
    preset: "falling", shown: ["trace"],
    words: "Almost upright, and too slow: it falls. Press “Set spin to it”, then raise the spin. Above the red mark the top sleeps.",
  },
  {
    preset: "fast", shown: ["trace", "omega", "cones"],
    words: "A symmetric top has two steady precessions for one tilt. In this one, the fast one, the body cone rolls on the space cone; the angular velocity is where they touch. Choose “steady, slow” under Precession.",
  },
  {
    preset: "rest", shown: ["trace"],
    words: "A toy top with dry friction: it sleeps until its spin falls below the threshold, wakes, falls, and lies still. How long does it live with half the friction?",
  },
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
    const { preset, shown, words } = STEPS[step];
    this.step = step;
    live.load(PRESETS[preset].state, preset);
    for (const name of ARROWS) live.show(name, shown.includes(name));
    parts.tour.hidden = false;
    parts.tour_begin.hidden = true;
    parts.tour_count.textContent = `Step ${step + 1} of ${STEPS.length}: ${PRESETS[preset].title}`;
    parts.tour_text.textContent = words;
    parts.tour_back.disabled = step === 0;
    parts.tour_next.textContent = step === STEPS.length - 1 ? "Finish" : "Next";
    if (!live.isCalm) live.play();
  }

  end() {
    const { parts } = this.live;
    parts.tour.hidden = true;
    parts.tour_begin.hidden = false;
    parts.tour_begin.focus();
  }
}
