"""The best method of each family, and the names of curves beside a panel or above it."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from spintop_figures.methods.curves import TARGET, Curve, time_to
from spintop_figures.methods.known import family_of
from spintop_figures.methods.styles import ink_of

APART = 0.06
"""Distance of names at a side, over the height of the panel."""

SIDE = 1.045
"""Where the names stand, over the width of the panel."""

TOP, SLOPE = 1.015, 32
"""Where names stand above a panel, over its height, and how they rise, in degrees."""

APART_ON_TOP = 0.05
"""Distance of such names, over the width of the panel."""

REACH = 0.3
"""A curve that begins further below, over the height of the panel, has its name at its end."""


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


def name_at_the_side(
    axes: Axes,
    named: Sequence[tuple[Curve, tuple[float, float]]],
    words: Callable[[Curve], str],
) -> None:
    """The words for curves at the right of a panel, each joined to a point of its curve.

    The points are in data, on log axes that have their limits.
    """
    low, high = np.log10(axes.get_ylim())
    heights = [(np.log10(point[1]) - low) / (high - low) for _, point in named]
    spots = spread(np.sort(heights), APART)
    for place, height in zip(np.argsort(heights), spots, strict=True):
        curve, point = named[place]
        colour = ink_of(family_of(curve.method))
        axes.annotate(
            "",
            (SIDE - 0.01, height),
            point,
            xycoords="axes fraction",
            textcoords="data",
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.6, "ls": ":", "shrinkB": 0},
            annotation_clip=False,
        )
        style = {"transform": axes.transAxes, "ha": "left", "clip_on": False}
        look = {"color": colour, "fontsize": 9, "va": "center_baseline"}
        axes.text(SIDE, height, words(curve), **style, **look)


def name_at_the_top(axes: Axes, named: Sequence[tuple[Curve, tuple[float, float]]]) -> None:
    """The names of curves above a panel, over their upper ends; at those that are far below it.

    The points are in data, on log axes that have their limits.
    """
    to_panel = axes.transData + axes.transAxes.inverted()
    ends = [to_panel.transform(point) for _, point in named]
    high = [i for i, end in enumerate(ends) if 1 - end[1] < REACH]
    high.sort(key=lambda i: ends[i][0])
    spots = dict(zip(high, spread(np.array([ends[i][0] for i in high]), APART_ON_TOP), strict=True))
    for i, (curve, point) in enumerate(named):
        colour = ink_of(family_of(curve.method))
        style = {"fontweight": "bold", "color": colour, "fontsize": 9, "zorder": 6}
        if i not in spots:
            outline = [withStroke(linewidth=2.5, foreground="white")]
            place = {"textcoords": "offset points", "ha": "center", "path_effects": outline}
            axes.annotate(curve.label, point, (0, 7), **place, **style)
            continue
        line = {"arrowstyle": "-", "color": colour, "lw": 0.6, "ls": ":", "shrinkA": 0}
        axes.annotate(
            "",
            (spots[i], 1.0),
            point,
            xycoords="axes fraction",
            textcoords="data",
            arrowprops=line | {"shrinkB": 0},
            annotation_clip=False,
        )
        style |= {"rotation": SLOPE, "rotation_mode": "anchor", "clip_on": False}
        axes.text(spots[i], TOP, curve.label, transform=axes.transAxes, **style)


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
