// The stage: an element in which one or two tops move, by three.js. It knows tops, vectors and moments, and nothing of
// tables, time lines or controls.

import {
  CanvasTexture,
  DirectionalLight,
  Group,
  HemisphereLight,
  MathUtils,
  PerspectiveCamera,
  Scene,
  Spherical,
  Sprite,
  SpriteMaterial,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { Arrow, makeBody } from "./body.js";
import { Trace } from "./trace.js";
import { countPanes, placePanes, unitsOf, viewOf } from "./view.js";

const WORDS = {
  release: "Tap outside to scroll again",
  hold: "Tap to turn the top",
  lack: "The top is not shown in space: this browser has no WebGL.",
};
const TAP = 10; // pixels that a finger may move in a tap
const FIRST_VIEW = { azimuth: -1.05, elevation: 0.32 }; // of the eye, rad
const FIELD = 32; // degrees
const [NEAREST, FARTHEST] = [0.4, 4]; // times the first distance
const ROOM = 1.06; // times the part of space that is to be seen
const TRACE_WIDTH = { solid: 2.5, ghost: 1.8 }; // pixels

/** The colours of the style sheet by their names in the scene. */
const COLOURS = {
  ground: "stage", faint: "faint", ink: "ink", rod: "rod", even: "body-even", odd: "body-odd", mark: "mark", trace: "trace",
  ghost: "ghost", force: "force", momentum: "momentum", omega: "omega", torque: "torque", change: "torque",
};

/** The colours that hold for an element now, of style sheet names by others. */
export function coloursOf(element, names = COLOURS) {
  const style = getComputedStyle(element);
  return Object.fromEntries(Object.entries(names).map(([key, name]) => [key, style.getPropertyValue(`--${name}`).trim()]));
}

/** A line through points, as wide as so many pixels. */
function makeLine(points, color, linewidth) {
  return new Line2(new LineGeometry().setPositions(points), new LineMaterial({ color, linewidth, transparent: true }));
}

/** A circle in the plane of two vectors, as large as they are long. */
function makeCircle(centre, a, b, colour) {
  const points = Array.from({ length: 97 }, (_, i) => {
    const angle = (2 * Math.PI * i) / 96;
    return [...centre.clone().addScaledVector(a, Math.cos(angle)).addScaledVector(b, Math.sin(angle))];
  });
  return makeLine(points.flat(), colour, 1);
}

/** A letter that always faces the eye. */
function makeLetter(letter, colour, size) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  Object.assign(pen, { font: "italic 44px Georgia, serif", fillStyle: colour, textAlign: "center", textBaseline: "middle" });
  pen.fillText(letter, 32, 32);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthWrite: false }));
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
  #middle = new Vector3();
  #distance = 0; // of the eye in the first view

  /**
   * @param element what holds the stage; its colours are those of the style that holds for it
   * @param calm whether less motion is asked for
   * @param words for fingers, while they turn the tops and while they do not, and without WebGL
   */
  constructor(element, { calm = false, words = WORDS } = {}) {
    this.element = element;
    this.calm = calm;
    this.words = words;
    this.camera = new PerspectiveCamera(FIELD, 1);
    this.camera.up.set(0, 0, 1);
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
    this.hint.textContent = on ? this.words.release : this.words.hold;
    if (on) this.element.focus({ preventScroll: true });
    this.#setTouch();
  }

  /** The controls of the scene claim every touch; only a held stage does. */
  #setTouch() {
    const canvas = this.#renderer?.domElement;
    if (canvas) canvas.style.touchAction = this.isHeld ? "none" : "pan-x pan-y";
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
    const place = this.#distance ? this.#place() : null;
    const nearness = place ? this.#distance / place.radius : 1;
    this.tops = tops;
    this.view = viewOf(tops, vectors);
    this.#moment = null;
    this.#middle.set(0, 0, this.view.middle);
    this.#distance = (ROOM * this.view.radius) / Math.sin(MathUtils.degToRad(FIELD / 2));
    this.camera.near = this.#distance / 50;
    this.camera.far = this.#distance * 20;
    this.#limitControls();
    if (place) this.#putEye(new Spherical(this.#distance / nearness, place.phi, place.theta));
    else this.#reset();
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
      pane.turning = new Group();
      pane.curves = new Group().add(pane.turning);
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
    const light = new DirectionalLight("#ffffff", 2.4);
    light.position.set(2, -3, 5);
    this.#scene = new Scene().add(light, new HemisphereLight("#ffffff", "#c8c8c8", 2.6));
    this.#addSpace();
    this.#panes = Array.from({ length: countPanes(this.tops) }, () => this.#makePane());
    this.#tops = this.tops.map((top, k) => this.#makeTop(top, this.view.tips[k]));
    this.setCurves(this.#curves);
    this.#showHidden();
  }

  #makePane() {
    const pane = new Group();
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
    const [x, y, z] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    const circles = band
      ? band.map((height) => [Math.sqrt(Math.max(tip ** 2 - height ** 2, 0)), height, x, y])
      : [[tip, 0, x, y], [tip, 0, x, z], [tip, 0, y, z]];
    for (const [radius, height, a, b] of circles) {
      const [u, v] = [a, b].map((axis) => axis.clone().multiplyScalar(radius));
      this.#scene.add(makeCircle(z.clone().multiplyScalar(height), u, v, colours.faint));
    }
    const length = 0.34 * size;
    for (const [axis, letter] of [[x, "x"], [y, "y"], [z, "z"]]) {
      const end = axis.clone().multiplyScalar(length);
      const sign = makeLetter(letter, colours.ink, 0.36 * length);
      sign.position.copy(end).multiplyScalar(1.2);
      this.#scene.add(makeLine([0, 0, 0, ...end], colours.ink, 1.5), sign);
    }
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
    const origin = new Vector3();
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
      this.hint.textContent = this.words.lack;
      this.hint.hidden = false;
      return;
    }
    this.element.prepend(canvas);
    this.#renderer = new WebGLRenderer({ canvas, context });
    this.#renderer.setScissorTest(true);
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enablePan: false, rotateSpeed: this.calm ? 0.6 : 0.9 });
    this.#limitControls();
    this.controls.addEventListener("change", () => this.#draw());
    this.#setTouch();
    this.#build();
    this.#resize();
  }

  #limitControls() {
    if (!this.controls) return;
    this.controls.target.copy(this.#middle);
    this.controls.minDistance = NEAREST * this.#distance;
    this.controls.maxDistance = FARTHEST * this.#distance;
    this.controls.update();
  }

  /** Give the context back; what stands on the stage is kept. */
  close() {
    if (!this.#renderer) return;
    release(this.#scene);
    this.controls.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
    this.#renderer.domElement.remove();
    [this.#renderer, this.#scene, this.controls] = [null, null, null];
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
    const half = Math.tan(MathUtils.degToRad(FIELD / 2));
    this.camera.aspect = width / height;
    this.camera.fov = 2 * MathUtils.radToDeg(Math.atan(half * Math.max(1, height / width)));
    this.camera.updateProjectionMatrix();
  }

  /** Take the colours of the page again, which may have become dark. */
  recolour() {
    this.#build();
    this.redraw();
  }

  /** Change the view: "turn" (azimuth, elevation; rad), "zoom" (factor) or "reset". */
  look(how, ...amounts) {
    const place = this.#place();
    if (how === "reset") this.#reset();
    else if (how === "turn") {
      place.theta += amounts[0];
      place.phi = MathUtils.clamp(place.phi - amounts[1], 0.01, Math.PI - 0.01);
      this.#putEye(place);
    } else {
      place.radius = MathUtils.clamp(place.radius / amounts[0], NEAREST * this.#distance, FARTHEST * this.#distance);
      this.#putEye(place);
    }
    this.#draw();
  }

  #reset() {
    const { azimuth, elevation } = FIRST_VIEW;
    this.#putEye(new Spherical(this.#distance, Math.PI / 2 - elevation, azimuth));
  }

  /** Where the eye is; three's spherical coordinates have y upward. */
  #place() {
    const { x, y, z } = this.camera.position.clone().sub(this.#middle);
    return new Spherical().setFromCartesianCoords(y, z, x);
  }

  #putEye(place) {
    const { x: y, y: z, z: x } = new Vector3().setFromSpherical(place);
    this.camera.position.set(x, y, z).add(this.#middle);
    this.camera.lookAt(this.#middle);
    this.controls?.update();
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
