"""The path of the centre of mass, in space and seen from above."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D

from spintop_figures.motion.extremes import extremes_of_rows, height_extremes, sparseness
from spintop_figures.motion.trajectory import numbers
from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import DOTS, FAINT, GREY, HIDDEN, LINES
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

CAP_ZOOM = 1.12
"""The size of a cap in its panel."""


def draw_path(table: Table) -> Figure:
    """Path of the centre of mass, in space and from above (Figure 11)."""
    x, y, z = (numbers(table, f"com_{name}") for name in "xyz")
    sparse = sparseness(x, y, z)
    title = "Path of the centre of mass" + (f" ({sparse})" if sparse else "")
    figure = new_figure(table, title, height=4.5)
    figure.get_layout_engine().set(wspace=0.14)
    radius = float(np.nanmedian(np.sqrt(x**2 + y**2 + z**2)))
    room = min(1.1 * float(np.nanmax(np.hypot(x, y))), radius)
    if np.nanmin(z) < 0 < np.nanmax(z) or room == 0:
        room = radius
    style = DOTS if sparse else LINES[0]
    space = figure.add_subplot(1, 2, 1, projection="3d")
    draw_sphere(space, radius, room, upper=np.nanmax(z) > 0)
    space.patch.set_visible(False)  # it would hide labels of the panel beside it
    space.plot(x, y, z, **style)
    mark_ends(space, x, y, z)
    label_space(space, table, room < radius)
    above = figure.add_subplot(1, 2, 2)
    around = np.linspace(0, 2 * np.pi, 181)
    above.plot(radius * np.cos(around), radius * np.sin(around), color=FAINT, linewidth=0.8)
    draw_from_above(above, x, y, z, style)
    above.plot(0, 0, "+", color=GREY)
    mark_ends(above, x, y)
    side = 1.04 * room
    above.set(xlim=(-side, side), ylim=(-side, side), aspect="equal")
    above.set(xlabel="x (m)", ylabel="y (m)")
    above.set_title("from above", loc="left", pad=4)
    above.legend(
        loc="upper right", bbox_to_anchor=(1.03, -0.16), ncols=2, handletextpad=0.4, borderpad=0
    )
    return figure


def draw_from_above(
    axes: Axes, x: np.ndarray, y: np.ndarray, z: np.ndarray, style: dict[str, object]
) -> None:
    """The path seen from above: where it is below the level of the pivot, it is paler."""
    below, above = z < 0, z >= 0
    halves = (below, "below the pivot", HIDDEN, 2), (above, "above the pivot", "", 3)
    for there, words, colour, order in halves:
        if not there.any():
            continue
        label = words if below.any() and above.any() else None
        shown = there | np.roll(there, 1) if "linestyle" in style else there
        look = style | ({"color": colour} if colour else {})
        parts = (np.where(shown, part, np.nan) for part in (x, y))
        axes.plot(*parts, **look, label=label, zorder=order, rasterized=len(x) > MANY_POINTS)


def label_space(space: Axes3D, table: Table, is_cap: bool) -> None:
    """Labels of the axes in space; a cap may be too flat for a vertical one."""
    space.set(xlabel="x (m)", ylabel="y (m)")
    if is_cap:
        space.xaxis.labelpad = space.yaxis.labelpad = 9
        space.set_zticks([])
        low, high = (
            height_extremes(table)
            if "theta" in table.rows
            else extremes_of_rows(numbers(table, "com_z"))
        )
        note = (low if low.of_rows else high).note()
        sides = [np.ptp(ends) for ends in (space.get_xlim(), space.get_ylim(), space.get_zlim())]
        space.set_box_aspect(sides, zoom=CAP_ZOOM)
        space.set_title(f"in space, z from {low.value:.4g} to {high.value:.4g} m{note}", y=0.8)
    else:
        space.set(zlabel="z (m)", title="in space")


def draw_sphere(axes: Axes3D, radius: float, room: float, upper: bool) -> None:
    """The sphere of the centre of mass or, if `room` is less than its radius, that cap of it."""
    down = np.linspace(0, np.arcsin(room / radius) if room < radius else np.pi, 49)
    around = np.linspace(0, 2 * np.pi, 73)
    height = radius * np.outer(np.cos(down), np.ones_like(around))
    axes.plot_wireframe(
        radius * np.outer(np.sin(down), np.cos(around)),
        radius * np.outer(np.sin(down), np.sin(around)),
        height if upper else -height,
        rstride=8,
        cstride=6,
        color=FAINT,
        linewidth=0.5,
    )
    axes.set(xlim=(-room, room), ylim=(-room, room))
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(3))
        axis.pane.set_visible(False)
    axes.grid(visible=False)


def mark_ends(axes: Axes, *path: np.ndarray) -> None:
    """Mark where the path begins and ends."""
    for place, marker, label in ((0, "o", "start"), (-1, "D", "end")):
        ends = [component[place : place + 1 or None] for component in path]
        axes.plot(*ends, marker, markersize=5, color=LINES[1]["color"], mec="white", label=label)
