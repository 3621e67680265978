"""The body of a trajectory, and the solid that the page draws for it."""

import re
from dataclasses import dataclass

import numpy as np

from figures.table import Table

BODY = re.compile(r"mass (\S+) kg; inertia (.+?) kg m\^2 about the pivot; centre of mass (.+?) m")
ALIKE = 1e-6
"""Moments of inertia that differ by less than this part of the largest are equal."""

NUMBERS = 6
"""Of inertia and centre of mass together."""

LARGEST = 1e100
"""Numbers beyond are those of no body that can be drawn."""

THINNEST = 0.04
"""No solid is drawn thinner than this part of its largest extent."""


@dataclass(frozen=True)
class Body:
    """Mass (kg), principal inertia about the pivot (kg m^2), centre of mass (m), in body axes."""

    mass: float
    inertia: np.ndarray
    centre: np.ndarray

    def axis(self) -> np.ndarray:
        """Unit vector from the pivot to the centre of mass; body z where they coincide."""
        length = np.linalg.norm(self.centre)
        return self.centre / length if length > 0 else np.array([0.0, 0.0, 1.0])


def read_body(table: Table) -> Body | None:
    """The body in the header of a table; None if it cannot be drawn."""
    match = BODY.fullmatch(table.header.get("body", ""))
    if not match:
        return None
    try:
        mass, *others = [float(x) for group in match.groups() for x in group.split(",")]
    except ValueError:
        return None
    sizes = np.abs([mass, *others])
    if len(others) != NUMBERS or not (sizes < LARGEST).all():
        return None
    return Body(mass, np.array(others[:3]), np.array(others[3:]))


def central_inertia(body: Body) -> np.ndarray:
    """The tensor of inertia about the centre of mass, kg m^2 (Steiner's theorem).

    Where no body has such moments, as in Example 2 of the paper, the given ones are taken as those.
    """
    given = np.diag(body.inertia)
    r = body.centre
    central = given - body.mass * (r @ r * np.eye(3) - np.outer(r, r))
    return central if np.linalg.eigvalsh(central)[0] > 0 else given


def equivalent_solid(body: Body) -> dict[str, object]:
    """The homogeneous solid of the same mass and moments of inertia, about the centre of mass.

    A cylinder, or a cuboid where no two moments are equal: its kind, extents (m) and axes (columns
    in body axes; a cylinder's own axis is the last).
    """
    moments, axes = np.linalg.eigh(central_inertia(body))
    if body.mass <= 0 or moments[2] <= 0:
        return {"kind": "none"}
    close = ALIKE * moments[2]
    if moments[2] - moments[1] < close:  # the odd one comes last
        moments, axes = moments[[1, 2, 0]], axes[:, [1, 2, 0]]
    if np.linalg.det(axes) < 0:
        axes = axes * [1, 1, -1]
    shape = {"axes": [round(x, 15) for x in axes.T.ravel().tolist()]}
    if abs(moments[1] - moments[0]) < close:
        radius = np.sqrt(2 * moments[2] / body.mass)
        height = np.sqrt(max(0.0, 12 * moments[0] / body.mass - 3 * radius**2))
        height = max(height, 2 * THINNEST * radius)
        return {"kind": "cylinder", "radius": radius, "height": height} | shape
    squares = 6 * (moments.sum() - 2 * moments) / body.mass
    edges = np.sqrt(np.maximum(squares, 0))
    return {"kind": "cuboid", "edges": np.maximum(edges, THINNEST * edges.max()).tolist()} | shape
