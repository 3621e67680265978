"""A stability study: what each method is worth on each hard case, and what it costs."""

import math
import string
import textwrap
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.kinds import figure
from spintop_figures.methods.known import Look, families, family_of, ink_of, look_of
from spintop_figures.style.axes import name_axis
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, INK, OURS, WIDTH, by_width
from spintop_figures.style.numbers import DASH, TIMES, write_count
from spintop_figures.style.page import new_figure, no_axis
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table


class Verdict(NamedTuple):
    """A verdict: the colour of its cells, the colour and the form of what stands in them."""

    name: str
    face: str
    ink: str
    mark: str
    """What stands in a cell; `{digits}` are those reached, `{why}` the letter of the status."""


VERDICTS = {
    verdict.name: verdict
    for verdict in (
        Verdict("accurate", f"{OURS}band", INK, "{digits}"),
        Verdict("drifts", f"{OURS}area1", "black", "~{digits}"),
        Verdict("wrong", FAULT, GROUND, TIMES),
        Verdict("failed", f"{OURS}failed", GROUND, "{why}"),
        Verdict("unsuitable", GROUND, GREY, DASH),
        Verdict("no_reference", GROUND, GREY, "?"),
    )
}
"""From best to worst. They darken step by step, for print without colours."""

NO_TRIAL = ("unsuitable", "no_reference")
"""The verdicts without a trial."""

STABILITY = {
    "kind": "stability",
    "words": "case method formulation verdict status reference reason",
}
"""What figures of a stability study ask."""


def trials(table: Table) -> pd.DataFrame:
    """The rows with the columns `entry`, which names method and formulation, and `family`.

    A method that is tried once a case takes the formulation that suits the body, which its entry
    leaves out; of one that is tried several times the entries name what distinguishes them.
    """
    rows = table.rows.copy()
    place = rows.groupby(["case", "method"]).cumcount()
    key = [rows["method"], place]
    suited = rows["formulation"].where(~rows["verdict"].isin(NO_TRIAL))
    forms = suited.groupby(key).transform(lambda names: ", ".join(names.dropna().unique()))
    forms = forms.where(forms != "", rows["formulation"])
    several = place.groupby(rows["method"]).transform("max") > 0
    named = several & ~forms.str.contains(",")
    names, forms = rows["method"].map(name_of), forms.map(name_of)
    rows["entry"] = names.where(~named, names + ", " + forms)
    rows["family"] = rows["method"].map(family_of)
    return rows


def cases_by_reference(rows: pd.DataFrame) -> dict[str, list[str]]:
    """The cases by what they are compared with, else in the order of the table."""
    groups = rows.groupby("reference", sort=False)["case"]
    return {str(reference): list(cases.unique()) for reference, cases in groups}


def entries_by_family(rows: pd.DataFrame) -> dict[str, list[str]]:
    """The methods by family, in the order of the registry."""
    found = {name: list(rows.loc[rows["family"] == name, "entry"].unique()) for name in families()}
    return {family: entries for family, entries in found.items() if entries}


def object_to_trials(table: Table) -> str:
    """A verdict has to be known, and a trial to be there once."""
    if unknown := [name for name in table.rows["verdict"].unique() if name not in VERDICTS]:
        return f"has the unknown verdict {unknown[0]!r}"
    rows = trials(table)
    twice = rows[rows.duplicated(["case", "entry"])]
    return "" if twice.empty else f"tries {twice['entry'].iloc[0]} twice on {twice['case'].iloc[0]}"


CELL = 0.158
"""Side of a cell in inches; lengths below are in cells."""

LETTER = 0.38
"""Width of a letter of a label."""

BAR = 3.4
"""Length of a bar of counts."""

HEAD, GAP, LINE = 1.0, 0.7, 1.15
"""Height of a family's name above its methods, distance of cases with different references and of
the matrix and the bars, and of the lines of the legend."""

SMALL = "x-small"
"""Of what stands in cells, and of labels."""


class Layout(NamedTuple):
    """Where the cases stand from left to right, and the methods from top to bottom."""

    x: dict[str, float]
    y: dict[str, float]
    references: dict[str, list[str]]
    families: dict[str, list[str]]
    width: float
    height: float


