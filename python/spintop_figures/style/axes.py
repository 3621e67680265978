"""The numbers of axes. Nothing is written beside an axis.

Where its numbers are tiny or huge its unit has a prefix (mm, µrad), many degrees are turns, and
numbers that differ little are written as differences from one of them, which the label names.
"""

import math
import re
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import (
    FixedLocator,
    Formatter,
    Locator,
    MaxNLocator,
    NullLocator,
    ScalarFormatter,
)

from spintop_figures.style.log_axes import axes_of, write_powers
from spintop_figures.style.numbers import PLAIN, true_minus, with_comma, write

LEAST_TICK, LARGEST_TICK = 0.01, 1e4
"""Axes whose numbers are all smaller or reach beyond have a prefix before their unit."""

PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G"}
BOTH_WAYS = ("m", "J", "N", "N m")
DOWN_ONLY = ("s", "J s", "rad", "rad/s", "m/s")
"""Units with prefixes; of the second ones for tiny numbers only."""

DEGREES = ("degrees", "deg")
TURN = 360.0
CLOSE = 1e-4
"""Numbers of which the range is a smaller part are written as differences from one of them."""

NOISE, FLAT = 1e-12, 0.05
"""A range that is a smaller part of the numbers is of rounding, and what is shown around it."""

UNIT = re.compile(r"\(((?:[^()]|\([^()]*\))*)\)(?!.*\()", re.DOTALL)
"""The unit of a label, in its last parentheses."""

MOST_DECIMALS = 12
STEPS = 1, 2, 2.5, 5, 10


class Scale(NamedTuple):
    """How the numbers of an axis are written: less `origin`, times `factor`, in `unit`."""

    factor: float = 1.0
    unit: str = ""
    origin: float = 0.0


class Ticks(Formatter):
    """The numbers at the ticks of an axis, all with as many decimals as tell them apart."""

    def __init__(self, scale: Scale) -> None:
        self.scale = scale
        self.places = np.array([])

    def set_locs(self, locs: object) -> None:
        """Know all ticks of the axis."""
        self.places = np.asarray(locs, float)

    def shown(self, places: object) -> np.ndarray:
        """Numbers of the axis as they are written."""
        return (np.asarray(places, float) - self.scale.origin) * self.scale.factor

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        value = float(self.shown(x))
        numbers = self.shown(self.places) if self.places.size else np.array([value])
        step = np.diff(np.sort(numbers)).min(initial=np.inf)
        step = step if 0 < step < np.inf else abs(value) or 1.0
        largest = np.abs(numbers).max()
        if abs(value) < 1e-6 * step:
            return "0"
        if largest >= 10 ** PLAIN[1] or largest < 10 ** PLAIN[0]:
            return write(float(f"{value:.10e}"), 6)
        for decimals in range(MOST_DECIMALS):
            if np.all(np.abs(numbers - np.round(numbers, decimals)) < 1e-3 * step):
                break
        return true_minus(f"{value:,.{decimals}f}")


class WithComma(Formatter):
    """The labels of another formatter, with decimal commas."""

    def __init__(self, inner: Formatter) -> None:
        self.inner = inner

    def set_axis(self, axis: Axis) -> None:
        """Have both know the axis."""
        super().set_axis(axis)
        self.inner.set_axis(axis)

    def set_locs(self, locs: object) -> None:
        """Have both know the ticks."""
        self.inner.set_locs(locs)

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        return with_comma(self.inner(x, pos))


class ScaledLocator(Locator):
    """Ticks at round numbers as they are written, where those differ by no power of ten."""

    def __init__(self, scale: Scale) -> None:
        self.scale, self.round = scale, MaxNLocator("auto", steps=STEPS)

    def __call__(self) -> np.ndarray:
        """The places of the ticks."""
        return self.tick_values(*self.axis.get_view_interval())

    def tick_values(self, vmin: float, vmax: float) -> np.ndarray:
        """The places of ticks between two numbers of the axis."""
        self.round.set_axis(self.axis)
        factor, _, origin = self.scale
        ticks = self.round.tick_values((vmin - origin) * factor, (vmax - origin) * factor)
        return ticks / factor + origin


