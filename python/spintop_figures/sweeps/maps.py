"""The maps of a sweep over a grid of two parameters, and the colours of numbers."""

import textwrap
from collections.abc import Callable, Sequence
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import (
    BoundaryNorm,
    Colormap,
    LinearSegmentedColormap,
    ListedColormap,
    LogNorm,
    Normalize,
)
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import acting
from spintop_figures.moving.body import GRAVITY
from spintop_figures.style.look import FAULT, lightness
from spintop_figures.style.numbers import write
from spintop_figures.style.page import head, panel_figure
from spintop_figures.sweeps.quantities import (
    Quantity,
    has_log_axis,
    is_words,
    order_classes,
    quantities_of,
    set_parameter_axis,
    tell_rest,
)
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import ended_well

COLOURS = mpl.colormaps["cividis"]
"""From dark to light, for all eyes and for print without colours."""

SIGNED = LinearSegmentedColormap.from_list(
    "signed", ["#0b2a4f", "#3f6d9e", "#a9c3dc", "#f4f2ee", "#f2bd8e", "#de7f35", "#ab4a0c"]
)
"""For values of both signs, with a neutral zero; the ends differ in lightness, too."""

OUTLIERS, FAR = 1.0, 0.5
"""Percentage of the values, at either end, that may be beyond the colour bar, which they are where
they would take more than this of the range of the others."""

LETTER, LINE = 0.085, 0.16
"""Width of a letter and height of a line of a name in a map, in inches."""

HEIGHTS = 2.6, 4.0
"""Of a row of panels, and of all of them, in inches."""

BLANK = {"facecolor": "white", "edgecolor": "0.7", "hatch": "////"}
"""Of a map where there is no value."""

WORDS = {"ha": "center", "va": "center", "fontsize": "small"}
"""Of a name in a map, whose colours are the same on dark ground."""

RATE, AMPLITUDE = "effects.vibration_rate", "effects.vibration_amplitude(3)"

KAPITZA = r"Kapitza: $A\,\Omega=\sqrt{2gI/(ml)}$"
"""What the limit is, as a legend has it."""


COARSE = 60
"""Cells of a grid along an axis by which the place of a name is found; finer ones are skipped."""


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


def colours_of(norm: Normalize) -> Colormap:
    """The colours of a scale."""
    return SIGNED if is_signed(norm) else COLOURS


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
        np.unique(table.column(name), return_inverse=True) for name in table.axes()
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


@figure("sweep", objection=object_to_maps)
def draw_maps(table: Table) -> Figure:
    """Maps of the quantities of a sweep over a grid of two parameters."""
    grid, quantities = make_grid(table), quantities_of(table)
    names = " and ".join(map(name_of, table.axes()))
    title = f"The motion over {names}{tell_rest(table)}"
    figure, panels = panel_figure(table, title, len(quantities), *HEIGHTS)
    failed = ~ended_well(table.rows).to_numpy()
    for quantity, axes in zip(quantities, panels, strict=True):
        axes.patch.set(**BLANK)
        values = quantity.values(table.rows)
        if is_words(values):
            head(axes, quantity.label)
            draw_classes(axes, grid, values, failed)
        else:
            draw_numbers(axes, grid, quantity, values.to_numpy(float), failed)
        cross(axes, grid, failed)
    label_axes(table, grid, panels)
    if limit := find_kapitza_limit(table):
        for axes in panels:
            draw_limit(axes, limit)
    return figure


