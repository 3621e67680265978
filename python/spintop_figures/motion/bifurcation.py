"""The bifurcation set of a symmetric top: which momenta and energies are those of which motion."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from spintop_figures.motion.potential import draw_legend
from spintop_figures.motion.reduced import Reduced, find_reduced
from spintop_figures.style.axes import STEPS
from spintop_figures.style.look import FAINT, LINES, by_width
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

WEAK = 1e-9
"""A smaller momentum about the axis, over that about the vertical, has no such diagram."""

LEAST_SLEEPING = 2.0
"""The value of L3^2/(2 I1 m g l) from which the sleeping top is stable."""

FAR = 6
"""The inclinations of the curve come as close to the horizontal and to the poles as 10^-FAR."""

ROOM = 0.12
"""Room beside the motion and the poles, over the width."""

LEAST_HEIGHT, WIDEST, NARROWEST = 0.12, 5.0, 1.6
"""A region is named if it is as high, over the figure, and if the figure reaches from minus this to
this ratio at most (between the poles) or at least (beside them)."""

FURTHER = 3
"""The curve is drawn this many times as far as the edge of the figure, which cuts it off."""

FORBIDDEN = "#e4e4e4"


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

        For each inclination there are two: a slow one and a fast one, with
        x - u = (1 - u^2)(1 -+ r)/(2 u) and r^2 = 1 - 2 w u/p.
        """
        # With w u in place of u and w x in place of x the weight pulls down.
        last = min(1.0, self.strength / 2)
        near = np.logspace(-FAR, 0, 500) / 2
        part = np.concatenate([near, 1 - near[-2::-1]])
        below, whole, above = -part, (1 + last) * part - 1, last * part
        parts = [self._precession(u, fast) for u, fast in ((below, 1), (whole, -1), (above, 1))]
        ratio, energy = (np.concatenate(values) for values in zip(*parts, strict=True))
        order = np.argsort(ratio)
        return self.sign * ratio[order], energy[order]

    def _precession(self, u: np.ndarray, fast: int) -> tuple[np.ndarray, np.ndarray]:
        """Ratio and energy, less that of the cusps, of the slow (-1) or the fast precession (1)."""
        p = self.strength
        square = (1 - u) * (1 + u)
        root = np.sqrt(np.maximum(0, 1 - 2 * u / p))
        if fast < 0:
            return u + square / (p * (1 + root)), -square * root / (p * (1 + root) ** 2)
        away = square * (1 + root) / (2 * u)
        return u + away, away * (p * (1 + root) / (2 * u) - 1)

    def sleeps(self) -> bool:
        """Whether the sleeping top is stable with this momentum about the axis."""
        return self.strength >= LEAST_SLEEPING


def draw_bifurcation(table: Table) -> Figure:
    """The curve of the steady precessions, the cusps, both rests, and the motion as a point."""
    constants = Constants(find_reduced(table))
    figure = new_figure(table, "Bifurcation diagram of the symmetric top", 4.4)
    axes = figure.subplots()
    edge = (1 + ROOM) * max(1, abs(constants.ratio))
    ratio, energy = constants.steady()
    near = abs(ratio) <= FURTHER * edge
    depth = -energy[abs(ratio) <= edge].min()
    high = max(1.5 * depth, 1.25 * constants.excess)
    low = -max(1.5 * depth, 0.2 * high)
    axes.fill_between(ratio[near], energy[near], low, color=FORBIDDEN, linewidth=0, zorder=0)
    axes.plot(ratio[near], energy[near], **LINES[0], label="steady precession")
    axes.plot((-1, 1), (0, 0), **LINES[1], label="cusps")
    for pole in (-1, 1):
        axes.axvline(pole, color=FAINT, linewidth=0.8, zorder=0)
    draw_rests(axes, constants)
    axes.plot(
        constants.ratio,
        constants.excess,
        "D",
        color=LINES[3]["color"],
        zorder=6,
        clip_on=False,
        label="the motion",
    )
    name_regions(axes, (ratio, energy), (low, high), edge)
    axes.set(xlim=(-edge, edge), ylim=(low, high))
    axes.set(xlabel="ratio of the momenta, $L_z/L_3$", ylabel=label_of(constants))
    axes.xaxis.set_major_locator(MaxNLocator(by_width(8, 5), steps=STEPS))
    draw_legend(axes, 3)
    return figure


def name_regions(
    axes: Axes, curve: tuple[np.ndarray, np.ndarray], seen: tuple[float, float], edge: float
) -> None:
    """Loops above the cusps, waves elsewhere above the curve, each where it has room."""
    order = np.argsort(curve[0])
    ratio, energy = (values[order] for values in curve)
    low, high = seen
    room = LEAST_HEIGHT * (high - low)
    beside = (1 + edge) / 2
    places = (
        ("loops", 0, 0, high),
        ("waves", 0, float(np.interp(0, ratio, energy)), 0),
        ("waves", beside, float(np.interp(beside, ratio, energy)), high),
        ("waves", -beside, float(np.interp(-beside, ratio, energy)), high),
    )
    for name, place, bottom, top in places:
        has_width = edge < WIDEST if place == 0 else edge > NARROWEST
        if has_width and top - bottom > room:
            axes.text(place, (bottom + top) / 2, name, ha="center", va="center")
    bottom = min(0.0, float(np.interp(0, ratio, energy)))
    axes.text(0, (low + bottom) / 2, "no motion", ha="center", va="center")


def label_of(constants: Constants) -> str:
    """The energy less that of the cusps, as a formula."""
    sign = "-" if constants.sign > 0 else "+"
    return rf"energy, $(E-L_3^2/2I_3)/|mgl|{sign}L_z/L_3$"


def draw_rests(axes: Axes, constants: Constants) -> None:
    """The top at rest but for its spin: upright, where it may be unstable, and hanging."""
    upright, look = constants.sign, {"color": "black", "zorder": 5, "clip_on": False}
    if constants.sleeps():
        axes.plot(upright, 0, "o", **look, label="sleeping top")
    else:
        axes.plot(upright, 0, "o", **look, mfc="white", label="upright top, unstable")
    axes.plot(-upright, 0, "s", **look, label="hanging top")


def object_to_bifurcation(table: Table) -> str:
    """The momenta are in units of that about the axis, the energies in those of the weight."""
    reduced = find_reduced(table)
    if isinstance(reduced, str):
        return reduced
    spins = abs(reduced.l3) > WEAK * abs(reduced.lz)
    return "" if spins else "is of a top without a momentum about its axis"
