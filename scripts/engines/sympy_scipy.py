"""The baseline: Euler's equations derived by SymPy, integrated by SciPy's DOP853.

The tolerance of DOP853 is made so large that it takes steps of one size.
"""

import numpy as np
import sympy as sp
from scipy.integrate import DOP853

METHODS = ("DOP853",)


def rates(motion: dict) -> object:
    """The right-hand side, of a quaternion and the angular velocity in the body."""
    q, w = sp.symbols("q:4"), sp.Matrix(sp.symbols("w:3"))
    attitude = sp.Quaternion(*q)
    spin = attitude * sp.Quaternion(0, *w) / 2
    vertical = attitude.to_rotation_matrix().row(2).T
    arm, inertia = sp.Matrix(motion["arm"]), sp.diag(*motion["inertia_at_pivot"])
    weight = -motion["mass"] * motion["gravity"] * vertical
    acceleration = inertia.inv() * (arm.cross(weight) - w.cross(inertia * w))
    result = sp.Matrix([spin.a, spin.b, spin.c, spin.d, *acceleration])
    function = sp.lambdify([(*q, *w)], list(result), "math", cse=True)
    return lambda t, y: function(y)


def prepare(motion: dict, method: str, step: float) -> tuple:
    """A solver with fixed steps, without an estimate of the first one."""
    t_end = motion["t_end"]
    solver = DOP853(rates(motion), 0, [*motion["quaternion"], *motion["omega"]], t_end, rtol=1e6,
                    atol=1e6, first_step=step, max_step=step)  # fmt: skip

    def advance(n: int) -> None:
        for _ in range(n):
            if solver.status == "running":
                solver.step()

    return advance, lambda: np.array(solver.y)
