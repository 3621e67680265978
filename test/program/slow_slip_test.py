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
@pytest.mark.parametrize("method", ["taylor", "dop853", "taylor_quadruple"])
@pytest.mark.parametrize("absolute", [1e-12, 1e-16])
def test_short_departure(
    folder: Path, absolute: float, method: str, peak: float, beyond: float
) -> None:
    """However little the torque exceeds the friction, the body departs, and comes to rest.

    The absolute tolerance is that of the angular velocity, rad/s, as the dry moment gives a rate
    of about 1 rad/s; over the deceleration before the rest it is an error of the time.
    """
    rows = [f"{t},0,0,{DRY * (1 + beyond) - CURVATURE * (t - peak) ** 2!r}" for t in (0, 3, 6, 10)]
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + "\n".join(rows) + "\n")
    integration = f"method = '{method}'  absolute_tolerance = {absolute}"
    effects = "torque_table = 'torque.csv'  torque_interpolation = 'spline'"
    events = move(folder, effects, integration)
    half = math.sqrt(beyond * DRY / CURVATURE)
    assert [event[0] for event in events] == ["slip", "stuck"]
    # Rounding of the torque over its slope; the tolerance over the deceleration.
    rounding = 1e-15 / (2 * CURVATURE * half)
    error = 10 * rounding + 1e-8 * half + absolute / (3 * CURVATURE * half**2 / INERTIA)
    assert events[0][1] == pytest.approx(peak - half, abs=rounding)
    assert events[1][1] == pytest.approx(peak + 2 * half, abs=error)
    turned = 9 / 4 * CURVATURE * half**4 / INERTIA
    assert events[1][2] - events[0][2] == pytest.approx(turned, rel=1e-5, abs=3 * half * absolute)
