// The bifurcation diagram of a symmetric top: its momenta and its energy among those of all motions with
// the same momentum about the axis. With p = L3^2/(2 I1 m g l) and x = Lz/L3 a steady precession at
// u = cos(theta) has x - u = (1 - u^2)(1 -+ r)/(2 u), r^2 = 1 - 2 u/p; no motion has less energy. The
// ordinate is the energy without that of the spin, over m g l, less x, which is that of cusps.

import { say } from "./language.js";
import { Plot } from "./plot.js";

const SAMPLES = 160; // of each part of the curve
const ROOM = 1.12; // beside the motion and the poles
const plots = new WeakMap();

/** p, x and the ordinate of a motion; null where the top has no momentum about its axis, or no weight. */
export function constantsOf({ nutation, body, start }) {
  const l3 = nutation ? body.inertia3 * start.omega[2] : 0;
  if (!l3 || !body.mgl) return null;
  const theta = start.angle[1];
  const ratio = Math.cos(theta) + (body.inertia1 * Math.sin(theta) ** 2 * start.phiRate) / l3;
  const strength = l3 ** 2 / (2 * body.inertia1 * body.mgl);
  return { strength, ratio, excess: nutation.energy / body.mgl - ratio };
}

/** The steady precessions: ratios of the momenta in their order, and ordinates. */
export function steadyOf(p) {
  const slow = (u) => {
    const [square, root] = [(1 - u) * (1 + u), Math.sqrt(Math.max(0, 1 - (2 * u) / p))];
    return [u + square / (p * (1 + root)), (-square * root) / (p * (1 + root) ** 2)];
  };
  const fast = (u) => {
    const root = Math.sqrt(Math.max(0, 1 - (2 * u) / p));
    const away = ((1 - u) * (1 + u) * (1 + root)) / (2 * u);
    return [u + away, away * ((p * (1 + root)) / (2 * u) - 1)];
  };
  // Dense at both ends, where the curve bends.
  const parts = Array.from({ length: SAMPLES }, (_, i) => (1 - Math.cos((Math.PI * (i + 0.5)) / SAMPLES)) / 2);
  const last = Math.min(1, p / 2);
  const points = [
    ...parts.map((part) => fast(-part)),
    ...parts.map((part) => slow((1 + last) * part - 1)),
    ...parts.map((part) => fast(last * (1 - part))),
  ];
  return { ratios: points.map(([x]) => x), ordinates: points.map(([, y]) => y) };
}

/** A figure of its own after that of a pane. */
function plotBeside(pane) {
  if (!plots.has(pane)) {
    const figure = document.createElement("figure");
    figure.className = "plot";
    figure.style.gridColumn = "1 / -1";
    figure.innerHTML = '<figcaption></figcaption><div class="pane" data-mark="point"></div>';
    figure.firstChild.textContent = say("plot_bifurcation");
    pane.parentElement.after(figure);
    plots.set(pane, new Plot(figure.lastChild));
  }
  return plots.get(pane);
}

function drawRest(plot, x, isFilled) {
  const { pen } = plot;
  pen.beginPath();
  pen.arc(plot.x(x), plot.y(0), 3.5, 0, 2 * Math.PI);
  pen.fillStyle = isFilled ? plot.colours.ink : "transparent";
  pen.strokeStyle = plot.colours.ink;
  pen.fill();
  pen.stroke();
}

/** Draw the diagram of a track after another pane; hidden for bodies that have none. */
export function drawBifurcation(pane, track, colours) {
  const plot = plotBeside(pane);
  const constants = constantsOf(track);
  plot.pane.parentElement.hidden = !constants;
  if (!constants) return;
  if (plot.width !== plot.pane.clientWidth || plot.height !== plot.pane.clientHeight) plot.resize();
  const { strength, ratio, excess } = constants;
  const { ratios, ordinates } = steadyOf(strength);
  const edge = ROOM * Math.max(1, Math.abs(ratio));
  const depth = -Math.min(...ordinates.filter((_, i) => Math.abs(ratios[i]) <= edge));
  const top = Math.max(1.5 * depth, 1.25 * excess);
  plot.begin([-edge, edge], [-Math.max(1.5 * depth, 0.2 * top), top], colours);
  plot.line(ratios, ordinates, colours.ink);
  plot.line([-1, 1], [0, 0], colours.quiet, 1.6, [5, 4]);
  drawRest(plot, 1, strength >= 2);
  drawRest(plot, -1, true);
  plot.end();
  plot.place(ratio, excess);
}
