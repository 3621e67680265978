"""The residuals of a fit: what was measured less the fitted motion, against time."""

import numpy as np
from matplotlib.figure import Figure

from spintop_figures.motion.trajectory import TIME, numbers
from spintop_figures.style.look import FAINT, GREY, LINES
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import SYMBOLS, with_unit
from spintop_figures.tables.own_units import converted
from spintop_figures.tables.table import Table

ENDING = "_residual"


def measured_columns(table: Table) -> list[str]:
    """The columns that were measured."""
    return [name.removesuffix(ENDING) for name in table.rows if name.endswith(ENDING)]


def object_to_fit(table: Table) -> str:
    """The rows of a fit have its residuals, the table of the parameters has not."""
    return "" if measured_columns(table) else "has no column of residuals"


def draw_fit(table: Table) -> Figure:
    """A panel for each measured column; a band has the width of two standard deviations."""
    names = measured_columns(table)
    sought = ", ".join(table.settings.get("fit.unknown", []))
    figure = new_figure(table, f"Residuals of a fit of {sought}", 1.2 + 1.5 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    t = numbers(table, "t")
    for axes, name in zip(panels, names, strict=True):
        found = converted(name)
        label, unit = SYMBOLS.get(found.column if found else name, name), table.units.get(name, "")
        residuals = numbers(table, name + ENDING)
        if unit == "rad":
            residuals, unit = np.degrees(residuals), "deg"
        deviation = float(np.sqrt(np.nanmean(residuals**2)))
        axes.axhspan(-2 * deviation, 2 * deviation, color=FAINT, alpha=0.35, linewidth=0)
        axes.axhline(0, color=GREY, linewidth=0.8)
        axes.plot(t, residuals, "o", color=LINES[0]["color"], markersize=3)
        axes.margins(x=0.01)
        axes.ticklabel_format(axis="y", scilimits=(-2, 3), useOffset=False)
        axes.set_ylabel(with_unit(label, unit), parse_math=False)
        words = f"root mean square {deviation:.2g}; band: twice that"
        axes.set_title(words, loc="right", fontsize=8.5, color=GREY)
    panels[-1].set_xlabel(TIME)
    figure.align_ylabels()
    return figure
