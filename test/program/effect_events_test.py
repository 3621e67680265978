"""The events stuck, slip and knot: rest under dry friction, departure, and rows of a table.

A body without weight turns about its own axis: I3 = 0.3, dry moment 0.25. The torque about the
axis grows by 0.1 N m/s to 0.4 N m at t = 4, and then falls at the same rate: the body departs at
2.5 s, and comes to rest again.
"""

import math

import numpy as np
import pytest

from conftest import each, largest

BODY = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0 /\n"
TABLE = "t,m1,m2,m3\n0,0,0,0\n4,0,0,0.4\n12,0,0,-0.4\n"
DRIVEN = (
    BODY + "&initial omega = 0, 0, 0  theta = 1 /\n&span t_end = 10 {} /\n"
    "&effects friction_torque = 0.25  torque_table = 'torque.csv' /\n"
    "&integration {} /\n&output columns = {} /\n"
)
SLIP, STUCK = 2.5, 5.5 + math.sqrt(4.5)


@each("method", "taylor", "dop853", "ode45")
def test_departure_and_rest(spin, method):
    wanted = "'t', 'omega3'  events = 'stuck', 'slip', 'knot', 'omega3 = 0.375'"
    text = DRIVEN.format("", f"method = '{method}'  relative_tolerance = 1e-12", wanted)
    events = spin(text, torque=TABLE).table("events")
    names = ["slip", "knot", "omega3=0.375 rising", "omega3=0.375 falling", "stuck"]
    assert sorted(events.event) == sorted(names)
    assert events.t.is_monotonic_increasing
    at = dict(zip(events.event, events.t, strict=True))
    assert at["slip"] == pytest.approx(SLIP, abs=1e-13)
    assert at["knot"] == 4
    assert at["stuck"] == pytest.approx(STUCK, abs=1e-9)
    assert at["omega3=0.375 falling"] == pytest.approx(4 + 3, abs=1e-9)


def test_fixed_steps(spin):
    wanted = "'t'  events = 'stuck', 'slip', 'knot'"
    text = DRIVEN.format("", "method = 'gauss_8'  steps = 1111", wanted)
    at = spin(text, torque=TABLE).table("events").set_index("event").t
    assert at["knot"] == 4
    assert at["slip"] == pytest.approx(SLIP, abs=10 / 1111)
    assert at["stuck"] == pytest.approx(STUCK, abs=2 * 10 / 1111)


@each("event, end", ("stuck", STUCK), ("slip", SLIP), ("knot", 4.0))
def test_end_of_a_motion(spin, event, end):
    """A motion that ends at one has its last row there, with its work."""
    span = f"samples = 5  stop_at = '{event}'"
    wanted = "'t', 'omega3', 'work', 'work_torque'"
    run = spin(DRIVEN.format(span, "relative_tolerance = 1e-13", wanted), torque=TABLE)
    assert run.status == "ok"
    rows = run.rows
    assert list(rows.t) == pytest.approx(np.linspace(0, end, 5), abs=1e-9)
    assert list(rows.work) == pytest.approx(0.15 * rows.omega3**2, abs=1e-10)
    assert rows.omega3.iloc[-1] == pytest.approx(0.375 if event == "knot" else 0, abs=1e-12)
    if event == "stuck":
        assert rows.work_torque.iloc[-1] > 0.1


@each("samples", 2, 101)
@each("method", "taylor", "dop853")
def test_work_until_events(spin, method, samples):
    """At events of all sorts the account is closed, whatever rows lie between them."""
    wanted = "'t', 'kinetic', 'potential', 'work', 'energy_error'"
    wanted += "  events = 'slip', 'stuck', 'knot', 'turning_points', 'omega3 = 0.1'"
    how = f"method = '{method}'  relative_tolerance = 1e-12"
    text = DRIVEN.format(f"samples = {samples}", how, wanted)
    text = text.replace("length = 0", "length = 0.5").replace("theta = 1", "theta_deg = 40")
    run = spin(text, torque=TABLE, code=(0, 3))
    start, rows = run.rows.iloc[0], run.table("events")
    assert len(rows) > 3
    change = rows.kinetic + rows.potential - start.kinetic - start.potential
    assert list(rows.work) == pytest.approx(change, abs=1e-9)
    assert largest(rows.energy_error) < 1e-9
    assert rows.work.abs().max() > 0.1


def test_sweep_that_ends_there(spin):
    """The cases end at rest, at times that are inverse to the moment of friction."""
    rows = spin(
        BODY
        + "&study kind = 'sweep' /\n&initial theta = 1  omega = 0, 0, 5 /\n"
        + "&effects friction_torque = 0.1 /\n&span t_end = 100  stop_at = 'stuck' /\n"
        + "&sweep parameter(1) = 'effects.friction_torque'  values(1, :) = 0.1, 0.2, 0.4 /\n"
        + "&output columns = 't_end', 'psi_end' /\n"
    ).rows
    moments = rows["effects.friction_torque"]
    assert list(rows.t_end) == pytest.approx(0.3 * 5 / moments, rel=1e-10)
    assert list(rows.psi_end) == pytest.approx(0.3 * 5**2 / 2 / moments, rel=1e-10)
    assert (rows.notes == "").all()


@each(
    "effects, event, words",
    ("drag_force = 0.1", "stuck", "only a body with dry friction that is not smoothed"),
    ("friction_torque = 0.1  friction_smoothing = 0.1", "slip", "sticks and slips"),
    ("friction_torque = 0.1", "knot", "needs a table of torques"),
    ("friction_torque = 0.1", "stick", "did you mean 'stuck'"),
)
def test_bad_input(spin, effects, event, words):
    text = BODY + f"&initial theta = 1  omega = 0, 0, 5 /\n&effects {effects} /\n"
    assert words in spin(text + f"&span t_end = 1  stop_at = '{event}' /\n", code=2).err
