"""The coverage of the intervals of thousands of fits."""

import os

import numpy as np

import python_library  # noqa: F401
import spintop

FITS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))
TRUTH = {"top.inertia(1)": 0.875, "top.inertia(3)": 0.25, "initial.psi_rate": 14.0}
GIVEN = {"top": {"mass": 1, "inertia": (0.875, 0.875, 0.25), "length": 0.85}}
GIVEN["initial"] = {"theta": 0.6, "theta_rate": 0.3, "psi_rate": 14}
NOISE = 0.002


def test_coverage() -> None:
    """95 % within 1 %, which is 4.6 standard deviations of the count of 10,000 fits."""
    t = np.linspace(0.0, 6.0, 61)
    top = spintop.Top(spintop.Body(**GIVEN["top"]), **GIVEN["initial"])
    truth = dict(top.exact(t, ["phi", "theta", "psi"]))
    source = np.random.default_rng(1)
    covered = np.zeros(len(TRUTH))
    for _ in range(FITS):
        noisy = {name: truth[name] + source.normal(0, NOISE, t.size) for name in truth}
        rows = spintop.fit({"t": t, **noisy}, list(TRUTH), GIVEN).rows
        assert np.all(rows["lower"] < rows["upper"])
        true = np.array(list(TRUTH.values()))
        covered += (rows["lower"] <= true) & (true <= rows["upper"])
    assert np.abs(covered / FITS - 0.95).max() <= (1e4 / FITS) ** 0.5 * 0.01