def find_kapitza_limit(table: Table) -> Callable[[np.ndarray], np.ndarray] | None:
    """The second swept parameter at the limit, as a function of the first; None if there is none.

    A vertical vibration a cos(W t) of the pivot, averaged over its period, adds the potential
    (m l a W)^2 sin(theta)^2/(4 I) to m g l cos(theta), with I about the pivot. The body without
    spin is stable upright if the curvature of the sum is positive there: a W > sqrt(2 g I/(m l)).
    With I = m l^2 it is the pendulum's sqrt(2 g l). It holds for fast vibrations of small
    amplitude, a body given by its moments of inertia, and no other effect.
    """
    if sorted(table.axes()) != sorted((RATE, AMPLITUDE)):
        return None
    others = set(acting(table, "effects.")) - {"effects.vibration_amplitude"}
    spins = any(table.number(f"initial.{key}", 0.0) for key in ("omega3", "psi_rate"))
    if others or spins or acting(table, "top.damping") or table.setting("top.shape") != "inertia":
        return None
    mass, length, inertia = (table.number(f"top.{key}") for key in ("mass", "length", "inertia"))
    if table.setting("top.inertia_about") == "centre_of_mass":
        inertia += mass * length**2
    limit = np.sqrt(2 * table.number("top.gravity", GRAVITY) * inertia / (mass * length))
    return (lambda values: limit / values) if np.isfinite(limit) else None


def draw_limit(axes: Axes, limit: Callable[[np.ndarray], np.ndarray]) -> None:
    """Kapitza's limit over a map: the second parameter at each value of the first."""
    x = np.geomspace(*axes.get_xlim(), 200)
    outline = [withStroke(linewidth=3.5, foreground="white")]
    style = {"color": "black", "linewidth": 1.4, "scalex": False, "scaley": False}
    axes.plot(x, limit(x), **style, path_effects=outline, label=KAPITZA)
    box = {"frameon": True, "framealpha": 0.85, "facecolor": "white", "edgecolor": "none"}
    axes.legend(loc="lower left", labelcolor="black", **box)


def draw_classes(axes: Axes, grid: Grid, values: pd.Series, failed: np.ndarray) -> None:
    """A map of classes, each with its name in it; those without room for it are in a legend."""
    classes = order_classes(values[~failed])
    codes = {name: float(code) for code, name in enumerate(classes)}
    shades = ListedColormap(COLOURS(np.linspace(0.05, 0.95, len(classes))))
    norm = BoundaryNorm(np.arange(len(classes) + 1) - 0.5, len(classes))
    cells = grid.fill(np.where(failed, np.nan, values.map(codes).to_numpy(float)))
    look = {"cmap": shades, "norm": norm, "rasterized": True}
    axes.pcolormesh(*grid.edges(), np.ma.masked_invalid(cells), **look)
    names, named = [*map(name_of, classes)], set()
    width, height = room_of(axes)
    for spot in spots(cells):
        name = names[spot.code]
        if spot.width * width >= LETTER * len(name) and spot.height * height >= LINE:
            named.add(name)
            ink = "black" if lightness(shades(spot.code)) > 0.45 else "white"
            style = WORDS | {"transform": axes.transAxes, "color": ink}
            axes.text(spot.x, spot.y, name, parse_math=False, **style)
    rest = [(code, name) for code, name in enumerate(names) if name not in named]
    if rest:
        handles = [Patch(color=shades(code), label=name) for code, name in rest]
        place = {"loc": "lower right", "bbox_to_anchor": (1.02, 0.99), "ncols": 3}
        axes.legend(handles=handles, **place, handlelength=1, columnspacing=0.8, borderpad=0.2)


def room_of(axes: Axes) -> tuple[float, float]:
    """About how wide and how high a panel is, in inches, before it is laid out."""
    spot = axes.get_subplotspec()
    rows, columns = spot.get_gridspec().get_geometry()
    width, height = axes.figure.get_size_inches()
    return 0.78 * width * len(spot.colspan) / columns, 0.72 * height / rows


