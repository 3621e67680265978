"""Work and precision of methods: the curves of a work-precision study, and axes for them."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.methods.best import best_of_families, name_at_the_top
from spintop_figures.methods.curves import EXACT, curves_of, problems_of, time_to
from spintop_figures.methods.known import family_of, order_of
from spintop_figures.methods.styles import look_of, style_of
from spintop_figures.style.look import FAINT, GREY, by_width
from spintop_figures.style.numbers import write, write_count
from spintop_figures.style.page import new_figure
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

WORDS = ("problem", "method", "formulation", "setting", "status")
"""The columns of words of a work-precision study."""

LEAST_ERROR, MOST_ERROR = 1e-16, 4.0
"""Smaller errors are drawn at the first, rad; no turn is larger than the second."""

MOST_PROBLEMS = 6
"""Panels that fit a page."""

PANEL_HEIGHT, NAMES_HEIGHT = 3.4, 0.8
"""Of a panel, and of the names above it, in inches."""

FAN = 0.2, 0.3
"""Width and height of the fan of orders, over those of the panel."""

OTHERS = {"color": "0.78", "linewidth": 0.9, "zorder": 1}
"""Curves that are not the best of their family."""

NOTE = "named: the best of each family at 10\u207b\u2079 rad; grey: the others"

GOAL = "10\u207b\u2079 rad"
"""The error at which methods are compared, as it is written."""

LEAST_LEAD = 1.05
"""A method that is ahead by less, as a ratio, is not said to be."""

ERROR_LABEL = "largest error of the attitude (rad)"


def draw_precision_curves(axes: Axes, rows: pd.DataFrame, x: str, y: str = "error_max") -> None:
    """The curves of a problem on log axes: the error `y` of each method over its cost `x`.

    `rows` have the columns of a work-precision table. The exact motion, which has no settings, is
    a point with its name; errors below what rounding of the data does lie in a grey band.
    """
    axes.set(xscale="log", yscale="log")
    for curve in curves_of(rows, (x, y)):
        cost = curve.rows[x].to_numpy(float)
        error = np.maximum(curve.rows[y].to_numpy(float), LEAST_ERROR)
        if curve.method == EXACT:
            mark_exact(axes, cost, error)
        else:
            axes.plot(cost, error, **curve.style(), label=curve.label)
    draw_floor(axes, rows)
    set_limits(axes, rows, x, y)


def mark_exact(axes: Axes, cost: np.ndarray, error: np.ndarray) -> None:
    """The exact motion as a point with its name, if it has a cost that a log axis can show."""
    there = cost > 0
    axes.plot(cost[there], error[there], **style_of(EXACT) | {"linestyle": "", "markersize": 8})
    for place in zip(cost[there][:1], error[there][:1], strict=True):
        style = {"ha": "left", "va": by_width("top", "bottom"), "fontsize": 9}
        axes.annotate(
            "exact solution", place, (6, by_width(-1, 1)), textcoords="offset points", **style
        )


def draw_floor(axes: Axes, rows: pd.DataFrame) -> None:
    """The band of errors that rounding of the data makes by itself, where it is known."""
    if "inherent_error" in rows and np.isfinite(floor := rows["inherent_error"].max()):
        top = max(floor, LEAST_ERROR)
        axes.axhspan(1e-30, top, color=FAINT, linewidth=0, zorder=0)
        style = {"fontsize": 8.5, "color": GREY, "va": "bottom", "ha": "right", "zorder": 5}
        outline = [withStroke(linewidth=3, foreground=FAINT)]
        place = {"xy": (0.99, 0.015), "xycoords": "axes fraction", "path_effects": outline}
        axes.annotate("inherent error", **place, **style)


def set_limits(axes: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """From the least to the largest, with a little room; a method that is lost is not shown."""
    cost, error = (rows[name].to_numpy(float) for name in (x, y))
    shown = ended_well(rows).to_numpy() & (cost > 0) & np.isfinite(error)
    if not shown.any():
        return
    axes.set_xlim(cost[shown].min() / 2, cost[shown].max() * 2)
    least = max(error[shown].min(), LEAST_ERROR)
    axes.set_ylim(least / 15, min(error[shown].max() * 5, 2 * MOST_ERROR))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=9))
        axis.set_minor_locator(NullLocator())
    axes.grid(color="0.92", linewidth=0.6)
    axes.set_axisbelow(True)


def object_to_precision(table: Table) -> str:
    """A method has to be there that takes steps, and not too many problems for panels."""
    if "program" in table.rows:
        return "compares programs"
    count = len(problems_of(table))
    if count > MOST_PROBLEMS:
        return f"has {count} problems, more than fit ({MOST_PROBLEMS})"
    return "" if stepping(table.rows).any() else "has no method that went well and takes steps"


def stepping(rows: pd.DataFrame) -> pd.Series:
    """Which rows are of methods that take steps, and went well."""
    return ended_well(rows) & (rows["method"] != EXACT)


def problem_panels(
    table: Table, title: str, rows: pd.DataFrame, above: float = 0.0
) -> tuple[Figure, dict[str, Axes]]:
    """A figure with a panel a problem, one below the other, with so many inches above each."""
    problems = list(dict.fromkeys(rows["problem"]))
    figure = new_figure(table, title, 1.0 + (PANEL_HEIGHT + above) * len(problems))
    panels = figure.subplots(len(problems), 1, squeeze=False)[:, 0]
    by_problem = dict(zip(problems, panels, strict=True))
    if len(problems) > 1:
        for problem, axes in by_problem.items():
            axes.set_title(name_of(problem), loc="left", pad=4)
    return figure, by_problem


def draw_precision_over(table: Table, cost: str, title: str, label: str) -> tuple[Figure, list]:
    """Error against a cost, one panel per problem: the best of each family, the others grey."""
    rows = table.rows
    figure, panels = problem_panels(table, title, rows, NAMES_HEIGHT)
    for problem, axes in panels.items():
        draw_best_curves(axes, rows[rows["problem"] == problem], cost)
        axes.set_ylabel(ERROR_LABEL)
    axes.set_xlabel(f"{label}\n{NOTE}")
    return figure, list(panels.values())


def draw_best_curves(axes: Axes, rows: pd.DataFrame, cost: str) -> None:
    """The curves of a problem: the best of each family is strong and has its name."""
    axes.set(xscale="log", yscale="log")
    curves = curves_of(rows, (cost, "error_max"))
    best = best_of_families([curve for curve in curves if curve.method != EXACT], cost)
    named = []
    for curve in curves:
        x = curve.rows[cost].to_numpy(float)
        y = np.maximum(curve.rows["error_max"].to_numpy(float), LEAST_ERROR)
        if curve.method == EXACT:
            mark_exact(axes, x, y)
        elif any(curve is other for other in best):
            style = curve.style() | {"linestyle": "-", "linewidth": 1.6, "zorder": 3}
            style["color"] = look_of(family_of(curve.method)).colour
            axes.plot(x, y, **style, label=curve.label)
            named.append((curve, upper_end(x, y)))
        else:
            axes.plot(x, y, **OTHERS, label=curve.label)
    draw_floor(axes, rows)
    set_limits(axes, rows, cost, "error_max")
    name_at_the_top(axes, named)


def upper_end(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """The first point of a curve that no turn is beyond; the highest of one that is not there."""
    place = int(np.argmax(y <= MOST_ERROR))
    return float(x[place]), min(float(y[place]), MOST_ERROR)


def tell_lead(table: Table, cost: str, less: str) -> str:
    """Which family needs the least for the goal on a single problem, and how much less it is."""
    if len(problems_of(table)) > 1:
        return ""
    curves = [c for c in curves_of(table.rows, (cost, "error_max")) if c.method != EXACT]
    costs = [(time_to(curve, cost=cost), curve) for curve in best_of_families(curves, cost)]
    reached = sorted(((x, c.label) for x, c in costs if np.isfinite(x)), key=lambda pair: pair[0])
    if len(reached) < 2 or reached[1][0] < LEAST_LEAD * reached[0][0]:
        return ""
    (least, first), (more, second) = reached[:2]
    ratio = more / least
    told = write(ratio, 2) if ratio < 100 else write_count(ratio)
    return f": {first} {less.format(ratio=told, other=second)} at {GOAL}"


def draw_precision_time(table: Table) -> Figure:
    """Error against time, the fastest of the repeats."""
    lead = tell_lead(table, "time_s", "is {ratio} times as fast as {other}")
    title = f"Error against computing time{lead}"
    figure, _ = draw_precision_over(table, "time_s", title, "computing time (s)")
    return figure


def draw_precision_work(table: Table) -> Figure:
    """Error against evaluations, with lines whose slopes are orders."""
    lead = tell_lead(table, "evaluations", "takes {ratio} times fewer than {other}")
    title = f"Error against function evaluations{lead}"
    label = "function evaluations (a Taylor series of order p counts as p)"
    figure, panels = draw_precision_over(table, "evaluations", title, label)
    for (_, rows), axes in zip(table.rows.groupby("problem", sort=False), panels, strict=True):
        methods = rows.loc[stepping(rows) & rows["setting"].str.startswith("steps "), "method"]
        orders = {order for name in methods.unique() if (order := order_of(name))}
        draw_slopes(axes, sorted(orders))
    return figure


def draw_slopes(axes: Axes, orders: list[int]) -> None:
    """A fan at the lower left, above the band of rounding, whose slopes are these orders."""
    if not orders:
        return
    (left, right), (low, high) = (np.log10(limits) for limits in (axes.get_xlim(), axes.get_ylim()))
    floor = max((np.log10(patch.get_corners()[:, 1].max()) for patch in axes.patches), default=low)
    ratio = (right - left) / (high - low)
    apex = 0.03, (max(floor, low) - low) / (high - low) + 0.06 + FAN[1]
    for order in orders:
        slope = order * ratio
        run = 1 / np.hypot(1 / FAN[0], slope / FAN[1])
        ends = [apex, (apex[0] + run, apex[1] - slope * run)]
        points = [
            (10 ** (left + x * (right - left)), 10 ** (low + y * (high - low))) for x, y in ends
        ]
        axes.plot(*np.transpose(points), color=GREY, linewidth=0.9, zorder=1)
        style = {"fontsize": 9, "color": GREY, "ha": "left", "va": "top"}
        axes.annotate(f"{order}", points[1], (1, 2), textcoords="offset points", **style)
    style = {"fontsize": 9, "color": GREY, "va": "bottom"}
    axes.text(apex[0], apex[1] + 0.01, "order", transform=axes.transAxes, **style)
