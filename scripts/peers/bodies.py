"""Many bodies at once: a sweep of damped bodies without symmetry, and how exact its ends are.

Each of ten thousand bodies has a different inertia. They start near the upright with spins from 0.5
to 20 rad/s. Slow bodies fall, and amplify the errors of the steps up to ten million times.
"""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from peers.problem import Problem
from peers.program import RunError, processors, run_sweep
from peers.quaternion import angle_between

CASES = 10000
INERTIA = (0.875, 0.7, 0.25)
MASS, GRAVITY = 2.0, 9.81
CENTRE = (0.021650635094610966, -0.012990381056766580, 0.43227658029900259)
DAMPING = (0.01, 0.01, 0.005)
START = (math.cos(math.pi / 32), math.sin(math.pi / 32), 0.0, 0.0)
ANGLES = ("phi_end", "theta_end", "psi_end")
SCENE = f"""\
! Damped bodies without symmetry, started near the upright: written by scripts/measure_batch.

&study  kind = 'sweep' /
&top
    mass = {MASS}
    gravity = {GRAVITY}
    centre_of_mass = {", ".join(map(repr, CENTRE))}
    damping = {", ".join(map(repr, DAMPING))}
/
&initial  quaternion = {", ".join(map(repr, START))}  omega = 0, 0, 1 /
&span  t_end = 7 /
&integration  relative_tolerance = 1e-10  absolute_tolerance = 1e-10 /
&output  columns = 'theta_end', 'phi_end', 'psi_end' /
&sweep  table = 'TABLE' /
"""


@dataclass(frozen=True)
class Errors:
    """Of the attitudes at the end: median, 99th percentile and maximum, rad."""

    median: float
    most: float
    largest: float


def inertia_of(k: int) -> list[float]:
    """The moments of inertia of body k, counted from zero."""
    shares = math.sin(k), math.sin(1.7 * k + 1), math.sin(2.3 * k + 2)
    return [own * (1 + 0.02 * share) for own, share in zip(INERTIA, shares, strict=True)]


def spin_of(k: int) -> float:
    """The spin of body k at the start, rad/s."""
    return 0.5 * 40 ** (k / (CASES - 1))


def problems(t_end: float) -> Iterator[Problem]:
    """All bodies as problems, whose ends are not known."""
    weight = tuple(MASS * GRAVITY * part for part in CENTRE)
    for k in range(CASES):
        omega = (0.0, 0.0, spin_of(k))
        yield Problem("body", tuple(inertia_of(k)), weight, DAMPING, START, omega, t_end, START)


def write_cases(path: Path, every: int) -> None:
    """Write the bodies, or every so many of them, as a table of parameters."""
    with path.open("w", encoding="ascii", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*(f"top.inertia({i})" for i in (1, 2, 3)), "initial.omega(3)"])
        for k in range(0, CASES, every):
            table.writerow([*inertia_of(k), spin_of(k)])


def write_scene(folder: Path, name: str, every: int) -> Path:
    """Write the input with every so many of the bodies, and its table."""
    write_cases(folder / f"{name}_cases.csv", every)
    scene = folder / f"{name}.nml"
    scene.write_text(SCENE.replace("TABLE", f"{name}_cases.csv"), encoding="ascii")
    return scene


def run(
    scene: Path, threads: int, span: str, tolerance: str, method: str = "taylor"
) -> tuple[list[list[float]], float]:
    """Run the sweep, and give the angles at the ends and the seconds of computing."""
    settings = (
        f"span.t_end={span}",
        f"integration.method={method}",
        *(f"integration.{kind}_tolerance={tolerance}" for kind in ("relative", "absolute")),
    )
    seconds = run_sweep(scene, threads, settings, scene.parent).computing
    with scene.with_suffix(".csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        angles = [[float(row[name]) for name in ANGLES] for row in rows]
    if not all(math.isfinite(angle) for three in angles for angle in three):
        raise RunError(f"{scene}: some bodies have no end")
    return angles, seconds


def run_reference(folder: Path, span: str, every: int) -> list[list[float]]:
    """The attitudes at the end of every so many of the bodies, in quadruple precision."""
    scene = write_scene(folder, "judged_bodies", every)
    angles, _ = run(scene, processors(), span, "1e-20", "taylor_quadruple")
    return [quaternion_of(three) for three in angles]


def quaternion_of(angles: list[float]) -> list[float]:
    """Turn Euler's angles z-x-z into a quaternion."""
    phi, theta, psi = angles
    plus, minus = (phi + psi) / 2, (phi - psi) / 2
    upper, lower = math.cos(theta / 2), math.sin(theta / 2)
    return [upper * math.cos(plus), lower * math.cos(minus),
            lower * math.sin(minus), upper * math.sin(plus)]  # fmt: skip


def judge(found: list[list[float]], right: list[list[float]]) -> Errors:
    """Errors of attitudes at the end, as quaternions."""
    errors = sorted(map(angle_between, found, right))
    median, most = (errors[math.ceil(share * len(errors)) - 1] for share in (0.5, 0.99))
    return Errors(median, most, errors[-1])
