"""Paths of a point on a sphere: the whole sphere from afar, or the cap that a path keeps to.

A direction of space is three arrays, x, y and z, of unit vectors; the sphere has the radius 1.
"""

import textwrap
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.motion.trajectory import inclination_extremes, sparseness
from spintop_figures.style import look
from spintop_figures.style.axes import MANY_POINTS, Places, draw_heads, name_axes
from spintop_figures.style.numbers import write
from spintop_figures.style.page import legend_below, panel_figure
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import say

Points = tuple[np.ndarray, np.ndarray, np.ndarray]

ELEVATION, GRID = np.radians(28), np.radians(30)
"""How far above the horizon the eye is where the whole sphere is seen; between the circles."""

CIRCLE = np.linspace(0, 2 * np.pi, 241)

FRONT = {"color": look.LINES[0]["color"], "linewidth": 1.5}
BACK = {"color": look.HIDDEN, "linewidth": 1.1}
"""The path before the sphere, and behind it a paler tint of the same colour."""

ENDS = {
    "start": {"color": look.LINES[1]["color"], "linestyle": "", "marker": "o", "markersize": 6},
    "end": {"color": look.LINES[1]["color"], "linestyle": "", "marker": "D", "markersize": 5.5},
}
"""Where the path begins and ends; empty if that is behind the sphere."""


class View(NamedTuple):
    """Where the eye is: three directions of space, and how far from the middle it sees."""

    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray
    window: float = 1.0
    """The radius of what is seen; 1 is the whole sphere."""


WHOLE = View(
    np.array([1.0, 0.0, 0.0]),
    np.array([0.0, np.sin(ELEVATION), np.cos(ELEVATION)]),
    np.array([0.0, -np.cos(ELEVATION), np.sin(ELEVATION)]),
)
"""From -y, and a little from above."""


def on_sphere(theta: np.ndarray, phi: np.ndarray) -> Points:
    """The tip of the axis of a top in space."""
    return np.sin(theta) * np.sin(phi), -np.sin(theta) * np.cos(phi), np.cos(theta)


def project(x: np.ndarray, y: np.ndarray, z: np.ndarray, view: View = WHOLE) -> Points:
    """Points as seen: to the right, upward, and towards the eye."""
    return tuple(a * x + b * y + c * z for a, b, c in (view.right, view.up, view.towards))


def radius_about(middle: np.ndarray, directions: np.ndarray) -> float:
    """The largest angle between a direction and others, rad; also where it is tiny."""
    chord = np.linalg.norm(directions - middle[:, np.newaxis], axis=0).max()
    return float(2 * np.arcsin(min(chord / 2, 1.0)))


def view_of(points: Points) -> View:
    """The view of a path: of the whole sphere, or of a small cap from straight above it."""
    directions = np.array(points)
    middle = directions.max(axis=1) + directions.min(axis=1)  # of the box about the path
    size = np.linalg.norm(middle)
    middle = middle / size if size > 0 else WHOLE.towards
    radius = radius_about(middle, directions)
    if not 0 < radius < np.radians(35):  # a smaller cap is seen through a window
        return WHOLE
    pole = np.array([0.0, 0.0, np.copysign(1.0, middle[2])])
    if np.linalg.norm(middle - pole) < 0.2 * radius:  # about a pole: from straight above
        middle, radius = pole, radius_about(pole, directions)
    upright = np.array([0.0, 1.0, 0.0]) if abs(middle[2]) == 1 else np.array([0.0, 0.0, 1.0])
    up = upright - (upright @ middle) * middle
    up /= np.linalg.norm(up)
    # with some room about the cap
    return View(np.cross(up, middle), up, middle, 1.12 * float(np.sin(radius)))


def draw_seen(
    axes: Axes, points: Points, front: dict, back: dict | None = None, view: View = WHOLE
) -> None:
    """A curve on the sphere: its part before the sphere in one style, that behind it in another.

    What is outside of a window, or behind without a style for it, is left out.
    """
    x, y, towards = project(*points, view)
    inside = np.hypot(x, y) <= view.window * (1 + 1e-9)
    draw_halves(axes, (x, y), ((back, (towards <= 0) & inside), (front, (towards >= 0) & inside)))


def draw_halves(
    axes: Axes, path: Sequence[np.ndarray], halves: Sequence[tuple[dict | None, np.ndarray]]
) -> None:
    """The far and the near half of a path: the style of each, if it is drawn, and where it is."""
    for (style, there), order in zip(halves, (1, 3), strict=True):
        if style is None or not there.any():
            continue
        if "marker" not in style:
            there = there | np.roll(there, 1)  # no gaps where it passes the edge
        line = (np.where(there, part, np.nan) for part in path)
        axes.plot(*line, **{"zorder": order, "rasterized": there.size > MANY_POINTS} | style)


