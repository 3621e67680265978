"""The inclination of a symmetric top by itself: its effective potential, and its phase portrait."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.motion.reduced import Reduced, find_reduced
from spintop_figures.motion.trajectory import decimals_for, numbers
from spintop_figures.style.look import FAINT, LINES, by_width
from spintop_figures.style.numbers import write_fixed
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

ROOM = 0.35
"""What is seen on either side of the motion, over its range."""

LEAST_ROOM = 1e-9
"""In radians."""

LEVELS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
"""Amplitudes of the level curves over that of the motion."""

NEVER = 1e-9
"""A motion whose energy is that of the separatrix, over its depth, never reaches the upright."""

JOINED = 0.1
"""Rows that are nearer to each other, over the panel, are joined."""

INCLINATION = axis_of("theta", "deg")
BAND = "#d3e8f0"
SEPARATRIX = {"color": "#f0c4a6", "linewidth": 4, "linestyle": "-", "zorder": 1.5}
"""A wide line that a motion may be on."""


def seen(reduced: Reduced) -> tuple[float, float]:
    """The range of inclinations that a figure shows, rad."""
    least, largest = reduced.turning_points()
    room = max(ROOM * (largest - least), LEAST_ROOM)
    return max(0.0, least - room), min(np.pi, largest + room)


def clustered(low: float, high: float, count: int = 2001) -> np.ndarray:
    """Inclinations that are dense at both ends, where a barrier may rise without end."""
    return low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, count))) / 2


def turns_of(reduced: Reduced) -> list[tuple[float, bool]]:
    """The ends of the inclination, rad, and whether the motion turns there.

    On the separatrix it approaches the upright, and never reaches it.
    """
    separatrix = reduced.separatrix()
    depth = reduced.energy - reduced.potential(reduced.resting_point())
    never = separatrix is not None and abs(reduced.energy - separatrix) <= NEVER * depth
    upright = 0.0 if reduced.weight > 0 else np.pi
    ends = reduced.turning_points()
    least = min(ends, key=lambda end: abs(end - upright))
    return [(upright, False) if never and end == least else (end, True) for end in ends]


def draw_potential(table: Table) -> Figure:
    """The effective potential with the energy of the motion, its turning points and its band."""
    reduced = find_reduced(table)
    figure = new_figure(table, "Effective potential of the inclination", 4.2)
    axes = figure.subplots()
    low, high = seen(reduced)
    theta = clustered(low, high)
    values = reduced.potential(theta)
    ends = turns_of(reduced)
    turns = [end for end, _ in ends]
    bottom = reduced.potential(reduced.resting_point())
    depth = reduced.energy - bottom
    axes.axvspan(*np.degrees(turns), color=BAND, linewidth=0, zorder=0, label="allowed")
    axes.axhline(reduced.energy, **LINES[1], label="energy of the motion")
    axes.plot(np.degrees(theta), values, **LINES[0], label="effective potential")
    axes.plot(
        np.degrees(theta),
        reduced.weight * np.cos(theta),
        **LINES[2],
        label=r"weight alone, $mgl\cos\theta$",
    )
    floor = min(bottom, np.min(reduced.weight * np.cos(theta)))
    axes.set_ylim(min(bottom - 0.15 * depth, max(floor, bottom - depth)), bottom + 1.5 * depth)
    axes.set_xlim(np.degrees(low), np.degrees(high))
    decimals = decimals_for(np.degrees(turns[1] - turns[0]), 2)
    for (turn, turning), side, shift in zip(ends, ("left", "right"), (8, -8), strict=True):
        words = f"{write_fixed(np.degrees(turn), decimals)}°"
        face = "black" if turning else "white"
        place = np.degrees(turn), reduced.energy
        axes.plot(*place, "o", mec="black", mfc=face, clip_on=False, zorder=4)
        axes.annotate(
            words if turning else f"{write_fixed(np.degrees(turn), 0)}°, never reached",
            place,
            (shift, 6),
            textcoords="offset points",
            ha=side,
        )
    axes.plot([], [], "o", color="black", label="turning point")
    axes.set(xlabel=INCLINATION, ylabel="energy minus energy of the spin (J)")
    draw_legend(axes, 3)
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
    theta, rate = numbers(table, "theta"), numbers(table, "theta_rate")
    steps = np.hypot(np.diff(theta) / (high - low), np.diff(rate) / (2.8 * fastest))
    joined = np.nanmax(steps) < JOINED
    dots = {} if joined else {"linestyle": "", "marker": "o", "markersize": 2.5}
    look = LINES[0] | {"linewidth": 1.8} | dots
    axes.plot(np.degrees(theta), rate, **look, label="the motion")
    draw_arrows(axes, np.degrees(theta), rate)
    middle = np.degrees(reduced.resting_point())
    axes.plot(middle, 0, "k+", markersize=9, label="equilibrium")
    axes.set(xlabel=INCLINATION, ylabel=axis_of("theta_rate", "rad/s"))
    axes.set(xlim=np.degrees((low, high)), ylim=(-1.4 * fastest, 1.4 * fastest))
    draw_legend(axes, 4)
    return figure


def draw_arrows(axes: Axes, theta: np.ndarray, rate: np.ndarray) -> None:
    """The direction of the motion where it is fastest: to the right where the rate is positive."""
    look = {"arrowstyle": "-|>", "color": LINES[0]["color"], "lw": 0, "mutation_scale": 16}
    look |= {"shrinkA": 0, "shrinkB": 0}
    for sign in (1, -1):
        place = max(int(np.nanargmax(sign * rate)), 1)
        if sign * rate[place] <= 0 or theta[place] == theta[place - 1]:
            continue
        tail, tip = ((theta[i], rate[i]) for i in (place - 1, place))
        axes.annotate("", tip, tail, arrowprops=look, zorder=4)


def draw_legend(axes: Axes, across: int) -> None:
    """What the curves are, above the panel, so many in a row."""
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.01, 1.0),
        ncols=by_width(across, 2),
        columnspacing=1.2,
        borderpad=0.2,
    )


def draw_levels(axes: Axes, reduced: Reduced, seen: tuple[float, float], fastest: float) -> None:
    """The level curves of the energy, and the separatrix where there is one."""
    theta = clustered(*seen, 801)
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
        squares = 2 * (separatrix - well) / reduced.inertia
        branch = np.sqrt(np.where(squares >= 0, squares, np.nan))
        axes.plot(np.degrees(theta), branch, **SEPARATRIX, label="separatrix, to the upright")
        axes.plot(np.degrees(theta), -branch, **SEPARATRIX)
