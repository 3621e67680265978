// The charts of a live top: angles and energies against time, with a common cursor.

import { Plot } from "../plot.js";

const ENERGIES = { kinetic: "kinetic", potential: "potential", energy: "ink" };

export class Charts {
  /** @param panes elements by name: theta, phi, psi, energy @param onPick called with the time at which one points */
  constructor(panes, onPick) {
    this.plots = Object.fromEntries(Object.entries(panes).map(([name, pane]) => [name, new Plot(pane, onPick)]));
  }

  /** Draw all charts of a track, and the angles of another beside it. */
  draw(track, other = null) {
    const span = [0, track.wanted];
    for (const name of ["theta", "phi", "psi"]) {
      const line = (of, colour) => ({ t: of.t, values: of[name].map((angle) => (angle * 180) / Math.PI), colour });
      const beside = other ? [line(other, "quiet")] : [];
      this.plots[name].draw(span, [...beside, line(track, "trace")], { least: 1e-3 });
    }
    const lines = Object.entries(ENERGIES).map(([name, colour]) => ({ t: track.t, values: track[name], colour }));
    this.plots.energy.draw(span, lines);
  }

  redraw() {
    for (const plot of Object.values(this.plots)) plot.redraw();
  }

  /** Move the marks to a moment. */
  show({ t }) {
    for (const plot of Object.values(this.plots)) plot.place(t);
  }
}
