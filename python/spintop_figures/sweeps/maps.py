"""The maps of a sweep over a grid of two parameters."""

import textwrap
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import (
    BoundaryNorm,
    ListedColormap,
)
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from spintop_figures.style.lines import set_degree_ticks
from spintop_figures.style.look import FAULT
from spintop_figures.style.numbers import numbers as plain_numbers
from spintop_figures.style.numbers import write
from spintop_figures.style.page import add_panels, head, is_lowest, new_figure, panel_rows
from spintop_figures.sweeps.fields import jumps, spots
from spintop_figures.sweeps.kapitza import KAPITZA, find_kapitza_limit
from spintop_figures.sweeps.quantities import (
    Quantity,
    has_log_axis,
    is_words,
    label_parameter,
    order_classes,
    parameter_words,
    quantities_of,
    tell_constants,
    tell_failed,
    tell_noise,
)
from spintop_figures.sweeps.scales import COLOURS, colours_of, is_signed, scale_of
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of, with_unit
from spintop_figures.tables.table import Table

LETTER, LINE = 0.085, 0.16
"""Width of a letter and height of a line of a name in a map, in inches."""

PANEL_HEIGHT, LEAST_HEIGHT = 2.6, 4.0
"""Of a row of panels, and of all of them, in inches."""


class Grid(NamedTuple):
    """The cases of a sweep by the values of two parameters."""

    x: np.ndarray
    y: np.ndarray
    place: np.ndarray
    """Place of each row in the grid, which runs through y first."""
    logs: tuple[bool, bool]
    """Whether x and y are on log axes."""

    def fill(self, values: np.ndarray) -> np.ndarray:
        """Values of the rows as an array over y and x."""
        cells = np.full(self.x.size * self.y.size, np.nan)
        cells[self.place] = values
        return cells.reshape(self.x.size, self.y.size).T

    def edges(self) -> list[np.ndarray]:
        """The edges of the cells along x and y."""
        return [
            np.exp(edges_of(np.log(axis))) if is_log else edges_of(axis)
            for axis, is_log in zip((self.x, self.y), self.logs, strict=True)
        ]


def edges_of(centres: np.ndarray) -> np.ndarray:
    """The edges of cells half-way between their centres."""
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])


def make_grid(table: Table) -> Grid:
    """The grid of the two parameters."""
    (x, column), (y, line) = (
        np.unique(table.rows[name].to_numpy(float), return_inverse=True) for name in table.axes()
    )
    return Grid(x, y, column * y.size + line, (has_log_axis(table, 0), has_log_axis(table, 1)))


def object_to_grid(table: Table) -> str:
    """Maps are over two parameters, all of whose values are combined."""
    if len(table.axes()) != 2:
        return "is no sweep over two parameters"
    grid = make_grid(table)
    if min(grid.x.size, grid.y.size) < 2:
        return "is a sweep with a single value of a parameter"
    cells = grid.x.size * grid.y.size
    if grid.place.size != cells or not np.array_equal(np.sort(grid.place), np.arange(cells)):
        return "is a sweep over no grid"
    return ""


def object_to_maps(table: Table) -> str:
    """Maps show the quantities of a grid."""
    return object_to_grid(table) or ("" if quantities_of(table) else "has no quantity to map")


def draw_maps(table: Table) -> Figure:
    """A map of each quantity that the table has."""
    grid = make_grid(table)
    quantities = quantities_of(table)
    down = panel_rows(len(quantities))
    names = " and ".join(map(parameter_words, table.axes()))
    notes = tell_failed(table) + tell_constants(table) + tell_noise(table)
    height = 1.2 + max(PANEL_HEIGHT * down, LEAST_HEIGHT)
    figure = new_figure(table, f"The motion over {names}{notes}", height)
    failed = ~ended_well(table.rows).to_numpy()
    panels = add_panels(figure, len(quantities))
    for quantity, axes in zip(quantities, panels, strict=True):
        draw_map(axes, grid, quantity, quantity.values(table.rows), failed)
        cross(axes, grid, failed)
    label_axes(table, grid, panels)
    if limit := find_kapitza_limit(table):
        for axes in panels:
            draw_limit(axes, limit)
    return figure


