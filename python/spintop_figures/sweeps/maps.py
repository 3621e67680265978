"""The maps of a sweep over a grid of two parameters, and the colours of numbers."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib import colors
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import acting
from spintop_figures.moving.body import GRAVITY
from spintop_figures.style.look import FAULT
from spintop_figures.style.numbers import MINUS, write
from spintop_figures.style.page import head, panel_figure
from spintop_figures.sweeps import quantities
from spintop_figures.sweeps.quantities import Quantity
from spintop_figures.tables.names import ended_well, name_of
from spintop_figures.tables.table import Table

COLOURS = mpl.colormaps["cividis"]
"""From dark to light, for all eyes and for print without colours."""

SIGNED = colors.LinearSegmentedColormap.from_list(
    "signed", ["#0b2a4f", "#3f6d9e", "#a9c3dc", "#f4f2ee", "#f2bd8e", "#de7f35", "#ab4a0c"]
)
"""For values of both signs, with a neutral zero; the ends differ in lightness, too."""

HEIGHTS = 2.6, 4.0
"""Of a row of panels, and of all of them, in inches."""

BLANK = {"facecolor": "white", "edgecolor": "0.7", "hatch": "////"}
"""Of a map where there is no value."""

KAPITZA = r"Kapitza: $A\,\Omega=\sqrt{2gI/(ml)}$"
"""What the limit is, as a legend has it."""


def scale_of(quantity: Quantity, values: np.ndarray) -> tuple[colors.Normalize, str]:
    """The scale of the colours of values, and at which ends some are beyond it.

    A scale of both signs has zero in its middle.
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return colors.Normalize(0, 1), "neither"
    if finite.min() == finite.max():
        return colors.Normalize(finite[0] - 1, finite[0] + 1), "neither"
    if quantity.has_log_scale(finite):
        above = finite[finite > 0]
        end = "min" if above.size < finite.size else "neither"
        return colors.LogNorm(above.min(), above.max()), end
    # a hundredth may be beyond the bar if it would take more than half the range of the others
    low, high = np.percentile(finite, [1, 99])
    room = 0.5 * (high - low)
    first = low if finite.min() < low - room else finite.min()
    last = high if finite.max() > high + room else finite.max()
    if first < 0 < last:
        last = max(-first, last)
        first = -last
    beyond = (finite.min() < first) + 2 * (finite.max() > last)
    return colors.Normalize(first, last), ("neither", "min", "max", "both")[beyond]


def is_signed(norm: colors.Normalize) -> bool:
    """Whether a scale has zero inside."""
    return not isinstance(norm, colors.LogNorm) and norm.vmin < 0 < norm.vmax


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
    logs = tuple(quantities.has_log_axis(table, name) for name in table.axes())
    return Grid(x, y, column * y.size + line, logs)


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


@figure(
    "sweep",
    objection=lambda table: (
        object_to_grid(table)
        or ("" if quantities.quantities_of(table) else "has no quantity to map")
    ),
)
def draw_maps(table: Table) -> Figure:
    """Maps of the quantities of a sweep over a grid of two parameters."""
    grid, shown = make_grid(table), quantities.quantities_of(table)
    names = " and ".join(map(name_of, table.axes()))
    title = f"The motion over {names}{quantities.tell_rest(table)}"
    figure, panels = panel_figure(table, title, len(shown), *HEIGHTS)
    failed = ~ended_well(table.rows).to_numpy()
    for quantity, axes in zip(shown, panels, strict=True):
        axes.patch.set(**BLANK)
        values = quantity.values(table.rows)
        if quantities.is_words(values):
            head(axes, quantity.label)
            classes = quantities.order_classes(values[~failed])
            colours = COLOURS(np.linspace(0.05, 0.95, len(classes)))
            draw_classes(
                axes, grid, values.where(~failed), dict(zip(classes, colours, strict=True))
            )
        else:
            draw_numbers(axes, grid, quantity, values.to_numpy(float), failed)
        cross(axes, grid, failed)
    label_axes(table, grid, panels)
    if limit := find_kapitza_limit(table):
        outline = [withStroke(linewidth=3.5, foreground="white")]
        style = {"color": "black", "linewidth": 1.4, "scalex": False, "scaley": False}
        box = {"frameon": True, "framealpha": 0.85, "facecolor": "white", "edgecolor": "none"}
        for axes in panels:
            x = np.geomspace(*axes.get_xlim(), 200)
            axes.plot(x, limit(x), **style, path_effects=outline, label=KAPITZA)
            axes.legend(loc="lower left", labelcolor="black", **box)
    return figure


