"""Which method is the cheapest that reaches an error, and at what cost: maps of a swept study."""

import dataclasses
import itertools

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from figures.maps import PANEL_HEIGHT, cross, draw_map, label_axes, make_grid, object_to_grid
from figures.precision import EXACT, Curve, curves_of, problems_of
from figures.quantities import Quantity, tell_failed, the_column
from figures.style import add_panels, new_figure
from figures.table import Table

TARGET, GOAL = 1e-9, "10\u207b\u2079 rad"
"""The error that the methods have to reach, rad, and how it is written."""

QUANTITIES = (
    Quantity(("time_s",), f"shortest time for {GOAL}", "s", the_column("time_s"), 3),
    Quantity(("method",), "by", "", the_column("method")),
    Quantity(("ratio",), "time ratio of the next method", "", the_column("ratio"), 10),
    Quantity(("next",), "next method", "", the_column("next")),
)
"""The columns of the table of problems, as maps."""


def time_to(curve: Curve, target: float = TARGET) -> float:
    """The least time in which a method reaches an error, nan if it does not.

    Between two settings the logarithms of time and error are on a line.
    """
    time, error = (np.log(curve.rows[name].to_numpy(float)) for name in ("time_s", "error_max"))
    goal = np.log(target)
    times = [time[0]] if error[0] <= goal else []
    for (t0, e0), (t1, e1) in itertools.pairwise(zip(time, error, strict=True)):
        if e1 <= goal < e0:
            share = 1.0 if np.isneginf(e1) else (goal - e0) / (e1 - e0)
            times.append(t0 + share * (t1 - t0))
    return float(np.exp(min(times))) if times else float("nan")


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
    columns = ["case", *axes, "status", *(quantity.columns[0] for quantity in QUANTITIES)]
    return dataclasses.replace(table, rows=pd.DataFrame(rows, columns=columns))


def object_to_tolerance_map(table: Table) -> str:
    """The maps are over two swept parameters, all of whose values are combined."""
    if len(swept_parameters(table)) != 2:
        return "is no study over two parameters"
    problems = table_of_problems(table)
    if objection := object_to_grid(problems):
        return objection
    if not (problems.rows["status"] == "ok").any():
        return f"has no method that reaches an error of {GOAL}"
    return ""


def draw_tolerance_map(table: Table) -> Figure:
    """The least time to the target and the method that takes it, and what the next one takes."""
    problems = table_of_problems(table)
    grid = make_grid(problems)
    failed = (problems.rows["status"] != "ok").to_numpy()
    title = f"The cheapest method for an error of {GOAL} in attitude"
    figure = new_figure(table, title + tell_failed(problems), 1.2 + 2 * PANEL_HEIGHT)
    panels = add_panels(figure, len(QUANTITIES))
    for quantity, axes in zip(QUANTITIES, panels, strict=True):
        draw_map(axes, grid, quantity, quantity.values(problems.rows), failed)
        cross(axes, grid, failed)
    label_axes(problems, grid, panels)
    return figure
