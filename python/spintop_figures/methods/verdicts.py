"""The picture of a stability study: methods down, hard cases across, what each is worth."""

import math
import string
import textwrap
from typing import NamedTuple

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from spintop_figures.methods.known import families
from spintop_figures.methods.trials import (
    NO_TRIAL,
    VERDICTS,
    Verdict,
    cases_by_reference,
    trials,
)
from spintop_figures.style.look import GREY, WIDTH
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

CELL = 0.158
"""Side of a cell in inches; lengths below are in cells."""

LETTER = 0.38
"""Width of a letter of a label."""

BAR = 3.4
"""Length of a bar of counts."""

HEAD = 1.0
"""Height of a family's name above its methods."""

GAP = 0.7
"""Between cases with different references, and between the matrix and the bars."""

LINE = 1.15
"""Distance of the lines of the legend."""

DIGITS, WORDS = 6.8, 7.5
"""Sizes of what stands in cells, and of labels, in points."""

MOST_DIGITS = 16
"""What double precision holds."""


class Layout(NamedTuple):
    """Where the cases stand from left to right, and the methods from top to bottom."""

    x: dict[str, float]
    y: dict[str, float]
    references: dict[str, list[str]]
    families: dict[str, list[str]]
    width: float
    height: float


def draw_verdicts(table: Table) -> Figure:
    """Verdict and digits of every method on every case, counts at the edges, and a legend."""
    rows = trials(table)
    layout = lay_out(rows)
    letters = letters_of(rows)
    legend = legend_lines(table, rows, letters)
    left = LETTER * max(map(len, layout.y)) + 0.6
    top = BAR + GAP + 1.6
    right = layout.width + GAP + BAR + 1.6
    bottom = layout.height + LETTER * max(map(len, layout.x)) + 1.2
    end = bottom + LINE * (len(legend) + 0.5)
    width = max(WIDTH, CELL * (left + right) + 0.2)
    figure = new_figure(
        table, "Verdicts on the methods in hard cases", 0.8 + CELL * (top + end), width
    )
    axes = figure.add_subplot()
    axes.set(xlim=(-left, max(right, width / CELL - left - 1)), ylim=(end, -top))
    axes.set_aspect("equal", anchor="NW")
    axes.axis("off")
    for row in rows.itertuples():
        draw_cell(
            axes,
            layout.x[row.case],
            layout.y[row.entry],
            VERDICTS[row.verdict],
            mark_of(row, letters),
        )
    draw_labels(axes, layout)
    draw_counts(axes, rows, layout)
    draw_legend(axes, legend, -left + 0.2, bottom)
    return figure


def lay_out(rows: pd.DataFrame) -> Layout:
    """Cases by reference, else in the order of the table; methods by family."""
    x: dict[str, float] = {}
    width = 0.0
    references = cases_by_reference(rows)
    for cases in references.values():
        width += GAP if x else 0
        for case in cases:
            x[case] = width
            width += 1
    y: dict[str, float] = {}
    groups: dict[str, list[str]] = {}
    height = 0.0
    for family in families():
        entries = list(rows.loc[rows["family"] == family, "entry"].unique())
        if not entries:
            continue
        groups[family] = entries
        height += HEAD
        for entry in entries:
            y[entry] = height
            height += 1
    return Layout(x, y, references, groups, width, height)


def letters_of(rows: pd.DataFrame) -> dict[str, str]:
    """A letter for each status of the failed trials: its first letter that is not used."""
    letters: dict[str, str] = {}
    for status in rows.loc[rows["verdict"] == "failed", "status"].value_counts().index:
        free = (letter for letter in status.upper() + string.ascii_uppercase if letter.isalpha())
        letters[status] = next(letter for letter in free if letter not in letters.values())
    return letters


def mark_of(row: object, letters: dict[str, str]) -> str:
    """What stands in the cell of a trial."""
    return VERDICTS[row.verdict].mark.format(
        digits=digits_of(row.orientation_error), why=letters.get(row.status, "")
    )


def digits_of(error: float) -> int:
    """Digits that an error in radians leaves."""
    return min(MOST_DIGITS, max(0, math.floor(-math.log10(error)))) if error > 0 else MOST_DIGITS


def draw_cell(axes: Axes, x: float, y: float, verdict: Verdict, mark: str) -> None:
    """A cell with its upper left corner at x, y."""
    edge = "0.85" if verdict.name in NO_TRIAL else "white"
    axes.add_patch(Rectangle((x + 0.03, y + 0.03), 0.94, 0.94, fc=verdict.face, ec=edge, lw=0.5))
    style = {"color": verdict.ink, "fontsize": DIGITS, "ha": "center", "va": "center_baseline"}
    axes.text(x + 0.5, y + 0.5, mark, **style, in_layout=False)


