// The top as a drawing on a plain canvas, for browsers without WebGL: the same methods as scene3d.js.

import { Vector3 } from "three";
import { FIRST_VIEW, scaleOf } from "./scale.js";

const ROOM = 1.25;

export class Scene2D {
  constructor(canvas, motion, colours, { onChange }) {
    this.canvas = canvas;
    this.motion = motion;
    this.scale = scaleOf(motion);
    this.pen = canvas.getContext("2d");
    this.visible = { trace: true, force: true, momentum: true };
    this.trace = motion.trace();
    this.onChange = onChange;
    this.stop = new AbortController();
    this.#listen();
    this.setColours(colours);
    this.reset();
  }

  #listen() {
    const { signal } = this.stop;
    let from = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = event;
      this.canvas.setPointerCapture(event.pointerId);
    }, { signal });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from || event.pointerId !== from.pointerId) return;
      this.turn((from.clientX - event.clientX) / 150, (event.clientY - from.clientY) / 150);
      from = event;
      this.onChange();
    }, { signal });
    for (const end of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(end, () => { from = null; }, { signal });
    }
  }

  setColours(colours) {
    this.colours = colours;
  }

  setVisible(name, on) {
    this.visible[name] = on;
  }

  resize(width, height) {
    const ratio = Math.min(devicePixelRatio, 2);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.ratio = ratio;
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.max(this.elevation + elevation, -1.57), 1.57);
  }

  zoom(factor) {
    this.nearness = Math.min(Math.max(this.nearness * factor, 0.25), 4);
  }

  reset() {
    Object.assign(this, FIRST_VIEW, { nearness: 1 });
  }

  /** Where a point of space is on the canvas. */
  #project({ x, y, z }) {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    const { width, height } = this.canvas;
    const unit = (this.nearness * Math.min(width, height)) / (2 * ROOM * this.scale.radius);
    return [
      width / 2 + unit * (ca * y - sa * x),
      height / 2 - unit * (ce * (z - this.scale.middle) - se * (ca * x + sa * y)),
    ];
  }

  #line(points, colour, width) {
    this.pen.beginPath();
    for (const point of points) this.pen.lineTo(...this.#project(point));
    this.pen.strokeStyle = colour;
    this.pen.lineWidth = width * this.ratio;
    this.pen.stroke();
  }

  /** A circle about a centre, normal to the vector a x b. */
  #circle(centre, a, b, colour, width) {
    const points = Array.from({ length: 73 }, (_, i) => {
      const angle = (2 * Math.PI * i) / 72;
      return centre.clone().addScaledVector(a, Math.cos(angle)).addScaledVector(b, Math.sin(angle));
    });
    this.#line(points, colour, width);
  }

  show(state) {
    this.state = state;
    this.draw();
  }

  draw() {
    if (!this.state) return;
    const { colours, pen, scale } = this;
    const origin = new Vector3();
    pen.fillStyle = colours.ground;
    pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
    const axes = [0, 1, 2].map((i) => new Vector3().setComponent(i, scale.tip));
    for (const [i, k] of [[0, 1], [0, 2], [1, 2]]) this.#circle(origin, axes[i], axes[k], colours.faint, 1);
    if (this.visible.trace) this.#drawTrace();
    this.#drawBody(this.state.attitude);
    for (const name of ["force", "momentum"]) {
      const vector = this.visible[name] && this.state[name];
      if (vector) this.#line([origin, vector.clone().multiplyScalar(scale[name])], colours[name], 3);
    }
  }

  #drawTrace() {
    const past = [];
    for (let i = 0; i < this.trace.times.length && this.trace.times[i] <= this.state.time; i += 1) {
      past.push(new Vector3().fromArray(this.trace.points, 3 * i).multiplyScalar(this.scale.tip));
    }
    this.#line(past, this.colours.trace, 2);
  }

  #drawBody(attitude) {
    const { body } = this.motion;
    const [x, y] = [0, 3].map((i) => new Vector3().fromArray(body.solid.axes ?? [1, 0, 0, 0, 1, 0], i));
    const size = body.solid.radius ?? Math.max(...(body.solid.edges ?? [this.scale.reach])) / 2;
    const centre = new Vector3(...body.centre).applyQuaternion(attitude);
    for (const edge of [x, y]) edge.applyQuaternion(attitude).multiplyScalar(size);
    const tip = this.motion.axisOf(attitude).multiplyScalar(this.scale.tip);
    this.#line([new Vector3(), tip], this.colours.ink, 3);
    this.#circle(centre, x, y, this.colours.even, 3);
    this.#line([centre, centre.clone().add(x)], this.colours.mark, 3);
  }

  dispose() {
    this.stop.abort();
  }
}
