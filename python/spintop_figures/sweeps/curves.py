"""Sweeps over one parameter: curves, and the paper's formulas beside exact values, Table 1 too."""

import itertools
import math
import textwrap
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator, NullLocator

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import LAGRANGE
from spintop_figures.style.axes import name_axis
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, INK, LINES, by_width
from spintop_figures.style.numbers import COMMA, DASH, localised, with_power, write
from spintop_figures.style.page import describe_run, head, new_figure, no_axis, panel_figure
from spintop_figures.sweeps import quantities
from spintop_figures.sweeps.quantities import Quantity
from spintop_figures.tables.names import axis_of, ended_well, is_good_end, name_of
from spintop_figures.tables.table import Table

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
AZIMUTH = "azimuth_after_period_deg"


def good_rows(table: Table) -> pd.DataFrame:
    """The cases that succeeded, by the swept parameter."""
    return quantities.succeeded(table).sort_values(table.axes()[0], kind="stable")


@figure(
    "sweep",
    " ".join([*EQUATIONS, *FORMULAS, AZIMUTH]),
    unless={
        "is a sweep over more than one parameter": lambda table: len(table.axes()) == 1,
        "has no case that succeeded": lambda table: len(good_rows(table)),
        "has no formula for a fast top": lambda table: table.empty(FORMULAS) != FORMULAS,
    },
    sparse=True,
    assumes=LAGRANGE,
)
def draw_sweep(table: Table) -> Figure:
    """Formulas for a fast top and exact values against the swept parameter."""
    title = "Fast-top formulas and exact solution"
    figure, panels = panel_figure(table, title, 6, by_width(2.1, 1.9), above=1.1, share="x")
    rows = good_rows(table)
    x = rows[table.axes()[0]].to_numpy(float)
    for column, axes in zip(EQUATIONS, panels, strict=False):
        draw_quantity(axes, x, rows, column, table.units.get(column, ""))
    axes, azimuth = panels[4], rows[AZIMUTH].to_numpy(float)
    axes.plot(x, np.full_like(x, 360), **LINES[1], label="paper's Eq 32: a full turn")
    known = np.isfinite(azimuth).any()
    label = "computed by the run" if known else "not computed: no row at $T_p$"
    axes.plot(x, azimuth, **marks(x, "o", markersize=3) | LINES[0], label=label)
    low, high = np.nanmin([0, *azimuth]), np.nanmax([360, *azimuth])
    axes.set_ylim(low - 0.06 * (high - low), high + 0.45 * (high - low))  # the legend is above
    axes.yaxis.set_major_locator(MultipleLocator(90 * max(1, round((high - low) / 450))))
    name_axis(axes.yaxis, "azimuth after $T_p$", "degrees")
    axes.legend(loc="upper left")
    draw_deviations(panels[5], x, rows)
    name = table.axes()[0]
    quantities.scale_panels(panels, "x", table, name, quantities.has_log_axis(table, name))
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
    if quantities.is_wide(values := np.concatenate([exact, formula])):
        axes.set_yscale("log")
        if quantities.is_wide(values, 100):
            axes.yaxis.set_minor_locator(NullLocator())  # a tenth of the time of a figure
    name_axis(axes.yaxis, axis_of(column), unit)
    axes.legend()


def draw_deviations(axes: Axes, x: np.ndarray, rows: pd.DataFrame) -> None:
    """How far each formula is from the exact value: full marks too large, empty ones too small.

    Between marks of one kind there is a line; where the sign changes, there is none.
    """
    handles = []
    for line, marker, (column, equation) in zip(LINES, "osD^", EQUATIONS.items(), strict=True):
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


@figure(
    "sweep",
    unless={
        "is no sweep over one parameter": lambda table: len(table.axes()) == 1,
        "is a sweep with a single value of the parameter": lambda table: (
            table.rows[table.axes()[0]].nunique() > 1
        ),
        "has no quantity to draw": quantities.quantities_of,
    },
)
def draw_curves(table: Table) -> Figure:
    """Quantities of a sweep over one parameter."""
    shown, name = quantities.quantities_of(table), table.axes()[0]
    rows = table.rows.sort_values(name, kind="stable")
    x, failed = rows[name].to_numpy(float), ~ended_well(rows).to_numpy()
    title = f"The motion over the {name_of(name)}{quantities.tell_rest(table)}"
    figure, panels = panel_figure(table, title, len(shown), 2.0, 3.0, 1.3, share="x")
    threshold = sleeping_threshold(name, rows)
    crosses = {"color": FAULT, "markersize": 4, "clip_on": False}
    for quantity, axes in zip(shown, panels, strict=True):
        draw_curve(axes, x, quantity, quantity.values(rows), failed)
        if failed.any():
            place = x[failed], np.zeros(failed.sum())
            axes.plot(*place, "x", transform=axes.get_xaxis_transform(), **crosses)
        if threshold:
            axes.axvline(threshold, color=FAINT, linewidth=0.8, linestyle="--")
    quantities.scale_panels(panels, "x", table, name, quantities.has_log_axis(table, name))
    return figure


