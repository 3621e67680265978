"""SciPy: solve_ivp and odeint, with a right-hand side in Python, as its users write it."""

import warnings

from peers.answer import Answer, least_time
from peers.equations import EQUATIONS, python_rates
from peers.problem import Problem

try:
    import scipy
    from scipy.integrate import odeint, solve_ivp
except ImportError:
    scipy = None

NAME = "SciPy"
METHODS = ("scipy_rk45", "scipy_dop853", "scipy_lsoda", "scipy_radau", "scipy_odeint")
FORMULATIONS = ("space_frame", "rigid_body")
DEBIAN: tuple[str, ...] = ()
SETTING = "tolerance"
SETTINGS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13)
SOLVERS = {"scipy_rk45": "RK45", "scipy_dop853": "DOP853", "scipy_lsoda": "LSODA",
           "scipy_radau": "Radau"}  # fmt: skip
MOST_STEPS = 100_000_000


def absence() -> str:
    """Why it cannot be had."""
    return "" if scipy else "the Python package scipy is not installed"


def versions() -> str:
    """What is used."""
    return f"SciPy {scipy.__version__}"


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
    return Answer(q, seconds, int(found["steps"]), evaluations=int(found["evaluations"]))
