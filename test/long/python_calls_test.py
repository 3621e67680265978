"""A million calls from Python: memory does not grow."""

import resource

import pytest

import python_library  # noqa: F401
import spintop

CALLS = 1_000_000
MOST_GROWTH = 1000
"""Growth of the memory of the process, kB: a leak of one pointer per call would be 8000."""


def test_exact() -> None:
    """The exact solution at one time, and each hundredth time a call that fails."""
    body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
    top = spintop.Top(body, theta=0.2, psi_rate=1.0)

    def use(calls: int) -> int:
        for i in range(calls):
            top.exact(1e-5 * i)
            if i % 100 == 0:
                with pytest.raises(spintop.InputError):
                    top.exact(float("nan"))
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = use(CALLS // 20)
    assert use(CALLS) - before < MOST_GROWTH
