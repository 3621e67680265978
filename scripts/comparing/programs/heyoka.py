"""heyoka: adaptive Taylor series, compiled for the equations; compiling them is not counted.

Constants are numbers in the compiled code, which is not compact: its fastest way. It is compiled
with fast_math, which may reorder sums, and without: the methods `heyoka_fast` and `heyoka`. The
better one of both counts.
"""

import time
from pathlib import Path

import heyoka
import numpy as np

from comparing.answer import DECADES, Answer, least_time
from comparing.bodies import problems
from comparing.equations import EQUATIONS, RIGID_BODY, python_rates
from comparing.problem import Problem

VERSIONS = f"heyoka {heyoka.__version__} (compact_mode=False; heyoka_fast: fast_math=True)"
METHODS = ("heyoka", "heyoka_fast")
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
SETTINGS = (*DECADES, 1e-16)
CPU = Path("/proc/cpuinfo")
WIDE = CPU.exists() and "avx512f" in CPU.read_text(encoding="utf-8")
"""Whether the processor has vectors of eight, which heyoka does not use by itself."""
SIZE = 8 if WIDE else 4
BATCHES = (f"heyoka_{SIZE}", f"heyoka_fast_{SIZE}")
"""So many bodies at once; twice as many were no faster, and half as many slower."""
BATCH_REPEATS = 3
COMPILED: dict[tuple, object] = {}
"""By method, equations, their constants and tolerance: problems that differ in time share one."""


def integrator(method: str, formulation: str, constants: list, tolerance: float) -> object:
    """The compiled integrator, of a batch if a constant is a parameter."""
    key = (method, formulation, *map(str, constants), tolerance)
    if key not in COMPILED:
        states = heyoka.make_vars(*EQUATIONS[formulation].states)
        rates = python_rates(EQUATIONS[formulation], constants)(0.0, states)
        equations = list(zip(states, rates, strict=True))
        how = {"tol": max(tolerance, 2.3e-16), "compact_mode": False, "fast_math": "fast" in method}
        parameters = sum(not isinstance(value, float) for value in constants)
        if parameters:
            how |= {"pars": np.zeros((parameters, SIZE)), "force_avx512": WIDE}
            start = np.zeros((len(states), SIZE))
            COMPILED[key] = heyoka.taylor_adaptive_batch(equations, start, **how)
        else:
            COMPILED[key] = heyoka.taylor_adaptive(equations, [0.0] * len(states), **how)
    return COMPILED[key]


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance. A function evaluation is a coefficient of the series, as in spintop."""
    form = EQUATIONS[formulation]
    constants, start = form.start(problem)
    solver = integrator(method, formulation, constants, setting)
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
    return Answer([q], seconds, steps, 0, steps * solver.order)


def solve_batch(t_end: float, every: int, method: str, setting: float) -> Answer:
    """Solve the many bodies to a tolerance, batch after batch.

    The constants that differ between the bodies are parameters. The calls from Python are not
    counted: their time is that of motions that end at once.
    """
    bodies = [RIGID_BODY.start(problem) for problem in problems(t_end)]
    each = list(zip(*(constants for constants, _ in bodies), strict=True))
    varied = [i for i, values in enumerate(each) if len(set(values)) > 1]
    shared = [heyoka.par[varied.index(i)] if i in varied else values[0]
              for i, values in enumerate(each)]  # fmt: skip
    solver = integrator(method, "rigid_body", shared, setting)
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
    return Answer([RIGID_BODY.attitude(None, y.tolist()) for y in states[::every]], seconds - calls)


def in_batches(rows: list[list[float]]) -> list[object]:
    """Arrays of as many columns as a batch has; the last body fills up the last one."""
    rows = rows + [rows[-1]] * (-len(rows) % SIZE)
    columns = np.array(rows).T
    return [np.ascontiguousarray(columns[:, i : i + SIZE]) for i in range(0, len(rows), SIZE)]
