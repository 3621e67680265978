"""Torques that depend on the time: harmonic ones, and tables with jumps."""

import math

import numpy as np
import pytest

from conftest import each, largest, output
from effects_test import FREE, OMEGA, SKEW, Q, move, refused, scene, tolerant

A, B, W, F = 0.05, 0.4, 7.3, 0.6
SPHERE = "mass = 1  gravity = 9.81  inertia = 0.5, 0.5, 0.5  centre_of_mass = 0, 0, 0"
METHODS = {
    "taylor": (tolerant("taylor", 1e-14), 1e-12),
    "taylor_quadruple": (tolerant("taylor_quadruple", 1e-20), 1e-13),
    "dop853": (tolerant("dop853", 1e-12), 1e-10),
    "arkode": (tolerant("arkode_erk", 1e-11), 1e-8),
    "gauss": ("method = 'gauss_8'  steps = 1000", 1e-11),
    "lie": ("method = 'rkmk_4'  steps = 4000", 1e-7),
}
HEAD = "t,m1,m2,m3\n"


def integral(t):
    return A * t + B / W * (np.sin(W * t + F) - math.sin(F))


def check(values, expected, tolerance):
    assert list(values) == pytest.approx(list(expected), abs=tolerance)


@each("method", *METHODS)
def test_about_an_axis_of_the_body(spin, method):
    """The spin has the integral of the torque, and the work its energy."""
    how, tolerance = METHODS[method]
    effects = f"torque_body = 0, 0, {A}  torque_body_amplitude = 0, 0, {B}"
    effects += f"  torque_body_rate = {W}  torque_body_phase = 0, 0, {F}"
    start, span = "theta = 1  omega = 0, 0, 3", "t_end = 10  samples = 21"
    rows = move(spin, scene(FREE, start, span, effects, how)).rows
    omega3 = 3 + integral(rows.t) / 0.3
    check(rows.omega3, omega3, tolerance)
    check(rows.work_torque, 0.15 * (omega3**2 - 9), 10 * tolerance)
    assert largest(rows.energy_error) < 10 * tolerance


@each("method", *METHODS)
def test_about_axes_of_space(spin, method):
    """The momentum of a sphere in space has the integral of the torque, whatever its attitude."""
    how, tolerance = METHODS[method]
    effects = f"torque_space = 0, 0, {A}  torque_space_amplitude = {B}, 0, {B}"
    effects += f"  torque_space_rate = {W}"
    effects += f"  torque_space_phase_deg = {math.degrees(F)}, 0, {math.degrees(F)}"
    start, span = "theta = 1  omega = 1, 2, 3", "t_end = 5  samples = 11"
    rows = move(spin, scene(SPHERE, start, span, effects, how)).rows
    up = 0.5 * rows[["gamma1", "gamma2", "gamma3"]].iloc[0] @ np.array([1, 2, 3])
    # phi = psi = 0: space x is body x.
    across = 0.5
    other = 0.25 * 14 - up**2 - across**2
    lz = up + integral(rows.t)
    lx = across + integral(rows.t) - A * rows.t
    check(rows.lz, lz, tolerance)
    check(rows.energy, lx**2 + lz**2 + other, 10 * tolerance)


def test_methods_agree(spin):
    """All effects that depend on the time at once, of an asymmetric body under drag."""
    effects = (
        "torque_body_amplitude = 0.1, -0.2, 0.3  torque_body_rate = 5\n"
        "torque_space_amplitude = 0.3, 0.1, -0.2  torque_space_rate = 2\n"
        "torque_body_phase = 1, 2, 3  torque_space_phase = 3, 1, 0  torque_space = 0.1, 0, 0.1\n"
        "drag_moment = 0.01, 0.02, 0.03  earth_rate = 0.3  latitude = 0.9\n"
        "vibration_amplitude = 0.01, 0.02, 0.03  vibration_rate = 20"
    )
    ends = {}
    for name in ("taylor", "taylor_quadruple", "dop853"):
        text = scene(SKEW, "theta = 1  psi_rate = 10", "t_end = 1", effects, METHODS[name][0])
        last = move(spin, text).last
        ends[name] = list(last[[*Q, "lz", "work_torque"]])
        assert abs(last.energy_error) < 1e-11
    assert ends["taylor"] == pytest.approx(ends["taylor_quadruple"], abs=2e-12)
    assert ends["dop853"] == pytest.approx(ends["taylor_quadruple"], abs=1e-9)


