"""Paths of a point on a sphere: the whole sphere from afar, or the cap that a path keeps to.

A direction of space is three arrays, x, y and z, of unit vectors; the sphere has the radius 1.
"""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import DOTS, FAINT, GREY, GROUND, HIDDEN, LINES, WASH
from spintop_figures.style.numbers import write

Points = tuple[np.ndarray, np.ndarray, np.ndarray]

ELEVATION = np.radians(28)
"""How far above the horizon the eye is, where the whole sphere is seen."""

GRID = np.radians(30)
"""Distance of the circles of the graticule."""

LARGEST_CAP = np.radians(35)
"""A path that keeps to a smaller cap is seen through a window."""

ROOM = 1.12
"""The radius of a window over that of the cap."""

AT_POLE = 0.2
"""A cap whose centre is nearer to a pole, over its radius, is seen from straight above."""

STEPS = 500
"""Of the search for the least cap, which is off by one part in so many."""

INSET = (0.84, 0.82, 0.22, 0.22)
"""Where the small globe is beside a window, over the sides of the panel."""

CIRCLE = np.linspace(0, 2 * np.pi, 241)

MOST_DOTS = 1000
"""Points that are not joined: more are thinned, or they would be a cloud."""

START_OF_ARROW = 0.3
"""How far from its start, over the radius of what is seen, a path has its arrow."""

FRONT = {"color": LINES[0]["color"], "linewidth": 1.5}
BACK = {"color": HIDDEN, "linewidth": 1.1}
"""The path before the sphere, and behind it a paler tint of the same colour."""

