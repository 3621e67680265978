"""Quantities of sweeps are those of body z as it was given, whatever axes compute them.

A body that is given by an inertia tensor is computed in its principal axes. The rows of its
trajectory are in the axes of the input; their extremes are those of the sweep.
"""

import csv
import math
import os
import subprocess
from pathlib import Path

import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
BODY = """\
&top mass = 2  inertia_tensor(1,:) = 0.7, 0.12, -0.1  inertia_tensor(2,2:3) = 0.9, 0.15
     inertia_tensor(3,3) = 0.6  centre_of_mass = 0.1, -0.15, 0.3  {} /
&initial theta = 1  psi = 0.3  phi_rate = 1  psi_rate = 5 /
&span t_end = 4 {} /
&integration relative_tolerance = 1e-12 /
"""
SWEEP = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = 4 /\n"
EXTREMES = "theta_min", "theta_max", "theta_rate_max", "phi_rate_max"


def rows_of(folder: Path, text: str, columns: tuple[str, ...]) -> list[dict[str, str]]:
    """The rows of the table of an input."""
    names = ", ".join(f"'{name}'" for name in columns)
    (folder / "scene.nml").write_text(text + f"&output columns = {names} /\n")
    command = [EXE, "--quiet", "-o", folder, folder / "scene.nml"]
    subprocess.run(command, check=True, capture_output=True)
    lines = (folder / "scene.csv").read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


# A plane swing about the axis (1, 0, 1) of the body, by which body z does not go over the poles.
OBLIQUE = """\
&top mass = 1  inertia = 0.9, 0.5, 0.9  centre_of_mass = 0, 0.4, 0  damping = 3*0.01  {} /
&initial theta_deg = 135  psi_deg = 90  omega = 1, 0, 1 /
&span t_end = 4 {} /
&integration relative_tolerance = 1e-12 /
"""


# Tops in closed form about body x, about body y below the pivot, about none of the body axes.
ABOUT_OTHER_AXES = [
    OBLIQUE.replace("0.9, 0.5, 0.9  centre_of_mass = 0, 0.4, 0  damping = 3*0.01", moments).replace(
        "1, 0, 1 /", "1, 0.3, 1 /"
    )
    for moments in (
        "0.25, 0.9, 0.9  centre_of_mass = 0.8, 0, 0",
        "0.9, 0.25, 0.9  centre_of_mass = 0, -0.8, 0",
    )
]
ABOUT_OTHER_AXES += [
    BODY[: BODY.index("mass = 2")]
    + "mass = 1  inertia_tensor(1,:) = 0.8, 0.1, 0.1  inertia_tensor(2,2:3) = 0.8, 0.1"
    + " inertia_tensor(3,3) = 0.8  centre_of_mass = 3*0.3 {} /\n"
    + BODY[BODY.index("&initial") :]
]


@pytest.mark.parametrize(
    ("body", "gravity"),
    [(BODY, ""), (BODY, "gravity = 0"), (OBLIQUE, ""), *((body, "") for body in ABOUT_OTHER_AXES)],
)
def test_extremes(tmp_path: Path, body: str, gravity: str) -> None:
    """Each alone and all together, against many rows of the trajectory."""
    sweep = body.format(gravity, "") + SWEEP
    (found,) = rows_of(tmp_path, sweep, EXTREMES)
    for name in EXTREMES:
        (alone,) = rows_of(tmp_path, sweep, (name,))
        assert float(alone[name]) == pytest.approx(float(found[name]), rel=1e-9), name
    columns = "t", "theta", "theta_rate", "phi_rate"
    rows = rows_of(tmp_path, body.format(gravity, "samples = 20001"), columns)
    theta, theta_rate, phi_rate = ([float(row[name]) for row in rows] for name in columns[1:])
    near = pytest.approx
    assert float(found["theta_min"]) == near(min(theta), abs=1e-4)
    assert float(found["theta_max"]) == near(max(theta), abs=1e-6)
    assert float(found["theta_rate_max"]) == near(max(map(abs, theta_rate)), rel=1e-3)
    if not gravity:
        assert float(found["phi_rate_max"]) == near(max(phi_rate, key=abs), rel=1e-5)


