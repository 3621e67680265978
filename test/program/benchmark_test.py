"""The study of published benchmarks: its table, and what it refuses."""

import math

import numpy as np
import pytest

from conftest import largest
from mechanics import product, runge_kutta

TIPS = {
    "com_x": -0.15041682274564175981,
    "com_y": -0.72416559163689565075,
    "com_z": -0.67302226956044409605,
}
"""The tip of the heavy top at t = 2 in twenty digits (test/integrators/known_motions_test.pf)."""


def study(spin, cases):
    return spin("benchmarks", f"benchmark.cases={cases}")


def test_heavy_top(spin):
    """The truth has its sixteen digits, and the published figures are off by 1e-7 to 1e-5."""
    run = study(spin, "heavy_top")
    rows = run.rows
    assert len(rows) == 7
    tips = rows.set_index("quantity").truth[list(TIPS)]
    assert largest(tips - list(TIPS.values())) < 2e-15
    assert (rows.truth_error < 1e-14).all()
    error = rows.published_error
    assert list(error) == pytest.approx(list(abs(rows.truth - rows.published)), abs=5e-16)
    assert error.between(1e-8, 1e-5, inclusive="neither").all()
    assert (rows.error <= rows.goal).all()
    assert (abs(rows.value - rows.truth) <= rows.goal).all()
    assert (abs(rows.goal - error / 100) <= 1e-3 * error).all()
    assert "7 published figures; largest error" in run.out


def test_quantities_without_a_figure(spin):
    rows = study(spin, "steady_cone").rows
    assert rows.published.isna().all()
    assert set(rows.goal) == {1e-10}
    length = 3 * 0.1 / 4
    angle = 10 - math.pi / 2  # of the tip: phi - pi/2
    across = length * math.sin(math.pi / 3)
    expected = {"com_x": across * math.cos(angle), "com_y": across * math.sin(angle)}
    expected["com_z"] = length / 2
    assert list(rows.truth) == pytest.approx([expected[q] for q in rows.quantity], abs=5e-16)
    assert largest(rows.value - rows.truth) < 1e-10


def test_free_bodies(spin):
    """The truth of the test set is that of Jacobi's functions; a free box keeps its energy."""
    run = study(spin, "euler_equations,tumbling_box")
    truth, error = run.rows.truth, run.rows.published_error
    jacobi = np.array([-0.93965707987292040, -0.34211777540007491, 0.74141265961999530])
    assert list(truth[:3]) == pytest.approx(list(jacobi * [9 / 5, 3 / 4, 5 / 2]), abs=5e-16)
    assert error[:3].between(5e-16, 3e-15, inclusive="neither").all()
    assert (run.rows.method[:3] == "").all()
    assert truth[3] == pytest.approx(0.49 / 3, abs=5e-17)
    assert list(error[3:5]) == pytest.approx([0.09 * 0.49 / 3, 0.07 * 0.49 / 3], abs=5e-16)
    assert "2 published figures; largest error" in run.out


def test_free_symmetric_body(spin):
    """Its attitude is a turn about the momentum and one about the axis, with constant rates."""
    rows = study(spin, "free_symmetric_body").rows
    t, momentum = 5.0, np.array([0.5, 0.5, 0.5])  # I = (1, 1, 0.5), omega = (0.5, 0.5, 1)
    size = np.linalg.norm(momentum)
    half = size * t / 2  # the rate about the momentum is |L|/I1
    about_momentum = [math.cos(half), *(math.sin(half) * momentum / size)]
    half = (1 - 0.5 / 1) * t / 2  # the rate about the axis is omega3 - L3/I1
    expected = product(about_momentum, [math.cos(half), 0, 0, math.sin(half)])
    assert list(rows.truth) == pytest.approx(list(expected), abs=5e-16)
    assert rows.published_error.between(1e-6, 2e-3, inclusive="neither").all()


def test_tumbling_brick(spin):
    """One of two published trajectories has eleven digits, the other six; their attitudes, too.

    The published angles are relative to axes that turn about north with the Earth and with
    the longitude; seen from these, the true attitude has the published angles.
    """
    run = study(spin, "tumbling_brick")
    errors = run.rows.published_error
    ends = [(1e-12, 1e-11)] * 3 + [(1e-7, 1e-6)] * 3 + [(5e-13, 5e-11)] * 4
    ends += [(1e-7, 1e-6)] * (len(errors) - len(ends))
    assert all(low < error < high for error, (low, high) in zip(errors, ends, strict=True))
    assert "14 published figures; largest error" in run.out
    half = -(7.292115e-5 * 30 + 1.0027827516629e-6) / 2
    q0, q1, q2, q3 = product([math.cos(half), math.sin(half), 0, 0], run.rows.truth[6:10])
    roll = math.atan2(2 * (q0 * q1 + q2 * q3), 1 - 2 * (q1**2 + q2**2))
    pitch = math.asin(2 * (q0 * q2 - q3 * q1))
    yaw = math.atan2(2 * (q0 * q3 + q1 * q2), 1 - 2 * (q2**2 + q3**2))
    first = [-0.9800251968615921, -0.06666555465260421, -0.07486336822299243]
    fifth = np.radians([-56.15127539, -3.819633201, -4.289288509])
    assert [roll, pitch, yaw] == pytest.approx(first, abs=6e-11)
    assert [roll, pitch, yaw] == pytest.approx(list(fifth), abs=2e-6)


def test_bodies_of_two_codes(spin):
    """The true values are those of Runge-Kutta steps in the variables of the source."""
    rows = study(spin, "free_body,torqued_body").rows

    def free(_, y):
        a, b, c = y[4:]
        rates = [5 * b * c / 6, -3 * c * a / 8, -2 * a * b / 3]
        return np.append(product(y[:4], [0, a, b, c]) / 2, rates)

    q0, q1, q2, q3, *_ = runge_kutta(free, [1, 0, 0, 0, 10, 20, 20], 0.1, 400)
    expected = [
        *(2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), 1 - 2 * (q1**2 + q2**2)),
        *(2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1)),
    ]
    assert list(rows.truth[:10]) == pytest.approx(expected * 2, abs=1e-9)
    assert rows.published_error[:10].between(1e-9, 1e-8, inclusive="neither").all()

    def torqued(t, y):
        torque = 0.25 * math.sin(t) ** 2
        return np.array([-2 * y[1] * y[2], 1.25 * y[0] * y[2], -0.5 * y[0] * y[1] + torque])

    found = runge_kutta(torqued, [1, 0, 0.9], 10, 4000) * [1.25, 2, 2.5]
    assert list(rows.truth[10:]) == pytest.approx(list(found), abs=1e-9)
    assert (rows.truth_error[10:] < 1e-15).all()


def test_refusals(spin):
    error = spin.refuse("benchmarks", "benchmark.cases=heavy_tops")
    assert "there is no benchmark 'heavy_tops'" in error
    assert "did you mean 'heavy_top'?" in error
