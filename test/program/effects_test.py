"""Bodies with effects: reference motions, closed forms, rest under dry friction, refused inputs.

The references (test/reference/l_*.json) contain their inputs.
"""

import json
import math
from typing import NamedTuple

import numpy as np
import pandas as pd
import pytest

from conftest import ROOT, each, largest, output

REFERENCES = ROOT / "test/reference"
TABLE = (REFERENCES / "l_torque_3_table.csv").read_text()
TOP = "mass = 1  gravity = 9.81  inertia = 0.9, 0.9, 0.3  centre_of_mass = 0, 0, 0.5"
FREE = "mass = 1  gravity = 9.81  inertia = 0.9, 0.9, 0.3  centre_of_mass = 0, 0, 0"
SKEW = "mass = 1  gravity = 9.81  inertia = 0.9, 1.0, 0.3  centre_of_mass = 0.02, -0.03, 0.5"
TIGHT = "relative_tolerance = 1e-14"
Q, OMEGA = ["q0", "q1", "q2", "q3"], ["omega1", "omega2", "omega3"]
COLUMNS = [
    *("t", "phi", "theta", "psi", *OMEGA, *Q, "gamma1", "gamma2", "gamma3"),
    *("energy", "lz", "l3", "energy_error", "R1", "R2", "force_x", "force_y", "force_z", "work"),
    *("work_damping", "work_friction", "work_drag", "work_vibration", "work_torque", "work_rotor"),
]


class Motion(NamedTuple):
    rows: pd.DataFrame
    status: str
    time: float

    @property
    def last(self):
        return self.rows.iloc[-1]


def scene(top, initial, span, effects, integration=TIGHT):
    groups = {"top": top, "initial": initial, "span": span, "effects": effects}
    groups["integration"] = integration
    return "".join(f"&{name} {keys} /\n" for name, keys in groups.items())


def move(spin, text, **files):
    run = spin(text + output(*COLUMNS), **files)
    status, _, time = run.status.partition(" at t = ")
    return Motion(run.rows, status, float(time or "nan"))


def refused(spin, text, *words, **files):
    message = " ".join(spin.refuse(text, **files).split())
    for word in words:
        assert word in message


def tolerant(method, tolerance):
    return f"method = '{method}'  relative_tolerance = {tolerance}"


METHODS = {
    "taylor": (tolerant("taylor", 1e-14), 1e-11),
    "dop853": (tolerant("dop853", 1e-12), 1e-9),
    "ode45": (tolerant("ode45", 1e-9), 1e-6),
    "gauss": ("method = 'gauss_8'  steps = 1000", 1e-8),
    "lie": ("method = 'rkmk_4'  steps = 4000", 1e-5),
    "arkode": (tolerant("arkode_erk", 1e-11), 1e-8),
}


@each("name", *sorted(path.stem for path in REFERENCES.glob("l_*.json")))
@each("method", *METHODS)
def test_references(spin, name, method):
    """Every reference motion, its energy and its works, by methods of all families."""
    reference = json.loads((REFERENCES / f"{name}.json").read_text())
    settings, tolerance = METHODS[method]
    if "table" in reference["namelist"] and method in ("gauss", "lie"):
        tolerance = max(tolerance, 1e-4)  # steps do not end at knots
    text = reference["namelist"].replace("t_end = 1000", "t_end = 8")
    stuck = reference.get("status") == "stuck"
    if stuck and "steps" in settings:
        pytest.skip("rest is found to a step")
    end = 8.0 if stuck else float(reference["rows"][-1][0])
    samples = round(end * (4 if stuck else 10)) + 1
    text = text.replace("&span t_end", f"&span samples = {samples}  t_end")
    motion = move(spin, f"{text}&integration {settings} /\n", l_torque_3_table=TABLE)
    at = motion.rows.set_index(motion.rows.t.round(9))
    compared = 0
    for values in reference["rows"]:
        known = dict(zip(reference["columns"], map(float, values), strict=True))
        if round(known["t"], 9) not in at.index:
            continue
        row = at.loc[round(known["t"], 9)]
        compared += 1
        sign = math.copysign(1, sum(row[q] * known[q] for q in Q))
        pairs = [(sign * row[q], known[q]) for q in Q]
        pairs += [(row[f"omega{i}"], known[f"w{i}"]) for i in (1, 2, 3)]
        pairs += [(row[f"gamma{i}"], known[f"G{i}"]) for i in (1, 2, 3)]
        pairs += [(row.l3, known["P3"]), (row.energy, known["E"]), (row.work, known["W"])]
        pairs += [(row["work_" + key[2:]], known[key]) for key in known if key.startswith("W_")]
        pairs += [(row.lz, sum(known[f"P{i}"] * known[f"G{i}"] for i in (1, 2, 3)))]
        for ours, theirs in pairs:
            assert ours == pytest.approx(theirs, abs=tolerance * max(1, abs(theirs)))
        assert abs(row.energy_error) < tolerance
        assert max(abs(row.R1), abs(row.R2)) < 1e-12
    assert compared >= 5
    if stuck:
        assert motion.status == "at_rest"
        assert motion.time == pytest.approx(float(reference["t_stuck"]), rel=max(tolerance, 1e-12))


