"""The cheapest method for an error: over a swept study, and beside the automatic choice."""

import dataclasses
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from spintop_figures.kinds import figure
from spintop_figures.methods.known import family_of, known_methods, look_of
from spintop_figures.methods.precision import (
    EXACT,
    GOAL,
    PRECISION,
    curves_of,
    problems_of,
    time_to,
)
from spintop_figures.style.axes import letters_of, name_axis, name_rows
from spintop_figures.style.look import FAINT, GREY, GROUND, INK, by_width, tint
from spintop_figures.style.numbers import localised, with_power, write, write_fixed
from spintop_figures.style.page import head, new_figure
from spintop_figures.sweeps.maps import (
    Grid,
    cross,
    draw_shades,
    label_axes,
    make_grid,
    object_to_grid,
)
from spintop_figures.sweeps.quantities import tell_failed
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import ended_well

NONE = "none"
"""In place of a method where none reaches the error."""

PANELS = (
    ("method", "time_s", "the cheapest method, and its time in {unit}"),
    ("next", "ratio", "the next method, and how many times longer it takes"),
)
"""The column with the method of each map, that with the number in its cells, and its heading."""

UNITS = (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9))
"""Of times."""

PANEL_HEIGHT = 2.9
"""In inches."""


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
        (time, method), (later, other) = [*cheapest(part), (np.nan, NONE), (np.nan, NONE)][:2]
        status = "ok" if np.isfinite(time) else "not reached"
        rows.append([number, *part[axes].iloc[0], status, time, method, later / time, other])
    columns = ["case", *axes, "status", "time_s", "method", "ratio", "next"]
    return dataclasses.replace(table, rows=pd.DataFrame(rows, columns=columns))


def object_to_tolerance_map(table: Table) -> str:
    """The maps are over two swept parameters, all of whose values are combined."""
    if len(swept_parameters(table)) != 2:
        return "is no study over two parameters"
    problems = table_of_problems(table)
    reached = ended_well(problems.rows).any()
    reason = "" if reached else f"has no method that reaches an error of {GOAL}"
    return object_to_grid(problems) or reason


@figure(needs="error_max time_s", objection=object_to_tolerance_map, **PRECISION)
def draw_tolerance_map(table: Table) -> Figure:
    """The cheapest method for a given error, over two swept parameters.

    The cheapest method and the next one for the target as colours, and numbers in the cells.
    """
    problems = table_of_problems(table)
    grid = make_grid(problems)
    failed = ~ended_well(problems.rows).to_numpy()
    title = f"The cheapest method for an error of {GOAL} in attitude{tell_failed(problems)}"
    figure = new_figure(table, title, 0.9 + 2 * PANEL_HEIGHT)
    panels = list(figure.subplots(2, 1, sharex=True, sharey=True))
    colours = colours_of_methods(problems.rows)
    for (method, number, heading), axes in zip(PANELS, panels, strict=True):
        values = problems.column(number)
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
    known = {name_of(method): method for method in known_methods()}
    members: dict[str, int] = {}
    colours = {}
    for label in counts.index.drop(NONE, errors="ignore"):
        family = family_of(known.get(label.partition(", ")[0], ""))
        pale = 1 - 0.38 * 0.55 ** members.get(family, 0)
        members[family] = members.get(family, 0) + 1
        colours[label] = tint(look_of(family).colour, pale)
    return colours


def draw_methods(
    axes: Axes, grid: Grid, names: pd.Series, colours: dict[str, tuple[float, ...]]
) -> None:
    """A map of methods, each with its colour and once in the legend."""
    there = [name for name in colours if (names == name).any()]
    codes = {name: float(code) for code, name in enumerate(there)}
    shades = ListedColormap([colours[name] for name in there])
    cells = grid.fill(names.map(codes).to_numpy(float))
    draw_shades(axes, grid, cells, shades, edgecolor=GROUND, linewidth=0.5)
    handles = [Patch(color=colours[name], label=name.replace(", ", ",\n")) for name in there]
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02), "handlelength": 1.2}
    axes.legend(handles=handles, **place)


def write_numbers(axes: Axes, grid: Grid, values: np.ndarray) -> None:
    """The number of each cell in it, if the cells are large enough."""
    texts = [tell(value) for value in values]
    across, up = (0.6 * letters_of(axes, side) for side in "xy")  # a line is as high as two letters
    if grid.x.size * max(map(len, texts)) > across or 2 * grid.y.size > up:
        return
    column, line = np.divmod(grid.place, grid.y.size)
    style = {"ha": "center", "va": "center_baseline", "fontsize": "small", "in_layout": False}
    for x, y, text in zip(grid.x[column], grid.y[line], texts, strict=True):
        axes.text(x, y, text, **style)


def tell(value: float) -> str:
    """Two digits of a number; empty if there is none."""
    return localised(f"{value:.{0 if value >= 10 else 1}f}") if np.isfinite(value) else ""


TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
"""The errors for which methods are compared, rad, as in the summary of the program."""

NEAR = 2.0
"""A choice that takes no more than so many times as long is near the cheapest."""


