"""The motion of a symmetric top as that of its inclination alone, in an effective potential.

Figures: the potential, the phase portrait, and the bifurcation set, which tells the momenta and
energies of which motion.
"""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.moving.assumptions import LAGRANGE
from spintop_figures.moving.body import GRAVITY, read_body
from spintop_figures.style.axes import Places, draw_heads, name_axes, name_axis
from spintop_figures.style.look import FAINT, GREY, GROUND, INK, LINES, OURS, PALE, by_width
from spintop_figures.style.numbers import decimals_for, write_fixed
from spintop_figures.style.page import legend_above, panel_figure
from spintop_figures.tables.names import axis_of
from spintop_figures.tables.table import Table

COLUMNS = "theta theta_rate phi_rate psi_rate kinetic potential"
"""What the reduced motion is found from."""


class Reduced(NamedTuple):
    """I1 theta'^2/2 + V(theta) = energy, with V(theta) = (lz - l3 u)^2/(2 I1 (1 - u^2)) + m g l u.

    u is cos(theta). `energy` is that of the start less the constant part of the spin, l3^2/(2 I3).
    """

    inertia: float
    weight: float
    """m g l, J."""
    lz: float
    l3: float
    energy: float

    def potential(self, theta: np.ndarray) -> np.ndarray:
        """V at inclinations, J; infinite at a pole that the motion cannot reach."""
        half = np.asarray(theta, float) / 2
        below, above = (self.lz - self.l3) / 2, (self.lz + self.l3) / 2
        with np.errstate(divide="ignore", invalid="ignore"):
            # (lz - l3 u)/sin(theta), as two terms of which each is singular at one pole
            turning = below / np.tan(half) + above * np.tan(half)
            turning = np.where((half == 0) & (below == 0), 0.0, turning)
        return turning**2 / (2 * self.inertia) + self.weight * np.cos(2 * half)

    def turning_points(self) -> tuple[float, float]:
        """The least and the largest inclination, rad.

        They are roots of (1 - u^2) (alpha - beta u) - (b - a u)^2 in [-1, 1]; the third root lies
        beyond the pole that the weight pulls away from.
        """
        alpha, beta = 2 * self.energy / self.inertia, 2 * self.weight / self.inertia
        a, b = self.l3 / self.inertia, self.lz / self.inertia
        cubic = [beta, -(alpha + a * a), 2 * a * b - beta, alpha - b * b]
        roots = np.sort(np.roots(cubic).real)
        between = roots[1:] if beta < 0 else roots[:2]
        least, largest = np.arccos(np.clip(between, -1, 1))[::-1]
        return float(least), float(largest)

    def resting_point(self) -> float:
        """The inclination at which V is least: that of the steady precession, rad.

        It lies between the turning points.
        """
        theta = np.linspace(*self.turning_points(), 20_001)
        return float(theta[np.argmin(self.potential(theta))])

    def bottom(self) -> float:
        """The least V, J."""
        return float(self.potential(self.resting_point()))

    def separatrix(self) -> float | None:
        """The energy of the top upright at rest, where it is unstable there; else none.

        Only with equal momenta does a motion reach the upright, the pole that the weight pulls
        away from; below the spin at which the top sleeps, V has its local maximum there.
        """
        upright = np.copysign(1.0, self.weight)
        height = abs(self.weight)
        if self.lz != upright * self.l3 or self.l3**2 >= 4 * height * self.inertia:
            return None
        return height


def find_reduced(table: Table) -> Reduced | str:
    """The reduced motion of a symmetric top, of its body and its start, or why it is not known."""
    body, kinetic = read_body(table), table.column("kinetic")
    if body is None:
        return "does not tell its body"
    if not np.nanmax(kinetic) - np.nanmin(kinetic) > 1e-10 * np.nanmax(kinetic):
        return "is too steady for a picture of its nutation"
    start, (inertia, _, axial) = table.rows.iloc[0], body.inertia
    cosine, turning = np.cos(start["theta"]), start["phi_rate"] * np.sin(start["theta"])
    l3 = axial * (start["phi_rate"] * cosine + start["psi_rate"])
    lz = inertia * turning * np.sin(start["theta"]) + l3 * cosine
    if abs(abs(lz) - abs(l3)) <= 1e-12 * abs(l3):  # equal but for rounding
        lz = np.copysign(l3, lz)
    weight = body.mass * table.number("top.gravity", GRAVITY) * body.centre[2]
    energy = inertia * (start["theta_rate"] ** 2 + turning**2) / 2 + weight * cosine
    return Reduced(*map(float, (inertia, weight, lz, l3, energy)))


