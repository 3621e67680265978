// The top taken by the mouse or a finger: the tip of its axis tilts it, its body spins it. Both go to the start,
// whose numbers they change as the sliders do. Elsewhere on the stage one turns the view.

import { Vector3 } from "three";

const NEAR = { mouse: 18, touch: 34 }; // pixels from the tip
const TILTS = 720; // places on the arc of the tip that are looked at
const WIDTH = 300; // pixels of a drag over the range of the slider

export class Grip {
  #held = null; // what the pointer moves: a function of its event

  /** @param live the live top */
  constructor(live) {
    this.live = live;
    const { element } = live.stage;
    element.addEventListener("pointerdown", (event) => this.#take(event), { capture: true });
    element.addEventListener("pointermove", (event) => (this.#held ? this.#held(event) : this.#point(event)));
    for (const end of ["pointerup", "pointercancel"]) element.addEventListener(end, () => this.#leave());
  }

  /** Where an event is on the stage. */
  #placeOf({ clientX, clientY }) {
    const { left, top } = this.live.stage.element.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  /** What is at a place: "tip", "body" or null. */
  #partAt(event) {
    const { live } = this;
    const place = this.#placeOf(event);
    const axis = live.axisNow();
    const far = (point) => {
      const [x, y] = live.stage.project(point);
      return Math.hypot(x - place[0], y - place[1]);
    };
    if (!live.stage.project(axis)) return null;
    if (far(axis.clone().multiplyScalar(live.picture.tip)) < (NEAR[event.pointerType] ?? NEAR.mouse)) return "tip";
    const [solid] = live.picture.drawing.solids;
    if (!solid || !live.parts.body_shown.checked) return null;
    const middle = axis.clone().multiplyScalar(solid.place[2]);
    const aside = new Vector3(-axis.y, axis.x, 0).normalize().multiplyScalar(solid.radius ?? solid.edges[0] / 2);
    const [[x0, y0], [x1, y1]] = [middle, middle.clone().add(aside)].map((point) => live.stage.project(point));
    return far(middle) < 0.9 * Math.hypot(x1 - x0, y1 - y0) ? "body" : null;
  }

  #point(event) {
    const part = event.pointerType === "mouse" && this.#partAt(event);
    this.live.stage.element.dataset.grip = part || "";
  }

  #take(event) {
    const { live } = this;
    if (event.button !== 0 || (event.pointerType === "touch" && !live.stage.isHeld)) return;
    const part = this.#partAt(event);
    if (!part) return;
    event.stopPropagation(); // the view shall not turn
    live.stage.element.setPointerCapture(event.pointerId);
    this.wasPlaying = live.clock.playing;
    live.clock.seek(0);
    const from = { x: event.clientX, omega3: live.state.omega3 };
    this.#held = part === "tip" ? (next) => this.#tilt(next) : (next) => this.#spin(next, from);
  }

  #leave() {
    if (!this.#held) return;
    this.#held = null;
    if (this.wasPlaying) this.live.clock.play();
  }

  /** The tilt whose tip is nearest to the pointer. */
  #tilt(event) {
    const { live } = this;
    const [x, y] = this.#placeOf(event);
    let [best, least] = [0, Infinity];
    for (let k = 0; k <= TILTS; k += 1) {
      const theta = (Math.PI * k) / TILTS;
      const [px, py] = live.stage.project(new Vector3(0, -Math.sin(theta), Math.cos(theta)).multiplyScalar(live.picture.tip));
      const far = (px - x) ** 2 + (py - y) ** 2;
      if (far < least) [best, least] = [k, far];
    }
    live.set({ theta: (180 * best) / TILTS });
  }

  /** To the right it spins faster. */
  #spin(event, { x, omega3 }) {
    const { live } = this;
    const { low, high } = live.controls.omega3;
    const value = omega3 + ((event.clientX - x) * (high - low)) / WIDTH;
    live.set({ omega3: Number(Math.min(Math.max(value, low), high).toPrecision(4)) });
  }
}
