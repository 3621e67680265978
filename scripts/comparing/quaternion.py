"""Unit quaternions of attitudes, scalar first, body to space; they need no library."""

import math
from collections.abc import Sequence


def product(a: Sequence[float], b: Sequence[float]) -> list[float]:
    """The turn b followed by the turn a, both in space axes."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    return [
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 + a2 * b0 + a3 * b1 - a1 * b3,
        a0 * b3 + a3 * b0 + a1 * b2 - a2 * b1,
    ]


def conjugate(q: Sequence[float]) -> list[float]:
    """The turn back."""
    return [q[0], -q[1], -q[2], -q[3]]


def to_space(q: Sequence[float], vector: Sequence[float]) -> list[float]:
    """A vector in body axes, in space axes."""
    return product(product(q, [0.0, *vector]), conjugate(q))[1:]


def angle_between(a: Sequence[float], b: Sequence[float]) -> float:
    """Rotation angle between two attitudes, rad; for quaternions of any norm."""
    turn = product(conjugate(a), b)
    return 2 * math.atan2(math.hypot(*turn[1:]), abs(turn[0]))
