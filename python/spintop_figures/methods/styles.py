"""How the methods are drawn: a colour and a marker by family, tone and dashes by member."""

from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb

from spintop_figures.methods.known import OTHER, families, family_of, place_of


class Look(NamedTuple):
    """The marker and the colour of a family."""

    marker: str
    colour: str


LOOKS = (
    Look("p", "#000000"),
    Look("s", "#d1641b"),
    Look("v", "#8a6fae"),
    Look("^", "#7a2048"),
    Look("P", "#2da4a1"),
    Look("X", "#c78803"),
    Look("o", "#12355b"),
    Look("*", "#2f7d32"),
    Look("h", "#a61e65"),
    Look("<", "#5c8292"),
    Look(">", "#765237"),
    Look("d", "#8a9050"),
)
"""Of the families in the order of the registry."""

OTHER_LOOK = Look("D", "#7f7f7f")

DASHES = ("-", (0, (5, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (1.2, 1.2)), (0, (3, 3)))
"""Of the members of a family, the first of which has the family's own colour."""

PALER, PALEST = 0.17, 0.6
"""How much of the way to white a member's colour is from the one before it, and at most."""

GAMMA, LUMINANCES = 2.2, (0.2126, 0.7152, 0.0722)
"""Of the colours of screens: exponent, and shares of red, green and blue."""

LIGHTEST_INK = 0.18
"""Luminance of words on white at a contrast of 4.5 to 1."""

FILLS = {
    "space_frame": "full",
    "rigid_body": "none",
    "lagrange": "left",
    "euler": "bottom",
    "lagrange_energy": "right",
}
"""Which part of a marker is filled, by the formulation; of others all of it."""


def look_of(family: str) -> Look:
    """The look of a family."""
    if family == OTHER:
        return OTHER_LOOK
    return LOOKS[families().index(family) % len(LOOKS)]


def ink_of(family: str) -> tuple[float, ...]:
    """The colour of a family as words have it: as dark as they need to be read on white."""
    colour = np.array(to_rgb(look_of(family).colour))
    luminance = max(np.dot(LUMINANCES, colour**GAMMA), LIGHTEST_INK)
    return tuple(colour * (LIGHTEST_INK / luminance) ** (1 / GAMMA))


def style_of(method: str, formulation: str = "") -> dict[str, object]:
    """How the curve of a method under a formulation is drawn, in every figure alike."""
    look, variation = look_of(family_of(method)), place_of(method)
    share = min(PALER * variation, PALEST)
    colour = tuple(part + share * (1 - part) for part in to_rgb(look.colour))
    return {
        "color": colour,
        "linestyle": DASHES[variation % len(DASHES)],
        "marker": look.marker,
        "markersize": 8 if look.marker == "*" else 5.5,
        "fillstyle": FILLS.get(formulation, "full"),
        "markerfacecoloralt": "white",
        "markeredgewidth": 0.9,
    }
