"""The quantities of a sweep whose cases fill no grid, as points against each swept parameter."""

import itertools
import re
import textwrap
from collections.abc import Iterable, Sized
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import (
    Colormap,
    LinearSegmentedColormap,
    ListedColormap,
    LogNorm,
    Normalize,
)
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from spintop_figures.style.look import FAINT, FAULT, by_width
from spintop_figures.style.numbers import numbers as plain_numbers
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import new_figure
from spintop_figures.sweeps.cloud import Cloud, make_cloud
from spintop_figures.sweeps.maps import object_to_grid, scale_name
from spintop_figures.sweeps.quantities import (
    Quantity,
    has_log_axis,
    is_words,
    name_parameter,
    order_classes,
    parameter_words,
    quantities_of,
    succeeded,
    tell_noise,
)
from spintop_figures.sweeps.scales import COLOURS, colours_of, is_signed, scale_of
from spintop_figures.tables.ends import count_failures
from spintop_figures.tables.names import name_of, with_unit
from spintop_figures.tables.table import Table

MOST_PARAMETERS, NARROW_PARAMETERS, MOST_QUANTITIES = 4, 2, 6
"""The first of them are drawn; fewer on a narrow figure."""

SHADES = ListedColormap(COLOURS(np.linspace(0, 0.92, 256)))
"""Colours by a number, without those that are hard to see on white."""

ROW_HEIGHT, LEAST_HEIGHT = 1.45, 3.0
"""Of a row of panels, and of all of them, in inches."""

KEY_HEIGHT = 0.2
"""Of the key above the panels, as a part of a row's."""

LABEL_LETTERS, NARROW_LETTERS, FAILED_LETTERS = 19, 16, 32
"""Length of a line of the labels beside and below a panel, and of the failures in the key."""

JITTER = 0.3
"""How far the cases of a class stand from their line, at most; the golden ratio spreads them."""

TURNS = 6
"""Classes are drawn by turns, so that none hides the others."""

GOLDEN = (5**0.5 - 1) / 2

RUG = {"color": FAULT, "marker": "|", "markersize": 6, "markeredgewidth": 0.6}
"""Ticks at the axis for cases that failed."""

FULL, FAINTEST = 60, 0.25
"""So many ticks are drawn in full colour; more are fainter, so that it is seen where most are."""


CELLS = 46, 18
"""Cells across and down a panel in which cases are counted."""

DENSITIES = LinearSegmentedColormap.from_list("densities", ["#cfdbe8", "#4d7096", "#0b2038"])
"""From few cases to many."""


class Tint(NamedTuple):
    """What gives points their colours: a number for each case, and its scale."""

    values: pd.Series
    norm: Normalize
    label: str = ""
    shades: Colormap = SHADES


def varying(table: Table) -> list[int]:
    """The places of the swept parameters that have several values."""
    return [i for i, name in enumerate(table.axes()) if table.rows[name].nunique() > 1]


def telling(table: Table) -> list[Quantity]:
    """The quantities that have several values."""
    rows = succeeded(table)
    return [quantity for quantity in quantities_of(table) if quantity.values(rows).nunique() > 1]


def object_to_scatter(table: Table) -> str:
    """Points are for cases of several parameters that are no grid of two."""
    if len(table.axes()) < 2:
        return "is no sweep over several parameters"
    if not object_to_grid(table):
        return "is a sweep over a grid of two parameters, which has maps"
    if not varying(table):
        return "is a sweep in which no parameter varies"
    return "" if telling(table) else "has no quantity that varies"


def draw_scatter(table: Table) -> Figure:
    """One row of panels per quantity, one panel per parameter; two parameters span a plane."""
    places, quantities = varying(table), telling(table)
    most = by_width(MOST_PARAMETERS, NARROW_PARAMETERS)
    shown, told = places[:most], quantities[:MOST_QUANTITIES]
    has_plane = len(places) == by_width(2, 0)
    across = len(shown) + has_plane
    cloud = make_cloud(table, len(told) * across)
    counts = ((table.rows, cloud.count, "random cases"), (places, len(shown), "parameters"))
    title = "Cases over " + ", ".join(parameter_words(table.axes()[place]) for place in shown)
    title += tell_left_out((*counts, (quantities, len(told), "quantities"))) + tell_noise(table)
    figure = new_figure(table, title, 1.9 + max(ROW_HEIGHT * len(told), LEAST_HEIGHT))
    key, field = figure.add_gridspec(2, 1, height_ratios=[KEY_HEIGHT, len(told)])
    panels = field.subgridspec(len(told), across).subplots(squeeze=False)
    tint = None if len(cloud.layers) > 1 else tint_by_parameter(table, places[0], cloud)
    densities = []
    for row, quantity in zip(panels, told, strict=True):
        heights = heights_of(quantity, cloud.rows)
        for axes, place in zip(row, shown, strict=False):
            name = table.axes()[place]
            if cloud.is_dense:
                logs = has_log_axis(table, place), quantity.has_log_scale(heights.to_numpy())
                densities.append(draw_density(axes, cloud.rows[name], heights, logs))
            else:
                draw_points(axes, cloud, name, heights, tint)
            mark_failed(axes, cloud.failed[name].to_numpy(float))
            scale_heights(axes, quantity, cloud.rows, heights)
            axes.tick_params(labelleft=axes is row[0])
        row[0].set_ylabel(label_quantity(quantity, cloud.rows), fontsize=9)
        if has_plane:
            draw_plane(row[-1], table, shown, cloud, quantity)
    set_parameter_axes(panels, table, shown, has_plane)
    if densities:
        norm = LogNorm(1, max(max(cells.get_array()) for cells in densities))
        for cells in densities:
            cells.set_norm(norm)
        tint = Tint(pd.Series(dtype=float), norm, "cases per cell", DENSITIES)
    add_key(figure.add_subplot(key), cloud, table, tint)
    Figure.align_ylabels(figure, panels[:, 0])  # before the layout: labels have several lines
    return figure


