"""The residuals of a run and its true error against time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.motion.trajectory import TIME, four_panels, numbers
from spintop_figures.style.lines import draw_line, draw_sizes, has_wide_range
from spintop_figures.style.look import FAINT, GREY, LINES
from spintop_figures.style.numbers import write
from spintop_figures.style.page import head, new_figure
from spintop_figures.style.provenance import describe_run, model_of
from spintop_figures.tables.names import with_unit
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import columns_of

NAMES = ("R1", "R2", "R3", "R4")

TOGETHER = ("R1", "R2")
"""Residuals of one kind, which have one scale."""


def object_to_residuals(table: Table) -> str:
    """Residuals measure the equations of a method, not a closed-form solution."""
    if model_of(table)[1] == "exact":
        return "is of the exact solution, which has no residuals"
    return ""


def draw_residuals(table: Table) -> Figure:
    """R1, R2, R3 and R4 against time (Figures 2 to 7 of the paper)."""
    figure, panels = four_panels(table, f"Residuals: {describe_run(table)}")
    by_name = dict(zip(NAMES, panels, strict=True))
    t = numbers(table, "t")
    pair = [numbers(table, name) for name in TOGETHER]
    for name, axes in by_name.items():
        y = numbers(table, name)
        is_log = any(map(has_wide_range, pair)) if name in TOGETHER else has_wide_range(y)
        draw_residual(axes, t, y, is_log)
        label = f"$|R_{name[1]}|$" if is_log and np.any(y) else f"$R_{name[1]}$"
        axes.set_ylabel(with_unit(label, table.units.get(name, "")))
        known = columns_of("trajectory")[name]["description"]
        meaning = table.meanings.get(name, known).partition(" (")[0]
        head(axes, f"{name}: {meaning}", pad=18)
        scale = "scale of R1 and R2" if name in TOGETHER else f"scale of {name} alone"
        style = {"ha": "right", "fontsize": 8.5, "color": GREY}
        words = f"{scale}; {tell_largest(y)}"
        axes.annotate(words, (1, 1), (0, 4), "axes fraction", textcoords="offset points", **style)
    shared = [by_name[name] for name in TOGETHER if np.any(numbers(table, name))]
    limits = [axes.get_ylim() for axes in shared]
    for axes in shared:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    figure.align_ylabels()
    return figure


def draw_residual(axes: Axes, t: np.ndarray, y: np.ndarray, is_log: bool) -> None:
    """A residual on its axis; one that is zero throughout says so."""
    if not np.any(y):
        draw_line(axes, t, y)
        axes.set_yticks([0])
        axes.text(0.5, 0.6, "zero throughout", transform=axes.transAxes, ha="center")
    elif is_log:
        draw_sizes(axes, t, y)
    else:
        axes.axhline(0, color=FAINT, linewidth=0.8)
        draw_line(axes, t, y)


def tell_largest(y: np.ndarray) -> str:
    """The largest magnitude, in words."""
    largest = np.nanmax(np.where(np.isfinite(y), np.abs(y), np.nan))
    return f"largest {write(largest, 2)}" if largest else "zero"


def draw_error(table: Table) -> Figure:
    """Orientation error against time, which the residuals do not show, and R4 below it."""
    has_energy = "R4" in table.rows and bool(table.rows["R4"].any())
    figure = new_figure(
        table, f"Orientation error: {describe_run(table)}", 5.0 if has_energy else 3.6
    )
    panels = figure.subplots(1 + has_energy, 1, sharex=True, squeeze=False)[:, 0]
    t, error = numbers(table, "t"), numbers(table, "orientation_error")
    for axes in panels:
        axes.margins(x=0.01)
    draw_sizes(panels[0], t, error)
    panels[0].set_ylabel("orientation error (rad)")
    degrees = panels[0].secondary_yaxis("right", functions=(np.degrees, np.radians))
    degrees.set_ylabel("(degrees)")
    degrees.yaxis.set_major_locator(LogLocator(numticks=7))
    degrees.yaxis.set_minor_locator(NullLocator())
    mark_largest(panels[0], t, error)
    if has_energy:
        draw_sizes(panels[1], t, numbers(table, "R4"))
        panels[1].set_ylabel(f"change of energy\n$|R_4|$ ({table.units.get('R4', 'J')})")
    panels[-1].set_xlabel(TIME)
    figure.align_ylabels()
    return figure


def mark_largest(axes: Axes, t: np.ndarray, error: np.ndarray) -> None:
    """A dot at the largest orientation error, with its size in radians and in degrees."""
    place = int(np.nanargmax(np.where(np.isfinite(error), error, np.nan)))
    largest = error[place]
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.12)  # room for the words
    axes.plot(t[place], largest, "o", color=LINES[1]["color"], markersize=4.5, zorder=4)
    is_late = t[place] > (t[0] + t[-1]) / 2
    axes.annotate(
        f"largest: {write(largest, 2)} rad = {write(np.degrees(largest), 2)}°",
        (t[place], largest),
        (0, 6),
        textcoords="offset points",
        ha="right" if is_late else "left",
        fontsize=9,
        color=LINES[1]["color"],
    )
