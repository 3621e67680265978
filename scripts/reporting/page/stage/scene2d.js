// The tops as a drawing on a plain canvas, for browsers without WebGL: the methods of scene3d.js.

import { Vector3 } from "three";
import { frameOf, wiresOf } from "./solid.js";
import { countUpTo, strengthAt } from "./trace.js";
import { FIRST_VIEW, countPanes, placePanes } from "./view.js";

const ROOM = 1.12;
const FADES = 24; // strengths of a trace that are told apart

export class Scene2D {
  #curves = [];
  #hidden = new Set();

  constructor(canvas, colours, { onChange }) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.ratio = 1;
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

  setTops(tops, view) {
    this.tops = tops.map((top, k) => ({
      ...top,
      tip: view.tips[k],
      wires: top.body.solids.flatMap((solid) => {
        const frame = frameOf(solid);
        return wiresOf(solid).map((wire) => wire.map((point) => point.clone().applyMatrix4(frame)));
      }),
    }));
    this.view = view;
  }

  setTraces(tops, perUnit) {
    this.tops = this.tops.map((top, k) => ({ ...top, trace: tops[k].trace }));
    this.view = { ...this.view, perUnit };
  }

  setCurves(curves) {
    this.#curves = curves;
  }

  setColours(colours) {
    this.colours = colours;
  }

  setVisible(name, on) {
    if (on) this.#hidden.delete(name);
    else this.#hidden.add(name);
  }

  #isShown(name) {
    return !this.#hidden.has(name);
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
    const [left, top, width, height] = this.place;
    const unit = (this.nearness * Math.min(width, height)) / (2 * ROOM * this.view.radius);
    return [
      left + width / 2 + unit * (ca * y - sa * x),
      top + height / 2 - unit * (ce * (z - this.view.middle) - se * (ca * x + sa * y)),
    ];
  }

  /** Where a point of space is in the first pane, in pixels of CSS. */
  project(point) {
    [this.place] = this.#places();
    return this.#project(point).map((value) => value / this.ratio);
  }

  #line(points, colour, width) {
    this.pen.beginPath();
    for (const point of points) this.pen.lineTo(...this.#project(point));
    this.pen.strokeStyle = colour;
    this.pen.lineWidth = width * this.ratio;
    this.pen.stroke();
  }

  /** A circle about a centre, in the plane of the vectors a and b. */
  #circle(centre, a, b, colour, width) {
    const points = Array.from({ length: 73 }, (_, i) => {
      const angle = (2 * Math.PI * i) / 72;
      return centre.clone().addScaledVector(a, Math.cos(angle)).addScaledVector(b, Math.sin(angle));
    });
    this.#line(points, colour, width);
  }

  show(moment) {
    this.moment = moment;
    this.draw();
  }

  draw() {
    if (!this.moment || !this.view) return;
    const { pen, canvas } = this;
    pen.fillStyle = this.colours.ground;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    this.#places().forEach((place, pane) => {
      this.place = place;
      pen.save();
      pen.beginPath();
      pen.rect(...place);
      pen.clip();
      this.#drawPane(pane);
      pen.restore();
    });
  }

  /** Where the panes are, in pixels of the canvas. */
  #places() {
    return placePanes(countPanes(this.tops), this.canvas.width, this.canvas.height);
  }

  #drawPane(pane) {
    const { colours, view } = this;
    const { time, attitudes } = this.moment;
    const vectors = this.moment.vectors[pane];
    const isHere = (item) => (item.pane ?? 0) === pane;
    const origin = new Vector3();
    const axes = [0, 1, 2].map((i) => new Vector3().setComponent(i, view.tip));
    for (const [i, k] of [[0, 1], [0, 2], [1, 2]]) this.#circle(origin, axes[i], axes[k], colours.faint, 1);
    if (this.#isShown("curves")) this.#drawCurves(this.#curves.filter(isHere), attitudes[this.tops.findIndex(isHere)]);
    this.tops.forEach((top, k) => {
      if (!isHere(top) || !this.#isShown(top.look === "ghost" ? "ghost" : "body")) return;
      this.#drawBody(top, attitudes[k]);
      if (this.#isShown("trace")) this.#drawTrace(top, time, attitudes[k]);
    });
    for (const [name, unit] of Object.entries(view.perUnit)) {
      const vector = this.#isShown(name) && vectors[name];
      if (!vector) continue;
      const begin = name === "change" && vectors.momentum
        ? vectors.momentum.clone().multiplyScalar(view.perUnit.momentum) : origin;
      this.#line([begin, vector.clone().multiplyScalar(unit).add(begin)], colours[name], 3);
    }
  }

  #drawCurves(curves, attitude) {
    for (const { points, colour, width = 1.5, frame = "space" } of curves) {
      const corners = [];
      for (let i = 0; i < points.length; i += 3) {
        const corner = new Vector3().fromArray(points, i);
        corners.push(frame === "body" ? corner.applyQuaternion(attitude) : corner);
      }
      this.#line(corners, this.colours[colour] ?? colour, width);
    }
  }

  /** In pieces of one strength each, the oldest first. */
  #drawTrace({ trace: { times, points }, tip, body, look }, time, attitude) {
    const count = countUpTo(times, time);
    const duration = times[times.length - 1] - times[0] || 1;
    const corner = (i) => new Vector3().fromArray(points, 3 * i).multiplyScalar(tip);
    const strength = (i) => Math.round(FADES * strengthAt((time - times[i]) / duration));
    const colour = this.colours[look === "ghost" ? "ghost" : "trace"];
    let piece = [];
    for (let i = 0; i < count; i += 1) {
      piece.push(corner(i));
      if (i + 1 === count) piece.push(new Vector3(...body.axis).applyQuaternion(attitude).multiplyScalar(tip));
      if (i + 1 === count || strength(i + 1) !== strength(i)) {
        this.pen.globalAlpha = strength(i) / FADES;
        this.#line(piece, colour, 2);
        piece = [corner(i)];
      }
    }
    this.pen.globalAlpha = 1;
  }

  #drawBody({ body, wires, tip, look }, attitude) {
    const isGhost = look === "ghost";
    const place = (point) => point.clone().applyQuaternion(attitude);
    const axis = place(new Vector3(...body.axis)).multiplyScalar(tip);
    this.#line([new Vector3(), axis], isGhost ? this.colours.ghost : this.colours.ink, isGhost ? 1.5 : 3);
    for (const wire of wires) {
      this.#line(wire.map(place), isGhost ? this.colours.ghost : this.colours.even, isGhost ? 1.2 : 2.5);
    }
    const [solid] = body.solids;
    if (!solid || isGhost) return;
    const frame = frameOf(solid);
    const rim = wiresOf(solid)[0]?.[0]?.clone().applyMatrix4(frame);
    if (rim) this.#line([place(new Vector3(...solid.place)), place(rim)], this.colours.mark, 3);
  }

  dispose() {
    this.stop.abort();
  }
}
