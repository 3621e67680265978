// The stage: an element in which one or two tops move, by three.js. It knows tops, vectors and moments, and nothing of
// tables, time lines or controls.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { say } from "../live/language.js";
import { Arrow, makeBody } from "./body.js";
import { Trace } from "./trace.js";
import { countPanes, placePanes, unitsOf, viewOf } from "./view.js";

const TAP = 10; // pixels that a finger may move in a tap
const FIRST_VIEW = new THREE.Vector3(Math.cos(-1.05), Math.sin(-1.05), Math.tan(0.32)).normalize(); // to the eye
const FIELD = 32; // degrees
const [NEAREST, FARTHEST] = [0.4, 4]; // times the first distance
const ROOM = 1.06; // times the part of space that is to be seen
const TRACE_WIDTH = { solid: 2.5, ghost: 1.8 }; // pixels

/** The colours of the style sheet by their names in the scene. */
const COLOURS = {
  ground: "stage", faint: "faint", ink: "ink", rod: "rod", even: "body-even", odd: "body-odd", mark: "mark", trace: "trace",
  ghost: "ghost", force: "force", momentum: "momentum", omega: "omega", torque: "torque", change: "torque",
};

/** The colours that hold for an element now, light or dark, of style sheet names by others. */
export function coloursOf(element, names = COLOURS) {
  const probe = element.appendChild(document.createElement("i"));
  const style = getComputedStyle(probe);
  const colours = Object.entries(names).map(([key, name]) => {
    probe.style.color = `var(--${name})`;
    return [key, style.color];
  });
  probe.remove();
  return Object.fromEntries(colours);
}

/** A line through points, as wide as so many pixels. */
function makeLine(points, color, linewidth) {
  return new Line2(new LineGeometry().setPositions(points), new LineMaterial({ color, linewidth, transparent: true }));
}

/** A circle about the vertical. */
function makeCircle(radius, colour) {
  const points = new THREE.EllipseCurve(0, 0, radius, radius).getPoints(96);
  return makeLine(points.flatMap(({ x, y }) => [x, y, 0]), colour, 1);
}

/** A letter that always faces the eye. */
function makeLetter(letter, colour, size) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  Object.assign(pen, { font: "italic 44px Georgia, serif", fillStyle: colour, textAlign: "center", textBaseline: "middle" });
  pen.fillText(letter, 32, 32);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), depthWrite: false }));
  sprite.renderOrder = 6; // above the body
  sprite.scale.setScalar(size);
  return sprite;
}

/** Give back what an object holds on the graphics card. */
function release(object) {
  object?.traverse((item) => {
    item.geometry?.dispose();
    for (const material of [item.material ?? []].flat()) {
      material.map?.dispose();
      material.dispose();
    }
  });
}

export class Stage {
  #scene = null;
  #renderer = null; // while the stage is open
  #tops = []; // what is drawn of each top
  #panes = []; // of each a group of what it alone shows: tops, `arrows` by name, `curves`, those that turn with its top
  #curves = [];
  #moment = null;
  #hidden = new Set();
  #size = [1, 1];

