"""Work and precision of methods: the curves of a work-precision study, and axes for them."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullLocator

from figures.methods import ORDERS, rank_of, style_of
from figures.style import FAINT, GREY, new_figure
from figures.table import Table

WORDS = ("problem", "method", "formulation", "setting", "status")
"""The columns of words of a work-precision study."""

EXACT = "exact"
"""The method that takes no steps."""

LEAST_ERROR, MOST_ERROR = 1e-16, 4.0
"""Smaller errors are drawn at the first, rad; no turn is larger than the second."""

MOST_PROBLEMS = 6
"""Panels that fit a page."""

PANEL_HEIGHT = 3.4
"""In inches."""

ROOM = 0.25
"""For the triangles of orders, over the width of the curves."""

ERROR_LABEL = "largest error of the attitude (rad)"


class Curve(NamedTuple):
    """A method under a formulation: its label, and its rows from the coarsest to the finest."""

    method: str
    formulation: str
    label: str
    rows: pd.DataFrame

    def style(self) -> dict[str, object]:
        """How it is drawn, in every figure alike."""
        return style_of(self.method, self.formulation)


def fineness(setting: str) -> float:
    """How fine a setting is: a number of steps, or one over a tolerance; 0 if it is neither."""
    word, _, value = setting.partition(" ")
    if word == "steps":
        return float(value)
    return 1 / float(value) if word == "tolerance" else 0.0


def problems_of(table: Table) -> list[str]:
    """The problems, in the order in which the table has them first."""
    return list(dict.fromkeys(table.rows["problem"]))


def curves_of(rows: pd.DataFrame, columns: Iterable[str]) -> list[Curve]:
    """The curves of a problem, by family, of rows that went well and have these columns.

    A label names the formulation only where a method has several.
    """
    columns = list(columns)
    sound = (rows["status"] == "ok") & np.isfinite(rows[columns].astype(float)).all(axis=1)
    several = rows.groupby("method")["formulation"].nunique() > 1
    curves = []
    for (method, formulation), part in rows[sound].groupby(["method", "formulation"], sort=False):
        label = f"{method}, {formulation}" if several[method] else method
        order = part["setting"].map(fineness).sort_values(kind="stable").index
        curves.append(Curve(method, formulation, label, part.loc[order]))
    return sorted(curves, key=lambda curve: (*rank_of(curve.method), curve.label))


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
        style = {"ha": "left", "va": "top", "fontsize": 9}
        axes.annotate("exact solution", place, (6, -1), textcoords="offset points", **style)


def draw_floor(axes: Axes, rows: pd.DataFrame) -> None:
    """The band of errors that rounding of the data makes by itself, where it is known."""
    if "inherent_error" in rows and np.isfinite(floor := rows["inherent_error"].max()):
        axes.axhspan(1e-30, max(floor, LEAST_ERROR), color=FAINT, linewidth=0, zorder=0)


def set_limits(axes: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """From the least to the largest, with a little room; a method that is lost is not shown."""
    cost, error = (rows[name].to_numpy(float) for name in (x, y))
    shown = (rows["status"] == "ok").to_numpy() & (cost > 0) & np.isfinite(error)
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


def method_handles(parts: Iterable[pd.DataFrame], columns: Iterable[str]) -> list[Artist]:
    """What curves mean, by family, each once; and what fills markers, if not one formulation."""
    columns = list(columns)
    curves = {
        curve.label: curve
        for rows in parts
        for curve in curves_of(rows, columns)
        if curve.method != EXACT
    }
    ordered = sorted(curves.values(), key=lambda curve: (*rank_of(curve.method), curve.label))
    handles = [Line2D([], [], **curve.style(), label=curve.label) for curve in ordered]
    fills = dict.fromkeys(curve.formulation for curve in ordered)
    grey = {"color": GREY, "linestyle": "", "marker": "o"}
    if len(fills) > 1:
        handles += [
            Line2D([], [], **style_of("", name) | grey, label=f"under {name}") for name in fills
        ]
    return handles


FLOOR_HANDLE = Patch(color=FAINT, linewidth=0, label="inherent error")


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
    return (rows["status"] == "ok") & (rows["method"] != EXACT)


def problem_panels(
    table: Table, title: str, rows: pd.DataFrame, columns: tuple[str, str]
) -> tuple[Figure, dict[str, Axes], list[Artist]]:
    """A figure with a panel a problem, one below the other, and the handles of its legend."""
    problems = list(dict.fromkeys(rows["problem"]))
    figure = new_figure(table, title, 1.2 + PANEL_HEIGHT * len(problems))
    panels = figure.subplots(len(problems), 1, squeeze=False)[:, 0]
    by_problem = dict(zip(problems, panels, strict=True))
    if len(problems) > 1:
        for problem, axes in by_problem.items():
            axes.set_title(problem, loc="left", pad=4)
    parts = [rows[rows["problem"] == problem] for problem in problems]
    return figure, by_problem, method_handles(parts, columns)


def draw_precision_over(table: Table, cost: str, title: str, label: str) -> tuple[Figure, list]:
    """Error against a cost, one panel per problem, the legend at the right."""
    rows = table.rows
    figure, panels, handles = problem_panels(table, title, rows, (cost, "error_max"))
    for problem, axes in panels.items():
        draw_precision_curves(axes, rows[rows["problem"] == problem], cost)
        axes.set_ylabel(ERROR_LABEL)
    axes.set_xlabel(label)
    if "inherent_error" in rows:
        handles.append(FLOOR_HANDLE)
    figure.legend(handles=handles, loc="outside right upper", handlelength=3.2, labelspacing=0.55)
    return figure, list(panels.values())


def draw_precision_time(table: Table) -> Figure:
    """Error against time, the fastest of the repeats."""
    title = "Work-precision diagram: error against time"
    figure, _ = draw_precision_over(table, "time_s", title, "computing time (s)")
    return figure


def draw_precision_work(table: Table) -> Figure:
    """Error against evaluations, with triangles whose slopes are orders."""
    title = "Work-precision diagram: error against function evaluations"
    label = "function evaluations (a Taylor series of order p counts as p)"
    figure, panels = draw_precision_over(table, "evaluations", title, label)
    for (_, rows), axes in zip(table.rows.groupby("problem", sort=False), panels, strict=True):
        orders = {ORDERS[name] for name in rows.loc[stepping(rows), "method"] if name in ORDERS}
        draw_slopes(axes, sorted(orders))
    return figure


def draw_slopes(axes: Axes, orders: list[int]) -> None:
    """Triangles at the lower left, above the band of rounding, whose slopes are these orders."""
    if not orders:
        return
    left, right = axes.get_xlim()
    axes.set_xlim(left / (right / left) ** ROOM, right)
    x_log, y_log = (np.log10(limits) for limits in (axes.get_xlim(), axes.get_ylim()))
    run = ROOM / (1 + ROOM) / (1.5 * len(orders)) * np.ptp(x_log)
    floor = max((np.log10(patch.get_corners()[:, 1].max()) for patch in axes.patches), default=-99)
    x = x_log[0] + 0.025 * np.ptp(x_log)
    bottom = max(floor, y_log[0]) + 0.05 * np.ptp(y_log)
    for order in orders:
        corners = [(x, bottom), (x, bottom + order * run), (x + run, bottom), (x, bottom)]
        axes.plot(*np.power(10, np.transpose(corners)), color=GREY, linewidth=0.8, zorder=1)
        axes.annotate(
            f"{order}", (10 ** (x + 0.3 * run), 10**bottom), (0, -1), textcoords="offset points",
            ha="center", va="top", fontsize=8, color=GREY,
        )  # fmt: skip
        x += 1.5 * run
