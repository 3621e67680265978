"""Quantities of sweeps are those of body z as it was given, whatever axes compute them.

A body that is given by an inertia tensor is computed in its principal axes. The rows of its
trajectory are in the axes of the input; their extremes are those of the sweep.
"""

import math

import numpy as np
import pytest

from conftest import each, output

BODY = """\
&top mass = 2  inertia_tensor(1,:) = 0.7, 0.12, -0.1  inertia_tensor(2,2:3) = 0.9, 0.15
     inertia_tensor(3,3) = 0.6  centre_of_mass = 0.1, -0.15, 0.3  {} /
&initial theta = 1  psi = 0.3  phi_rate = 1  psi_rate = 5 /
&span t_end = 4 {} /
&integration relative_tolerance = 1e-12 /
"""
SPAN = "&span t_end = 4 /\n"
SWEEP = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = 4 /\n"
EXTREMES = ["theta_min", "theta_max", "theta_rate_max", "phi_rate_max"]
# A plane swing about the axis (1, 0, 1) of the body, by which body z does not go over the poles.
OBLIQUE = """\
&top mass = 1  inertia = 0.9, 0.5, 0.9  centre_of_mass = 0, 0.4, 0  damping = 3*0.01  {} /
&initial theta_deg = 135  psi_deg = 90  omega = 1, 0, 1 /
&span t_end = 4 {} /
&integration relative_tolerance = 1e-12 /
"""
# Tops in closed form about body x, about body y below the pivot, about none of the body axes.
OLD = "0.9, 0.5, 0.9  centre_of_mass = 0, 0.4, 0  damping = 3*0.01"
SLANTED = OBLIQUE.replace("1, 0, 1 /", "1, 0.3, 1 /")
ABOUT_OTHER_AXES = [
    SLANTED.replace(OLD, moments.replace("at", "centre_of_mass ="))
    for moments in ("0.25, 0.9, 0.9  at 0.8, 0, 0", "0.9, 0.25, 0.9  at 0, -0.8, 0")
]
ABOUT_OTHER_AXES += [
    BODY[: BODY.index("mass = 2")]
    + "mass = 1  inertia_tensor(1,:) = 0.8, 0.1, 0.1  inertia_tensor(2,2:3) = 0.8, 0.1"
    + " inertia_tensor(3,3) = 0.8  centre_of_mass = 3*0.3 {} /\n"
    + BODY[BODY.index("&initial") :]
]


def one(spin, text, *columns):
    (row,) = spin(text + output(*columns)).rows.itertuples()
    return row


@each(
    "body, gravity",
    (BODY, ""),
    (BODY, "gravity = 0"),
    (OBLIQUE, ""),
    *((body, "") for body in ABOUT_OTHER_AXES),
)
def test_extremes(spin, body, gravity):
    """Each alone and all together, against many rows of the trajectory."""
    sweep = body.format(gravity, "") + SWEEP
    found = one(spin, sweep, *EXTREMES)
    for name in EXTREMES:
        alone = one(spin, sweep, name)
        assert getattr(alone, name) == pytest.approx(getattr(found, name), rel=1e-9)
    text = body.format(gravity, "samples = 20001") + output("t", "theta", "theta_rate", "phi_rate")
    rows = spin(text).rows
    assert found.theta_min == pytest.approx(rows.theta.min(), abs=1e-4)
    assert found.theta_max == pytest.approx(rows.theta.max(), abs=1e-6)
    assert found.theta_rate_max == pytest.approx(rows.theta_rate.abs().max(), rel=1e-3)
    if not gravity:
        assert found.phi_rate_max == pytest.approx(max(rows.phi_rate, key=abs), rel=1e-5)


@each("body", *ABOUT_OTHER_AXES)
def test_a_little_asymmetry_changes_little(spin, body):
    """With it there is no closed form, nor axis of symmetry: what a row says is of body z."""
    numbers = [*EXTREMES, "com_z_min", "force_max", "nutation_period", "theta_end"]
    other = body.replace("0.9, 0.9", "0.9, 0.90000001").replace("0.25, 0.9 ", "0.25, 0.90000001 ")
    other = other.replace("(3,3) = 0.8", "(3,3) = 0.80000001")
    assert other != body
    end = SWEEP + output("motion_class", *numbers)
    first, second = (spin(text.format("", "") + end).rows for text in (body, other))
    assert list(first.motion_class) == list(second.motion_class)
    np.testing.assert_allclose(first[numbers], second[numbers], rtol=1e-5, atol=1e-5)


@each("axis", "0.5, 0.9, 0.9", "0.9, 0.5, 0.9")
def test_free_body_about_another_axis(spin, axis):
    """The range of theta for all times does not depend on whether two moments are equal."""
    body = f"&top mass = 1  inertia = {axis}  length = 0 /\n"
    body += f"&initial theta = 1  omega = 1, 2, 3 /\n{SPAN}{SWEEP}"
    other = body.replace("0.9  length", "0.90000000001  length")
    columns = ["theta_min", "theta_max", "momentum_period"]
    found, expected = (spin(text + output(*columns)).rows[columns] for text in (body, other))
    assert found.to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-6)


def test_constants_of_a_free_body(spin):
    sweep = BODY.format("gravity = 0", "") + SWEEP
    constants = ["momentum_period", "momentum_turn", "momentum_turn_geometric", "omega_max"]
    alone = spin(sweep + output(*constants)).rows[constants]
    beside = spin(sweep + output(*constants, "phi_rate_max", "com_z_min")).rows[constants]
    assert alone.to_numpy() == pytest.approx(beside.to_numpy(), rel=1e-14)


