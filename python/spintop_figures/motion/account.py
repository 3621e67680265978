"""The account of energy of a motion under effects."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.motion.trajectory import TIME, numbers
from spintop_figures.style.lines import draw_line, draw_sizes, set_degree_ticks
from spintop_figures.style.look import FAINT, GREY
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import SYMBOLS, axis_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import columns_of

COLUMNS = ("t", "theta", "omega3", "energy", "energy_error", "work")
"""What the figure is made of; it also draws the columns of the single works."""


def object_to_account(table: Table) -> str:
    """A balance without an error cannot be drawn on a log axis."""
    return "" if table.rows["energy_error"].any() else "has no energy error that is not zero"


def draw_account(table: Table) -> Figure:
    """Inclination, spin, energy with the works of the effects, and the error of the balance."""
    figure = new_figure(table, "Inclination, spin, and account of energy", 7.4)
    ratios = {"height_ratios": (1, 1, 1.3, 1)}
    panels = figure.subplots(4, 1, sharex=True, gridspec_kw=ratios)
    t = numbers(table, "t")
    degrees = np.degrees(numbers(table, "theta"))
    draw_line(panels[0], t, degrees)
    set_degree_ticks(panels[0].yaxis, degrees)
    panels[0].set_ylabel(axis_of("theta", "deg", "\n"))
    panels[1].axhline(0, color=FAINT, linewidth=0.8)
    draw_line(panels[1], t, numbers(table, "omega3"))
    panels[1].set_ylabel(axis_of("omega3", "rad/s", "\n"))
    draw_works(panels[2], table, t)
    draw_sizes(panels[3], t[1:], numbers(table, "energy_error")[1:])  # it is zero at the start
    panels[3].set_ylabel("error of the\nbalance (relative)")
    panels[3].set_xlabel(TIME)
    for axes in panels:
        axes.margins(x=0.01)
    figure.align_ylabels()
    return figure


def draw_works(axes: Axes, table: Table, t: np.ndarray) -> None:
    """The energy, and the works that are not zero throughout."""
    axes.axhline(0, color=FAINT, linewidth=0.8)
    draw_line(axes, t, numbers(table, "energy"), label="energy")
    names = [name for name in columns_of("trajectory") if name.startswith("work_")]
    acting = [name for name in names if name in table.rows and table.rows[name].any()]
    shown = {name: SYMBOLS.get(name, name.replace("_", " of ")) for name in acting}
    for line, (name, label) in enumerate((shown or {"work": "work"}).items()):
        draw_line(axes, t, numbers(table, name), 1 + line % 3, label=label)
    if "potential" in table.rows:
        style = {"color": GREY, "linewidth": 0.8, "zorder": 1}
        axes.plot(t, numbers(table, "potential"), **style, label="potential energy")
    axes.set_ylabel("energy, work (J)")
    axes.legend(loc="upper right", ncols=2, handlelength=2.2, columnspacing=1.2, borderpad=0.1)