@pytest.mark.parametrize("body", ABOUT_OTHER_AXES)
def test_a_little_asymmetry_changes_little(tmp_path: Path, body: str) -> None:
    """With it there is no closed form, nor axis of symmetry: what a row says is of body z."""
    columns = (*EXTREMES, "com_z_min", "force_max", "motion_class", "nutation_period", "theta_end")
    tops = [
        body,
        body.replace("0.9, 0.9", "0.9, 0.90000001").replace("0.25, 0.9 ", "0.25, 0.90000001 "),
    ]
    tops[1] = tops[1].replace("(3,3) = 0.8", "(3,3) = 0.80000001")
    assert tops[0] != tops[1]
    top, other = (rows_of(tmp_path, text.format("", "") + SWEEP, columns)[0] for text in tops)
    assert top["motion_class"] == other["motion_class"]
    for name in set(columns) - {"motion_class"}:
        if other[name] != top[name]:
            assert float(top[name]) == pytest.approx(float(other[name]), rel=1e-5, abs=1e-5), name


@pytest.mark.parametrize("axis", ["0.5, 0.9, 0.9", "0.9, 0.5, 0.9"])
def test_free_body_about_another_axis(tmp_path: Path, axis: str) -> None:
    """The range of theta for all times does not depend on whether two moments are equal."""
    body = f"&top mass = 1  inertia = {axis}  length = 0 /\n"
    body += "&initial theta = 1  omega = 1, 2, 3 /\n&span t_end = 4 /\n"
    other = body.replace("0.9  length", "0.90000000001  length")
    columns = "theta_min", "theta_max", "momentum_period"
    found, expected = (rows_of(tmp_path, text + SWEEP, columns)[0] for text in (body, other))
    for name in columns:
        assert float(found[name]) == pytest.approx(float(expected[name]), rel=1e-6), name


def test_constants_of_a_free_body(tmp_path: Path) -> None:
    """They do not depend on what else is asked for."""
    sweep = BODY.format("gravity = 0", "") + SWEEP
    constants = "momentum_period", "momentum_turn", "momentum_turn_geometric", "omega_max"
    (alone,) = rows_of(tmp_path, sweep, constants)
    (beside,) = rows_of(tmp_path, sweep, (*constants, "phi_rate_max", "com_z_min"))
    for name in constants:
        assert float(alone[name]) == pytest.approx(float(beside[name]), rel=1e-14), name


@pytest.mark.parametrize("latitude", [90, -90])
def test_class_in_a_frame_that_turns(tmp_path: Path, latitude: int) -> None:
    """That of the motion as seen from outside would be another one."""
    text = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    text += "&initial theta = 0.5  omega3 = 10 /\n&span t_end = 4 /\n"
    text += f"&effects earth_rate = 0.1  latitude_deg = {latitude} /\n"
    (found,) = rows_of(tmp_path, text + SWEEP, ("motion_class",))
    assert found["motion_class"] in ("none", "cusp"), found
    assert found["notes"].startswith("no class") or found["motion_class"] == "cusp"


@pytest.mark.parametrize("frame", [0.1, 6])
@pytest.mark.parametrize(
    "start", ["theta_rate = 0.5  phi_rate = 1", "phi_rate = 0", "phi_rate = 5"]
)
@pytest.mark.parametrize("spin", [-10, 3])
def test_precession_in_a_frame_that_turns(
    tmp_path: Path, frame: float, start: str, spin: float
) -> None:
    """The rate of either turning point, or one in between, is the largest relative to the frame."""
    body = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    body += f"&initial theta = 0.7  {start}  psi_rate = {spin} /\n"
    body += f"&effects earth_rate = {frame}  latitude_deg = 90 /\n"
    (found,) = rows_of(tmp_path, body + "&span t_end = 9 /\n" + SWEEP, ("phi_rate_max",))
    rows = rows_of(tmp_path, body + "&span t_end = 9  samples = 9001 /\n", ("t", "phi_rate"))
    largest = max((float(row["phi_rate"]) for row in rows), key=abs)
    assert float(found["phi_rate_max"]) == pytest.approx(largest, rel=1e-4)