def tell_left_out(counts: Iterable[tuple[Sized, int, str]]) -> str:
    """Of what not all is drawn, and how much is."""
    parts = [
        f"{write_count(drawn)} of {write_count(len(things))} {what}"
        for things, drawn, what in counts
        if drawn < len(things)
    ]
    return f" ({'; '.join(parts)})" if parts else ""


def heights_of(quantity: Quantity, rows: pd.DataFrame) -> pd.Series:
    """Where cases stand in the panels of a quantity; those of a class, about its line."""
    values = quantity.values(rows)
    if is_words(values):
        codes = {name: code for code, name in enumerate(order_classes(values))}
        return values.map(codes) + JITTER * (2 * (GOLDEN * rows["case"] % 1) - 1)
    numbers = values.to_numpy(float)
    numbers = quantity.shown(np.where(quantity.is_none(numbers), 0.0, numbers))
    if quantity.has_log_scale(numbers):
        numbers = np.where(numbers > 0, numbers, np.nan)
    return pd.Series(numbers, rows.index)


def draw_density(
    axes: Axes, x: pd.Series, heights: pd.Series, logs: tuple[bool, bool]
) -> PolyCollection:
    """How many cases there are in each cell of a panel; it has to have its scales before."""
    there = np.isfinite(heights) & np.isfinite(x)
    scales = {f"{which}scale": scale_name(is_log) for which, is_log in zip("xy", logs, strict=True)}
    return axes.hexbin(
        x[there], heights[there], gridsize=CELLS, mincnt=1, cmap=DENSITIES, linewidths=0.1, **scales
    )


def draw_points(axes: Axes, cloud: Cloud, name: str, heights: pd.Series, tint: Tint | None) -> None:
    """The cases that succeeded against a parameter, in colours of their class or by a number."""
    for turn, layer in itertools.product(reversed(range(TURNS)), cloud.layers):
        rows = layer.rows[turn::TURNS]
        look = {"color": layer.colour}
        if tint:
            look = {"c": tint.values[rows.index], "cmap": tint.shades, "norm": tint.norm}
        axes.scatter(
            rows[name],
            heights[rows.index],
            cloud.area,
            marker=layer.marker,
            linewidths=0,
            rasterized=cloud.rasterized,
            **look,
        )


def mark_failed(axes: Axes, x: np.ndarray) -> None:
    """Ticks on the axis where cases failed, below the points."""
    if x.size:
        axes.margins(y=0.12)
        alpha = float(np.clip(FULL / x.size, FAINTEST, 1.0))
        style = {"transform": axes.get_xaxis_transform(), "linestyle": "", "alpha": alpha}
        axes.plot(x, np.full_like(x, 0.035), **style, **RUG)


def scale_heights(axes: Axes, quantity: Quantity, rows: pd.DataFrame, heights: pd.Series) -> None:
    """The scale of a quantity: names of classes, a log axis, or a line where its sign changes."""
    values = quantity.values(rows)
    if is_words(values):
        classes = order_classes(values)
        axes.set_yticks(range(len(classes)), labels=list(map(name_of, classes)))
        axes.set_ylim(-0.5 - 0.1 * len(classes), len(classes) - 0.4)
    elif quantity.has_log_scale(heights.to_numpy()):
        axes.set_yscale("log")
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5))
        if heights.min() < 0 < heights.max():
            axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)


def draw_plane(
    axes: Axes, table: Table, places: list[int], cloud: Cloud, quantity: Quantity
) -> None:
    """The plane of two parameters: points coloured by a quantity, failed cases crossed."""
    x, y = (table.axes()[place] for place in places)
    values = quantity.values(cloud.rows)
    tint = None
    if not is_words(values):
        numbers = heights_of(quantity, cloud.rows)
        norm, extend = scale_of(quantity, numbers.to_numpy())
        tint = Tint(numbers, norm, shades=shades_of(norm))
        bar = axes.figure.colorbar(
            ScalarMappable(norm, shades_of(norm)), ax=axes, extend=extend, pad=0.03, aspect=14
        )
        bar.ax.tick_params(labelsize=8)
    draw_points(axes, cloud, x, cloud.rows[y], tint)
    style = {"color": FAULT, "markersize": 4, "markeredgewidth": 0.8}
    axes.plot(cloud.failed[x], cloud.failed[y], "x", rasterized=cloud.rasterized, **style)


