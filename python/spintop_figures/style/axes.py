"""The names and the numbers of axes. Nothing is written beside an axis.

Where its numbers are tiny or huge its unit has a prefix (mm, µrad), many degrees are turns, and
numbers that differ little are written as differences from one of them, which the name tells.
"""

import itertools
import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib import ticker
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.text import Text

from spintop_figures.style.look import FAINT, GREY, LINES, is_slide
from spintop_figures.style.look import scale as scale_of_letters
from spintop_figures.style.numbers import PLAIN, localised, with_power, write
from spintop_figures.tables.names import shown_in, with_unit
from spintop_figures.tables.words import say

LEAST_TICK, LARGEST_TICK = 0.01, 1e4
"""Axes whose numbers are all smaller or reach beyond have a prefix before their unit."""

BOTH_WAYS = ("m", "J", "N", "N m")
DOWN_ONLY = ("s", "J s", "rad", "rad/s", "m/s")
"""Units with prefixes; of the second ones for tiny numbers only."""

DEGREES = ("degrees", "deg")

LETTERS, MOST_LETTERS = 14, 40
"""Letters of the usual size in an inch, and those of a line in a panel without a grid."""

FORMULA = re.compile(r"\$[^$]*\$")


class Scale(NamedTuple):
    """How the numbers of an axis are written: less `origin`, times `factor`, in `unit`."""

    factor: float = 1.0
    unit: str = ""
    origin: float = 0.0

    def shown(self, places: object) -> np.ndarray:
        """Numbers of the axis as they are written."""
        return (np.asarray(places, float) - self.origin) * self.factor


def scale_for(low: float, high: float, unit: str) -> Scale:
    """How numbers between these in a unit are written; turns for many degrees."""
    origin = 0.0
    if 0 < high - low < 1e-4 * max(abs(low), abs(high)) and low * high > 0:  # they differ little
        numbers = (float(f"{(low + high) / 2:.{digits}e}") for digits in range(17))
        origin = next((number for number in numbers if low <= number <= high), low)
    largest = max(abs(low - origin), abs(high - origin))
    if not largest or not math.isfinite(largest):
        return Scale(unit=unit)
    if unit in DEGREES and largest >= LARGEST_TICK:
        return Scale(1 / 360, "turns", origin)
    factor = 1.0
    if unit in DEGREES and largest < LEAST_TICK:
        factor, unit = math.pi / 180, "rad"
    largest *= factor
    power = 3 * math.floor(math.log10(largest) / 3)
    is_tiny = largest < LEAST_TICK and unit in BOTH_WAYS + DOWN_ONLY
    is_huge = largest >= LARGEST_TICK and unit in BOTH_WAYS
    if (is_tiny or is_huge) and -12 <= power <= 9:
        return Scale(factor * 10.0**-power, ticker.EngFormatter.ENG_PREFIXES[power] + unit, origin)
    return Scale(factor, unit, origin)


class Numbers(ticker.Formatter):
    """The numbers at ticks, with as many decimals as tell them apart, and the name of the axis."""

    def __init__(self, words: str, unit: str, after: str) -> None:
        self.words, self.unit, self.after = words, unit, after
        self.asked = shown_in(words, unit)
        self.holders: list[tuple[Text, int]] = []
        """Texts that name the axis or those that share it, with the letters of their lines."""

    def scale(self) -> Scale:
        """How the numbers are written: by the ends of the axis; in a unit that is asked for."""
        scale = scale_for(*sorted(self.axis.get_view_interval()), self.unit)
        factor, unit = self.asked
        return scale if unit == self.unit else Scale(factor, unit, scale.origin)

    def set_locs(self, locs: object) -> None:
        """Know all ticks of the axis, and tell how they are written."""
        self.ticks, scale, words = np.asarray(locs, float), self.scale(), self.words
        if scale.origin:
            sign = "minus" if scale.origin > 0 else "plus"
            words += f"\n{sign} {write(abs(scale.origin), 12)} {self.unit}"
        named = words + f" ({scale.unit})" if scale != Scale(unit=self.unit) and scale.unit else ""
        for holder, letters in self.holders:
            text = named or with_unit(words, self.unit)
            holder.set_text(wrapped(text + self.after, letters))

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        scale = self.scale()
        value = float(scale.shown(x))
        numbers = scale.shown(self.ticks) if len(self.ticks) else np.array([value])
        step = np.diff(np.sort(numbers)).min(initial=np.inf)
        step = step if 0 < step < np.inf else abs(value) or 1.0
        largest = np.abs(numbers).max()
        if abs(value) < 1e-6 * step:
            return "0"
        if largest >= 10 ** PLAIN[1] or largest < 10 ** PLAIN[0]:
            return write(float(f"{value:.10e}"), 6)
        for decimals in range(12):
            if np.all(np.abs(numbers - np.round(numbers, decimals)) < 1e-3 * step):
                break
        return localised(f"{value:,.{decimals}f}")


