"""Effects on a body in other than principal axes, and steady precession with effects.

The same body moves in the same way, whatever the axes in which it is given.
"""

import math

import numpy as np
import pytest

from conftest import each, largest, output
from mechanics import product, rotation

INERTIA, CENTRE = np.array([0.9, 1.0, 0.3]), np.array([0.02, -0.03, 0.5])
VECTORS = {
    "rotor_momentum": np.array([0.2, -0.1, 0.3]),
    "rotor_torque": np.array([0.01, 0.02, -0.03]),
    "torque_body": np.array([0.05, 0, 0.1]),
}
START, RATES = np.array([0.8, 0.6, 0, 0]), np.array([1.0, -0.5, 6.0])
TABLE = np.array([[0, 0, 0, 0], [1, 0.2, -0.1, 0.3], [3, -0.1, 0.2, 0]])
OMEGA = ["omega1", "omega2", "omega3"]
SCALARS = ["energy", "kinetic", "potential", "lz", "com_x", "com_y", "com_z"]
SCALARS += ["force_x", "force_y", "force_z", "work"]
SCALARS += [
    f"work_{name}" for name in ["damping", "friction", "drag", "vibration", "torque", "rotor"]
]
OTHERS = ["t", "q0", "q1", "q2", "q3", *OMEGA, "l3", "R1", "R2", "energy_error"]
TENSOR = "inertia_tensor(1,:) = {}  inertia_tensor(2,2:3) = {}  inertia_tensor(3,3) = {}"


def words(values):
    return ", ".join(repr(float(value)) for value in np.ravel(values))


def move(spin, p, effects):
    """The motion of the body in axes that are turned by p from its principal axes, or in these."""
    turn, inertia, back = np.eye(3), f"inertia = {words(INERTIA)}", np.array([1, 0, 0, 0])
    if p is not None:
        turn, back = rotation(p), np.array([1, -1, -1, -1]) * p
        tensor = turn @ np.diag(INERTIA) @ turn.T
        inertia = TENSOR.format(words(tensor[0]), words(tensor[1, 1:]), words(tensor[2, 2]))
    table = TABLE.copy()
    table[:, 1:] = TABLE[:, 1:] @ turn.T
    lines = ["t,m1,m2,m3", *(",".join(repr(float(x)) for x in row) for row in table), ""]
    text = f"&top mass = 1  {inertia}  centre_of_mass = {words(turn @ CENTRE)}"
    text += "  damping = 0.02, 0.02, 0.02 /\n"
    text += f"&initial quaternion = {words(product(START, back))}"
    text += f"  omega = {words(turn @ RATES)} /\n"
    text += "&span t_end = 3  samples = 7 /\n&integration relative_tolerance = 1e-13 /\n"
    for name, value in VECTORS.items():
        effects = effects.replace(name, f"{name} = {words(turn @ value)}")
    text += f"&effects {effects} /\n"
    return spin(text + output(*OTHERS, *SCALARS), torque="\n".join(lines)).rows


@each(
    "effects",
    "rotor_momentum  rotor_torque  torque_body  torque_space = 0.1, 0.2, 0.1",
    "torque_table = 'torque.csv'  torque_interpolation = 'linear'"
    "  torque_space_amplitude = 0.1, 0.2, 0.3  torque_space_rate = 4",
    "torque_table = 'torque.csv'  earth_rate = 0.3  latitude_deg = 40",
    "friction_torque = 0.1  friction_coefficient = 0.2  friction_radius = 0.02"
    "  drag_force = 0.05  drag_moment = 0.01, 0.01, 0.01  drag_exponent = 1.5"
    "  vibration_amplitude = 0.05, 0.02, 0.1  vibration_rate = 11  rotor_momentum",
)
def test_any_axes(spin, effects):
    """Scalars and vectors in space are equal, vectors in the body turn; the balance closes."""
    p = np.array([0.5, -0.3, 0.7, 0.2])
    p /= np.linalg.norm(p)
    plain, turned = move(spin, None, effects), move(spin, p, effects)
    np.testing.assert_allclose(turned[SCALARS], plain[SCALARS], rtol=0, atol=2e-10)
    expected = plain[OMEGA].to_numpy() @ rotation(p).T
    np.testing.assert_allclose(turned[OMEGA], expected, rtol=0, atol=2e-10)
    for rows in (plain, turned):
        assert largest(rows.energy_error) < 1e-11
        assert largest(rows[["R1", "R2"]]) < 1e-12
    rotor = VECTORS["rotor_momentum"] * ("rotor_momentum" in effects)
    if "earth" not in effects:
        start = rotation(p) @ (INERTIA * RATES + rotor)
        assert turned.l3[0] == pytest.approx(start[2], abs=1e-14)