@each("name", "l_combined_1", "l_torque_3")
def test_quadruple(spin, name):
    """The series in quadruple precision is the same motion, to the rounding of the table."""
    reference = json.loads((REFERENCES / f"{name}.json").read_text())
    text = reference["namelist"].replace("&span", "&span samples = 21 ")
    text += f"&integration {tolerant('taylor_quadruple', 1e-25)} /\n"
    motion = move(spin, text, l_torque_3_table=TABLE)
    known = dict(zip(reference["columns"], map(float, reference["rows"][-1]), strict=True))
    expected = [known[f"w{i}"] for i in (1, 2, 3)]
    assert list(motion.last[OMEGA]) == pytest.approx(expected, abs=2e-14)


def test_spin_down(spin):
    effects = "friction_torque = 0.02  friction_coefficient = 0.3  friction_radius = 0.01"
    effects += "  drag_moment = 0, 0, 0.003"
    start, span = "theta = 1  omega = 0, 0, 12", "t_end = 30  samples = 31"
    text = scene(FREE + "  damping = 0, 0, 0.01", start, span, effects)
    motion = move(spin, text)
    assert motion.rows.omega3[2] == pytest.approx(8.846626858973130, rel=1e-13)
    assert motion.status == "at_rest"
    assert motion.time == pytest.approx(23.86289777879196, rel=1e-13)
    assert motion.last.psi == pytest.approx(85.16613498183026, rel=1e-13)
    assert motion.last.omega3 == 0
    assert abs(motion.last.energy_error) < 1e-13
    # The dry moment is on the load that the table shows.
    assert motion.rows.force_z[2] == pytest.approx(9.81, rel=1e-14)
    # Where nothing depends on time there is one rest, which is the event.
    events = "&output columns = 't', 'psi', 'omega3'  events = 'stuck', 'slip' /\n"
    (row,) = spin(text + events).table("events").itertuples()
    assert (row.event, row.number, row.omega3) == ("stuck", 1, 0)
    assert [row.t, row.psi] == pytest.approx([motion.time, motion.last.psi], rel=1e-13)


def test_stop_of_a_coning_body(spin):
    """The direction of the angular velocity tends to an axis while friction stops the body."""
    start, span = "theta = 1  omega = 3, 0, 10", "t_end = 100  samples = 11"
    motion = move(spin, scene(FREE, start, span, "friction_torque = 0.05"))
    assert motion.status == "at_rest"
    assert motion.time == pytest.approx(88.49423948083030, rel=1e-11)


def swing(spin, span, effects, method):
    """A pendulum that is released: the motion, and angles from the lowest point where it turns."""
    start = f"theta = {math.pi - 2!r}  omega = 0, 0, 0"
    motion = move(spin, scene(TOP, start, span, effects, tolerant(method, 1e-12)))
    height = list(motion.rows.gamma3)
    turns = [
        (motion.rows.t[i], math.acos(-height[i]), height[i] - height[i - 1])
        for i in range(1, len(height) - 1)
        if height[i - 1] < height[i] >= height[i + 1]
    ]
    return motion, turns