def find_kapitza_limit(table: Table) -> Callable[[np.ndarray], np.ndarray] | None:
    """The second swept parameter at the limit, as a function of the first; None if there is none.

    A vertical vibration a cos(W t) of the pivot, averaged over its period, adds the potential
    (m l a W)^2 sin(theta)^2/(4 I) to m g l cos(theta), with I about the pivot. The body without
    spin is stable upright if the curvature of the sum is positive there: a W > sqrt(2 g I/(m l)).
    With I = m l^2 it is the pendulum's sqrt(2 g l). It holds for fast vibrations of small
    amplitude, a body given by its moments of inertia, and no other effect.
    """
    if sorted(table.axes()) != ["effects.vibration_amplitude(3)", "effects.vibration_rate"]:
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


def draw_classes(
    axes: Axes, grid: Grid, words: pd.Series, colours: Mapping[str, object], **look: object
) -> None:
    """A map of words in these colours, which a bar names; where there are others it is blank."""
    codes = words.map({name: float(code) for code, name in enumerate(colours)}).to_numpy(float)
    norm = colors.BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    cells = np.ma.masked_invalid(grid.fill(codes))
    shades = colors.ListedColormap([*colours.values()])
    bar = draw_cells(axes, grid.edges(), cells, norm, colours=shades, **look)
    bar.set_ticks(range(len(colours)), labels=[name_of(name) for name in colours])
    bar.ax.tick_params(which="both", length=0)


def draw_numbers(
    axes: Axes, grid: Grid, quantity: Quantity, numbers: np.ndarray, failed: np.ndarray
) -> None:
    """A map of a number with its colour bar; of both signs, with its zero where continuous.

    Where it jumps from one sign to the other there is no line, and the heading tells the jumps.
    """
    none = quantity.is_none(np.where(failed, np.nan, numbers))
    after = f"; white: {quantity.none}" if none.any() else ""
    if none.any():
        blank = np.ma.masked_equal(grid.fill(none & ~failed), 0)
        white = colors.ListedColormap(["white"])
        axes.pcolormesh(*grid.edges(), blank, cmap=white, rasterized=True)
    numbers = quantity.shown(np.where(none | failed, np.nan, numbers))
    norm, extend = scale_of(quantity, numbers)
    whole = np.ma.masked_invalid(grid.fill(numbers))
    bar = draw_cells(axes, grid.edges(), whole, norm, extend)
    if whole.count() and whole.min() == whole.max():
        bar.set_ticks([whole.min()])
    elif is_signed(norm):
        cut, size = jumps(whole)
        smooth = np.ma.masked_where(cut, whole)
        if smooth.count() and smooth.min() < 0 < smooth.max():
            axes.contour(grid.x, grid.y, smooth, levels=[0], colors="0.25", linewidths=1.0)
        after += f",\nwith jumps by about {write(size, 3)}" if cut.any() else ""
        mark_negative(axes, grid.x, grid.y, whole)
        after += f"; {MINUS}:\u00a0below\u00a0zero"
    if quantity.most:
        after += f"; largest: {quantity.most}"
    head(axes, quantity.label, bar.ax.yaxis, quantity.unit, after)


def mark_negative(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ma.MaskedArray) -> None:
    """A minus in each cell below zero, in some of many: without colours signs are not seen."""
    strides = [n // 20 if n > 60 else 1 for n in values.shape]
    some = tuple(slice(stride // 2, None, stride) for stride in strides)
    places, values = [part[some] for part in np.meshgrid(x, y)], np.ma.filled(values, np.nan)[some]
    style = {"marker": "_", "linestyle": "", "markersize": 3, "markeredgewidth": 0.8}
    dark = values < -0.5 * np.nanmax(np.abs(values))  # where colours are
    for chosen, colour in (((values < 0) & ~dark, "black"), (dark, "white")):
        axes.plot(*(part[chosen] for part in places), color=colour, rasterized=True, **style)


def draw_cells(
    axes: Axes,
    edges: Sequence[np.ndarray],
    cells: np.ma.MaskedArray,
    norm: colors.Normalize,
    extend: str = "neither",
    colours: colors.Colormap | None = None,
    **look: object,
) -> Colorbar:
    """Cells in the colours of a scale, with its bar."""
    colours = colours or (SIGNED if is_signed(norm) else COLOURS)
    image = axes.pcolormesh(*edges, cells, cmap=colours, norm=norm, **{"rasterized": True} | look)
    return axes.figure.colorbar(image, ax=axes, extend=extend, pad=0.02, aspect=18)


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
    for which, name, is_log in zip("xy", table.axes(), grid.logs, strict=True):
        quantities.scale_panels(panels, which, table, name, is_log)


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