INCLINED = TENSOR.format("0.6, 0, 0.3", "0.9, 0", "0.6")


def test_rotor_on_the_axis_of_a_tensor(spin):
    """A symmetric body given by a tensor, with a rotor on its axis, has its closed form."""
    text = f"&top mass = 1  {INCLINED}  centre_of_mass = 0.3, 0, -0.3 /\n"
    text += "&initial theta = 1  omega = 1, 0.2, -3 /\n&span t_end = 2  samples = 3 /\n"
    text += "&effects rotor_momentum = 0.4, 0, -0.4 /\n"
    text += output("t", "energy", "lz", "omega1", "omega2")
    exact = spin(text)
    assert "method: exact" in "\n".join(exact.comments)
    text += "&integration method = 'taylor'  relative_tolerance = 1e-14 /\n"
    found = spin(text)
    np.testing.assert_allclose(found.rows, exact.rows, rtol=0, atol=1e-11)


def test_drag_that_differs(spin):
    text = f"&top mass = 1  {INCLINED}  length = 0.1 /\n"
    text += "&initial theta = 1  omega = 1, 0, 0 /\n&span t_end = 1 /\n"
    error = spin(text + "&effects drag_moment = 0.1, 0, 0 /\n", code=2).err
    assert "differs about axes that are not principal axes" in error
    spin(text + "&effects drag_moment = 0.1, 0, 0.1 /\n")


@each("branch", "slow", "fast")
@each("name, rate", ("omega3", 20), ("psi_rate", 18))
def test_steady_precession(spin, branch, name, rate):
    """With a rotor on the axis and the Earth at a pole inclination and rates are constant."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5 /\n"
    text += f"&initial theta = 1  {name} = {rate}  steady_precession = '{branch}' /\n"
    text += "&effects rotor_momentum = 0, 0, 0.8  earth_rate = 0.3  latitude_deg = -90 /\n"
    text += "&span t_end = 20  samples = 41 /\n"
    rows = spin(text + output("theta", "phi_rate", "psi_rate", "omega3")).rows
    np.testing.assert_allclose(rows.theta, 1, rtol=0, atol=1e-12)
    for column in (rows.phi_rate, rows.psi_rate):
        assert np.ptp(column) < 1e-11 * abs(column[0])
    assert rows[name][0] == pytest.approx(rate, rel=1e-14)
    total = rows.phi_rate[0] - 0.3
    momentum = 0.3 * (rows.psi_rate[0] + total * math.cos(1)) + 0.8
    rest = 0.9 * math.cos(1) * total**2 - momentum * total + 9.81 * 0.5
    assert rest == pytest.approx(0, abs=1e-10)
    assert (abs(total) < 2) == (branch == "slow")


def test_no_steady_precession(spin):
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5 /\n"
    text += "&initial theta = 1  omega3 = 20  steady_precession = 'slow' /\n&span t_end = 1 /\n"
    error = spin(text + "&effects drag_force = 0.1 /\n", code=2).err
    assert "a held rotor on its axis and the Earth at a pole" in error
