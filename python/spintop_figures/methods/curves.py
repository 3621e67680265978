"""The curves of a work-precision study: errors of a method against its cost; which are named."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from spintop_figures.methods.known import family_of, ink_of, rank_of, style_of
from spintop_figures.style.look import GROUND
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

EXACT = "exact"
"""The method that takes no steps."""

TARGET, GOAL = 1e-9, "10\u207b\u2079 rad"
"""The error by whose cost methods are compared, rad, and how it is written."""

APART, APART_ON_TOP = 0.06, 0.05
"""Distance of names at a side over the height of a panel, and above it over the width."""

SIDE, TOP, SLOPE = 1.045, 1.015, 32
"""Where names stand beside a panel and above it, over its size, and how they rise, in degrees."""

REACH = 0.3
"""A curve that begins further below, over the height of the panel, has its name at its end."""

Point = tuple[float, float]


class Curve(NamedTuple):
    """A method under a formulation: its label, and its rows from the coarsest to the finest."""

    method: str
    formulation: str
    label: str
    rows: pd.DataFrame

    def style(self) -> dict[str, object]:
        """How it is drawn, in every figure alike; the formulation fills markers if it is told."""
        return style_of(self.method, self.formulation if self.label != self.method else "")


def fineness(setting: str) -> float:
    """How fine a setting is: a number of steps, or one over a tolerance; 0 if it is neither."""
    word, _, value = setting.partition(" ")
    if word == "steps":
        return float(value)
    return 1 / float(value) if word == "tolerance" else 0.0


def problems_of(table: Table) -> list[str]:
    """The problems, in the order in which the table has them first."""
    return list(dict.fromkeys(table.rows["problem"]))


def curves_of(rows: pd.DataFrame, columns: Iterable[str]) -> list[Curve]:
    """The curves of a problem, by family, of rows that went well and have these columns.

    A label names the formulation only where a method has several.
    """
    sound = ended_well(rows) & np.isfinite(rows[[*columns]].astype(float)).all(axis=1)
    several = rows.groupby("method")["formulation"].nunique() > 1
    curves = []
    for (method, formulation), part in rows[sound].groupby(["method", "formulation"], sort=False):
        label = f"{name_of(method)}, {name_of(formulation)}" if several[method] else name_of(method)
        order = part["setting"].map(fineness).sort_values(kind="stable").index
        curves.append(Curve(method, formulation, label, part.loc[order]))
    return sorted(curves, key=lambda curve: (*rank_of(curve.method), curve.label))


def time_to(curve: Curve, target: float = TARGET, cost: str = "time_s") -> float:
    """The least cost at which a method reaches an error, nan if it does not.

    Between two settings the logarithms of cost and error are on a line.
    """
    with np.errstate(divide="ignore"):
        time, error = (np.log(curve.rows[name].to_numpy(float)) for name in (cost, "error_max"))
    goal = np.log(target)
    times = [time[0]] if error[0] <= goal else []
    for (t0, e0), (t1, e1) in itertools.pairwise(zip(time, error, strict=True)):
        if e1 <= goal < e0:
            share = 1.0 if np.isneginf(e1) else (goal - e0) / (e1 - e0)
            times.append(t0 + share * (t1 - t0))
    return float(np.exp(min(times))) if times else float("nan")


def best_of_families(curves: Sequence[Curve], cost: str) -> list[Curve]:
    """The curve of each family that reaches the target at the least cost, in their order.

    Of a family that does not reach it, that with the least error.
    """
    best: dict[str, tuple[tuple[float, float], Curve]] = {}
    for curve in curves:
        reached = time_to(curve, TARGET, cost)
        least = float(curve.rows["error_max"].min())
        merit = (0.0, reached) if np.isfinite(reached) else (1.0, least)
        family = family_of(curve.method)
        if family not in best or merit < best[family][0]:
            best[family] = merit, curve
    return [curve for _, curve in best.values()]


def lead(axes: Axes, colour: object, place: Point, point: Point) -> None:
    """A faint line from a name beside a panel, at a place in it, to a point of data."""
    line = {"arrowstyle": "-", "color": colour, "lw": 0.6, "ls": ":", "shrinkA": 0, "shrinkB": 0}
    places = {"xycoords": "axes fraction", "textcoords": "data", "annotation_clip": False}
    axes.annotate("", place, point, arrowprops=line, **places)


def name_at_the_side(
    axes: Axes, named: Sequence[tuple[Curve, Point]], words: Callable[[Curve], str]
) -> None:
    """The words for curves at the right of a panel, each joined to a point of its curve.

    The points are in data, on log axes that have their limits.
    """
    low, high = np.log10(axes.get_ylim())
    heights = [(np.log10(point[1]) - low) / (high - low) for _, point in named]
    spots = spread(np.sort(heights), APART)
    style = {"transform": axes.transAxes, "fontsize": "small", "va": "center_baseline"}
    for place, height in zip(np.argsort(heights), spots, strict=True):
        curve, point = named[place]
        colour = ink_of(family_of(curve.method))
        lead(axes, colour, (SIDE - 0.01, height), point)
        axes.text(SIDE, height, words(curve), color=colour, clip_on=False, **style)


def name_at_the_top(axes: Axes, named: Sequence[tuple[Curve, Point]]) -> None:
    """The names of curves above a panel, over their upper ends; at those that are far below it.

    The points are in data, on log axes that have their limits.
    """
    to_panel = axes.transData + axes.transAxes.inverted()
    ends = [to_panel.transform(point) for _, point in named]
    high = sorted((i for i, end in enumerate(ends) if 1 - end[1] < REACH), key=lambda i: ends[i][0])
    spots = dict(zip(high, spread(np.array([ends[i][0] for i in high]), APART_ON_TOP), strict=True))
    for i, (curve, point) in enumerate(named):
        colour = ink_of(family_of(curve.method))
        style = {"fontweight": "bold", "color": colour, "fontsize": "small", "zorder": 6}
        if i in spots:
            lead(axes, colour, (spots[i], 1.0), point)
            style |= {"rotation": SLOPE, "rotation_mode": "anchor", "clip_on": False}
            axes.text(spots[i], TOP, curve.label, transform=axes.transAxes, **style)
        else:
            style["path_effects"] = [withStroke(linewidth=2.5, foreground=GROUND)]
            place = {"textcoords": "offset points", "ha": "center"}
            axes.annotate(curve.label, point, (0, 7), **place, **style)


def spread(heights: np.ndarray, apart: float = APART) -> np.ndarray:
    """Heights in rising order moved as little as needed to be apart, between 0 and 1."""
    count = len(heights)
    if not count:
        return heights
    apart = min(apart, 1 / count)
    offsets = apart * np.arange(count)
    moved = np.clip(heights, 0.02, 0.98)
    # equal distances taken off, what remains has only to rise: pool those that do not
    blocks: list[list[float]] = []
    for value in moved - offsets:
        blocks.append([value])
        while len(blocks) > 1 and np.mean(blocks[-2]) > np.mean(blocks[-1]):
            last = blocks.pop()
            blocks[-1] += last
    level = np.concatenate([np.full(len(block), np.mean(block)) for block in blocks])
    return np.clip(level, 0.02, max(0.98 - offsets[-1], 0.02)) + offsets
