"""A stability study: what each method is worth on each hard case, and what it costs."""

import math
import string
import textwrap
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from spintop_figures.kinds import figure
from spintop_figures.methods.known import Look, families, ink_of, known, look_of
from spintop_figures.style.axes import few_ticks, name_axis, name_rows
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, INK, OURS, WIDTH, by_width
from spintop_figures.style.numbers import DASH, TIMES, in_print, write_count
from spintop_figures.style.page import new_figure, no_axis
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import say


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
    rows["family"] = [known(method).family for method in rows["method"]]
    return rows


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


CELL, LETTER, LINE, BAR = 0.165, 0.36, 1.2, 3.4
"""Side of a cell in inches; in cells the width of a letter of a label, the height of a line of the
legend, and the length of a bar of counts."""

SMALL = {"fontsize": "x-small"}
"""Of what stands in cells, and of labels."""


def places_of(groups: Iterable[Iterable[str]], apart: float, first: float) -> dict[str, float]:
    """Places of rows or columns from the first one, with so much room between groups."""
    places: dict[str, float] = {}
    for number, names in enumerate(groups):
        for name in names:
            places.setdefault(name, first + len(places) + number * apart)
    return places


@figure(needs="orientation_error", objection=object_to_trials, **STABILITY)
def draw_verdicts(table: Table) -> Figure:
    """Verdict and digits of each method on each hard case.

    Verdict and digits of every method on every case, counts at the edges, and a legend.
    """
    rows = trials(table)
    references, families = rows.groupby("reference", sort=False)["case"], entries_by_family(rows)
    x, y = (places_of(groups, 1, 1) for groups in (references.unique(), families.values()))
    letters = letters_of(rows)
    legend = legend_of(table, rows, letters)
    across, down = max(x.values()) + 0.5, max(y.values()) + 0.5
    beside, below = (LETTER * max(map(len, map(name_of, names))) for names in (y, x))
    page = max(WIDTH / CELL, beside + across + BAR + 5)
    height = 1.2 + CELL * (BAR + 2 + down + below + LINE * len(legend))
    figure = new_figure(table, "Verdicts on the methods in hard cases", height, CELL * page)
    widths = across, page - beside - across - 4
    grid = figure.add_gridspec(3, 2, width_ratios=widths, height_ratios=(BAR, down, 0.01))
    cells = figure.add_subplot(grid[1, 0])
    bars = {
        "case": figure.add_subplot(grid[0, 0], sharex=cells),
        "entry": figure.add_subplot(grid[1, 1], sharey=cells),
    }
    for row in rows.itertuples():
        verdict, place = VERDICTS[row.verdict], (x[row.case], y[row.entry])
        why = letters.get(row.status, "")
        mark = verdict.mark.format(digits=digits_of(row.orientation_error), why=why)
        edge = FAINT if verdict.name in NO_TRIAL else GROUND
        look = {"facecolor": verdict.face, "edgecolor": edge, "linewidth": 0.5}
        cells.add_patch(Rectangle(np.subtract(place, 0.47), 0.94, 0.94, **look))
        style = {"color": verdict.ink, "ha": "center", "va": "center_baseline"}
        cells.text(*place, mark, **style, **SMALL, in_layout=False)
    draw_counts(rows, {"case": x, "entry": y}, bars)
    for panel in (cells, *bars.values()):
        panel.spines[:].set_visible(False)
        panel.tick_params(length=0, labelsize="x-small", labelbottom=panel is cells)
    cells.set_xticks([*x.values()], labels=map(name_of, x), rotation=90)
    heads = [y[entries[0]] - 1 for entries in families.values()]
    cells.set_yticks([*heads, *y.values()], labels=[*families, *y])
    for label in cells.get_yticklabels()[: len(heads)]:
        label.set(style="italic", color=GREY)
    cells.set(xlim=(0.5, across), ylim=(down, -0.5))
    for reference, cases in references:
        ends = x[cases.iloc[0]] - 0.4, x[cases.iloc[-1]] + 0.4
        bars["case"].plot(ends, [1.1, 1.1], color=GREY, linewidth=0.8, clip_on=False)
        name, room = say(f"against {reference}"), int(np.ptp(ends) / LETTER)
        name = textwrap.fill(name, max(10, room))
        style = {"rotation": 90 * (max(map(len, name.split("\n"))) > room), "color": GREY, **SMALL}
        bars["case"].text(np.mean(ends), 1.15, name, ha="center", va="bottom", **style)
    foot = no_axis(figure.add_subplot(grid[2, :]))
    handles, labels = zip(*legend, strict=True)
    foot.legend(handles, labels, loc="upper left", **SMALL, handlelength=1.2, labelspacing=0.4)
    return figure


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


