"""The automatic choice of a method beside the cheapest method, on each problem of a study."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.methods.curves import problems_of
from spintop_figures.methods.known import family_of
from spintop_figures.methods.styles import look_of
from spintop_figures.style.look import FAINT, GREY, by_width
from spintop_figures.style.numbers import with_power
from spintop_figures.style.page import new_figure
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.table import Table

TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
"""The errors for which methods are compared, rad, as in the summary of the program."""

LEAST_PROBLEMS = 5
"""Fewer problems do not tell whether a choice is right."""

NEAR = 2.0
"""A choice that takes no more than so many times as long is near the cheapest."""

HEIGHT, SPREAD = 0.75, 0.3
"""Of a target, in inches, and how far its dots stand from its line, over that."""

GOLDEN = (5**0.5 - 1) / 2


class Choice(NamedTuple):
    """The choice on a problem for a target: its time over the least, and who has the least."""

    target: float
    ratio: float
    cheapest: str


def object_to_choice(table: Table) -> str:
    """The rows of the choice are marked, and there are enough problems."""
    if not (table.rows["auto"] == "yes").any():
        return "has no row of the automatic choice"
    if len(problems_of(table)) < LEAST_PROBLEMS:
        return f"has fewer than {LEAST_PROBLEMS} problems to judge a choice by"
    return "" if choices_of(table) else "has no method that is accurate enough"


def cheapest_row(rows: pd.DataFrame, target: float) -> pd.Series | None:
    """The row with the least time whose error is no larger than the target."""
    good = rows[ended_well(rows) & (rows["orientation_error"] <= target)]
    return None if good.empty else good.loc[good["time_s"].idxmin()]


def choices_of(table: Table) -> list[Choice]:
    """The comparisons; the ratio is infinite where the choice is not accurate enough."""
    found = []
    for _, rows in table.rows.groupby("problem", sort=False):
        chosen = rows[rows["auto"] == "yes"]
        for target in TARGETS if len(chosen) else ():
            best, own = cheapest_row(rows, target), cheapest_row(chosen, target)
            if best is None or not best["time_s"] > 0:
                continue
            ratio = np.inf if own is None else own["time_s"] / best["time_s"]
            found.append(Choice(target, float(ratio), str(best["method"])))
    return found


def draw_choice(table: Table) -> Figure:
    """How many times longer the choice takes than the cheapest method, a dot a problem."""
    choices = choices_of(table)
    ratios = np.array([choice.ratio for choice in choices])
    worst = ratios[np.isfinite(ratios)].max(initial=1.0)
    within = np.count_nonzero(ratios <= NEAR)
    title = (
        f"The automatic choice takes at most {worst:.2f} times as long as the cheapest method"
        if within == len(choices)
        else f"The automatic choice takes no more than {NEAR:g} times as long as the cheapest "
        f"method in {within} of {len(choices)} comparisons"
    )
    targets = [target for target in TARGETS if any(c.target == target for c in choices)]
    figure = new_figure(table, title, 1.4 + HEIGHT * len(targets))
    axes = figure.add_subplot()
    axes.axvspan(1, NEAR, color=FAINT, alpha=0.4, linewidth=0)
    axes.axvline(1, color=GREY, linewidth=0.8)
    edge = max(1.15 * worst, 1.15 * NEAR)
    for place, target in enumerate(targets):
        draw_target(axes, place, [c for c in choices if c.target == target], edge)
    handles, labels = axes.get_legend_handles_labels()
    alone = dict(zip(labels, handles, strict=True))
    axes.legend(
        alone.values(), alone, title="cheapest method", loc="upper left", bbox_to_anchor=(1.0, 1.0)
    )
    axes.set_xscale("log")
    axes.set_xlim(1 / 1.04, edge)
    ticks = ratios_below(edge)
    axes.set_xticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_ylim(len(targets) - 0.5, -0.5)
    labels = [f"{with_power('1', round(np.log10(target)))} rad" for target in targets]
    axes.set_yticks(range(len(targets)), labels=labels)
    axes.tick_params(axis="y", length=0)
    axes.set_ylabel("error")
    axes.set_xlabel("time of the automatic choice over that of the cheapest method")
    return figure


def ratios_below(edge: float) -> list[float]:
    """Round ratios from 1 to an edge, so far apart on a log axis that their numbers have room."""
    apart = by_width(0.07, 0.13) * np.log(edge)
    found: list[float] = [1]
    for ratio in (1.2, 1.5, 2, 3, 5, 10, 20, 50, 100):
        if ratio < edge and np.log(ratio / found[-1]) >= apart:
            found.append(ratio)
    return found


def draw_target(axes: Axes, place: int, choices: list[Choice], edge: float) -> None:
    """The comparisons for a target; those in which the choice misses it are at the right edge."""
    axes.axhline(place, color=FAINT, linewidth=0.5, zorder=0)
    heights = place + SPREAD * (2 * (GOLDEN * np.arange(len(choices)) % 1) - 1)
    for choice, height in zip(choices, heights, strict=True):
        look = look_of(family_of(choice.cheapest))
        x = min(choice.ratio, edge / 1.03)
        style = {"color": look.colour, "marker": look.marker, "linestyle": ""}
        style["markersize"] = 9 if look.marker == "*" else 6
        style["markeredgecolor"] = "white" if np.isfinite(choice.ratio) else "black"
        axes.plot(x, height, **style, markeredgewidth=0.5, label=choice.cheapest)
    near = sum(choice.ratio <= NEAR for choice in choices)
    missed = sum(not np.isfinite(choice.ratio) for choice in choices)
    words = f"{near} of {len(choices)} within {NEAR:g}" + (f", {missed} missed" if missed else "")
    axes.annotate(
        words,
        (0.99, place - 0.3),
        xycoords=axes.get_yaxis_transform(),
        ha="right",
        fontsize=8.5,
        color=GREY,
    )
