"""SciPy: solve_ivp and odeint, with a right-hand side in Python, as its users write it.

As an engine it is the baseline: the equations of a rigid body in DOP853, whose tolerance is made so
large that it takes steps of one size.
"""

import warnings

import scipy
from scipy.integrate import DOP853, odeint, solve_ivp

from comparing.answer import Answer, least_time
from comparing.equations import EQUATIONS, RIGID_BODY, python_rates
from comparing.problem import Problem

VERSIONS = f"SciPy {scipy.__version__}"
SOLVERS = {"scipy_rk45": "RK45", "scipy_dop853": "DOP853", "scipy_lsoda": "LSODA",
           "scipy_radau": "Radau"}  # fmt: skip
METHODS = (*SOLVERS, "scipy_odeint")
FORMULATIONS = ("space_frame", "rigid_body")
SETTINGS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13)
STEPPERS = ("DOP853",)
MOST_STEPS = 100_000_000


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance, absolute and relative."""
    form = EQUATIONS[formulation]
    constants, start = form.start(problem)
    rates = python_rates(form, constants, "y.tolist()")
    span, found = (0.0, problem.t_end), {}

    def run() -> None:
        if method == "scipy_odeint":
            y, info = odeint(rates, start, span, tfirst=True, rtol=setting, atol=setting,
                             mxstep=MOST_STEPS, full_output=True)  # fmt: skip
            found.update(y=y[-1], steps=info["nst"][-1], evaluations=info["nfe"][-1])
        else:
            result = solve_ivp(rates, span, start, SOLVERS[method], rtol=setting, atol=setting)
            if not result.success:
                raise ArithmeticError(result.message)
            found.update(y=result.y[:, -1], steps=len(result.t) - 1, evaluations=result.nfev)

    warnings.simplefilter("ignore")
    seconds = least_time(run)
    q = form.attitude(problem, found["y"].tolist())
    return Answer([q], seconds, int(found["steps"]), evaluations=int(found["evaluations"]))


def prepare(problem: Problem, method: str, step: float) -> tuple:
    """A solver with fixed steps, without an estimate of the first one."""
    constants, start = RIGID_BODY.start(problem)
    rates = python_rates(RIGID_BODY, constants, "y.tolist()")
    solver = DOP853(rates, 0, start, problem.t_end, rtol=1e6, atol=1e6, first_step=step,
                    max_step=step)  # fmt: skip

    def advance(n: int) -> None:
        for _ in range(n):
            if solver.status == "running":
                solver.step()

    def state() -> list[float]:
        return [*solver.y[3:], *(solver.y[:3] / problem.inertia)]

    return advance, state
