// The tops in three dimensions, by three.js. A scene has the methods setTops, setCurves, setVisible,
// setColours, show, draw, resize, turn, zoom, reset and dispose; scene2d.js has the same.

import {
  CanvasTexture,
  DirectionalLight,
  Group,
  HemisphereLight,
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
import { Arrow } from "./arrow.js";
import { makeBody } from "./body.js";
import { Trace } from "./trace.js";
import { FIRST_VIEW, countPanes, placePanes } from "./view.js";

const FIELD = 32; // degrees
const NEAREST = 0.4; // times the first distance
const FARTHEST = 4;
const ROOM = 1.06; // times the part of space that is to be seen
const TRACE_WIDTH = { solid: 2.5, ghost: 1.8 }; // pixels

let webGL = null; // whether the browser has it, once that is known

/** Whether the browser has WebGL. */
export function hasWebGL() {
  if (webGL === null) {
    const context = document.createElement("canvas").getContext("webgl2");
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    webGL = context !== null;
  }
  return webGL;
}

/** A line through points, as wide as so many pixels. */
function makeLine(points, colour, width) {
  const geometry = new LineGeometry().setPositions(points);
  return new Line2(geometry, new LineMaterial({ color: colour, linewidth: width, transparent: true }));
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
  pen.font = "italic 44px Georgia, serif";
  pen.fillStyle = colour;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
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
  object?.removeFromParent();
}

export class Scene3D {
  #tops = [];
  #panes = []; // of each a group of what it alone shows: tops, `arrows` by name, `curves`, those that turn with its top
  #curves = [];
  #hidden = new Set();

  /**
   * @param canvas where to draw
   * @param onChange called when the view has changed and the scene is to be drawn again
   */
  constructor(canvas, colours, { calm, onChange }) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setScissorTest(true);
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera = new PerspectiveCamera(FIELD, 1);
    this.camera.up.set(0, 0, 1);
    this.middle = new Vector3();
    this.tops = [];
    this.size = [1, 1];
    this.distance = 1;
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, {
      enablePan: false,
      enableDamping: false,
      rotateSpeed: calm ? 0.6 : 0.9,
    });
    this.colours = colours;
    this.controls.addEventListener("change", onChange);
  }

  /** Put tops on the stage, in a view that `viewOf` gives; the eye stays where it was, if it was. */
  setTops(tops, view) {
    const place = this.view ? this.#place() : null;
    const nearness = place ? this.distance / place.radius : 1;
    this.tops = tops;
    this.view = view;
    this.middle.set(0, 0, view.middle);
    this.distance = (ROOM * view.radius) / Math.sin((FIELD * Math.PI) / 360);
    this.camera.near = this.distance / 50;
    this.camera.far = this.distance * 20;
    this.controls.target.copy(this.middle);
    this.controls.minDistance = NEAREST * this.distance;
    this.controls.maxDistance = FARTHEST * this.distance;
    if (place) this.#putEye(new Spherical(this.distance / nearness, place.phi, place.theta));
    else this.reset();
    this.#fit();
    this.#build();
  }

  /** Other traces and vectors of the same tops, in the same view. */
  setTraces(tops, perUnit) {
    this.tops = tops;
    this.view = { ...this.view, perUnit };
    this.#tops.forEach(({ trace }, k) => trace.setPath(tops[k].trace));
  }

  /** Closed or open curves beside the tops, as cones: see `Stage.setCurves`. */
  setCurves(curves) {
    this.#curves = curves;
    if (this.scene) this.#addCurves();
  }

  setColours(colours) {
    this.colours = colours;
    if (this.view) this.#build();
  }

  #build() {
    release(this.scene);
    this.scene = new Scene();
    this.renderer.setClearColor(this.colours.ground);
    const light = new DirectionalLight("#ffffff", 2.4);
    light.position.set(2, -3, 5);
    this.scene.add(light, new HemisphereLight("#ffffff", "#c8c8c8", 2.6));
    this.#addSpace();
    this.#panes = Array.from({ length: countPanes(this.tops) }, () => this.#makePane());
    this.#tops = this.tops.map((top, k) => this.#makeTop(top, this.view.tips[k]));
    this.#addCurves();
    this.#showHidden();
  }

  #makePane() {
    const pane = new Group();
    pane.arrows = Object.fromEntries(
      Object.keys(this.view.perUnit).map((name) => [name, new Arrow(this.colours[name], this.view.tip)]),
    );
    pane.add(...Object.values(pane.arrows));
    this.scene.add(pane);
    return pane;
  }

  #makeTop(top, tip) {
    const isGhost = top.look === "ghost";
    const { trace, ghost, ground } = this.colours;
    const width = TRACE_WIDTH[isGhost ? "ghost" : "solid"];
    const made = {
      name: isGhost ? "ghost" : "body",
      body: makeBody(top.body, this.colours, isGhost),
      trace: new Trace(top.trace, tip, { colour: isGhost ? ghost : trace, ground, width }),
      axis: new Vector3(...top.body.axis),
    };
    this.#panes[top.pane ?? 0].add(made.body, made.trace);
    return made;
  }

  /** The sphere of the tip, or the two circles between which it stays; and the axes of space. */
  #addSpace() {
    const { colours, view } = this;
    const [x, y, z] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    const { tip, band } = view;
    const circles = band
      ? band.map((height) => [Math.sqrt(Math.max(tip ** 2 - height ** 2, 0)), height, x, y])
      : [[tip, 0, x, y], [tip, 0, x, z], [tip, 0, y, z]];
    for (const [radius, height, a, b] of circles) {
      const [u, v] = [a, b].map((axis) => axis.clone().multiplyScalar(radius));
      this.scene.add(makeCircle(z.clone().multiplyScalar(height), u, v, colours.faint));
    }
    const length = 0.34 * view.radius;
    for (const [axis, letter] of [[x, "x"], [y, "y"], [z, "z"]]) {
      const end = axis.clone().multiplyScalar(length);
      const sign = makeLetter(letter, colours.ink, 0.36 * length);
      sign.position.copy(end).multiplyScalar(1.2);
      this.scene.add(makeLine([0, 0, 0, ...end], colours.ink, 1.5), sign);
    }
  }

  #addCurves() {
    for (const pane of this.#panes) {
      release(pane.curves);
      pane.curves = new Group();
      pane.turning = new Group();
      pane.add(pane.curves.add(pane.turning));
    }
    for (const { points, colour, width = 1.5, frame = "space", pane = 0 } of this.#curves) {
      const line = makeLine(points, this.colours[colour] ?? colour, width);
      line.renderOrder = 4;
      const { curves, turning } = this.#panes[pane];
      (frame === "body" ? turning : curves).add(line);
    }
  }

  /** Show a moment: its time, an attitude (a quaternion) per top, and per pane vectors or null by name. */
  show({ time, attitudes, vectors }) {
    this.#tops.forEach(({ body, trace, axis }, k) => {
      body.quaternion.copy(attitudes[k]);
      trace.show(time, axis.clone().applyQuaternion(attitudes[k]));
    });
    this.#panes.forEach(({ turning, arrows }, k) => {
      turning.quaternion.copy(attitudes[this.tops.findIndex(({ pane = 0 }) => pane === k)]);
      for (const [name, arrow] of Object.entries(arrows)) {
        arrow.point(vectors[k][name] ?? null, this.view.perUnit[name], this.#originOf(name, vectors[k]));
      }
    });
    this.draw();
  }

  /** The change of the angular momentum begins at its tip, everything else at the pivot. */
  #originOf(name, { momentum }) {
    const origin = new Vector3();
    return name === "change" && momentum ? origin.addScaledVector(momentum, this.view.perUnit.momentum) : origin;
  }

  /** Where a point of space is in the first pane, in pixels of CSS. */
  project(point) {
    const { x, y } = point.clone().project(this.camera);
    const [, , width, height] = this.#places()[0];
    return [((x + 1) * width) / 2, ((1 - y) * height) / 2];
  }

  /** Where the panes are, in pixels of CSS. */
  #places() {
    return placePanes(countPanes(this.tops), ...this.size);
  }

  draw() {
    if (!this.scene) return;
    const { renderer } = this;
    this.#places().forEach(([x, y, width, height], k) => {
      this.#panes.forEach((pane, n) => { pane.visible = n === k; });
      const below = this.size[1] - y - height;
      renderer.setViewport(x, below, width, height);
      renderer.setScissor(x, below, width, height);
      renderer.render(this.scene, this.camera);
    });
  }

  /** Show or hide `body`, `ghost`, `trace`, `curves`, or the arrow of a vector. */
  setVisible(name, on) {
    if (on) this.#hidden.delete(name);
    else this.#hidden.add(name);
    if (this.scene) this.#showHidden();
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

  /** To a size in pixels. */
  resize(width, height) {
    this.size = [width, height];
    this.renderer.setSize(width, height, false);
    this.#fit();
  }

  /** Have the panes filled by the view; a narrow view is taken from farther off. */
  #fit() {
    const [, , width, height] = this.#places()[0];
    this.camera.aspect = width / height;
    this.camera.fov = width < height ? 2 * degrees(Math.atan(Math.tan(radians(FIELD / 2)) * (height / width))) : FIELD;
    this.camera.updateProjectionMatrix();
  }

  /** Turn the eye about the pivot, rad. */
  turn(azimuth, elevation) {
    const place = this.#place();
    place.theta += azimuth;
    place.phi = Math.min(Math.max(place.phi - elevation, 0.01), Math.PI - 0.01);
    this.#putEye(place);
  }

  /** Go nearer by a factor, or farther if it is below one. */
  zoom(factor) {
    const place = this.#place();
    const { minDistance, maxDistance } = this.controls;
    place.radius = Math.min(Math.max(place.radius / factor, minDistance), maxDistance);
    this.#putEye(place);
  }

  reset() {
    const { azimuth, elevation } = FIRST_VIEW;
    this.#putEye(new Spherical(this.distance, Math.PI / 2 - elevation, azimuth));
  }

  /** Where the eye is; three's spherical coordinates have y upward. */
  #place() {
    const { x, y, z } = this.camera.position.clone().sub(this.middle);
    return new Spherical().setFromCartesianCoords(y, z, x);
  }

  #putEye(place) {
    const { x: y, y: z, z: x } = new Vector3().setFromSpherical(place);
    this.camera.position.set(x, y, z).add(this.middle);
    this.controls.update();
  }

  /** Give back what the graphics card holds. */
  dispose() {
    release(this.scene);
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

function degrees(angle) {
  return (angle * 180) / Math.PI;
}

function radians(angle) {
  return (angle * Math.PI) / 180;
}
