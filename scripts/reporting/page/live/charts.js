// The charts of a live top: angles and energies against time with a common cursor, the effective
// potential, and the phase portrait with the present point.

import { effectivePotential, swingEnergy } from "../exact/quantities.js";
import { Plot, rangeOf } from "./plot.js";

const DEGREE = 180 / Math.PI;
const SAMPLES = 220; // of the potential
const LEVELS = [0.15, 0.45, 1.7, 2.6]; // of the energy above the least potential, beside that of the motion
const LEAST_RANGE = 4; // degrees of inclination to each side that are shown at least

const degrees = (column) => column.map((value) => value * DEGREE);

/** Colours of lines, by the names of the style sheet. */
export function linesOf(element) {
  const style = getComputedStyle(element);
  const names = {
    rule: "--rule", quiet: "--quiet", ink: "--ink", trace: "--trace", kinetic: "--kinetic", potential: "--potential",
  };
  return Object.fromEntries(Object.entries(names).map(([key, name]) => [key, style.getPropertyValue(name).trim()]));
}

export class Charts {
  /** Called with the time at which one points. */
  onPick = () => {};

  /** @param panes elements by name: theta, phi, psi, energy, potential, portrait */
  constructor(panes) {
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

  resize() {
    for (const plot of Object.values(this.plots)) plot.resize();
  }

  /** Draw all charts of a track. */
  draw(track, colours) {
    const { plots } = this;
    const { t } = track;
    const times = [0, track.span];
    const byTime = (plot, columns, lines, least) => {
      plot.begin(times, rangeOf(columns, least), colours);
      columns.forEach((column, i) => plot.line(t, column, lines[i]));
      plot.end();
    };
    byTime(plots.theta, [degrees(track.theta)], [colours.trace], 1e-3);
    byTime(plots.phi, [degrees(track.phi)], [colours.trace], 1e-3);
    byTime(plots.psi, [degrees(track.psi)], [colours.trace], 1e-3);
    const energies = ["kinetic", "potential", "energy"];
    byTime(plots.energy, energies.map((name) => track[name]), [colours.kinetic, colours.potential, colours.ink]);
    this.#drawPotential(track, colours);
  }

  /** Effective potential and phase portrait share the axis of the inclination. */
  #drawPotential(track, colours) {
    const { potential, portrait } = this.plots;
    const { exact, nutation, body } = track;
    const [low, high] = [nutation.thetaMin * DEGREE, nutation.thetaMax * DEGREE];
    const room = Math.max(0.45 * (high - low), LEAST_RANGE);
    const range = [Math.max(0, low - room), Math.min(180, high + room)];
    const step = (range[1] - range[0]) / SAMPLES;
    const theta = Float64Array.from({ length: SAMPLES + 1 }, (_, i) => range[0] + step * i);
    const values = theta.map((angle) => effectivePotential(exact, angle / DEGREE));
    const energy = swingEnergy(exact);
    const least = Math.min(energy, ...values.filter(Number.isFinite));
    const far = Math.max(...values.filter((value) => Number.isFinite(value)));
    let depth = energy - least;
    // A motion at the bottom of the potential: the scale is that of the walls.
    const isFlat = !(depth > 1e-9 * (Math.abs(energy) + body.mgl));
    if (isFlat) depth = Math.max(0.25 * (far - least), 1e-12 + 1e-6 * Math.abs(energy));
    const level = isFlat ? least : energy;

    potential.begin(range, [least - 0.12 * depth, least + 2.6 * depth], colours);
    potential.line(theta, values, colours.ink);
    potential.line([low, high], [level, level], colours.trace, 2.4);
    potential.line(range, [level, level], colours.trace, 1, [4, 4]);
    potential.end();

    const inertia = body.inertia1;
    const fastest = DEGREE * Math.sqrt((2 * depth) / inertia);
    const top = 1.35 * fastest;
    portrait.begin(range, [-top, top], colours);
    for (const part of LEVELS) this.#orbit(theta, values, least + part * depth, inertia, colours.quiet, 1);
    const { thetaRate } = track;
    portrait.line(degrees(track.theta), degrees(thetaRate), colours.trace, 2.4);
    portrait.end();
    this.level = level;
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
    plots.potential.place(theta, this.level);
    plots.portrait.place(theta, moment.rate[1] * DEGREE);
  }
}
