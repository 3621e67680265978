"""The best method of each family, drawn strongly and named beside its curve."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes

from spintop_figures.methods.curves import TARGET, Curve, time_to
from spintop_figures.methods.known import family_of, known_methods
from spintop_figures.methods.styles import ink_of
from spintop_figures.style.look import GREY

APART, APART_ALONE = 0.115, 0.06
"""Distance of the names, over the height of the panel: with a line below each, and without."""

SIDE = 1.045
"""Where the names stand, over the width of the panel."""


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
    words: Callable[[Curve], str] | None = None,
) -> None:
    """The names of curves at the right of a panel, each joined to a point of its curve.

    The points are in data, on log axes that have their limits. Below a name is the kind of the
    method, or there are `words` in place of both.
    """
    low, high = np.log10(axes.get_ylim())
    heights = [(np.log10(point[1]) - low) / (high - low) for _, point in named]
    spots = spread(np.sort(heights), APART_ALONE if words else APART)
    for place, height in zip(np.argsort(heights), spots, strict=True):
        curve, point = named[place]
        colour = ink_of(family_of(curve.method))
        method = known_methods().get(curve.method)
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
        if words:
            look = {"color": colour, "fontsize": 9, "va": "center_baseline"}
            axes.text(SIDE, height, words(curve), **style, **look)
            continue
        look = {"fontweight": "bold", "color": colour, "fontsize": 9, "va": "bottom"}
        axes.text(SIDE, height, curve.label, **style, **look)
        if method:
            small = {"fontsize": 7.5, "color": GREY}
            axes.text(SIDE, height, method.group, va="top", **style, **small)


def spread(heights: np.ndarray, apart: float = APART) -> np.ndarray:
    """Heights in rising order moved as little as needed to be apart, between 0 and 1."""
    count = len(heights)
    apart = min(apart, 1 / max(count, 1))
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