def draw_limit(axes: Axes, limit: Callable[[np.ndarray], np.ndarray]) -> None:
    """Kapitza's limit over a map: the second parameter at each value of the first."""
    x = np.geomspace(*axes.get_xlim(), 200)
    outline = [withStroke(linewidth=3.5, foreground="white")]
    style = {"color": "black", "linewidth": 1.4, "scalex": False, "scaley": False}
    axes.plot(x, limit(x), **style, path_effects=outline, label=KAPITZA)
    axes.legend(loc="lower left", frameon=True, framealpha=0.85, edgecolor="none", fontsize=8)


def draw_map(
    axes: Axes, grid: Grid, quantity: Quantity, values: pd.Series, failed: np.ndarray
) -> None:
    """A filled map; cases without a value are hatched, failed ones crossed."""
    axes.patch.set(facecolor="white", edgecolor="0.7", hatch="////")
    title = with_unit(quantity.label, quantity.unit)
    head(axes, title)
    if is_words(values):
        draw_classes(axes, grid, values, failed)
    else:
        draw_numbers(axes, grid, quantity, values.to_numpy(float), failed)


def draw_classes(axes: Axes, grid: Grid, values: pd.Series, failed: np.ndarray) -> None:
    """A map of classes, each with its name in it; those without room for it are in a legend."""
    classes = order_classes(values[~failed])
    codes = {name: float(code) for code, name in enumerate(classes)}
    numbers = np.where(failed, np.nan, values.map(codes).to_numpy(float))
    shades = ListedColormap(COLOURS(np.linspace(0.05, 0.95, len(classes))))
    norm = BoundaryNorm(np.arange(len(classes) + 1) - 0.5, len(classes))
    cells = grid.fill(numbers)
    look = {"cmap": shades, "norm": norm, "rasterized": True}
    axes.pcolormesh(*grid.edges(), np.ma.masked_invalid(cells), **look)
    named = set()
    width, height = room_of(axes)
    for spot in spots(cells):
        name = name_of(classes[spot.code])
        if spot.width * width < LETTER * len(name) or spot.height * height < LINE:
            continue
        named.add(name)
        ink = "black" if lightness(shades(spot.code)) > 0.45 else "white"
        style = {"ha": "center", "va": "center", "fontsize": 9, "color": ink}
        axes.text(spot.x, spot.y, name, transform=axes.transAxes, parse_math=False, **style)
    handles = [
        Patch(color=shades(code), label=name_of(name))
        for code, name in enumerate(classes)
        if name_of(name) not in named
    ]
    if handles:
        place = {"loc": "lower right", "bbox_to_anchor": (1.02, 0.99), "ncols": 3}
        axes.legend(handles=handles, **place, handlelength=1, columnspacing=0.8, borderpad=0.2)


def room_of(axes: Axes) -> tuple[float, float]:
    """About how wide and how high a panel is, in inches, before it is laid out."""
    spot = axes.get_subplotspec()
    rows, columns = spot.get_gridspec().get_geometry()
    width, height = axes.figure.get_size_inches()
    across = len(spot.colspan) / columns
    return 0.78 * width * across, 0.72 * height / rows


def lightness(colour: tuple[float, ...]) -> float:
    """How light a colour is, from 0 to 1."""
    return float(np.dot(colour[:3], (0.299, 0.587, 0.114)))


def draw_numbers(
    axes: Axes, grid: Grid, quantity: Quantity, numbers: np.ndarray, failed: np.ndarray
) -> None:
    """A map of a number with its colour bar; of both signs, with its zero where continuous."""
    none = quantity.is_none(np.where(failed, np.nan, numbers))
    if none.any():
        axes.set_title(f"{axes.get_title(loc='left')}; white: {quantity.none}", loc="left")
        blank = np.ma.masked_equal(grid.fill(none & ~failed), 0)
        axes.pcolormesh(*grid.edges(), blank, cmap=ListedColormap(["white"]), rasterized=True)
    numbers = quantity.shown(np.where(none | failed, np.nan, numbers))
    norm, extend = scale_of(quantity, numbers)
    whole = np.ma.masked_invalid(grid.fill(numbers))
    cells = np.ma.masked_invalid(grid.fill(np.clip(numbers, norm.vmin, norm.vmax)))
    look = {"cmap": colours_of(norm), "norm": norm, "rasterized": True}
    image = axes.pcolormesh(*grid.edges(), cells, **look)
    bar = axes.figure.colorbar(image, ax=axes, extend=extend, pad=0.02, aspect=18)
    if whole.count() and whole.min() == whole.max():
        bar.set_ticks([whole.min()])
    elif is_signed(norm):
        draw_zero(axes, grid, whole)
        name_signs(axes, whole)
    if quantity.most and whole.count():
        name_regions(axes, np.ma.filled(whole == whole.max(), False), quantity.most)