def test_departures(spin):
    """A body that dry friction holds starts when the torque exceeds it: A sin(W t) = M."""
    effects = "friction_torque = 0.5  torque_body_amplitude = 0, 0, 1  torque_body_rate = 0.1"
    effects += "  torque_body_phase_deg = 0, 0, -90"
    text = scene(FREE, "theta = 1  omega = 0, 0, 0", "t_end = 10", effects)
    (t,) = spin(text + "&output events = 'slip' /\n").table("events").t
    assert t == pytest.approx(math.asin(0.5) / 0.1, abs=1e-8)


def test_sweep_from_zero(spin):
    """An amplitude is an axis, which may start from zero: there the body has no such effect."""
    effects = f"torque_body_rate = {W}  torque_body_phase = 0, 0, {F}"
    effects += "  torque_body_amplitude = 0, 0, 0"
    text = "&study kind = 'sweep' /\n"
    text += scene(FREE, "theta = 1  omega = 0, 0, 3", "t_end = 2", effects)
    text += "&sweep parameter = 'effects.torque_body_amplitude(3)'  values(1, :) = 0, 0.4 /\n"
    ends = spin(text + output("psi_end", "energy_error_max")).rows.psi_end
    angle = B / W * (-(math.cos(W * 2 + F) - math.cos(F)) / W - 2 * math.sin(F)) / 0.3
    assert ends[1] - ends[0] == pytest.approx(angle, abs=1e-8)


@each(
    "effects, word",
    ("torque_body_amplitude = 0, 0, 1", "torque_body_rate"),
    ("torque_space_rate = 1", "torque_space_amplitude"),
    ("torque_body_phase = 0, 0, 1", "torque_body_amplitude"),
    ("torque_body_amplitude = 0, 0, 1  torque_body_rate = 0", "> 0"),
    (
        "torque_space_amplitude = 0, 0, 1  torque_space_rate = 1  torque_space_phase = 0, 0, 1"
        "  torque_space_phase_deg = 0, 0, 1",
        "given twice",
    ),
)
def test_bad_harmonics(spin, effects, word):
    text = scene(FREE, "theta = 1  psi_rate = 10", "t_end = 1", effects)
    refused(spin, text, "scene.nml:4", word)


STEPS = "t,m1,m2,m3\n0,0,0,0.3\n1,0,0,0.3\n1,0,0,-0.2\n2.5,0,0,-0.2\n2.5,0,0,0.5\n4,0,0,0.5\n"


@each("method", "taylor", "taylor_quadruple", "dop853", "ode45", "arkode")
@each("end", "4", "2.5", "3.3")
def test_jumps(spin, method, end):
    """Steps end where the torque jumps, and each sees the torque of its side."""
    how, _ = METHODS.get(method, (tolerant(method, 1e-6), 0))
    start, span = "theta = 1  omega = 0, 0, 1", f"t_end = {end}  samples = 81"
    text = scene(FREE, start, span, "torque_table = 'torque.csv'", how)
    rows = move(spin, text, torque=STEPS).rows
    assert rows.t.iloc[-1] == float(end)
    t = rows.t  # the integral of the torques, from 1 rad/s, of a body with 0.3 kg m^2
    changes = 0.3 * np.minimum(t, 1) - 0.2 * np.clip(t - 1, 0, 1.5) + 0.5 * np.maximum(t - 2.5, 0)
    omega3 = 1 + changes / 0.3
    check(rows.omega3, omega3, 2e-14)
    check(rows.work_torque, 0.15 * (omega3**2 - 1), 1e-14)


