"""The quantities of a sweep over one parameter as curves."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.style.look import FAINT, FAULT, LINES
from spintop_figures.style.page import add_panels, head, new_figure, panel_rows
from spintop_figures.sweeps.quantities import (
    Quantity,
    draw_class_ticks,
    is_words,
    quantities_of,
    set_parameter_axis,
    tell_rest,
)
from spintop_figures.sweeps.sweep import MOST_MARKS, marks
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

PANEL_HEIGHT, LEAST_HEIGHT = 2.0, 3.0
"""Of a row of panels, and of all of them, in inches."""

SAME_THRESHOLD = 1e-6
"""Spins of the table are that precise; a rotor adds to them, and then there is no one threshold."""

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


@figure(
    "curves",
    "quantities of a sweep over one parameter",
    kind="sweep",
    objection=object_to_curves,
)
def draw_curves(table: Table) -> Figure:
    """A curve of each quantity that the table has, and where cases failed."""
    quantities, name = quantities_of(table), table.axes()[0]
    rows = table.rows.sort_values(name, kind="stable")
    x, failed = rows[name].to_numpy(float), ~ended_well(rows).to_numpy()
    height = 1.3 + max(PANEL_HEIGHT * panel_rows(len(quantities)), LEAST_HEIGHT)
    figure = new_figure(table, f"The motion over the {name_of(name)}{tell_rest(table)}", height)
    threshold = sleeping_threshold(name, rows)
    panels = add_panels(figure, len(quantities), sharey=False)
    crosses = {"color": FAULT, "markersize": 4, "clip_on": False}
    for quantity, axes in zip(quantities, panels, strict=True):
        draw_curve(axes, x, quantity, quantity.values(rows), failed)
        if failed.any():
            place = x[failed], np.zeros(failed.sum())
            axes.plot(*place, "x", transform=axes.get_xaxis_transform(), **crosses)
        if threshold:
            axes.axvline(threshold, color=FAINT, linewidth=0.8, linestyle="--")
    set_parameter_axis(table, 0, *panels)
    return figure


def sleeping_threshold(name: str, rows: pd.DataFrame) -> float | None:
    """Where on an axis of spins the sleeping top becomes stable, if the table has the ratio."""
    if name not in ("initial.omega3", "initial.spin_ratio") or "sleeping_ratio" not in rows:
        return None
    at = np.abs(rows[name] / rows["sleeping_ratio"]).dropna()
    spread = np.ptp(at) if at.size else np.inf
    return float(at.mean()) if spread <= SAME_THRESHOLD * at.mean() else None


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
