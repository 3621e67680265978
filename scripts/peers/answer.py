"""What a peer finds, and how its time is taken."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

LEAST_REPEATS, MOST_REPEATS = 5, 1000
ENOUGH, LONG = 0.05, 2.0
"""Seconds: repeats end after the first, and there are fewer of runs that take the second."""

DECADES = tuple(float(f"1e-{digits}") for digits in range(3, 16))
"""Tolerances of peers that are cheap to run."""

HALF_DECADES = (1e-10, 3e-11, 1e-11, 3e-12, 1e-12, 3e-13, 1e-13)
"""Tolerances of many bodies at once, where rates at an error are compared."""


@dataclass(frozen=True)
class Answer:
    """The attitude at the end, what it took, and the least time of a run in seconds."""

    quaternion: list[float]
    time_s: float
    steps: float = math.nan
    rejected: float = math.nan
    evaluations: float = math.nan


@dataclass(frozen=True)
class BatchAnswer:
    """Attitudes at the end of every so many of the bodies, and the least time of all, seconds."""

    ends: list[list[float]]
    time_s: float


def least_time(run: Callable[[], None], before: Callable[[], None] = lambda: None) -> float:
    """The least time of several runs after a first, each after what is to be done before.

    peers/least_time.h does the same for those in C.
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
