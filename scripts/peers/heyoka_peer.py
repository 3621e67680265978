"""heyoka: adaptive Taylor series, compiled for the equations; compiling them is not counted.

Constants are numbers in the compiled code, which is not compact: its fastest way. It is compiled
with fast_math, which may reorder sums, and without: the methods `heyoka_fast` and `heyoka`. The
better one of both counts.
"""

import time
from pathlib import Path

from peers.answer import DECADES, Answer, BatchAnswer, least_time
from peers.bodies import problems
from peers.equations import EQUATIONS, RIGID_BODY, python_rates
from peers.problem import Problem

try:
    import heyoka
    import numpy as np
except ImportError:
    heyoka = None

NAME = "heyoka"
METHODS = ("heyoka", "heyoka_fast")
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
DEBIAN: tuple[str, ...] = ()
SETTING = "tolerance"
SETTINGS = (*DECADES, 1e-16)
CPU = Path("/proc/cpuinfo")
WIDE = CPU.exists() and "avx512f" in CPU.read_text(encoding="utf-8")
"""Whether the processor has vectors of eight, which heyoka does not use by itself."""
SIZE = 8 if WIDE else 4
BATCHES = (f"heyoka_{SIZE}", f"heyoka_fast_{SIZE}")
"""So many bodies at once; twice as many were no faster, and half as many slower."""
BATCH_REPEATS = 3
COMPILED: dict[tuple, object] = {}
"""By equations, their constants and tolerance: problems that differ in time share one."""


def absence() -> str:
    """Why it cannot be had."""
    return "" if heyoka else "the Python package heyoka is not installed"


def versions() -> str:
    """What is used."""
    return f"heyoka {heyoka.__version__} (compact_mode=False; heyoka_fast: fast_math=True)"


def is_fast(method: str) -> bool:
    """Whether a method is compiled with fast_math."""
    return "fast" in method


def integrator(
    formulation: str, constants: list[float], tolerance: float, fast_math: bool
) -> object:
    """The compiled integrator."""
    key = (formulation, *constants, tolerance, fast_math)
    if key not in COMPILED:
        states = heyoka.make_vars(*EQUATIONS[formulation].states)
        rates = python_rates(EQUATIONS[formulation], constants)(0.0, states)
        COMPILED[key] = heyoka.taylor_adaptive(
            list(zip(states, rates, strict=True)),
            [0.0] * len(states),
            tol=max(tolerance, 2.3e-16),
            compact_mode=False,
            fast_math=fast_math,
        )
    return COMPILED[key]


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance. A function evaluation is a coefficient of the series, as in spintop."""
    form = EQUATIONS[formulation]
    constants, start = form.start(problem)
    solver = integrator(formulation, constants, setting, is_fast(method))
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


def batch_integrator(tolerance: float, fast_math: bool) -> tuple[object, list[int]]:
    """The compiled integrator of a batch, and which constants it has as parameters.

    They are those that differ between the bodies; the others are numbers in the code.
    """
    several = [RIGID_BODY.start(problem)[0] for problem in problems(1.0)]
    varied = [i for i, values in enumerate(zip(*several, strict=True)) if len(set(values)) > 1]
    constants = list(several[0])
    for place, i in enumerate(varied):
        constants[i] = heyoka.par[place]
    key = ("batch", tolerance, fast_math)
    if key not in COMPILED:
        states = heyoka.make_vars(*RIGID_BODY.states)
        rates = python_rates(RIGID_BODY, constants)(0.0, states)
        COMPILED[key] = heyoka.taylor_adaptive_batch(
            list(zip(states, rates, strict=True)),
            np.zeros((len(states), SIZE)),
            pars=np.zeros((len(varied), SIZE)),
            tol=max(tolerance, 2.3e-16),
            compact_mode=False,
            fast_math=fast_math,
            force_avx512=WIDE,
        )
    return COMPILED[key], varied


def solve_batch(t_end: float, every: int, method: str, setting: float) -> BatchAnswer:
    """Solve the many bodies to a tolerance, batch after batch.

    The calls from Python are not counted: their time is that of motions that end at once.
    """
    solver, varied = batch_integrator(setting, is_fast(method))
    bodies = [RIGID_BODY.start(problem) for problem in problems(t_end)]
    pars = in_batches([[constants[i] for i in varied] for constants, _ in bodies])
    starts = in_batches([start for _, start in bodies])
    ends: list[object] = []

    def run(t: float) -> float:
        began = time.process_time()
        ends.clear()
        for par, start in zip(pars, starts, strict=True):
            solver.set_time(0.0)
            solver.pars[:] = par
            solver.state[:] = start
            solver.propagate_until(t)
            ends.append(solver.state.copy())
        return time.process_time() - began

    calls = min(run(0.0) for _ in range(BATCH_REPEATS))
    seconds = min(run(t_end) for _ in range(BATCH_REPEATS))
    states = np.concatenate(ends, axis=1)[:, : len(bodies)].T
    quaternions = [RIGID_BODY.attitude(None, state.tolist()) for state in states[::every]]
    return BatchAnswer(quaternions, seconds - calls)


def in_batches(rows: list[list[float]]) -> list[object]:
    """Arrays of as many columns as a batch has; the last body fills up the last one."""
    rows = rows + [rows[-1]] * (-len(rows) % SIZE)
    columns = np.array(rows).T
    return [np.ascontiguousarray(columns[:, i : i + SIZE]) for i in range(0, len(rows), SIZE)]