class Places(ticker.MaxNLocator):
    """Ticks at round numbers as they are written, which may be turns, or differences."""

    def __init__(self, nbins: int | str = "auto") -> None:
        super().__init__(nbins, steps=(1, 2, 2.5, 5, 10))

    def tick_values(self, vmin: float, vmax: float) -> np.ndarray:
        """The places of ticks between two numbers of the axis."""
        numbers = self.axis.get_major_formatter()
        scale = numbers.scale() if isinstance(numbers, Numbers) else Scale()
        return super().tick_values(*scale.shown((vmin, vmax))) / scale.factor + scale.origin


class Powers(ticker.LogFormatterSciNotation):
    """Powers of ten as plain text, ten times as fast as formulas; numbers on a short axis."""

    def __init__(self, plain: bool = False, unit: str = "") -> None:
        super().__init__()
        self.plain, self.unit = plain, unit

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        if not super().__call__(x, pos):
            return ""
        low, high = sorted(self.axis.get_view_interval())
        is_short = high < 100 * low and low >= 1e-3 and high <= 1e4  # it needs no powers of ten
        mantissa, power = f"{x:.0e}".split("e")
        return write(x) if self.plain or is_short else with_power(mantissa, int(power))


def name_axis(
    axis: Axis,
    words: str,
    unit: str = "",
    after: str = "",
    holder: Text | None = None,
    plain: bool = False,
    letters: int = 0,
) -> None:
    """Name an axis that has its scale and its locator, and give it its numbers.

    The name is its label, or a text such as a heading, without numbers but those at the ticks. A
    log axis may have `plain` numbers, without powers of ten. Without so many `letters` the lines of
    the name are as long as the axis.
    """
    axes = axis.axes
    letters = letters or letters_of(axes, axis.axis_name if holder is None else "x")
    if is_slide() and holder is None:
        letters = int(0.85 * letters)  # beside it there is less room than above a panel
    holder = holder or axis.label
    holder.set_text(wrapped(with_unit(words, unit) + after, letters))
    if axis.get_scale() == "log":
        axis.set_major_formatter(Powers(plain, unit))
        axis.set_minor_formatter(Powers(plain, unit))
        return
    numbers = axis.get_major_formatter()
    if not isinstance(numbers, Numbers):  # else of a panel that shares the axis
        numbers = Numbers(words, unit, after)
        axis.set_major_formatter(numbers)
        if isinstance(axis.get_major_locator(), ticker.AutoLocator) or numbers.asked[1] != unit:
            axis.set_major_locator(Places())
    numbers.holders.append((holder, letters))
    low, high = axis.get_view_interval()
    if 0 < abs(high - low) < 1e-12 * abs(low + high) / 2:  # of rounding: a flat line
        room = 0.05 * abs(low + high) / 2
        getattr(axes, f"set_{axis.axis_name}lim")(min(low, high) - room, max(low, high) + room)


def name_axes(axes: Axes, x: tuple[str, ...], y: tuple[str, ...]) -> None:
    """Name both axes, each by words and a unit."""
    name_axis(axes.xaxis, *x)
    name_axis(axes.yaxis, *y)