  /**
   * @param element what holds the stage; its colours are those of the style that holds for it
   * @param calm whether less motion is asked for
   */
  constructor(element, { calm = false } = {}) {
    this.element = element;
    this.camera = new THREE.PerspectiveCamera(FIELD, 1);
    this.camera.up.set(0, 0, 1);
    this.controls = Object.assign(new OrbitControls(this.camera), { enablePan: false, rotateSpeed: calm ? 0.6 : 0.9 });
    this.controls.addEventListener("change", () => this.#draw());
    this.hint = Object.assign(document.createElement("p"), { className: "hint", hidden: true });
    element.append(this.hint);
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(element);
  }

  /** Whether a finger turns the top; else it scrolls the page. */
  get isHeld() {
    return this.element.dataset.held === "yes";
  }

  get isOpen() {
    return this.#renderer !== null;
  }

  /** A finger scrolls the page over the stage until one taps on it, a wheel until it has the focus. */
  #listen() {
    const { element } = this;
    let start = null;
    element.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch" && !this.isHeld) {
        start = event;
        event.stopPropagation(); // the scene shall not turn
        return;
      }
      element.focus({ preventScroll: true });
    }, { capture: true });
    element.addEventListener("pointerup", (event) => {
      const moved = start && Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY);
      if (start?.pointerId === event.pointerId && moved < TAP) this.hold(true);
      start = null;
    }, { capture: true });
    document.addEventListener("pointerdown", (event) => {
      if (this.isHeld && !element.contains(event.target)) this.hold(false);
    }, { capture: true });
    element.addEventListener("wheel", (event) => {
      if (document.activeElement !== element) event.stopPropagation();
    }, { capture: true, passive: true });
    if (matchMedia("(pointer: coarse)").matches) this.hold(false);
  }

  /** Have fingers turn the tops, or scroll the page. */
  hold(on) {
    this.element.dataset.held = on ? "yes" : "no";
    this.hint.hidden = false;
    this.hint.textContent = say(on ? "hold_on" : "hold_off");
    if (on) this.element.focus({ preventScroll: true });
  }

  /**
   * Put tops on the stage; the eye stays where it was, if it was.
   *
   * @param tops of each the `body`, the `trace` of its axis (`times`, and `points`: unit vectors side
   *   by side), its `look`, "solid" or "ghost", and the `pane` in which it stands (0 if there is none): panes
   *   are pictures beside each other, seen by one eye
   * @param vectors by name (a colour: force, momentum, omega) all that will be shown of a vector,
   *   x, y, z side by side, or null; by them the arrows are so long that they stay in view
   */
  setTops(tops, vectors = {}) {
    const { camera, controls } = this;
    const eye = this.tops && camera.position.clone().sub(controls.target).divideScalar(controls.maxDistance / FARTHEST);
    this.tops = tops;
    this.view = viewOf(tops, vectors);
    this.#moment = null;
    const distance = (ROOM * this.view.radius) / Math.sin(THREE.MathUtils.degToRad(FIELD / 2));
    Object.assign(camera, { near: distance / 50, far: distance * 20 });
    Object.assign(controls, { minDistance: NEAREST * distance, maxDistance: FARTHEST * distance });
    controls.target.set(0, 0, this.view.middle);
    const place = (view) => camera.position.copy(controls.target).addScaledVector(view, distance);
    place(FIRST_VIEW);
    controls.saveState(); // what it is reset to
    place(eye ?? FIRST_VIEW);
    controls.update();
    this.#fit();
    this.#build();
  }

  /** Give the tops on the stage other traces and vectors, in the same view: quick enough for every frame. */
  setTraces(traces, vectors = {}) {
    this.tops = this.tops.map((top, k) => ({ ...top, trace: traces[k] }));
    this.view.perUnit = unitsOf(this.tops, vectors);
    this.#tops.forEach(({ trace }, k) => trace.setPath(traces[k]));
  }

  /**
   * Draw curves beside the tops: of each its `points` (m, side by side), its `colour` (a name of the scene
   * or of CSS), `width` in pixels, `frame`: "space", or "body" to turn with the first top of its pane, and its `pane`.
   */
  setCurves(curves) {
    this.#curves = curves;
    if (!this.#scene) return;
    for (const pane of this.#panes) {
      release(pane.curves);
      pane.curves?.removeFromParent();
      pane.turning = new THREE.Group();
      pane.curves = new THREE.Group().add(pane.turning);
      pane.add(pane.curves);
    }
    for (const { points, colour, width = 1.5, frame = "space", pane = 0 } of curves) {
      const line = makeLine(points, this.colours[colour] ?? colour, width);
      line.renderOrder = 4;
      const { curves: still, turning } = this.#panes[pane];
      (frame === "body" ? turning : still).add(line);
    }
  }

  /** Make the scene of what stands on the stage, while it is open. */
  #build() {
    if (!this.#renderer || !this.tops) return;
    release(this.#scene);
    this.colours = coloursOf(this.element);
    const light = new THREE.DirectionalLight("#ffffff", 2.4);
    light.position.set(2, -3, 5);
    this.#scene = new THREE.Scene().add(light, new THREE.HemisphereLight("#ffffff", "#c8c8c8", 2.6));
    this.#addSpace();
    this.#panes = Array.from({ length: countPanes(this.tops) }, () => this.#makePane());
    this.#tops = this.tops.map((top, k) => this.#makeTop(top, this.view.tips[k]));
    this.setCurves(this.#curves);
    this.#showHidden();
  }

  #makePane() {
    const pane = new THREE.Group();
    const names = Object.keys(this.view.perUnit);
    pane.arrows = Object.fromEntries(names.map((name) => [name, new Arrow(this.colours[name], this.view.tip)]));
    this.#scene.add(pane.add(...Object.values(pane.arrows)));
    return pane;
  }

  #makeTop({ body, trace, look, pane = 0 }, tip) {
    const isGhost = look === "ghost";
    const { ground } = this.colours;
    const made = {
      name: isGhost ? "ghost" : "body",
      body: makeBody(body, this.colours, isGhost),
      trace: new Trace(trace, tip, { colour: this.colours[isGhost ? "ghost" : "trace"], ground, width: TRACE_WIDTH[look] }),
    };
    this.#panes[pane].add(made.body, made.trace);
    return made;
  }

  /** The sphere of the tip, or the two circles between which it stays; and the axes of space. */
  #addSpace() {
    const { colours, view: { tip, band, radius: size } } = this;
    const circle = (height = 0) => makeCircle(Math.sqrt(Math.max(tip ** 2 - height ** 2, 0)), colours.faint);
    this.#scene.add(...(band?.map((height) => circle(height).translateZ(height))
      ?? [circle(), circle().rotateX(Math.PI / 2), circle().rotateY(Math.PI / 2)]));
    const length = 0.34 * size;
    ["x", "y", "z"].forEach((letter, k) => {
      const end = new THREE.Vector3().setComponent(k, length);
      const sign = makeLetter(letter, colours.ink, 0.36 * length);
      sign.position.copy(end).multiplyScalar(1.2);
      this.#scene.add(makeLine([0, 0, 0, ...end], colours.ink, 1.5), sign);
    });
  }

  /** Show or hide "body", "ghost", "trace", "curves", or the arrow of a vector by its name. */
  setVisible(name, on) {
    if (on) this.#hidden.delete(name);
    else this.#hidden.add(name);
    this.#showHidden();
    this.redraw();
  }

  #showHidden() {
    const isShown = (name) => !this.#hidden.has(name);
    for (const { name, body, trace } of this.#tops) {
      body.visible = isShown(name);
      trace.visible = isShown("trace") && isShown(name);
    }
    for (const { arrows, curves } of this.#panes) {
      for (const [name, arrow] of Object.entries(arrows)) arrow.wanted = isShown(name);
      curves.visible = isShown("curves");
    }
  }

  /**
   * Show a moment: `time`, `attitudes` (a quaternion per top), `vectors` by name (x, y, z or null), of several panes a
   * list of them.
   */
  show({ time, attitudes, vectors = {} }) {
    this.#moment = { time, attitudes, vectors: [vectors].flat() };
    this.redraw();
  }

  /** Draw the latest moment again. */
  redraw() {
    if (!this.#scene || !this.#moment) return;
    const { time, attitudes, vectors } = this.#moment;
    this.#tops.forEach(({ body, trace }, k) => {
      body.quaternion.copy(attitudes[k]);
      trace.show(time);
    });
    this.#panes.forEach(({ turning, arrows }, k) => {
      turning.quaternion.copy(attitudes[this.tops.findIndex(({ pane = 0 }) => pane === k)]);
      for (const [name, arrow] of Object.entries(arrows)) {
        arrow.point(vectors[k][name] ?? null, this.view.perUnit[name], this.#originOf(name, vectors[k]));
      }
    });
    this.#draw();
  }

  /** The change of the angular momentum begins at its tip, everything else at the pivot. */
  #originOf(name, { momentum }) {
    const origin = new THREE.Vector3();
    return name === "change" && momentum ? origin.fromArray(momentum).multiplyScalar(this.view.perUnit.momentum) : origin;
  }

  #draw() {
    const renderer = this.#renderer;
    if (!this.#scene) return;
    renderer.setClearColor(this.colours.ground);
    this.#places().forEach(([x, y, width, height], k) => {
      this.#panes.forEach((pane, n) => { pane.visible = n === k; });
      const below = this.#size[1] - y - height;
      renderer.setViewport(x, below, width, height);
      renderer.setScissor(x, below, width, height);
      renderer.render(this.#scene, this.camera);
    });
  }

  /** Where the panes are, in pixels of CSS. */
  #places() {
    return placePanes(countPanes(this.tops), ...this.#size);
  }

  /** Draw from now on, which takes one of the few WebGL contexts of a browser; without WebGL the stage says so. */
  open() {
    if (this.#renderer) return;
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    const context = canvas.getContext("webgl2", { antialias: true });
    if (!context) {
      this.hint.textContent = say("no_webgl");
      this.hint.hidden = false;
      return;
    }
    this.element.prepend(canvas);
    this.#renderer = new THREE.WebGLRenderer({ canvas, context });
    this.#renderer.setScissorTest(true);
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.controls.connect(canvas);
    canvas.style.touchAction = ""; // the controls claim every touch: the style sheet gives them those of a held stage only
    this.#build();
    this.#resize();
  }

  /** Give the context back; what stands on the stage is kept. */
  close() {
    if (!this.#renderer) return;
    release(this.#scene);
    this.controls.disconnect();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
    this.#renderer.domElement.remove();
    [this.#renderer, this.#scene] = [null, null];
    [this.#tops, this.#panes] = [[], []];
  }

  #resize(width = this.element.clientWidth, height = this.element.clientHeight) {
    if (!this.#renderer || !width || !height) return;
    this.#size = [width, height];
    this.#renderer.setSize(width, height, false);
    this.#fit();
    this.redraw();
  }

  /** Have the panes filled by the view; a narrow view is taken from farther off. */
  #fit() {
    const [, , width, height] = this.#places()[0];
    const half = Math.tan(THREE.MathUtils.degToRad(FIELD / 2));
    this.camera.aspect = width / height;
    this.camera.fov = 2 * THREE.MathUtils.radToDeg(Math.atan(half * Math.max(1, height / width)));
    this.camera.updateProjectionMatrix();
  }

  /** Take the colours of the page again, which may have become dark. */
  recolour() {
    this.#build();
    this.redraw();
  }

  /** Where a point of space (m) is in the first pane, in pixels from the upper left corner; null while it is closed. */
  project(point) {
    if (!this.#renderer) return null;
    this.camera.updateMatrixWorld();
    const { x, y } = point.clone().project(this.camera);
    const [, , width, height] = this.#places()[0];
    return [((x + 1) * width) / 2, ((1 - y) * height) / 2];
  }

  /** A moment as the address of a PNG of this size; empty without WebGL. */
  still(width, height, moment = null) {
    const wasOpen = this.isOpen;
    const before = this.#moment;
    this.open();
    if (!this.#renderer) return "";
    if (moment) this.show(moment);
    if (!this.#moment) return "";
    this.#resize(width, height);
    const address = this.#renderer.domElement.toDataURL("image/png");
    this.#moment = before;
    if (wasOpen) this.#resize();
    else this.close();
    return address;
  }
}
