"""What a program finds, and how its time is taken."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from comparing.problem import Problem

LEAST_REPEATS, MOST_REPEATS = 5, 1000
ENOUGH, LONG = 0.05, 2.0
"""Seconds: repeats end after the first, and there are fewer of runs that take the second."""
DECADES = tuple(float(f"1e-{digits}") for digits in range(3, 16))
"""Tolerances of programs that are cheap to run."""
LEAST, MOST_ROUNDS = 0.1, 5
"""Steps of an engine are repeated for so many seconds of the processor, or so many times."""


@dataclass(frozen=True)
class Answer:
    """Attitudes, or whole states, what they took, and the least time of a run in seconds.

    The states are those at the samples of a problem, or at the ends of many bodies.
    """

    states: list[list[float]]
    time_s: float
    steps: float = math.nan
    rejected: float = math.nan
    evaluations: float = math.nan


def least_time(run: Callable[[], None], before: Callable[[], None] = lambda: None) -> float:
    """The least time of several runs after a first, each after what is to be done before.

    programs/answer.h does the same for those in C.
    """
    spent, least, repeats = 0.0, math.inf, -1
    while repeats < LEAST_REPEATS or (spent < ENOUGH and repeats < MOST_REPEATS):
        before()
        start = time.perf_counter()
        run()
        taken = time.perf_counter() - start
        repeats += 1
        if repeats > 0 or taken > LONG:
            spent, least = spent + taken, min(least, taken)
        if spent > LONG:
            break
    return least


def step_through(prepare: Callable, problem: Problem, method: str, steps: int) -> Answer:
    """The states at the samples after so many steps; the time is that of the steps alone.

    The first of two runs at least may have to compile. The fastest counts.
    """
    stride = max(round(steps / problem.samples), 1)
    best, states, rounds, spent = math.inf, [], 0, 0.0
    while rounds < 2 or (rounds < MOST_ROUNDS and spent < LEAST):
        advance, state = prepare(problem, method, problem.t_end / (stride * problem.samples))
        states, seconds, begin = [], 0.0, time.process_time()
        for _ in range(problem.samples):
            start = time.process_time()
            advance(stride)
            seconds += time.process_time() - start
            states.append([float(x) for x in state()])
        best, rounds = min(best, seconds), rounds + 1
        spent += time.process_time() - begin
        if spent > LONG:
            break
    return Answer(states, best, stride * problem.samples)
