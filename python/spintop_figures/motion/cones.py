"""The cones on which a body rolls: the angular velocity seen in the body, and seen in space."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from spintop_figures.kinds import figure
from spintop_figures.motion.path import HEIGHT
from spintop_figures.motion.sphere import BACK, ENDS, FRONT, draw_globe, draw_seen, project
from spintop_figures.style.axes import name_axes
from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import GREY, GROUND, INK, LINES, PALE, by_width
from spintop_figures.style.page import new_figure, three_panels
from spintop_figures.tables.table import Table

RAYS = 24
"""Lines of a cone from its apex."""

MANY_TURNS = 15
"""Curves that are longer, in circles about their extent, have thin lines."""

LEAST = 1e-9
"""What is slower, over the fastest, has no direction."""

BODY = {"color": LINES[1]["color"], "linewidth": 1.5, "linestyle": (0, (3, 1))}
BODY_BACK = {"color": PALE, "linewidth": 1.1, "linestyle": (0, (3, 1))}
"""The cone of the body, before the sphere and behind it."""

TOUCH = {"color": INK, "linewidth": 1.3}

ROOM = 1.08
"""What is seen of a plane, over the extent of its curve."""

ANGLES = ("phi", "theta", "psi")


def turn_by_euler(vector: np.ndarray, phi: object, theta: object, psi: object) -> np.ndarray:
    """A vector of body axes in space axes, by Rz(phi) Rx(theta) Rz(psi); components by rows."""
    x, y, z = vector
    x, y = x * np.cos(psi) - y * np.sin(psi), x * np.sin(psi) + y * np.cos(psi)
    y, z = y * np.cos(theta) - z * np.sin(theta), y * np.sin(theta) + z * np.cos(theta)
    return np.array([x * np.cos(phi) - y * np.sin(phi), x * np.sin(phi) + y * np.cos(phi), z])


def in_body(table: Table) -> np.ndarray:
    """The angular velocity in body axes; components by rows."""
    return np.array([table.column(f"omega{i}") for i in (1, 2, 3)])


def in_space(table: Table) -> np.ndarray:
    """The angular velocity in space axes; components by rows."""
    return turn_by_euler(in_body(table), *map(table.column, ANGLES))


def body_at_start(table: Table) -> np.ndarray:
    """The angular velocities of body axes, placed in space by the attitude of the first row."""
    return turn_by_euler(in_body(table), *(table.column(name)[0] for name in ANGLES))


@figure(
    "cones",
    "angular velocity in the body and in space (polhode and herpolhode)",
    kind="trajectory",
    needs="phi theta psi omega1 omega2 omega3",
)
def draw_cones(table: Table) -> Figure:
    """The two cones, that of the body rolling on that in space, and their curves in planes."""
    title = "Angular velocity: polhode cone of the body, rolling on the herpolhode cone in space"
    figure = new_figure(table, title, by_width(HEIGHT + 0.2, 3 * HEIGHT))
    (globe, body, space), key = three_panels(figure)
    draw_globe(globe)
    draw_cone(globe, in_space(table), FRONT, BACK)
    draw_cone(globe, body_at_start(table), BODY, BODY_BACK)
    touch = directions(in_space(table))[:, :1]
    if touch.size:
        (x,), (y,), _ = project(*touch)
        globe.plot([0, x], [0, y], **TOUCH, zorder=4)
        globe.annotate(r"$\omega$", (x, y), (4, 4), textcoords="offset points", zorder=6)
    globe.plot(0, 0, "o", color=GREY, markersize=2.5, zorder=4)
    globe.set_title("directions, at the start", loc="center")
    draw_plane(body, in_body(table), BODY | {"linestyle": "-"}, "12", "in the body")
    draw_plane(space, in_space(table), FRONT, "xy", "in space, from above")
    handles = [
        Line2D([], [], **BODY, label="cone of the body"),
        Line2D([], [], **FRONT, label="cone in space"),
        Line2D([], [], **TOUCH, label="where they touch"),
        *(Line2D([], [], **look, label=name) for name, look in ENDS.items()),
    ]
    key.legend(handles=handles, loc="center", ncols=by_width(5, 2), borderpad=0, columnspacing=1.2)
    return figure


def directions(omega: np.ndarray) -> np.ndarray:
    """Unit vectors along angular velocities, without those that are about zero."""
    size = np.linalg.norm(omega, axis=0)
    there = size > LEAST * np.nanmax(size)
    return omega[:, there] / size[there]


def draw_cone(axes: Axes, omega: np.ndarray, front: dict, back: dict) -> None:
    """The curve of directions on the sphere, with rays to it from the middle."""
    points = directions(omega)
    draw_seen(axes, tuple(points), *(thin_if_long(style, points) for style in (front, back)))
    x, y, towards = project(*points)
    passed = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=1), axis=0))])
    places = np.searchsorted(passed, np.linspace(0, min(passed[-1], 2 * np.pi), RAYS))
    for place in np.unique(np.minimum(places, len(x) - 1)):
        colour = (front if towards[place] >= 0 else back)["color"]
        look = {"color": colour, "linewidth": 0.5, "alpha": 0.6, "zorder": 2}
        axes.plot([0, x[place]], [0, y[place]], **look)


def thin_if_long(style: dict, curve: np.ndarray) -> dict:
    """A style with a thin line for a curve of many turns, which would be a solid area."""
    length = np.nansum(np.linalg.norm(np.diff(curve, axis=1), axis=0))
    extent = np.max(np.nanmax(curve, axis=1) - np.nanmin(curve, axis=1))
    is_long = length > MANY_TURNS * np.pi * extent
    return style | {"linewidth": 0.4} if is_long else style


def draw_plane(axes: Axes, omega: np.ndarray, style: dict, names: str, heading: str) -> None:
    """Two components of the angular velocity against each other, from start to end."""
    x, y = omega[:2]
    axes.plot(x, y, **thin_if_long(style, omega[:2]), rasterized=len(x) > MANY_POINTS)
    axes.plot(0, 0, "+", color=GREY)
    for name, place in (("end", -1), ("start", 0)):
        axes.plot(x[place:][:1], y[place:][:1], **ENDS[name], mec=GROUND, zorder=5)
    side = ROOM * float(np.nanmax(np.abs(omega[:2]))) or 1.0
    axes.set(xlim=(-side, side), ylim=(-side, side), aspect="equal")
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    name_axes(axes, *((rf"$\omega_{name}$", "rad/s") for name in names))
    axes.set_title(heading)