def draw_numbers(
    axes: Axes, grid: Grid, quantity: Quantity, numbers: np.ndarray, failed: np.ndarray
) -> None:
    """A map of a number with its colour bar; of both signs, with its zero where continuous."""
    none = quantity.is_none(np.where(failed, np.nan, numbers))
    after = f"; white: {quantity.none}" if none.any() else ""
    if none.any():
        blank = np.ma.masked_equal(grid.fill(none & ~failed), 0)
        axes.pcolormesh(*grid.edges(), blank, cmap=ListedColormap(["white"]), rasterized=True)
    numbers = quantity.shown(np.where(none | failed, np.nan, numbers))
    norm, extend = scale_of(quantity, numbers)
    whole = np.ma.masked_invalid(grid.fill(numbers))
    cells = np.ma.masked_invalid(grid.fill(np.clip(numbers, norm.vmin, norm.vmax)))
    bar = draw_cells(axes, grid.edges(), cells, norm, extend, colours_of(norm))
    if whole.count() and whole.min() == whole.max():
        bar.set_ticks([whole.min()])
    elif is_signed(norm):
        after += draw_zero(axes, grid, whole)
        name_signs(axes, whole)
    head(axes, quantity.label, bar.ax.yaxis, quantity.unit, after)
    if quantity.most and whole.count():
        name_regions(axes, np.ma.filled(whole == whole.max(), False), quantity.most)


def draw_cells(
    axes: Axes,
    edges: Sequence[np.ndarray],
    cells: np.ma.MaskedArray,
    norm: Normalize | None,
    extend: str,
    colours: Colormap,
) -> Colorbar:
    """Cells in the colours of a scale, with its bar."""
    image = axes.pcolormesh(*edges, cells, cmap=colours, norm=norm, rasterized=True)
    return axes.figure.colorbar(image, ax=axes, extend=extend, pad=0.02, aspect=18)


def name_regions(axes: Axes, there: np.ndarray, name: str) -> None:
    """A name in each large region of some cells."""
    width, height = room_of(axes)
    for spot in spots(np.where(there, 0.0, np.nan)):
        lines = textwrap.fill(name, max(int(spot.width * width / LETTER), 8))
        if spot.height * height > LINE * (lines.count("\n") + 1):
            axes.text(spot.x, spot.y, lines, transform=axes.transAxes, color="0.1", **WORDS)


def name_signs(axes: Axes, cells: np.ma.MaskedArray) -> None:
    """The sign of each large region in it, for print without colours."""
    width, height = room_of(axes)
    filled = np.ma.filled(cells, np.nan)
    outline = [withStroke(linewidth=1.5, foreground=(1, 1, 1, 0.6))]
    style = WORDS | {"color": "0.1", "path_effects": outline, "transform": axes.transAxes}
    for spot in spots(np.where(np.isfinite(filled), filled > 0, np.nan)):
        if spot.width * width > 3 * LETTER and spot.height * height > LINE:
            axes.text(spot.x, spot.y, "> 0" if spot.code else "< 0", **style)


def draw_zero(axes: Axes, grid: Grid, cells: np.ma.MaskedArray) -> str:
    """The line where a field is zero; where it jumps from one sign to the other there is none.

    Gives what the heading says of the jumps.
    """
    cut, size = jumps(cells)
    known = np.ma.masked_where(cut, cells)
    if known.count() and known.min() < 0 < known.max():
        axes.contour(grid.x, grid.y, known, levels=[0], colors="0.25", linewidths=1.0)
    return f",\nwith jumps by about {write(size, 3)}" if cut.any() else ""


def cross(axes: Axes, grid: Grid, failed: np.ndarray) -> None:
    """A cross on each case that failed, no larger than its cell but large enough to be seen."""
    if failed.any():
        column, line = np.divmod(grid.place[failed], grid.y.size)
        size = float(np.clip(120 / max(grid.x.size, grid.y.size), 1.5, 6))
        style = {"markersize": size, "markeredgewidth": size / 6, "color": FAULT}
        axes.plot(grid.x[column], grid.y[line], "x", linestyle="", rasterized=True, **style)


def label_axes(table: Table, grid: Grid, panels: list[Axes]) -> None:
    """Scales and labels of the parameters; labels at the left and lowest panels only."""
    x_edges, y_edges = grid.edges()
    panels[0].set(xlim=(x_edges[0], x_edges[-1]), ylim=(y_edges[0], y_edges[-1]))
    set_parameter_axis(table, 0, *panels)
    set_parameter_axis(table, 1, *panels, which="y")


