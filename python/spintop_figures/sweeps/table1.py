"""The paper's Table 1 as a page: formulas for a fast top, exact values, the run's azimuth."""

import itertools
import math
import textwrap
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.cells import Cells
from spintop_figures.style.look import GREY
from spintop_figures.style.numbers import DASH, true_minus, with_power, write
from spintop_figures.style.page import new_figure
from spintop_figures.style.provenance import describe_run
from spintop_figures.tables.ends import ended_well, is_good_end
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

MOST_ROWS = 60
"""Longer tables make no page."""

ROW_HEIGHT = 0.215
"""In inches."""

HEADS = 4.0
"""Height of the heads, in rows."""


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
PAGE_LETTERS = 160

LEAST, LARGEST = 1e-6, 1e6
"""A column with smaller or larger numbers has powers of ten."""

POINT = "."

MARK, MARK_WIDTH = "*", 0.08
"""Of a case that failed; the width in inches."""

LEGEND = (
    "paper: its formula for a fast top; exact: closed form of the whole motion; this run: {run} "
    "(a full turn, 360, by Eq 32)."
)


def draw_table1(table: Table) -> Figure:
    """The page."""
    notes = [
        line
        for note in (LEGEND.format(run=describe_run(table)), *notes_on(table.rows))
        for line in textwrap.wrap(note, PAGE_LETTERS)
    ]
    bottom = HEADS + 0.4 + len(table.rows)
    lines = bottom + 0.5 + len(notes)
    figure = new_figure(
        table,
        f"Table 1 with {name_inertia(table)}: fast-top formulas and exact solution",
        height=lines * ROW_HEIGHT + 1.2,
        width=PAGE_WIDTH,
    )
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set(xlim=(0, PAGE_WIDTH), ylim=(lines, 0))
    write_heads(axes)
    failed = ~ended_well(table.rows).to_numpy()
    cells = Cells()
    for column in COLUMNS:
        write_column(cells, column, table.rows[column.column].to_numpy(float), failed)
    axes.add_artist(cells)
    axes.axhline(bottom, color="black", linewidth=1.2)
    for number, note in enumerate(notes):
        axes.text(0.1, bottom + 0.8 + number, note, va="center", parse_math=False, fontsize=9)
    return figure


def write_heads(axes: Axes) -> None:
    """Two lines of heads between rules; a group's head stands over its columns."""
    axes.axhline(0.2, color="black", linewidth=1.2)
    for group in dict.fromkeys(column.group for column in COLUMNS):
        members = [column for column in COLUMNS if column.group == group]
        right = RIGHT_EDGES[members[-1]]
        left = RIGHT_EDGES[members[0]] - 0.85
        axes.text((left + right) / 2, 1.4, group, ha="center", va="center")
        if len(members) > 1:
            axes.plot([left, right], [2.4, 2.4], color="black", linewidth=0.6)
    for column in COLUMNS:
        axes.text(RIGHT_EDGES[column], 3.2, column.head, ha="right", va="center")
    axes.axhline(HEADS, color="black", linewidth=0.8)


def write_column(cells: Cells, column: Column, values: np.ndarray, failed: np.ndarray) -> None:
    """The cells of a column below each other, on their decimal points; a failed case is grey."""
    is_first = column is COLUMNS[0]
    texts = [write(value) for value in values] if is_first else as_column(values)
    decimals = max(len(text.partition(POINT)[2]) for text in texts)
    for number, (text, is_failed) in enumerate(zip(texts, failed, strict=True)):
        _, point, behind = text.partition(POINT)
        room = "0" * (decimals - len(behind)) + (POINT if decimals and not point else "")
        end = (RIGHT_EDGES[column], HEADS + 0.7 + number)
        cells.write(end, text, "" if text == DASH else room, GREY if is_failed else "black")
        if is_first and is_failed:
            cells.write((end[0] + MARK_WIDTH, end[1]), MARK, "", GREY)


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
        return true_minus(f"{value:.{max(decimals, 0)}f}")
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
        if reason:
            words.append(reason)
        if words:
            ratios = ", ".join(write(ratio) for ratio in cases[COLUMNS[0].column])
            notes.append(f"{mark}λ = {ratios}: {': '.join(words)}")
    return notes
