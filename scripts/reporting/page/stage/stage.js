// The stage: an element in which one or two tops move, in three dimensions or, without WebGL, in two.
// It knows tops, vectors and moments, and nothing of tables, time lines or controls.

import { coloursOf } from "./colours.js";
import { Scene2D } from "./scene2d.js";
import { Scene3D, hasWebGL } from "./scene3d.js";
import { unitsOf, viewOf } from "./view.js";

const HINTS = ["Tap outside to scroll again", "Tap to turn the top"];
const TAP = 10; // pixels that a finger may move in a tap

export class Stage {
  #scene = null;
  #tops = null;
  #framed = null; // the tops by which the view was chosen
  #vectors = {};
  #curves = [];
  #moment = null;
  #visible = new Map();
  #stop = new AbortController();

  /**
   * @param element what holds the stage; its colours are those of the style that holds for it
   * @param calm whether less motion is asked for
   * @param hints for fingers, while they turn the tops and while they do not
   */
  constructor(element, { calm = false, hints = HINTS } = {}) {
    this.element = element;
    this.calm = calm;
    this.hints = hints;
    this.hint = Object.assign(document.createElement("p"), { className: "hint", hidden: true });
    element.append(this.hint);
    this.#listen();
    const size = new ResizeObserver(() => this.#resize());
    size.observe(element);
    this.#stop.signal.addEventListener("abort", () => size.disconnect());
  }

  /** Whether a finger turns the top; else it scrolls the page. */
  get isHeld() {
    return this.element.dataset.held === "yes";
  }

  /** Whether the scene is there, and in how many dimensions; 0 while it is closed. */
  get dimensions() {
    if (!this.#scene) return 0;
    return this.#scene instanceof Scene3D ? 3 : 2;
  }

  /** A finger scrolls the page over the stage until one taps on it, a wheel until it has the focus. */
  #listen() {
    const { element } = this;
    const { signal } = this.#stop;
    const isTouch = (event) => event.pointerType === "touch";
    let start = null;
    element.addEventListener("pointerdown", (event) => {
      if (isTouch(event) && !this.isHeld) {
        start = event;
        event.stopPropagation(); // the scene shall not turn
        return;
      }
      element.focus({ preventScroll: true });
    }, { capture: true, signal });
    element.addEventListener("pointerup", (event) => {
      const moved = start && Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY);
      if (start?.pointerId === event.pointerId && moved < TAP) this.hold(true);
      start = null;
    }, { capture: true, signal });
    document.addEventListener("pointerdown", (event) => {
      if (this.isHeld && !element.contains(event.target)) this.hold(false);
    }, { capture: true, signal });
    element.addEventListener("wheel", (event) => {
      if (document.activeElement !== element) event.stopPropagation();
    }, { capture: true, passive: true, signal });
    if (matchMedia("(pointer: coarse)").matches) this.hold(false);
  }

  /** Have fingers turn the tops, or scroll the page. */
  hold(on) {
    this.element.dataset.held = on ? "yes" : "no";
    this.hint.hidden = false;
    this.hint.textContent = this.hints[on ? 0 : 1];
    if (on) this.element.focus({ preventScroll: true });
    this.#setTouch();
  }