def sleeping_threshold(name: str, rows: pd.DataFrame) -> float | None:
    """Where on an axis of spins the sleeping top becomes stable, if the table has the ratio."""
    is_spin = name.startswith(("initial.omega3", "initial.spin_ratio"))
    if not is_spin or "sleeping_ratio" not in rows:
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
    if quantities.is_words(values):
        ticks = quantities.draw_class_ticks(axes, values, values[~failed])
        numbers = np.where(failed, np.nan, ticks)
        axes.plot(x, numbers, **style | {"linestyle": "", "marker": "o", "markersize": 3})
        axes.set_ylim(-0.5, len(axes.get_yticks()) - 0.5)
        head(axes, quantity.label)
        return
    numbers, after = quantity.heights(np.where(failed, np.nan, values.to_numpy(float)))
    if quantity.has_log_scale(numbers):
        axes.set_yscale("log")
    elif np.nanmin(numbers) < 0 < np.nanmax(numbers):
        axes.axhline(0, color=FAINT, linewidth=0.8)
    draw_joined(axes, x, numbers, style)
    head(axes, quantity.label, axes.yaxis, quantity.unit, after)


def draw_joined(axes: Axes, x: np.ndarray, y: np.ndarray, style: dict[str, object]) -> None:
    """A curve; of many cases only those that are near to each other are joined, others are dots."""
    if len(x) <= MOST_MARKS:
        axes.plot(x, y, **style)
        return
    heights = np.log(y) if axes.get_yscale() == "log" else y
    # neighbours that differ by more of the range: between them a curve is not known
    far = np.abs(np.diff(heights)) > 0.08 * (np.nanmax(heights) - np.nanmin(heights))
    gaps = np.flatnonzero(far) + 1
    axes.plot(np.insert(x, gaps, np.nan), np.insert(y, gaps, np.nan), **style)
    alone = np.append(True, far) & np.append(far, True)
    dots = {"linestyle": "", "marker": ".", "markersize": 3, "color": style["color"]}
    axes.plot(x[alone], y[alone], **dots)


ROW_HEIGHT, HEADS = 0.215, 4.0
"""Height of a row in inches, and of the heads in rows."""


class Column(NamedTuple):
    """A column of the page: its width in inches, which table column it shows, and its heads."""

    width: float
    column: str
    group: str
    head: str


COLUMNS = (
    Column(0.6, "initial.spin_ratio", "", r"$\lambda$"),
    Column(1.2, "delta_u_fast_top", r"range $\Delta u$ of $\cos\theta$", "paper, Eq 29"),
    Column(1.2, "delta_u", r"range $\Delta u$ of $\cos\theta$", "exact"),
    Column(1.2, "nutation_rate_fast_top", "nutation rate (rad/s)", "paper, Eq 30"),
    Column(1.05, "nutation_rate", "nutation rate (rad/s)", "exact"),
    Column(1.2, "precession_rate_fast_top", "precession rate (rad/s)", "paper, Eq 32"),
    Column(1.05, "precession_rate", "precession rate (rad/s)", "exact"),
    Column(1.2, "nutations_per_turn_fast_top", "nutations per turn", "paper, Eq 54"),
    Column(1.05, "nutations_per_turn", "nutations per turn", "exact"),
    Column(1.4, "azimuth_after_period_deg", "azimuth after\n$T_p$ (degrees)", "this run"),
    Column(1.1, "phi_rate_max", "largest\n$\\dot\\phi$ (rad/s)", "exact"),
    Column(1.25, "fast_top_ratio", "$(I_3\\omega_3)^2$ over\n$2I_1mgl$", "large: fast"),
)
RIGHT_EDGES = dict(zip(COLUMNS, itertools.accumulate(c.width for c in COLUMNS), strict=True))
PAGE_WIDTH = sum(column.width for column in COLUMNS) + 0.1
LEAST, LARGEST = 1e-6, 1e6
"""A column with smaller or larger numbers has powers of ten."""


