// The top in three dimensions, by three.js. A scene has the methods show, setVisible, setColours,
// resize, turn, zoom, reset and dispose; scene2d.js has the same.

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
import { FIRST_VIEW, scaleOf } from "./scale.js";
import { makeBody } from "./solid.js";

const FIELD = 32; // degrees
const NEAREST = 0.4; // times the first distance
const FARTHEST = 4;
const ROOM = 1.1; // times the reach of the body is in view

/** Whether the browser has WebGL. */
export function hasWebGL() {
  const context = document.createElement("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

/** A line through points, as wide as so many pixels. */
function makeLine(points, colour, width) {
  const geometry = new LineGeometry().setPositions(points);
  return new Line2(geometry, new LineMaterial({ color: colour, linewidth: width }));
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
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas) }));
  sprite.scale.setScalar(size);
  return sprite;
}

export class Scene3D {
  /**
   * @param canvas where to draw @param motion what to draw
   * @param onChange called when the view has changed and the scene is to be drawn again
   */
  constructor(canvas, motion, colours, { calm, onChange }) {
    this.motion = motion;
    this.scale = scaleOf(motion);
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.camera = new PerspectiveCamera(FIELD, 1, this.scale.reach / 50, this.scale.reach * 80);
    this.camera.up.set(0, 0, 1);
    this.middle = new Vector3(0, 0, this.scale.middle);
    this.distance = (ROOM * this.scale.radius) / Math.sin((FIELD * Math.PI) / 360);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.copy(this.middle);
    Object.assign(this.controls, {
      enablePan: false,
      enableDamping: false,
      minDistance: NEAREST * this.distance,
      maxDistance: FARTHEST * this.distance,
      rotateSpeed: calm ? 0.6 : 0.9,
    });
    this.visible = {};
    this.setColours(colours);
    this.reset();
    this.controls.addEventListener("change", onChange);
  }

  /** Build everything in these colours. */
  setColours(colours) {
    this.#clear();
    this.scene = new Scene();
    this.renderer.setClearColor(colours.ground);
    const light = new DirectionalLight("#ffffff", 2.4);
    light.position.set(2, -3, 5);
    this.scene.add(light, new HemisphereLight("#ffffff", "#c8c8c8", 2.6));
    this.#addSpace(colours);
    this.body = makeBody(this.motion.body, colours);
    this.#addTrace(colours);
    this.arrows = {
      force: new Arrow(colours.force, this.scale.reach),
      momentum: new Arrow(colours.momentum, this.scale.reach),
    };
    this.scene.add(this.body, this.arrows.force, this.arrows.momentum);
    for (const [name, on] of Object.entries(this.visible)) this.setVisible(name, on);
  }

  /** The sphere of the tip, or the two circles between which it stays; and the axes of space. */
  #addSpace(colours) {
    const [x, y, z] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    const { tip, between } = this.scale;
    const circles = between
      ? between.map((height) => [Math.sqrt(Math.max(tip ** 2 - height ** 2, 0)), height, x, y])
      : [[tip, 0, x, y], [tip, 0, x, z], [tip, 0, y, z]];
    for (const [radius, height, a, b] of circles) {
      const [u, v] = [a, b].map((axis) => axis.clone().multiplyScalar(radius));
      this.scene.add(makeCircle(z.clone().multiplyScalar(height), u, v, colours.faint));
    }
    for (const [axis, letter] of [[x, "x"], [y, "y"], [z, "z"]]) {
      const end = axis.clone().multiplyScalar(0.32 * this.scale.reach);
      const sign = makeLetter(letter, colours.ink, 0.13 * this.scale.reach);
      sign.position.copy(end).multiplyScalar(1.2);
      this.scene.add(makeLine([0, 0, 0, ...end], colours.ink, 1.5), sign);
    }
  }

  /** All of the trace, faint; what is past of it; and its last piece, up to the tip. */
  #addTrace(colours) {
    const { times, points } = this.motion.trace();
    this.traceTimes = times;
    this.tracePoints = points.map((value) => value * this.scale.tip);
    this.past = makeLine(this.tracePoints, colours.trace, 2.5);
    this.last = makeLine([0, 0, 0, 0, 0, 0], colours.trace, 2.5);
    const all = makeLine(this.tracePoints, colours.faint, 1.2);
    all.material.depthWrite = false; // so that what is past may be drawn upon it
    this.trace = new Group().add(all, this.past, this.last);
    this.scene.add(this.trace);
    [all, this.past, this.last].forEach((line, i) => {
      line.renderOrder = 1 + i; // after the body
    });
  }

  /** Show what `Motion.at` gives. */
  show({ time, attitude, force, momentum }) {
    this.body.quaternion.copy(attitude);
    let count = 0;
    let after = this.traceTimes.length;
    while (count < after) {
      const middle = Math.floor((count + after) / 2);
      if (this.traceTimes[middle] <= time) count = middle + 1;
      else after = middle;
    }
    this.past.geometry.instanceCount = Math.max(0, count - 1);
    this.past.visible = count > 1;
    const from = this.tracePoints.slice(3 * (count - 1), 3 * count);
    const tip = this.motion.axisOf(attitude).multiplyScalar(this.scale.tip);
    this.last.geometry.setPositions([...from, ...tip]);
    this.arrows.force.point(force, this.scale.force);
    this.arrows.momentum.point(momentum, this.scale.momentum);
    this.draw();
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
  }

  setVisible(name, on) {
    this.visible[name] = on;
    if (name === "trace") this.trace.visible = on;
    else this.arrows[name].wanted = on;
  }

  /** To a size in pixels; a narrow view is taken from farther off. */
  resize(width, height) {
    this.renderer.setSize(width, height, false);
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

  #clear() {
    this.scene?.traverse((item) => {
      item.geometry?.dispose();
      for (const material of [item.material ?? []].flat()) {
        material.map?.dispose();
        material.dispose();
      }
    });
  }

  /** Give back what the graphics card holds. */
  dispose() {
    this.#clear();
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
