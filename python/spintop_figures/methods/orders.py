"""Convergence of the fixed-step methods: error against step size, with measured orders."""

import itertools

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.methods.curves import Curve, curves_of, name_at_the_side
from spintop_figures.methods.known import order_of
from spintop_figures.methods.precision import (
    ERROR,
    LEAST_ERROR,
    MOST_ERROR,
    PRECISION,
    draw_precision_curves,
    object_to_precision,
    problem_panels,
)
from spintop_figures.style.axes import name_axes, name_axis
from spintop_figures.style.numbers import DASH, write_fixed
from spintop_figures.tables.table import Table

STEP = "step"
"""The column with the step size over the time span."""

ALIKE = 0.1
"""Slopes that differ by less, over their size, are those of a power: the steps are small enough
for the order to show, and the errors are not of rounding yet."""

LEAST_SLOPE = 0.5
"""Errors of rounding fall by less."""


def equal_steps(table: Table) -> pd.DataFrame:
    """The rows with a fixed step size, with the step size over the time span."""
    rows = table.rows[table.rows["setting"].str.startswith("steps ")].copy()
    rows[STEP] = 1 / rows["setting"].str.split().str[1].astype(float)
    return rows


def object_to_orders(table: Table) -> str:
    """A method needs rows with several fixed step sizes."""
    if objection := object_to_precision(table):
        return objection
    curves = curves_of(equal_steps(table), (STEP, "error_max"))
    several = any(len(curve.rows) > 1 for curve in curves)
    return "" if several else "has no method with several fixed step sizes"


def measured_order(rows: pd.DataFrame) -> float:
    """The slope of the logarithm of the error over that of the step; nan if it cannot be told.

    It is that of the finest three steps over which it hardly changes; of rows with one step
    the first counts.
    """
    rows = rows.drop_duplicates(STEP)
    error, step = (np.log(rows[name].to_numpy(float)) for name in ("error_max", STEP))
    slopes = np.diff(error) / np.diff(step)
    for one, other in itertools.pairwise(slopes[::-1]):
        if min(one, other) > LEAST_SLOPE and abs(one - other) < ALIKE * max(one, other):
            return float((one + other) / 2)
    return float("nan")


def with_order(curve: Curve) -> str:
    """The label of a curve with its measured order and, after a slash, that of the method."""
    order = measured_order(curve.rows)
    measured = write_fixed(order, 2) if np.isfinite(order) else DASH
    return f"{curve.label}: {measured} / {order_of(curve.method) or DASH}"


@figure(
    "orders",
    "error against step size of the fixed-step methods, with measured orders",
    needs="error_max",
    objection=object_to_orders,
    **PRECISION,
)
def draw_orders(table: Table) -> Figure:
    """Error against the size of the step, a panel a problem, each curve with its name and order."""
    rows = equal_steps(table)
    title = "Convergence of the fixed-step methods, with measured / theoretical order"
    figure, panels = problem_panels(table, title, rows)
    words = "step size over the time span"
    for problem, axes in panels.items():
        part = rows[rows["problem"] == problem]
        draw_precision_curves(axes, part, STEP)
        named = [(curve, coarse_end(curve)) for curve in curves_of(part, (STEP, "error_max"))]
        name_at_the_side(axes, named, with_order)
        name_axes(axes, y=ERROR)
        if any(DASH in text.get_text() for text in axes.texts) and "\n" not in words:
            words += f"\n{DASH}: no order is seen, for rounding or for too large steps"
        name_axis(axes.xaxis, "")
    name_axis(axes.xaxis, words)
    return figure


def coarse_end(curve: Curve) -> tuple[float, float]:
    """The point of a curve with the largest step that is on the axes."""
    first = curve.rows.iloc[0]
    return float(first[STEP]), min(max(float(first["error_max"]), LEAST_ERROR), MOST_ERROR)