def draw_counts(
    rows: pd.DataFrame, places: dict[str, dict[str, float]], bars: dict[str, Axes]
) -> None:
    """Bars with the shares of the verdicts, above the cases and beside the methods."""
    tried = rows[~rows["verdict"].isin(NO_TRIAL)]
    style = {"edgecolor": GROUND, "linewidth": 0.5}
    for by, axes in bars.items():
        shares = pd.crosstab(tried[by], tried["verdict"], normalize="index")
        there, begin = [places[by][name] for name in shares.index], 0.0
        draw = axes.bar if by == "case" else axes.barh
        for name in filter(shares.columns.__contains__, VERDICTS):
            draw(there, shares[name], 0.7, begin, color=VERDICTS[name].face, **style)
            begin = begin + shares[name]
    for entry, verdicts in tried.groupby("entry")["verdict"]:
        words = f"{(verdicts == 'accurate').sum()}/{len(verdicts)}"
        place, beside = (1, places["entry"][entry]), {"textcoords": "offset points", "va": "center"}
        bars["entry"].annotate(words, place, (3, 0), **beside, **SMALL)
    bars["case"].set_yticks([0.5], labels=["verdicts on\neach case"], color=GREY)
    bars["case"].set_ylim(0, 1)
    bars["entry"].set(xlim=(0, 1), xticks=[])
    bars["entry"].tick_params(labelleft=False)
    bars["entry"].text(0, 0.4, "accurate of\nthose tried", va="bottom", color=GREY, **SMALL)


def legend_of(
    table: Table, rows: pd.DataFrame, letters: dict[str, str]
) -> list[tuple[object, str]]:
    """Handle and text of each line of the legend."""
    lines: list[tuple[object, str]] = []
    for verdict in VERDICTS.values():
        number = int((rows["verdict"] == verdict.name).sum())
        if verdict.name == "no_reference" and not number:
            continue
        meaning = table.header.get(f"verdict {verdict.name}", "")
        words = f"{name_of(verdict.name)} ({write_count(number)})"
        mark = verdict.mark.format(digits="n", why="")
        lines.append((square(verdict, mark), ": ".join(filter(None, (words, in_print(meaning))))))
        for status, letter in letters.items() if verdict.name == "failed" else ():
            chosen = rows[(rows["verdict"] == "failed") & (rows["status"] == status)]
            reason = chosen["reason"].iloc[0].rpartition(": ")[2]
            text = f"{write_count(len(chosen))} {name_of(status)}: {in_print(reason)}"
            lines.append((square(verdict, letter), text))
    nothing = Line2D([], [], linestyle="")
    if empty := rows["case"].nunique() * rows["entry"].nunique() - len(rows):
        lines.append((nothing, f"empty ({empty}): not tried"))
    digits = "n: digits, for a largest error of the attitude of 10\u207b\u207f rad"
    return [*lines, (nothing, digits)]


def square(verdict: Verdict, mark: str) -> tuple[Line2D, ...]:
    """A cell with a mark, as a legend has it."""
    edge = FAINT if verdict.name in NO_TRIAL else GROUND
    looks = {"s": {"markersize": 10, "markerfacecolor": verdict.face, "markeredgecolor": edge}}
    if mark:
        mark = rf"$\mathdefault{{{mark.replace('~', chr(92) + 'sim ')}}}$"
        looks[mark] = {"markersize": 5, "color": verdict.ink, "markeredgewidth": 0}
    return tuple(Line2D([], [], linestyle="", marker=each, **looks[each]) for each in looks)