def halves_of(joined: bool) -> tuple[dict, dict]:
    """How a path is drawn before the sphere and behind it: as dots if its rows are not joined."""
    return (FRONT, BACK) if joined else (look.DOTS, look.DOTS | {"color": look.HIDDEN})


def mark_ends(axes: Axes, x: np.ndarray, y: np.ndarray, towards: Sequence[float] = (1.0,)) -> None:
    """Marks where a path ends and begins, if it has rows."""
    for name, place in (("end", -1), ("start", 0)) if len(x) else ():
        face = {"mec": look.GROUND} if towards[place] >= 0 else {"mfc": look.GROUND}
        axes.plot(x[place], y[place], **ENDS[name] | face, zorder=5)


def draw_globe(axes: Axes, view: View = WHOLE, path: Points | None = None) -> None:
    """The edge of the sphere or of the window, the graticule beside a path, and the vertical."""
    edge = view.window * np.array([np.cos(CIRCLE), np.sin(CIRCLE)])
    axes.fill(*edge, color=look.WASH, zorder=0)
    axes.plot(*edge, color=look.GREY, linewidth=0.8)
    front = {"color": look.FAINT, "linewidth": 0.5, "zorder": 1}
    if view.window < 1:
        draw_fine_grid(axes, view, front, path)
    else:
        for place in np.arange(0, np.pi, GRID):
            at = np.full_like(CIRCLE, place)
            for circle in (on_sphere(at, CIRCLE), on_sphere(CIRCLE, at)):
                draw_seen(axes, circle, front, front | {"alpha": 0.5})
        top, arrow = np.cos(ELEVATION), {"arrowstyle": "-|>", "color": look.GREY, "lw": 0.9}
        axes.annotate("", (0, top + 0.3), (0, top), arrowprops=arrow)
        axes.text(0.05, top + 0.22, "$z$", color=look.GREY, fontsize="small")
    side = 1.06 * view.window
    axes.set(xlim=(-side, side), ylim=(-side, side if view.window < 1 else 1.28), aspect="equal")
    axes.set_axis_off()


def draw_fine_grid(axes: Axes, view: View, style: dict, path: Points) -> None:
    """Circles of equal inclination in a window, with their numbers, and meridians."""
    radius = np.arcsin(min(view.window, 1.0))
    middle = np.arctan2(np.hypot(*view.towards[:2]), view.towards[2])
    least = np.degrees(radius) / 2.5
    power = 10.0 ** np.floor(np.log10(least))
    step = np.radians(next(n * power for n in (1, 2, 5, 10) if n * power >= least))
    low, high = max(middle - radius, 0.0), min(middle + radius, np.pi)
    around = np.linspace(0, 2 * np.pi, 2881)
    path_seen = project(*thinned(path), view)[:2]
    outline = [withStroke(linewidth=2, foreground=look.WASH)]
    words = {"fontsize": "small", "color": look.GREY, "ha": "center", "va": "center", "zorder": 2}
    for count in range(int(np.ceil(low / step)), int(high / step) + 1):
        if 0 < count * step < np.pi * (1 - 1e-12):
            circle = on_sphere(np.full_like(around, count * step), around)
            draw_seen(axes, circle, style, view=view)
            x, y, towards = project(*circle, view)
            inside = (np.hypot(x, y) < 0.97 * view.window) & (towards > 0)
            if inside.any():  # its number, beside the path, at its lower right end
                gaps = [np.hypot(x - px, y - py) for px, py in zip(*path_seen, strict=True)]
                free = np.minimum(np.min(gaps, axis=0), 0.1 * view.window)
                place = int(np.argmax(np.where(inside, 20 * free + x - 0.8 * y, -np.inf)))
                name = f"{write(np.degrees(count * step), 8)}°"
                axes.text(x[place], y[place], name, path_effects=outline, **words)
    down = np.linspace(low, high, 181)
    apart = GRID if low == 0 or high == np.pi else step / np.sin(middle)
    apart = 2 * np.pi / max(round(2 * np.pi / apart), 12)
    for phi in np.arange(0, 2 * np.pi - apart / 2, apart):
        draw_seen(axes, on_sphere(down, np.full_like(down, phi)), style, view=view)


