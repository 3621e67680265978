"""The figure of a sweep over one parameter: the paper's formulas beside the exact values."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator, NullLocator

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import LAGRANGE
from spintop_figures.style.axes import name_axis
from spintop_figures.style.look import FAINT, FAULT, GROUND, LINES, by_width
from spintop_figures.style.page import head, new_figure, panel_figure
from spintop_figures.sweeps.quantities import (
    Quantity,
    draw_class_ticks,
    has_log_axis,
    is_wide,
    is_words,
    quantities_of,
    scale_panels,
    succeeded,
    tell_rest,
)
from spintop_figures.tables.names import axis_of, name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import ended_well

FORMULA = "_fast_top"
"""Ending of the columns that hold the paper's formula for a fast top."""

MOST_MARKS = 60
"""Curves with more points have no marks at them."""

EQUATIONS = {
    "delta_u": "Eq 29",
    "nutation_rate": "Eq 30",
    "precession_rate": "Eq 32",
    "nutations_per_turn": "Eq 54",
}
"""Quantities that the paper has a formula for."""

FORMULAS = [column + FORMULA for column in EQUATIONS]
MARKERS = "osD^"
AZIMUTH = "azimuth_after_period_deg"


def good_rows(table: Table) -> pd.DataFrame:
    """The cases that succeeded, by the swept parameter."""
    return succeeded(table).sort_values(table.axes()[0], kind="stable")


def object_to_sweep(table: Table) -> str:
    """The curves are over one parameter, through the cases that succeeded."""
    if len(table.axes()) != 1:
        return "is a sweep over more than one parameter"
    if good_rows(table).empty:
        return "has no case that succeeded"
    return "has no formula for a fast top" if table.empty(FORMULAS) == FORMULAS else ""


