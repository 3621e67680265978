"""Many bodies at once: a sweep of damped bodies without symmetry, by spintop and by others.

Each of ten thousand bodies has a different inertia. They start near the upright with spins from 0.5
to 20 rad/s. Slow bodies fall, and amplify the errors of the steps up to ten million times. All
programs take turns, round after round; what counts is the least time of each.
"""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from comparing.problem import Problem, angle_between
from program import ProgramError, processors, run_sweep

CASES = 10000
INERTIA = (0.875, 0.7, 0.25)
MASS, GRAVITY = 2.0, 9.81
CENTRE = (0.021650635094610966, -0.012990381056766580, 0.43227658029900259)
DAMPING = (0.01, 0.01, 0.005)
START = (math.cos(math.pi / 32), math.sin(math.pi / 32), 0.0, 0.0)
ANGLES = ("phi_end", "theta_end", "psi_end")


def problems(t_end: float) -> Iterator[Problem]:
    """All bodies as problems, whose ends are not known."""
    for k in range(CASES):
        shares = math.sin(k), math.sin(1.7 * k + 1), math.sin(2.3 * k + 2)
        inertia = (own * (1 + 0.02 * share) for own, share in zip(INERTIA, shares, strict=True))
        omega = (0.0, 0.0, 0.5 * 40 ** (k / (CASES - 1)))
        yield Problem("", MASS, GRAVITY, CENTRE, tuple(inertia), START, omega, t_end, DAMPING)


def write_scene(folder: Path, name: str, every: int) -> Path:
    """Write the input with every so many of the bodies, and its table of parameters."""
    cases, scene = folder / f"{name}_cases.csv", folder / f"{name}.nml"
    some = list(problems(7.0))[::every]
    with cases.open("w", encoding="ascii", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*(f"top.inertia({i})" for i in (1, 2, 3)), "initial.omega(3)"])
        table.writerows([*problem.inertia, problem.omega[2]] for problem in some)
    groups = ["&study kind = 'sweep' /", *some[0].groups(), f"&sweep table = '{cases.name}' /"]
    groups.append(f"&output columns = {', '.join(map(repr, ANGLES))} /")
    scene.write_text("\n".join([*groups, ""]), encoding="ascii")
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
    from spintop_figures.tables.table import read_table  # which programs in their processes lack

    seconds = run_sweep(scene, threads, settings, scene.parent)["computing"]
    rows = read_table(scene.with_suffix(".csv")).rows[list(ANGLES)].to_numpy(float)
    ends = [quaternion_of(*row) for row in rows.tolist()]
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
