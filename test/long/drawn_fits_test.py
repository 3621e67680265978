"""Two hundred fits of drawn measurements: they reach the truth, or say that they do not."""

import os

import numpy as np

from drawn_fits import draw

FITS = int(os.environ.get("SPINTOP_LONG_CASES", "200"))


def test_drawn_fits() -> None:
    """At least 97.5 % reach the truth within 4 standard errors; intervals cover 95 +- 2 %."""
    reached, covered = 0, []
    for number in range(FITS):
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
    assert reached >= 0.975 * FITS
    assert abs(np.mean(covered) - 0.95) < 0.02
