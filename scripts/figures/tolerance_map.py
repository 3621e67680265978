"""Which method is the cheapest that reaches an error, and at what cost: maps of a swept study."""

import dataclasses
import itertools

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from figures.maps import LEAST_HEIGHT, draw_map, label_axes, make_grid, object_to_grid
from figures.precision import EXACT, Curve, curves_of, problems_of
from figures.quantities import Quantity, the_column
from figures.style import add_panels, new_figure
from figures.table import Table

TARGET = 1e-9
"""The error that the methods have to reach, rad."""

TIME = Quantity(("time_s",), f"least time to {TARGET:.0e} rad", "s", the_column("time_s"), 3)
METHOD = Quantity(("method",), "by", "", the_column("method"))


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


def cheapest(rows: pd.DataFrame) -> tuple[float, str]:
    """The least time in which a method that takes steps reaches the target, and its name."""
    curves = [c for c in curves_of(rows, ("time_s", "error_max")) if c.method != EXACT]
    times = {curve.label: time_to(curve) for curve in curves}
    good = {label: time for label, time in times.items() if np.isfinite(time)}
    if not good:
        return float("nan"), ""
    label = min(good, key=good.get)
    return good[label], label


def swept_parameters(table: Table) -> list[str]:
    """The parameters that the study sweeps: columns whose names have a point."""
    return [name for name in table.rows if "." in name]


def table_of_problems(table: Table) -> Table:
    """The study as the table of a sweep: a row a problem, with the cheapest method and its time."""
    axes = swept_parameters(table)
    rows = []
    for number, problem in enumerate(problems_of(table), start=1):
        part = table.rows[table.rows["problem"] == problem]
        time, method = cheapest(part)
        status = "ok" if method else "not reached"
        rows.append([number, *part[axes].iloc[0], status, time, method])
    columns = ["case", *axes, "status", "time_s", "method"]
    return dataclasses.replace(table, rows=pd.DataFrame(rows, columns=columns))


def object_to_tolerance_map(table: Table) -> str:
    """The maps are over two swept parameters, all of whose values are combined."""
    if len(swept_parameters(table)) != 2:
        return "is no study over two parameters"
    problems = table_of_problems(table)
    if objection := object_to_grid(problems):
        return objection
    if not (problems.rows["status"] == "ok").any():
        return f"has no method that reaches an error of {TARGET:.0e} rad"
    return ""


def draw_tolerance_map(table: Table) -> Figure:
    """The least time to the target, and the method that takes it, side by side."""
    problems = table_of_problems(table)
    grid = make_grid(problems)
    failed = (problems.rows["status"] != "ok").to_numpy()
    title = f"The cheapest method to an error of {TARGET:.0e} rad in attitude"
    figure = new_figure(table, title, 1.2 + LEAST_HEIGHT * 0.75)
    panels = add_panels(figure, 2)
    for quantity, axes in zip((TIME, METHOD), panels, strict=True):
        draw_map(axes, grid, quantity, quantity.values(problems.rows), failed)
    label_axes(problems, grid, panels)
    return figure
