"""The inclination of a symmetric top by itself: its effective potential, and its phase portrait."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.motion.reduced import Reduced, find_reduced
from spintop_figures.motion.trajectory import numbers
from spintop_figures.style.look import FAINT, GREY, LINES
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

ROOM = 0.35
"""What is seen on either side of the motion, over its range."""

LEAST_ROOM = 1e-9
"""In radians."""

LEVELS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
"""Amplitudes of the level curves over that of the motion."""

INCLINATION = axis_of("theta", "deg")
BAND = "#d3e8f0"


def seen(reduced: Reduced) -> tuple[float, float]:
    """The range of inclinations that a figure shows, rad."""
    least, largest = reduced.turning_points()
    room = max(ROOM * (largest - least), LEAST_ROOM)
    return max(0.0, least - room), min(np.pi, largest + room)


def draw_potential(table: Table) -> Figure:
    """The effective potential with the energy of the motion, its turning points and its band."""
    reduced = find_reduced(table)
    figure = new_figure(table, "Effective potential of the inclination", 4.2)
    axes = figure.subplots()
    low, high = seen(reduced)
    theta = np.linspace(low, high, 2001)
    values = reduced.potential(theta)
    turns = reduced.turning_points()
    bottom = reduced.potential(reduced.resting_point())
    depth = reduced.energy - bottom
    axes.axvspan(*np.degrees(turns), color=BAND, linewidth=0, zorder=0)
    axes.axhline(reduced.energy, **LINES[1], label="energy of the motion")
    axes.plot(np.degrees(theta), values, **LINES[0], label="effective potential")
    axes.plot(
        np.degrees(theta),
        reduced.weight * np.cos(theta),
        **LINES[2],
        label=r"weight alone, $mgl\cos\theta$",
    )
    axes.plot(np.degrees(turns), [reduced.energy] * 2, "o", color="black", label="turning points")
    floor = min(bottom, np.min(reduced.weight * np.cos(theta)))
    axes.set_ylim(min(bottom - 0.15 * depth, max(floor, bottom - depth)), bottom + 1.5 * depth)
    axes.set_xlim(np.degrees(low), np.degrees(high))
    for turn, side, shift in zip(turns, ("left", "right"), (8, -8), strict=True):
        axes.annotate(
            f"{np.degrees(turn):.4f}°",
            (np.degrees(turn), reduced.energy),
            (shift, 6),
            textcoords="offset points",
            ha=side,
        )
    axes.set(xlabel=INCLINATION, ylabel="energy minus energy of the spin (J)")
    draw_legend(axes)
    return figure


def draw_portrait(table: Table) -> Figure:
    """Inclination and its rate: the motion among the level curves of the energy."""
    reduced = find_reduced(table)
    figure = new_figure(table, "Phase portrait of the inclination", 4.6)
    axes = figure.subplots()
    low, high = seen(reduced)
    depth = reduced.energy - reduced.potential(reduced.resting_point())
    fastest = np.sqrt(2 * depth / reduced.inertia)
    draw_levels(axes, reduced, (low, high), 1.4 * fastest)
    rate = numbers(table, "theta_rate")
    dots = {"linestyle": "", "marker": "o", "markersize": 2.5, "markeredgewidth": 0}
    axes.plot(np.degrees(numbers(table, "theta")), rate, **LINES[0] | dots, label="the motion")
    middle = np.degrees(reduced.resting_point())
    axes.plot(middle, 0, "k+", markersize=9, label="equilibrium")
    axes.set(xlabel=INCLINATION, ylabel=r"its rate $\dot\theta$ (rad/s)")
    axes.set(xlim=np.degrees((low, high)), ylim=(-1.4 * fastest, 1.4 * fastest))
    draw_legend(axes)
    return figure


def draw_legend(axes: Axes) -> None:
    """What the curves are, above the panel."""
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.01, 1.0), ncols=4, columnspacing=1.2, borderpad=0.2
    )


def draw_levels(axes: Axes, reduced: Reduced, seen: tuple[float, float], fastest: float) -> None:
    """The level curves of the energy, and the separatrix where there is one."""
    theta = np.linspace(*seen, 801)
    rate = np.linspace(-fastest, fastest, 401)
    well = reduced.potential(theta)
    energy = np.minimum(well, 1e300) + reduced.inertia * rate[:, np.newaxis] ** 2 / 2
    bottom = reduced.potential(reduced.resting_point())
    depth = reduced.energy - bottom
    curves = [bottom + amplitude**2 * depth for amplitude in LEVELS]
    style = {"colors": "0.6", "linewidths": 0.8, "linestyles": "-"}
    axes.contour(np.degrees(theta), rate, energy, levels=curves, **style)
    axes.plot([], [], color="0.6", linewidth=0.8, label="equal energy")
    axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)
    if (separatrix := reduced.separatrix()) is not None:
        style = {"color": GREY, "linewidth": 1.6, "linestyle": (0, (5, 2)), "zorder": 3}
        squares = 2 * (separatrix - well) / reduced.inertia
        branch = np.sqrt(np.where(squares >= 0, squares, np.nan))
        axes.plot(np.degrees(theta), branch, **style, label="separatrix, to the upright")
        axes.plot(np.degrees(theta), -branch, **style)
