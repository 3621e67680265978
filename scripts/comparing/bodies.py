"""Many bodies at once: a sweep of damped bodies without symmetry, by spintop and by others.

Each of ten thousand bodies has a different inertia. They start near the upright with spins from 0.5
to 20 rad/s. Slow bodies fall, and amplify the errors of the steps up to ten million times. All
programs take turns, round after round; what counts is the least time of each.
"""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from comparing.problem import Problem, angle_between, as_list
from program import ProgramError, processors, run_sweep

CASES = 10000
INERTIA = (0.875, 0.7, 0.25)
MASS, GRAVITY = 2.0, 9.81
CENTRE = (0.021650635094610966, -0.012990381056766580, 0.43227658029900259)
DAMPING = (0.01, 0.01, 0.005)
START = (math.cos(math.pi / 32), math.sin(math.pi / 32), 0.0, 0.0)
ANGLES = ("phi_end", "theta_end", "psi_end")
SCENE = f"""\
! Damped bodies without symmetry, started near the upright: written by scripts/compare.

&study  kind = 'sweep' /
&top
    mass = {MASS}
    gravity = {GRAVITY}
    centre_of_mass = {as_list(CENTRE)}
    damping = {as_list(DAMPING)}
/
&initial  quaternion = {as_list(START)}  omega = 0, 0, 1 /
&span  t_end = 7 /
&integration  relative_tolerance = 1e-10  absolute_tolerance = 1e-10 /
&output  columns = 'theta_end', 'phi_end', 'psi_end' /
&sweep  table = 'TABLE' /
"""


def inertia_of(k: int) -> list[float]:
    """The moments of inertia of body k, counted from zero."""
    shares = math.sin(k), math.sin(1.7 * k + 1), math.sin(2.3 * k + 2)
    return [own * (1 + 0.02 * share) for own, share in zip(INERTIA, shares, strict=True)]


def spin_of(k: int) -> float:
    """The spin of body k at the start, rad/s."""
    return 0.5 * 40 ** (k / (CASES - 1))


def problems(t_end: float) -> Iterator[Problem]:
    """All bodies as problems, whose ends are not known."""
    for k in range(CASES):
        inertia, omega = tuple(inertia_of(k)), (0.0, 0.0, spin_of(k))
        yield Problem("", MASS, GRAVITY, CENTRE, inertia, START, omega, t_end, DAMPING)


def write_scene(folder: Path, name: str, every: int) -> Path:
    """Write the input with every so many of the bodies, and its table of parameters."""
    cases, scene = folder / f"{name}_cases.csv", folder / f"{name}.nml"
    with cases.open("w", encoding="ascii", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*(f"top.inertia({i})" for i in (1, 2, 3)), "initial.omega(3)"])
        table.writerows([*inertia_of(k), spin_of(k)] for k in range(0, CASES, every))
    scene.write_text(SCENE.replace("TABLE", cases.name), encoding="ascii")
    return scene


def run(
    scene: Path, threads: int, t_end: float, tolerance: float, method: str = "taylor"
) -> tuple[list[list[float]], float]:
    """Run the sweep, and give the attitudes at the ends and the seconds of computing."""
    settings = (
        f"span.t_end={t_end}",
        f"integration.method={method}",
        *(f"integration.{kind}_tolerance={tolerance}" for kind in ("relative", "absolute")),
    )
    seconds = run_sweep(scene, threads, settings, scene.parent)["computing"]
    with scene.with_suffix(".csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        ends = [quaternion_of(*(float(row[name]) for name in ANGLES)) for row in rows]
    if not all(math.isfinite(part) for q in ends for part in q):
        raise ProgramError(f"{scene}: some bodies have no end")
    return ends, seconds


def run_reference(folder: Path, t_end: float, every: int) -> list[list[float]]:
    """The attitudes at the end of every so many of the bodies, in quadruple precision."""
    scene = write_scene(folder, "judged_bodies", every)
    return run(scene, processors(), t_end, 1e-20, "taylor_quadruple")[0]


def quaternion_of(phi: float, theta: float, psi: float) -> list[float]:
    """Turn Euler's angles z-x-z into a quaternion."""
    plus, minus = (phi + psi) / 2, (phi - psi) / 2
    upper, lower = math.cos(theta / 2), math.sin(theta / 2)
    return [upper * math.cos(plus), lower * math.cos(minus),
            lower * math.sin(minus), upper * math.sin(plus)]  # fmt: skip


def judge(found: list[list[float]], right: list[list[float]]) -> dict[str, float]:
    """Errors of attitudes at the end: median, 99th percentile and maximum, rad."""
    errors = sorted(map(angle_between, found, right))
    median, most = (errors[math.ceil(share * len(errors)) - 1] for share in (0.5, 0.99))
    return {"median": median, "most": most, "largest": errors[-1]}