@each("method", "taylor", "dop853")
def test_swings_with_friction(spin, method):
    """A pendulum stops at each turning point and starts again, until friction holds it."""
    motion, turns = swing(spin, "t_end = 12  samples = 12001", "friction_torque = 0.5", method)
    first, second = [turn[:2] for turn in turns if turn[2] > 1e-9][:2]
    assert first == pytest.approx((1.710219112097427, 1.618139306842915), abs=1e-3)
    assert first[1] == pytest.approx(1.618139306842915, abs=2e-6)
    assert second[1] == pytest.approx(1.316258808776618, abs=2e-6)
    assert motion.status == "at_rest"
    # It lies where friction can hold it, and the first such turning point ends the motion.
    assert 9.81 * 0.5 * math.sin(math.acos(-motion.last.gamma3)) <= 0.5
    assert abs(motion.last.energy_error) < 1e-10


@each("method", "taylor", "dop853")
def test_swings_in_air(spin, method):
    """A plane pendulum with drag: the force changes its branch at each turning point."""
    _, turns = swing(spin, "t_end = 5  samples = 10001", "drag_force = 0.5", method)
    angles = [turn[1] for turn in turns[:2]]
    assert angles == pytest.approx([1.607630028664216, 1.365912156777692], abs=4e-7)


@each("exponent, end", (1.5, 4.140437573436630), (1.8, 1.952020936566768), (2, 1.445783132530120))
def test_drag_about_an_axis(spin, exponent, end):
    effects = f"drag_moment = 0, 0, 0.02  drag_exponent = {exponent}"
    start, span = "theta = 1  omega = 0, 0, 40", "t_end = 10  samples = 11"
    motion = move(spin, scene(FREE, start, span, effects))
    assert motion.last.omega3 == pytest.approx(end, rel=1e-13)


ROTOR, EARTH = "rotor_momentum = 0, 0, 0.8", "earth_rate = 0.3  latitude_deg = 90"
SHIFTS = [
    (ROTOR, (1.129399513883146, 12.75286737897582, 98.84611312231331)),
    (EARTH, (1.499191437135319, 12.19972469541215, 101.1994868071405)),
    (f"{ROTOR}  {EARTH}", (1.027191877028727, 10.60877037794142, 99.00722644549234)),
]


@each("effects, angles", *SHIFTS)
@each(
    "integration",
    "method = 'exact'",
    "method = 'dop853'  relative_tolerance = 1e-13",
    "formulation = 'lagrange'  method = 'dop853'  relative_tolerance = 1e-13",
    "method = 'splitting_8'  steps = 20000",
)
def test_exact_with_effects(spin, effects, angles, integration):
    """A held rotor on the axis and the Earth at a pole keep closed form and formulations."""
    start = "theta = 1  phi_rate = 0.2  theta_rate = 0.1  psi_rate = 10"
    motion = move(spin, scene(TOP, start, "t_end = 10  samples = 11", effects, integration))
    tolerance = 1e-13 if "exact" in integration else 1e-9
    for name, angle, factor in zip(("theta", "phi", "psi"), angles, (1, 10, 100), strict=True):
        assert motion.last[name] == pytest.approx(angle, abs=factor * tolerance)
    # Energy and momentum are those of the body with its effects.
    assert abs(motion.last.energy_error) < max(tolerance, 1e-12)
    assert motion.last.lz == pytest.approx(motion.rows.lz[0], rel=1e-9)
    assert largest(motion.rows.R1.abs() + motion.rows.R2.abs()) < 1e-9


def test_exact_with_effects_is_that_of_rigid_body(spin):
    """The shifted closed form is the motion of the full equations, support force included."""
    effects = "rotor_momentum = 0.8, 0, 0  earth_rate = 0.3  latitude_deg = -90"
    top = "mass = 1  gravity = 9.81  inertia = 0.3, 0.9, 0.9  centre_of_mass = -0.5, 0, 0"
    initial = "quaternion = 0.8, 0.6, 0, 0  omega = 10, 0.3, -0.2"
    span = "t_end = 3  samples = 31"
    exact = move(spin, scene(top, initial, span, effects, "method = 'exact'")).rows
    # A torque too small to matter excludes the closed form.
    other = move(spin, scene(top, initial, span, effects + "  torque_body = 0, 0, 1e-30")).rows
    assert len(exact) == len(other)
    same = [*OMEGA, "force_x", "force_y", "force_z", "energy", "lz", "theta"]
    assert exact[same].to_numpy() == pytest.approx(other[same].to_numpy(), abs=1e-10)
    sign = np.copysign(1, exact.q0 * other.q0 + exact.q1 * other.q1).to_numpy()[:, None]
    assert sign * exact[Q].to_numpy() == pytest.approx(other[Q].to_numpy(), abs=1e-12)