@figure(needs="orientation_error", objection=object_to_trials, **STABILITY)
def draw_verdicts(table: Table) -> Figure:
    """Verdict and digits of each method on each hard case.

    Verdict and digits of every method on every case, counts at the edges, and a legend.
    """
    rows = trials(table)
    layout, letters = lay_out(rows), letters_of(rows)
    legend = legend_lines(table, rows, letters)
    left = LETTER * max(map(len, layout.y)) + 0.6
    top, right = BAR + GAP + 1.6, layout.width + GAP + BAR + 1.6
    bottom = layout.height + LETTER * max(map(len, layout.x)) + 1.2
    end = bottom + LINE * (len(legend) + 0.5)
    width = max(WIDTH, CELL * (left + right) + 0.2)
    title = "Verdicts on the methods in hard cases"
    figure = new_figure(table, title, 0.8 + CELL * (top + end), width)
    axes = no_axis(figure.add_subplot())
    axes.set(xlim=(-left, max(right, width / CELL - left - 1)), ylim=(end, -top))
    axes.set_aspect("equal", anchor="NW")
    for row in rows.itertuples():
        verdict, place = VERDICTS[row.verdict], (layout.x[row.case], layout.y[row.entry])
        why = letters.get(row.status, "")
        mark = verdict.mark.format(digits=digits_of(row.orientation_error), why=why)
        draw_cell(axes, *place, verdict, mark)
    draw_labels(axes, layout)
    draw_counts(axes, rows, layout)
    for number, (verdict, mark, text) in enumerate(legend):
        x, y = 0.2 - left, bottom + LINE * number
        x += 1.4 if mark.isalpha() and verdict and verdict.name == "failed" else 0
        if verdict:
            draw_cell(axes, x, y, verdict, mark)
        axes.text(x + 1.4, y + 0.5, text, va="center", fontsize=SMALL)
    return figure


def lay_out(rows: pd.DataFrame) -> Layout:
    """Cases by reference, else in the order of the table; methods by family."""
    x: dict[str, float] = {}
    y: dict[str, float] = {}
    width = height = 0.0
    references, groups = cases_by_reference(rows), entries_by_family(rows)
    for cases in references.values():
        width += GAP if x else 0
        x |= {case: width + number for number, case in enumerate(cases)}
        width += len(cases)
    for entries in groups.values():
        height += HEAD
        y |= {entry: height + number for number, entry in enumerate(entries)}
        height += len(entries)
    return Layout(x, y, references, groups, width, height)


def letters_of(rows: pd.DataFrame) -> dict[str, str]:
    """A letter for each status of the failed trials: its first letter that is not used."""
    letters: dict[str, str] = {}
    for status in rows.loc[rows["verdict"] == "failed", "status"].value_counts().index:
        free = (letter for letter in status.upper() + string.ascii_uppercase if letter.isalpha())
        letters[status] = next(letter for letter in free if letter not in letters.values())
    return letters


def digits_of(error: float) -> int:
    """Digits that an error in radians leaves."""
    # double precision holds no more
    return min(16, max(0, math.floor(-math.log10(error)))) if error > 0 else 16


def draw_cell(axes: Axes, x: float, y: float, verdict: Verdict, mark: str) -> None:
    """A cell with its upper left corner at x, y."""
    edge = FAINT if verdict.name in NO_TRIAL else GROUND
    axes.add_patch(Rectangle((x + 0.03, y + 0.03), 0.94, 0.94, fc=verdict.face, ec=edge, lw=0.5))
    style = {"color": verdict.ink, "fontsize": SMALL, "ha": "center", "va": "center_baseline"}
    axes.text(x + 0.5, y + 0.5, mark, **style, in_layout=False)