def scale_for(low: float, high: float, unit: str) -> Scale:
    """How numbers between these in a unit are written; turns for many degrees."""
    origin = 0.0
    if 0 < high - low < CLOSE * max(abs(low), abs(high)) and low * high > 0:
        origin = round_number_in(low, high)
    largest = max(abs(low - origin), abs(high - origin))
    if not largest or not math.isfinite(largest):
        return Scale(unit=unit)
    if unit in DEGREES and largest >= LARGEST_TICK:
        return Scale(1 / TURN, "turns", origin)
    factor = 1.0
    if unit in DEGREES and largest < LEAST_TICK:
        factor, unit = math.pi / 180, "rad"
    largest *= factor
    power = 3 * math.floor(math.log10(largest) / 3)
    is_tiny = largest < LEAST_TICK and unit in BOTH_WAYS + DOWN_ONLY
    is_huge = largest >= LARGEST_TICK and unit in BOTH_WAYS
    if (is_tiny or is_huge) and power in PREFIXES:
        return Scale(factor * 10.0**-power, PREFIXES[power] + unit, origin)
    return Scale(factor, unit, origin)


def round_number_in(low: float, high: float) -> float:
    """The number between two with the fewest digits."""
    for digits in range(1, 17):
        number = float(f"{(low + high) / 2:.{digits - 1}e}")
        if low <= number <= high:
            return number
    return (low + high) / 2


def write_axes(figure: Figure) -> None:
    """Give all axes of a figure their numbers, and the units in their labels what these need."""
    holders = [(*each, holder_of(each[0], each[2])) for each in axes_of(figure)]
    for axes, name, axis, holder in sorted(holders, key=lambda each: each[3] is None):
        write_powers(axis)
        formatter = axis.get_major_formatter()
        unit = UNIT.search(holder.get_text())[1] if holder else ""
        if type(formatter) is ScalarFormatter:
            show_flat(axes, name)
            scale = scale_for(*sorted(getattr(axes, f"get_{name}lim")()), unit)
            is_free = not isinstance(axis.get_major_locator(), FixedLocator | NullLocator)
            if is_free and (scale.origin or (scale.unit != unit and unit in DEGREES)):
                axis.set_major_locator(ScaledLocator(scale))
            axis.set_major_formatter(Ticks(scale))
        elif isinstance(formatter, Ticks):  # panels that share an axis share its numbers
            scale = formatter.scale
        else:
            continue
        if holder:
            rename(holder, scale, unit)


def show_flat(axes: Axes, name: str) -> None:
    """Widen an axis whose numbers differ by rounding only: what is constant is a flat line."""
    ends = getattr(axes, f"get_{name}lim")()
    middle = sum(ends) / 2
    if 0 < abs(ends[1] - ends[0]) < NOISE * abs(middle):
        getattr(axes, f"set_{name}lim")(middle - FLAT * abs(middle), middle + FLAT * abs(middle))


def holder_of(axes: Axes, axis: Axis) -> Text | None:
    """The text with the unit of an axis: its label, or the heading of the panel.

    That of a map is for its colour bar; any other for the y axis, if no panel that shares it has a
    label.
    """
    bar = getattr(axes, "_colorbar", None)
    panel = getattr(bar and bar.mappable, "axes", None) or axes
    sharing = axes.get_shared_y_axes().get_siblings(axes)
    headed = bar or (axis is axes.yaxis and not any(each.get_ylabel() for each in sharing))
    texts = [axis.label, *([panel._left_title, axes.title] if headed else [])]
    return next((text for text in texts if UNIT.search(text.get_text())), None)


def rename(label: Text, scale: Scale, unit: str) -> None:
    """Write the unit that a scale has in a label, and what its numbers are less."""
    text = label.get_text()
    before = text[: UNIT.search(text).start()].rstrip()
    after = text[UNIT.search(text).end() :]
    if scale.origin:
        sign = "minus" if scale.origin > 0 else "plus"
        before += f"\n{sign} {write(abs(scale.origin), 12)} {unit}"
    if scale.origin or scale.unit != unit:
        label.set_text(f"{before} ({scale.unit}){after}")
