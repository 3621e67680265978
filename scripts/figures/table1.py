"""The paper's Table 1 as a page: formulas for a fast top, exact values, the run's azimuth."""

import math
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


class Column(NamedTuple):
    """A column of the page: its place from the left (its right edge, inches) and its heads."""

    right: float
    column: str
    group: str
    head: str


COLUMNS = (
    Column(0.75, "initial.spin_ratio", "", r"$\lambda$"),
    Column(1.85, "delta_u_fast_top", r"swing $\Delta u$ of $\cos\theta$", "paper, Eq 29"),
    Column(2.75, "delta_u", r"swing $\Delta u$ of $\cos\theta$", "exact"),
    Column(3.85, "nutation_rate_fast_top", "nutation rate (rad/s)", "paper, Eq 30"),
    Column(4.70, "nutation_rate", "nutation rate (rad/s)", "exact"),
    Column(5.80, "precession_rate_fast_top", "precession rate (rad/s)", "paper, Eq 32"),
    Column(6.65, "precession_rate", "precession rate (rad/s)", "exact"),
    Column(7.75, "nutations_per_turn_fast_top", "nutations per turn", "paper, Eq 54"),
    Column(8.60, "nutations_per_turn", "nutations per turn", "exact"),
    Column(9.70, "azimuth_after_period_deg", "azimuth\nafter $T_p$ (degrees)", "this run"),
    Column(10.65, "phi_rate_max", "largest\n$\\dot\\phi$ (rad/s)", "exact"),
    Column(11.65, "fast_top_ratio", "$(I_3\\omega_3)^2$\n/$(2I_1mgl)$", "exact"),
)
PAGE_WIDTH = 12.0


def draw_table1(table: Table) -> Figure:
    """The page."""
    notes = notes_on(table.rows)
    lines = len(table.rows) + len(notes) + 6
    figure = new_figure(
        table,
        "Table 1: formulas for a fast top beside the exact motion",
        height=lines * ROW_HEIGHT + 1.1,
        width=PAGE_WIDTH,
    )
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set(xlim=(0, PAGE_WIDTH), ylim=(lines, 0))
    write_heads(axes)
    for number, (_, row) in enumerate(table.rows.iterrows()):
        write_row(axes, 4.5 + number, row)
    bottom = 4.0 + len(table.rows)
    axes.axhline(bottom, color="black", linewidth=1.2)
    for number, note in enumerate(notes):
        axes.text(0.1, bottom + 0.8 + number, note, va="center", parse_math=False, fontsize=9)
    return figure


def write_heads(axes: Axes) -> None:
    """Two lines of heads between rules; a group's head stands over its columns."""
    axes.axhline(0.2, color="black", linewidth=1.2)
    for group in dict.fromkeys(column.group for column in COLUMNS):
        members = [column for column in COLUMNS if column.group == group]
        right = members[-1].right
        left = members[0].right - 0.85
        axes.text((left + right) / 2, 1.4, group, ha="center", va="center")
        if len(members) > 1:
            axes.plot([left, right], [2.4, 2.4], color="black", linewidth=0.6)
    for column in COLUMNS:
        axes.text(column.right, 3.2, column.head, ha="right", va="center")
    axes.axhline(4.0, color="black", linewidth=0.8)


def write_row(axes: Axes, height: float, row: pd.Series) -> None:
    """The cells of a case; one that failed is grey, and marked."""
    failed = row["status"] != "ok"
    for column in COLUMNS:
        text = as_text(row[column.column])
        if column is COLUMNS[0]:
            text = f"{row[column.column]:g}" + ("*" if failed else "")
        axes.text(
            column.right, height, text, ha="right", va="center", color=GREY if failed else "black"
        )


def as_text(value: float) -> str:
    """Five significant digits; a dash where there is no value."""
    if not math.isfinite(value):
        return "–"
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        decimals = 4 - math.floor(math.log10(abs(value))) if value else 0
        return f"{value:.{max(decimals, 0)}f}".replace("-", "−")
    mantissa, exponent = f"{value:.4e}".split("e")
    return rf"${mantissa}\cdot 10^{{{int(exponent)}}}$"


def notes_on(rows: pd.DataFrame) -> list[str]:
    """What the marks of the page mean, each reason once."""
    notes = []
    failed = rows[rows["status"] != "ok"]
    for status, cases in failed.groupby("status", sort=False):
        notes.append(f"* {status}: λ = {', '.join(f'{x:g}' for x in cases[COLUMNS[0].column])}")
    reasons = rows["notes"] if "notes" in rows else pd.Series(dtype=str)
    for reason, cases in rows.groupby(reasons, sort=False):
        if reason:
            notes.append(f"λ = {', '.join(f'{x:g}' for x in cases[COLUMNS[0].column])}: {reason}")
    return notes
