"""The path of the axis tip on the unit sphere, seen from far away and a little from above."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures.style import GREY, LINES, MANY_POINTS, WIDTH, new_figure
from figures.table import Table
from figures.trajectory import numbers

ELEVATION = np.radians(28)
"""How far above the horizon the eye is."""

GRID = np.radians(30)
"""Distance of the circles of the graticule."""

HIDDEN = "#e9b48f"
"""The path behind the sphere."""

CIRCLE = np.linspace(0, 2 * np.pi, 241)

MOST_ACROSS = 3
"""Spheres in a row."""


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


def draw_path_on(axes: Axes, table: Table) -> None:
    """The path of a motion, between the circles of its least and its largest inclination."""
    draw_globe(axes)
    theta, phi = path_of(table)
    edge = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (4, 2))}
    for extreme in (theta.min(), theta.max()):
        circle = on_sphere(np.full_like(CIRCLE, extreme), CIRCLE)
        draw_seen(axes, circle, edge, edge | {"color": "0.82"})
    front = {"color": LINES[0]["color"], "linewidth": 1.5}
    draw_seen(axes, on_sphere(theta, phi), front, {"color": HIDDEN, "linewidth": 1.1})
    x, y, towards = project(*on_sphere(theta[:1], phi[:1]))
    style = {"color": LINES[1]["color"], "markersize": 5.5, "zorder": 5}
    axes.plot(x, y, "o", **style, mfc=LINES[1]["color"] if towards[0] >= 0 else "white")
    axes.set(xlim=(-1.06, 1.06), ylim=(-1.06, 1.28), aspect="equal")
    axes.axis("off")


def turns_of(table: Table) -> str:
    """The extremes of the inclination and the azimuth passed, in words."""
    theta, phi = np.degrees(path_of(table))
    turned = f"{phi[-1] - phi[0]:.4g}".replace("-", "\N{MINUS SIGN}")
    return f"θ {theta.min():.4g}° to {theta.max():.4g}°, φ by {turned}°"


def draw_traces(tables: Sequence[Table]) -> Figure:
    """The paths of several motions side by side, each under its title."""
    across = min(len(tables), MOST_ACROSS)
    down = -(-len(tables) // across)
    side = min(WIDTH / across, 4.6)
    figure = new_figure(
        tables, "Path of the axis tip on the unit sphere", 1.15 + (side + 0.3) * down
    )
    panels = list(figure.subplots(down, across, squeeze=False).flat)
    for axes in panels:
        axes.axis("off")
    for axes, table in zip(panels, tables, strict=False):
        draw_path_on(axes, table)
        title = f"{table.title}\n" if len(tables) > 1 else ""
        axes.set_title(title + turns_of(table), fontsize=9, pad=2, parse_math=False)
    return figure


def draw_trace(table: Table) -> Figure:
    """The path of a single motion."""
    return draw_traces([table])
