"""Effects on a body in other than principal axes, and steady precession with effects.

The same body moves in the same way, whatever the axes in which it is given.
"""

import csv
import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
INERTIA, CENTRE = np.array([0.9, 1.0, 0.3]), np.array([0.02, -0.03, 0.5])
ROTOR, DRIVE = np.array([0.2, -0.1, 0.3]), np.array([0.01, 0.02, -0.03])
TORQUE = np.array([0.05, 0, 0.1])
START, RATES = np.array([0.8, 0.6, 0, 0]), np.array([1.0, -0.5, 6.0])
TABLE = np.array([[0, 0, 0, 0], [1, 0.2, -0.1, 0.3], [3, -0.1, 0.2, 0]])
SCALARS = [
    "energy",
    "kinetic",
    "potential",
    "lz",
    "com_x",
    "com_y",
    "com_z",
    "force_x",
    "force_y",
    "force_z",
    "work",
]
SCALARS += [
    f"work_{name}" for name in ["damping", "friction", "drag", "vibration", "torque", "rotor"]
]
OTHERS = [
    "t",
    "q0",
    "q1",
    "q2",
    "q3",
    "omega1",
    "omega2",
    "omega3",
    "l3",
    "R1",
    "R2",
    "energy_error",
]


def words(values: np.ndarray) -> str:
    """Numbers of an input."""
    return ", ".join(repr(float(value)) for value in np.ravel(values))


def rotation(p: np.ndarray) -> np.ndarray:
    """The matrix of v -> p v conj(p)."""
    w, x, y, z = p
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The product of two quaternions."""
    return np.concatenate(
        [[a[0] * b[0] - a[1:] @ b[1:]], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])]
    )


def run(folder: Path, text: str) -> subprocess.CompletedProcess[str]:
    """Run an input."""
    (folder / "scene.nml").write_text(text)
    command = [EXE, "--quiet", "-o", folder, folder / "scene.nml"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def rows_of(path: Path) -> dict[str, np.ndarray]:
    """The columns of a table."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def move(folder: Path, p: np.ndarray | None, effects: str) -> dict[str, np.ndarray]:
    """The motion of the body in axes that are turned by p from its principal axes."""
    turn = np.eye(3) if p is None else rotation(p)
    tensor = turn @ np.diag(INERTIA) @ turn.T
    inertia = f"inertia = {words(INERTIA)}"
    if p is not None:
        inertia = f"inertia_tensor(1,:) = {words(tensor[0])}"
        inertia += f"  inertia_tensor(2,2:3) = {words(tensor[1, 1:])}"
        inertia += f"  inertia_tensor(3,3) = {words(tensor[2, 2])}"
    back = np.array([1, -1, -1, -1]) * (np.array([1, 0, 0, 0]) if p is None else p)
    table = TABLE.copy()
    table[:, 1:] = TABLE[:, 1:] @ turn.T
    lines = ["t,m1,m2,m3", *(",".join(repr(float(x)) for x in row) for row in table)]
    (folder / "torque.csv").write_text("\n".join(lines) + "\n")
    text = f"&top mass = 1  {inertia}  centre_of_mass = {words(turn @ CENTRE)}"
    text += "  damping = 0.02, 0.02, 0.02 /\n"
    text += f"&initial quaternion = {words(product(START, back))}"
    text += f"  omega = {words(turn @ RATES)} /\n"
    text += "&span t_end = 3  samples = 7 /\n&integration relative_tolerance = 1e-13 /\n"
    vectors = {"rotor_momentum": ROTOR, "rotor_torque": DRIVE, "torque_body": TORQUE}
    for name, value in vectors.items():
        effects = effects.replace(name, f"{name} = {words(turn @ value)}")
    text += f"&effects {effects} /\n"
    text += "&output columns = " + ", ".join(f"'{name}'" for name in OTHERS + SCALARS) + " /\n"
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    return rows_of(folder / "scene.csv")


