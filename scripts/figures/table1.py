"""The paper's Table 1 as a page: formulas for a fast top, exact values, the run's azimuth."""

import itertools
import math
import textwrap
from typing import NamedTuple

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures.style import GREY, new_figure
from figures.table import Table

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
    Column(0.98, "delta_u", r"range $\Delta u$ of $\cos\theta$", "exact"),
    Column(1.2, "nutation_rate_fast_top", "nutation rate (rad/s)", "paper, Eq 30"),
    Column(0.98, "nutation_rate", "nutation rate (rad/s)", "exact"),
    Column(1.2, "precession_rate_fast_top", "precession rate (rad/s)", "paper, Eq 32"),
    Column(0.98, "precession_rate", "precession rate (rad/s)", "exact"),
    Column(1.2, "nutations_per_turn_fast_top", "nutations per turn", "paper, Eq 54"),
    Column(0.98, "nutations_per_turn", "nutations per turn", "exact"),
    Column(1.15, "azimuth_after_period_deg", "azimuth after\n$T_p$ (degrees)", "this run"),
    Column(1.0, "phi_rate_max", "largest\n$\\dot\\phi$ (rad/s)", "exact"),
    Column(1.15, "fast_top_ratio", "$(I_3\\omega_3)^2$ over\n$2I_1mgl$", "large: fast"),
)
RIGHT_EDGES = dict(zip(COLUMNS, itertools.accumulate(c.width for c in COLUMNS), strict=True))
PAGE_WIDTH = sum(column.width for column in COLUMNS) + 0.1
PAGE_LETTERS = 160

LEGEND = (
    "paper: its formula for a fast top; exact: closed form of the whole motion; this run: by "
    "formulation and method below (a full turn, 360, by Eq 32)."
)


def draw_table1(table: Table) -> Figure:
    """The page."""
    notes = [
        line
        for note in (LEGEND, *notes_on(table.rows))
        for line in textwrap.wrap(note, PAGE_LETTERS)
    ]
    bottom = HEADS + 0.4 + len(table.rows)
    lines = bottom + 0.5 + len(notes)
    figure = new_figure(
        table,
        "Table 1: fast-top formulas and exact solution",
        height=lines * ROW_HEIGHT + 1.2,
        width=PAGE_WIDTH,
    )
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set(xlim=(0, PAGE_WIDTH), ylim=(lines, 0))
    write_heads(axes)
    for number, (_, row) in enumerate(table.rows.iterrows()):
        write_row(axes, HEADS + 0.7 + number, row)
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


def write_row(axes: Axes, height: float, row: pd.Series) -> None:
    """The cells of a case; one that failed is grey, and marked."""
    failed = row["status"] != "ok"
    for column in COLUMNS:
        text = as_text(row[column.column])
        if column is COLUMNS[0]:
            text = f"{row[column.column]:g}" + ("*" if failed else "")
        axes.text(
            RIGHT_EDGES[column],
            height,
            text,
            ha="right",
            va="center",
            color=GREY if failed else "black",
        )


def as_text(value: float) -> str:
    """Five significant digits; a dash where there is no value."""
    if not math.isfinite(value):
        return "\N{EN DASH}"
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        decimals = 4 - math.floor(math.log10(abs(value))) if value else 0
        return f"{value:.{max(decimals, 0)}f}".replace("-", "\N{MINUS SIGN}")
    mantissa, exponent = f"{value:.4e}".split("e")
    return rf"${mantissa}\cdot 10^{{{int(exponent)}}}$"


def notes_on(rows: pd.DataFrame) -> list[str]:
    """What the marks of the page mean, each reason once."""
    reasons = rows["notes"] if "notes" in rows else rows["status"].map(lambda _: "")
    notes = []
    for (status, reason), cases in rows.groupby([rows["status"], reasons], sort=False):
        mark, words = ("", []) if status == "ok" else ("* ", [status])
        if reason:
            words.append(reason)
        if words:
            ratios = ", ".join(f"{ratio:g}" for ratio in cases[COLUMNS[0].column])
            notes.append(f"{mark}λ = {ratios}: {': '.join(words)}")
    return notes
