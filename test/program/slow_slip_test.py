"""Slow departures from rest under dry friction and slow returns to it, against closed forms.

A body without weight turns about its own axis, I3 = 0.3, under the torque
M (1 + d) - k (t - t0)^2 against the dry moment M. With a = sqrt(d M/k) it departs at t0 - a, comes
to rest again at t0 + 2 a, and has turned by 9/4 k a^4/I3 then. A spline through rows of a parabola
is the parabola.
"""

import csv
import math
import os
import subprocess
from pathlib import Path

import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
DRY, CURVATURE, INERTIA = 0.5, 0.0125, 0.3


def move(folder: Path, effects: str, method: str) -> list[tuple[str, float, float]]:
    """Compute a motion; its events with time and psi."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0 /\n"
    text += "&initial theta = 1  omega = 0, 0, 0 /\n&span t_end = 10 /\n"
    text += f"&effects friction_torque = {DRY!r}  {effects} /\n&integration {method} /\n"
    text += "&output columns = 't', 'psi'  events = 'stuck', 'slip' /\n"
    (folder / "scene.nml").write_text(text)
    done = subprocess.run(
        [EXE, "--quiet", "-o", folder, folder / "scene.nml"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = (folder / "scene.events.csv").read_text().splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [(row["event"], float(row["t"]), float(row["psi"])) for row in rows]


@pytest.mark.parametrize("beyond", [0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("peak", [4.3, 5.0])
@pytest.mark.parametrize(
    "method",
    [
        "method = 'taylor'",
        "method = 'taylor'  relative_tolerance = 1e-13",
        "method = 'dop853'",
        "method = 'taylor_quadruple'",
    ],
)
def test_short_departure(folder: Path, method: str, peak: float, beyond: float) -> None:
    """However little the torque exceeds the friction, the body departs, and comes to rest."""
    rows = [f"{t},0,0,{DRY * (1 + beyond) - CURVATURE * (t - peak) ** 2!r}" for t in (0, 3, 6, 10)]
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + "\n".join(rows) + "\n")
    events = move(folder, "torque_table = 'torque.csv'  torque_interpolation = 'spline'", method)
    half = math.sqrt(beyond * DRY / CURVATURE)
    assert [event[0] for event in events] == ["slip", "stuck"]
    # Rounding of the torque over its slope; the tolerance, in radians, over a small rate.
    rounding = 1e-15 / (2 * CURVATURE * half)
    assert events[0][1] == pytest.approx(peak - half, abs=rounding)
    assert events[1][1] == pytest.approx(peak + 2 * half, abs=2e-5 * half + 10 * rounding)
    turned = 9 / 4 * CURVATURE * half**4 / INERTIA
    assert events[1][2] - events[0][2] == pytest.approx(turned, rel=1e-5)
