"""Which method is the cheapest that reaches an error, and at what cost: maps of a swept study."""

import dataclasses

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from spintop_figures.methods.curves import EXACT, curves_of, problems_of, time_to
from spintop_figures.methods.known import family_of
from spintop_figures.methods.styles import look_of
from spintop_figures.style.page import head, new_figure
from spintop_figures.sweeps.maps import Grid, cross, label_axes, make_grid, object_to_grid
from spintop_figures.sweeps.quantities import tell_failed
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.table import Table

NONE = "none"
"""In place of a method where none reaches the error."""

GOAL = "10\u207b\u2079 rad"
"""The error that the methods have to reach, as it is written."""

PANELS = (
    ("method", "time_s", "the cheapest method, and its time in {unit}"),
    ("next", "ratio", "the next method, and how many times longer it takes"),
)
"""The column with the method of each map, that with the number in its cells, and its heading."""

UNITS = (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9))
"""Of times."""

PALE = 0.62
"""How much of the way to white the colours of cells are from those of their families."""

PANEL_HEIGHT = 2.9
"""In inches."""

ROOM = 5.2, 2.2
"""About how wide and how high a map is, in inches."""

LETTER, LINE = 0.075, 0.15
"""Width of a letter and height of a line in a cell, in inches."""


def cheapest(rows: pd.DataFrame) -> list[tuple[float, str]]:
    """The times in which methods that take steps reach the target, the least first; two at most."""
    curves = [c for c in curves_of(rows, ("time_s", "error_max")) if c.method != EXACT]
    times = [(time_to(curve), curve.label) for curve in curves]
    return sorted((time, label) for time, label in times if np.isfinite(time))[:2]


def swept_parameters(table: Table) -> list[str]:
    """The parameters that the study sweeps: columns whose names have a point."""
    return [name for name in table.rows if "." in name]


def table_of_problems(table: Table) -> Table:
    """The study as the table of a sweep: per problem the cheapest method and its time."""
    axes = swept_parameters(table)
    rows = []
    for number, problem in enumerate(problems_of(table), start=1):
        part = table.rows[table.rows["problem"] == problem]
        found = [*cheapest(part), (np.nan, NONE), (np.nan, NONE)]
        (time, method), (later, other) = found[:2]
        status = "ok" if np.isfinite(time) else "not reached"
        rows.append([number, *part[axes].iloc[0], status, time, method, later / time, other])
    columns = ["case", *axes, "status", "time_s", "method", "ratio", "next"]
    return dataclasses.replace(table, rows=pd.DataFrame(rows, columns=columns))


def object_to_tolerance_map(table: Table) -> str:
    """The maps are over two swept parameters, all of whose values are combined."""
    if len(swept_parameters(table)) != 2:
        return "is no study over two parameters"
    problems = table_of_problems(table)
    if objection := object_to_grid(problems):
        return objection
    if not ended_well(problems.rows).any():
        return f"has no method that reaches an error of {GOAL}"
    return ""


def draw_tolerance_map(table: Table) -> Figure:
    """The cheapest method and the next one for the target as colours, and numbers in the cells."""
    problems = table_of_problems(table)
    grid = make_grid(problems)
    failed = ~ended_well(problems.rows).to_numpy()
    title = f"The cheapest method for an error of {GOAL} in attitude"
    figure = new_figure(table, title + tell_failed(problems), 0.9 + 2 * PANEL_HEIGHT)
    first = figure.add_subplot(2, 1, 1)
    panels = [first, figure.add_subplot(2, 1, 2, sharex=first, sharey=first)]
    colours = colours_of_methods(problems.rows)
    for (method, number, heading), axes in zip(PANELS, panels, strict=True):
        values = problems.rows[number].to_numpy(float)
        unit, factor = unit_of(values) if number == "time_s" else ("", 1.0)
        head(axes, heading.format(unit=unit))
        draw_methods(axes, grid, problems.rows[method], colours)
        cross(axes, grid, failed)
        write_numbers(axes, grid, factor * values)
    label_axes(problems, grid, panels)
    return figure


def unit_of(seconds: np.ndarray) -> tuple[str, float]:
    """The unit that suits times, and the factor to it: that in which the median is above one."""
    median = np.nanmedian(seconds)
    return next((pair for pair in UNITS if median * pair[1] >= 1), UNITS[-1])


def colours_of_methods(rows: pd.DataFrame) -> dict[str, tuple[float, ...]]:
    """A pale colour for each method: that of its family, paler for further members."""
    counts = pd.concat([rows["method"], rows["next"]]).value_counts()
    members: dict[str, int] = {}
    colours = {}
    for label in counts.index:
        if label == NONE:
            continue
        family = family_of(label.partition(", ")[0])
        pale = 1 - (1 - PALE) * 0.55 ** members.get(family, 0)
        members[family] = members.get(family, 0) + 1
        colours[label] = tuple(c + pale * (1 - c) for c in to_rgb(look_of(family).colour))
    return colours


def draw_methods(
    axes: Axes, grid: Grid, names: pd.Series, colours: dict[str, tuple[float, ...]]
) -> None:
    """A map of methods, each with its colour and once in the legend."""
    there = [name for name in colours if (names == name).any()]
    codes = {name: float(code) for code, name in enumerate(there)}
    cells = np.ma.masked_invalid(grid.fill(names.map(codes).to_numpy(float)))
    norm = BoundaryNorm(np.arange(len(there) + 1) - 0.5, len(there))
    shades = ListedColormap([colours[name] for name in there])
    look = {"cmap": shades, "norm": norm, "edgecolor": "white", "linewidth": 0.5}
    axes.pcolormesh(*grid.edges(), cells, **look)
    handles = [Patch(color=colours[name], label=name.replace(", ", ",\n")) for name in there]
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02), "handlelength": 1.2}
    axes.legend(handles=handles, **place)


def write_numbers(axes: Axes, grid: Grid, values: np.ndarray) -> None:
    """The number of each cell in it, if the cells are large enough."""
    texts = [tell(value) for value in values]
    width, height = ROOM[0] / grid.x.size, ROOM[1] / grid.y.size
    if LETTER * max(map(len, texts)) > width or height < LINE:
        return
    column, line = np.divmod(grid.place, grid.y.size)
    style = {"ha": "center", "va": "center_baseline", "fontsize": 8.5, "in_layout": False}
    for x, y, text in zip(grid.x[column], grid.y[line], texts, strict=True):
        axes.text(x, y, text, **style)


def tell(value: float) -> str:
    """Two digits of a number; empty if there is none."""
    if not np.isfinite(value):
        return ""
    return f"{value:.0f}" if value >= 10 else f"{value:.1f}"
