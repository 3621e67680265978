"""Random symmetric tops of all classes of motion, drawn with a fixed seed."""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass

TURNS = (-2.0, 6.0)
"""The span is 10 to a power from this interval, in natural periods."""
UNITS = 12
"""A third of the tops have units of mass, length and time that differ by up to 10 to this power."""


@dataclass(frozen=True)
class Start:
    """Data of a motion: the body (SI units), its angles (rad) and rates (rad/s) at time 0.

    `spin` is psi_rate, or omega3 if `spin_is_omega3`.
    """

    inertia1: float
    inertia3: float
    mass: float
    gravity: float
    length: float
    phi: float
    theta: float
    psi: float
    phi_rate: float
    theta_rate: float
    spin: float
    spin_is_omega3: bool = False


class Draw:
    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.uniform = self.random.uniform
        self.i1, self.i3 = self.log(0.05, 20), 0.0
        self.i3 = self.i1 * self.random.choice([self.log(1e-3, 0.1), self.uniform(0.1, 2), 1.0])
        self.mass, self.gravity, self.length = self.log(0.1, 10), 9.81, self.log(0.05, 3)
        self.phi, self.psi = self.uniform(-4, 4), self.uniform(-4, 4)
        self.theta = self.uniform(0.05, 3.09)
        self.phi_rate, self.theta_rate, self.omega3 = 0.0, 0.0, 0.0

    def log(self, low: float, high: float) -> float:
        """A number between two others, uniform in its logarithm."""
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    def signed(self, low: float, high: float) -> float:
        """The same with either sign."""
        return self.log(low, high) * self.random.choice([-1, 1])

    @property
    def beta(self) -> float:
        """2 m g l/I1."""
        return 2 * self.mass * self.gravity * self.length / self.i1

    @property
    def threshold(self) -> float:
        """The spin beyond which the sleeping top is stable."""
        return math.sqrt(2 * self.beta) * self.i1 / self.i3

    @property
    def rate(self) -> float:
        swing = math.hypot(self.theta_rate, self.phi_rate)
        return math.hypot(math.sqrt(self.beta), self.i3 * self.omega3 / self.i1, swing)


def draw_slow(top: Draw) -> None:
    """A start at rest or with moderate rates."""
    top.omega3 = top.signed(0.01, 0.7) * top.threshold
    if top.random.random() < 0.5:
        scale = math.sqrt(top.beta)
        top.phi_rate, top.theta_rate = top.signed(0.01, 3) * scale, top.signed(0.01, 3) * scale


def draw_fast(top: Draw) -> None:
    """A spin of up to 1000 thresholds."""
    top.omega3 = top.signed(1, 1000) * top.threshold
    if top.random.random() < 0.5:
        top.phi_rate = top.signed(0.001, 1) * math.sqrt(top.beta)


def draw_sleeping(top: Draw) -> None:
    """Close to the upright, or upright, with a spin around the threshold."""
    top.theta = top.random.choice([0.0, top.log(1e-9, 0.1)])
    top.omega3 = top.signed(0.3, 3) * top.threshold
    if top.random.random() < 0.5:
        top.theta_rate = top.signed(1e-9, 0.1) * math.sqrt(top.beta)


def draw_separatrix(top: Draw) -> None:
    """An energy and momenta close to those of the sleeping top that falls and rises again."""
    top.omega3 = top.signed(0.01, 0.95) * top.threshold
    a, u = top.i3 * top.omega3 / top.i1, math.cos(top.theta)
    top.phi_rate = a / (1 + u) * (1 + top.random.choice([0, top.signed(1e-15, 1e-3)]))
    square = top.beta * (1 - u) - (1 - u) / (1 + u) * a**2
    if square < 0:
        top.theta = 0.5 * math.acos(min(a**2 / top.beta - 1, 1.0))
        u = math.cos(top.theta)
        top.phi_rate = a / (1 + u)
        square = max(top.beta * (1 - u) - (1 - u) / (1 + u) * a**2, 0.0)
    top.theta_rate = math.sqrt(square) * top.random.choice([-1, 1]) * (1 + top.signed(1e-15, 1e-3))