def test_gyroscope_keeps_its_direction(spin):
    """On the rotating Earth the axis of a free symmetric body turns against it."""
    latitude = math.radians(50)
    earth = (0.0, 0.3 * math.cos(latitude), 0.3 * math.sin(latitude))
    c, s = 0.8**2 - 0.6**2, 2 * 0.8 * 0.6
    omega = (-earth[0], -c * earth[1] - s * earth[2], 20 + s * earth[1] - c * earth[2])
    start = "quaternion = 0.8, 0.6, 0, 0  omega = " + ", ".join(map(repr, omega))
    effects = "earth_rate = 0.3  latitude_deg = 50"
    q0, q1, q2, q3 = move(spin, scene(FREE, start, "t_end = 10  samples = 11", effects)).last[Q]
    axis = (2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), q0**2 + q3**2 - q1**2 - q2**2)
    known = (-0.1291788840124092, 0.4354309177312228, -0.8909055684016424)
    assert axis == pytest.approx(known, abs=1e-12)


def test_gyrocompass(spin):
    """Small swings of a pendulous gyroscope about north on the Earth."""
    top = "mass = 2  gravity = 9.81  inertia = 0.02, 0.015, 0.01  centre_of_mass = 0, 0, -0.01"
    rate = 7.292115e-5
    load = 2 * 9.81 * 0.01
    # Equilibrium: the rotor rises above the horizon by h Oe sin(lat)/(m g l).
    tilt = 0.05 * rate * math.sin(math.radians(50)) / load
    start = f"phi = 1e-3  theta = {tilt!r}  psi = 0  omega = 0, 0, 0"
    effects = f"rotor_momentum = 0, 0.05, 0  earth_rate = {rate!r}  latitude_deg = 50"
    span, how = "t_end = 700  samples = 1401", "relative_tolerance = 1e-12"
    rows = move(spin, scene(top, start, span, effects, how)).rows
    # Azimuth of body y, where the rotor points, from north.
    q0, q1, q2, q3 = (rows[q].to_numpy() for q in Q)
    azimuth = np.arctan2(-2 * (q1 * q2 - q0 * q3), q0**2 - q1**2 + q2**2 - q3**2)
    # Two passages of north in the same sense are a period apart; the fast nutation is tiny.
    first, second = np.flatnonzero(azimuth[:-1] * azimuth[1:] < 0)[:2]
    at = [rows.t[i] + 0.5 * azimuth[i] / (azimuth[i] - azimuth[i + 1]) for i in (first, second)]
    assert 2 * (at[1] - at[0]) == pytest.approx(618.9378838177327, rel=2e-3)


@each(
    "effects, omega",
    # A rotor that is spun up on the axis of a free symmetric body.
    (
        "rotor_momentum = 0, 0, 2  rotor_torque = 0, 0, 0.1",
        [0.4996132792811143, 0.01966141312244184, -1 / 3],
    ),
    # A constant torque in the axes of a symmetric body.
    ("torque_body = 0.2, 0.1, 0.06", [0.1615452243395345, -0.5108514627490013, 5]),
)
def test_driven_bodies(spin, effects, omega):
    start, span = "theta = 1  omega = 0.5, 0, 3", "t_end = 10  samples = 11"
    motion = move(spin, scene(FREE, start, span, effects))
    assert list(motion.last[OMEGA]) == pytest.approx(omega, abs=1e-12)
    if "rotor" in effects:
        assert motion.last.work == motion.last.work_rotor
        assert abs(motion.last.energy_error) < 1e-13


