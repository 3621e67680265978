"""The body of a trajectory, and the solids that the page draws for it."""

import re
from dataclasses import dataclass, field

import numpy as np

from spintop_figures.tables.table import Table

BODY = re.compile(
    r"mass (\S+) kg; inertia (.+?) kg m\^2 about the pivot; centre of mass (.+?) m"
    r"(?:; elements 23, 31, 12 of the inertia tensor (.+?) kg m\^2)?"
)
GRAVITY = 9.81
"""Where an input does not say it, m/s^2."""

ALIKE = 1e-6
"""Moments of inertia that differ by less than this part of the largest are equal."""

SLACK = 8 * np.finfo(float).eps
"""Part of the largest moment by which the sum of the others may fall short, as in the program."""

LARGEST = 1e100
"""Numbers beyond are those of no body that can be drawn."""

THINNEST = 0.04
"""No solid is drawn thinner than this part of its largest extent."""

DISC = {"radius": "radius", "height": "thickness"}
SHAPES = {
    "spinning_wheel": ("cylinder", DISC, "a wheel"),
    "ring": ("ring", {"inner": "inner_radius", **DISC}, "a ring"),
    "sphere": ("sphere", {"radius": "radius"}, "a sphere"),
    "cylinder": ("cylinder", DISC, "a cylinder"),
    "cone": ("cone", DISC, "a cone"),
}
"""Of a shape of the program: the kind of its solid, its extents as keys of `top`, and its name."""

NO_SUCH_BODY = (
    "No mass distribution has this inertia about the pivot with its centre of mass there (is the "
    "term m l^2 missing?)."
)
"""What the program says of such an input."""


@dataclass(frozen=True)
class Body:
    """Mass (kg), inertia about the pivot (kg m^2), centre of mass (m), in body axes.

    The inertia is the diagonal of the tensor, the products are its elements 23, 31 and 12.
    """

    mass: float
    inertia: np.ndarray
    centre: np.ndarray
    products: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def tensor(self) -> np.ndarray:
        """The tensor of inertia about the pivot, kg m^2."""
        tensor = np.diag(self.inertia)
        for (row, column), product in zip(((1, 2), (2, 0), (0, 1)), self.products, strict=True):
            tensor[row, column] = tensor[column, row] = product
        return tensor

    def axis(self) -> np.ndarray:
        """Unit vector from the pivot to the centre of mass; body z where they coincide."""
        length = np.linalg.norm(self.centre)
        return self.centre / length if length > 0 else np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Drawing:
    """The solids that stand for a body, and what the page says of them."""

    solids: list[dict[str, object]]
    label: str


def read_body(table: Table) -> Body | None:
    """The body in the header of a table; None if it cannot be drawn."""
    match = BODY.fullmatch(table.header.get("body", ""))
    if not match:
        return None
    try:
        mass, *others = [float(x) for group in match.groups("0, 0, 0") for x in group.split(",")]
    except ValueError:
        return None
    sizes = np.abs([mass, *others])
    if len(others) != 3 * 3 or not (sizes < LARGEST).all():
        return None
    return Body(mass, *np.reshape(others, (3, 3)))


def central_inertia(body: Body) -> np.ndarray:
    """The tensor of inertia about the centre of mass, kg m^2 (Steiner's theorem)."""
    r = body.centre
    return body.tensor() - body.mass * (r @ r * np.eye(3) - np.outer(r, r))


def as_solid(
    kind: str, axes: np.ndarray, place: np.ndarray, **extents: object
) -> dict[str, object]:
    """A solid as `stage/body.js` of the page has it; its own axes are the columns of `axes`."""
    own = [round(x, 15) for x in axes.T.ravel().tolist()]
    return {"kind": kind, **extents, "axes": own, "place": place.tolist()}


def shape_drawing(table: Table, body: Body) -> Drawing | None:
    """The shape that the input names, as it is; None if it names none."""
    if table.setting("top.shape") not in SHAPES:
        return None
    kind, keys, name = SHAPES[table.setting("top.shape")]
    extents = {extent: table.number(f"top.{key}") for extent, key in keys.items()}
    largest = max(size for extent, size in extents.items() if extent != "inner")
    if not (np.isfinite([*extents.values()]).all() and 0 < largest < LARGEST):
        return None
    label = f"The body is {name}, drawn to scale."
    if extents.get("height", 1.0) < THINNEST * extents["radius"]:
        extents["height"] = THINNEST * extents["radius"]
        label = f"The body is {name}, drawn to scale but for its thickness, which is smaller."
    return Drawing([as_solid(kind, np.eye(3), body.centre, **extents)], label)