FACES = {"accurate": 1.0, "drifts": 0.35, "wrong": 0.0}
"""How full the marker of a verdict is; the other verdicts have none."""

MEDIAN = {"color": INK, "linestyle": "", "marker": "|", "markersize": 11, "markeredgewidth": 1.6}


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """The trials that went to their end, at some cost."""
    return rows[rows["verdict"].isin(FACES) & (rows["evaluations"] > 0)]


@figure(
    needs="orientation_error evaluations inherent_error",
    objection=lambda table: (
        object_to_trials(table)
        or ("has no trial that went to its end" if judged(table.rows).empty else "")
    ),
    **STABILITY,
)
def draw_costs(table: Table) -> Figure:
    """Cost and error of the methods, a line per method and a dot per hard case.

    Two panels over the same methods: their cost, and the error that they reach.
    """
    rows = judged(trials(table))
    known = rows["evaluations"].where(rows["verdict"] == "accurate")
    least = known.groupby(rows["case"]).transform("min")
    # a case without an accurate method is measured by its cheapest trial
    least = least.fillna(rows.groupby("case")["evaluations"].transform("min"))
    ratio = rows["evaluations"] / least
    places = places_of(entries_by_family(rows).values(), 0.5, 0)
    most = max(places.values())
    height = max(0.2 * (most + 1.5), 1.6)
    title = "What the methods cost and reach: a dot for each of "
    figure = new_figure(table, f"{title}{rows['case'].nunique()} hard cases", 1.7 + height)
    grid = figure.add_gridspec(2, 2, height_ratios=(height, 0.25))
    cost = figure.add_subplot(grid[0, 0])
    error = figure.add_subplot(grid[0, 1], sharey=cost)
    draw_trials(cost, rows, places, ratio)
    draw_trials(error, rows, places, np.maximum(rows["orientation_error"], 1e-16))
    error.tick_params(labelleft=False)
    few_ticks(error.xaxis, by_width(8, 4))
    good = ratio[rows["verdict"] == "accurate"].groupby(rows["entry"]).median()
    cost.plot(good, good.index.map(places), **MEDIAN, zorder=4)
    family = rows.groupby("entry")["family"].first()
    for label, entry in zip(cost.get_yticklabels(), places, strict=True):
        label.set_color(ink_of(look_of(family[entry])))
    cost.axvline(1, color=GREY, linewidth=0.8, zorder=1)
    words = "evaluations over those of the cheapest accurate method of the case"
    name_axis(cost.xaxis, words, letters=by_width(0, 16))
    name_axis(error.xaxis, "largest error of the attitude", "rad", letters=by_width(0, 16))
    handles = [
        Line2D([], [], label=f"{how}: {verdict}", **marker(Look("o", GREY), fullness))
        for how, (verdict, fullness) in zip(("full", "pale", "empty"), FACES.items(), strict=True)
        if (rows["verdict"] == verdict).any()
    ]
    handles.append(Line2D([], [], **MEDIAN, label="median of the accurate"))
    place = {"loc": "center right", "ncols": by_width(4, 2), "borderpad": 0}
    foot = no_axis(figure.add_subplot(grid[1, :]))
    foot.legend(handles=handles, **place).set_in_layout(False)
    return figure


def draw_trials(
    axes: Axes, rows: pd.DataFrame, places: dict[str, float], values: pd.Series
) -> None:
    """The trials as dots on the lines of their methods, on a log axis."""
    axes.set_xscale("log")
    for (family, verdict), part in rows.groupby(["family", "verdict"]):
        heights = part["entry"].map(places)
        axes.plot(values[part.index], heights, **marker(look_of(family), FACES[verdict]))
    few_ticks(axes.xaxis, 7)
    name_rows(axes, [*places], [*places.values()])


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
