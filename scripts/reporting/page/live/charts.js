// The charts of a live top: angles and energies against time with a common cursor, the effective
// potential, and the phase portrait with the present point.

import { drawBifurcation } from "./bifurcation.js";
import { Plot, rangeOf } from "./plot.js";

const DEGREE = 180 / Math.PI;
const SAMPLES = 220; // of the potential
const LEVELS = [0.15, 0.45, 1.7, 2.6]; // of the energy above the least potential, beside that of the motion
const LEAST_RANGE = 4; // degrees of inclination to each side that are shown at least

const degrees = (column) => column.map((value) => value * DEGREE);

/** Colours of lines, by the names of the style sheet. */
function linesOf(element) {
  const style = getComputedStyle(element);
  const names = {
    rule: "--rule", quiet: "--quiet", ink: "--ink", trace: "--trace", kinetic: "--kinetic", potential: "--potential",
  };
  return Object.fromEntries(Object.entries(names).map(([key, name]) => [key, style.getPropertyValue(name).trim()]));
}

/** The largest magnitude in a column. */
const extremeOf = (column) => Math.max(...column.map(Math.abs));

export class Charts {
  /** Called with the time at which one points. */
  onPick = () => {};

  /** @param panes elements by name: theta, phi, psi, energy, potential, portrait */
  constructor(panes) {
    this.recolour(panes.theta);
    this.plots = Object.fromEntries(Object.entries(panes).map(([name, pane]) => [name, new Plot(pane)]));
    for (const name of ["theta", "phi", "psi", "energy"]) {
      const { pane } = this.plots[name];
      const pick = (event) => {
        if (event.buttons === 1) this.onPick(this.plots[name].at(event.clientX));
      };
      pane.addEventListener("pointerdown", (event) => {
        pane.setPointerCapture(event.pointerId);
        pick(event);
      });
      pane.addEventListener("pointermove", pick);
    }
  }

  /** Take the colours that hold for an element: to ask for them costs as much as to draw a chart. */
  recolour(element = this.plots.theta.pane) {
    this.colours = linesOf(element);
  }

  resize() {
    for (const plot of Object.values(this.plots)) plot.resize();
  }

  /** Draw all charts of a track, and the angles of another beside it. */
  draw(track, other = null) {
    const { colours, plots } = this;
    const pane = plots.potential.pane.parentElement;
    if (pane.hidden === Boolean(track.nutation)) { // of other bodies there is none
      pane.hidden = !track.nutation;
      this.resize();
    }
    const { t } = track;
    const times = [0, track.wanted];
    const byTime = (plot, columns, lines, least, beside = []) => {
      plot.begin(times, rangeOf([...columns, ...beside], least), colours);
      for (const column of beside) plot.line(other.t, column, colours.quiet);
      columns.forEach((column, i) => plot.line(t, column, lines[i]));
      plot.end();
    };
    for (const name of ["theta", "phi", "psi"]) {
      const beside = other ? [degrees(other[name])] : [];
      byTime(plots[name], [degrees(track[name])], [colours.trace], 1e-3, beside);
    }
    const energies = ["kinetic", "potential", "energy"];
    byTime(plots.energy, energies.map((name) => track[name]), [colours.kinetic, colours.potential, colours.ink]);
    this.#drawPotential(track, colours);
    drawBifurcation(plots.portrait.pane, track, colours);
  }

  /** Effective potential and phase portrait share the axis of the inclination. */
  #drawPotential(track, colours) {
    const { potential, portrait } = this.plots;
    const { nutation, body, theta: angles, thetaRate, motion } = track;
    const [low, high] = rangeOf([angles], 0).map((angle) => angle * DEGREE);
    const room = Math.max(0.45 * (high - low), LEAST_RANGE);
    const range = motion.isPlane ? [low - room, high + room] : [Math.max(0, low - room), Math.min(180, high + room)];
    const curves = nutation && this.#curvesOf(nutation, body, range);
    if (curves) {
      const { theta, values, least, level, depth } = curves;
      potential.begin(range, [least - 0.12 * depth, least + 2.6 * depth], colours);
      potential.line(theta, values, colours.ink);
      potential.line([low, high], [level, level], colours.trace, 2.4);
      potential.line(range, [level, level], colours.trace, 1, [4, 4]);
      potential.end();
      this.level = level;
    }
    const fastest = curves ? Math.sqrt((2 * curves.depth) / body.inertia1) : extremeOf(thetaRate);
    const top = 1.35 * DEGREE * (fastest || 1e-6);
    portrait.begin(range, [-top, top], colours);
    for (const part of curves ? LEVELS : []) {
      this.#orbit(curves.theta, curves.values, curves.least + part * curves.depth, body.inertia1, colours.quiet, 1);
    }
    portrait.line(degrees(angles), degrees(thetaRate), colours.trace, 2.4);
    portrait.end();
  }

  /** The effective potential over a range, with the energy of the motion. */
  #curvesOf(nutation, body, range) {
    const step = (range[1] - range[0]) / SAMPLES;
    const theta = Float64Array.from({ length: SAMPLES + 1 }, (_, i) => range[0] + step * i);
    const values = theta.map((angle) => nutation.potential(angle / DEGREE));
    const { energy } = nutation;
    const finite = values.filter(Number.isFinite);
    const least = Math.min(energy, ...finite);
    let depth = energy - least;
    // A motion at the bottom of the potential: the scale is that of the walls.
    const isFlat = !(depth > 1e-9 * (Math.abs(energy) + body.mgl));
    if (isFlat) depth = Math.max(0.25 * (Math.max(...finite) - least), 1e-12 + 1e-6 * Math.abs(energy));
    return { theta, values, least, depth, level: isFlat ? least : energy };
  }

  /** theta' = +- sqrt(2 (E - V)/I1) over the inclination. */
  #orbit(theta, values, energy, inertia, colour, width) {
    const [angles, rates] = [[], []];
    values.forEach((value, i) => {
      const [before, above] = [values[i - 1] - energy, value - energy];
      const part = before / (before - above);
      if (before > 0 !== above > 0 && Number.isFinite(part)) { // it turns between two samples
        angles.push(theta[i - 1] + part * (theta[i] - theta[i - 1]));
        rates.push(0);
      }
      angles.push(theta[i]);
      rates.push(above <= 0 ? DEGREE * Math.sqrt((-2 * above) / inertia) : NaN);
    });
    this.plots.portrait.line(angles, rates, colour, width);
    this.plots.portrait.line(angles, rates.map((rate) => -rate), colour, width);
  }

  /** Move the marks to a moment. */
  show(moment) {
    const { plots } = this;
    for (const name of ["theta", "phi", "psi", "energy"]) plots[name].place(moment.t);
    const theta = moment.angle[1] * DEGREE;
    if (!plots.potential.pane.parentElement.hidden) plots.potential.place(theta, this.level);
    plots.portrait.place(theta, moment.rate[1] * DEGREE);
  }
}
