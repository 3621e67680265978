"""The quantities of a sweep whose cases fill no grid, as points against each swept parameter."""

import itertools
import textwrap
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Colormap, LinearSegmentedColormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spintop_figures.kinds import figure
from spintop_figures.style.axes import MANY_POINTS, Places, name_axis
from spintop_figures.style.look import FAINT, FAULT, GROUND, OURS, by_width, lightness, tint
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import new_figure, no_axis
from spintop_figures.sweeps import quantities
from spintop_figures.sweeps.maps import COLOURS, SIGNED, is_signed, object_to_grid, scale_of
from spintop_figures.sweeps.quantities import Quantity
from spintop_figures.tables.names import axis_of, count_failures, name_of
from spintop_figures.tables.table import Table

MOST_CASES, LEAST_CASES = 10_000, 300
"""Size of the random sample of many cases, and of each class and of the failed cases."""

MARKERS = "o^sDvPX<>"
"""Of classes, as their colours are numbered; the first three are far apart in lightness."""

SHADES = ListedColormap(COLOURS(np.linspace(0, 0.92, 256)))
"""Colours by a number, without those that are hard to see on white."""

LETTERS = 19
"""Of a line of the labels beside a panel."""

RUG = {"color": FAULT, "marker": "|", "markersize": 6, "markeredgewidth": 0.6}
"""Ticks at the axis for cases that failed."""


class Layer(NamedTuple):
    """Cases of a class, or all that succeeded: which are drawn, of how many, and how."""

    name: str
    rows: pd.DataFrame
    count: int
    look: dict[str, str]


class Cloud(NamedTuple):
    """The cases that are drawn."""

    layers: list[Layer]
    """Those that succeeded, the most numerous below."""
    rows: pd.DataFrame
    """All of these."""
    failed: pd.DataFrame
    rasterized: bool
    """Whether an SVG stores them as pixels."""

    @property
    def area(self) -> float:
        """Of a point, in square points of print: less where there are many."""
        return float(np.clip(15 / len(self.rows) ** 0.25, 1.6, 5.0)) ** 2


def make_cloud(table: Table, panels: int) -> Cloud:
    """The cases that are drawn in so many panels, by class where the table has classes.

    Of many cases they are a random sample, the same one each time; rare groups are complete.
    """
    good = quantities.succeeded(table)
    words = good["motion_class"] if "motion_class" in good else pd.Series("", good.index)
    classes = quantities.order_classes(words)
    groups = [*(good[words == name] for name in classes), table.rows.drop(good.index)]
    share = min(1.0, MOST_CASES / len(table.rows))
    counts = [min(len(group), max(round(share * len(group)), LEAST_CASES)) for group in groups]
    *chosen, failed = (
        group.sample(count, random_state=0).sort_index()
        for group, count in zip(groups, counts, strict=True)
    )
    looks = [
        {"color": f"{OURS}class{number}", "marker": marker}
        for number, marker in enumerate(MARKERS, start=1)
    ]
    layers = [
        Layer(name, rows, len(group), look)
        for name, rows, group, look in zip(classes, chosen, groups, itertools.cycle(looks))
    ]
    layers.sort(key=lambda layer: -layer.count)
    rows = pd.concat([layer.rows for layer in layers])
    return Cloud(layers, rows, failed, (len(rows) + len(failed)) * panels > MANY_POINTS)


class Tint(NamedTuple):
    """What gives points their colours: a number for each case, and its scale."""

    values: pd.Series
    norm: Normalize
    label: tuple[str, str] = ("", "")
    shades: Colormap = SHADES


def varying(table: Table) -> list[str]:
    """The swept parameters that have several values."""
    return [name for name in table.axes() if table.rows[name].nunique() > 1]


def telling(table: Table) -> list[Quantity]:
    """The quantities that have several values."""
    rows = quantities.succeeded(table)
    return [
        quantity
        for quantity in quantities.quantities_of(table)
        if quantity.values(rows).nunique() > 1
    ]