@pytest.mark.parametrize("end", [1.2, 2, 12])
@pytest.mark.parametrize("across", ["0", "1e-12", "1e-8", "1e-7"])
def test_swing_over_poles(tmp_path: Path, end: float, across: str) -> None:
    """The nutation rate is largest where the body hangs, in a pole: by the energy."""
    text = "&top mass = 1  inertia = 0.9, 0.8, 0.25  length = 0.3 /\n"
    text += f"&initial theta = 1  omega = 1, {across}, 0 /\n&span t_end = {end} /\n"
    sweep = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = "
    (found,) = rows_of(tmp_path, text + sweep + f"{end} /\n", ("theta_rate_max",))
    largest = math.sqrt(1 + 2 * 9.81 * 0.3 * (1 + math.cos(1)) / 0.9)
    assert float(found["theta_rate_max"]) == pytest.approx(largest, abs=1e-6 + 3 * float(across))


@pytest.mark.parametrize("method", ["taylor", "dop853"])
@pytest.mark.parametrize("psi", [0, 45, 100])
def test_nutation_rate_from_a_pole(tmp_path: Path, psi: int, method: str) -> None:
    """That of the start, which is largest here: sin(180 deg) is not zero to a computer."""
    text = "&top mass = 1  inertia = 0.5, 0.7, 0.9  length = 0.8  damping = 0.05, 0.02, 0.01 /\n"
    text += f"&initial theta_deg = 180  psi_deg = {psi}  omega = 1.8, 2.4, 0 /\n&span t_end = 4 /\n"
    text += f"&integration method = '{method}' /\n"
    (found,) = rows_of(tmp_path, text + SWEEP, ("theta_rate_max",))
    assert float(found["theta_rate_max"]) == pytest.approx(3, rel=1e-9)


@pytest.mark.parametrize(("rate", "kind"), [(1, "libration"), (6, "circulation")])
def test_class_of_a_swing(tmp_path: Path, rate: float, kind: str) -> None:
    """A plane motion does not precess, whatever rounding does near the poles."""
    text = "&top mass = 1  inertia = 0.9, 0.8, 0.25  length = 0.3 /\n"
    text += f"&initial theta = 1  omega = {rate}, 0, 0 /\n&span t_end = 12 /\n"
    sweep = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = 12 /\n"
    (found,) = rows_of(tmp_path, text + sweep, ("phi_rate_max", "motion_class"))
    assert float(found["phi_rate_max"]) == 0
    assert found["motion_class"] == kind


def test_force_on_a_balanced_body(tmp_path: Path) -> None:
    """It is the weight, all the time."""
    text = "&top mass = 2  inertia = 0.7, 0.9, 0.6  length = 0 /\n"
    text += "&initial theta = 1  omega = 1, 2, 3 /\n&span t_end = 4 /\n"
    names = "force_max", "force_z_min", "force_z_max"
    (found,) = rows_of(tmp_path, text + SWEEP, names)
    assert found["status"] == "ok"
    for name in names:
        assert float(found[name]) == pytest.approx(2 * 9.81, rel=1e-12), name


def test_a_slow_sleeping_top(tmp_path: Path) -> None:
    """Below the threshold the axis has no period, and no spin in one: that is no failure."""
    text = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
    text += "&initial theta = 0  psi_rate = 5 /\n&span t_end = 4 /\n"
    (found,) = rows_of(tmp_path, text + SWEEP, ("nutation_period", "spin_per_nutation"))
    assert (found["status"], found["nutation_period"], found["spin_per_nutation"]) == (
        "ok",
        "nan",
        "nan",
    )


@pytest.mark.parametrize("columns", [(), ("motion_class",)])
def test_precession_of_a_free_top(tmp_path: Path, columns: tuple[str, ...]) -> None:
    """The axis circles the momentum, and with it the vertical or not: whole turns."""
    text = "&top mass = 1  inertia = 0.9, 0.9, 0.25  length = 0 /\n"
    text += "&initial theta = 1  theta_rate = 0.3  psi_rate = 5 /\n&span t_end = 4 /\n"
    text += "&study kind = 'sweep' /\n"
    text += "&sweep parameter = 'initial.phi_rate'  from = -9  to = 9  count = 60 /\n"
    wanted = ("precession_per_nutation", "precession_rate", "nutation_period", "nutations_per_turn")
    turns = set()
    for row in rows_of(tmp_path, text, (*wanted, *columns)):
        precession, rate, period, per_turn = (float(row[name]) for name in wanted)
        assert precession in (-2 * math.pi, 0, 2 * math.pi)
        assert rate == pytest.approx(precession / period, rel=1e-14)
        assert per_turn == 1 if precession else math.isnan(per_turn)
        turns.add(precession)
    assert len(turns) == 3