ENDS = {
    "start": {"color": LINES[1]["color"], "linestyle": "", "marker": "o", "markersize": 6},
    "end": {"color": LINES[1]["color"], "linestyle": "", "marker": "D", "markersize": 5.5},
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


def find_cap(points: Points) -> tuple[np.ndarray, float]:
    """The middle of the least cap that holds the points, and its angular radius, rad.

    The middle moves towards the furthest point by ever shorter steps (Badoiu and Clarkson 2003).
    """
    directions = np.array(points)
    middle = directions[:, 0].copy()
    for step in range(2, STEPS):
        furthest = directions[:, np.argmin(middle @ directions)]
        middle += (furthest - middle) / step
    size = np.linalg.norm(middle)
    middle = middle / size if size > 0 else WHOLE.towards
    return middle, radius_about(middle, directions)


def radius_about(middle: np.ndarray, directions: np.ndarray) -> float:
    """The largest angle between a direction and others, rad; also where it is tiny."""
    chord = np.linalg.norm(directions - middle[:, np.newaxis], axis=0).max()
    return float(2 * np.arcsin(min(chord / 2, 1.0)))


def view_of(points: Points) -> View:
    """The view of a path: of the whole sphere, or of a small cap from straight above it."""
    middle, radius = find_cap(points)
    if not 0 < radius < LARGEST_CAP:
        return WHOLE
    pole = np.array([0.0, 0.0, np.copysign(1.0, middle[2])])
    if np.linalg.norm(middle - pole) < AT_POLE * radius:
        middle, radius = pole, radius_about(pole, np.array(points))
    upright = np.array([0.0, 1.0, 0.0]) if abs(middle[2]) == 1 else np.array([0.0, 0.0, 1.0])
    up = upright - (upright @ middle) * middle
    up /= np.linalg.norm(up)
    return View(np.cross(up, middle), up, middle, ROOM * float(np.sin(radius)))


def draw_seen(
    axes: Axes, points: Points, front: dict, back: dict | None = None, view: View = WHOLE
) -> None:
    """A curve on the sphere: its part before the sphere in one style, that behind it in another.

    What is outside of a window, or behind without a style for it, is left out.
    """
    x, y, towards = project(*points, view)
    inside = np.hypot(x, y) <= view.window * (1 + 1e-9)
    rasterized = len(x) > MANY_POINTS
    for style, shown, order in ((back, towards <= 0, 1), (front, towards >= 0, 3)):
        if style is None or not (shown & inside).any():
            continue
        shown = shown & inside
        if "marker" not in style:
            shown = shown | np.roll(shown, 1)  # no gaps where it passes the edge
        line = np.where(shown, x, np.nan), np.where(shown, y, np.nan)
        axes.plot(*line, **{"zorder": order, "rasterized": rasterized} | style)


def draw_globe(axes: Axes, view: View = WHOLE) -> None:
    """The edge of the sphere or of the window, the graticule, and the vertical."""
    edge = view.window * np.array([np.cos(CIRCLE), np.sin(CIRCLE)])
    axes.fill(*edge, color=WASH, zorder=0)
    axes.plot(*edge, color=GREY, linewidth=0.8)
    front = {"color": FAINT, "linewidth": 0.5, "zorder": 1}
    if view.window < 1:
        draw_fine_grid(axes, view, front)
    else:
        back = front | {"alpha": 0.5}
        for theta in np.arange(GRID, np.pi - GRID / 2, GRID):
            draw_seen(axes, on_sphere(np.full_like(CIRCLE, theta), CIRCLE), front, back)
        for phi in np.arange(0, np.pi, GRID):
            draw_seen(axes, on_sphere(CIRCLE, np.full_like(CIRCLE, phi)), front, back)
        top, arrow = np.cos(ELEVATION), {"arrowstyle": "-|>", "color": GREY, "lw": 0.9}
        axes.annotate("", (0, top + 0.3), (0, top), arrowprops=arrow)
        axes.text(0.05, top + 0.22, "$z$", color=GREY, fontsize="small")
    side = 1.06 * view.window
    axes.set(xlim=(-side, side), ylim=(-side, side if view.window < 1 else 1.28), aspect="equal")
    axes.set_axis_off()


def draw_fine_grid(axes: Axes, view: View, style: dict) -> None:
    """Circles of equal inclination in a window, with their numbers, and meridians."""
    radius = np.arcsin(min(view.window, 1.0))
    middle = np.arctan2(np.hypot(*view.towards[:2]), view.towards[2])
    step = np.radians(round_step(np.degrees(radius) / 2.5))
    low, high = max(middle - radius, 0.0), min(middle + radius, np.pi)
    around = np.linspace(0, 2 * np.pi, 2881)
    for count in range(int(np.ceil(low / step)), int(high / step) + 1):
        if 0 < count * step < np.pi * (1 - 1e-12):
            circle = on_sphere(np.full_like(around, count * step), around)
            draw_seen(axes, circle, style, view=view)
            name_circle(axes, circle, f"{write(np.degrees(count * step), 8)}°", view)
    down = np.linspace(low, high, 181)
    apart = GRID if low == 0 or high == np.pi else step / np.sin(middle)
    apart = 2 * np.pi / max(round(2 * np.pi / apart), 12)
    for phi in np.arange(0, 2 * np.pi - apart / 2, apart):
        draw_seen(axes, on_sphere(down, np.full_like(down, phi)), style, view=view)


def round_step(least: float) -> float:
    """The next number above that is 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least))


def name_circle(axes: Axes, circle: Points, name: str, view: View) -> None:
    """The number of a circle, at its lower right end in the window."""
    x, y, towards = project(*circle, view)
    inside = (np.hypot(x, y) < 0.97 * view.window) & (towards > 0)
    if not inside.any():
        return
    place = int(np.argmax(np.where(inside, x - 0.8 * y, -np.inf)))
    outline = [withStroke(linewidth=2, foreground=WASH)]
    style = {"fontsize": "small", "color": GREY, "ha": "center", "va": "center", "zorder": 2}
    axes.text(x[place], y[place], name, path_effects=outline, **style)


def draw_path_on(axes: Axes, points: Points, joined: bool) -> View:
    """A path on the sphere, or in a window with a small globe that tells where it is."""
    there = np.isfinite(points).all(axis=0)
    points = tuple(part[there] for part in points)
    view = view_of(points)
    draw_globe(axes, view)
    front, back = (FRONT, BACK) if joined else (DOTS, DOTS | {"color": HIDDEN})
    shown = points if joined else thinned(points)
    draw_seen(axes, shown, front, back, view)
    if joined:
        draw_arrow(axes, points, view)
    for name, place in (("end", -1), ("start", 0)):
        (x,), (y,), (towards,) = project(*(part[place:][:1] for part in points), view)
        face = ENDS[name]["color"] if towards >= 0 else GROUND
        axes.plot(x, y, **ENDS[name], mfc=face, mec=GROUND if towards >= 0 else None, zorder=5)
    if view.window < 1:
        draw_inset(axes, view)
    return view


def thinned(points: Points) -> Points:
    """Points that are not joined, MOST_DOTS at most."""
    every = -(-len(points[0]) // MOST_DOTS)
    return tuple(part[::every] for part in points)


def draw_arrow(axes: Axes, points: Points, view: View) -> None:
    """The direction of a path, near its start and before the sphere."""
    x, y, towards = project(*points, view)
    far = np.hypot(x - x[0], y - y[0]) > START_OF_ARROW * view.window
    steps = np.hypot(np.diff(x), np.diff(y)) > 0
    places = np.flatnonzero(far[:-1] & (towards[:-1] > 0) & steps)
    if not places.size:
        return
    begin = places[0]
    unit = np.array([x[begin + 1] - x[begin], y[begin + 1] - y[begin]])
    tip = np.array([x[begin], y[begin]])
    tail = tip - 0.02 * view.window * unit / np.linalg.norm(unit)
    arrow = {"arrowstyle": "-|>", "color": FRONT["color"], "lw": 0, "mutation_scale": 15}
    axes.annotate("", tip, tail, arrowprops=arrow | {"shrinkA": 0, "shrinkB": 0}, zorder=4)


def draw_inset(axes: Axes, view: View) -> None:
    """A small globe with the window on it."""
    inset = axes.inset_axes(INSET)
    draw_globe(inset)
    angle = np.arcsin(view.window)
    rim = np.cos(angle) * view.towards[:, np.newaxis] + view.window * (
        view.right[:, np.newaxis] * np.cos(CIRCLE) + view.up[:, np.newaxis] * np.sin(CIRCLE)
    )
    look = {"color": LINES[1]["color"], "linewidth": 1.4}
    if angle < np.radians(2):
        rim, look = view.towards[:, np.newaxis], {"color": LINES[1]["color"], "marker": "o"}
        look["markersize"] = 3
    draw_seen(inset, tuple(rim), look, look | {"alpha": 0.4})


def path_handles(views: list[View], joined: list[bool]) -> list[Line2D]:
    """What the lines of paths are, for a legend of all of them."""
    front, back = (FRONT, BACK) if any(joined) else (DOTS, DOTS | {"color": HIDDEN})
    handles = [Line2D([], [], **front, label="path")]
    if any(view.window >= 1 for view in views):
        handles.append(Line2D([], [], **back, label="on the far side"))
    return handles + [Line2D([], [], **look, label=name) for name, look in ENDS.items()]
