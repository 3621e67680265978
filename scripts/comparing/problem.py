"""Motions to compute, as numbers: the body, its start, how long, and where it is on the way.

Attitudes are unit quaternions, scalar first, body to space. Nothing here needs a library.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

ALIKE = 1e-14
"""Two moments of inertia are the same if they differ by no more than this part."""


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


@dataclass(frozen=True)
class Problem:
    """A rigid body from its start to `t_end`, in SI units and principal axes.

    Inertia is about the fixed point, from which the centre of mass is at `arm`; a body with neither
    arm nor weight is free. A symmetric top has its axis on body z, but for those of MOTIONS.
    """

    name: str
    mass: float
    gravity: float
    arm: tuple[float, ...]
    inertia: tuple[float, ...]
    quaternion: tuple[float, ...]
    omega: tuple[float, ...]
    t_end: float
    damping: tuple[float, ...] = (0.0, 0.0, 0.0)
    samples: int = 1
    """At so many equidistant times attitudes are compared, the last of which is the end."""
    truth: Sequence[Sequence[float]] = ()
    """The attitudes at these times."""
    general: bool = False
    """Whether no use is to be made of a symmetry."""

    @property
    def is_top(self) -> bool:
        """Whether it has a fixed point, and weight."""
        return any(self.arm)

    @property
    def weight(self) -> list[float]:
        """m g times the vector to the centre of mass, N m."""
        return [self.mass * self.gravity * part for part in self.arm]

    @property
    def central(self) -> list[list[float]]:
        """The inertia about the centre of mass, a matrix."""
        square = sum(x * x for x in self.arm)
        return [
            [self.mass * x * y + (self.inertia[i] - self.mass * square if i == j else 0.0)
             for j, y in enumerate(self.arm)]
            for i, x in enumerate(self.arm)
        ]  # fmt: skip

    @property
    def is_symmetric(self) -> bool:
        """Whether it is an undamped symmetric top about body z."""
        is_round = math.isclose(self.inertia[0], self.inertia[1], rel_tol=ALIKE)
        return is_round and not (self.general or any(self.arm[:2]) or any(self.damping))

    def judge(self, states: Sequence[Sequence[float]]) -> dict[str, float]:
        """The largest errors of a run: its attitude, rad, energy and momentum, as parts.

        The momentum of a top is that about the vertical, and its energy a part of the kinetic
        energy and m g times the arm together. Both are left out without an angular velocity.
        """
        names = ("orientation_error", "energy", "momentum")
        if len(states) < self.samples or not all(math.isfinite(x) for y in states for x in y):
            return {names[0]: math.inf}
        states = [[x / math.hypot(*y[:4]) for x in y[:4]] + list(y[4:]) for y in states]
        error = max(map(angle_between, (y[:4] for y in states), self.truth))
        if len(states[0]) == len(self.quaternion):
            return {names[0]: error}
        first, energy = self.momentum_and_energy([*self.quaternion, *self.omega])
        length, height = math.hypot(*self.weight), to_space(self.quaternion, self.weight)[2]
        found = [self.momentum_and_energy(y) for y in states]
        axes = slice(2, 3) if self.is_top else slice(0, 3)
        drift = max(abs(value - energy) for _, value in found) / (energy + length - height)
        turn = max(math.dist(value[axes], first[axes]) for value, _ in found) / math.hypot(*first)
        return dict(zip(names, (error, drift, turn), strict=True))

    def momentum_and_energy(self, state: Sequence[float]) -> tuple[list[float], float]:
        """The angular momentum in space axes, about the fixed point, and the energy."""
        momentum = [i * w for i, w in zip(self.inertia, state[4:], strict=True)]
        turning = sum(p * w for p, w in zip(momentum, state[4:], strict=True)) / 2
        return to_space(state[:4], momentum), turning + to_space(state[:4], self.weight)[2]

    def groups(self) -> list[str]:
        """As the groups of an input of spintop."""
        body = f"mass = {self.mass} gravity = {self.gravity} inertia = {as_list(self.inertia)}"
        place = f"centre_of_mass = {as_list(self.arm)} damping = {as_list(self.damping)}"
        return [
            f"&top {body} {place} /",
            f"&initial quaternion = {as_list(self.quaternion)} omega = {as_list(self.omega)} /",
            f"&span t_end = {self.t_end} samples = {self.samples + 1} /",
        ]


FREE, UPRIGHT = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
INCLINED = (math.cos(math.pi / 32), math.sin(math.pi / 32), 0.0, 0.0)
MOTIONS = tuple(
    Problem(name, mass, 9.81 if any(arm) else 0.0, arm, inertia, start, omega, t_end, samples=25)
    for name, t_end, mass, inertia, arm, omega, start in (
        ("free_symmetric", 5, 1, (1.0, 1.0, 0.5), FREE, (0.5, 0.5, 1.0), UPRIGHT),
        ("free_asymmetric", 5, 1, (0.13 / 3, 0.1 / 3, 0.05 / 3), FREE, (1.0, 2.0, 3.0), UPRIGHT),
        ("intermediate_axis", 10, 0.1, (1e-4, 2e-4, 2.5e-4), FREE, (1e-3, 10.0, 1e-3), UPRIGHT),
        ("free_needle", 2, 0.12, (1.7231e-4, 6.58e-6, 1.7243e-4), FREE, (30.0, 100.0, 1.0),
         UPRIGHT),
        ("slow_top", 7.5, 1, (0.875, 0.875, 0.25), (0.0, 0.0, 0.75**0.5), (0.0, 0.0, 1.0),
         INCLINED),
        ("heavy_top", 2, 15, (15.234375, 0.46875, 15.234375), (0.0, 1.0, 0.0),
         (0.0, 150.0, -4.61538), UPRIGHT),
    )
)  # fmt: skip
"""What the engines compute."""


def as_list(numbers: Sequence[float]) -> str:
    """Numbers in a namelist."""
    return ", ".join(map(repr, numbers))