def draw_path_on(axes: Axes, points: Points, joined: bool) -> View:
    """A path on the sphere, or in a window with a small globe that tells where it is."""
    there = np.isfinite(points).all(axis=0)
    points = tuple(part[there] for part in points)
    view = view_of(points)
    draw_globe(axes, view, points)
    draw_seen(axes, points if joined else thinned(points), *halves_of(joined), view)
    seen = project(*points, view)
    if joined:
        # one arrow, near the start and before the sphere
        x, y, towards = seen
        far = np.hypot(x - x[0], y - y[0])[:-1] > 0.3 * view.window
        moves = (np.diff(x) != 0) | (np.diff(y) != 0)
        draw_heads(axes, x, y, np.flatnonzero(far & (towards[:-1] > 0) & moves)[:1] + 1)
    mark_ends(axes, *seen)
    if view.window < 1:
        draw_inset(axes, view)
    return view


def thinned(points: Points) -> Points:
    """Points that are not joined, MOST_DOTS at most."""
    every = -(-len(points[0]) // 1000)  # more would be a cloud
    return tuple(part[::every] for part in points)


def draw_inset(axes: Axes, view: View) -> None:
    """A small globe with the window on it, a dot if it is tiny."""
    inset = axes.inset_axes((0.84, 0.82, 0.22, 0.22))
    draw_globe(inset)
    angle = np.arcsin(view.window)
    if angle < np.radians(2):
        rim, style = view.towards[:, np.newaxis], {"marker": "o", "markersize": 3}
    else:
        circle = np.array([np.cos(CIRCLE), np.sin(CIRCLE), np.full_like(CIRCLE, 1 / np.tan(angle))])
        rim, style = view.window * (np.array(view[:3]).T @ circle), {"linewidth": 1.4}
    style["color"] = look.LINES[1]["color"]
    draw_seen(inset, tuple(rim), style, style | {"alpha": 0.4})


def path_looks(views: Sequence[View], joined: Sequence[bool]) -> dict[str, dict]:
    """How the lines of paths look, for a legend of all of them."""
    front, back = halves_of(any(joined))
    far = {"on the far side": back} if any(view.window >= 1 for view in views) else {}
    return {"path": front} | far | ENDS


EDGE = {"color": look.GREY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
"""The circles of the extreme inclinations."""


def path_of(table: Table) -> np.ndarray:
    """Inclination and azimuth, where there are both."""
    path = np.array([table.column(name) for name in ("theta", "phi")])
    return path[:, np.isfinite(path).all(axis=0)]


def draw_tip(axes: Axes, table: Table) -> tuple[View, bool, bool, list[str]]:
    """The path of a motion, between the circles of its minimum and its maximum inclination.

    Gives the view, whether the rows are joined, and whether the circles are drawn: they are where
    they differ from each other and from the path. Then lines of words: the extremes of the
    inclination, and the azimuth passed.
    """
    theta, phi = path_of(table)
    tip = on_sphere(theta, phi)
    sparse = sparseness(*tip)
    view = draw_path_on(axes, tip, not sparse)
    low, high = inclination_extremes(table)
    # more than the width of the line
    nutates = high.value - low.value > min(np.radians(0.5), 0.04 * view.window)
    for extreme in (low, high) if nutates else ():
        circle = on_sphere(np.full_like(CIRCLE, extreme.value), CIRCLE)
        draw_seen(axes, circle, EDGE, EDGE | {"alpha": 0.35}, view)
    least, most = (f"{write(np.degrees(end.value))}°" for end in (low, high))
    words = rf"$\theta$ = {least}" if least == most else rf"$\theta$ {least} to {most}"
    if (low.of_rows or high.of_rows) and least != most:
        words += " in the rows"
    turn = rf"$\phi$ {tell_turn(np.degrees(phi[-1] - phi[0]))}"
    return view, not sparse, nutates, [words, turn, *filter(None, [sparse])]


def tell_turn(degrees: float) -> str:
    """How far an azimuth turns, in degrees or in turns."""
    many = abs(degrees) > 1000  # else turns would be hard to compare
    sign = "+" if degrees > 0 else ""
    return f"{sign}{write(degrees / 360)} turns" if many else f"{sign}{write(degrees)}°"


MOTIONS = {
    "kind": "trajectory",
    "needs": "theta phi",
    "unless": {"has no row with both angles": lambda table: path_of(table).size},
}


@figure(**MOTIONS, together=True)
def draw_traces(tables: Sequence[Table]) -> Figure:
    """Paths of the axis tip on the unit sphere, side by side."""
    across = min(len(tables), look.by_width(3, 2))
    side = min(4.6, look.drawn_size()[0] / across)
    grid = {"share": "", "has_foot": True, "across": across}
    row = 1.1 * side + 0.65  # with the vertical, and words above
    title = "Path of the axis tip on the unit sphere"
    figure, panels = panel_figure(tables, title, len(tables), row, 0, 0.8, **grid)
    drawn = [draw_tip(axes, table) for axes, table in zip(panels, tables, strict=True)]
    views, joined, nutates, told = zip(*drawn, strict=True)
    looks = path_looks(views, joined)
    if any(nutates):
        looks["minimum and maximum inclination"] = EDGE
    for axes, table, lines in zip(panels, tables, told, strict=True):
        title = textwrap.fill(table.title, int(side * 13)).replace("$", r"\$")
        alone = len(tables) == 1  # it has its title below the figure
        words = "\n".join([title] * (not alone) + [*map(say, lines)])
        axes.set_title(words, loc="center", fontsize="small", pad=2)
    legend_below(panels, looks, look.by_width(5, 2))
    return figure


@figure(**MOTIONS)
def draw_trace(table: Table) -> Figure:
    """Path of the axis tip on the unit sphere."""
    return draw_traces([table])


def three_panels(table: Table, title: str) -> tuple[Figure, list[Axes]]:
    """A figure of three panels in a row, or one below the other on a narrow one, and a legend."""
    shape = {"share": "", "has_foot": True, "across": look.by_width(3, 1)}
    figure, panels = panel_figure(table, title, 3, 3.5, 0, 0.1, **shape)
    figure.get_layout_engine().set(wspace=0.08)
    return figure, panels


@figure("trajectory", "com_x com_y com_z")
def draw_path(table: Table) -> Figure:
    """Path of the centre of mass in space and from above (Figure 11)."""
    x, y, z = place = tuple(table.column(f"com_{name}") for name in "xyz")
    sparse = sparseness(*place)
    title = "Path of the centre of mass" + (f" ({sparse})" if sparse else "")
    figure, (space, above, side) = three_panels(table, title)
    radius, joined = float(np.nanmedian(np.sqrt(sum(part**2 for part in place)))), not sparse
    if radius > 0:
        draw_path_on(space, tuple(part / radius for part in place), joined)
    space.set_axis_off()
    space.set_title(f"on its sphere of {write(radius)} m", loc="center", pad=16)
    draw_path_plane(above, (x, y), z >= 0, radius, joined)
    name_axes(above, ("x", "m"), ("y", "m"))
    above.set_title("from above")
    is_wide = np.ptp(x[np.isfinite(x)]) >= np.ptp(y[np.isfinite(y)])
    across, near = (x, y <= 0) if is_wide else (y, x >= 0)
    draw_path_plane(side, (across, z), near, radius, joined)
    name_axes(side, ("x" if is_wide else "y", "m"), ("z", "m"))
    side.set_title("from $-y$" if is_wide else "from $+x$")
    looks = path_looks([WHOLE], [joined])
    legend_below([space], looks, look.by_width(len(looks), 2))
    return figure


def draw_path_plane(
    axes: Axes, path: Sequence[np.ndarray], near: np.ndarray, radius: float, joined: bool
) -> None:
    """A path as two coordinates of it: where it is on the far half of its sphere, it is paler.

    In a square about the path, or about its sphere; a flat path has a scale of its own upward.
    """
    circle = radius * np.cos(CIRCLE), radius * np.sin(CIRCLE)
    axes.plot(*circle, color=look.FAINT, linewidth=0.8, zorder=0)
    axes.plot(0, 0, "+", color=look.GREY, zorder=0)
    front, back = halves_of(joined)
    *line, near = (*path, near) if joined else thinned((*path, near))
    draw_halves(axes, line, ((back, ~near), (front, near)))
    mark_ends(axes, *path)
    low, high = (np.array([end(part) for part in path]) for end in (np.nanmin, np.nanmax))
    low, high = 1.05 * low - 0.05 * high, 1.05 * high - 0.05 * low  # with room about the path
    half = max(high - low) / 2
    half = half if 0 < 1.5 * half < radius else 1.05 * (radius or 1.0)
    middle = (low + high) / 2 if half < radius else np.zeros(2)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    width, height = high - low
    if half < radius and 0 < height < 0.25 * width:  # upward a scale of its own
        axes.set_ylim(low[1], high[1])
        axes.set_box_aspect(1)
    else:
        axes.set_ylim(middle[1] - half, middle[1] + half)
        axes.set_aspect("equal")
    axes.xaxis.set_major_locator(Places(3))
    axes.yaxis.set_major_locator(Places(4))


BODY = {"color": look.LINES[1]["color"], "linewidth": 1.5, "linestyle": (0, (3, 1))}
TOUCH = {"color": look.INK, "linewidth": 1.3}


def turn_by_euler(vector: np.ndarray, phi: object, theta: object, psi: object) -> np.ndarray:
    """A vector of body axes in space axes, by Rz(phi) Rx(theta) Rz(psi); components by rows."""
    x, y, z = vector
    x, y = x * np.cos(psi) - y * np.sin(psi), x * np.sin(psi) + y * np.cos(psi)
    y, z = y * np.cos(theta) - z * np.sin(theta), y * np.sin(theta) + z * np.cos(theta)
    return np.array([x * np.cos(phi) - y * np.sin(phi), x * np.sin(phi) + y * np.cos(phi), z])


def in_body_and_space(table: Table) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The angular velocity in body axes, in space, and as the body lies at the start; by rows."""
    body = np.array([table.column(f"omega{i}") for i in (1, 2, 3)])
    angles = [table.column(name) for name in ("phi", "theta", "psi")]
    return body, turn_by_euler(body, *angles), turn_by_euler(body, *(each[0] for each in angles))


@figure("trajectory", "phi theta psi omega1 omega2 omega3")
def draw_cones(table: Table) -> Figure:
    """Angular velocity in the body and in space (polhode and herpolhode)."""
    title = "Angular velocity: polhode cone of the body, rolling on the herpolhode cone in space"
    figure, (globe, body, space) = three_panels(table, title)
    draw_globe(globe)
    in_body, in_space, at_start = in_body_and_space(table)
    draw_cone(globe, in_space, FRONT, BACK)
    draw_cone(globe, at_start, BODY, BODY | {"color": look.PALE, "linewidth": 1.1})
    touch = directions(in_space)[:, :1]
    if touch.size:
        (x,), (y,), _ = project(*touch)
        globe.plot([0, x], [0, y], **TOUCH, zorder=4)
        globe.annotate(r"$\omega$", (x, y), (4, 4), textcoords="offset points", zorder=6)
    globe.plot(0, 0, "o", color=look.GREY, markersize=2.5, zorder=4)
    globe.set_title("directions, at the start", loc="center")
    draw_cone_plane(body, in_body, BODY | {"linestyle": "-"}, "12", "in the body")
    draw_cone_plane(space, in_space, FRONT, "xy", "in space, from above")
    looks = {"cone of the body": BODY, "cone in space": FRONT, "where they touch": TOUCH} | ENDS
    legend_below([globe], looks, look.by_width(5, 2))
    return figure


def directions(omega: np.ndarray) -> np.ndarray:
    """Unit vectors along angular velocities, without those that are about zero."""
    size = np.linalg.norm(omega, axis=0)
    there = size > 1e-9 * np.nanmax(size)  # slower ones have no direction
    return omega[:, there] / size[there]


def draw_cone(axes: Axes, omega: np.ndarray, front: dict, back: dict) -> None:
    """The curve of directions on the sphere, with rays to it from the middle."""
    points = directions(omega)
    draw_seen(axes, tuple(points), *(thin_if_long(style, points) for style in (front, back)))
    x, y, towards = project(*points)
    passed = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=1), axis=0))])
    places = np.searchsorted(passed, np.linspace(0, min(passed[-1], 2 * np.pi), 24))
    for place in np.unique(np.minimum(places, len(x) - 1)):
        colour = (front if towards[place] >= 0 else back)["color"]
        ray = {"color": colour, "linewidth": 0.5, "alpha": 0.6, "zorder": 2}
        axes.plot([0, x[place]], [0, y[place]], **ray)


def thin_if_long(style: dict, curve: np.ndarray) -> dict:
    """A style with a thin line for a curve of many circles, which would be a solid area."""
    length = np.nansum(np.linalg.norm(np.diff(curve, axis=1), axis=0))
    extent = np.max(np.nanmax(curve, axis=1) - np.nanmin(curve, axis=1))
    is_long = length > 15 * np.pi * extent
    return style | {"linewidth": 0.4} if is_long else style


def draw_cone_plane(axes: Axes, omega: np.ndarray, style: dict, names: str, heading: str) -> None:
    """Two components of the angular velocity against each other, from start to end."""
    path = omega[:2]
    axes.plot(*path, **thin_if_long(style, path), rasterized=path.shape[1] > MANY_POINTS)
    axes.plot(0, 0, "+", color=look.GREY)
    mark_ends(axes, *path)
    side = 1.08 * float(np.nanmax(np.abs(path))) or 1.0
    axes.set(xlim=(-side, side), ylim=(-side, side), aspect="equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(Places(4))
    name_axes(axes, *((rf"$\omega_{name}$", "rad/s") for name in names))
    axes.set_title(heading)
