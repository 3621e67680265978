// The picture of a live top: bodies, paths, arrows and cones of its motions, on the stage.

import { Quaternion } from "three";
import { measure } from "../stage/body.js";
import { Stage } from "../stage/stage.js";
import { unitsOf } from "../stage/view.js";
import { drawingOf } from "./track.js";

const VECTORS = { momentum: "momentum", omega: "omegaSpace", force: "force", torque: "torque", change: "change" };
const PARTS = ["trace", ...Object.keys(VECTORS)];
const SPOKES = 36; // of a cone
const SPHERE = { times: [0, 1, 2, 3, 4, 5], points: [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1] };

/** Points of a cone about the pivot: its edge, and spokes to it. */
function coneOf(table, perUnit) {
  const edge = new Float32Array(table).map((value) => value * perUnit);
  const count = edge.length / 3;
  const spokes = [];
  for (let k = 0; k <= SPOKES; k += 1) {
    const i = 3 * Math.round(((count - 1) * k) / SPOKES);
    spokes.push(0, 0, 0, edge[i], edge[i + 1], edge[i + 2]);
  }
  return [edge, [...spokes, 0, 0, 0]];
}

/** Tables one after the other. */
function joined(tables) {
  if (tables.length === 1) return tables[0];
  return Float64Array.from(tables.flatMap((table) => [...table]));
}

export class Picture {
  #drawn = "";
  #tops = [];
  #tips = []; // of each top how far its tip is from the pivot, m
  #unit = 0; // how long a unit of angular velocity is drawn, m

  /** @param parts of the live top @param calm whether less motion is asked for */
  constructor(parts, calm) {
    this.parts = parts;
    this.stage = new Stage(parts.stage, { calm });
    for (const name of ["body_shown", "cones", ...PARTS]) parts[name].addEventListener("change", () => this.#showParts());
  }

  /** Show motions: of each its `state`, `track`, `look` ("solid" or "ghost") and `pane`. The first is that of the sliders. */
  fill(tops) {
    const { stage, parts } = this;
    const drawings = tops.map(({ state, track }) => drawingOf(state, track.body));
    const made = tops.map(({ look, pane }, k) => ({ body: drawings[k].body, trace: SPHERE, look, pane }));
    this.#tops = tops;
    this.#tips = drawings.map(({ body }) => measure(body).tip);
    const vectors = Object.fromEntries(
      Object.entries(VECTORS).map(([name, key]) => [name, joined(this.#solid().map(({ track }) => track[key]))]),
    );
    this.#unit = unitsOf(made, vectors).omega;
    const key = JSON.stringify(made);
    if (key !== this.#drawn) {
      this.#drawn = key;
      this.drawing = drawings[0].body; // the same while the body is the same
      stage.setTops(made, vectors);
      this.#setVisible();
    }
    stage.setTraces(tops.map(({ track }) => ({ times: track.t, points: track.axis })), vectors);
    parts.label.textContent = [drawings[0].label, tops[0].track.lack].filter(Boolean).join(" ");
    this.#setCurves();
  }

  /** The motions with arrows and cones: one in each pane. */
  #solid() {
    return this.#tops.filter(({ look }) => look === "solid");
  }

  #setCurves() {
    const { parts } = this;
    const curves = this.#solid().flatMap(({ track, pane }, k) => {
      const [found, tip] = [[], this.#tips[k]];
      if (parts.trace.checked) {
        found.push({ points: new Float32Array(track.axis).map((value) => value * tip), colour: "faint", width: 1.4 });
      }
      if (parts.cones.checked) {
        for (const [table, colour, frame] of [[track.omegaSpace, "omega", "space"], [track.omega, "mark", "body"]]) {
          const [edge, spokes] = coneOf(table, this.#unit);
          found.push({ points: edge, colour, width: 2, frame }, { points: spokes, colour, width: 0.7, frame });
        }
      }
      return found.map((curve) => ({ ...curve, pane }));
    });
    this.stage.setCurves(curves);
  }

  /** How far the tip of the first top is from the pivot, m. */
  get tip() {
    return this.#tips[0];
  }

  #showParts() {
    this.#setVisible();
    this.#setCurves();
    this.show(this.time);
  }

  #setVisible() {
    const { parts, stage } = this;
    stage.setVisible("body", parts.body_shown.checked);
    for (const name of PARTS) stage.setVisible(name, parts[name].checked);
  }

  /** Show a moment of all motions; returns that of the first. */
  show(time) {
    this.time = time;
    const moments = this.#tops.map(({ track }) => track.at(time));
    const solid = moments.filter((_, k) => this.#tops[k].look === "solid");
    this.stage.show({
      time,
      attitudes: moments.map(({ quaternion: [w, x, y, z] }) => new Quaternion(x, y, z, w)),
      vectors: solid.map((moment) => Object.fromEntries(
        Object.entries(VECTORS).map(([name, key]) => [name, moment[key]]),
      )),
    });
    return moments[0];
  }
}
