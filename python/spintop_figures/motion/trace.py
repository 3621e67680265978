"""The path of the axis tip on the unit sphere, or on the cap of it that the axis keeps to."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spintop_figures.kinds import figure
from spintop_figures.motion.extremes import inclination_extremes, sparseness
from spintop_figures.motion.sphere import (
    CIRCLE,
    View,
    draw_path_on,
    draw_seen,
    on_sphere,
    path_handles,
)
from spintop_figures.style.look import GREY, by_width, drawn_width
from spintop_figures.style.numbers import write
from spintop_figures.style.page import new_figure, no_axis
from spintop_figures.tables.table import Table

LEAST_NUTATION = np.radians(0.5)
"""A smaller range of the inclination is about the width of the line of the path."""

BESIDE = {"loc": "lower left", "bbox_to_anchor": (-0.05, 0.1)}
UNDER = {"loc": "lower left", "bbox_to_anchor": (-0.05, -0.1), "ncols": 2}
"""Where the legend of a single sphere is, beside it and below it."""

BELOW = 3.0
"""Inches below a sphere on a narrow figure."""

MOST_ACROSS = 3
"""Spheres in a row."""

ALONE = 4.6
"""Side of a single sphere in inches; the words are beside it."""

SHAPE, TITLE, LEGEND = 1.1, 0.65, 0.25
"""Height of a sphere with its vertical over its width, and of the words above it and of the legend
in inches."""

LETTERS = 13
"""Letters of a title per inch."""

MANY_DEGREES = 1000
"""An azimuth of more is told in turns."""

EDGE = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
"""The circles of the extreme inclinations."""


def path_of(table: Table) -> np.ndarray:
    """Inclination and azimuth, where there are both."""
    path = np.array([table.column(name) for name in ("theta", "phi")])
    return path[:, np.isfinite(path).all(axis=0)]


def object_to_trace(table: Table) -> str:
    """A path has at least one point."""
    return "" if path_of(table).size else "has no row with both angles"


def draw_tip(axes: Axes, table: Table) -> tuple[View, bool, bool]:
    """The path of a motion, between the circles of its minimum and its maximum inclination.

    Gives the view, whether the rows are joined, and whether the circles are drawn: they are where
    they differ from each other and from the path.
    """
    tip = on_sphere(*path_of(table))
    joined = not sparseness(*tip)
    view = draw_path_on(axes, tip, joined)
    low, high = inclination_extremes(table)
    nutates = high.value - low.value > min(LEAST_NUTATION, 0.04 * view.window)
    for extreme in (low, high) if nutates else ():
        circle = on_sphere(np.full_like(CIRCLE, extreme.value), CIRCLE)
        draw_seen(axes, circle, EDGE, EDGE | {"alpha": 0.35}, view)
    return view, joined, nutates


def tell_path(table: Table) -> list[str]:
    """The extremes of the inclination and the azimuth passed, in lines of words."""
    theta, phi = path_of(table)
    low, high = inclination_extremes(table)
    ends = [f"{write(np.degrees(end.value))}°" for end in (low, high)]
    words = rf"$\theta$ = {ends[0]}" if ends[0] == ends[1] else rf"$\theta$ {ends[0]} to {ends[1]}"
    if (low.of_rows or high.of_rows) and ends[0] != ends[1]:
        words += " in the rows"
    lines = [words, rf"$\phi$ {tell_turn(np.degrees(phi[-1] - phi[0]))}"]
    return [*lines, *filter(None, [sparseness(*on_sphere(theta, phi))])]


def tell_turn(degrees: float) -> str:
    """How far an azimuth turns, in degrees or in turns."""
    many = abs(degrees) > MANY_DEGREES
    sign = "+" if degrees > 0 else ""
    return f"{sign}{write(degrees / 360)} turns" if many else f"{sign}{write(degrees)}°"


def spheres(figure: Figure, count: int, side: float) -> tuple[list[Axes], Axes]:
    """Panels of spheres of this side, and room for words beside a single one or below them."""
    if count > 1:
        across = min(count, by_width(MOST_ACROSS, 2))
        down = -(-count // across)
        grid = figure.add_gridspec(down + 1, across, height_ratios=[*[side] * down, LEGEND])
        places = [*(grid[place] for place in np.ndindex(down, across)), grid[down, :]]
    elif by_width(True, False):
        places = figure.add_gridspec(1, 2, width_ratios=[ALONE, drawn_width() - ALONE])
    else:
        places = figure.add_gridspec(2, 1, height_ratios=[side, BELOW - 1])
    *panels, key = (no_axis(figure.add_subplot(place)) for place in places)
    return panels, key


@figure(
    "traces",
    "paths of the axis tip on the unit sphere, side by side",
    kind="trajectory",
    needs="theta phi",
    objection=object_to_trace,
    together=True,
)
def draw_traces(tables: Sequence[Table]) -> Figure:
    """The paths of several motions side by side, each under its title."""
    alone, width = len(tables) == 1, drawn_width()
    across = min(len(tables), by_width(MOST_ACROSS, 2))
    down = -(-len(tables) // across)
    side = min(ALONE, width) if alone else width / across
    height = 0.8 + side * down if alone else 0.8 + (SHAPE * side + TITLE) * down
    if alone:
        height = by_width(height, side + BELOW)
    figure = new_figure(tables, "Path of the axis tip on the unit sphere", height)
    panels, key = spheres(figure, len(tables), side)
    drawn = [draw_tip(axes, table) for axes, table in zip(panels, tables, strict=False)]
    handles = path_handles([view for view, _, _ in drawn], [joined for _, joined, _ in drawn])
    if any(nutates for _, _, nutates in drawn):
        handles.append(Line2D([], [], **EDGE, label="minimum and maximum inclination"))
    if alone:
        words = "\n".join(textwrap.fill(line, 44) for line in tell_path(tables[0]))
        key.text(0, by_width(0.8, 1.0), words, va="top", linespacing=1.5)
        for handle in handles:
            handle.set_label(textwrap.fill(handle.get_label(), 20))
        key.legend(handles=handles, **by_width(BESIDE, UNDER))
        return figure
    for axes, table in zip(panels, tables, strict=False):
        title = textwrap.fill(table.title, int(side * LETTERS)).replace("$", r"\$")
        words = "\n".join([title, *tell_path(table)])
        axes.set_title(words, loc="center", fontsize="small", pad=2)
    place = {"loc": "center", "columnspacing": 1.2, "handletextpad": 0.4}
    key.legend(handles=handles, **place, ncols=by_width(5, 2))
    return figure


@figure(
    "trace",
    "path of the axis tip on the unit sphere",
    kind="trajectory",
    needs="theta phi",
    objection=object_to_trace,
)
def draw_trace(table: Table) -> Figure:
    """The path of a single motion."""
    return draw_traces([table])
