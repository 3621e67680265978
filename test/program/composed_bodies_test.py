"""Bodies that are composed of parts, or given by an inertia tensor, in runs of the program."""

import re

import numpy as np
import pytest

from conftest import ROOT, each
from mechanics import runge_kutta

TOP = (ROOT / "input/composed_top.nml").read_text()
PART = "&part shape = 'disc' mass = 2 radius = 0.1 thickness = 0.02 place = {} axis = {} /\n"
START = (
    "&initial quaternion = {}, {}, 0, 0  omega = {} /\n&span t_end = 3 samples = 31 /\n"
    "&output columns = 't', 'com_x', 'com_y', 'com_z', 'lz', 'energy', 'inherent_error' /\n"
)


def test_results_are_in_the_axes_of_the_parts(spin):
    """Euler's equations hold in these axes, in which the body has a product of inertia."""
    columns = "R1,R2,energy,lz,com_x,com_y,com_z,omega1,omega2,omega3"
    rows = spin("composed_top", f"output.columns={columns}").rows
    assert rows[["R1", "R2"]].abs().to_numpy().max() < 1e-12
    for name in ("energy", "lz"):
        assert rows[name].to_numpy() == pytest.approx(rows[name][0], rel=5e-10)
    distance = np.linalg.norm(rows[["com_x", "com_y", "com_z"]], axis=1)
    assert distance == pytest.approx(0.049776039, abs=5e-9)
    assert rows.omega3[0] == 200


def test_the_header_is_the_input(spin):
    first = spin("composed_top", "span.samples=11")
    expected, text = first.rows, first.head
    assert text.count("&part") == 4
    assert spin(text).rows.equals(expected)


def test_an_inclined_top_is_exact(spin):
    """A top whose parts are inclined in the body axes has the motion of the upright one."""
    upright = spin(PART.format("0, 0, 0.5", "0, 0, 1") + START.format(0.6, 0.8, "1, 2, 30")).rows
    # The axes of the second body are turned about x by the angle whose sine is 0.6.
    # q = p conj(turn).
    s, c = 0.1**0.5, 0.9**0.5
    omega = f"1, {2 * 0.8 + 30 * 0.6}, {-2 * 0.6 + 30 * 0.8}"
    start = START.format(0.6 * c - 0.8 * s, 0.8 * c + 0.6 * s, omega)
    inclined = spin(PART.format("0, 0.3, 0.4", "0, 3, 4") + start)
    assert "principal axes" in inclined.out
    assert inclined.rows.to_numpy() == pytest.approx(upright.to_numpy(), abs=5e-12)


def test_parts_are_swept(spin):
    text = TOP.replace("kind = 'trajectory'", "kind = 'sweep'").replace("samples = 2001", "")
    text += "&sweep parameter(1) = 'part.mass(4)' from(1) = 0.001 to(1) = 0.004 count(1) = 4 /\n"
    rows = spin(text).rows
    assert list(rows.status) == ["ok"] * 4
    assert rows.theta_end.nunique() == 4
    alone = spin("composed_top", "part.mass(4)=0.002", "output.columns=theta").rows
    assert rows.theta_end[1] == pytest.approx(alone.theta.iloc[-1], abs=5e-10)


@each(
    "old, new, said",
    ("'rod'", "'rode'", "did you mean 'rod'?"),
    ("density = 2700", "", "neither mass nor density of the part is given"),
    ("thickness = 0.02", "", "part.thickness(4) is not given"),
    ("gravity = 9.81", "mass = 1", "top.mass is not for a body of parts"),
    ("axis = 1, 0, 0", "axis = 0, 0, 0", "has no direction"),
)
def test_messages(spin, old, new, said):
    error = spin.refuse(TOP.replace(old, new))
    assert said in error
    assert re.search(r"scene\.nml:\d+:\d+: error: ", error)


def test_no_part_has_a_place(spin):
    """A weight without a moment: perhaps a mistake, but not where the place is given."""
    start = "&initial theta = 1  omega3 = 9 /\n&span t_end = 1 /\n"
    placed = PART.format("0, 0, 0", "0, 0, 1") + start
    assert "no part has a place" in spin(placed.replace("place = 0, 0, 0", "")).err
    assert spin(placed).err == ""


# A top of point masses: the motion follows from them alone, without axes of inertia.

MASSES = np.array([0.3, 0.3, 0.3, 0.1])
POINTS = np.array([[0.4, 0, 0.5], [-0.2, 0.12**0.5, 0.5], [-0.2, -(0.12**0.5), 0.5], [0, 0, 1.1]])
THETA, PHI, PSI = 0.7, 0.4, -1.1
RATE, SPIN, END, STEPS = 0.8, 14.0, 1.0, 500
GRAVITY = np.array([0, 0, -9.81])


def attitude():
    (cf, ct, cp), (sf, st, sp) = np.cos([PHI, THETA, PSI]), np.sin([PHI, THETA, PSI])
    about_z = np.array([[cf, -sf, 0], [sf, cf, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]])
    about_axis = np.array([[cp, -sp, 0], [sp, cp, 0], [0, 0, 1]])
    return about_z @ about_x @ about_axis


def inertia(points):
    squares = (MASSES[:, np.newaxis] * points**2).sum()
    return squares * np.eye(3) - (MASSES[:, np.newaxis] * points).T @ points


def slope(_, state):
    points = state[:12].reshape(4, 3)
    omega = np.linalg.solve(inertia(points), state[12:])
    return np.append(np.cross(omega, points), np.cross(MASSES @ points, GRAVITY))


def test_points_move_as_the_top_does(spin):
    turn = attitude()
    points = POINTS @ turn.T
    omega = RATE * np.array([0, 0, 1.0]) + SPIN * turn[:, 2]
    momentum = inertia(points) @ omega
    points = runge_kutta(slope, np.append(points, momentum), END, STEPS)[:12].reshape(4, 3)
    moments = np.diag(inertia(POINTS))
    assert np.allclose(inertia(POINTS), np.diag(moments), atol=1e-15)
    text = f"&top mass = 1  inertia = {moments[0]}, {moments[0]}, {moments[2]}  length = 0.56 /\n"
    text += f"&initial phi = {PHI}  theta = {THETA}  psi = {PSI}  phi_rate = {RATE}\n"
    text += f"  psi_rate = {SPIN} /\n&span t_end = {END}  samples = 2 /\n"
    text += "&output columns = 'q0', 'q1', 'q2', 'q3' /\n"
    q0, *v = spin(text).rows.iloc[-1]
    found = POINTS + 2 * q0 * np.cross(v, POINTS) + 2 * np.cross(v, np.cross(v, POINTS))
    assert np.abs(found - points).max() < 1e-6
