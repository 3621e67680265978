"""What the methods of a stability study cost and reach: a line a method, a dot a hard case."""

import textwrap

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.methods.known import families
from spintop_figures.methods.styles import Look, ink_of, look_of
from spintop_figures.methods.trials import object_to_trials, trials
from spintop_figures.style.look import FAINT, GREY, by_width
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

COST = "evaluations over those of the cheapest accurate method of the case"

ROW, GAP = 0.2, 0.5
"""Height of a method in inches, and the distance of families over it."""

LEAST_HEIGHT, LEGEND = 1.6, 0.25
"""Of the panels at least, and of the legend, in inches."""

LEAST_ERROR = 1e-16
"""Smaller errors are drawn here, rad."""

FACES = {"accurate": 1.0, "drifts": 0.35, "wrong": 0.0}
"""How full the marker of a verdict is; the other verdicts have none."""

NAMES = {"accurate": "full: accurate", "drifts": "pale: drifts", "wrong": "empty: wrong"}

RATIO = "ratio"
"""Evaluations over those of the cheapest accurate method of the case."""


def object_to_costs(table: Table) -> str:
    """The trials have to be known, and one to have gone to its end."""
    if objection := object_to_trials(table):
        return objection
    return "" if not judged(table.rows).empty else "has no trial that went to its end"


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


def places_of(rows: pd.DataFrame) -> dict[str, float]:
    """The height of each method from the top, by family."""
    places: dict[str, float] = {}
    height = 0.0
    for family in families():
        entries = rows.loc[rows["family"] == family, "entry"].unique()
        for entry in entries:
            places[entry] = height
            height += 1
        height += GAP if len(entries) else 0
    return places


def draw_costs(table: Table) -> Figure:
    """Two panels over the same methods: their cost, and the error that they reach."""
    rows = with_ratio(judged(trials(table)))
    places = places_of(rows)
    most = max(places.values())
    height = max(ROW * (most + 1.5), LEAST_HEIGHT)
    count = rows["case"].nunique()
    title = f"What the methods cost and reach: a dot for each of {count} hard cases"
    figure = new_figure(table, title, 1.7 + height)
    grid = figure.add_gridspec(2, 2, height_ratios=(height, LEGEND))
    cost = figure.add_subplot(grid[0, 0])
    error = figure.add_subplot(grid[0, 1], sharey=cost)
    error.tick_params(labelleft=False)
    draw_trials(cost, rows, places, rows[RATIO])
    draw_trials(error, rows, places, np.maximum(rows["orientation_error"], LEAST_ERROR))
    for entry, part in rows.groupby("entry"):
        good = part[part["verdict"] == "accurate"]
        if not good.empty:
            style = {"color": "black", "marker": "|", "markersize": 11, "markeredgewidth": 1.6}
            cost.plot(good[RATIO].median(), places[entry], **style, zorder=4)
    cost.set_yticks(list(places.values()), labels=list(places))
    for label, entry in zip(cost.get_yticklabels(), places, strict=True):
        family = rows.loc[rows["entry"] == entry, "family"].iloc[0]
        label.set(color=ink_of(family), fontsize=8.5)
    cost.set_ylim(most + 0.75, -0.75)
    cost.axvline(1, color=GREY, linewidth=0.8, zorder=1)
    letters = by_width(38, 22)
    cost.set_xlabel(textwrap.fill(COST, letters))
    error.set_xlabel(textwrap.fill("largest error of the attitude (rad)", letters))
    error.xaxis.set_major_locator(LogLocator(numticks=by_width(8, 4)))
    add_legend(figure.add_subplot(grid[1, :]), rows)
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
        "markersize": 7 if look.marker == "*" else 4.5,
        "markerfacecolor": (look.colour, fullness),
        "markeredgecolor": look.colour,
        "markeredgewidth": 0.6,
    }


def add_legend(axes: Axes, rows: pd.DataFrame) -> None:
    """What the markers mean, below the panels."""
    grey = Look("o", GREY)
    handles = [
        Line2D([], [], label=NAMES[verdict], **marker(grey, fullness))
        for verdict, fullness in FACES.items()
        if (rows["verdict"] == verdict).any()
    ]
    style = {"color": "black", "linestyle": "", "marker": "|", "markersize": 10}
    handles.append(Line2D([], [], **style, markeredgewidth=1.6, label="median of the accurate"))
    axes.axis("off")
    axes.legend(
        handles=handles, loc="center right", ncols=by_width(4, 2), borderpad=0
    ).set_in_layout(False)
