"""Work and precision of methods: the curves of a work-precision study, and axes for them."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.kinds import figure
from spintop_figures.methods.curves import (
    EXACT,
    GOAL,
    best_of_families,
    curves_of,
    name_at_the_top,
    problems_of,
    time_to,
)
from spintop_figures.methods.known import family_of, look_of, order_of, style_of
from spintop_figures.style.axes import name_axes
from spintop_figures.style.look import FAINT, GREY, by_width
from spintop_figures.style.numbers import write, write_count
from spintop_figures.style.page import head, new_figure
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

PRECISION = {"kind": "work_precision", "words": "problem method formulation setting status"}
"""What figures of a work-precision study ask."""

LEAST_ERROR, MOST_ERROR = 1e-16, 4.0
"""Smaller errors are drawn at the first, rad; no turn is larger than the second."""

MOST_PROBLEMS = 6
"""Panels that fit a page."""

PANEL_HEIGHT, NAMES_HEIGHT = 3.4, 0.8
"""Of a panel, and of the names above it, in inches."""

FAN = 0.2, 0.3
"""Width and height of the fan of orders, over those of the panel."""

OTHERS = {"color": FAINT, "linewidth": 0.9, "zorder": 1}
"""Curves that are not the best of their family."""

NOTE = f"named: the best of each family at {GOAL}; grey: the others"

LEAST_LEAD = 1.05
"""A method that is ahead by less, as a ratio, is not said to be."""

ERROR = "largest error of the attitude", "rad"


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
    style = {"textcoords": "offset points", "va": by_width("top", "bottom"), "fontsize": "small"}
    for place in zip(cost[there][:1], error[there][:1], strict=True):
        axes.annotate("exact solution", place, (6, by_width(-1, 1)), **style)


def draw_floor(axes: Axes, rows: pd.DataFrame) -> None:
    """The band of errors that rounding of the data makes by itself, where it is known."""
    if "inherent_error" in rows and np.isfinite(floor := rows["inherent_error"].max()):
        axes.axhspan(1e-30, max(floor, LEAST_ERROR), color=FAINT, linewidth=0, zorder=0)
        style = {"fontsize": "small", "va": "bottom", "ha": "right", "zorder": 5}
        style["path_effects"] = [withStroke(linewidth=3, foreground=FAINT)]
        axes.annotate("inherent error", (0.99, 0.015), xycoords="axes fraction", **style)


def set_limits(axes: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """From the least to the largest, with a little room; a method that is lost is not shown."""
    cost, error = (rows[name].to_numpy(float) for name in (x, y))
    shown = ended_well(rows).to_numpy() & (cost > 0) & np.isfinite(error)
    if not shown.any():
        return
    axes.set_xlim(cost[shown].min() / 2, cost[shown].max() * 2)
    least = max(error[shown].min(), LEAST_ERROR)
    axes.set_ylim(least / 15, min(error[shown].max() * 5, 2 * MOST_ERROR))
    few_ticks(axes, 9, 9)


def few_ticks(axes: Axes, x: int, y: int) -> None:
    """So many ticks on log axes at most, and a faint grid."""
    for axis, count in ((axes.xaxis, x), (axes.yaxis, y)):
        axis.set_major_locator(LogLocator(numticks=count))
        axis.set_minor_locator(NullLocator())
    axes.grid(alpha=0.4)


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
    if len(problems) > 1:
        for problem, axes in zip(problems, panels, strict=True):
            head(axes, name_of(problem))
    return figure, dict(zip(problems, panels, strict=True))


def draw_over(table: Table, cost: str, less: str, words: str, unit: str) -> tuple[Figure, list]:
    """Error against a cost, one panel per problem: the best of each family, the others grey."""
    title = f"Error against {words.partition(' (')[0]}{tell_lead(table, cost, less)}"
    figure, panels = problem_panels(table, title, table.rows, NAMES_HEIGHT)
    for problem, axes in panels.items():
        draw_best_curves(axes, table.rows[table.rows["problem"] == problem], cost)
        name_axes(axes, (words, unit, f"\n{NOTE}"), ERROR)
        if axes is not [*panels.values()][-1]:
            axes.set_xlabel("")
    return figure, [*panels.values()]


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
            place = int(np.argmax(y <= MOST_ERROR))  # no turn is beyond
            named.append((curve, (float(x[place]), min(float(y[place]), MOST_ERROR))))
        else:
            axes.plot(x, y, **OTHERS, label=curve.label)
    draw_floor(axes, rows)
    set_limits(axes, rows, cost, "error_max")
    name_at_the_top(axes, named)


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


@figure(
    "precision_time",
    "work-precision diagram: error against time, one panel per problem",
    needs="error_max time_s",
    objection=object_to_precision,
    **PRECISION,
)
def draw_precision_time(table: Table) -> Figure:
    """Error against time, the fastest of the repeats."""
    less = "is {ratio} times as fast as {other}"
    return draw_over(table, "time_s", less, "computing time", "s")[0]


@figure(
    "precision_work",
    "work-precision diagram: error against evaluations, one panel per problem",
    needs="error_max evaluations",
    objection=object_to_precision,
    **PRECISION,
)
def draw_precision_work(table: Table) -> Figure:
    """Error against evaluations, with lines whose slopes are orders."""
    less = "takes {ratio} times fewer than {other}"
    words = "function evaluations (a Taylor series of order p counts as p)"
    figure, panels = draw_over(table, "evaluations", less, words, "")
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
    x, y = 0.03, (max(floor, low) - low) / (high - low) + 0.06 + FAN[1]
    style = {"fontsize": "small", "color": GREY}
    for order in orders:
        run = 1 / np.hypot(1 / FAN[0], order * ratio / FAN[1])
        across, up = np.array([x, x + run]), np.array([y, y - order * ratio * run])
        line = 10 ** (left + across * (right - left)), 10 ** (low + up * (high - low))
        axes.plot(*line, color=GREY, linewidth=0.9, zorder=1)
        end = line[0][1], line[1][1]
        axes.annotate(f"{order}", end, (1, 2), textcoords="offset points", va="top", **style)
    axes.text(x, y + 0.01, "order", transform=axes.transAxes, va="bottom", **style)