def draw_at_pole(top: Draw) -> None:
    """A start close to a pole, at distances of 1e-9 to 0.1."""
    distance = top.log(1e-9, 0.1)
    top.theta = top.random.choice([distance, math.pi - distance])
    scale = math.sqrt(top.beta)
    top.omega3 = top.signed(0.01, 5) * top.threshold
    top.theta_rate = top.signed(1e-6, 5) * scale
    if top.random.random() < 0.5:
        top.phi_rate = top.signed(1e-3, 10) * scale


def draw_near_pole(top: Draw) -> None:
    """A passage close to theta = 0 or theta = pi: momenta that are almost equal or opposite."""
    top.omega3 = top.signed(0.01, 2) * top.threshold
    a, u = top.i3 * top.omega3 / top.i1, math.cos(top.theta)
    miss = 1 + top.random.choice([0, top.signed(1e-12, 1e-1)])
    top.phi_rate = a / (1 + u) * miss if top.random.random() < 0.5 else -a / (1 - u) * miss
    top.theta_rate = top.signed(0.5, 5) * math.sqrt(top.beta)


def draw_cusp(top: Draw) -> None:
    """A start from rest in phi and theta: a cusp."""
    top.omega3 = top.signed(0.1, 20) * top.threshold


def draw_loop(top: Draw) -> None:
    """A start at the upper turning point with phi' against or along the precession."""
    top.omega3 = top.signed(0.3, 20) * top.threshold
    steady = top.beta / 2 / (top.i3 * top.omega3 / top.i1)
    top.phi_rate = steady * top.uniform(-3, 2)


def draw_plane(top: Draw) -> None:
    """A plane pendulum, or almost one."""
    scale = math.sqrt(top.beta)
    top.theta_rate = top.random.choice([0.0, top.signed(1e-3, 10) * scale])
    if top.random.random() < 0.5:
        top.phi_rate, top.omega3 = top.signed(1e-14, 1e-3) * scale, top.signed(1e-14, 1e-3) * scale


def draw_spherical(top: Draw) -> None:
    top.i3 = top.i1
    draw_slow(top)


def draw_steady(top: Draw) -> None:
    """Steady precession, slow or fast, or close to it."""
    top.omega3 = top.signed(1.05, 50) * top.threshold
    a, u = top.i3 * top.omega3 / top.i1, math.cos(top.theta)
    root = math.sqrt(max(a**2 - 2 * top.beta * u, 0.0))
    slow = top.beta / (a + math.copysign(root, a))
    fast = (a + math.copysign(root, a)) / (2 * u) if abs(u) > 0.01 else slow
    top.phi_rate = top.random.choice([slow, fast]) * (
        1 + top.random.choice([0, 1]) * top.signed(1e-16, 1e-2)
    )
    if top.random.random() < 0.3:
        top.theta_rate = top.signed(1e-16, 1e-3) * math.sqrt(top.beta)


def draw_weightless(top: Draw) -> None:
    """Little gravity, or none."""
    draw_slow(top)
    top.gravity = top.random.choice([0.0, top.log(1e-14, 1e-2)])
    if top.random.random() < 0.5:
        top.theta_rate = top.signed(0.01, 10)


CLASSES: dict[str, Callable[[Draw], None]] = {
    name.removeprefix("draw_").replace("_", " "): draw
    for name, draw in list(globals().items())
    if name.startswith("draw_")
}


def draw_top(number: int, seed: int) -> tuple[str, Start, float]:
    """Class, data and span (s) of a top; tops of all classes take turns."""
    kind = list(CLASSES)[number % len(CLASSES)]
    top = Draw(seed * 1_000_003 + number)
    CLASSES[kind](top)
    span = 2 * math.pi / top.rate * 10 ** top.uniform(*TURNS)
    mass, length, time = (
        (10.0 ** top.uniform(-UNITS, UNITS) for _ in range(3)) if number % 3 == 0 else (1.0,) * 3
    )
    spin_is_omega3 = top.random.random() < 0.5 or kind == "at pole"
    spin = top.omega3
    if not spin_is_omega3:
        spin -= top.phi_rate * math.cos(top.theta)
    body = (top.i1 * mass * length**2, top.i3 * mass * length**2, top.mass * mass)
    places = (top.gravity * length / time**2, top.length * length, top.phi, top.theta, top.psi)
    rates = (top.phi_rate / time, top.theta_rate / time, spin / time)
    return kind, Start(*body, *places, *rates, spin_is_omega3), span * time
