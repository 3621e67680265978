"""The method of Gragg, Bulirsch and Stoer for any kind of number, at a fixed order."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

Number = Any
State = np.ndarray
"""Numbers, or in each place an array of numbers."""
Rate = Callable[[Number, State], State]


class Accuracy(NamedTuple):
    """How steps are taken: columns of the table (the order is twice that), error per step.

    Where steps become so short that the span has more than `most` the body has come to rest.
    """

    columns: int
    tolerance: Number
    most: int


def integrate(
    rate: Rate, state: State, times: Sequence[Number], scales: Sequence[Number], accuracy: Accuracy
) -> Iterator[State]:
    """The states at increasing times; the first is the start. `scales` are units of the error."""
    now, step = times[0], (times[-1] - times[0]) / 1000
    least = (times[-1] - times[0]) / accuracy.most
    yield state
    for end in times[1:]:
        while now < end and step > least:
            taken = min(step, end - now)
            trial, error = extrapolated(rate, now, state, taken, scales, accuracy.columns)
            excess = float(error / accuracy.tolerance)
            if excess <= 1:
                now, state = (end if taken == end - now else now + taken), trial
            factor = 0.8 * max(excess, 1e-30) ** (-1 / (2 * accuracy.columns - 1))
            if excess > 1 or taken == step or factor < 1:
                step = taken * int(1000 * min(factor, 4)) / 1000
        now = end
        yield state


def extrapolated(
    rate: Rate, time: Number, state: State, step: Number, scales: Sequence[Number], columns: int
) -> tuple[State, Number]:
    """A step, and its error: midpoint rules of 2, 4, 6 ... parts, extrapolated to none."""
    first = rate(time, state)
    above: list[State] = []
    for j in range(1, columns + 1):
        part = step / (2 * j)
        before, here = state, state + part * first
        for i in range(1, 2 * j):
            before, here = here, before + 2 * part * rate(time + i * part, here)
        row = [(before + here + part * rate(time + step, here)) / 2]
        for k, old in enumerate(above, 1):
            up, down = (j - k) ** 2, j**2 - (j - k) ** 2
            row.append(row[-1] + (row[-1] - old) * up / down)
        above = row
    changes = (abs(x - y) / s for x, y, s in zip(above[-1], above[-2], scales, strict=True))
    return above[-1], max(part for change in changes for part in np.ravel(change))
