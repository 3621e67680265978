"""The figures of a trajectory that show quantities of the motion against time."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.motion.extremes import Extreme, height_extremes, inclination_extremes
from spintop_figures.moving.assumptions import LAGRANGE, broken
from spintop_figures.style.lines import draw_line, set_degree_ticks
from spintop_figures.style.look import FAINT, GREY, LINES, by_width
from spintop_figures.style.numbers import write_fixed
from spintop_figures.style.page import new_figure
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

TIME = "time t (s)"

SAME, MOST_INCLINATIONS = 1.0, 3
"""Sign changes at inclinations that differ by fewer degrees are at one; more are not marked."""

NEAR_POLE, LEAST_JUMP, SAME_TURN = np.radians(15), np.radians(45), 0.5
"""Of jumps at a pole: how near to it, how large, and what part of them the body turns at most."""

DENSE = 150
"""A curve that turns more often in the width of a panel has a thin line."""

MOST_DECIMALS = 8
"""Extremes that differ only in further decimals have no numbers."""

MOST_OFTEN = 0.25
"""Sign changes between more of the rows than this part are those of rounding."""


def numbers(table: Table, column: str) -> np.ndarray:
    """A column as an array."""
    return table.rows[column].to_numpy(float)


def four_panels(table: Table, what: str) -> tuple[Figure, list[Axes]]:
    """A figure with four panels over the same time."""
    figure = new_figure(table, what, height=by_width(5.4, 8.6))
    across = by_width(2, 1)
    axes = figure.subplots(4 // across, across, sharex=True, squeeze=False)
    for panel in axes[-1]:
        panel.set_xlabel(TIME)
    for panel in axes.flat:
        panel.margins(x=0.01)
    return figure, list(axes.flat)


def pole_jumps(phi: np.ndarray, theta: np.ndarray, psi: np.ndarray) -> np.ndarray:
    """The rows before which the axis passed so near a pole that azimuth and spin jumped.

    There only their sum or their difference is an angle of the body, and goes on without a jump.
    """
    turned = np.abs(np.diff(phi))
    steps = (np.diff(phi + psi), np.diff(phi - psi))
    on = np.minimum(*(np.abs(np.remainder(step + np.pi, 2 * np.pi) - np.pi) for step in steps))
    off_pole = np.minimum(theta, np.pi - theta)
    near = np.minimum(off_pole[1:], off_pole[:-1]) < NEAR_POLE
    return np.flatnonzero(near & (turned > LEAST_JUMP) & (on < SAME_TURN * turned)) + 1


def draw_angles(table: Table) -> Figure:
    """Euler angles and height of the centre of mass against time (Figure 8)."""
    figure, panels = four_panels(table, "Euler angles and height of the centre of mass")
    t = numbers(table, "t")
    angles = {name: numbers(table, name) for name in ("phi", "theta", "psi")}
    jumps = pole_jumps(**angles)
    for (name, angle), axes in zip(angles.items(), panels, strict=False):
        degrees = np.degrees(angle)
        gaps = () if name == "theta" else jumps
        draw_line(axes, np.insert(t, gaps, np.nan), np.insert(degrees, gaps, np.nan))
        set_degree_ticks(axes.yaxis, degrees)
        axes.set_ylabel(axis_of(name, "deg"))
        if name == "theta":
            ends = inclination_extremes(table)
            turned = [end._replace(value=np.degrees(end.value)) for end in ends]
            mark_extremes(axes, turned, "°", 2)
    draw_line(panels[3], t, numbers(table, "com_z"))
    panels[3].set_ylabel("height above the pivot (m)")
    mark_extremes(panels[3], height_extremes(table), " m", 5)
    figure.align_ylabels()
    return figure


def decimals_for(span: float, least: int) -> int:
    """How many decimals tell numbers over a span apart, with two digits of it."""
    return max(least, 1 - math.floor(math.log10(span))) if span > 0 else least


def mark_extremes(axes: Axes, ends: Sequence[Extreme], unit: str, decimals: int) -> None:
    """Faint lines at the minimum and the maximum, with their numbers."""
    low, high = (end.value for end in ends)
    room = 0.16 * (high - low or 1)
    decimals = decimals_for(high - low, decimals)
    axes.set_ylim(low - room, high + room)
    outline = [withStroke(linewidth=2.5, foreground="white")]
    sides = (("least", "top", -2), ("largest", "bottom", 2))
    for end, (which, side, shift) in zip(ends, sides, strict=True):
        axes.axhline(end.value, color=FAINT, linewidth=0.8, zorder=0)
        if decimals > MOST_DECIMALS:
            continue
        axes.annotate(
            f"{end.note(which)}{write_fixed(end.value, decimals)}{unit}",
            (0.99, end.value),
            xycoords=axes.get_yaxis_transform(),
            xytext=(0, shift),
            textcoords="offset points",
            ha="right",
            va=side,
            fontsize=9,
            path_effects=outline,
            color=GREY,
        )


def draw_force(axes: Axes, t: np.ndarray, force: np.ndarray) -> None:
    """A force against time; one that turns very often has a thin line, or it would be an area."""
    is_dense = np.count_nonzero(np.diff(np.sign(np.diff(force)))) > DENSE
    draw_line(axes, t, force, **({"linewidth": 0.4} if is_dense else {}))


def draw_forces(table: Table) -> Figure:
    """Support force and energies against time (Figure 9)."""
    figure, panels = four_panels(table, "Support force on the top, and energy of the top")
    t = numbers(table, "t")
    for name, axes in zip(("x", "y", "z"), panels, strict=False):
        axes.axhline(0, color=FAINT, linewidth=0.8)
        draw_force(axes, t, numbers(table, f"force_{name}"))
        axes.set_ylabel(f"$F_{name}$ (N)" + (", upward" if name == "z" else ""))
    limits = [axes.get_ylim() for axes in panels[:2]]  # both are horizontal
    for axes in panels[:2]:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    if "theta" in table.rows and not broken(LAGRANGE, table):
        mark_sign_changes(panels[2], t, numbers(table, "force_z"), numbers(table, "theta"))
    for line, name in enumerate(("energy", "kinetic", "potential")):
        label = "total" if name == "energy" else name
        draw_line(panels[3], t, numbers(table, name), line, label=label)
    panels[3].set_ylabel("energy (J)")
    panels[3].legend(
        loc="lower right",
        bbox_to_anchor=(1.03, 1.0),
        ncols=3,
        handlelength=1.6,
        columnspacing=1.0,
        borderpad=0,
    )
    figure.align_ylabels()
    return figure


def mark_sign_changes(axes: Axes, t: np.ndarray, y: np.ndarray, theta: np.ndarray) -> None:
    """Dots where a quantity changes its sign, and the inclinations at which it does.

    It is a function of the inclination. If it changes its sign at more than a few of them, or
    nearly from row to row, it is zero but for rounding, and no sign means anything.
    """
    before = np.flatnonzero(y[:-1] * y[1:] < 0)
    share = y[before] / (y[before] - y[before + 1])
    times, inclinations = (
        values[before] + share * np.diff(values)[before] for values in (t, np.degrees(theta))
    )
    ordered = np.sort(inclinations)
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) >= SAME) + 1)
    is_chain = any(np.ptp(group) >= SAME for group in groups if group.size)
    if not times.size or len(groups) > MOST_INCLINATIONS or is_chain:
        return
    if times.size > MOST_OFTEN * y.size:
        return
    axes.plot(times, np.zeros_like(times), "o", color=LINES[1]["color"], markersize=2.8)
    words = " and ".join(f"{first_in(group, inclinations):.1f}°" for group in groups)
    title = rf"zero at $\theta$ = {words}"
    axes.set_title(title, loc="right", fontsize=9, pad=3, color=LINES[1]["color"])


def first_in(group: np.ndarray, values: np.ndarray) -> float:
    """The first of some values that is between the ends of a group."""
    return float(values[(values >= group.min()) & (values <= group.max())][0])


def draw_support(table: Table) -> Figure:
    """Support force in the plane of the axis, normal to it and upward, and its size."""
    figure, panels = four_panels(table, "Support force: outward, along the nodes and upward")
    t = numbers(table, "t")
    force = {name: numbers(table, f"force_{name}") for name in "rnz"}
    labels = {
        "r": "$F_r$ (N), outward",
        "n": "$F_n$ (N), along the nodes",
        "z": "$F_z$ (N), upward",
    }
    for (name, label), axes in zip(labels.items(), panels, strict=False):
        axes.axhline(0, color=FAINT, linewidth=0.8)
        draw_force(axes, t, force[name])
        axes.set_ylabel(label)
    draw_line(panels[3], t, np.sqrt(sum(part**2 for part in force.values())))
    panels[3].set_ylabel("magnitude of the force (N)")
    panels[3].set_ylim(bottom=0)
    figure.align_ylabels()
    return figure
