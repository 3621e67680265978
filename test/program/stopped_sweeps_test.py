"""What a sweep says of motions that an event ends is what it says of motions that end then."""

import numpy as np
import pytest

from conftest import each, output

SWEEP = "&study kind = 'sweep' /\n&sweep parameter = 'initial.omega3'  values(1,:) = {} /\n"
START = "&initial theta_deg = 30  phi_rate = 0.5 /\n"
SYMMETRIC = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
ANY = "&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0, 0.5 /\n"
STOP = "stop_at = 'turning_points'  stop_after = 3"


@each("body", SYMMETRIC, ANY)
@each("method", "auto", "taylor", "dop853")
def test_growth_to_the_event(spin, body, method):
    columns = ["t_end", "largest_singular_value", "lyapunov_exponent"]
    if body == SYMMETRIC:
        columns += ["inherent_error"]
    text = f"{body}{START}&integration method = '{method}' /\n{SWEEP.format(3)}"
    stopping = f"{text}&span t_end = 9  {STOP} /\n"
    (stopped,) = spin(stopping + output(*columns)).rows[columns].to_numpy()
    assert stopped[0] < 8
    whole = spin(f"{text}&span t_end = {float(stopped[0])!r} /\n" + output(*columns)).rows
    assert whole[columns].to_numpy()[0] == pytest.approx(stopped, rel=1e-6)
    alone = spin(stopping + output(columns[1])).rows
    assert alone[columns[1]][0] == stopped[1]


def test_the_turning_point_at_the_end_counts(spin):
    """On whichever side of the end rounding errors put it."""
    spins = ", ".join(str(5 + 0.19 * k) for k in range(60))
    text = f"{ANY}{START}{SWEEP.format(spins)}&span t_end = 40  {STOP} /\n"
    text += output("nutation_period", "precession_per_nutation", "motion_class")
    methods = ("taylor", 1e-9), ("taylor", 1e-12), ("dop853", 1e-10), ("dop853", 1e-12)
    how = "&integration method = '{}'  relative_tolerance = {} /\n"
    first, *others = (spin(text + how.format(*method)).rows for method in methods)
    for other in others:
        assert list(other.motion_class) == list(first.motion_class)
        for name in ("nutation_period", "precession_per_nutation"):
            np.testing.assert_allclose(other[name], first[name], rtol=1e-5, equal_nan=False)


@each("effect", "drag_moment = 3*0.1", "torque_body = 0, 0, 5")
@each("stop", "", STOP)
def test_no_growth_with_effects(spin, effect, stop):
    """The equations of perturbations are those without effects."""
    columns = ["largest_singular_value", "lyapunov_exponent"]
    text = f"{ANY}&effects {effect} /\n{START}&span t_end = 3  {stop} /\n{SWEEP.format(3)}"
    row = spin(text + output(*columns)).rows.iloc[0]
    assert np.isnan(row[columns].astype(float)).all()
    assert "no Lyapunov exponent: it is not measured for bodies with effects" in row.notes
