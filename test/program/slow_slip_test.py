"""Slow departures from rest under dry friction and slow returns to it, against closed forms.

A body without weight turns about its own axis, I3 = 0.3, under the torque
M (1 + d) - k (t - t0)^2 against the dry moment M. With a = sqrt(d M/k) it departs at t0 - a, comes
to rest again at t0 + 2 a, and has turned by 9/4 k a^4/I3 then. A spline through rows of a parabola
is the parabola.
"""

import math

import pytest

DRY, CURVATURE, INERTIA = 0.5, 0.0125, 0.3
SCENE = (
    "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0 /\n&initial theta = 1  omega = 0, 0, 0 /\n"
    f"&span t_end = 10 /\n&effects friction_torque = {DRY!r}  torque_table = 'torque.csv'"
    "  torque_interpolation = 'spline' /\n"
    "&output columns = 't', 'psi'  events = 'stuck', 'slip' /\n"
)


@pytest.mark.parametrize("beyond", [0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("peak", [4.3, 5.0])
@pytest.mark.parametrize("method", ["taylor", "dop853", "taylor_quadruple"])
@pytest.mark.parametrize("absolute", [1e-12, 1e-16])
def test_short_departure(spin, absolute, method, peak, beyond):
    """However little the torque exceeds the friction, the body departs, and comes to rest.

    The absolute tolerance is that of the angular velocity, rad/s, as the dry moment gives a rate
    of about 1 rad/s; over the deceleration before the rest it is an error of the time.
    """
    rows = [f"{t},0,0,{DRY * (1 + beyond) - CURVATURE * (t - peak) ** 2!r}" for t in (0, 3, 6, 10)]
    integration = f"&integration method = '{method}'  absolute_tolerance = {absolute} /\n"
    events = spin(SCENE + integration, torque="\n".join(["t,m1,m2,m3", *rows, ""])).table("events")
    half = math.sqrt(beyond * DRY / CURVATURE)
    assert list(events.event) == ["slip", "stuck"]
    # Rounding of the torque over its slope; the tolerance over the deceleration.
    rounding = 1e-15 / (2 * CURVATURE * half)
    error = 10 * rounding + 1e-8 * half + absolute / (3 * CURVATURE * half**2 / INERTIA)
    assert events.t[0] == pytest.approx(peak - half, abs=rounding)
    assert events.t[1] == pytest.approx(peak + 2 * half, abs=error)
    turned = 9 / 4 * CURVATURE * half**4 / INERTIA
    assert events.psi[1] - events.psi[0] == pytest.approx(turned, rel=1e-5, abs=3 * half * absolute)