def letters_of(axes: Axes, side: str) -> int:
    """Letters of a line along a side of a panel, before it is laid out."""
    if not (spot := axes.get_subplotspec()):
        return MOST_LETTERS
    size = axes.figure.get_size_inches() / scale_of_letters()
    width, height = size * spot.get_position(axes.figure).size
    rows, columns = spot.get_gridspec().get_geometry()
    width *= 1.1 + 0.22 * (columns - 1) / columns  # margins are smaller when it is laid out
    height *= 0.91 + 0.18 * (rows - 1) / rows
    return max(int(LETTERS * (width if side == "x" else height)), 12)


def wrapped(text: str, letters: int) -> str:
    """A text in the language that is spoken, in lines of so many letters; formulas stay whole."""
    text = say(text)
    formulas = iter(FORMULA.findall(text))
    silent = r"\\[a-z]+|[{}$_^\\, ]"  # what takes no room, or that of a letter
    text = FORMULA.sub(lambda each: "\0" * max(len(re.sub(silent, "", each[0])), 1), text)
    fill = textwrap.TextWrapper(letters, break_long_words=False).wrap
    lines = itertools.chain(*(fill(line) or [""] for line in text.split("\n")))
    return re.sub("\0+", lambda _: next(formulas), "\n".join(lines))


MANY_POINTS = 20_000
"""Longer lines are stored as pixels in an SVG."""

RIGHT_ANGLES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720)


def draw_line(axes: Axes, x: np.ndarray, y: np.ndarray, line: int = 0, **options: object) -> None:
    """Draw a curve; what is not finite is left out."""
    finite = np.where(np.isfinite(y), y, np.nan)
    axes.plot(x, finite, **LINES[line] | {"rasterized": len(y) > MANY_POINTS} | options)


def draw_heads(axes: Axes, x: np.ndarray, y: np.ndarray, places: Iterable[int]) -> None:
    """Heads of arrows along a curve of the first colour, at the steps to these rows."""
    look = {"arrowstyle": "-|>", "color": LINES[0]["color"], "lw": 0, "mutation_scale": 15}
    look |= {"shrinkA": 0, "shrinkB": 0}
    for place in places:
        tail, tip = ((x[i], y[i]) for i in (place - 1, place))
        axes.annotate("", tip, tail, arrowprops=look, zorder=4)


def has_wide_range(y: np.ndarray) -> bool:
    """Whether a linear axis would show nothing but the largest values.

    The largest is so many times what all but a fifth of the rows exceed that the paper's residuals
    stay on linear axes, as printed.
    """
    sizes = np.abs(y[np.isfinite(y) & (y != 0)])
    return sizes.size > 0 and sizes.max() / 3e4 > np.quantile(sizes, 0.2)


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
    axes.yaxis.set_major_locator(ticker.LogLocator(numticks=7))
    if zero.any():  # ticks at the bottom
        style = {"color": GREY, "markersize": 4, "markeredgewidth": 0.5, "linestyle": ""}
        style |= {"marker": "|", "transform": axes.get_xaxis_transform()}
        count = int(zero.sum())
        style["label"] = f"exactly zero ({count} row{'s' * (count > 1)})"
        axes.plot(x[zero], np.full(count, 0.03), rasterized=count > MANY_POINTS, **style)
        axes.legend(loc="upper right", borderpad=0.1, handletextpad=0.2)


def few_ticks(axis: Axis, count: int) -> None:
    """So many ticks on a log axis at most."""
    axis.set_major_locator(ticker.LogLocator(numticks=count))
    axis.set_minor_locator(ticker.NullLocator())


def name_rows(axes: Axes, labels: Sequence[str], places: Sequence[float] = ()) -> None:
    """Name the rows of a figure from the top, each on a faint line."""
    places = places or range(len(labels))
    for place in places:
        axes.axhline(place, color=FAINT, linewidth=0.5, zorder=0)
    axes.set_yticks(places, labels=labels)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(places[-1] + 0.5, -0.5)


def set_degree_ticks(axis: Axis, degrees: np.ndarray, most: int = 5) -> None:
    """Ticks at round parts or multiples of a turn, with so many steps between them at most."""
    span = np.ptp(degrees[np.isfinite(degrees)])
    step = next((step for step in RIGHT_ANGLES if span <= most * step), None)
    if step is not None and span > 2 * RIGHT_ANGLES[0]:
        axis.set_major_locator(ticker.MultipleLocator(step))