def draw_labels(axes: Axes, layout: Layout) -> None:
    """Names of methods, families, cases and references."""
    small, grey = {"fontsize": SMALL}, {"fontsize": SMALL, "color": GREY, "va": "bottom"}
    for entry, y in layout.y.items():
        axes.text(-0.25, y + 0.5, entry, ha="right", va="center", **small)
    for family, entries in layout.families.items():
        axes.text(0, layout.y[entries[0]] - 0.12, family, fontstyle="italic", **grey)
    for case, x in layout.x.items():
        style = {"ha": "center", "va": "top", "rotation": 90}
        axes.text(x + 0.5, layout.height + 0.25, name_of(case), **style, **small)
    for reference, cases in layout.references.items():
        begin, end = layout.x[cases[0]], layout.x[cases[-1]] + 1
        y = -BAR - GAP - 0.2
        axes.plot([begin, end], [y, y], color=GREY, linewidth=0.8)
        name = textwrap.fill(f"against {reference}", max(10, int((end - begin) / LETTER)))
        axes.text((begin + end) / 2, y - 0.2, name, ha="center", **grey)


def draw_counts(axes: Axes, rows: pd.DataFrame, layout: Layout) -> None:
    """Bars with the shares of the verdicts, beside the methods and above the cases."""
    x = layout.width + GAP
    for entry, place in layout.y.items():
        counts, done = count(rows[rows["entry"] == entry])
        for begin, share, verdict in counts:
            add_bar(axes, x + BAR * begin, place + 0.15, BAR * share, 0.7, verdict)
        axes.text(x + BAR + 0.2, place + 0.5, done, va="center", fontsize=SMALL)
    for case, place in layout.x.items():
        for begin, share, verdict in count(rows[rows["case"] == case])[0]:
            add_bar(axes, place + 0.15, -BAR * (begin + share), 0.7, BAR * share, verdict)
    style = {"fontsize": SMALL, "color": GREY}
    axes.text(x, 0.1, "accurate of\nthose tried", va="bottom", **style)
    axes.text(-0.25, -BAR / 2, "verdicts on\neach case", ha="right", va="center", **style)


def count(rows: pd.DataFrame) -> tuple[list[tuple[float, float, Verdict]], str]:
    """Begins and shares of the verdicts, and how many are accurate of those that had a trial."""
    number = rows["verdict"].value_counts()
    tried = len(rows) - sum(number.get(name, 0) for name in NO_TRIAL)
    begin, shares = 0.0, []
    for verdict in VERDICTS.values():
        if verdict.name not in NO_TRIAL and verdict.name in number:
            share = number[verdict.name] / tried
            shares.append((begin, share, verdict))
            begin += share
    return shares, f"{number.get('accurate', 0)}/{tried}"


def add_bar(axes: Axes, x: float, y: float, width: float, height: float, verdict: Verdict) -> None:
    """A part of a bar."""
    axes.add_patch(Rectangle((x, y), width, height, fc=verdict.face, ec=GROUND, lw=0.5))


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
        text = ": ".join(
            filter(None, (f"{name_of(verdict.name)} ({write_count(number)})", meaning))
        )
        lines.append((verdict, verdict.mark.format(digits="n", why=""), text))
        for status, letter in letters.items() if verdict.name == "failed" else ():
            chosen = rows[(rows["verdict"] == "failed") & (rows["status"] == status)]
            reason = chosen["reason"].iloc[0].rpartition(": ")[2]
            text = f"{write_count(len(chosen))} by {name_of(status)}: {reason}"
            lines.append((verdict, letter, text))
    if empty := rows["case"].nunique() * rows["entry"].nunique() - len(rows):
        lines.append((None, "", f"empty ({empty}): not tried"))
    lines.append((None, "", "n: digits, for a largest error of the attitude of 10\u207b\u207f rad"))
    return lines


FACES = {"accurate": 1.0, "drifts": 0.35, "wrong": 0.0}
"""How full the marker of a verdict is; the other verdicts have none."""

NAMES = {"accurate": "full: accurate", "drifts": "pale: drifts", "wrong": "empty: wrong"}

RATIO = "ratio"
"""Evaluations over those of the cheapest accurate method of the case."""

MEDIAN = {"color": INK, "linestyle": "", "marker": "|", "markersize": 11, "markeredgewidth": 1.6}


def object_to_costs(table: Table) -> str:
    """The trials have to be known, and one to have gone to its end."""
    lacks = judged(table.rows).empty
    return object_to_trials(table) or ("has no trial that went to its end" if lacks else "")


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """The trials that went to their end, at some cost."""
    return rows[rows["verdict"].isin(FACES) & (rows["evaluations"] > 0)]