class Spot(NamedTuple):
    """The middle of a region of one class, as shares of the grid, and how much room is there."""

    code: int
    x: float
    y: float
    width: float
    height: float


def jumps(cells: np.ndarray) -> tuple[np.ndarray, float]:
    """Which cells are beside a jump, and how large the jumps are; nan without one.

    A jump is a change of sign between neighbours along an axis that is much larger than the
    changes before and after it: a branch cut, such as that of an angle that grows by a turn.
    """
    beside = np.zeros(cells.shape, dtype=bool)
    sizes: list[float] = []
    values = np.ma.filled(cells, np.nan)
    for axis in (0, 1):
        rows, marks = np.moveaxis(values, axis, 0), np.moveaxis(beside, axis, 0)
        change = np.abs(np.diff(rows, axis=0))
        quiet = np.zeros_like(change)
        quiet[1:] = np.fmax(quiet[1:], change[:-1])
        quiet[:-1] = np.fmax(quiet[:-1], change[1:])
        crosses = rows[1:] * rows[:-1] < 0
        # much larger than those on either side
        is_jump = crosses & (change > 4.0 * quiet) & (len(change) > 1)
        marks[1:] |= is_jump
        marks[:-1] |= is_jump
        sizes += change[is_jump].tolist()
    return beside, float(np.median(sizes)) if sizes else float("nan")


def regions(codes: np.ndarray) -> list[np.ndarray]:
    """The connected regions of cells with the same code, the largest first; nan belongs to none."""
    left = np.isfinite(codes)
    found = []
    while left.any():
        seed = np.unravel_index(np.argmax(left), left.shape)
        same = left & (codes == codes[seed])
        region = np.zeros_like(left)
        region[seed] = True
        size = 0
        while size != (size := int(region.sum())):
            for axis in (0, 1):
                for step in (1, -1):
                    moved = np.roll(region, step, axis)
                    edge = [slice(None)] * 2
                    edge[axis] = 0 if step == 1 else -1
                    moved[tuple(edge)] = False
                    region |= moved & same
        found.append(region)
        left &= ~region
    return sorted(found, key=lambda region: -int(region.sum()))


def spots(codes: np.ndarray) -> list[Spot]:
    """Where the regions of a field of classes have room for a name.

    The room is that of the largest rectangle, of cells, about the cell that is furthest inside.
    """
    strides = [max(1, size // COARSE) for size in codes.shape]
    coarse = codes[:: strides[0], :: strides[1]]
    down, across = coarse.shape
    found = []
    for region in regions(coarse):
        if region.sum() < 0.02 * region.size:  # too small for a name
            break
        depth, inside = 0, region
        while inside.any():
            depth, deepest = depth + 1, inside
            padded = np.pad(inside, 1, mode="edge" if depth == 1 else "constant")
            inside = (
                inside & padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
            )
        lines, columns = np.nonzero(deepest)
        middle = np.argmin((lines - lines.mean()) ** 2 + (columns - columns.mean()) ** 2)
        y, x = int(lines[middle]), int(columns[middle])
        left, right = reach(region[y], x)
        low, high = reach(region[:, x], y)
        found.append(
            Spot(
                int(coarse[y, x]),
                (left + right + 1) / 2 / across,
                (y + 0.5) / down,
                (right - left + 1) / across,
                (high - low + 1) / down,
            )
        )
    return found


def reach(line: np.ndarray, place: int) -> tuple[int, int]:
    """The first and the last cell of the run of true ones about a place."""
    before, after = np.flatnonzero(~line[:place]), np.flatnonzero(~line[place:])
    first = int(before[-1]) + 1 if before.size else 0
    last = place + int(after[0]) - 1 if after.size else line.size - 1
    return first, last
