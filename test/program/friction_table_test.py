"""Friction about the axis of the body by a table over its angular velocity."""

import math
from itertools import pairwise

import numpy as np
import pytest

from conftest import each, largest, output
from effects_test import FREE, OMEGA, SKEW, TIGHT, Q, move, refused, scene, tolerant
from mechanics import runge_kutta

INERTIA = 0.3
BROKEN = [(0, 0), (4, 0.2), (10, 0.35), (20, 1.2), (40, 1.2), (60, 4.0)]
METHODS = {
    "taylor": (TIGHT, 1e-11),
    "taylor_quadruple": (tolerant("taylor_quadruple", 1e-20), 1e-12),
    "dop853": (tolerant("dop853", 1e-13), 1e-13),
    "arkode": (tolerant("arkode_erk", 1e-11), 1e-11),
    "gauss": ("method = 'gauss_8'  steps = 5000", 1e-5),
}
KEY = "friction_table = 'friction.csv'"
HEAD = "omega3,friction_torque\n"


def table(rows):
    return HEAD + "".join(f"{omega!r},{torque!r}\n" for omega, torque in rows)


def spin_down(omega3, t):
    """The spin that broken lines leave after a time: an exponential between two rows."""
    pieces = list(pairwise(BROKEN))
    for (low, at_low), (high, at_high) in reversed(pieces):
        if not low < omega3 <= high:
            continue
        slope = (at_high - at_low) / (high - low)
        torque = at_low + slope * (omega3 - low)
        if slope > 0:
            # The torque falls as exp(-slope t/I).
            until = math.inf if at_low == 0 else math.log(torque / at_low) * INERTIA / slope
        else:
            until = (omega3 - low) * INERTIA / torque
        if t <= until:
            if slope == 0:
                return omega3 - torque * t / INERTIA
            return low + (torque * math.exp(-slope * t / INERTIA) - at_low) / slope
        omega3, t = low, t - until
    return omega3


@each("direction", 1, -1)
@each("method", *METHODS)
def test_spin_down(spin, method, direction):
    """A body that spins about its axis alone has a closed form; it starts at a row."""
    integration, tolerance = METHODS[method]
    start, span = f"theta = 1  omega = 0, 0, {60 * direction}", "t_end = 20  samples = 41"
    motion = move(spin, scene(FREE, start, span, KEY, integration), friction=table(BROKEN))
    assert motion.status == "ok"
    rows, known = motion.rows, np.array([spin_down(60, t) for t in motion.rows.t])
    assert list(rows.omega3) == pytest.approx(list(direction * known), abs=60 * tolerance)
    work = 0.15 * (known**2 - 3600)
    assert list(rows.work_friction) == pytest.approx(list(work), abs=1000 * tolerance)
    assert largest(rows.energy_error) < 10 * tolerance


def test_laws_of_keys(spin):
    """Rows of a + b omega + c omega^2 through a spline are friction by three keys, up to rest."""
    a, b, c = 0.05, 0.02, 0.003
    rows = [(w, a + b * w + c * w * w) for w in (0, 1, 4, 9, 17, 31, 40)]
    start, span = "theta = 1  omega = 0, 0, 38", "t_end = 40  samples = 81"
    effects = KEY + "  friction_interpolation = 'spline'"
    found = move(spin, scene(FREE, start, span, effects), friction=table(rows))
    keys = f"friction_torque = {a}  drag_moment = 0, 0, {c}"
    expected = move(spin, scene(f"{FREE}  damping = 0, 0, {b}", start, span, keys))
    assert found.status == expected.status == "at_rest"
    assert found.time == pytest.approx(expected.time, rel=1e-10)
    assert list(found.rows.omega3) == pytest.approx(list(expected.rows.omega3), abs=1e-10)
    assert list(found.rows.psi) == pytest.approx(list(expected.rows.psi), abs=1e-9)
    assert largest(found.rows.energy_error) < 1e-12


@each("interpolation", "linear", "monotone", "spline")
def test_methods_agree(spin, interpolation):
    """The spin of a body without symmetry rises and falls across rows; the law falls first."""
    rows = [(0, 0.02), (1, 0.012), (3, 0.02), (6, 0.05), (8, 0.06), (10, 0.1), (15, 0.3), (30, 0.5)]
    effects = f"{KEY}  friction_interpolation = '{interpolation}'"
    ends = {}
    for name in ("taylor", "taylor_quadruple", "dop853"):
        text = scene(SKEW, "theta = 1  psi_rate = 9", "t_end = 2", effects, METHODS[name][0])
        last = move(spin, text, friction=table(rows)).last
        ends[name] = list(last[[*Q, "lz", "work_friction"]])
        assert abs(last.energy_error) < 1e-9
        assert last.work_friction < -0.1
    assert ends["taylor"] == pytest.approx(ends["taylor_quadruple"], abs=1e-10)
    assert ends["dop853"] == pytest.approx(ends["taylor_quadruple"], abs=1e-8)