def object_to_reduced(table: Table) -> str:
    """Only a symmetric top moves in an effective potential."""
    reduced = find_reduced(table)
    return reduced if isinstance(reduced, str) else ""


INCLINATION = axis_of("theta"), "degrees"
SEPARATRIX = {"color": PALE, "linewidth": 4, "linestyle": "-", "zorder": 1.5}
"""A wide line that a motion may be on."""

SYMMETRIC = {"kind": "trajectory", "needs": COLUMNS, "assumes": LAGRANGE}


def seen(reduced: Reduced) -> tuple[float, float]:
    """The range of inclinations that a figure shows, rad."""
    least, largest = reduced.turning_points()
    room = max(0.35 * (largest - least), 1e-9)  # on either side
    return max(0.0, least - room), min(np.pi, largest + room)


def clustered(low: float, high: float, count: int = 2001) -> np.ndarray:
    """Inclinations that are dense at both ends, where a barrier may rise without end."""
    return low + (high - low) * (1 - np.cos(np.linspace(0, np.pi, count))) / 2


def turns_of(reduced: Reduced) -> list[tuple[float, bool]]:
    """The ends of the inclination, rad, and whether the motion turns there.

    On the separatrix it approaches the upright, and never reaches it.
    """
    separatrix = reduced.separatrix()
    depth = reduced.energy - reduced.bottom()
    never = separatrix is not None and abs(reduced.energy - separatrix) <= 1e-9 * depth
    upright = 0.0 if reduced.weight > 0 else np.pi
    ends = reduced.turning_points()
    least = min(ends, key=lambda end: abs(end - upright))
    return [(upright, False) if never and end == least else (end, True) for end in ends]


@figure(objection=object_to_reduced, **SYMMETRIC)
def draw_potential(table: Table) -> Figure:
    """Effective potential of a symmetric top, with the turning points."""
    reduced = find_reduced(table)
    figure, (axes,) = panel_figure(table, "Effective potential of the inclination", 1, 4.2, above=0)
    low, high = seen(reduced)
    theta, ends = clustered(low, high), turns_of(reduced)
    degrees, turns = np.degrees(theta), np.degrees([end for end, _ in ends])
    bottom, pulled = reduced.bottom(), reduced.weight * np.cos(theta)
    depth = reduced.energy - bottom
    axes.axvspan(*turns, color=f"{OURS}band", linewidth=0, zorder=0, label="allowed")
    axes.axhline(reduced.energy, **LINES[1], label="energy of the motion")
    axes.plot(degrees, reduced.potential(theta), **LINES[0], label="effective potential")
    axes.plot(degrees, pulled, **LINES[2], label=r"weight alone, $mgl\cos\theta$")
    floor = min(bottom, np.min(pulled))
    axes.set_ylim(min(bottom - 0.15 * depth, max(floor, bottom - depth)), bottom + 1.5 * depth)
    axes.set_xlim(*np.degrees((low, high)))
    decimals = decimals_for(turns[1] - turns[0], 2)
    sides = (("left", 8), ("right", -8))
    for (_, turning), turn, (side, shift) in zip(ends, turns, sides, strict=True):
        place = turn, reduced.energy
        face = INK if turning else GROUND
        axes.plot(*place, "o", mec=INK, mfc=face, clip_on=False, zorder=4)
        words = f"{write_fixed(turn, decimals if turning else 0)}°"
        words += "" if turning else ", never reached"
        axes.annotate(words, place, (shift, 6), textcoords="offset points", ha=side)
    axes.plot([], [], "o", color=INK, label="turning point")
    name_axes(axes, INCLINATION, ("energy minus energy of the spin", "J"))
    legend_above(axes, 3)
    return figure


