"""The paper's Table 1 as a page: formulas for a fast top, exact values, the run's azimuth."""

import itertools
import math
import textwrap
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import LAGRANGE
from spintop_figures.style.look import GREY, INK
from spintop_figures.style.numbers import COMMA, DASH, localised, with_power, write
from spintop_figures.style.page import new_figure, no_axis
from spintop_figures.style.provenance import describe_run
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import ended_well, is_good_end

MOST_ROWS = 60
"""Longer tables make no page."""

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

LEGEND = (
    "paper: its formula for a fast top; exact: closed form of the whole motion; this run: {run} "
    "(a full turn, 360, by Eq 32)."
)


def object_to_table1(table: Table) -> str:
    """The page is for a sweep over the spin ratio that fits on it."""
    if table.axes() != ["initial.spin_ratio"]:
        return "is not a sweep over initial.spin_ratio alone"
    fits = len(table.rows) <= MOST_ROWS
    return "" if fits else f"has more rows than fit on a page ({MOST_ROWS})"


@figure(
    "sweep",
    " ".join(column.column for column in COLUMNS),
    objection=object_to_table1,
    sparse=True,
    assumes=LAGRANGE,
)
def draw_table1(table: Table) -> Figure:
    """The same as a page, where the spin ratio is swept (Table 1)."""
    notes = [LEGEND.format(run=describe_run(table)), *notes_on(table.rows)]
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
    place = [float(text) for text in table.settings.get("top.centre_of_mass", [])]
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