@figure(
    "sweep",
    " ".join([*EQUATIONS, *FORMULAS, AZIMUTH]),
    objection=object_to_sweep,
    sparse=True,
    assumes=LAGRANGE,
)
def draw_sweep(table: Table) -> Figure:
    """Formulas for a fast top and exact values against the swept parameter."""
    figure = new_figure(table, "Fast-top formulas and exact solution", by_width(7.4, 12.5))
    across = by_width(2, 1)
    panels = figure.subplots(6 // across, across, sharex=True, squeeze=False)
    rows = good_rows(table)
    x = rows[table.axes()[0]].to_numpy(float)
    for column, axes in zip(EQUATIONS, panels.flat, strict=False):
        draw_quantity(axes, x, rows, column, table.units.get(column, ""))
    axes, azimuth = panels.flat[4], rows[AZIMUTH].to_numpy(float)
    axes.plot(x, np.full_like(x, 360), **LINES[1], label="paper's Eq 32: a full turn")
    known = np.isfinite(azimuth).any()
    label = "computed by the run" if known else "not computed: no row at $T_p$"
    axes.plot(x, azimuth, **marks(x, "o", markersize=3) | LINES[0], label=label)
    low, high = np.nanmin([0, *azimuth]), np.nanmax([360, *azimuth])
    axes.set_ylim(low - 0.06 * (high - low), high + 0.45 * (high - low))  # the legend is above
    axes.yaxis.set_major_locator(MultipleLocator(90 * max(1, round((high - low) / 450))))
    name_axis(axes.yaxis, "azimuth after $T_p$", "degrees")
    axes.legend(loc="upper left")
    draw_deviations(panels.flat[5], x, rows)
    name = table.axes()[0]
    scale_panels([*panels.flat], "x", table, name, has_log_axis(table, name))
    figure.align_ylabels()
    return figure


def marks(x: np.ndarray, marker: str, **style: object) -> dict[str, object]:
    """The marks of a curve: none where they would touch each other."""
    return {"marker": marker, **style} if len(x) <= MOST_MARKS else {}


def draw_quantity(axes: Axes, x: np.ndarray, rows: pd.DataFrame, column: str, unit: str) -> None:
    """A quantity by the paper's formula, and exact."""
    exact, formula = (rows[name].to_numpy(float) for name in (column, column + FORMULA))
    empty = marks(x, "s", markersize=4, mfc=GROUND) | {"label": f"paper's {EQUATIONS[column]}"}
    axes.plot(x, formula, **empty, **LINES[1])
    axes.plot(x, exact, **marks(x, "o", markersize=3), **LINES[0], label="exact")
    if is_wide(values := np.concatenate([exact, formula])):
        axes.set_yscale("log")
        if is_wide(values, 100):
            axes.yaxis.set_minor_locator(NullLocator())  # a tenth of the time of a figure
    name_axis(axes.yaxis, axis_of(column), unit)
    axes.legend()


def draw_deviations(axes: Axes, x: np.ndarray, rows: pd.DataFrame) -> None:
    """How far each formula is from the exact value: full marks too large, empty ones too small.

    Between marks of one kind there is a line; where the sign changes, there is none.
    """
    handles = []
    for line, marker, (column, equation) in zip(LINES, MARKERS, EQUATIONS.items(), strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            deviation = (rows[column + FORMULA] / rows[column] - 1).to_numpy(float)
        style = {"color": line["color"], "marker": marker, "markersize": 4}
        handles.append(Line2D([], [], **style, label=equation))
        style |= {} if len(x) <= MOST_MARKS else {"marker": ""}
        sides = (("too large", 1, line["color"], "-"), ("too small", -1, GROUND, ":"))
        for words, sign, face, dashes in sides:
            size = np.where(sign * deviation > 0, np.abs(deviation), np.nan)
            look = style | {"markerfacecolor": face, "linestyle": dashes, "linewidth": 1.0}
            axes.plot(x, size, **look, label=f"{equation} {words}")
    axes.set_yscale("log")
    axes.yaxis.set_minor_locator(NullLocator())
    name_axis(axes.yaxis, "relative error of the formula")
    axes.set_title("full: too large; empty, dotted: too small", fontsize="small", pad=3)
    axes.legend(handles=handles, ncols=2)


FAR = 0.08
"""Neighbours among many cases that differ by more of the range are not joined: between them a curve
is not known."""


def object_to_curves(table: Table) -> str:
    """The curves are over one parameter that has several values."""
    if len(table.axes()) != 1:
        return "is no sweep over one parameter"
    if table.rows[table.axes()[0]].nunique() < 2:
        return "is a sweep with a single value of the parameter"
    return "" if quantities_of(table) else "has no quantity to draw"


@figure("sweep", objection=object_to_curves)
def draw_curves(table: Table) -> Figure:
    """Quantities of a sweep over one parameter."""
    quantities, name = quantities_of(table), table.axes()[0]
    rows = table.rows.sort_values(name, kind="stable")
    x, failed = rows[name].to_numpy(float), ~ended_well(rows).to_numpy()
    title = f"The motion over the {name_of(name)}{tell_rest(table)}"
    figure, panels = panel_figure(table, title, len(quantities), 2.0, 3.0, 1.3, share="x")
    threshold = sleeping_threshold(name, rows)
    crosses = {"color": FAULT, "markersize": 4, "clip_on": False}
    for quantity, axes in zip(quantities, panels, strict=True):
        draw_curve(axes, x, quantity, quantity.values(rows), failed)
        if failed.any():
            place = x[failed], np.zeros(failed.sum())
            axes.plot(*place, "x", transform=axes.get_xaxis_transform(), **crosses)
        if threshold:
            axes.axvline(threshold, color=FAINT, linewidth=0.8, linestyle="--")
    scale_panels(panels, "x", table, name, has_log_axis(table, name))
    return figure


def sleeping_threshold(name: str, rows: pd.DataFrame) -> float | None:
    """Where on an axis of spins the sleeping top becomes stable, if the table has the ratio."""
    if name not in ("initial.omega3", "initial.spin_ratio") or "sleeping_ratio" not in rows:
        return None
    at = np.abs(rows[name] / rows["sleeping_ratio"]).dropna()
    spread = np.ptp(at) if at.size else np.inf
    # a rotor adds to them, and then there is no one threshold
    return float(at.mean()) if spread <= 1e-6 * at.mean() else None


def draw_curve(
    axes: Axes, x: np.ndarray, quantity: Quantity, values: pd.Series, failed: np.ndarray
) -> None:
    """A quantity of the cases that succeeded; a class of motion is a step, a sign change a line."""
    style = marks(x, "o", markersize=3) | LINES[0]
    if is_words(values):
        numbers = np.where(failed, np.nan, draw_class_ticks(axes, values, values[~failed]))
        axes.plot(x, numbers, **style | {"linestyle": "", "marker": "o", "markersize": 3})
        axes.set_ylim(-0.5, len(axes.get_yticks()) - 0.5)
        head(axes, quantity.label)
        return
    numbers = quantity.shown(np.where(failed, np.nan, values.to_numpy(float)))
    none = quantity.is_none(numbers)
    numbers = np.where(none, 0.0, numbers)
    if quantity.has_log_scale(numbers):
        axes.set_yscale("log")
        numbers = np.where(numbers > 0, numbers, np.nan)
    elif np.nanmin(numbers) < 0 < np.nanmax(numbers):
        axes.axhline(0, color=FAINT, linewidth=0.8)
    draw_joined(axes, x, numbers, style)
    after = f"; 0: {quantity.none}" if none.any() else ""
    head(axes, quantity.label, axes.yaxis, quantity.unit, after)


def draw_joined(axes: Axes, x: np.ndarray, y: np.ndarray, style: dict[str, object]) -> None:
    """A curve; of many cases only those that are near to each other are joined, others are dots."""
    if len(x) <= MOST_MARKS:
        axes.plot(x, y, **style)
        return
    heights = np.log(y) if axes.get_yscale() == "log" else y
    far = np.abs(np.diff(heights)) > FAR * (np.nanmax(heights) - np.nanmin(heights))
    gaps = np.flatnonzero(far) + 1
    axes.plot(np.insert(x, gaps, np.nan), np.insert(y, gaps, np.nan), **style)
    alone = np.append(True, far) & np.append(far, True)
    dots = {"linestyle": "", "marker": ".", "markersize": 3, "color": style["color"]}
    axes.plot(x[alone], y[alone], **dots)