@pytest.mark.parametrize(
    "effects",
    [
        "rotor_momentum  rotor_torque  torque_body  torque_space = 0.1, 0.2, 0.1",
        "torque_table = 'torque.csv'  torque_interpolation = 'linear'"
        "  torque_space_amplitude = 0.1, 0.2, 0.3  torque_space_rate = 4",
        "torque_table = 'torque.csv'  earth_rate = 0.3  latitude_deg = 40",
        "friction_torque = 0.1  friction_coefficient = 0.2  friction_radius = 0.02"
        "  drag_force = 0.05  drag_moment = 0.01, 0.01, 0.01  drag_exponent = 1.5"
        "  vibration_amplitude = 0.05, 0.02, 0.1  vibration_rate = 11  rotor_momentum",
    ],
)
def test_any_axes(folder: Path, effects: str) -> None:
    """Scalars and vectors in space are equal, vectors in the body turn; the balance closes."""
    p = np.array([0.5, -0.3, 0.7, 0.2])
    p /= np.linalg.norm(p)
    plain, turned = move(folder, None, effects), move(folder, p, effects)
    for name in SCALARS:
        np.testing.assert_allclose(turned[name], plain[name], rtol=0, atol=2e-10, err_msg=name)
    omega = [np.array([rows[f"omega{i}"] for i in (1, 2, 3)]) for rows in (plain, turned)]
    np.testing.assert_allclose(omega[1], rotation(p) @ omega[0], rtol=0, atol=2e-10)
    for rows in (plain, turned):
        assert np.abs(rows["energy_error"]).max() < 1e-11
        assert max(np.abs(rows["R1"]).max(), np.abs(rows["R2"]).max()) < 1e-12
    start = rotation(p) @ (INERTIA * RATES) + rotation(p) @ ROTOR * ("rotor_momentum" in effects)
    if "earth" not in effects:
        assert turned["l3"][0] == pytest.approx(start[2], abs=1e-14)


def test_rotor_on_the_axis_of_a_tensor(folder: Path) -> None:
    """A symmetric body given by a tensor, with a rotor on its axis, has its closed form."""
    tensor = "inertia_tensor(1,:) = 0.6, 0, 0.3  inertia_tensor(2,2:3) = 0.9, 0"
    tensor += "  inertia_tensor(3,3) = 0.6"
    text = f"&top mass = 1  {tensor}  centre_of_mass = 0.3, 0, -0.3 /\n"
    text += "&initial theta = 1  omega = 1, 0.2, -3 /\n&span t_end = 2  samples = 3 /\n"
    text += "&effects rotor_momentum = 0.4, 0, -0.4 /\n"
    text += "&output columns = 't', 'energy', 'lz', 'omega1', 'omega2' /\n"
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    assert "# method: exact" in (folder / "scene.csv").read_text()
    exact = rows_of(folder / "scene.csv")
    done = run(folder, text + "&integration method = 'taylor'  relative_tolerance = 1e-14 /\n")
    assert done.returncode == 0, done.stderr
    for name, values in rows_of(folder / "scene.csv").items():
        np.testing.assert_allclose(values, exact[name], rtol=0, atol=1e-11, err_msg=name)


def test_drag_that_differs(folder: Path) -> None:
    """A moment of the air that differs about axes that are not principal axes is refused."""
    text = "&top mass = 1  inertia_tensor(1,:) = 0.6, 0, 0.3  inertia_tensor(2,2:3) = 0.9, 0"
    text += "  inertia_tensor(3,3) = 0.6  length = 0.1 /\n"
    text += "&initial theta = 1  omega = 1, 0, 0 /\n&span t_end = 1 /\n"
    done = run(folder, text + "&effects drag_moment = 0.1, 0, 0 /\n")
    assert done.returncode == 2
    assert "differs about axes that are not principal axes" in " ".join(done.stderr.split())
    done = run(folder, text + "&effects drag_moment = 0.1, 0, 0.1 /\n")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("branch", ["slow", "fast"])
@pytest.mark.parametrize("spin", ["omega3 = 20", "psi_rate = 18"])
def test_steady_precession(folder: Path, branch: str, spin: str) -> None:
    """With a rotor on the axis and the Earth at a pole inclination and rates are constant."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5 /\n"
    text += f"&initial theta = 1  {spin}  steady_precession = '{branch}' /\n"
    text += "&effects rotor_momentum = 0, 0, 0.8  earth_rate = 0.3  latitude_deg = -90 /\n"
    text += "&span t_end = 20  samples = 41 /\n"
    text += "&output columns = 'theta', 'phi_rate', 'psi_rate', 'omega3' /\n"
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    rows = rows_of(folder / "scene.csv")
    np.testing.assert_allclose(rows["theta"], 1, rtol=0, atol=1e-12)
    for name in ("phi_rate", "psi_rate"):
        assert np.ptp(rows[name]) < 1e-11 * abs(rows[name][0])
    name, value = spin.split(" = ")
    assert rows[name][0] == pytest.approx(float(value), rel=1e-14)
    total = rows["phi_rate"][0] - 0.3
    momentum = 0.3 * (rows["psi_rate"][0] + total * math.cos(1)) + 0.8
    rest = 0.9 * math.cos(1) * total**2 - momentum * total + 9.81 * 0.5
    assert rest == pytest.approx(0, abs=1e-10)
    assert (abs(total) < 2) == (branch == "slow")


def test_no_steady_precession(folder: Path) -> None:
    """Other effects have none, and the message says which have."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5 /\n"
    text += "&initial theta = 1  omega3 = 20  steady_precession = 'slow' /\n&span t_end = 1 /\n"
    done = run(folder, text + "&effects drag_force = 0.1 /\n")
    assert done.returncode == 2
    assert "a held rotor on its axis and the Earth at a pole" in " ".join(done.stderr.split())
