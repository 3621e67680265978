"""Fits from Python: what measurements determine, and what they do not."""

import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "python"))

subprocess.run([ROOT / "scripts/install", "--library"], check=True, capture_output=True)

import spintop  # noqa: E402

TRUTH = {"top.inertia(3)": 0.25, "initial.psi_rate": 14.0}
GIVEN = {
    "top": {"mass": 1, "inertia": (0.875, 0.875, 0.26), "length": 0.75**0.5},
    "initial": {"theta": 0.5, "psi_rate": 13.8},
}
NOISE = 1e-3


def measure(*columns: str) -> dict[str, np.ndarray]:
    """Columns of the true motion with noise, rad."""
    body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
    t = np.linspace(0.0, 5.0, 101)
    exact = spintop.Top(body, theta=0.5, psi_rate=14.0).exact(t, list(columns))
    noise = np.random.default_rng(1).normal(0, NOISE, (len(columns), t.size))
    return {"t": t, **{name: exact[name] + noise[i] for i, name in enumerate(columns)}}


class FitTest(unittest.TestCase):
    """Two numbers of a symmetric top."""

    def test_three_angles_determine_them(self) -> None:
        """Estimates within five standard errors of the truth, which fall with the noise."""
        result = spintop.fit(measure("phi", "theta", "psi"), list(TRUTH), GIVEN, sigma=NOISE)
        self.assertTrue(result.ok)
        table = result.rows
        self.assertEqual(list(table["parameter"]), list(TRUTH))
        for truth, estimate, error in zip(
            TRUTH.values(), table["estimate"], table["standard_error"], strict=True
        ):
            self.assertLess(abs(estimate - truth), 5 * error)
            self.assertLess(error, 1e-3)

    def test_two_angles_do_not(self) -> None:
        """phi and theta depend on the product of both numbers only."""
        result = spintop.fit(measure("phi", "theta"), list(TRUTH), GIVEN, sigma=NOISE)
        self.assertFalse(result.ok)
        first, second = result.rows["estimate"]
        # I3 (psi' + phi' cos theta), with no precession at the start.
        self.assertAlmostEqual(first * second, 0.25 * 14, delta=1e-2)

    def test_measurements_without_times(self) -> None:
        """They are refused with a reason."""
        with self.assertRaisesRegex(spintop.InputError, "`t`"):
            spintop.fit({"theta": [0.1, 0.2]}, list(TRUTH), GIVEN)


if __name__ == "__main__":
    unittest.main()
