"""The maps of a sweep over a grid of two parameters."""

from typing import NamedTuple

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from figures.quantities import (
    Quantity,
    has_log_axis,
    is_words,
    label_parameter,
    order_classes,
    quantities_of,
    tell_failed,
)
from figures.style import FAULT, add_panels, new_figure, set_degree_ticks, with_unit
from figures.table import Table

COLOURS = mpl.colormaps["cividis"]
"""From dark to light, for all eyes and for print without colours."""

OUTLIERS = 1.0
"""Percentage of the values, at either end, that may be beyond the colour bar."""

FAR = 0.5
"""They are where they would take more than this of the range of the others."""

PANEL_HEIGHT, LEAST_HEIGHT = 2.5, 4.0
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
    down = (len(quantities) + 1) // 2
    names = " and ".join(name.partition(".")[2] for name in table.axes())
    title = f"Maps over {names}{tell_failed(table)}"
    figure = new_figure(table, title, 1.2 + max(PANEL_HEIGHT * down, LEAST_HEIGHT))
    failed = (table.rows["status"] != "ok").to_numpy()
    panels = add_panels(figure, len(quantities))
    for quantity, axes in zip(quantities, panels, strict=True):
        draw_map(axes, grid, quantity, quantity.values(table.rows), failed)
        cross(axes, grid, failed)
    label_axes(table, grid, panels)
    return figure


def draw_map(
    axes: Axes, grid: Grid, quantity: Quantity, values: pd.Series, failed: np.ndarray
) -> None:
    """A filled map with its colour bar; cases without a value are hatched, failed ones crossed."""
    title = with_unit(quantity.label, quantity.unit)
    axes.patch.set(facecolor="white", edgecolor="0.7", hatch="////")
    if is_words(values):
        classes = order_classes(values[~failed])
        codes = {name: float(code) for code, name in enumerate(classes)}
        numbers = values.map(codes).to_numpy(float)
        shades = ListedColormap(COLOURS(np.linspace(0.05, 0.95, len(classes))))
        norm, extend = BoundaryNorm(np.arange(len(classes) + 1) - 0.5, len(classes)), "neither"
    else:
        numbers, shades = values.to_numpy(float), COLOURS
        none = quantity.is_none(np.where(failed, np.nan, numbers))
        if none.any():
            title += f"; white: {quantity.none}"
            blank = np.ma.masked_equal(grid.fill(none & ~failed), 0)
            axes.pcolormesh(*grid.edges(), blank, cmap=ListedColormap(["white"]), rasterized=True)
        numbers = np.where(none, np.nan, numbers)
        norm, extend = scale_of(quantity, numbers[~failed])
        numbers = np.clip(numbers, norm.vmin, norm.vmax)
    axes.set_title(title, loc="left", fontsize=9.5, pad=4)
    cells = np.ma.masked_invalid(grid.fill(np.where(failed, np.nan, numbers)))
    image = axes.pcolormesh(*grid.edges(), cells, cmap=shades, norm=norm, rasterized=True)
    bar = axes.figure.colorbar(image, ax=axes, extend=extend, pad=0.02, aspect=18)
    if cells.count() and cells.min() == cells.max() and not is_words(values):
        bar.set_ticks([cells.min()])
    elif is_words(values):
        bar.set_ticks(range(len(classes)), labels=classes)
        bar.ax.tick_params(length=0)
    elif norm.vmin < 0 < norm.vmax:
        axes.contour(grid.x, grid.y, cells, levels=[0], colors="white", linewidths=1.2)
        bar.ax.axhline(0, color="white", linewidth=1.2)


def scale_of(quantity: Quantity, values: np.ndarray) -> tuple[Normalize, str]:
    """The scale of the colours of values, and at which ends some are beyond it."""
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
    below, beyond = finite.min() < low - room, finite.max() > high + room
    ends = {(True, True): "both", (True, False): "min", (False, True): "max"}
    norm = Normalize(low if below else finite.min(), high if beyond else finite.max())
    return norm, ends.get((bool(below), bool(beyond)), "neither")


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
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    x_edges, y_edges = grid.edges()
    panels[0].set(xlim=(x_edges[0], x_edges[-1]), ylim=(y_edges[0], y_edges[-1]))
    panels[0].set(xscale=scale_name(grid.logs[0]), yscale=scale_name(grid.logs[1]))
    for axes in panels:
        spot = axes.get_subplotspec()
        for axis, is_log in zip((axes.xaxis, axes.yaxis), grid.logs, strict=True):
            if is_log:
                axis.set_major_formatter(plain)
        axes.tick_params(labelleft=spot.is_first_col(), labelbottom=spot.is_last_row())
        if spot.is_first_col():
            label_parameter(table, 1, axes.yaxis)
        if table.units.get(table.axes()[1]) == "deg":
            set_degree_ticks(axes, grid.y)
        if spot.is_last_row():
            label_parameter(table, 0, axes.xaxis)


def scale_name(is_log: bool) -> str:
    """What matplotlib calls a scale."""
    return "log" if is_log else "linear"