@figure(
    "sweep",
    unless={
        "is no sweep over several parameters": lambda table: len(table.axes()) > 1,
        "is a sweep over a grid of two parameters, which has maps": object_to_grid,
        "is a sweep in which no parameter varies": varying,
        "has no quantity that varies": telling,
    },
)
def draw_scatter(table: Table) -> Figure:
    """Points of a sweep over several parameters that is not a grid of two."""
    names, known = varying(table), telling(table)
    shown, told = names[: by_width(5, 2)], known[:6]
    has_plane = len(names) == by_width(2, 0)
    across = len(shown) + has_plane
    cloud = make_cloud(table, len(told) * across)
    title = "Cases over " + ", ".join(map(name_of, shown))
    parts = [
        f"{write_count(drawn)} of {write_count(count)} {what}"
        for drawn, count, what in (
            (len(cloud.rows) + len(cloud.failed), len(table.rows), "random cases"),
            (len(shown), len(names), "parameters"),
            (len(told), len(known), "quantities"),
        )
        if drawn < count
    ]
    title += (f" ({'; '.join(parts)})" if parts else "") + quantities.tell_hidden(table)
    figure = new_figure(table, title, 1.9 + max(1.45 * len(told), 3.0))
    key, field = figure.add_gridspec(2, 1, height_ratios=[0.2, len(told)])
    panels = field.subgridspec(len(told), across).subplots(squeeze=False)
    is_dense = len(cloud.layers) == 1 and len(cloud.rows) > 1500  # points would hide each other
    tint, densities = None, []
    if len(cloud.layers) == 1:  # no classes are to be told apart
        values, is_log = table.rows[names[0]], quantities.has_log_axis(table, names[0])
        norm = (LogNorm if is_log else Normalize)(values.min(), values.max())
        label = axis_of(names[0]), table.units.get(names[0], "")
        tint = Tint(cloud.rows[names[0]], norm, label)
    for row, quantity in zip(panels, told, strict=True):
        heights = heights_of(quantity, cloud.rows)
        for axes, name in zip(row, shown, strict=False):
            if is_dense:
                logs = (
                    quantities.has_log_axis(table, name),
                    quantity.has_log_scale(heights.to_numpy()),
                )
                densities.append(draw_density(axes, cloud.rows[name], heights, logs))
            else:
                draw_points(axes, cloud, name, heights, tint)
            if len(cloud.failed):  # ticks on the axis, below the points; many are fainter
                axes.margins(y=0.12)
                x, alpha = cloud.failed[name], np.clip(60 / len(cloud.failed), 0.25, 1.0)
                style = {"transform": axes.get_xaxis_transform(), "linestyle": "", "alpha": alpha}
                axes.plot(x, np.full(len(x), 0.035), **style, **RUG)
            scale_heights(axes, quantity, cloud.rows, heights, axes is row[0])
        if has_plane:
            draw_plane(row[-1], shown, cloud, quantity)
    for column, name in zip(panels.T, shown + shown[:has_plane], strict=True):
        scale_parameter(column, "x", table, name)
    if has_plane:
        scale_parameter(panels[:, -1], "y", table, shown[1])
    if densities:
        norm = LogNorm(1, max(max(cells.get_array()) for cells in densities))
        for cells in densities:
            cells.set_norm(norm)
        tint = Tint(pd.Series(dtype=float), norm, ("cases per cell", ""), densities[0].cmap)
    add_key(no_axis(figure.add_subplot(key)), cloud, table, tint)
    figure.align_ylabels(panels[:, 0])
    return figure


def heights_of(quantity: Quantity, rows: pd.DataFrame) -> pd.Series:
    """Where cases stand in the panels of a quantity; those of a class, about its line."""
    values = quantity.values(rows)
    if quantities.is_words(values):
        codes = {name: code for code, name in enumerate(quantities.order_classes(values))}
        # the golden ratio spreads them
        return values.map(codes) + 0.3 * (2 * ((5**0.5 - 1) / 2 * rows["case"] % 1) - 1)
    return pd.Series(quantity.heights(values.to_numpy(float))[0], rows.index)


def draw_density(
    axes: Axes, x: pd.Series, heights: pd.Series, logs: tuple[bool, bool]
) -> PolyCollection:
    """How many cases there are in each cell of a panel; it has to have its scales before.

    The colours are from few cases to many, which are far from the ground.
    """
    there = np.isfinite(heights) & np.isfinite(x)
    ends = ("#0b2038", "#cfdbe8") if lightness(GROUND) < 0.5 else ("#cfdbe8", "#0b2038")
    shades = LinearSegmentedColormap.from_list(
        "densities", [tint(ends[0], 0.2), "#4d7096", ends[1]]
    )
    style = {"gridsize": (46, 18), "mincnt": 1, "cmap": shades, "linewidths": 0.1}
    for which, is_log in zip("xy", logs, strict=True):
        style[f"{which}scale"] = "log" if is_log else "linear"
    return axes.hexbin(x[there], heights[there], **style)