def name_regions(axes: Axes, there: np.ndarray, name: str) -> None:
    """A name in each large region of some cells."""
    width, height = room_of(axes)
    for spot in spots(np.where(there, 0.0, np.nan)):
        lines = textwrap.fill(name, max(int(spot.width * width / LETTER), 8))
        if spot.height * height > LINE * (lines.count("\n") + 1):
            style = {"ha": "center", "va": "center", "fontsize": 9, "color": "0.1"}
            axes.text(spot.x, spot.y, lines, transform=axes.transAxes, **style)


def name_signs(axes: Axes, cells: np.ma.MaskedArray) -> None:
    """The sign of each large region in it, for print without colours."""
    width, height = room_of(axes)
    for spot in spots((np.ma.filled(cells, np.nan) > 0) + 0.0 * np.ma.filled(cells, np.nan)):
        if spot.width * width > 3 * LETTER and spot.height * height > LINE:
            style = {"ha": "center", "va": "center", "fontsize": 8, "color": "0.1"}
            outline = [withStroke(linewidth=1.5, foreground=(1, 1, 1, 0.6))]
            words = "> 0" if spot.code else "< 0"
            place = {"transform": axes.transAxes, "path_effects": outline}
            axes.text(spot.x, spot.y, words, **style, **place)


def draw_zero(axes: Axes, grid: Grid, cells: np.ma.MaskedArray) -> None:
    """The line where a field is zero; where it jumps from one sign to the other there is none."""
    cut, size = jumps(cells)
    known = np.ma.masked_where(cut, cells)
    if known.count() and known.min() < 0 < known.max():
        axes.contour(grid.x, grid.y, known, levels=[0], colors="0.25", linewidths=1.0)
    if cut.any():
        title = axes.get_title(loc="left")
        axes.set_title(f"{title},\nwith jumps by about {write(size, 3)}", loc="left")


def cross(axes: Axes, grid: Grid, failed: np.ndarray) -> None:
    """A cross on each case that failed, no larger than its cell but large enough to be seen."""
    if not failed.any():
        return
    column, line = np.divmod(grid.place[failed], grid.y.size)
    size = float(np.clip(120 / max(grid.x.size, grid.y.size), 1.5, 6))
    style = {"markersize": size, "markeredgewidth": size / 6, "color": FAULT}
    axes.plot(grid.x[column], grid.y[line], "x", linestyle="", rasterized=True, **style)


def label_axes(table: Table, grid: Grid, panels: list[Axes]) -> None:
    """Scales and labels of the parameters; labels at the left and lowest panels only."""
    plain = plain_numbers()
    x_edges, y_edges = grid.edges()
    panels[0].set(xlim=(x_edges[0], x_edges[-1]), ylim=(y_edges[0], y_edges[-1]))
    panels[0].set(xscale=scale_name(grid.logs[0]), yscale=scale_name(grid.logs[1]))
    for axes in panels:
        spot = axes.get_subplotspec()
        for axis, is_log in zip((axes.xaxis, axes.yaxis), grid.logs, strict=True):
            if is_log:
                axis.set_major_formatter(plain)
        if spot.is_first_col():
            label_parameter(table, 1, axes.yaxis)
        if table.units.get(table.axes()[1]) == "deg":
            set_degree_ticks(axes.yaxis, grid.y)
        if is_lowest(axes):
            label_parameter(table, 0, axes.xaxis)


def scale_name(is_log: bool) -> str:
    """What matplotlib calls a scale."""
    return "log" if is_log else "linear"
