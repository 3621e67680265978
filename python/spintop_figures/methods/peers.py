"""spintop beside others: programs on the same problem, and published benchmarks."""

import math
import textwrap

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.methods.known import style_of
from spintop_figures.methods.precision import FLOOR
from spintop_figures.style.axes import few_ticks, name_axis, name_rows
from spintop_figures.style.look import FAINT, GREY, GROUND, LINES, by_width
from spintop_figures.style.numbers import in_print, write
from spintop_figures.style.page import legend_below, name_outer, new_figure, panel_figure
from spintop_figures.tables.names import ended_well, name_of
from spintop_figures.tables.table import Table

DOCUMENTED = ("peers_work_precision_slow_top",)
"""Pictures of scripts/compare that doc/figures has, too, by the stems of their files."""
OWN = "spintop"
OWN_METHODS = ("taylor", "splitting_8", "dop853", "ode45")
"""Methods of spintop that are drawn, as in every figure."""
PEER_MARKERS = {
    "heyoka": "h",
    "Boost.odeint": "^",
    "SUNDIALS": "s",
    "SciPy": "o",
    "MuJoCo": "D",
    "Drake": "P",
    "Exudyn": "v",
}
PEER = {"color": GREY, "linewidth": 0.9, "markersize": 4.5, "markerfacecolor": GROUND, "zorder": 2}
LEAST_ERROR, LARGEST_ERROR = 1e-17, 3.2
"""Errors are drawn between these, rad: the one stands for zero too, no turn is beyond pi."""


@figure(
    "work_precision",
    "orientation_error time_s inherent_error",
    words="problem program method status",
    unless={"has no row that went to its end": lambda table: ended_well(table.rows).any()},
    sparse=True,
)
def draw_peers(table: Table) -> Figure:
    """Error against time of spintop and of other programs (scripts/compare).

    The cheapest way to each error: a line a method of spintop, a grey one each other program.
    """
    problems = list(table.rows["problem"].unique())
    alone = len(problems) == 1
    title = "Error against time" + (f": {name_of(problems[0])}" if alone else "")
    figure, panels = panel_figure(
        table, title, len(problems), 4.2 if alone else 2.9, 0, 2.1, has_foot=True
    )
    for name, axes in zip(problems, panels, strict=True):
        rows = table.rows[(table.rows["problem"] == name) & ended_well(table.rows)]
        draw_problem(axes, rows, min(len(problems), 2))
        axes.set_title("" if alone else name_of(name))
    name_outer(panels, ("time", "s"), ("error of the attitude at the end", "rad"))
    handles = [handle for axes in panels for handle in axes.get_legend_handles_labels()[0]]
    known = {handle.get_label(): handle for handle in reversed(handles)}
    legend_below(panels, [*known.values()][::-1], by_width(4, 2))
    return figure


def draw_problem(axes: Axes, rows: pd.DataFrame, across: int) -> None:
    """One problem, in a row of so many panels, in the order of the legend."""
    axes.set(xscale="log", yscale="log", ylim=(LEAST_ERROR, 10))
    own = rows[rows["program"] == OWN]
    for method in (*OWN_METHODS, "exact"):
        look = {"linestyle": "-", "linewidth": 1.6}
        look = {"linestyle": "", "markersize": 9} if method == "exact" else look
        style = style_of(method) | look | {"label": f"{OWN}, {name_of(method)}", "zorder": 3}
        draw_front(axes, own[own["method"] == method], style)
    for program, marker in PEER_MARKERS.items():
        style = PEER | {"marker": marker, "label": program}
        draw_front(axes, rows[rows["program"] == program], style)
    if math.isfinite(floor := rows["inherent_error"].max()):
        style = {"color": FAINT, "linewidth": 0, "label": FLOOR}
        axes.axhspan(LEAST_ERROR / 10, floor, **style)
    few_ticks(axes.xaxis, 9 // across)
    few_ticks(axes.yaxis, 9)
    axes.grid(alpha=0.4)


def draw_front(axes: Axes, rows: pd.DataFrame, style: dict) -> None:
    """The rows than which no other of these is both cheaper and more exact."""
    rows = rows.sort_values(["time_s", "orientation_error"])
    errors, times = (rows[key].to_numpy(float) for key in ("orientation_error", "time_s"))
    best = np.minimum.accumulate(errors) if errors.size else errors
    chosen = np.append(True, best[1:] < best[:-1])[: errors.size] & (errors <= LARGEST_ERROR)
    if chosen.any():
        shown = np.maximum(errors[chosen], LEAST_ERROR * 2)
        axes.plot(times[chosen], shown, **style)


@figure(
    "benchmark",
    "published_error error truth_error time_s",
    words="benchmark quantity published_method",
    unless={
        "has no published number to compare with": lambda table: (
            table.rows["published_error"].notna().any()
        )
    },
    sparse=True,
)
def draw_benchmarks(table: Table) -> Figure:
    """Errors of published numbers and of spintop.

    The errors of all quantities of a publication on a line: published, spintop's, the truth's.

    Spintop's are those of its cheapest run that has at most a hundredth of the published error.
    """
    rows = table.rows[table.rows["published_error"].notna()]
    groups = list(rows.groupby(["benchmark", "published_method"], sort=False))
    figure = new_figure(table, "Published benchmarks", 1.5 + by_width(0.44, 0.62) * len(groups))
    axes = figure.add_subplot()
    looks = (
        ("published_error", "published", {"marker": "D", "color": LINES[1]["color"]}),
        ("error", "spintop, in this time", {"marker": "o", "color": LINES[0]["color"]}),
        ("truth_error", "reference", {"marker": "|", "color": GREY}),
    )
    beside = {"xycoords": axes.get_yaxis_transform(), "va": "center", "fontsize": "small"}
    for place, (_, part) in enumerate(groups):
        for column, label, look in looks:
            errors = np.maximum(part[column].dropna().to_numpy(float), LEAST_ERROR)
            style = look | {"linestyle": "", "markersize": 5, "alpha": 0.8}
            axes.plot(errors, np.full(errors.shape, place), **style, label="" if place else label)
        longest = part["time_s"].max() * 1e6
        time = f"{write(longest, 2)} µs" if np.isfinite(longest) else ""  # else not computed
        axes.annotate(time, (1.01, place), **beside, color=GREY)
    axes.set_xscale("log")
    few_ticks(axes.xaxis, by_width(9, 4))
    name_rows(axes, [describe(*map(str, key)) for key, _ in groups])
    name_axis(axes.xaxis, by_width("error of a quantity, in its unit", "error, in its unit"))
    if by_width(True, False):
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper right", ncols=3)
    else:
        axes.legend(loc="upper right", bbox_to_anchor=(1.2, -0.1), borderpad=0)
    return figure


def describe(benchmark: str, method: str) -> str:
    """A benchmark and what was published, in three short lines at most."""
    lines = textwrap.wrap(in_print(method), by_width(44, 22), max_lines=2, placeholder=" …")
    return "\n".join([benchmark.replace("_", " "), *lines])
