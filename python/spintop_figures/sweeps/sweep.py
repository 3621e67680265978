"""The figure of a sweep over one parameter: the paper's formulas beside the exact values."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator, NullLocator

from spintop_figures.style.look import LINES, by_width
from spintop_figures.style.numbers import numbers
from spintop_figures.style.page import new_figure
from spintop_figures.sweeps.quantities import has_log_axis, is_wide, label_parameter, succeeded
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

FORMULA = "_fast_top"
"""Ending of the columns that hold the paper's formula for a fast top."""

MANY_DECADES = 100
"""The ratio of the values on a log axis that needs no minor ticks."""

MOST_MARKS = 60
"""Curves with more points have no marks at them."""


class Quantity(NamedTuple):
    """A quantity that the paper has a formula for."""

    column: str
    equation: str


QUANTITIES = (
    Quantity("delta_u", "Eq 29"),
    Quantity("nutation_rate", "Eq 30"),
    Quantity("precession_rate", "Eq 32"),
    Quantity("nutations_per_turn", "Eq 54"),
)
TOO = {1: "too large", -1: "too small"}
AZIMUTH = "azimuth_after_period_deg"


def formula_columns() -> list[str]:
    """The columns that hold the paper's formulas."""
    return [quantity.column + FORMULA for quantity in QUANTITIES]


def sweep_columns() -> list[str]:
    """The columns that the figure is made of."""
    return [*(quantity.column for quantity in QUANTITIES), *formula_columns(), AZIMUTH]


def good_rows(table: Table) -> pd.DataFrame:
    """The cases that succeeded, by the swept parameter."""
    return succeeded(table).sort_values(table.axes()[0], kind="stable")


def draw_sweep(table: Table) -> Figure:
    """The paper's formulas and the exact values against the swept parameter."""
    figure = new_figure(table, "Fast-top formulas and exact solution", by_width(7.4, 12.5))
    across = by_width(2, 1)
    panels = figure.subplots(6 // across, across, sharex=True, squeeze=False)
    rows = good_rows(table)
    x = rows[table.axes()[0]].to_numpy(float)
    for quantity, axes in zip(QUANTITIES, panels.flat, strict=False):
        draw_quantity(axes, x, rows, quantity, table.units.get(quantity.column, ""))
    draw_azimuth(panels.flat[4], x, rows[AZIMUTH].to_numpy(float))
    draw_deviations(panels.flat[5], x, rows)
    for axes in panels[-1]:
        label_parameter(table, 0, axes.xaxis)
    figure.align_ylabels()
    if has_log_axis(table, 0):
        panels[0, 0].set_xscale("log")
        panels[-1, 0].xaxis.set_major_formatter(numbers())
    return figure


def marks(x: np.ndarray, marker: str, **style: object) -> dict[str, object]:
    """The marks of a curve: none where they would touch each other."""
    return {"marker": marker, **style} if len(x) <= MOST_MARKS else {}


def draw_quantity(
    axes: Axes, x: np.ndarray, rows: pd.DataFrame, quantity: Quantity, unit: str
) -> None:
    """A quantity by the paper's formula, and exact."""
    exact = rows[quantity.column].to_numpy(float)
    formula = rows[quantity.column + FORMULA].to_numpy(float)
    equation = f"paper's {quantity.equation}"
    axes.plot(x, formula, **marks(x, "s", markersize=4, mfc="white"), **LINES[1], label=equation)
    axes.plot(x, exact, **marks(x, "o", markersize=3), **LINES[0], label="exact")
    if is_wide(values := np.concatenate([exact, formula])):
        axes.set_yscale("log")
        if is_wide(values, MANY_DECADES):
            axes.yaxis.set_minor_locator(NullLocator())  # a tenth of the time of a figure
    axes.set_ylabel(axis_of(quantity.column, unit))
    axes.legend()


def draw_azimuth(axes: Axes, x: np.ndarray, azimuth: np.ndarray) -> None:
    """The azimuth after T_p, which the paper's Eq 32 makes a full turn."""
    axes.plot(x, np.full_like(x, 360), **LINES[1], label="paper's Eq 32: a full turn")
    style = marks(x, "o", markersize=3) | LINES[0]
    known = np.isfinite(azimuth).any()
    label = "computed by the run" if known else "not computed: no row at $T_p$"
    axes.plot(x, azimuth, **style, label=label)
    axes.set_ylabel("azimuth after $T_p$ (degrees)")
    low, high = np.nanmin([0, *azimuth]), np.nanmax([360, *azimuth])
    axes.set_ylim(low - 0.06 * (high - low), high + 0.45 * (high - low))  # the legend is above
    axes.yaxis.set_major_locator(MultipleLocator(90 * max(1, round((high - low) / 450))))
    axes.legend(loc="upper left")


def draw_deviations(axes: Axes, x: np.ndarray, rows: pd.DataFrame) -> None:
    """How far each formula is from the exact value: full marks too large, empty ones too small.

    Between marks of one kind there is a line; where the sign changes, there is none.
    """
    for line, marker, quantity in zip(LINES, "osD^", QUANTITIES, strict=True):
        exact = rows[quantity.column].to_numpy(float)
        formula = rows[quantity.column + FORMULA].to_numpy(float)
        with np.errstate(divide="ignore", invalid="ignore"):
            deviation = formula / exact - 1
        few = len(x) <= MOST_MARKS
        style = {"color": line["color"], "marker": marker if few else "", "markersize": 4}
        for sign, face, dashes in ((1, line["color"], "-"), (-1, "white", ":")):
            size = np.where(sign * deviation > 0, np.abs(deviation), np.nan)
            look = style | {"markerfacecolor": face, "linestyle": dashes, "linewidth": 1.0}
            axes.plot(x, size, **look, label=f"{quantity.equation} {TOO[sign]}")
    axes.set_yscale("log")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylabel("relative error of the formula")
    axes.set_title("full: too large; empty, dotted: too small", loc="left", fontsize=9, pad=3)
    handles = [
        Line2D([], [], color=line["color"], marker=marker, markersize=4, label=quantity.equation)
        for line, marker, quantity in zip(LINES, "osD^", QUANTITIES, strict=True)
    ]
    axes.legend(handles=handles, ncols=2)