def test_axis_of_a_tensor(spin):
    """Friction is about body z of the input where that is no principal axis."""
    inertia = np.array([[0.9, 0, 0.1], [0, 1, 0.05], [0.1, 0.05, 0.4]])
    top = "mass = 1  gravity = 0  centre_of_mass = 0, 0, 0"
    for i, row in enumerate(inertia, 1):
        top += f"  inertia_tensor({i},:) = " + ", ".join(map(str, row))
    text = scene(top, "theta = 1  omega = 2, -1, 9", "t_end = 1", KEY)
    motion = move(spin, text, friction=table([(0, 0), (20, 0.8)]))

    def slope(_, omega):
        moment = np.cross(inertia @ omega, omega) - [0, 0, 0.04 * omega[2]]
        return np.linalg.solve(inertia, moment)

    expected = runge_kutta(slope, [2, -1, 9], 1, 2000)
    assert list(motion.last[OMEGA]) == pytest.approx(list(expected), abs=1e-9)


def test_order_of_fixed_steps(spin):
    how = "method = 'rk4'  steps = 99"
    run = spin(
        scene(FREE, "theta = 1  omega = 0, 0, 50", "t_end = 1", KEY, how), friction=table(BROKEN)
    )
    assert "the order of the method is 2 at most" in run.err


def test_sweep(spin):
    """Cases with a table are computed one after another; one that starts beyond it is refused."""
    text = "&study kind = 'sweep' /\n"
    text += scene(FREE, "theta = 1  omega = 0, 0, 1", "t_end = 2", KEY)
    text += "&sweep parameter = 'initial.omega(3)'  values(1, :) = 5, 30, 60, 61 /\n"
    text += output("psi_end", "energy_error_max")
    rows = spin(text, code=3, friction=table(BROKEN)).rows
    assert list(rows.status) == ["ok", "ok", "ok", "bad_input"]
    for row, omega3 in zip(rows.itertuples(), (5, 30, 60), strict=False):
        n = 20000
        turned = sum(spin_down(omega3, 2 * (i + 0.5) / n) for i in range(n)) * 2 / n
        assert row.psi_end == pytest.approx(turned, rel=1e-7)
        assert row.energy_error_max < 1e-11


@each(
    "rows, effects, words",
    ("0,0", "", "has 1 rows"),
    ("0,0\n1,2", "friction_interpolation = 'spline'", "has 2 rows"),
    ("1,0\n2,1", "", "friction.csv:2: the table begins at omega3 = 1"),
    ("-1,0\n0,1", "", "friction.csv:2: the table begins at omega3 = -1"),
    ("0,0\n3,1\n3,2", "", "friction.csv:4: omega3 = 3"),
    ("0,0\n3,1\n2,2", "", "friction.csv:4: omega3 = 2"),
    ("0,0\n# bearing\n3,-1", "", "friction.csv:4: friction_torque = -1 would drive the body"),
    ("0,nan\n3,1", "", "friction.csv:2: row 1 has a value that is not finite"),
    ("0,0\n3,x", "", "friction.csv:3: 'x' in column friction_torque is not a number"),
    (
        "0,1\n1,0\n2,0\n30,1",
        "friction_interpolation = 'spline'",
        "friction.csv:3: from this row to the next the spline is negative",
    ),
    ("0,0\n5,1", "", "the table ends at omega3 = 5, below that of the start, 8"),
    ("0,1\n50,0.5", "friction_smoothing = 0.1", "falls from its value at rest"),
    ("0,0\n50,0.5", "friction_law = 1", "friction_table"),
)
def test_bad_tables(spin, rows, effects, words):
    text = scene(FREE, "theta = 1  omega = 0, 0, -8", "t_end = 1", f"{KEY}  {effects}")
    refused(spin, text, words, friction=HEAD + rows + "\n")


@each(
    "effects, words",
    (KEY, ["omega3", "its columns are omega3, friction_torque"]),
    ("friction_interpolation = 'spline'", ["give friction_table too"]),
)
def test_table_without_its_columns(spin, effects, words):
    text = scene(FREE, "theta = 1  omega = 0, 0, 8", "t_end = 1", effects)
    refused(spin, text, "scene.nml:4", *words, friction="omega,torque\n0,0\n9,1\n")
