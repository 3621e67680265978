"""spintop among the engines: the closed-form solution, and Taylor series at several tolerances."""

import spintop
from comparing.answer import Answer, least_time
from comparing.problem import Problem
from spintop.library import library

STEPPERS = ("exact", "taylor")
OWN_SETTINGS = {"exact": (0.0,), "taylor": tuple(10.0**-k for k in range(2, 15))}
"""Tolerances in place of steps."""
COLUMNS = ["q0", "q1", "q2", "q3", "omega1", "omega2", "omega3"]
VERSIONS = "spintop of this checkout"
library()  # an ImportError says how to make it


def step(problem: Problem, method: str, setting: float) -> Answer:
    """All samples in one call."""
    body = spintop.Body(mass=problem.mass, inertia=problem.inertia, centre_of_mass=problem.arm,
                        gravity=problem.gravity)  # fmt: skip
    top = spintop.Top(body, quaternion=problem.quaternion, omega=problem.omega)
    times = [problem.t_end * i / problem.samples for i in range(problem.samples + 1)]
    keys = {"method": method, "relative_tolerance": setting}
    move, keys = (top.exact, {}) if method == "exact" else (top.integrate, keys)
    seconds = least_time(lambda: move(times, COLUMNS, **keys))
    found = move(times, COLUMNS, **keys)
    rows = zip(*(found[name] for name in COLUMNS), strict=True)
    return Answer([[float(x) for x in row] for row in rows][1:], seconds)