@each("method", "taylor", "dop853", "arkode_erk")
def test_torque_table(spin, method):
    """A spline through rows of a cubic is the cubic; its integral is the spin."""
    rows = [
        f"{t},0,0,{0.1 - 0.2 * t + 0.05 * t**2 - 0.003 * t**3!r}" for t in (0, 1, 2.5, 4, 7, 10)
    ]
    effects = "torque_table = 'torque.csv'  torque_interpolation = 'spline'"
    start, span = "theta = 1  omega = 0, 0, 3", "t_end = 10  samples = 11"
    text = scene(FREE, start, span, effects, tolerant(method, 1e-11))
    motion = move(spin, text, torque="\n".join(["t,m1,m2,m3", *rows, ""]))
    near = 1e-9 if method == "arkode_erk" else 1e-12
    assert motion.last.omega3 == pytest.approx(32 / 9, rel=near)


def test_monotone_table(spin):
    """The monotone interpolation does not overshoot: a ramp stays between its levels."""
    table = "t,m1,m2,m3\n0,0,0,0\n1,0,0,0\n2,0,0,1\n3,0,0,1\n"
    effects = "torque_table = 'torque.csv'  torque_interpolation = 'monotone'"
    text = scene(FREE, "theta = 1  omega = 0, 0, 0.3", "t_end = 3  samples = 301", effects)
    omega3 = move(spin, text, torque=table).rows.omega3
    assert (np.diff(omega3) >= -1e-15).all()
    assert omega3[100] == pytest.approx(0.3, abs=1e-14)
    # By symmetry the ramp has the mean of its levels.
    assert 0.3 * (omega3[200] - 0.3) == pytest.approx(0.5, rel=1e-12)


def test_energy_that_effects_brought(spin):
    """At rest without weight there is no energy at the start to compare an error with."""
    top = "mass = 1  gravity = 0  inertia = 0.9, 0.9, 0.3  length = 0.5"
    text = scene(top, "theta = 3.1", "t_end = 2.5  samples = 20", "torque_body = -0.7742, 0, 0")
    rows = move(spin, text).rows
    assert rows.work.max() > 1
    assert largest(rows.energy_error) < 1e-14
    text = "&study kind = 'sweep' /\n" + text.replace("samples = 20 ", "")
    sweep = "&sweep parameter = 'top.mass'  values(1, :) = 1, 2 /\n"
    errors = spin(text + sweep + output("energy_error_max")).rows.energy_error_max
    assert (errors < 1e-14).all()


@each("method", "taylor", "dop853")
def test_start_from_rest(spin, method):
    """From rest the body starts along the u of lambda u_i = (T_i - M u_i)/I_i."""
    start, span = "quaternion = 0.8, 0.6, 0, 0  omega = 0, 0, 0", "t_end = 1e-4  samples = 2"
    text = scene(SKEW, start, span, "friction_torque = 0.5", tolerant(method, 1e-12))
    omega = move(spin, text).last[OMEGA].to_numpy()
    size = math.hypot(*omega)
    assert size / 1e-4 == pytest.approx(4.793614857683359, rel=1e-7)
    direction = [0.9952122644708552, 0.01037778559206357, -0.09718461922031603]
    assert list(omega / size) == pytest.approx(direction, abs=1e-6)


def test_shaken_loose(spin):
    """A lying body starts when a growing torque exceeds the friction, and only then."""
    effects = "friction_torque = 0.5  torque_table = 'torque.csv'"
    text = scene(FREE, "theta = 1  omega = 0, 0, 0", "t_end = 10  samples = 101", effects)
    motion = move(spin, text, torque="t,m1,m2,m3\n0,0,0,0\n10,0,0,1\n")
    assert motion.status == "ok"
    beyond = np.maximum(motion.rows.t - 5, 0)
    expected = 0.1 * beyond**2 / 2 / 0.3
    assert list(motion.rows.omega3) == pytest.approx(list(expected), abs=1e-9)


def test_smooth_friction_creeps(spin):
    """Smoothed friction never holds a body: it creeps with eps |T|/sqrt(M^2 - T^2)."""
    effects = "friction_torque = 0.5  friction_smoothing = 0.01  torque_body = 0, 0, 0.3"
    start, span, how = "theta = 1  omega = 0, 0, 0", "t_end = 1", "method = 'gauss_6'  steps = 2000"
    motion = move(spin, scene(FREE, start, span + "  samples = 11", effects, how))
    assert motion.status == "ok"
    assert motion.last.omega3 == pytest.approx(0.01 * 0.3 / 0.4, rel=1e-9)