def draw_labels(axes: Axes, layout: Layout) -> None:
    """Names of methods, families, cases and references."""
    for entry, y in layout.y.items():
        axes.text(-0.25, y + 0.5, entry, ha="right", va="center", fontsize=WORDS)
    for family, entries in layout.families.items():
        y = layout.y[entries[0]] - 0.12
        axes.text(0, y, family, va="bottom", fontsize=WORDS, color=GREY, fontstyle="italic")
    for case, x in layout.x.items():
        axes.text(
            x + 0.5,
            layout.height + 0.25,
            name_of(case),
            ha="center",
            va="top",
            rotation=90,
            fontsize=WORDS,
        )
    for reference, cases in layout.references.items():
        begin, end = layout.x[cases[0]], layout.x[cases[-1]] + 1
        y = -BAR - GAP - 0.2
        axes.plot([begin, end], [y, y], color=GREY, linewidth=0.8)
        name = textwrap.fill(f"against {reference}", max(10, int((end - begin) / LETTER)))
        axes.text(
            (begin + end) / 2, y - 0.2, name, ha="center", va="bottom", fontsize=WORDS, color=GREY
        )


def draw_counts(axes: Axes, rows: pd.DataFrame, layout: Layout) -> None:
    """Bars with the shares of the verdicts, beside the methods and above the cases."""
    x = layout.width + GAP
    style = {"fontsize": WORDS, "color": "black"}
    for entry, place in layout.y.items():
        counts, done = count(rows[rows["entry"] == entry])
        for begin, share, verdict in counts:
            axes.add_patch(bar(x + BAR * begin, place + 0.15, BAR * share, 0.7, verdict))
        axes.text(x + BAR + 0.2, place + 0.5, done, va="center", **style)
    for case, place in layout.x.items():
        counts, done = count(rows[rows["case"] == case])
        for begin, share, verdict in counts:
            side = -BAR * (begin + share)
            axes.add_patch(bar(place + 0.15, side, 0.7, BAR * share, verdict))
    axes.text(x, 0.1, "accurate of\nthose tried", va="bottom", fontsize=WORDS, color=GREY)
    axes.text(
        -0.25,
        -BAR / 2,
        "verdicts on\neach case",
        ha="right",
        va="center",
        fontsize=WORDS,
        color=GREY,
    )


def count(rows: pd.DataFrame) -> tuple[list[tuple[float, float, Verdict]], str]:
    """Begins and shares of the verdicts, and how many are accurate of those that had a trial."""
    number = rows["verdict"].value_counts()
    tried = len(rows) - sum(number.get(name, 0) for name in NO_TRIAL)
    begin, shares = 0.0, []
    for verdict in VERDICTS.values():
        if verdict.name in NO_TRIAL or verdict.name not in number:
            continue
        share = number[verdict.name] / tried
        shares.append((begin, share, verdict))
        begin += share
    return shares, f"{number.get('accurate', 0)}/{tried}"


def bar(x: float, y: float, width: float, height: float, verdict: Verdict) -> Rectangle:
    """A part of a bar."""
    return Rectangle((x, y), width, height, fc=verdict.face, ec="white", lw=0.5)


def legend_lines(
    table: Table, rows: pd.DataFrame, letters: dict[str, str]
) -> list[tuple[Verdict | None, str, str]]:
    """Verdict, mark and text of each line."""
    lines: list[tuple[Verdict | None, str, str]] = []
    for verdict in VERDICTS.values():
        number = int((rows["verdict"] == verdict.name).sum())
        if verdict.name == "no_reference" and not number:
            continue
        meaning = table.header.get(f"verdict {verdict.name}", "")
        text = f"{name_of(verdict.name)} ({write_count(number)})" + (
            f": {meaning}" if meaning else ""
        )
        if verdict.name != "failed":
            lines.append((verdict, verdict.mark.format(digits="n", why=""), text))
            continue
        lines.append((verdict, "", text))
        for status, letter in letters.items():
            chosen = rows[(rows["verdict"] == "failed") & (rows["status"] == status)]
            reason = chosen["reason"].iloc[0].rpartition(": ")[2]
            lines.append(
                (verdict, letter, f"{write_count(len(chosen))} by {name_of(status)}: {reason}")
            )
    if empty := rows["case"].nunique() * rows["entry"].nunique() - len(rows):
        lines.append((None, "", f"empty ({empty}): not tried"))
    lines.append((None, "", "n: digits, for a largest error of the attitude of 10\u207b\u207f rad"))
    return lines


def draw_legend(
    axes: Axes, lines: list[tuple[Verdict | None, str, str]], x: float, y: float
) -> None:
    """What the cells mean."""
    for number, (verdict, mark, text) in enumerate(lines):
        place = y + LINE * number
        indent = 1.4 if mark.isalpha() and verdict and verdict.name == "failed" else 0
        if verdict:
            draw_cell(axes, x + indent, place, verdict, mark)
        axes.text(x + indent + 1.4, place + 0.5, text, va="center", fontsize=WORDS)
