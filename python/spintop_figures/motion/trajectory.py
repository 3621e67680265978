"""The figures of a trajectory that show quantities of the motion against time."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.motion.extremes import Extreme, height_extremes, inclination_extremes
from spintop_figures.moving.assumptions import LAGRANGE, broken
from spintop_figures.style.axes import name_axis
from spintop_figures.style.lines import draw_line, set_degree_ticks
from spintop_figures.style.look import FAINT, GREY, GROUND, LINES, by_width
from spintop_figures.style.numbers import write_fixed
from spintop_figures.style.page import Page, legend_above, time_panels
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

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


def panels(table: Table, title: str) -> tuple[Page, list[Axes]]:
    """A figure with four panels over the same time."""
    return time_panels(table, title, 4, by_width(5.4, 8.6))


def draw_column(
    axes: Axes, table: Table, name: str, words: str = "", gaps: Sequence[int] = (), **style: object
) -> None:
    """A column against time, as its axis names it; before some rows there may be gaps.

    A force that turns very often has a thin line, or it would be an area.
    """
    t, (values, unit) = table.column("t"), table.shown(name)
    if name.startswith(("force", "R", "omega")):
        axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)
    turns = np.count_nonzero(np.diff(np.sign(np.diff(values))))
    if turns > DENSE and name.startswith("force"):
        style = {"linewidth": 0.4} | style
    draw_line(axes, np.insert(t, gaps, np.nan), np.insert(values, gaps, np.nan), **style)
    if unit == "degrees":
        set_degree_ticks(axes.yaxis, values)
    name_axis(axes.yaxis, words or axis_of(name), unit)


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


@figure(
    "angles",
    "angles and height of the centre of mass against time (Figure 8)",
    kind="trajectory",
    needs="t phi theta psi com_z",
)
def draw_angles(table: Table) -> Figure:
    """Euler angles and height of the centre of mass against time (Figure 8)."""
    figure, (phi, theta, psi, height) = panels(
        table, "Euler angles and height of the centre of mass"
    )
    jumps = pole_jumps(*map(table.column, ("phi", "theta", "psi")))
    draw_column(phi, table, "phi", gaps=jumps)
    draw_column(theta, table, "theta")
    draw_column(psi, table, "psi", gaps=jumps)
    draw_column(height, table, "com_z", "height above the pivot")
    ends = [end._replace(value=np.degrees(end.value)) for end in inclination_extremes(table)]
    mark_extremes(theta, ends, "°", 2)
    mark_extremes(height, height_extremes(table), " m", 5)
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
    style = {"xycoords": axes.get_yaxis_transform(), "textcoords": "offset points", "ha": "right"}
    style |= {"fontsize": "small", "color": GREY}
    style["path_effects"] = [withStroke(linewidth=2.5, foreground=GROUND)]
    sides = (("least", "top", -2), ("largest", "bottom", 2))
    for end, (which, side, shift) in zip(ends, sides, strict=True):
        axes.axhline(end.value, color=FAINT, linewidth=0.8, zorder=0)
        if decimals <= MOST_DECIMALS:
            words = f"{end.note(which)}{write_fixed(end.value, decimals)}{unit}"
            axes.annotate(words, (0.99, end.value), (0, shift), va=side, **style)


@figure(
    "forces",
    "support force and energies against time (Figure 9)",
    kind="trajectory",
    needs="t force_x force_y force_z energy kinetic potential",
)
def draw_forces(table: Table) -> Figure:
    """Support force and energies against time (Figure 9)."""
    figure, (x, y, z, energy) = panels(table, "Support force on the top, and energy of the top")
    for axes, name, words in ((x, "x", ""), (y, "y", ""), (z, "z", "upward force ")):
        draw_column(axes, table, f"force_{name}", f"{words}$F_{name}$")
    share_limits(x, y)  # both are horizontal
    if "theta" in table.rows and not broken(LAGRANGE, table):
        mark_sign_changes(z, *map(table.column, ("t", "force_z", "theta")))
    for line, name in enumerate(("energy", "kinetic", "potential")):
        label = "total" if name == "energy" else name
        draw_line(energy, table.column("t"), table.column(name), line, label=label)
    name_axis(energy.yaxis, "energy", "J")
    place = {"bbox_to_anchor": (1.03, 1.0), "ncols": 3, "borderpad": 0}
    legend_above(energy, 3, **place, handlelength=1.6, columnspacing=1.0)
    figure.align_ylabels()
    return figure


def share_limits(*panels: Axes) -> None:
    """Give panels the same range of the y axis."""
    limits = [axes.get_ylim() for axes in panels]
    for axes in panels:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


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
    is_rounding = times.size > MOST_OFTEN * y.size or is_chain
    if not times.size or len(groups) > MOST_INCLINATIONS or is_rounding:
        return
    axes.plot(times, np.zeros_like(times), "o", color=LINES[1]["color"], markersize=2.8)
    firsts = (next(i for i in inclinations if g.min() <= i <= g.max()) for g in groups)
    words = " and ".join(f"{write_fixed(first, 1)}°" for first in firsts)
    style = {"loc": "right", "fontsize": "small", "pad": 3, "color": LINES[1]["color"]}
    axes.set_title(rf"zero at $\theta$ = {words}", **style)


@figure(
    "support",
    "support force in the plane of the axis and normal to it, against time",
    kind="trajectory",
    needs="t force_r force_n force_z",
)
def draw_support(table: Table) -> Figure:
    """Support force in the plane of the axis, normal to it and upward, and its size."""
    figure, axes = panels(table, "Support force: outward, along the nodes and upward")
    draw_column(axes[0], table, "force_r", "outward force $F_r$")
    draw_column(axes[1], table, "force_n", "force along the nodes $F_n$")
    draw_column(axes[2], table, "force_z", "upward force $F_z$")
    parts = [table.column(f"force_{name}") for name in "rnz"]
    draw_line(axes[3], table.column("t"), np.sqrt(sum(part**2 for part in parts)))
    axes[3].set_ylim(bottom=0)
    name_axis(axes[3].yaxis, "magnitude of the force", "N")
    figure.align_ylabels()
    return figure