@each("kind", "linear", "monotone", "spline")
@each("axes", "body", "space")
def test_jumps_of_a_tumbling_body(spin, kind, axes):
    """Jumps are those of motions that end and begin there, in every kind of piece."""
    rows = ["0,1,0,0", "1,0,1,0", "2,0,0,1", "3,1,1,0"]
    others = ["3,0,-1,1", "4,0,0,1", "4.5,1,-2,0", "6,0,0,0"]
    later = [f"{float(row.split(',')[0]) - 3},{row.partition(',')[2]}" for row in others]
    how = f"torque_table = 'torque.csv'  torque_interpolation = '{kind}'  torque_axes = '{axes}'"
    state = [*Q, *OMEGA]

    def end(start, t_end, table):
        text = scene(SKEW, start, f"t_end = {t_end}  samples = 2", how)
        return list(move(spin, text, torque=HEAD + "\n".join([*table, ""])).last[state])

    first = list(map(repr, end("theta = 1  psi_rate = 5", 3, rows)))
    start = f"quaternion = {', '.join(first[:4])}  omega = {', '.join(first[4:])}"
    known = end(start, 3, later)
    found = end("theta = 1  psi_rate = 5", 6, rows + others)
    assert found == pytest.approx(known, abs=1e-11)


def test_jumps_over_friction(spin):
    """A torque that jumps over the friction moves a resting body; below it friction stops it."""
    table = HEAD + "0,0,0,0\n1,0,0,0.4\n1,0,0,0.8\n2,0,0,0.8\n2,0,0,0.2\n9,0,0,0.2\n"
    effects = "friction_torque = 0.5  torque_table = 'torque.csv'"
    text = scene(FREE, "theta = 1  omega = 0, 0, 0", "t_end = 9", effects)
    text += "&output events = 'slip', 'stuck', 'knot' /\n"
    events = spin(text, torque=table).table("events")
    found = list(zip(events.event, events.t, strict=True))
    # The spin is 1 rad/s at t = 2; 0.3 kg m^2 and 0.3 N m take it in 1 s.
    known = [("slip", 1), ("knot", 1), ("knot", 2), ("stuck", 3), ("knot", 9)]
    assert sorted(name for name, _ in found) == sorted(name for name, _ in known)
    for name, t in known:
        assert any(other == name and abs(at - t) < 1e-7 for other, at in found), found


@each(
    "rows, interpolation, words",
    ("0,0,0,0\n", "linear", ("torque.csv", "2")),
    ("0,0,0,0\n0,0,0,1\n", "linear", ("torque.csv", "do not increase")),
    ("0.1,0,0,0\n2,0,0,1\n", "linear", ("torque.csv", "begins at")),
    ("0,0,0,0\n0.5,0,0,1\n", "linear", ("torque.csv", "ends at")),
    ("0,0,0,nan\n1,0,0,1\n", "linear", ("torque.csv", "not finite")),
    ("0,0,0,x\n1,0,0,1\n", "linear", ("torque.csv", "is not a number")),
    ("0,0,0,0\n1,0,0,0\n1,0,0,1\n1,0,0,2\n2,0,0,1\n", "linear", ("do not increase",)),
    ("0,0,0,0\n1,0,0,0\n1,0,0,1\n", "linear", ("up to a jump, has 1 rows",)),
    ("0,0,0,0\n1,0,0,0\n1,0,0,1\n2,0,0,1\n3,0,0,1\n", "monotone", ("from t = 0 to 1",)),
)
def test_bad_tables(spin, rows, interpolation, words):
    effects = f"torque_table = 'torque.csv'  torque_interpolation = '{interpolation}'"
    text = scene(FREE, "theta = 1  psi_rate = 1", "t_end = 1", effects)
    refused(spin, text, *words, torque=HEAD + rows)