  /** The controls of the scene claim every touch; only a held stage does. */
  #setTouch() {
    const canvas = this.element.querySelector("canvas");
    if (canvas) canvas.style.touchAction = this.isHeld ? "none" : "pan-x pan-y";
  }

  /**
   * Put tops on the stage.
   *
   * @param tops of each the `body`, the `trace` of its axis (`times`, and `points`: unit vectors side
   *   by side), its `look`, "solid" or "ghost", and the `pane` in which it stands (0 if there is none): panes
   *   are pictures beside each other, seen by one eye
   * @param vectors by name (a colour: force, momentum, omega) all that will be shown of a vector,
   *   x, y, z side by side, or null; by them the arrows are so long that they stay in view
   */
  setTops(tops, vectors = {}) {
    this.#tops = tops;
    this.#framed = tops;
    this.#vectors = vectors;
    this.#moment = null;
    if (this.#scene) this.#fill();
  }

  /** Give the tops on the stage other traces and vectors, in the same view: quick enough for every frame. */
  setTraces(traces, vectors = {}) {
    this.#tops = this.#tops.map((top, k) => ({ ...top, trace: traces[k] }));
    this.#vectors = vectors;
    this.#scene?.setTraces(this.#tops, unitsOf(this.#tops, vectors));
  }

  /**
   * Draw curves beside the tops: of each its `points` (m, side by side), its `colour` (a name of
   * colours.js or of CSS), `width` in pixels, `frame`: "space", or "body" to turn with the first
   * top of its pane, and its `pane`.
   */
  setCurves(curves) {
    this.#curves = curves;
    this.#scene?.setCurves(curves);
  }

  /** Show or hide "body", "ghost", "trace", "curves", or the arrow of a vector by its name. */
  setVisible(name, on) {
    this.#visible.set(name, on);
    this.#scene?.setVisible(name, on);
    this.redraw();
  }

  /**
   * Show a moment: `time`, `attitudes` (a quaternion per top), `vectors` by name (Vector3 or null), of several panes a
   * list of them.
   */
  show({ time, attitudes, vectors = {} }) {
    this.#moment = { time, attitudes, vectors: [vectors].flat() };
    this.#scene?.show(this.#moment);
  }

  /** Draw the latest moment again. */
  redraw() {
    if (this.#moment) this.#scene?.show(this.#moment);
  }

  /** Build the scene, which takes one of the few WebGL contexts of a browser. */
  open() {
    if (this.#scene) return;
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    this.element.prepend(canvas);
    const Kind = hasWebGL() ? Scene3D : Scene2D;
    const options = { calm: this.calm, onChange: () => this.#scene?.draw() };
    this.#scene = new Kind(canvas, coloursOf(this.element), options);
    for (const [name, on] of this.#visible) this.#scene.setVisible(name, on);
    this.#setTouch();
    if (this.#tops) this.#fill();
    this.#resize();
  }

  #fill() {
    const view = viewOf(this.#framed, this.#vectors);
    this.#scene.setTops(this.#tops, { ...view, perUnit: unitsOf(this.#tops, this.#vectors) });
    this.#scene.setCurves(this.#curves);
    this.redraw();
  }

  /** Give the context back; what stands on the stage is kept. */
  close() {
    if (!this.#scene) return;
    this.#scene.dispose();
    this.#scene = null;
    this.element.querySelector("canvas").remove();
  }

  #resize() {
    const { clientWidth, clientHeight } = this.element;
    if (!this.#scene || !clientWidth || !clientHeight) return;
    this.#scene.resize(clientWidth, clientHeight);
    this.redraw();
  }

  /** Take the colours of the page again, which may have become dark. */
  recolour() {
    this.#scene?.setColours(coloursOf(this.element));
    this.redraw();
  }

  /** Change the view: "turn" (azimuth, elevation; rad), "zoom" (factor) or "reset". */
  look(how, ...amounts) {
    this.#scene?.[how](...amounts);
    this.#scene?.draw();
  }

  /** Where a point of space (m) is in the first pane, in pixels from the upper left corner; null while it is closed. */
  project(point) {
    return this.#scene ? this.#scene.project(point) : null;
  }

  /** The stage as it is now, as the address of a PNG of this size; empty while it is closed. */
  still(width, height) {
    if (!this.#scene || !this.#moment) return "";
    this.#scene.resize(width, height);
    this.redraw();
    const address = this.element.querySelector("canvas").toDataURL("image/png");
    this.#resize();
    return address;
  }

  dispose() {
    this.close();
    this.#stop.abort();
  }
}
