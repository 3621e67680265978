"""The surfaces of solids as polygons, in body axes."""

from itertools import pairwise

import numpy as np

SECTORS, STEPS = 8, 4
"""A solid of revolution has so many sectors, by which one sees it turn, of so many polygons."""

ARC = 10
"""Pieces of half a circle."""

MARK, EVEN, ODD = 0, 1, 2
"""Colours of polygons: the sector that is marked, and the others in turn."""


def surface(solid: dict[str, object]) -> tuple[np.ndarray, np.ndarray]:
    """The polygons of a solid, four corners each, and their colours."""
    own, colours = faces(solid) if solid["kind"] == "cuboid" else revolved(outline(solid))
    frame = np.array(solid["axes"], float).reshape(3, 3)
    return own @ frame + np.array(solid["place"], float), colours


def outline(solid: dict[str, object]) -> list[tuple[float, float]]:
    """Radius and height along the edge of a solid of revolution about its own z."""
    r, h = float(solid["radius"]), float(solid.get("height", 0.0))
    match solid["kind"]:
        case "cylinder":
            return [(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)]
        case "ring":
            s = float(solid["inner"])
            return [(s, -h / 2), (r, -h / 2), (r, h / 2), (s, h / 2), (s, -h / 2)]
        case "cone":
            return [(0, -0.75 * h), (r, h / 4), (0, h / 4)]
        case _:  # a sphere
            angles = np.linspace(-np.pi / 2, np.pi / 2, ARC + 1)
            return [(r * np.cos(a), r * np.sin(a)) for a in angles]


def revolved(edge: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """The polygons that an edge sweeps about z."""
    angles = np.linspace(0, 2 * np.pi, SECTORS * STEPS + 1)
    polygons = [
        [
            (r * np.cos(t), r * np.sin(t), h)
            for r, t, h in ((r0, a, h0), (r0, b, h0), (r1, b, h1), (r1, a, h1))
        ]
        for (r0, h0), (r1, h1) in pairwise(edge)
        for a, b in pairwise(angles)
    ]
    sectors = np.arange(len(polygons)) // STEPS % SECTORS
    return np.array(polygons), np.where(sectors == 0, MARK, np.where(sectors % 2, ODD, EVEN))


def faces(solid: dict[str, object]) -> tuple[np.ndarray, np.ndarray]:
    """The six faces of a cuboid; one pair is marked."""
    half = np.array(solid["edges"], float) / 2
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    polygons = [
        np.insert(square, axis, side, axis=1) * half for axis in range(3) for side in (-1.0, 1.0)
    ]
    return np.array(polygons), np.repeat((MARK, EVEN, ODD), 2)
