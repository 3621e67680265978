"""The energy budget of a motion under effects: what the body has, and where the rest has gone."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.motion.trajectory import draw_column
from spintop_figures.style.axes import name_axis
from spintop_figures.style.lines import draw_line, draw_sizes
from spintop_figures.style.look import FAINT, FAULT, GREY, HIDDEN, LINES, OURS, by_width
from spintop_figures.style.page import TIME, new_figure
from spintop_figures.tables.names import axis_of, name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import columns_of

AREAS = (f"{OURS}area1", LINES[2]["color"], LINES[3]["color"], FAULT, f"{OURS}area5")
"""Of the works, from the largest."""


def object_to_account(table: Table) -> str:
    """A balance without an error cannot be drawn on a log axis."""
    return "" if table.rows["energy_error"].any() else "has no energy error that is not zero"


@figure(
    "account",
    "inclination, spin, and account of energy under effects, against time",
    kind="trajectory",
    needs="t theta omega3 energy energy_error work",
    objection=object_to_account,
)
def draw_account(table: Table) -> Figure:
    """Inclination, spin, the budget of the energy, and the error of its balance."""
    figure = new_figure(table, "Inclination, spin and energy budget", 7.4)
    ratios = {"height_ratios": (1, 1, 1.4, 1)}
    theta, spin, energy, error = figure.subplots(4, 1, sharex=True, gridspec_kw=ratios)
    t, works = table.column("t"), works_of(table)
    draw_column(theta, table, "theta", axis_of("theta", between="\n"))
    draw_column(spin, table, "omega3", axis_of("omega3", between="\n"))
    (draw_budget if is_spent(works) else draw_works)(energy, table, t, works)
    draw_sizes(error, t[1:], table.column("energy_error")[1:])  # it is zero at the start
    name_axis(error.yaxis, "error of the\nbalance (relative)")
    name_axis(error.xaxis, *TIME)
    error.margins(x=0.01)
    figure.align_ylabels()
    return figure


def works_of(table: Table) -> dict[str, np.ndarray]:
    """The works that are not zero throughout, by what does them, the largest first."""
    names = [name for name in columns_of("trajectory") if name.startswith("work_")]
    acting = [name for name in names if name in table.rows and table.rows[name].any()]
    acting.sort(key=lambda name: -np.abs(table.rows[name]).max())
    works = {name_of(name).removeprefix("work of "): table.column(name) for name in acting}
    return works or {"effects": table.column("work")}


def is_spent(works: dict[str, np.ndarray]) -> bool:
    """Whether all works only take energy, so that what they took are parts of a whole."""
    largest = max(np.nanmax(np.abs(work)) for work in works.values())
    return all(np.nanmax(work) <= 1e-9 * largest for work in works.values())


def draw_budget(axes: Axes, table: Table, t: np.ndarray, works: dict[str, np.ndarray]) -> None:
    """The kinetic energy, on the potential one, and on them what each effect has taken.

    The upper edge is the energy of the start.
    """
    top = energy = table.column("energy")
    ground = table.column("potential") if "potential" in table.rows else np.zeros_like(energy)
    axes.fill_between(t, ground, energy, color=HIDDEN, linewidth=0, label="kinetic energy")
    for number, (name, work) in enumerate(works.items()):
        style = {"color": AREAS[number % len(AREAS)], "linewidth": 0, "label": f"taken by {name}"}
        axes.fill_between(t, top, top - work, **style)
        top = top - work
    draw_line(axes, t, energy, label="energy")
    if "potential" in table.rows:
        draw_line(axes, t, ground, 1, label="potential energy")
    name_axis(axes.yaxis, "energy", "J")
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1.0), "borderpad": 0.1}
    place |= {"handlelength": 1.4, "columnspacing": 0.7, "handletextpad": 0.5}
    axes.legend(**place, ncols=by_width(5, 2))


def draw_works(axes: Axes, table: Table, t: np.ndarray, works: dict[str, np.ndarray]) -> None:
    """The energy and the works as lines, where some give energy."""
    axes.axhline(0, color=FAINT, linewidth=0.8)
    draw_line(axes, t, table.column("energy"), label="energy")
    for line, (name, work) in enumerate(works.items()):
        draw_line(axes, t, work, 1 + line % (len(LINES) - 1), label=f"work of {name}")
    if "potential" in table.rows:
        style = {"color": GREY, "linewidth": 0.8, "zorder": 1, "label": "potential energy"}
        axes.plot(t, table.column("potential"), **style)
    name_axis(axes.yaxis, "energy, work", "J")
    place = {"loc": "upper right", "handlelength": 2.2, "columnspacing": 1.2, "borderpad": 0.1}
    axes.legend(**place, ncols=by_width(2, 1))
