"""What a motion reaches between the rows of its table, and whether the rows show its path."""

from typing import NamedTuple

import numpy as np

from spintop_figures.motion.reduced import COLUMNS, find_reduced
from spintop_figures.moving.assumptions import LAGRANGE, broken
from spintop_figures.style.numbers import write_fixed
from spintop_figures.tables.table import Table

NEEDS = COLUMNS.split()

MOST_ARC = np.radians(15)
"""Rows of which the axes are further apart are not joined: the line would be a guess."""

STEADY = 1e-9
"""A smaller range of the inclination in radians is that of a steady precession."""

SAME_ENERGY = 1e-7
"""The change of energy, over its size, up to which a run has the turning points of its start."""


class Extreme(NamedTuple):
    """The minimum or the maximum of a quantity, of the motion or only of the rows."""

    value: float
    of_rows: bool

    def note(self, side: str) -> str:
        """What a label of the "least" or "largest" says first if the motion may go further."""
        return f"{side} row: " if self.of_rows else ""


def extremes_of_rows(values: np.ndarray) -> tuple[Extreme, Extreme]:
    """The extremes of a column."""
    return Extreme(float(np.nanmin(values)), True), Extreme(float(np.nanmax(values)), True)


def inclination_extremes(table: Table) -> tuple[Extreme, Extreme]:
    """The minimum and the maximum inclination, rad: turning points that lie between the rows.

    A turning point belongs to the run if the nutation rate changes its sign as it does there. The
    others, and those of any body that is not a symmetric top, are extremes of the rows.
    """
    least, largest = extremes_of_rows(table.rows["theta"].to_numpy(float))
    if largest.value - least.value < STEADY:
        return least._replace(of_rows=False), largest._replace(of_rows=False)
    if table.missing(NEEDS) or table.empty(NEEDS) or broken(LAGRANGE, table):
        return least, largest
    reduced = find_reduced(table)
    if isinstance(reduced, str) or not keeps_energy(table):
        return least, largest
    low, high = reduced.turning_points()
    signs = np.sign(table.rows["theta_rate"].to_numpy(float))
    before, after = signs[:-1], signs[1:]
    if ((before <= 0) & (after > 0)).any() or ((before < 0) & (after >= 0)).any():
        least = Extreme(min(low, least.value), False)
    if ((before >= 0) & (after < 0)).any() or ((before > 0) & (after <= 0)).any():
        largest = Extreme(max(high, largest.value), False)
    return least, largest


def keeps_energy(table: Table) -> bool:
    """Whether a run keeps its energy, so that the turning points of the start are its own."""
    energy = (table.rows["kinetic"] + table.rows["potential"]).to_numpy(float)
    size = np.abs(table.rows["kinetic"]).max() + np.abs(table.rows["potential"]).max()
    return bool(np.ptp(energy) <= SAME_ENERGY * size)


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


def largest_arc(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> float:
    """The largest angle between the directions of successive points, rad."""
    points = np.array([x, y, z])
    points = points[:, np.isfinite(points).all(axis=0)]
    if points.shape[1] < 2:
        return 0.0
    unit = points / np.maximum(np.linalg.norm(points, axis=0), 1e-300)
    chords = np.linalg.norm(np.diff(unit, axis=1), axis=0)
    return float(2 * np.arcsin(min(chords.max() / 2, 1.0)))


def sparseness(*path: np.ndarray) -> str:
    """Why the points of a path are not joined; empty if they are."""
    arc = largest_arc(*path)
    if arc <= MOST_ARC:
        return ""
    return f"points only: rows are up to {write_fixed(np.degrees(arc), 0)}° apart"
