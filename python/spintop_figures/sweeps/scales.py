"""The colours of numbers and their scales, alike in maps and clouds of points."""

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize

from spintop_figures.sweeps.quantities import Quantity

COLOURS = mpl.colormaps["cividis"]
"""From dark to light, for all eyes and for print without colours."""

SIGNED = LinearSegmentedColormap.from_list(
    "signed", ["#0b2a4f", "#3f6d9e", "#a9c3dc", "#f4f2ee", "#f2bd8e", "#de7f35", "#ab4a0c"]
)
"""For values of both signs, with a neutral zero; the ends differ in lightness, too."""

OUTLIERS = 1.0
"""Percentage of the values, at either end, that may be beyond the colour bar."""

FAR = 0.5
"""They are where they would take more than this of the range of the others."""


def scale_of(quantity: Quantity, values: np.ndarray) -> tuple[Normalize, str]:
    """The scale of the colours of values, and at which ends some are beyond it.

    A scale of both signs has zero in its middle.
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return Normalize(0, 1), "neither"
    if finite.min() == finite.max():
        return Normalize(finite[0] - 1, finite[0] + 1), "neither"
    if quantity.has_log_scale(finite):
        above = finite[finite > 0]
        return LogNorm(above.min(), above.max()), "min" if above.size < finite.size else "neither"
    low, high = np.percentile(finite, [OUTLIERS, 100 - OUTLIERS])
    room = FAR * (high - low)
    first = low if finite.min() < low - room else finite.min()
    last = high if finite.max() > high + room else finite.max()
    if first < 0 < last:
        last = max(-first, last)
        first = -last
    ends = {(True, True): "both", (True, False): "min", (False, True): "max"}
    beyond = bool(finite.min() < first), bool(finite.max() > last)
    return Normalize(first, last), ends.get(beyond, "neither")


def is_signed(norm: Normalize) -> bool:
    """Whether a scale has zero inside."""
    return not isinstance(norm, LogNorm) and norm.vmin < 0 < norm.vmax


def colours_of(norm: Normalize) -> mpl.colors.Colormap:
    """The colours of a scale."""
    return SIGNED if is_signed(norm) else COLOURS
