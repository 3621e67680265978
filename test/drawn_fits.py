"""Drawn measurements of spin-downs, toy tops and gyroscopes, with what sensors do to them.

Each case of `draw` has an offset of one sensor, 1 % of wrong readings, 2 % of readings and two
parts of the time missing, and starts of the search that are up to 2 % off. `draw_redundant` has
unknowns that no measurement tells apart, `draw_tumbling` a body without symmetry over many turns.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import spintop

KINDS = ("spin-down", "toy", "gyroscope")
OFF = 0.02
WRONG, MISSING, GAP = 0.01, 0.02, 0.05

WHEEL = {"mass": 0.2, "inertia": (4e-4, 4e-4, 3e-4), "length": 0.03}
FREE = {**WHEEL, "length": 0.0}
SLOWED = {**FREE, "inertia": (2e-4, 2e-4, 3e-4), "damping": (0.0, 0.0, 3e-5)}
SPINNING = {"theta": 1.0, "omega3": 82.0}
RELEASED = {"theta": 1.0, "psi_rate": 80.0}
MOVING = {"theta": 1.0, "phi_rate": 2.0, "theta_rate": 1.0, "omega3": 80.0}
REDUNDANT = (
    (FREE, SPINNING, ("omega3",), ("initial.omega3", "offset.omega3")),
    (WHEEL, MOVING, ("omega3",), ("initial.omega3", "offset.omega3")),
    (FREE, SPINNING, ("omega3",), ("initial.omega3", "scale.omega3")),
    (FREE, SPINNING, ("theta",), ("scale.theta", "offset.theta")),
    (FREE, SPINNING, ("theta",), ("initial.theta", "offset.theta")),
    (WHEEL, MOVING, ("phi", "theta"), ("top.mass", "top.inertia(1)", "top.inertia(3)")),
    (WHEEL, MOVING, ("phi", "theta"), ("top.length", "top.gravity")),
    (WHEEL, RELEASED, ("phi", "theta"), ("top.inertia(3)", "initial.psi_rate")),
    (WHEEL, MOVING, ("phi", "theta"), ("initial.phi", "offset.phi", "initial.theta")),
    (WHEEL, MOVING, ("omega1", "omega2"), ("initial.psi", "mounting(3)", "initial.omega3")),
    (SLOWED, SPINNING, ("omega3",), ("top.inertia(3)", "top.damping(3)")),
    (SLOWED, SPINNING, ("omega3",), ("initial.omega3", "offset.t")),
)


@dataclass
class Drawn:
    """A case: measurements, what is sought with its true values, and where the search begins."""

    kind: str
    data: dict[str, np.ndarray]
    sigma: dict[str, float]
    truth: dict[str, float]
    given: dict[str, Any]

    def fit(self, *, loss: str = "tukey", knows_sigma: bool = True) -> spintop.Result:
        sigma = self.sigma if knows_sigma else None
        given = {**self.given, "fit": {"loss": loss}}
        return spintop.fit(self.data, list(self.truth), given, sigma=sigma)


def moved(top: dict, start: dict, t: np.ndarray, columns: Sequence[str]) -> spintop.Motion:
    """The true motion."""
    top = spintop.Top(spintop.Body(**top), **start)
    return top.integrate(t, columns, relative_tolerance=1e-12)


def draw(number: int, seed: int = 1) -> Drawn:
    rng = np.random.default_rng([seed, number])
    kind = KINDS[number % len(KINDS)]
    motions = {"spin-down": spin_down, "toy": toy, "gyroscope": gyroscope}
    top, start, sigma, sought, offsets = motions[kind](rng)
    t_end = rng.uniform(5, 30)
    t = np.linspace(0, t_end, int(t_end * rng.uniform(40, 110)))
    motion = moved(top, start, t, list(sigma))
    for begin in rng.uniform(0.1, 0.9, 2) * t_end:
        t = t[(t < begin) | (t > begin + GAP * t_end)]
    kept = np.searchsorted(np.linspace(0, t_end, motion[next(iter(sigma))].size), t - 1e-12)
    data = {"t": t}
    for name, deviation in sigma.items():
        readings = motion[name][kept] + rng.normal(0, deviation, t.size) + offsets.get(name, 0)
        wrong = rng.random(t.size) < WRONG
        sizes = rng.choice([-1, 1], wrong.sum()) * rng.uniform(10, 100, wrong.sum())
        readings[wrong] += sizes * deviation
        readings[rng.random(t.size) < MISSING] = np.nan
        data[name] = readings
    truth, given = {}, {"top": dict(top), "initial": dict(start)}
    for name in sought:
        group, key = name.split(".")
        if group == "offset":
            truth[name] = offsets[key]
            continue
        truth[name] = value_of(given[group], key)
        set_value(given[group], key, truth[name] * (1 + rng.uniform(-OFF, OFF)))
    return Drawn(kind, data, sigma, truth, given)


def draw_redundant(number: int, seed: int = 1) -> tuple[dict, tuple[str, ...], dict]:
    """Measurements, unknowns of which one is another in disguise, and the input."""
    rng = np.random.default_rng([seed, number])
    top, start, columns, unknown = REDUNDANT[number % len(REDUNDANT)]
    start = {"phi": 0.3, "psi": 0.2, **start}
    noise = (0.0, 1e-3, 0.1)[number // len(REDUNDANT) % 3]
    t = np.linspace(0.02, rng.uniform(1, 10), rng.integers(60, 300))
    motion = moved(top, start, t, columns)
    data = {"t": t} | {name: motion[name] + rng.normal(0, noise, t.size) for name in columns}
    given = {"top": {"gravity": 9.81, **top}, "initial": start}
    for name in unknown:
        group, _, key = name.partition(".")
        if group in given:
            set_value(given[group], key, value_of(given[group], key) * (1 + rng.uniform(-OFF, OFF)))
    return data, unknown, given


def draw_tumbling(number: int, seed: int = 1) -> tuple[dict, tuple[str, ...], dict, float]:
    """Readings of a gyroscope in a body without symmetry, unknowns, the input, and the noise.

    The search begins at the truth, or a thousandth from it.
    """
    rng = np.random.default_rng([seed, number])
    top = {"mass": 1.0, "inertia": (0.9, rng.uniform(0.65, 0.85), rng.uniform(0.3, 0.5))}
    top |= {"length": rng.uniform(0.1, 0.3), "damping": (rng.uniform(0, 0.005),) * 3}
    start = {"theta": rng.uniform(0.5, 2), "psi": 0.8, "phi_rate": 0.2, "theta_rate": -0.4}
    start["omega3"] = rng.uniform(4, 9)
    columns, noise = ("omega1", "omega2", "omega3"), 0.05
    t = np.linspace(0, rng.uniform(80, 200), 150)
    motion = moved(top, start, t, columns)
    data = {"t": t} | {name: motion[name] + rng.normal(0, noise, t.size) for name in columns}
    given = {"top": top, "initial": start | {"omega3": start["omega3"] * (1, 1.001)[number % 2]}}
    given["integration"] = {"relative_tolerance": 1e-12}
    return data, ("initial.omega3", "top.inertia(3)")[: 1 + number % 3 // 2], given, noise


def value_of(keys: dict[str, Any], key: str) -> float:
    """A number of a group: `omega3`, `inertia(1)`."""
    name, _, index = key.partition("(")
    return keys[name][int(index[0]) - 1] if index else keys[name]


def set_value(keys: dict[str, Any], key: str, value: float) -> None:
    """Set a number of a group; `inertia(1)` is both moments across the axis."""
    name, _, index = key.partition("(")
    if not index:
        keys[name] = value
        return
    places = (0, 1) if key == "inertia(1)" else (int(index[0]) - 1,)
    keys[name] = tuple(value if i in places else old for i, old in enumerate(keys[name]))


def spin_down(rng: np.random.Generator) -> tuple:
    """A balanced rotor that a bearing slows, with a tachometer."""
    inertia3 = 3e-4
    top = {**FREE, "inertia": (2e-4, 2e-4, inertia3)}
    top["damping"] = (0.0, 0.0, inertia3 / rng.uniform(5, 30))
    start = {"theta": 0.5, "omega3": rng.uniform(50, 300)}
    sought = ("initial.omega3", "top.damping(3)", "offset.omega3")
    return top, start, {"omega3": 0.3}, sought, {"omega3": rng.uniform(-1, 1)}


def toy(rng: np.random.Generator) -> tuple:
    """A toy top with friction about its axis, whose inclination and precession a film gives."""
    mass, length, across = 0.08, 0.04, rng.uniform(1e-4, 3e-4)
    along = across * rng.uniform(0.3, 1)
    threshold = math.sqrt(4 * across * mass * 9.81 * length) / along
    top = {"mass": mass, "inertia": (across, across, along), "length": length}
    top["damping"] = (0.0, 0.0, along / rng.uniform(20, 100))
    start = {"theta": rng.uniform(0.15, 0.9), "omega3": threshold * rng.uniform(1.3, 4)}
    sought = ("top.inertia(1)", "initial.omega3", "top.damping(3)", "initial.theta", "offset.theta")
    return top, start, {"theta": 0.004, "phi": 0.004}, sought, {"theta": rng.uniform(-0.02, 0.02)}


def gyroscope(rng: np.random.Generator) -> tuple:
    """A gyroscope that nutates, with an inclinometer, an encoder and a tachometer."""
    across = rng.uniform(2e-4, 6e-4)
    along = across * rng.uniform(0.8, 1.6)
    top = {"mass": 0.15, "inertia": (across, across, along), "length": 0.03}
    start = {"theta": rng.uniform(0.5, 1.8), "omega3": rng.uniform(60, 400)}
    start["phi_rate"] = rng.uniform(3, 8)
    sought = ("top.inertia(1)", "top.inertia(3)", "initial.omega3", "initial.phi_rate")
    sigma = {"theta": 0.004, "phi": 0.004, "omega3": 0.5}
    return top, start, sigma, (*sought, "offset.theta"), {"theta": rng.uniform(-0.02, 0.02)}


@dataclass
class DrawnRuns:
    """Runs of one wheel: their measurements, what all have in common and each for itself, starts.

    `truth` has the true values in the order of the table, `each` where the search of the numbers of
    each run begins.
    """

    data: list[dict[str, np.ndarray]]
    truth: dict[str, float]
    given: dict[str, Any]
    each: dict[str, list[float]]
    common: tuple[str, ...] = ("top.inertia(3)", "top.damping(3)")

    def fit(self, **options: object) -> spintop.Result:
        return spintop.fit(self.data, self.common, self.given, unknown_each=self.each, **options)


def draw_runs(number: int, seed: int = 1, runs: int = 3) -> DrawnRuns:
    """Spin-downs of a wheel by gyroscopes that have noise, a bias, spin and sampling of their own.

    One in three has no `omega1`, and spins may differ by a factor of four. The search of the spin
    begins at the first reading.
    """
    rng = np.random.default_rng([seed, number, runs])
    along, damping = 3e-4 * rng.uniform(0.9, 1.1), 3e-4 / rng.uniform(10, 40)
    top = WHEEL | {"inertia": (4e-4, 4e-4, along), "damping": (0.0, 0.0, damping)}
    truth, data = {"top.inertia(3)": along, "top.damping(3)": damping}, []
    each = {"initial.omega3": [], "initial.theta": [], "offset.omega2": []}
    for run in range(1, runs + 1):
        start = {"theta": rng.uniform(0.5, 1.5), "omega3": rng.uniform(60, 240)}
        t_end = rng.uniform(1.5, 3)
        t = np.linspace(rng.uniform(0, 0.02), t_end, int(t_end * rng.uniform(45, 90)))
        columns = ("omega1", "omega2", "omega3")[run % 3 == 0 :]
        bias, noise = rng.uniform(-0.5, 0.5), rng.uniform(0.02, 0.1)
        motion = moved(top, start, t, columns)
        data.append({"t": t})
        for name in columns:
            data[-1][name] = motion[name] + rng.normal(0, noise, t.size)
        data[-1]["omega2"] += bias
        truth[f"initial.omega3[{run}]"] = start["omega3"]
        truth[f"initial.theta[{run}]"] = start["theta"]
        truth[f"offset.omega2[{run}]"] = bias
        each["initial.omega3"].append(data[-1]["omega3"][0])
        each["initial.theta"].append(start["theta"] * (1 + rng.uniform(-OFF, OFF)))
        each["offset.omega2"].append(0.0)
    given = {"initial": {"theta": 1.0, "omega3": 100.0}}
    given["top"] = top | {"inertia": (4e-4, 4e-4, 3e-4), "damping": (0.0, 0.0, 1.5e-5)}
    return DrawnRuns(data, truth, given, each)
