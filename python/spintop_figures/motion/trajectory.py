"""What a motion reaches between the rows of its table, and whether the rows show its path."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.motion.reduced import COLUMNS, find_reduced
from spintop_figures.moving.assumptions import LAGRANGE, broken
from spintop_figures.style.axes import draw_line, draw_sizes, name_axis, set_degree_ticks
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, HIDDEN, LINES, OURS, by_width
from spintop_figures.style.numbers import decimals_for, write_fixed
from spintop_figures.style.page import Page, legend_above, time_panels
from spintop_figures.tables.names import axis_of, columns_of, name_of, units_of_columns
from spintop_figures.tables.table import Table


class Extreme(NamedTuple):
    """The minimum or the maximum of a quantity, of the motion or only of the rows."""

    value: float
    of_rows: bool


def extremes_of_rows(values: np.ndarray) -> tuple[Extreme, Extreme]:
    """The extremes of a column."""
    return Extreme(float(np.nanmin(values)), True), Extreme(float(np.nanmax(values)), True)


def inclination_extremes(table: Table) -> tuple[Extreme, Extreme]:
    """The minimum and the maximum inclination, rad: turning points that lie between the rows.

    A turning point belongs to the run if the nutation rate changes its sign as it does there. The
    others, and those of any body that is not a symmetric top, are extremes of the rows.
    """
    least, largest = extremes_of_rows(table.rows["theta"].to_numpy(float))
    needs = COLUMNS.split()
    if largest.value - least.value < 1e-9:  # a steady precession
        return least._replace(of_rows=False), largest._replace(of_rows=False)
    if table.missing(needs) or table.empty(needs) or broken(LAGRANGE, table):
        return least, largest
    reduced = find_reduced(table)
    kinetic, potential = (table.column(name) for name in ("kinetic", "potential"))
    size = 1e-7 * (np.abs(kinetic).max() + np.abs(potential).max())
    if isinstance(reduced, str) or np.ptp(kinetic + potential) > size:
        return least, largest  # the turning points of the start are not those of the run
    low, high = reduced.turning_points()
    turns = np.diff(np.sign(table.column("theta_rate")))
    if (turns > 0).any():
        least = Extreme(min(low, least.value), False)
    if (turns < 0).any():
        largest = Extreme(max(high, largest.value), False)
    return least, largest


def height_extremes(table: Table) -> tuple[Extreme, Extreme]:
    """The minimum and the maximum height of the centre of mass, in metres.

    Where it is on the axis of the body, that of a symmetric top, they follow from the inclination.
    """
    height, theta = (table.rows[name].to_numpy(float) for name in ("com_z", "theta"))
    low, high = extremes_of_rows(height)
    cosine = np.cos(theta)
    length = float(height @ cosine / (cosine @ cosine))
    if not np.allclose(height, length * cosine, rtol=0, atol=1e-9 * abs(length)):
        return low, high
    ends = [Extreme(length * np.cos(end.value), end.of_rows) for end in inclination_extremes(table)]
    return min(ends), max(ends)


def sparseness(*path: np.ndarray) -> str:
    """Why the points of a path are not joined; empty if they are."""
    points = np.array(path)
    points = points[:, np.isfinite(points).all(axis=0)]
    unit = points / np.maximum(np.linalg.norm(points, axis=0), 1e-300)
    chords = np.linalg.norm(np.diff(unit, axis=1), axis=0)
    arc = 2 * np.arcsin(min(chords.max(initial=0.0) / 2, 1.0))
    if arc <= np.radians(15):  # else a line would be a guess
        return ""
    return f"points only: rows are up to {write_fixed(np.degrees(arc), 0)}° apart"


def panels(table: Table, title: str, **columns: str) -> tuple[Page, list[Axes]]:
    """A figure with four panels over the same time, and columns in the first, as axes name them."""
    figure, axes = time_panels(table, title, 4, by_width(5.4, 8.6))
    near_pole = {"phi", "psi"} & columns.keys()
    jumps = pole_jumps(*map(table.column, ("phi", "theta", "psi"))) if near_pole else ()
    for (name, words), each in zip(columns.items(), axes, strict=False):
        draw_column(each, table, name, words, gaps=jumps if name in near_pole else ())
    return figure, axes


def draw_column(
    axes: Axes, table: Table, name: str, words: str = "", gaps: Sequence[int] = (), **style: object
) -> None:
    """A column against time, as its axis names it; before some rows there may be gaps.

    A force that turns very often has a thin line, or it would be an area.
    """
    t, (values, unit) = table.column("t"), table.shown(name, units_of_columns().get(name, ""))
    if name.startswith(("force", "R", "omega")):
        axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)
    turns = np.count_nonzero(np.diff(np.sign(np.diff(values))))
    if turns > 150 and name.startswith("force"):
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
    near = np.minimum(off_pole[1:], off_pole[:-1]) < np.radians(15)  # near a pole
    # the body turns by no more than a part of it
    return np.flatnonzero(near & (turned > np.radians(45)) & (on < 0.5 * turned)) + 1


@figure("trajectory", "t phi theta psi com_z")
def draw_angles(table: Table) -> Figure:
    """Angles and height of the centre of mass against time (Figure 8)."""
    columns = {"phi": "", "theta": "", "psi": "", "com_z": "height above the pivot"}
    title = "Euler angles and height of the centre of mass"
    figure, (_, theta, _, height) = panels(table, title, **columns)
    ends = [end._replace(value=np.degrees(end.value)) for end in inclination_extremes(table)]
    mark_extremes(theta, ends, "°", 2)
    mark_extremes(height, height_extremes(table), " m", 5)
    return figure


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
        if decimals <= 8:  # else they differ in further decimals only
            words = f"{which} row: " if end.of_rows else ""  # the motion may go further
            words += f"{write_fixed(end.value, decimals)}{unit}"
            axes.annotate(words, (0.99, end.value), (0, shift), va=side, **style)


@figure("trajectory", "t force_x force_y force_z energy kinetic potential")
def draw_forces(table: Table) -> Figure:
    """Support force and energies against time (Figure 9)."""
    columns = {"force_x": "$F_x$", "force_y": "$F_y$", "force_z": "upward force $F_z$"}
    title = "Support force on the top, and energy of the top"
    figure, (x, y, z, energy) = panels(table, title, **columns)
    share_limits(x, y)  # both are horizontal
    if "theta" in table.rows and not broken(LAGRANGE, table):
        mark_sign_changes(z, *map(table.column, ("t", "force_z", "theta")))
    for line, name in enumerate(("energy", "kinetic", "potential")):
        label = "total" if name == "energy" else name
        draw_line(energy, table.column("t"), table.column(name), line, label=label)
    name_axis(energy.yaxis, "energy", "J")
    place = {"bbox_to_anchor": (1.03, 1.0), "ncols": 3, "borderpad": 0}
    legend_above(energy, 3, **place, handlelength=1.6, columnspacing=1.0)
    return figure


def share_limits(*panels: Axes) -> None:
    """Give panels the same range of the y axis."""
    limits = [axes.get_ylim() for axes in panels]
    for axes in panels:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


def mark_sign_changes(axes: Axes, t: np.ndarray, y: np.ndarray, theta: np.ndarray) -> None:
    """Dots where a quantity changes its sign, and the inclinations at which it does.

    It is a function of the inclination. If it changes its sign at more than three of them, which
    differ by a degree, or nearly from row to row, it is zero but for rounding, and no sign means
    anything.
    """
    before = np.flatnonzero(y[:-1] * y[1:] < 0)
    share = y[before] / (y[before] - y[before + 1])
    times, inclinations = (
        values[before] + share * np.diff(values)[before] for values in (t, np.degrees(theta))
    )
    ordered = np.sort(inclinations)
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) >= 1) + 1)
    is_chain = any(np.ptp(group) >= 1 for group in groups if group.size)
    is_rounding = times.size > 0.25 * y.size or is_chain
    if not times.size or len(groups) > 3 or is_rounding:
        return
    axes.plot(times, np.zeros_like(times), "o", color=LINES[1]["color"], markersize=2.8)
    firsts = (next(i for i in inclinations if g.min() <= i <= g.max()) for g in groups)
    words = " and ".join(f"{write_fixed(first, 1)}°" for first in firsts)
    style = {"loc": "right", "fontsize": "small", "pad": 3, "color": LINES[1]["color"]}
    axes.set_title(rf"zero at $\theta$ = {words}", **style)


@figure("trajectory", "t force_r force_n force_z")
def draw_support(table: Table) -> Figure:
    """Support force in the plane of the axis and normal to it, against time."""
    columns = {"force_r": "", "force_n": "", "force_z": "upward force $F_z$"}
    title = "Support force: outward, along the nodes and upward"
    figure, (*_, size) = panels(table, title, **columns)
    draw_line(size, table.column("t"), np.sqrt(sum(table.column(name) ** 2 for name in columns)))
    size.set_ylim(bottom=0)
    name_axis(size.yaxis, "magnitude of the force", "N")
    return figure


AREAS = (f"{OURS}area1", LINES[2]["color"], LINES[3]["color"], FAULT, f"{OURS}area5")
"""Of the works, from the largest."""


@figure(
    "trajectory",
    "t theta omega3 energy energy_error work",
    unless={"has no energy error that is not zero": lambda table: table.rows["energy_error"].any()},
)
def draw_account(table: Table) -> Figure:
    """Inclination, spin, and account of energy under effects, against time."""
    title, grid = "Inclination, spin and energy budget", {"across": 1, "ratios": (1, 1, 1.4, 1)}
    figure, (theta, spin, energy, error) = time_panels(table, title, 4, 7.4, **grid)
    t, rows = table.column("t"), table.rows
    names = [name for name in columns_of("trajectory") if name.startswith("work_")]
    acting = [name for name in names if name in rows and rows[name].any()]
    acting.sort(key=lambda name: -np.abs(rows[name]).max())  # the largest first
    works = {name_of(name).removeprefix("work of "): table.column(name) for name in acting}
    works = works or {"effects": table.column("work")}
    draw_column(theta, table, "theta", axis_of("theta", between="\n"))
    draw_column(spin, table, "omega3", axis_of("omega3", between="\n"))
    draw_works(energy, table, t, works)
    draw_sizes(error, t[1:], table.column("energy_error")[1:])  # it is zero at the start
    name_axis(error.yaxis, "error of the\nbalance (relative)")
    return figure


def draw_works(axes: Axes, table: Table, t: np.ndarray, works: dict[str, np.ndarray]) -> None:
    """The energy, and the works of the effects: areas if all take energy, else lines.

    The areas are the kinetic energy, on the potential one, and on them what each effect has taken:
    the upper edge is the energy of the start.
    """
    energy = table.column("energy")
    ground = table.column("potential") if "potential" in table.rows else np.zeros_like(energy)
    largest = max(np.nanmax(np.abs(work)) for work in works.values())
    is_spent = all(np.nanmax(work) <= 1e-9 * largest for work in works.values())
    if is_spent:
        axes.fill_between(t, ground, energy, color=HIDDEN, linewidth=0, label="kinetic energy")
    else:
        axes.axhline(0, color=FAINT, linewidth=0.8)
    top = energy
    for number, (name, work) in enumerate(works.items()):
        colour = AREAS[number % len(AREAS)]
        if is_spent:
            style = {"color": colour, "linewidth": 0, "label": f"taken by {name}"}
            axes.fill_between(t, top, top - work, **style)
            top = top - work
        else:
            draw_line(axes, t, work, 2 + number % 2, color=colour, label=f"work of {name}")
    draw_line(axes, t, energy, label="energy")
    if "potential" in table.rows:
        draw_line(axes, t, ground, 1, label="potential energy")
    name_axis(axes.yaxis, "energy" if is_spent else "energy, work", "J")
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1.0), "borderpad": 0.1}
    place |= {"handlelength": 1.4, "columnspacing": 0.7, "handletextpad": 0.5}
    axes.legend(**place, ncols=by_width(5, 2))
