"""heyoka: adaptive Taylor series, compiled for the equations; compiling them is not counted.

Constants are numbers in the compiled code, which is not compact and may reorder sums: its fastest
way.
"""

from peers.answer import DECADES, Answer, least_time
from peers.equations import EQUATIONS, python_rates
from peers.problem import Problem

try:
    import heyoka
except ImportError:
    heyoka = None

NAME = "heyoka"
METHODS = ("heyoka",)
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
DEBIAN: tuple[str, ...] = ()
SETTING = "tolerance"
SETTINGS = (*DECADES[::2], 1e-16)
COMPILED: dict[tuple, object] = {}
"""By equations, their constants and tolerance: problems that differ in time share one."""


def absence() -> str:
    """Why it cannot be had."""
    return "" if heyoka else "the Python package heyoka is not installed"


def versions() -> str:
    """What is used."""
    return f"heyoka {heyoka.__version__} (compact_mode=False, fast_math=True)"


def integrator(formulation: str, constants: list[float], tolerance: float) -> object:
    """The compiled integrator."""
    key = (formulation, *constants, tolerance)
    if key not in COMPILED:
        states = heyoka.make_vars(*EQUATIONS[formulation].states)
        rates = python_rates(EQUATIONS[formulation], constants)(0.0, states)
        COMPILED[key] = heyoka.taylor_adaptive(
            list(zip(states, rates, strict=True)),
            [0.0] * len(states),
            tol=max(tolerance, 2.3e-16),
            compact_mode=False,
            fast_math=True,
        )
    return COMPILED[key]


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance. A function evaluation is a coefficient of the series, as in spintop."""
    form = EQUATIONS[formulation]
    constants, start = form.start(problem)
    solver = integrator(formulation, constants, setting)
    found = []

    def before() -> None:
        solver.time = 0.0
        solver.state[:] = start

    def run() -> None:
        found[:] = solver.propagate_until(problem.t_end)

    seconds = least_time(run, before)
    if found[0] != heyoka.taylor_outcome.time_limit:
        raise ArithmeticError(str(found[0]))
    steps = int(found[3])
    q = form.attitude(problem, solver.state.tolist())
    return Answer(q, seconds, steps, 0, steps * solver.order)