@each("latitude", 90, -90)
def test_class_in_a_frame_that_turns(spin, latitude):
    """That of the motion as seen from outside would be another one."""
    text = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    text += f"&initial theta = 0.5  omega3 = 10 /\n{SPAN}{SWEEP}"
    text += f"&effects earth_rate = 0.1  latitude_deg = {latitude} /\n"
    found = one(spin, text, "motion_class")
    assert found.motion_class in ("none", "cusp")
    assert found.notes.startswith("no class") or found.motion_class == "cusp"


@each("frame", 0.1, 6)
@each("start", "theta_rate = 0.5  phi_rate = 1", "phi_rate = 0", "phi_rate = 5")
@each("psi_rate", -10, 3)
def test_precession_in_a_frame_that_turns(spin, frame, start, psi_rate):
    """The rate of either turning point, or one in between, is the largest relative to the frame."""
    body = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    body += f"&initial theta = 0.7  {start}  psi_rate = {psi_rate} /\n"
    body += f"&effects earth_rate = {frame}  latitude_deg = 90 /\n"
    found = one(spin, body + "&span t_end = 9 /\n" + SWEEP, "phi_rate_max").phi_rate_max
    rows = spin(body + "&span t_end = 9  samples = 9001 /\n" + output("t", "phi_rate")).rows
    assert found == pytest.approx(max(rows.phi_rate, key=abs), rel=1e-4)


@each("end", 1.2, 2, 12)
@each("across", "0", "1e-12", "1e-8", "1e-7")
def test_swing_over_poles(spin, end, across):
    """The nutation rate is largest where the body hangs, in a pole: by the energy."""
    text = "&top mass = 1  inertia = 0.9, 0.8, 0.25  length = 0.3 /\n"
    text += f"&initial theta = 1  omega = 1, {across}, 0 /\n&span t_end = {end} /\n"
    found = one(spin, text + SWEEP.replace("= 4", f"= {end}"), "theta_rate_max").theta_rate_max
    largest = math.sqrt(1 + 2 * 9.81 * 0.3 * (1 + math.cos(1)) / 0.9)
    assert found == pytest.approx(largest, abs=1e-6 + 3 * float(across))


@each("method", "taylor", "dop853")
@each("psi", 0, 45, 100)
def test_nutation_rate_from_a_pole(spin, psi, method):
    """That of the start, which is largest here: sin(180 deg) is not zero to a computer."""
    text = "&top mass = 1  inertia = 0.5, 0.7, 0.9  length = 0.8  damping = 0.05, 0.02, 0.01 /\n"
    text += f"&initial theta_deg = 180  psi_deg = {psi}  omega = 1.8, 2.4, 0 /\n{SPAN}"
    text += f"&integration method = '{method}' /\n"
    found = one(spin, text + SWEEP, "theta_rate_max").theta_rate_max
    assert found == pytest.approx(3, rel=1e-9)


@each("rate, kind", (1, "libration"), (6, "circulation"))
def test_class_of_a_swing(spin, rate, kind):
    """A plane motion does not precess, whatever rounding does near the poles."""
    text = "&top mass = 1  inertia = 0.9, 0.8, 0.25  length = 0.3 /\n"
    text += f"&initial theta = 1  omega = {rate}, 0, 0 /\n&span t_end = 12 /\n"
    found = one(spin, text + SWEEP.replace("= 4", "= 12"), "phi_rate_max", "motion_class")
    assert (found.phi_rate_max, found.motion_class) == (0, kind)


def test_force_on_a_balanced_body(spin):
    text = "&top mass = 2  inertia = 0.7, 0.9, 0.6  length = 0 /\n"
    text += f"&initial theta = 1  omega = 1, 2, 3 /\n{SPAN}"
    found = one(spin, text + SWEEP, "force_max", "force_z_min", "force_z_max")
    assert found.status == "ok"
    forces = [found.force_max, found.force_z_min, found.force_z_max]
    assert forces == pytest.approx([2 * 9.81] * 3, rel=1e-12)


def test_a_slow_sleeping_top(spin):
    """Below the threshold the axis has no period, and no spin in one: that is no failure."""
    text = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    text += f"&initial theta = 0  psi_rate = 5 /\n{SPAN}"
    found = one(spin, text + SWEEP, "nutation_period", "spin_per_nutation")
    assert found.status == "ok"
    assert math.isnan(found.nutation_period)
    assert math.isnan(found.spin_per_nutation)


@each("columns", [], ["motion_class"])
def test_precession_of_a_free_top(spin, columns):
    """The axis circles the momentum, and with it the vertical or not: whole turns."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.25  length = 0 /\n"
    text += f"&initial theta = 1  theta_rate = 0.3  psi_rate = 5 /\n{SPAN}&study kind = 'sweep' /\n"
    text += "&sweep parameter = 'initial.phi_rate'  from = -9  to = 9  count = 60 /\n"
    wanted = ["precession_per_nutation", "precession_rate", "nutation_period", "nutations_per_turn"]
    rows = spin(text + output(*wanted, *columns)).rows[wanted].to_numpy()
    for precession, rate, period, per_turn in rows:
        assert precession in (-2 * math.pi, 0, 2 * math.pi)
        assert rate == pytest.approx(precession / period, rel=1e-14)
        assert per_turn == 1 if precession else math.isnan(per_turn)
    assert len(set(rows[:, 0])) == 3