@each("rate, rises", (39.6, True), (39.8, False))
def test_upright_by_vibration(spin, rate, rises):
    """A vertical vibration of the pivot holds a body upright from a rate of 39.678 rad/s on."""
    effects = f"vibration_amplitude = 0, 0, 0.15  vibration_rate = {rate}"
    start, span = "theta = 1e-6  omega = 0, 0, 0", "t_end = 60  samples = 6001"
    rows = move(spin, scene(TOP, start, span, effects, "relative_tolerance = 1e-10")).rows
    assert (largest(np.hypot(rows.gamma1, rows.gamma2)) > 1e-4) == rises


def test_sweep(spin):
    """Cases of a sweep: closed form without effects, rest with friction, and the time of rest."""
    rows = spin(
        f"&study kind = 'sweep' /\n&top {FREE} /\n&initial theta = 1  omega = 0, 0, 12 /\n"
        "&span t_end = 100 /\n&effects friction_torque = 0.1 /\n"
        "&integration relative_tolerance = 1e-12 /\n"
        "&sweep parameter = 'effects.friction_torque'  values(1, :) = 0, 0.05, 0.1 /\n"
        "&output columns = 'psi_end', 't_stuck', 'energy_error_max' /\n"
    ).rows
    assert list(rows.status) == ["ok", "at_rest", "at_rest"]
    assert rows.psi_end[0] == pytest.approx(1200, rel=1e-12)
    torque = np.array([0.05, 0.1])
    assert list(rows.t_stuck[1:]) == pytest.approx(list(0.3 * 12 / torque), rel=1e-10)
    assert list(rows.psi_end[1:]) == pytest.approx(list(0.3 * 144 / (2 * torque)), rel=1e-10)
    assert (rows.energy_error_max[1:] < 1e-11).all()


def test_resolved_input(spin):
    base = f"&top {TOP} /\n&initial theta = 1  psi_rate = 10 /\n&span t_end = 1  samples = 2 /\n"
    assert "effects" not in spin(base).path.read_text()
    text = spin(base + "&effects earth_rate = 0 latitude_deg = 50 /\n").path.read_text()
    assert "&effects" in text
    assert "work of all effects" not in text


START, SPAN = "theta = 1  psi_rate = 10", "t_end = 1"


@each(
    "effects, words",
    ("friction_coefficient = 0.3", ("effects", "friction_radius")),
    ("friction_radius = 0.01", ("friction_coefficient",)),
    ("friction_smoothing = 0.1", ("no dry friction",)),
    ("vibration_amplitude = 0, 0, 0.1", ("vibration_rate",)),
    ("vibration_rate = 10", ("vibration_amplitude",)),
    ("earth_rate = 7e-5", ("latitude",)),
    ("latitude_deg = 50", ("earth_rate",)),
    ("latitude = 2  earth_rate = 1", ("[-pi/2, pi/2]",)),
    ("drag_exponent = 1.5", ("drag_moment",)),
    ("drag_exponent = 4  drag_moment = 0, 0, 1", ("[1, 3]",)),
    ("torque_axes = 'space'", ("torque_table",)),
    ("torque_interpolation = 'spline'", ("torque_table",)),
    ("torque_table = 'none.csv'", ("none.csv",)),
    ("friction_coefficient = 2  friction_radius = 1", ("jam",)),
    ("friction_torque = -1", (">= 0",)),
)
def test_bad_effects(spin, effects, words):
    refused(spin, scene(TOP, START, SPAN, effects), "scene.nml:4", *words)


@each(
    "integration, word",
    ("method = 'exact'", "the exact solution exists only"),
    ("method = 'splitting_4'  steps = 100", "splitting_4"),
    ("project = 'invariants'", "conserves neither"),
    ("formulation = 'lagrange'  method = 'dop853'", "rigid_body"),
)
def test_refused_computations(spin, integration, word):
    refused(spin, scene(TOP, START, SPAN, "drag_force = 0.1", integration), word)


@each(
    "effects, integration, words",
    ("drag_force = 0.1", "relative_tolerance = 1e-9", ("taylor", "effects", "excluded")),
    ("rotor_momentum = 0, 0, 1", "", ("exact", "rotor")),
)
def test_choice_is_explained(spin, effects, integration, words):
    said = " ".join(spin(scene(TOP, START, SPAN, effects, integration), "--check").out.split())
    assert all(word in said for word in words)
