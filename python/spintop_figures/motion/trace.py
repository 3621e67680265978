"""The path of the axis tip on the unit sphere, seen from far away and a little from above."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spintop_figures.motion.extremes import inclination_extremes, sparseness
from spintop_figures.motion.trajectory import numbers
from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import DOTS, GREY, HIDDEN, LINES, WIDTH
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

ELEVATION = np.radians(28)
"""How far above the horizon the eye is."""

GRID = np.radians(30)
"""Distance of the circles of the graticule."""

LEAST_NUTATION = np.radians(0.5)
"""A smaller range of the inclination is about the width of the line of the path."""

CIRCLE = np.linspace(0, 2 * np.pi, 241)

MOST_ACROSS = 3
"""Spheres in a row."""

LEGEND = 0.25
"""Height of the legend in inches."""

LETTERS = 12
"""Letters of a title per inch."""

FRONT = {"color": LINES[0]["color"], "linewidth": 1.5}
BACK = {"color": HIDDEN, "linewidth": 1.1}
"""The path before the sphere, and behind it a paler tint of the same colour."""

START = {"color": LINES[1]["color"], "linestyle": "", "marker": "o", "markersize": 5.5}
"""Where the path begins; empty if that is behind the sphere."""


def project(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, ...]:
    """Points of space as seen: to the right, upward, and towards the eye, which is at -y."""
    up = z * np.cos(ELEVATION) + y * np.sin(ELEVATION)
    towards = z * np.sin(ELEVATION) - y * np.cos(ELEVATION)
    return x, up, towards


def on_sphere(theta: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, ...]:
    """The tip of the axis of a top in space."""
    return np.sin(theta) * np.sin(phi), -np.sin(theta) * np.cos(phi), np.cos(theta)


def draw_seen(axes: Axes, points: tuple[np.ndarray, ...], front: dict, back: dict) -> None:
    """A curve on the sphere: its part before the sphere in one style, that behind it in another."""
    x, y, towards = project(*points)
    rasterized = len(x) > MANY_POINTS
    for style, shown, order in ((back, towards <= 0, 1), (front, towards >= 0, 3)):
        if "marker" not in style:
            shown = shown | np.roll(shown, 1)  # no gaps where it passes the edge
        line = np.where(shown, x, np.nan), np.where(shown, y, np.nan)
        axes.plot(*line, **{"zorder": order, "rasterized": rasterized} | style)


def draw_globe(axes: Axes) -> None:
    """The edge of the sphere, its graticule, and the vertical."""
    axes.fill(np.cos(CIRCLE), np.sin(CIRCLE), color="0.975", zorder=0)
    axes.plot(np.cos(CIRCLE), np.sin(CIRCLE), color="0.5", linewidth=0.9)
    front, back = ({"color": shade, "linewidth": 0.5, "zorder": 1} for shade in ("0.72", "0.9"))
    for theta in np.arange(GRID, np.pi - GRID / 2, GRID):
        draw_seen(axes, on_sphere(np.full_like(CIRCLE, theta), CIRCLE), front, back)
    for phi in np.arange(0, np.pi, GRID):
        draw_seen(axes, on_sphere(CIRCLE, np.full_like(CIRCLE, phi)), front, back)
    top = np.cos(ELEVATION)
    axes.annotate(
        "", (0, top + 0.3), (0, top), arrowprops={"arrowstyle": "-|>", "color": GREY, "lw": 0.9}
    )
    axes.text(0.05, top + 0.22, "$z$", color=GREY, fontsize=9)


def path_of(table: Table) -> np.ndarray:
    """Inclination and azimuth, where there are both."""
    path = np.array([numbers(table, name) for name in ("theta", "phi")])
    return path[:, np.isfinite(path).all(axis=0)]


def object_to_trace(table: Table) -> str:
    """A path has at least one point."""
    return "" if path_of(table).size else "has no row with both angles"


def nutates(table: Table) -> bool:
    """Whether the circles of the extreme inclinations differ from each other and from the path."""
    low, high = inclination_extremes(table)
    return high.value - low.value > LEAST_NUTATION


def draw_path_on(axes: Axes, table: Table) -> None:
    """The path of a motion, between the circles of its minimum and its maximum inclination."""
    draw_globe(axes)
    theta, phi = path_of(table)
    edge = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
    for extreme in inclination_extremes(table) if nutates(table) else ():
        circle = on_sphere(np.full_like(CIRCLE, extreme.value), CIRCLE)
        draw_seen(axes, circle, edge, edge | {"color": "0.82"})
    tip = on_sphere(theta, phi)
    front, back = (DOTS, DOTS | {"color": HIDDEN}) if sparseness(*tip) else (FRONT, BACK)
    draw_seen(axes, tip, front, back)
    x, y, towards = project(*(part[:1] for part in tip))
    axes.plot(x, y, **START, mfc=START["color"] if towards[0] >= 0 else "white", zorder=5)
    axes.set(xlim=(-1.06, 1.06), ylim=(-1.06, 1.28), aspect="equal")
    axes.axis("off")


def turns_of(table: Table) -> list[str]:
    """The extremes of the inclination and the azimuth passed, in lines of words."""
    theta, phi = path_of(table)
    low, high = inclination_extremes(table)
    note = (low if low.of_rows else high).note()
    turned = f"{np.degrees(phi[-1] - phi[0]):+.4g}".replace("-", "\N{MINUS SIGN}")
    words = f"θ {np.degrees(low.value):.4g}° to {np.degrees(high.value):.4g}°{note}, φ {turned}°"
    sparse = sparseness(*on_sphere(theta, phi))
    return [words, sparse] if sparse else [words]


def draw_traces(tables: Sequence[Table]) -> Figure:
    """The paths of several motions side by side, each under its title."""
    across = min(len(tables), MOST_ACROSS)
    down = -(-len(tables) // across)
    side = min(WIDTH / across, 4.6)
    figure = new_figure(
        tables, "Path of the axis tip on the unit sphere", 1.0 + (side + 0.3) * down
    )
    grid = figure.add_gridspec(down + 1, across, height_ratios=[*[side] * down, LEGEND])
    panels = [figure.add_subplot(grid[place]) for place in np.ndindex(down, across)]
    for axes in panels:
        axes.axis("off")
    for axes, table in zip(panels, tables, strict=False):
        draw_path_on(axes, table)
        title = [table.title] if len(tables) > 1 else []
        words = "\n".join([*title, *turns_of(table)])
        lines = [textwrap.fill(line, int(side * LETTERS)) for line in words.split("\n")]
        axes.set_title("\n".join(lines), fontsize=9, pad=2, parse_math=False)
    key = figure.add_subplot(grid[down, :])
    key.axis("off")
    handles = legend_handles()[: 4 if any(map(nutates, tables)) else 3]
    key.legend(handles=handles, loc="center left", ncols=4, columnspacing=1.4)
    return figure


def legend_handles() -> list[Line2D]:
    """What the lines are."""
    ends = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
    return [
        Line2D([], [], **FRONT, label="path of the tip"),
        Line2D([], [], **BACK, label="on the far side"),
        Line2D([], [], **START, label="start"),
        Line2D([], [], **ends, label="minimum and maximum inclination"),
    ]


def draw_trace(table: Table) -> Figure:
    """The path of a single motion."""
    return draw_traces([table])