class Choice(NamedTuple):
    """The choice on a problem for a target: its time over the least, and who has the least."""

    target: float
    ratio: float
    cheapest: str


def object_to_choice(table: Table) -> str:
    """The rows of the choice are marked, and there are enough problems."""
    if not (table.rows["auto"] == "yes").any():
        return "has no row of the automatic choice"
    if len(problems_of(table)) < 5:
        return "has fewer than 5 problems to judge a choice by"
    return "" if choices_of(table) else "has no method that is accurate enough"


def cheapest_row(rows: pd.DataFrame, target: float) -> pd.Series | None:
    """The row with the least time whose error is no larger than the target."""
    good = rows[ended_well(rows) & (rows["orientation_error"] <= target)]
    return None if good.empty else good.loc[good["time_s"].idxmin()]


def choices_of(table: Table) -> list[Choice]:
    """The comparisons; the ratio is infinite where the choice is not accurate enough."""
    found = []
    for _, rows in table.rows.groupby("problem", sort=False):
        chosen = rows[rows["auto"] == "yes"]
        for target in TARGETS if len(chosen) else ():
            best, own = cheapest_row(rows, target), cheapest_row(chosen, target)
            if best is not None and best["time_s"] > 0:
                ratio = np.inf if own is None else own["time_s"] / best["time_s"]
                found.append(Choice(target, float(ratio), str(best["method"])))
    return found


@figure(
    PRECISION["kind"],
    "orientation_error time_s",
    words=f"{PRECISION['words']} auto",
    objection=object_to_choice,
)
def draw_choice(table: Table) -> Figure:
    """Time of the automatic choice of a method over that of the cheapest one.

    How many times longer the choice takes than the cheapest method, a dot a problem.
    """
    choices = choices_of(table)
    ratios = np.array([choice.ratio for choice in choices])
    worst = ratios[np.isfinite(ratios)].max(initial=1.0)
    within = np.count_nonzero(ratios <= NEAR)
    title = "The automatic choice takes "
    if within == len(choices):
        title += f"at most {write_fixed(worst, 2)} times as long as the cheapest method"
    else:
        title += f"no more than {write(NEAR)} times as long as the cheapest method in {within} of "
        title += f"{len(choices)} comparisons"
    targets = [target for target in TARGETS if any(c.target == target for c in choices)]
    figure = new_figure(table, title, 1.4 + 0.75 * len(targets))
    axes = figure.add_subplot()
    axes.axvspan(1, NEAR, color=FAINT, alpha=0.4, linewidth=0)
    axes.axvline(1, color=GREY, linewidth=0.8)
    edge = max(1.15 * worst, 1.15 * NEAR)
    for place, target in enumerate(targets):
        draw_target(axes, place, [c for c in choices if c.target == target], edge)
    alone = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0), "title": "cheapest method"}
    axes.legend(alone.values(), map(name_of, alone), **place)
    axes.set_xscale("log")
    axes.set_xlim(1 / 1.04, edge)
    words = "time of the automatic choice over that of the cheapest method"
    name_axis(axes.xaxis, words, letters=by_width(70, 25))
    ticks = ratios_below(edge)
    axes.set_xticks(ticks, labels=map(write, ticks))
    axes.set_xticks([], minor=True)
    name_rows(axes, [f"{with_power('1', round(np.log10(target)))} rad" for target in targets])
    axes.set_ylabel("error")
    return figure


def ratios_below(edge: float) -> list[float]:
    """Round ratios from 1 to an edge, so far apart on a log axis that their numbers have room."""
    apart = by_width(0.07, 0.13) * np.log(edge)
    found: list[float] = [1]
    for ratio in (1.2, 1.5, 2, 3, 5, 10, 20, 50, 100):
        if ratio < edge and np.log(ratio / found[-1]) >= apart:
            found.append(ratio)
    return found


def draw_target(axes: Axes, place: int, choices: list[Choice], edge: float) -> None:
    """The comparisons for a target; those in which the choice misses it are at the right edge."""
    heights = place + 0.3 * (2 * ((5**0.5 - 1) / 2 * np.arange(len(choices)) % 1) - 1)
    for choice, height in zip(choices, heights, strict=True):
        look = look_of(family_of(choice.cheapest))
        style = {"color": look.colour, "marker": look.marker, "markersize": 6 * look.size}
        style |= {"linestyle": "", "markeredgewidth": 0.5, "label": choice.cheapest}
        style["markeredgecolor"] = GROUND if np.isfinite(choice.ratio) else INK
        axes.plot(min(choice.ratio, edge / 1.03), height, **style)
    near = sum(choice.ratio <= NEAR for choice in choices)
    missed = sum(not np.isfinite(choice.ratio) for choice in choices)
    words = f"{near} of {len(choices)} within {write(NEAR)}" + f", {missed} missed" * (missed > 0)
    style = {"xycoords": axes.get_yaxis_transform(), "fontsize": "small", "color": GREY}
    axes.annotate(words, (0.99, place - 0.3), ha="right", **style)
