"""Lines of numbers over an axis: what is not finite or zero, wide ranges, degrees."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import LogLocator, MultipleLocator

from spintop_figures.style.look import GREY, LINES

WIDE_RANGE, USUAL = 3e4, 0.2
"""A quantity goes on a log axis if its largest size is more than so many times the size that it
exceeds in all but this part of the rows. The paper's residuals stay on linear ones, as printed."""

MANY_POINTS = 20_000
"""Longer lines are stored as pixels in an SVG."""

RIGHT_ANGLES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720)


def draw_line(axes: Axes, x: np.ndarray, y: np.ndarray, line: int = 0, **options: object) -> None:
    """Draw a curve; what is not finite is left out."""
    finite = np.where(np.isfinite(y), y, np.nan)
    axes.plot(x, finite, **LINES[line] | {"rasterized": len(y) > MANY_POINTS} | options)


def has_wide_range(y: np.ndarray) -> bool:
    """Whether a linear axis would show nothing but the largest values."""
    sizes = np.abs(y[np.isfinite(y) & (y != 0)])
    return sizes.size > 0 and sizes.max() / WIDE_RANGE > np.quantile(sizes, USUAL)


def draw_sizes(axes: Axes, x: np.ndarray, y: np.ndarray) -> None:
    """Draw absolute values on a log axis, with a gap and a tick at the bottom where they are zero.

    A line that joined the values beside a zero would show a floor that is not there.
    """
    sizes = np.abs(np.where(np.isfinite(y), y, np.nan))
    zero = sizes == 0
    sizes[zero] = np.nan
    axes.set_yscale("log")
    draw_line(axes, x, sizes)
    there = np.isfinite(sizes)
    beside = np.concatenate([[False], there[:-1]]) | np.concatenate([there[1:], [False]])
    alone = there & ~beside
    draw_line(axes, x[alone], sizes[alone], linestyle="", marker=".", markersize=2)
    axes.set_ylim(max(np.nanmin(sizes) / 3, 1e-307), min(np.nanmax(sizes) * 3, 1e308))
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    if zero.any():  # ticks at the bottom
        style = {"color": GREY, "markersize": 4, "markeredgewidth": 0.5, "linestyle": ""}
        style |= {"marker": "|", "transform": axes.get_xaxis_transform()}
        count = int(zero.sum())
        style["label"] = f"exactly zero ({count} row{'s' * (count > 1)})"
        axes.plot(x[zero], np.full(count, 0.03), rasterized=count > MANY_POINTS, **style)
        axes.legend(loc="upper right", borderpad=0.1, handletextpad=0.2)


def set_degree_ticks(axis: Axis, degrees: np.ndarray, most: int = 5) -> None:
    """Ticks at round parts or multiples of a turn, with so many steps between them at most."""
    span = np.ptp(degrees[np.isfinite(degrees)])
    step = next((step for step in RIGHT_ANGLES if span <= most * step), None)
    if step is not None and span > 2 * RIGHT_ANGLES[0]:
        axis.set_major_locator(MultipleLocator(step))