def part_solid(table: Table, group: str) -> dict[str, object] | None:
    """The part that a group of the input describes; None if it is a point, or cannot be drawn."""
    sizes = {
        key: float(table.setting(f"{group}.{key}") or 0)
        for key in ("radius", "inner_radius", "thickness")
    }
    radius, inner, height = sizes.values()
    shape = table.setting(f"{group}.shape")
    place = np.array(table.settings.get(f"{group}.place", [0, 0, 0]), dtype=float)
    z = np.array(table.settings.get(f"{group}.axis", [0, 0, 1]), dtype=float)
    z /= np.linalg.norm(z)
    x = np.cross(np.eye(3)[np.argmin(abs(z))], z)
    axes = np.column_stack([x / np.linalg.norm(x), np.cross(z, x / np.linalg.norm(x)), z])
    if shape == "torus":
        height = radius - inner
    if shape == "cone":
        place = place + 3 * height / 4 * z
    if not 0 < max(sizes.values()) < LARGEST:
        return None
    if shape == "sphere":
        return as_solid("sphere", axes, place, radius=radius)
    radius, height = max(radius, THINNEST * height / 2), max(height, THINNEST * radius)
    kind = "cone" if shape == "cone" else "ring" if inner > 0 else "cylinder"
    extents = {"inner": inner} if kind == "ring" else {}
    return as_solid(kind, axes, place, radius=radius, height=height, **extents)


def part_drawing(table: Table) -> Drawing | None:
    """The parts of which the input composes the body; None if it has none."""
    keys = filter(re.compile(r"part(\(\d+\))?\.").match, table.settings)  # the second is part(2)
    groups = sorted({key.partition(".")[0] for key in keys})
    if not groups:
        return None
    solids = [solid for group in groups if (solid := part_solid(table, group))]
    return Drawing(
        solids, f"The body is composed of {len(groups)} parts; those with extent are drawn."
    )


def equivalent_solid(body: Body, inertia: np.ndarray) -> dict[str, object] | None:
    """The homogeneous solid of the mass and these moments of inertia about the centre of mass.

    A cylinder, or a cuboid where no two moments are equal; None for a point mass.
    """
    moments, axes = np.linalg.eigh(inertia)
    if body.mass <= 0 or moments[2] <= 0:
        return None
    close = ALIKE * moments[2]
    if moments[2] - moments[1] < close:  # the odd one comes last
        moments, axes = moments[[1, 2, 0]], axes[:, [1, 2, 0]]
    if np.linalg.det(axes) < 0:
        axes = axes * [1, 1, -1]
    if abs(moments[1] - moments[0]) < close:
        radius = np.sqrt(2 * max(moments[2], 0.0) / body.mass)
        height = np.sqrt(max(0.0, 12 * moments[0] / body.mass - 3 * radius**2))
        radius = max(radius, THINNEST * height / 2)
        height = max(height, 2 * THINNEST * radius)
        return as_solid("cylinder", axes, body.centre, radius=radius, height=height)
    squares = 6 * (moments.sum() - 2 * moments) / body.mass
    edges = np.sqrt(np.maximum(squares, 0))
    edges = np.maximum(edges, THINNEST * edges.max()).tolist()
    return as_solid("cuboid", axes, body.centre, edges=edges)


def draw_body(table: Table, body: Body) -> Drawing:
    """The solids for a body: its shape, or a homogeneous solid of its mass properties."""
    if shape := shape_drawing(table, body) or part_drawing(table):
        return shape
    inertia = central_inertia(body)
    # a mass distribution has these moments: the largest is at most the sum of the others
    moments = np.linalg.eigvalsh(inertia)
    is_known = moments[2] - moments[1] - moments[0] <= 3 * SLACK * body.inertia.max()
    inertia = inertia if is_known else np.diag(body.inertia)
    solid = equivalent_solid(body, inertia)
    if solid is None:
        point = "The body is a point mass on a massless rod."
        return Drawing([], point if is_known else NO_SUCH_BODY)
    is_disc = solid["kind"] == "cylinder" and solid["height"] < 0.5 * solid["radius"]
    what = f"homogeneous {'disc' if is_disc else solid['kind']}"
    label = f"{NO_SUCH_BODY} The {what} with these moments about its centre of mass is drawn."
    if is_known:
        same = "mass, centre of mass and moments of inertia"
        label = f"Only mass properties are given: the {what} with the same {same} is drawn."
    return Drawing([solid], label)