@figure(objection=object_to_reduced, **SYMMETRIC)
def draw_portrait(table: Table) -> Figure:
    """Phase portrait of the inclination of a symmetric top."""
    reduced = find_reduced(table)
    figure, (axes,) = panel_figure(table, "Phase portrait of the inclination", 1, 4.6, above=0)
    low, high = seen(reduced)
    fastest = np.sqrt(2 * (reduced.energy - reduced.bottom()) / reduced.inertia)
    draw_levels(axes, reduced, (low, high), 1.4 * fastest)
    theta, rate = table.column("theta"), table.column("theta_rate")
    steps = np.hypot(np.diff(theta) / (high - low), np.diff(rate) / (2.8 * fastest))
    joined = np.nanmax(steps) < 0.1  # rows that are near each other
    dots = {} if joined else {"linestyle": "", "marker": "o", "markersize": 2.5}
    axes.plot(np.degrees(theta), rate, **LINES[0] | {"linewidth": 1.8} | dots, label="the motion")
    # where it is fastest, to the right where the rate is positive
    places = [max(int(np.nanargmax(sign * rate)), 1) for sign in (1, -1)]
    draw_heads(axes, np.degrees(theta), rate, [i for i in places if theta[i] != theta[i - 1]])
    middle = np.degrees(reduced.resting_point())
    axes.plot(middle, 0, "+", color=INK, markersize=9, label="equilibrium")
    axes.set(xlim=np.degrees((low, high)), ylim=(-1.4 * fastest, 1.4 * fastest))
    name_axes(axes, INCLINATION, (axis_of("theta_rate"), "rad/s"))
    legend_above(axes, 4)
    return figure


