"""A motion to compute, as numbers: the body, its start, how long, and where it ends."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from peers.quaternion import angle_between, to_space

ALIKE = 1e-14
"""Two moments of inertia are the same if they differ by no more than this part."""


@dataclass(frozen=True)
class Problem:
    """A rigid body with a fixed point from its start to `t_end`, in SI units and principal axes.

    Inertia is about the fixed point; `weight` is m g times the vector to the centre of mass, N m. A
    symmetric top has its axis on body z.
    """

    name: str
    inertia: tuple[float, ...]
    weight: tuple[float, ...]
    damping: tuple[float, ...]
    quaternion: tuple[float, ...]
    omega: tuple[float, ...]
    t_end: float
    reference: tuple[float, ...]
    """The attitude at the end."""
    general: bool = False
    """Whether no use is to be made of a symmetry."""

    @property
    def is_symmetric(self) -> bool:
        """Whether it is an undamped symmetric top about body z."""
        return (
            not self.general
            and math.isclose(self.inertia[0], self.inertia[1], rel_tol=ALIKE)
            and not any(self.weight[:2])
            and not any(self.damping)
        )

    def orientation_error(self, q: Sequence[float]) -> float:
        """Rotation angle from the attitude at the end, rad."""
        return angle_between(q, self.reference)

    def tip_error(self, q: Sequence[float]) -> float:
        """Distance of the axis tip from that at the end: the centre of mass at unit distance."""
        length = math.hypot(*self.weight)
        axis = [part / length for part in self.weight] if length else [0.0, 0.0, 1.0]
        norm = math.hypot(*q)
        return math.dist(
            to_space([part / norm for part in q], axis), to_space(self.reference, axis)
        )

    def as_dict(self) -> dict:
        """All of it, for another process."""
        return asdict(self)
