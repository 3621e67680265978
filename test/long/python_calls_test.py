"""A million calls from Python: memory does not grow."""

import resource
import unittest

import python_library  # noqa: F401
import spintop

CALLS = 1_000_000
MOST_GROWTH = 1000
"""Growth of the memory of the process, kB: a leak of one pointer per call would be 8000."""


class CallsTest(unittest.TestCase):
    """One top, again and again."""

    def test_exact(self) -> None:
        """The exact solution at one time, and each hundredth time a call that fails."""
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
        top = spintop.Top(body, theta=0.2, psi_rate=1.0)

        def use(calls: int) -> None:
            for i in range(calls):
                top.exact(1e-5 * i)
                if i % 100 == 0:
                    with self.assertRaises(spintop.InputError):
                        top.exact(float("nan"))

        use(CALLS // 20)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        use(CALLS)
        growth = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        self.assertLess(growth, MOST_GROWTH)
