"""Which method is the cheapest that reaches an error, and at what cost: maps of a swept study."""

import dataclasses
import re

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.methods.curves import EXACT, curves_of, problems_of, time_to
from spintop_figures.style.page import new_figure
from spintop_figures.sweeps.fields import spots
from spintop_figures.sweeps.maps import (
    Grid,
    cross,
    draw_map,
    label_axes,
    lightness,
    make_grid,
    object_to_grid,
)
from spintop_figures.sweeps.quantities import Quantity, tell_failed, the_column
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.table import Table

GOAL = "10\u207b\u2079 rad"
"""The error that the methods have to reach, as it is written."""

MICROSECOND = 1e-6
"""In seconds."""

QUANTITIES = (
    Quantity(
        ("time_s",),
        f"the cheapest method and its time for {GOAL}",
        "µs",
        lambda rows: rows["time_s"] / MICROSECOND,
        3,
    ),
    Quantity(
        ("ratio",),
        "the next method and its time over that of the cheapest",
        "",
        the_column("ratio"),
        10,
    ),
)
"""What the colours of the two maps show."""

NAMES = ("method", "next")
"""The column with the method of each."""

PANEL_HEIGHT = 2.9
"""In inches."""

ROOM = 5.4, 2.3
"""About how wide and how high a map is, in inches."""

LETTER, LINE = 0.06, 0.125
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
        found = [*cheapest(part), (np.nan, "none"), (np.nan, "none")]
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
    """The cheapest method and the next one for the target, with their times, in each cell."""
    problems = table_of_problems(table)
    grid = make_grid(problems)
    failed = ~ended_well(problems.rows).to_numpy()
    title = f"The cheapest method for an error of {GOAL} in attitude"
    figure = new_figure(table, title + tell_failed(problems), 0.9 + 2 * PANEL_HEIGHT)
    first = figure.add_subplot(2, 1, 1)
    panels = [first, figure.add_subplot(2, 1, 2, sharex=first, sharey=first)]
    for quantity, name, axes in zip(QUANTITIES, NAMES, panels, strict=True):
        values = quantity.values(problems.rows)
        draw_map(axes, grid, quantity, values, failed)
        cross(axes, grid, failed)
        if name == "method":
            numbers = [tell_time(value) for value in problems.rows["time_s"]]
        else:
            numbers = [tell_ratio(value) for value in values]
        name_cells(axes, grid, problems.rows[name], numbers)
    label_axes(problems, grid, panels)
    return figure


def tell_time(seconds: float) -> str:
    """A time in the unit that suits it; empty if there is none."""
    if not np.isfinite(seconds):
        return ""
    factor, unit = next(
        (pair for pair in ((1.0, "s"), (1e3, "ms"), (1e6, "µs")) if seconds * pair[0] >= 1),
        (1e9, "ns"),
    )
    return f"{seconds * factor:.3g} {unit}"


def tell_ratio(ratio: float) -> str:
    """How many times longer; empty if there is no other method."""
    return f"\N{MULTIPLICATION SIGN} {ratio:.2g}" if np.isfinite(ratio) else ""


def name_cells(axes: Axes, grid: Grid, names: pd.Series, numbers: list[str]) -> None:
    """The name and the number of each cell in it; where cells are small, the names of regions."""
    image = axes.collections[-1]
    colours = image.cmap(image.norm(image.get_array())).reshape(-1, 4)
    width, height = ROOM[0] / grid.x.size, ROOM[1] / grid.y.size
    letters = int(width / LETTER)
    style = {"ha": "center", "va": "center", "fontsize": 7.5, "linespacing": 1.0}
    style |= {"in_layout": False}
    texts = [
        [*break_method(name, letters), number] for name, number in zip(names, numbers, strict=True)
    ]
    if letters < 4 or max(map(len, texts)) * LINE > height:
        codes = {name: code for code, name in enumerate(dict.fromkeys(names))}
        by_code = list(codes)
        for spot in spots(grid.fill(names.map(codes).to_numpy(float))):
            outline = [withStroke(linewidth=2, foreground="white")]
            place = {"transform": axes.transAxes, "path_effects": outline}
            axes.text(spot.x, spot.y, by_code[spot.code], **style, **place)
        return
    column, line = np.divmod(grid.place, grid.y.size)
    for i, text in enumerate(texts):
        if not numbers[i]:
            continue
        ink = "black" if lightness(colours[line[i] * grid.x.size + column[i]]) > 0.45 else "white"
        axes.text(grid.x[column[i]], grid.y[line[i]], "\n".join(text), color=ink, **style)


def break_method(name: str, letters: int) -> list[str]:
    """A name in lines of so many letters, broken behind underscores and commas."""
    lines = [""]
    for part in re.findall(r"[^_, ]+[_,]?", name):
        if lines[-1] and len(lines[-1]) + len(part) > letters:
            lines.append(part)
        else:
            lines[-1] += part
    return lines