def draw_levels(axes: Axes, reduced: Reduced, seen: tuple[float, float], fastest: float) -> None:
    """The level curves of the energy, and the separatrix where there is one."""
    theta = clustered(*seen, 801)
    rate = np.linspace(-fastest, fastest, 401)
    well, bottom = reduced.potential(theta), reduced.bottom()
    energy = np.minimum(well, 1e300) + reduced.inertia * rate[:, np.newaxis] ** 2 / 2
    # amplitudes over that of the motion
    curves = [
        bottom + amplitude**2 * (reduced.energy - bottom)
        for amplitude in (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
    ]
    style = {"colors": GREY, "linewidths": 0.6, "linestyles": "-", "alpha": 0.7}
    axes.contour(np.degrees(theta), rate, energy, levels=curves, **style)
    axes.plot([], [], color=GREY, linewidth=0.6, alpha=0.7, label="equal energy")
    axes.axhline(0, color=FAINT, linewidth=0.8, zorder=0)
    if (separatrix := reduced.separatrix()) is not None:
        squares = 2 * (separatrix - well) / reduced.inertia
        branch = np.sqrt(np.where(squares >= 0, squares, np.nan))
        axes.plot(np.degrees(theta), branch, **SEPARATRIX, label="separatrix, to the upright")
        axes.plot(np.degrees(theta), -branch, **SEPARATRIX)


class Constants:
    """The constants of a motion, in units of m g l and of the momentum about the axis.

    With p = L3^2/(2 I1 m g l), x = Lz/L3 and w the sign of m g l, the energy without that of the
    spin is e = p (x - u)^2/(1 - u^2) + w u where the inclination is at rest. Over x it is drawn
    less w x: the energy of the cusps, where the upper turning point has u = x.
    """

    def __init__(self, reduced: Reduced) -> None:
        self.sign = float(np.sign(reduced.weight))
        weight = abs(reduced.weight)
        self.strength = reduced.l3**2 / (2 * reduced.inertia * weight)
        self.ratio = reduced.lz / reduced.l3
        self.excess = reduced.energy / weight - self.sign * self.ratio

    def steady(self) -> tuple[np.ndarray, np.ndarray]:
        """Ratio and energy, less that of the cusps, of the steady precessions, by the ratio.

        For each inclination there are two: a slow one with s > 0 and a fast one with s < 0, where
        s^2 = 1 - 2 w u/p. Both have x - u = (1 - u^2)/(p (1 + s)) and e - w x = s (u - x)/(1 + s).
        """
        # With w u in place of u and w x in place of x the weight pulls down.
        p = self.strength
        least, most = np.sqrt(max(0.0, 1 - 2 / p)), np.sqrt(1 + 2 / p)
        near = np.logspace(-6, 0, 500) / 2  # so near to the horizontal, s = -1, and to the poles
        part = np.concatenate([near, 1 - near[-2::-1]])
        ends = (-most, -1.0), (-1.0, -least), (least, most)
        s = np.concatenate([low + (high - low) * part for low, high in ends])
        u = p * (1 - s) * (1 + s) / 2
        away = (1 - u) * (1 + u) / (p * (1 + s))
        ratio = self.sign * (u + away)
        order = np.argsort(ratio)
        return ratio[order], (-away * s / (1 + s))[order]


def object_to_bifurcation(table: Table) -> str:
    """The momenta are in units of that about the axis, the energies in those of the weight."""
    reduced = find_reduced(table)
    if isinstance(reduced, str):
        return reduced
    spins = abs(reduced.l3) > 1e-9 * abs(reduced.lz)  # a weaker one has no diagram
    return "" if spins else "is of a top without a momentum about its axis"


@figure(objection=object_to_bifurcation, **SYMMETRIC)
def draw_bifurcation(table: Table) -> Figure:
    """Bifurcation diagram of a symmetric top: its momenta and energy among all motions."""
    constants = Constants(find_reduced(table))
    figure, (axes,) = panel_figure(
        table, "Bifurcation diagram of the symmetric top", 1, 4.4, above=0
    )
    edge = 1.12 * max(1, abs(constants.ratio))
    ratio, energy = constants.steady()
    near = abs(ratio) <= 3 * edge  # the edge cuts it off
    depth = -energy[abs(ratio) <= edge].min()
    high = max(1.5 * depth, 1.25 * constants.excess)
    low = -max(1.5 * depth, 0.2 * high)
    style = {"color": FAINT, "alpha": 0.55, "linewidth": 0, "zorder": 0}
    axes.fill_between(ratio[near], energy[near], low, **style)
    axes.plot(ratio[near], energy[near], **LINES[0], label="steady precession")
    axes.plot((-1, 1), (0, 0), **LINES[1], label="cusps")
    for pole in (-1, 1):
        axes.axvline(pole, color=FAINT, linewidth=0.8, zorder=0)
    upright, look = constants.sign, {"color": INK, "zorder": 5, "clip_on": False}
    sleeps = constants.strength >= 2.0  # L3^2/(2 I1 m g l)
    face, words = (INK, "sleeping top") if sleeps else (GROUND, "upright top, unstable")
    axes.plot(upright, 0, "o", **look, mfc=face, label=words)
    axes.plot(-upright, 0, "s", **look, label="hanging top")
    look |= {"color": LINES[3]["color"], "zorder": 6}
    axes.plot(constants.ratio, constants.excess, "D", **look, label="the motion")
    name_regions(axes, ratio, energy, (low, high), edge)
    axes.set(xlim=(-edge, edge), ylim=(low, high))
    axes.xaxis.set_major_locator(Places(by_width(8, 5)))
    sign = "-" if constants.sign > 0 else "+"
    name_axis(axes.xaxis, "ratio of the momenta, $L_z/L_3$")
    name_axis(axes.yaxis, rf"energy, $(E-L_3^2/2I_3)/|mgl|{sign}L_z/L_3$")
    legend_above(axes, 3)
    return figure


def name_regions(
    axes: Axes, ratio: np.ndarray, energy: np.ndarray, seen: tuple[float, float], edge: float
) -> None:
    """Loops above the cusps, waves elsewhere above the curve, each where it has room."""
    low, high = seen
    beside = (1 + edge) / 2
    middle, right, left = (float(np.interp(at, ratio, energy)) for at in (0, beside, -beside))
    regions = (
        ("loops", 0, 0, high),
        ("waves", 0, middle, 0),
        ("waves", beside, right, high),
        ("waves", -beside, left, high),
    )
    for name, place, bottom, top in regions:
        # of the figure's ratios, between the poles and beside them
        has_width = edge < 5.0 if place == 0 else edge > 1.6
        if has_width and top - bottom > 0.12 * (high - low):
            axes.text(place, (bottom + top) / 2, name, ha="center", va="center")
    axes.text(0, (low + min(0.0, middle)) / 2, "no motion", ha="center", va="center")