def with_ratio(rows: pd.DataFrame) -> pd.DataFrame:
    """The trials with their costs over that of the cheapest accurate method of their case.

    A case without one is measured by its cheapest trial.
    """
    known = rows["evaluations"].where(rows["verdict"] == "accurate")
    least = known.groupby(rows["case"]).transform("min")
    least = least.fillna(rows.groupby("case")["evaluations"].transform("min"))
    return rows.assign(**{RATIO: rows["evaluations"] / least})


@figure(
    needs="orientation_error evaluations inherent_error", objection=object_to_costs, **STABILITY
)
def draw_costs(table: Table) -> Figure:
    """Cost and error of the methods, a line per method and a dot per hard case.

    Two panels over the same methods: their cost, and the error that they reach.
    """
    rows = with_ratio(judged(trials(table)))
    places: dict[str, float] = {}
    for number, entries in enumerate(entries_by_family(rows).values()):
        # families are half a row apart
        places |= {entry: len(places) + i + number * 0.5 for i, entry in enumerate(entries)}
    most = max(places.values())
    height = max(0.2 * (most + 1.5), 1.6)
    title = "What the methods cost and reach: a dot for each of "
    figure = new_figure(table, f"{title}{rows['case'].nunique()} hard cases", 1.7 + height)
    grid = figure.add_gridspec(2, 2, height_ratios=(height, 0.25))
    cost = figure.add_subplot(grid[0, 0])
    error = figure.add_subplot(grid[0, 1], sharey=cost)
    draw_trials(cost, rows, places, rows[RATIO])
    draw_trials(error, rows, places, np.maximum(rows["orientation_error"], 1e-16))
    error.tick_params(labelleft=False)
    error.xaxis.set_major_locator(LogLocator(numticks=by_width(8, 4)))
    good = rows[rows["verdict"] == "accurate"].groupby("entry")[RATIO].median()
    cost.plot(good, good.index.map(places), **MEDIAN, zorder=4)
    cost.set_yticks(list(places.values()), labels=list(places))
    family = rows.groupby("entry")["family"].first()
    for label, entry in zip(cost.get_yticklabels(), places, strict=True):
        label.set_color(ink_of(family[entry]))
    cost.set_ylim(most + 0.75, -0.75)
    cost.axvline(1, color=GREY, linewidth=0.8, zorder=1)
    name_axis(cost.xaxis, "evaluations over those of the cheapest accurate method of the case")
    name_axis(error.xaxis, "largest error of the attitude", "rad")
    add_legend(no_axis(figure.add_subplot(grid[1, :])), rows)
    return figure


def draw_trials(
    axes: Axes, rows: pd.DataFrame, places: dict[str, float], values: pd.Series
) -> None:
    """The trials as dots on the lines of their methods, on a log axis."""
    axes.set_xscale("log")
    for place in places.values():
        axes.axhline(place, color=FAINT, linewidth=0.5, zorder=0)
    for (family, verdict), part in rows.groupby(["family", "verdict"]):
        heights = part["entry"].map(places)
        axes.plot(values[part.index], heights, **marker(look_of(family), FACES[verdict]))
    axes.xaxis.set_major_locator(LogLocator(numticks=7))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="y", length=0)


def marker(look: Look, fullness: float) -> dict[str, object]:
    """How a family is marked."""
    return {
        "linestyle": "",
        "marker": look.marker,
        "markersize": 4.5 * look.size,
        "markerfacecolor": (look.colour, fullness),
        "markeredgecolor": look.colour,
        "markeredgewidth": 0.6,
    }


def add_legend(axes: Axes, rows: pd.DataFrame) -> None:
    """What the markers mean, below the panels."""
    handles = [
        Line2D([], [], label=NAMES[verdict], **marker(Look("o", GREY), fullness))
        for verdict, fullness in FACES.items()
        if (rows["verdict"] == verdict).any()
    ]
    handles.append(Line2D([], [], **MEDIAN, label="median of the accurate"))
    place = {"loc": "center right", "ncols": by_width(4, 2), "borderpad": 0}
    axes.legend(handles=handles, **place).set_in_layout(False)
