"""The methods of the program, from its registry, and how they are drawn.

A family has a colour and a marker, its members differ in tone and dashes.
"""

import functools
from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb

from spintop_figures.style.look import GROUND, OURS, lightness, tint
from spintop_figures.tables.names import listed

OTHER = "own methods"
"""The family of what the registry does not have: tables and methods that a user adds."""

OWN: dict[str, int] = {}
"""Their places, in the order in which they are drawn."""

OWN_MARKERS = "DxH+8"
OWN_COLOURS = 3
"""Each of them has its own look, as they are drawn to be compared."""


class Method(NamedTuple):
    """A method: its family, its order if it has one, and its place among the members."""

    name: str
    family: str
    order: int | None
    place: int

    @property
    def is_own(self) -> bool:
        """Whether a user added it."""
        return self.family == OTHER

    @property
    def look(self) -> "Look":
        """Its look: that of its family, or its own one."""
        return look_of(self.family, self.place)


@functools.cache
def known_methods() -> dict[str, Method]:
    """The methods by name, family by family; Butcher tables are as their method.

    The members of a family are sorted: the highest order first. An order that the tolerance chooses
    is above all, one that a table decides below all.
    """
    methods: dict[str, Method] = {}
    members: dict[str, list[dict]] = {}
    for entry in listed("methods")["methods"]:
        members.setdefault(entry["family"], []).append(entry)
    for family, entries in members.items():
        entries.sort(key=lambda each: -(each["order"] or 1000 * (each["kind"] == "adaptive")))
        for place, entry in enumerate(entries):
            method = Method(entry["name"], family, entry["order"], place)
            methods |= dict.fromkeys((method.name, *(entry["tables"] or ())), method)
    return methods


def known(name: str) -> Method:
    """A method, or one that the registry does not have."""
    found = known_methods().get(name)
    return found or Method(name, OTHER, None, OWN.setdefault(name, len(OWN)))


def families() -> list[str]:
    """The families in the order of the registry, and that of own methods."""
    return [*dict.fromkeys(method.family for method in known_methods().values()), OTHER]


def rank_of(method: str) -> tuple[int, int, str]:
    """Where a method stands in a list: by its family, then by its place in it."""
    return families().index(known(method).family), known(method).place, method


MARKERS = "psv^PXo*h<>d"
"""Of the families in the order of the registry, as their colours are numbered."""

DASHES = ("-", (0, (5, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (1.2, 1.2)), (0, (3, 3)))
"""Of the members of a family, the first of which has the family's own colour."""

FILLS = {
    "space_frame": "full",
    "rigid_body": "none",
    "lagrange": "left",
    "euler": "bottom",
    "lagrange_energy": "right",
}
"""Which part of a marker is filled, by the formulation; of others all of it."""


class Look(NamedTuple):
    """The marker and the colour of a family."""

    marker: str
    colour: str

    @property
    def size(self) -> float:
        """The size of the marker over the usual one: a star is small."""
        return 1.5 if self.marker == "*" else 1.0


def look_of(family: str, place: int = 0) -> Look:
    """The look of a family; of own methods that at a place."""
    if family == OTHER:
        number = place % OWN_COLOURS + 1
        return Look(OWN_MARKERS[place % len(OWN_MARKERS)], f"{OURS}other{number}")
    place = families().index(family) % len(MARKERS)
    return Look(MARKERS[place], f"{OURS}family{place + 1}")


def ink_of(look: Look) -> tuple[float, ...]:
    """The colour of a look as words have it: as dark as they need to be read on white."""
    colour = np.array(to_rgb(look.colour))
    if lightness(GROUND) < 0.5:
        return tuple(colour)
    # a contrast of 4.5 to 1 on white, with the shares and the exponent of the colours of screens
    most = 0.18
    luminance = max(np.dot((0.2126, 0.7152, 0.0722), colour**2.2), most)
    return tuple(colour * (most / luminance) ** (1 / 2.2))


def style_of(method: str, formulation: str = "") -> dict[str, object]:
    """How the curve of a method under a formulation is drawn, in every figure alike."""
    its, look, variation = known(method), known(method).look, known(method).place
    return {
        "color": tint(look.colour, 0.0 if its.is_own else min(0.17 * variation, 0.6)),
        "linestyle": DASHES[variation % len(DASHES)],
        "marker": look.marker,
        "markersize": 5.5 * look.size,
        "fillstyle": FILLS.get(formulation, "full"),
        "markerfacecoloralt": GROUND,
        "markeredgewidth": 0.9,
    }
