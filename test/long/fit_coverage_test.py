"""The coverage of the intervals of thousands of fits."""

import os

import numpy as np

import python_library  # noqa: F401
import spintop
from drawn_fits import draw, draw_runs

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


# Drawn measurements: their fits reach the truth, or say that they do not.

DRAWN = int(os.environ.get("SPINTOP_LONG_CASES", "200"))


def test_drawn_fits() -> None:
    """At least 97.5 % reach the truth within 4 standard errors; intervals cover 95 +- 2 %."""
    reached, covered = 0, []
    for number in range(DRAWN):
        case = draw(number)
        result = case.fit(knows_sigma=number % 2 == 0)
        truth = np.array(list(case.truth.values()))
        rows = result.rows
        away = np.abs(rows["estimate"] - truth) / rows["standard_error"]
        near = bool(np.all(away < 4))
        reached += near
        assert near or not result.ok, (number, case.kind, away, result.summary)
        if result.ok:
            covered += ((rows["lower"] <= truth) & (truth <= rows["upper"])).tolist()
    assert reached >= 0.975 * DRAWN
    assert abs(np.mean(covered) - 0.95) < 0.02


# Runs of one wheel, each with noise, a bias, a start and a sampling of its own.

RUNS = int(os.environ.get("SPINTOP_LONG_CASES", "400"))


def test_three_runs() -> None:
    """Intervals of what is common and of what each run has cover the truth in 95 +- 2 %.

    One fit in a hundred may take noise for a motion.
    """
    covered, good = [], 0
    for number in range(RUNS):
        case = draw_runs(number)
        result = case.fit()
        good += result.ok
        rows, truth = result.rows, np.array(list(case.truth.values()))
        assert list(rows["parameter"]) == list(case.truth)
        covered.append((rows["lower"] <= truth) & (truth <= rows["upper"]))
    assert good >= 0.99 * RUNS - 1
    shares = np.mean(covered, axis=0)
    print(f"{RUNS} fits of three runs: {shares.mean():.4f}", *(f"{each:.3f}" for each in shares))
    assert abs(shares.mean() - 0.95) < 0.02
    assert np.abs(shares - 0.95).max() < 4.5 * (0.95 * 0.05 / RUNS) ** 0.5