def draw_points(axes: Axes, cloud: Cloud, name: str, heights: pd.Series, tint: Tint | None) -> None:
    """The cases that succeeded against a parameter, in colours of their class or by a number."""
    # by turns, so that no class hides the others
    for turn, layer in itertools.product(reversed(range(6)), cloud.layers):
        rows = layer.rows[turn::6]
        look = layer.look
        if tint:
            look = {"c": tint.values[rows.index], "cmap": tint.shades, "norm": tint.norm}
            look |= {"marker": layer.look["marker"]}
        look = look | {"linewidths": 0, "rasterized": cloud.rasterized}
        axes.scatter(rows[name], heights[rows.index], cloud.area, **look)


def scale_heights(
    axes: Axes, quantity: Quantity, rows: pd.DataFrame, heights: pd.Series, is_first: bool
) -> None:
    """The scale of a quantity: names of classes, a log axis, or a line where its sign changes."""
    values = quantity.values(rows)
    axes.tick_params(which="both", labelleft=is_first)
    if quantities.is_words(values):
        quantities.draw_class_ticks(axes, values, values)
        count = len(axes.get_yticks())
        axes.set_ylim(-0.5 - 0.1 * count, count - 0.4)
        axes.set_ylabel(textwrap.fill(quantity.label, LETTERS) if is_first else "")
        return
    if quantity.has_log_scale(heights.to_numpy()):
        axes.set_yscale("log")
    else:
        axes.yaxis.set_major_locator(Places(5))
        if heights.min() < 0 < heights.max():
            axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)
    if is_first:
        after = quantity.heights(values.to_numpy(float))[1]
        name_axis(axes.yaxis, quantity.label, quantity.unit, after, letters=LETTERS)


def draw_plane(axes: Axes, names: list[str], cloud: Cloud, quantity: Quantity) -> None:
    """The plane of two parameters: points coloured by a quantity, failed cases crossed."""
    x, y = names
    tint = None
    if not quantities.is_words(quantity.values(cloud.rows)):
        numbers = heights_of(quantity, cloud.rows)
        norm, extend = scale_of(quantity, numbers.to_numpy())
        tint = Tint(numbers, norm, shades=SIGNED if is_signed(norm) else SHADES)
        style = {"extend": extend, "pad": 0.03, "aspect": 14}
        bar = axes.figure.colorbar(ScalarMappable(norm, tint.shades), ax=axes, **style)
        name_axis(bar.ax.yaxis, "")  # the first panel of the row has the unit
    draw_points(axes, cloud, x, cloud.rows[y], tint)
    style = {"color": FAULT, "markersize": 4, "markeredgewidth": 0.8}
    axes.plot(cloud.failed[x], cloud.failed[y], "x", rasterized=cloud.rasterized, **style)


def scale_parameter(panels: Sequence[Axes], which: str, table: Table, name: str) -> None:
    """The same scale and limits wherever a parameter is on an axis, with room at the ends."""
    values, is_log = table.column(name), quantities.has_log_axis(table, name)
    ends = np.array([values.min(), values.max()])
    ends = np.log(ends) if is_log else ends
    ends += 0.04 * np.ptp(ends) * np.array([-1, 1])
    ends = np.exp(ends) if is_log else ends
    quantities.scale_panels(panels, which, table, name, is_log, ends, letters=16, steps=4)


def add_key(axes: Axes, cloud: Cloud, table: Table, tint: Tint | None) -> None:
    """What colours and marks mean, and how many cases there are of each."""
    handles = []
    dot = {"linestyle": "", "markersize": 6, "markeredgewidth": 0}
    for layer in () if tint else cloud.layers:
        label = f"{name_of(layer.name)} ({write_count(layer.count)})"
        handles.append(Line2D([], [], **layer.look, **dot, label=label))
    failures = count_failures(table.rows).items()
    if failures:
        words = ", ".join(f"{name_of(status)} ({write_count(count)})" for status, count in failures)
        label = textwrap.fill(f"failed: {words}", 32)
        handles.append(Line2D([], [], **RUG, linestyle="", label=label))
    if tint:
        bar = axes.inset_axes([0.0, 0.0, 0.45, 0.35])
        colours = ScalarMappable(tint.norm, tint.shades)
        axes.figure.colorbar(colours, cax=bar, orientation="horizontal")
        title = bar.set_title("", fontsize="small", pad=3, loc="center")
        words, unit = tint.label
        name_axis(bar.xaxis, f"colours: {words}", unit, holder=title, plain=True)
    if handles:
        place = {"loc": "center right" if tint else "center left", "ncols": by_width(4, 2)}
        axes.legend(handles=handles, **place, handletextpad=0.2, borderpad=0)