@figure(
    "sweep",
    " ".join(column.column for column in COLUMNS),
    unless={
        "is not a sweep over initial.spin_ratio alone": lambda table: (
            table.axes() == ["initial.spin_ratio"]
        ),
        "has more rows than fit on a page (60)": lambda table: len(table.rows) <= 60,
    },
    sparse=True,
    assumes=LAGRANGE,
)
def draw_table1(table: Table) -> Figure:
    """The same as a page, where the spin ratio is swept (Table 1)."""
    legend = "paper: its formula for a fast top; exact: closed form of the whole motion; "
    legend += f"this run: {describe_run(table)} (a full turn, 360, by Eq 32)."
    notes = [legend, *notes_on(table.rows)]
    notes = [line for note in notes for line in textwrap.wrap(note, 160)]
    bottom = HEADS + 0.4 + len(table.rows)
    lines = bottom + 0.5 + len(notes)
    title = f"Table 1 with {name_inertia(table)}: fast-top formulas and exact solution"
    figure = new_figure(table, title, lines * ROW_HEIGHT + 1.2, PAGE_WIDTH)
    axes = no_axis(figure.subplots())
    axes.set(xlim=(0, PAGE_WIDTH), ylim=(lines, 0))
    axes.axhline(0.2, color=INK, linewidth=1.2)
    for group, members in itertools.groupby(COLUMNS, key=lambda column: column.group):
        edges = [RIGHT_EDGES[column] for column in members]
        left, right = edges[0] - 0.85, edges[-1]
        axes.text((left + right) / 2, 1.4, group, ha="center", va="center")
        if len(edges) > 1:
            axes.plot([left, right], [2.4, 2.4], color=INK, linewidth=0.6)
    for column in COLUMNS:
        axes.text(RIGHT_EDGES[column], 3.2, column.head, ha="right", va="center")
    axes.axhline(HEADS, color=INK, linewidth=0.8)
    failed = ~ended_well(table.rows).to_numpy()
    for column in COLUMNS:
        write_column(axes, column, table.column(column.column), failed)
    axes.axhline(bottom, color=INK, linewidth=1.2)
    for number, note in enumerate(notes):
        style = {"va": "center", "parse_math": False, "fontsize": "small"}
        axes.text(0.1, bottom + 0.8 + number, note, **style)
    return figure


def write_column(axes: Axes, column: Column, values: np.ndarray, failed: np.ndarray) -> None:
    """The cells of a column below each other, on their decimal points; a failed case is grey."""
    is_first = column is COLUMNS[0]
    texts = [write(value) for value in values] if is_first else as_column(values)
    point = "," if COMMA.get() else "."
    behind = [len(text.partition(point)[2]) + 0.5 * (point in text) for text in texts]
    for number, (text, is_failed) in enumerate(zip(texts, failed, strict=True)):
        room = 0.0883 * (max(behind) - behind[number]) if text != DASH else 0.0
        place = RIGHT_EDGES[column] - room, HEADS + 0.7 + number
        style = {"va": "center_baseline", "color": GREY if is_failed else INK}
        axes.text(*place, text, ha="right", **style, in_layout=False)
        if is_first and is_failed:
            axes.text(RIGHT_EDGES[column] + 0.02, place[1], "*", **style, in_layout=False)


def as_column(values: np.ndarray) -> list[str]:
    """Numbers with five significant digits in one notation; a dash where there is no value."""
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    is_fixed = not sizes.size or (sizes.min() >= LEAST and sizes.max() < LARGEST)
    return [as_text(value, is_fixed) for value in values]


def as_text(value: float, is_fixed: bool = True) -> str:
    """Five significant digits, with or without a power of ten."""
    if not math.isfinite(value):
        return DASH
    if is_fixed:
        decimals = 4 - math.floor(math.log10(abs(value))) if value else 0
        return localised(f"{value:.{max(decimals, 0)}f}")
    mantissa, exponent = f"{value:.4e}".split("e")
    return with_power(mantissa, int(exponent))


def name_inertia(table: Table) -> str:
    """Whose inertia the wheel has: that of its body, or less than any body has about the pivot.

    The paper's author left out the term m l^2 of the centre of mass.
    """
    if table.setting("top.shape") != "inertia":
        return "the inertia of the wheel about the pivot"
    mass, transverse = (float(table.setting(f"top.{key}") or 0) for key in ("mass", "inertia"))
    place = map(float, table.settings.get("top.centre_of_mass", []))
    arm = float(table.setting("top.length") or 0) or math.hypot(*place)
    if table.setting("top.inertia_about") == "pivot" and transverse < mass * arm**2:
        return "the inertia of the paper's author (without m l\N{SUPERSCRIPT TWO})"
    return "the inertia of the input"


def notes_on(rows: pd.DataFrame) -> list[str]:
    """What the marks of the page mean, each reason once."""
    reasons = rows["notes"] if "notes" in rows else rows["status"].map(lambda _: "")
    notes = []
    for (status, reason), cases in rows.groupby([rows["status"], reasons], sort=False):
        mark, words = ("", []) if is_good_end(status) else ("* ", [name_of(status)])
        words += [reason] if reason else []
        if words:
            ratios = ", ".join(write(ratio) for ratio in cases[COLUMNS[0].column])
            notes.append(f"{mark}λ = {ratios}: {': '.join(words)}")
    return notes
