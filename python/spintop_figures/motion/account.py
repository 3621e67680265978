"""The energy budget of a motion under effects: what the body has, and where the rest has gone."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.motion.trajectory import TIME, numbers
from spintop_figures.style.lines import draw_line, draw_sizes, set_degree_ticks
from spintop_figures.style.look import FAINT, HIDDEN, LINES, by_width
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import axis_of, name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import columns_of

COLUMNS = ("t", "theta", "omega3", "energy", "energy_error", "work")
"""What the figure is made of; it also draws the columns of the single works."""

AREAS = ("#e39b35", "#2da4a1", "#8a6fae", "#b0392a", "#7f7f7f")
"""Of the works, from the largest."""


def object_to_account(table: Table) -> str:
    """A balance without an error cannot be drawn on a log axis."""
    return "" if table.rows["energy_error"].any() else "has no energy error that is not zero"


def draw_account(table: Table) -> Figure:
    """Inclination, spin, the budget of the energy, and the error of its balance."""
    figure = new_figure(table, "Inclination, spin and energy budget", 7.4)
    ratios = {"height_ratios": (1, 1, 1.4, 1)}
    panels = figure.subplots(4, 1, sharex=True, gridspec_kw=ratios)
    t = numbers(table, "t")
    degrees = np.degrees(numbers(table, "theta"))
    draw_line(panels[0], t, degrees)
    set_degree_ticks(panels[0].yaxis, degrees)
    panels[0].set_ylabel(axis_of("theta", "deg", "\n"))
    panels[1].axhline(0, color=FAINT, linewidth=0.8)
    draw_line(panels[1], t, numbers(table, "omega3"))
    panels[1].set_ylabel(axis_of("omega3", "rad/s", "\n"))
    works = works_of(table)
    if is_spent(works):
        draw_budget(panels[2], table, t, works)
    else:
        draw_works(panels[2], table, t, works)
    draw_sizes(panels[3], t[1:], numbers(table, "energy_error")[1:])  # it is zero at the start
    panels[3].set_ylabel("error of the\nbalance (relative)")
    panels[3].set_xlabel(TIME)
    for axes in panels:
        axes.margins(x=0.01)
    figure.align_ylabels()
    return figure


def works_of(table: Table) -> dict[str, np.ndarray]:
    """The works that are not zero throughout, by what does them, the largest first."""
    names = [name for name in columns_of("trajectory") if name.startswith("work_")]
    acting = [name for name in names if name in table.rows and table.rows[name].any()]
    if not acting:
        return {"effects": numbers(table, "work")}
    acting.sort(key=lambda name: -np.abs(table.rows[name]).max())
    words = {name: name_of(name) for name in acting}
    return {words[name].removeprefix("work of "): numbers(table, name) for name in acting}


def is_spent(works: dict[str, np.ndarray]) -> bool:
    """Whether all works only take energy, so that what they took are parts of a whole."""
    largest = max(np.nanmax(np.abs(work)) for work in works.values())
    return all(np.nanmax(work) <= 1e-9 * largest for work in works.values())


def draw_budget(axes: Axes, table: Table, t: np.ndarray, works: dict[str, np.ndarray]) -> None:
    """The kinetic energy, on the potential one, and on them what each effect has taken.

    The upper edge is the energy of the start.
    """
    energy = numbers(table, "energy")
    ground = numbers(table, "potential") if "potential" in table.rows else np.zeros_like(energy)
    axes.fill_between(t, ground, energy, color=HIDDEN, linewidth=0, label="kinetic energy")
    top = energy
    for number, (name, work) in enumerate(works.items()):
        colour = AREAS[number % len(AREAS)]
        axes.fill_between(t, top, top - work, color=colour, linewidth=0, label=f"taken by {name}")
        top = top - work
    draw_line(axes, t, energy, label="energy")
    if "potential" in table.rows:
        draw_line(axes, t, ground, 1, label="potential energy")
    axes.set_ylabel("energy (J)")
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1.0), "borderpad": 0.1}
    axes.legend(
        **place, ncols=by_width(5, 2), handlelength=1.4, columnspacing=0.7, handletextpad=0.5
    )


def draw_works(axes: Axes, table: Table, t: np.ndarray, works: dict[str, np.ndarray]) -> None:
    """The energy and the works as lines, where some give energy."""
    axes.axhline(0, color=FAINT, linewidth=0.8)
    draw_line(axes, t, numbers(table, "energy"), label="energy")
    for line, (name, work) in enumerate(works.items()):
        draw_line(axes, t, work, 1 + line % (len(LINES) - 1), label=f"work of {name}")
    if "potential" in table.rows:
        axes.plot(
            t,
            numbers(table, "potential"),
            color="0.35",
            linewidth=0.8,
            zorder=1,
            label="potential energy",
        )
    axes.set_ylabel("energy, work (J)")
    axes.legend(
        loc="upper right", ncols=by_width(2, 1), handlelength=2.2, columnspacing=1.2, borderpad=0.1
    )
