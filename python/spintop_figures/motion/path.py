"""The path of the centre of mass: on its sphere, seen from above, and seen from the side."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from spintop_figures.kinds import figure
from spintop_figures.motion.extremes import sparseness
from spintop_figures.motion.sphere import (
    BACK,
    ENDS,
    FRONT,
    WHOLE,
    draw_path_on,
    path_handles,
    thinned,
)
from spintop_figures.style.axes import name_axes
from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import DOTS, FAINT, GREY, GROUND, HIDDEN, by_width
from spintop_figures.style.numbers import write
from spintop_figures.style.page import new_figure, three_panels
from spintop_figures.tables.table import Table

HEIGHT = 3.5
"""Of the figure, in inches."""

ROOM = 1.1
"""What is seen, over the extent of the path."""

FLAT = 0.25
"""The height that a path from the side takes at least, over its width, has its own scale."""

CIRCLE = np.linspace(0, 2 * np.pi, 361)


@figure(
    "path",
    "path of the centre of mass in space and from above (Figure 11)",
    kind="trajectory",
    needs="com_x com_y com_z",
)
def draw_path(table: Table) -> Figure:
    """Path of the centre of mass, on its sphere, from above and from the side (Figure 11)."""
    x, y, z = place = tuple(table.column(f"com_{name}") for name in "xyz")
    sparse = sparseness(*place)
    title = "Path of the centre of mass" + (f" ({sparse})" if sparse else "")
    figure = new_figure(table, title, height=by_width(HEIGHT, 3 * HEIGHT))
    (space, above, side), key = three_panels(figure)
    radius, joined = float(np.nanmedian(np.sqrt(sum(part**2 for part in place)))), not sparse
    if radius > 0:
        draw_path_on(space, tuple(part / radius for part in place), joined)
    space.set_axis_off()
    space.set_title(f"on its sphere of {write(radius)} m", loc="center", pad=16)
    draw_plane(above, (x, y), z >= 0, radius, joined)
    name_axes(above, ("x", "m"), ("y", "m"))
    above.set_title("from above")
    is_wide = np.ptp(x[np.isfinite(x)]) >= np.ptp(y[np.isfinite(y)])
    across, near = (x, y <= 0) if is_wide else (y, x >= 0)
    draw_plane(side, (across, z), near, radius, joined)
    name_axes(side, ("x" if is_wide else "y", "m"), ("z", "m"))
    side.set_title("from $-y$" if is_wide else "from $+x$")
    handles = path_handles([WHOLE], [joined])
    key.legend(handles=handles, loc="center", ncols=by_width(len(handles), 2), borderpad=0)
    return figure


def draw_plane(
    axes: Axes,
    path: tuple[np.ndarray, np.ndarray],
    near: np.ndarray,
    radius: float,
    joined: bool,
) -> None:
    """A path as two coordinates of it: where it is on the far half of its sphere, it is paler."""
    axes.plot(radius * np.cos(CIRCLE), radius * np.sin(CIRCLE), color=FAINT, linewidth=0.8)
    axes.plot(0, 0, "+", color=GREY)
    x, y, near = (*path, near) if joined else thinned((*path, near))
    front, back = (FRONT, BACK) if joined else (DOTS, DOTS | {"color": HIDDEN})
    for there, style, order in ((~near, back, 2), (near, front, 3)):
        there = there | np.roll(there, 1) if joined else there
        line = (np.where(there, part, np.nan) for part in (x, y))
        axes.plot(*line, **style, zorder=order, rasterized=len(x) > MANY_POINTS)
    for name, index in (("end", -1), ("start", 0)):
        axes.plot(*(part[index:][:1] for part in path), **ENDS[name], mec=GROUND, zorder=5)
    set_limits(axes, path, radius)


def set_limits(axes: Axes, path: tuple[np.ndarray, np.ndarray], radius: float) -> None:
    """A square about the path, or about its sphere; a flat path has a scale of its own upward."""
    low, high = (np.array([end(part) for part in path]) for end in (np.nanmin, np.nanmax))
    half = ROOM * max(high - low) / 2
    half = half if 0 < 1.5 * half < radius else 1.05 * (radius or 1.0)
    middle = (low + high) / 2 if half < radius else np.zeros(2)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    width, height = high - low
    if half < radius and 0 < height < FLAT * width:
        axes.set_ylim(middle[1] - ROOM * height / 2, middle[1] + ROOM * height / 2)
        axes.set_box_aspect(1)
    else:
        axes.set_ylim(middle[1] - half, middle[1] + half)
        axes.set_aspect("equal")
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.yaxis.set_major_locator(MaxNLocator(4))
