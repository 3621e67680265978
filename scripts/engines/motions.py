"""The six motions that all engines compute, what is true of them, and how far others are off."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from peers.quaternion import angle_between, to_space
from peers.scene import END, REFERENCE, as_list, ask_for, compute

SAMPLES = 25
"""The error of a run is its largest at so many equidistant times."""
GRAVITY = 9.81


@dataclass(frozen=True)
class Motion:
    """A free body, or a top that turns about a fixed point; SI units, principal axes.

    `inertia` is about the centre of mass, which is at `arm` from the fixed point (zero for a free
    body); `omega` in the axes of the body.
    """

    name: str
    about: str
    mass: float
    inertia: tuple[float, float, float]
    arm: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    omega: tuple[float, float, float]
    t_end: float

    @property
    def is_top(self) -> bool:
        """Whether it has a fixed point, and weight."""
        return any(self.arm)

    @property
    def inertia_at_pivot(self) -> list[float]:
        """About the fixed point, which is on a principal axis."""
        square = sum(x * x for x in self.arm)
        pairs = zip(self.inertia, self.arm, strict=True)
        return [i + self.mass * (square - x * x) for i, x in pairs]

    def groups(self) -> list[str]:
        """As the groups of an input of spintop."""
        body = f"mass = {self.mass} inertia = {as_list(self.inertia_at_pivot)}"
        return [
            f"&top {body} centre_of_mass = {as_list(self.arm)} gravity = {GRAVITY} /",
            f"&initial quaternion = {as_list(self.quaternion)} omega = {as_list(self.omega)} /",
            f"&span t_end = {self.t_end} samples = {SAMPLES + 1} /",
        ]

    def truth(self, folder: Path) -> list[list[float]]:
        """The attitudes at the samples, by spintop in quadruple precision."""
        rows = compute("trajectory", [*self.groups(), ask_for(END), REFERENCE], folder).rows
        return rows[list(END[:4])].to_numpy(float).tolist()[1:]

    def momentum(self, q: Sequence[float], omega: Sequence[float]) -> list[float]:
        """The angular momentum in space axes, about the fixed point if there is one."""
        pairs = zip(self.inertia_at_pivot, omega, strict=True)
        return to_space(q, [i * w for i, w in pairs])

    def energy(self, q: Sequence[float], omega: Sequence[float]) -> float:
        """Of the turning body, and of its weight."""
        pairs = zip(self.inertia_at_pivot, omega, strict=True)
        height = to_space(q, self.arm)[2]
        return sum(i * w * w for i, w in pairs) / 2 + self.mass * GRAVITY * height


def errors(
    motion: Motion, truth: Sequence[Sequence[float]], states: Sequence[Sequence[float]]
) -> dict[str, float]:
    """The largest errors of a run: its attitude, rad, energy and momentum, as parts of the first.

    The momentum of a top is that about the vertical, and its energy a part of the kinetic energy
    and m g times the arm together.
    """
    if len(states) < SAMPLES or not all(math.isfinite(x) for state in states for x in state):
        return {"attitude": math.inf, "energy": math.inf, "momentum": math.inf}
    states = [[x / math.hypot(*state[:4]) for x in state[:4]] + state[4:] for state in states]
    first = motion.momentum(motion.quaternion, motion.omega)
    energy = motion.energy(motion.quaternion, motion.omega)
    weight = motion.mass * GRAVITY * math.hypot(*motion.arm)
    scale = energy - weight * (to_space(motion.quaternion, motion.arm)[2] - math.hypot(*motion.arm))
    axes = slice(2, 3) if motion.is_top else slice(0, 3)
    return {
        "attitude": max(map(angle_between, (state[:4] for state in states), truth)),
        "energy": max(abs(motion.energy(s[:4], s[4:]) - energy) for s in states) / scale,
        "momentum": max(math.dist(motion.momentum(s[:4], s[4:])[axes], first[axes]) for s in states)
        / math.hypot(*first),
    }


UPRIGHT = (1.0, 0.0, 0.0, 0.0)
FREE = (0.0, 0.0, 0.0)
MOTIONS = (
    Motion("free_symmetric", "a free symmetric body in regular precession", 1,
           (1.0, 1.0, 0.5), FREE, UPRIGHT, (0.5, 0.5, 1.0), 5),
    Motion("free_asymmetric", "a free box that tumbles", 1,
           (0.13 / 3, 0.1 / 3, 0.05 / 3), FREE, UPRIGHT, (1.0, 2.0, 3.0), 5),
    Motion("intermediate_axis", "a free body that turns over repeatedly", 0.1,
           (1e-4, 2e-4, 2.5e-4), FREE, UPRIGHT, (1e-3, 10.0, 1e-3), 10),
    Motion("free_needle", "a free slender body", 0.12,
           (1.7231e-4, 6.58e-6, 1.7243e-4), FREE, UPRIGHT, (30.0, 100.0, 1.0), 2),
    Motion("slow_top", "a slow heavy top that falls", 1,
           (0.125, 0.125, 0.25), (0.0, 0.0, 0.8660254037844387),
           (math.cos(math.pi / 32), math.sin(math.pi / 32), 0.0, 0.0), (0.0, 0.0, 1.0), 7.5),
    Motion("heavy_top", "a fast heavy top, the benchmark of Bruels, Cardona and Arnold", 15,
           (0.234375, 0.46875, 0.234375), (0.0, 1.0, 0.0), UPRIGHT, (0.0, 150.0, -4.61538), 2),
)  # fmt: skip
