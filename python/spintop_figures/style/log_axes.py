"""Log axes that are drawn fast: powers of ten as plain text, minor ticks as one line of marks."""

import re
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import TICKDOWN, TICKLEFT
from matplotlib.ticker import Locator, LogFormatterSciNotation, NullLocator

from spintop_figures.style.numbers import MINUS, with_power, write

POWER = re.compile(r"\$\\mathdefault\{(?:(\S+)\\times)?10\^\{(\S+)\}\}\$")
"""A power of ten as a formula, which takes matplotlib ten times as long as plain text."""

FEW_DECADES = 100
"""The ratio of the ends of an axis below which its numbers have no powers of ten."""
PLAIN = 1e-3, 1e4
"""The least and the largest of such numbers."""


def axes_of(figure: Figure) -> list[tuple[Axes, str, Axis]]:
    """Every axis of a figure, also within and beside panels, with its panel and its letter."""
    panels = [each for axes in figure.axes for each in (axes, *axes.child_axes)]
    return [(panel, name, axis) for panel in panels for name, axis in panel._axis_map.items()]


class PlainPowers(LogFormatterSciNotation):
    """Powers of ten with raised digits, and none on a short axis."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        text = super().__call__(x, pos)
        power = POWER.fullmatch(text)
        if not power:
            return text
        low, high = sorted(self.axis.get_view_interval())
        if high < FEW_DECADES * low and PLAIN[0] <= low and high <= PLAIN[1]:
            return write(x)
        return with_power(power[1] or "1", int(power[2].replace(MINUS, "-")))


def write_powers(axis: Axis) -> None:
    """Give a log axis plain powers of ten."""
    for which in ("major", "minor"):
        if type(getattr(axis, f"get_{which}_formatter")()) is LogFormatterSciNotation:
            getattr(axis, f"set_{which}_formatter")(PlainPowers())


class MinorTicks(NamedTuple):
    """The minor ticks that an axis is to have: they have no labels."""

    axes: Axes
    axis: Axis
    locator: Locator


def simplify_log_axes(figure: Figure) -> list[MinorTicks]:
    """Give log axes plain labels, and take minor ticks without labels from them for the layout."""
    taken = []
    for axes in figure.axes:
        for axis, side in ((axes.xaxis, "bottom"), (axes.yaxis, "left")):
            if axis.get_scale() != "log":
                continue
            write_powers(axis)
            low, high = sorted(axis.get_view_interval())
            seen = axes.axison and axis.get_visible()
            if seen and high > 10 * low and axis.get_tick_params("minor").get(side, True):
                taken.append(MinorTicks(axes, axis, axis.get_minor_locator()))
    for _, axis, _ in taken:  # after all are taken: panels that share an axis share its locator
        axis.set_minor_locator(NullLocator())
    return taken


def draw_minor_ticks(ticks: MinorTicks) -> None:
    """Draw the minor ticks of an axis, all as one line: each as a tick takes a millisecond."""
    axes, axis, locator = ticks
    low, high = sorted(axis.get_view_interval())
    places = np.asarray(locator.tick_values(low, high))
    places = places[(places >= low) & (places <= high)]
    zeros = np.zeros(len(places))
    if axis is axes.xaxis:
        x, y, marker, place = places, zeros, TICKDOWN, axes.get_xaxis_transform("tick1")
    else:
        x, y, marker, place = zeros, places, TICKLEFT, axes.get_yaxis_transform("tick1")
    colour = axes.spines["left"].get_edgecolor()
    style = {"color": colour, "markersize": 2, "markeredgewidth": 0.6, "linestyle": ""}
    axes.add_artist(Line2D(x, y, marker=marker, transform=place, clip_on=False, **style))