def shades_of(norm: Normalize) -> Colormap:
    """The colours of a scale that can be seen on white."""
    return colours_of(norm) if is_signed(norm) else SHADES


def label_quantity(quantity: Quantity, rows: pd.DataFrame) -> str:
    """A quantity with its unit in short lines, and what 0 means if that has a name."""
    label = with_unit(quantity.label, quantity.unit)
    values = quantity.values(rows)
    if not is_words(values) and quantity.is_none(values.to_numpy(float)).any():
        label += f"; 0: {quantity.none}"
    return textwrap.fill(label, LABEL_LETTERS)


def set_parameter_axes(
    panels: np.ndarray, table: Table, places: list[int], has_plane: bool
) -> None:
    """Scales, limits and labels of the parameters: those below at the lowest panels only."""
    for column, place in enumerate([*places, places[0]] if has_plane else places):
        for axes in panels[:, column]:
            set_parameter_axis(axes, "x", table, place)
            axes.tick_params(labelbottom=axes is panels[-1, column])
        panels[-1, column].set_xlabel(break_name(table, place), fontsize=9)
    for axes in panels[:, -1] if has_plane else ():
        set_parameter_axis(axes, "y", table, places[1])
        axes.set_ylabel(break_name(table, places[1]), fontsize=9)


def set_parameter_axis(axes: Axes, which: str, table: Table, place: int) -> None:
    """The same scale and limits wherever a parameter is on an axis, with room at the ends."""
    values = table.rows[table.axes()[place]].to_numpy(float)
    is_log = has_log_axis(table, place)
    ends = np.array([values.min(), values.max()])
    ends = np.log(ends) if is_log else ends
    ends += 0.04 * np.ptp(ends) * np.array([-1, 1])
    axes.set(**{f"{which}scale": scale_name(is_log)})
    axes.set(**{f"{which}lim": tuple(np.exp(ends) if is_log else ends)})
    axis = axes.xaxis if which == "x" else axes.yaxis
    if is_log:
        axis.set_major_formatter(plain_numbers())
        axis.set_minor_formatter("")
    else:
        axis.set_major_locator(MaxNLocator(4))


def break_name(table: Table, place: int) -> str:
    """A parameter with its unit in short lines, broken before a formula or the unit."""
    name = name_parameter(table, place)
    if len(name) <= NARROW_LETTERS:
        return name
    words, *rest = re.split(r" (?=[$(])", name, maxsplit=1)
    return "\n".join([*textwrap.wrap(words, NARROW_LETTERS), *rest])


def tint_by_parameter(table: Table, place: int, cloud: Cloud) -> Tint:
    """The colours of a parameter, where no classes are to be told apart."""
    name = table.axes()[place]
    values = table.rows[name]
    norm = (LogNorm if has_log_axis(table, place) else Normalize)(values.min(), values.max())
    return Tint(cloud.rows[name], norm, name_parameter(table, place))


def add_key(axes: Axes, cloud: Cloud, table: Table, tint: Tint | None) -> None:
    """What colours and marks mean, and how many cases there are of each."""
    handles = []
    for layer in () if tint else cloud.layers:
        look = {"color": layer.colour, "marker": layer.marker, "markersize": 6}
        handles.append(
            a_mark(f"{name_of(layer.name)} ({write_count(layer.count)})", markeredgewidth=0, **look)
        )
    failures = count_failures(table.rows)
    if failures:
        words = ", ".join(
            f"{name_of(status)} ({write_count(count)})" for status, count in failures.items()
        )
        handles.append(a_mark(textwrap.fill(f"failed: {words}", FAILED_LETTERS), **RUG))
    axes.set_axis_off()
    if tint:
        bar = axes.inset_axes([0.0, 0.0, 0.45, 0.35])
        colours = ScalarMappable(tint.norm, tint.shades)
        axes.figure.colorbar(colours, cax=bar, orientation="horizontal")
        bar.set_title(f"colours: {tint.label}", fontsize=9, pad=3)
        if isinstance(tint.norm, LogNorm):
            bar.xaxis.set_major_formatter(plain_numbers())
        bar.tick_params(labelsize=8)
    if handles:
        place = "center right" if tint else "center left"
        columns = by_width(4, 2)
        axes.legend(handles=handles, loc=place, ncols=columns, handletextpad=0.2, borderpad=0)


def a_mark(label: str, **style: object) -> Line2D:
    """An entry of the key."""
    return Line2D([], [], linestyle="", label=label, **style)
