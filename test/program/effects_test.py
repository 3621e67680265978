"""Bodies with effects: reference motions, closed forms, rest under dry friction, refused inputs.

The references (test/reference/l_*.json) contain their inputs.
"""

import csv
import json
import math
import os
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
REFERENCES = ROOT / "test/reference"

TOP = "mass = 1  gravity = 9.81  inertia = 0.9, 0.9, 0.3  centre_of_mass = 0, 0, 0.5"
FREE = "mass = 1  gravity = 9.81  inertia = 0.9, 0.9, 0.3  centre_of_mass = 0, 0, 0"
SKEW = "mass = 1  gravity = 9.81  inertia = 0.9, 1.0, 0.3  centre_of_mass = 0.02, -0.03, 0.5"
TIGHT = "relative_tolerance = 1e-14"
COLUMNS = [
    "t",
    "phi",
    "theta",
    "psi",
    "omega1",
    "omega2",
    "omega3",
    "q0",
    "q1",
    "q2",
    "q3",
    "gamma1",
    "gamma2",
    "gamma3",
    "energy",
    "lz",
    "l3",
    "energy_error",
    "R1",
    "R2",
    "force_x",
    "force_y",
    "force_z",
    "work",
    "work_damping",
    "work_friction",
    "work_drag",
    "work_vibration",
    "work_torque",
    "work_rotor",
]


class Motion(NamedTuple):
    """A trajectory: its rows and the words of its last line."""

    rows: list[dict[str, float]]
    status: str
    time: float

    @property
    def last(self) -> dict[str, float]:
        """The last row."""
        return self.rows[-1]


def run(folder: Path, text: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Run an input."""
    (folder / "scene.nml").write_text(text)
    return subprocess.run(
        [EXE, "--quiet", "-o", folder, *options, folder / "scene.nml"],
        capture_output=True,
        text=True,
        check=False,
    )


def move(folder: Path, text: str) -> Motion:
    """Compute a trajectory; it must come to a good end."""
    names = ", ".join(f"'{name}'" for name in COLUMNS)
    done = run(folder, text + f"\n&output columns = {names} /\n")
    assert done.returncode == 0, done.stderr
    lines = (folder / "scene.csv").read_text().splitlines()
    words = lines[-2].removeprefix("# status: ").split()
    table = csv.DictReader(line for line in lines if not line.startswith("#"))
    rows = [{name: float(cell) for name, cell in row.items()} for row in table]
    return Motion(rows, words[0], float(words[-1]) if len(words) > 1 else math.nan)


def scene(top: str, initial: str, span: str, effects: str, integration: str = TIGHT) -> str:
    """Write an input."""
    groups = {"top": top, "initial": initial, "span": span, "effects": effects}
    groups["integration"] = integration
    return "".join(f"&{name} {keys} /\n" for name, keys in groups.items())


def refused(folder: Path, text: str, *words: str) -> None:
    """Expect an input to be refused with a message that has these words."""
    done = run(folder, text)
    assert done.returncode != 0
    message = " ".join(done.stderr.split())
    for word in words:
        assert word in message, message


NAMES = sorted(path.stem for path in REFERENCES.glob("l_*.json"))
METHODS = {
    "taylor": ("method = 'taylor'  relative_tolerance = 1e-14", 1e-11),
    "dop853": ("method = 'dop853'  relative_tolerance = 1e-12", 1e-9),
    "ode45": ("method = 'ode45'  relative_tolerance = 1e-9", 1e-6),
    "gauss": ("method = 'gauss_8'  steps = 1000", 1e-8),
    "lie": ("method = 'rkmk_4'  steps = 4000", 1e-5),
    "arkode": ("method = 'arkode_erk'  relative_tolerance = 1e-11", 1e-8),
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("method", METHODS)
def test_references(folder: Path, name: str, method: str) -> None:
    """Every reference motion, its energy and its works, by methods of all families."""
    reference = json.loads((REFERENCES / f"{name}.json").read_text())
    settings, tolerance = METHODS[method]
    if "table" in reference["namelist"]:
        (folder / "l_torque_3_table.csv").write_text(
            (REFERENCES / "l_torque_3_table.csv").read_text()
        )
        tolerance = max(
            tolerance, {"gauss": 1e-4, "lie": 1e-4}.get(method, 0)
        )  # steps do not end at knots
    text = reference["namelist"].replace("t_end = 1000", "t_end = 8")
    stuck = reference.get("status") == "stuck"
    if stuck and "steps" in settings:
        pytest.skip("rest is found to a step")
    end = 8.0 if stuck else float(reference["rows"][-1][0])
    samples = round(end * (4 if stuck else 10)) + 1
    text = (
        text.replace("&span t_end", f"&span samples = {samples}  t_end")
        + f"&integration {settings} /\n"
    )
    motion = move(folder, text)
    at = {round(row["t"], 9): row for row in motion.rows}
    compared = 0
    for values in reference["rows"]:
        known = dict(zip(reference["columns"], map(float, values), strict=True))
        row = at.get(round(known["t"], 9))
        if row is None:
            continue
        compared += 1
        sign = math.copysign(1, sum(row[f"q{i}"] * known[f"q{i}"] for i in range(4)))
        pairs = [(sign * row[f"q{i}"], known[f"q{i}"]) for i in range(4)]
        pairs += [(row[f"omega{i}"], known[f"w{i}"]) for i in (1, 2, 3)]
        pairs += [(row[f"gamma{i}"], known[f"G{i}"]) for i in (1, 2, 3)]
        pairs += [(row["l3"], known["P3"]), (row["energy"], known["E"]), (row["work"], known["W"])]
        pairs += [(row["work_" + key[2:]], known[key]) for key in known if key.startswith("W_")]
        pairs += [(row["lz"], sum(known[f"P{i}"] * known[f"G{i}"] for i in (1, 2, 3)))]
        for ours, theirs in pairs:
            assert ours == pytest.approx(theirs, abs=tolerance * max(1, abs(theirs)))
        assert abs(row["energy_error"]) < tolerance
        assert max(abs(row["R1"]), abs(row["R2"])) < 1e-12
    assert compared >= 5
    if stuck:
        assert motion.status == "at_rest"
        assert motion.time == pytest.approx(float(reference["t_stuck"]), rel=max(tolerance, 1e-12))


@pytest.mark.parametrize("name", ["l_combined_1", "l_torque_3"])
def test_quadruple(folder: Path, name: str) -> None:
    """The series in quadruple precision is the same motion, to the rounding of the table."""
    reference = json.loads((REFERENCES / f"{name}.json").read_text())
    (folder / "l_torque_3_table.csv").write_text((REFERENCES / "l_torque_3_table.csv").read_text())
    text = reference["namelist"].replace("&span", "&span samples = 21 ")
    motion = move(
        folder, text + "&integration method = 'taylor_quadruple'  relative_tolerance = 1e-25 /\n"
    )
    known = dict(zip(reference["columns"], map(float, reference["rows"][-1]), strict=True))
    for i in (1, 2, 3):
        assert motion.last[f"omega{i}"] == pytest.approx(known[f"w{i}"], abs=2e-14)


def test_spin_down(folder: Path) -> None:
    """Dry friction with load, damping and drag about a fixed axis, to rest."""
    motion = move(
        folder,
        scene(
            FREE + "  damping = 0, 0, 0.01",
            "theta = 1  omega = 0, 0, 12",
            "t_end = 30  samples = 31",
            "friction_torque = 0.02  friction_coefficient = 0.3  friction_radius = 0.01  "
            "drag_moment = 0, 0, 0.003",
        ),
    )
    assert motion.rows[2]["omega3"] == pytest.approx(8.846626858973130, rel=1e-13)
    assert motion.status == "at_rest"
    assert motion.time == pytest.approx(23.86289777879196, rel=1e-13)
    assert motion.last["psi"] == pytest.approx(85.16613498183026, rel=1e-13)
    assert motion.last["omega3"] == 0
    assert abs(motion.last["energy_error"]) < 1e-13
    # The dry moment is on the load that the table shows.
    assert motion.rows[2]["force_z"] == pytest.approx(9.81, rel=1e-14)


def test_stop_of_a_coning_body(folder: Path) -> None:
    """The direction of the angular velocity tends to an axis while friction stops the body."""
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 3, 0, 10",
            "t_end = 100  samples = 11",
            "friction_torque = 0.05",
        ),
    )
    assert motion.status == "at_rest"
    assert motion.time == pytest.approx(88.49423948083030, rel=1e-11)


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_swings_with_friction(folder: Path, method: str) -> None:
    """A pendulum stops at each turning point and starts again, until friction holds it."""
    motion = move(
        folder,
        scene(
            TOP,
            f"theta = {math.pi - 2!r}  omega = 0, 0, 0",
            "t_end = 12  samples = 12001",
            "friction_torque = 0.5",
            f"method = '{method}'  relative_tolerance = 1e-12",
        ),
    )
    height = [row["gamma3"] for row in motion.rows]
    # Angles from the lowest point, by parabolas through the highest of the rows.
    turns = []
    for i in range(1, len(height) - 1):
        if height[i - 1] < height[i] >= height[i + 1] and height[i] - height[i - 1] > 1e-9:
            turns.append((motion.rows[i]["t"], math.acos(-height[i])))
    assert turns[0] == pytest.approx((1.710219112097427, 1.618139306842915), abs=1e-3)
    assert turns[0][1] == pytest.approx(1.618139306842915, abs=2e-6)
    assert turns[1][1] == pytest.approx(1.316258808776618, abs=2e-6)
    assert motion.status == "at_rest"
    # It lies where friction can hold it, and the first such turning point ends the motion.
    assert 9.81 * 0.5 * math.sin(math.acos(-height[-1])) <= 0.5
    assert abs(motion.last["energy_error"]) < 1e-10


@pytest.mark.parametrize(
    ("exponent", "end"),
    [(1.5, 4.140437573436630), (1.8, 1.952020936566768), (2, 1.445783132530120)],
)
def test_drag_about_an_axis(folder: Path, exponent: float, end: float) -> None:
    """Spin-down in air with any exponent."""
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0, 0, 40",
            "t_end = 10  samples = 11",
            f"drag_moment = 0, 0, 0.02  drag_exponent = {exponent}",
        ),
    )
    assert motion.last["omega3"] == pytest.approx(end, rel=1e-13)


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_swings_in_air(folder: Path, method: str) -> None:
    """A plane pendulum with drag: the force changes its branch at each turning point."""
    motion = move(
        folder,
        scene(
            TOP,
            f"theta = {math.pi - 2!r}  omega = 0, 0, 0",
            "t_end = 5  samples = 10001",
            "drag_force = 0.5",
            f"method = '{method}'  relative_tolerance = 1e-12",
        ),
    )
    height = [row["gamma3"] for row in motion.rows]
    turns = [
        math.acos(-height[i])
        for i in range(1, len(height) - 1)
        if height[i - 1] < height[i] >= height[i + 1]
    ]
    assert turns[0] == pytest.approx(1.607630028664216, abs=4e-7)
    assert turns[1] == pytest.approx(1.365912156777692, abs=4e-7)


SHIFTS = [
    ("rotor_momentum = 0, 0, 0.8", (1.129399513883146, 12.75286737897582, 98.84611312231331)),
    (
        "earth_rate = 0.3  latitude_deg = 90",
        (1.499191437135319, 12.19972469541215, 101.1994868071405),
    ),
    (
        "rotor_momentum = 0, 0, 0.8  earth_rate = 0.3  latitude_deg = 90",
        (1.027191877028727, 10.60877037794142, 99.00722644549234),
    ),
]


@pytest.mark.parametrize(("effects", "angles"), SHIFTS)
@pytest.mark.parametrize(
    "integration",
    [
        "method = 'exact'",
        "method = 'dop853'  relative_tolerance = 1e-13",
        "formulation = 'lagrange'  method = 'dop853'  relative_tolerance = 1e-13",
        "method = 'splitting_8'  steps = 20000",
    ],
)
def test_exact_with_effects(
    folder: Path, effects: str, angles: tuple[float, ...], integration: str
) -> None:
    """A held rotor on the axis and the Earth at a pole keep closed form and formulations."""
    motion = move(
        folder,
        scene(
            TOP,
            "theta = 1  phi_rate = 0.2  theta_rate = 0.1  psi_rate = 10",
            "t_end = 10  samples = 11",
            effects,
            integration,
        ),
    )
    theta, phi, psi = angles
    tolerance = 1e-13 if "exact" in integration else 1e-9
    assert motion.last["theta"] == pytest.approx(theta, abs=tolerance)
    assert motion.last["phi"] == pytest.approx(phi, abs=10 * tolerance)
    assert motion.last["psi"] == pytest.approx(psi, abs=100 * tolerance)
    # Energy and momentum are those of the body with its effects.
    assert abs(motion.last["energy_error"]) < max(tolerance, 1e-12)
    assert motion.last["lz"] == pytest.approx(motion.rows[0]["lz"], rel=1e-9)
    assert max(abs(row["R1"]) + abs(row["R2"]) for row in motion.rows) < 1e-9


def test_exact_with_effects_is_that_of_rigid_body(folder: Path) -> None:
    """The shifted closed form is the motion of the full equations, support force included."""
    effects = "rotor_momentum = 0.8, 0, 0  earth_rate = 0.3  latitude_deg = -90"
    top = "mass = 1  gravity = 9.81  inertia = 0.3, 0.9, 0.9  centre_of_mass = -0.5, 0, 0"
    initial = "quaternion = 0.8, 0.6, 0, 0  omega = 10, 0.3, -0.2"
    span = "t_end = 3  samples = 31"
    exact = move(folder, scene(top, initial, span, effects, "method = 'exact'"))
    # A torque too small to matter excludes the closed form.
    other = move(folder, scene(top, initial, span, effects + "  torque_body = 0, 0, 1e-30"))
    for one, two in zip(exact.rows, other.rows, strict=True):
        sign = math.copysign(1, one["q0"] * two["q0"] + one["q1"] * two["q1"])
        for name in (
            "omega1",
            "omega2",
            "omega3",
            "force_x",
            "force_y",
            "force_z",
            "energy",
            "lz",
            "theta",
        ):
            assert one[name] == pytest.approx(two[name], abs=1e-10), name
        for name in ("q0", "q1", "q2", "q3"):
            assert sign * one[name] == pytest.approx(two[name], abs=1e-12), name


def test_gyroscope_keeps_its_direction(folder: Path) -> None:
    """On the rotating Earth the axis of a free symmetric body turns against it."""
    latitude = math.radians(50)
    earth = (0.0, 0.3 * math.cos(latitude), 0.3 * math.sin(latitude))
    c, s = 0.8**2 - 0.6**2, 2 * 0.8 * 0.6
    omega = (-earth[0], -c * earth[1] - s * earth[2], 20 + s * earth[1] - c * earth[2])
    motion = move(
        folder,
        scene(
            FREE,
            "quaternion = 0.8, 0.6, 0, 0  omega = " + ", ".join(map(repr, omega)),
            "t_end = 10  samples = 11",
            "earth_rate = 0.3  latitude_deg = 50",
        ),
    )
    q0, q1, q2, q3 = (motion.last[f"q{i}"] for i in range(4))
    axis = (2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), q0**2 + q3**2 - q1**2 - q2**2)
    assert axis == pytest.approx(
        (-0.1291788840124092, 0.4354309177312228, -0.8909055684016424), abs=1e-12
    )


def test_gyrocompass(folder: Path) -> None:
    """Small swings of a pendulous gyroscope about north on the Earth."""
    top = "mass = 2  gravity = 9.81  inertia = 0.02, 0.015, 0.01  centre_of_mass = 0, 0, -0.01"
    latitude = math.radians(50)
    rate = 7.292115e-5
    load = 2 * 9.81 * 0.01
    # Equilibrium: the rotor rises above the horizon by h Oe sin(lat)/(m g l).
    tilt = 0.05 * rate * math.sin(latitude) / load
    small = 1e-3
    motion = move(
        folder,
        scene(
            top,
            f"phi = {small!r}  theta = {tilt!r}  psi = 0  omega = 0, 0, 0",
            "t_end = 700  samples = 1401",
            f"rotor_momentum = 0, 0.05, 0  earth_rate = {rate!r}  latitude_deg = 50",
            "relative_tolerance = 1e-12",
        ),
    )
    # Azimuth of body y, where the rotor points, from north.
    azimuth = []
    for row in motion.rows:
        q0, q1, q2, q3 = (row[f"q{i}"] for i in range(4))
        azimuth.append(math.atan2(-2 * (q1 * q2 - q0 * q3), q0**2 - q1**2 + q2**2 - q3**2))
    # Two passages of north in the same sense are a period apart; the fast nutation is tiny.
    passages = [
        motion.rows[i]["t"] + 0.5 * azimuth[i] / (azimuth[i] - azimuth[i + 1])
        for i in range(len(azimuth) - 1)
        if azimuth[i] * azimuth[i + 1] < 0
    ]
    assert 2 * (passages[1] - passages[0]) == pytest.approx(618.9378838177327, rel=2e-3)


def test_driven_rotor(folder: Path) -> None:
    """A rotor that is spun up on the axis of a free symmetric body."""
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0.5, 0, 3",
            "t_end = 10  samples = 11",
            "rotor_momentum = 0, 0, 2  rotor_torque = 0, 0, 0.1",
        ),
    )
    omega = [motion.last[f"omega{i}"] for i in (1, 2, 3)]
    assert omega == pytest.approx([0.4996132792811143, 0.01966141312244184, -1 / 3], abs=1e-12)
    assert motion.last["work"] == pytest.approx(motion.last["work_rotor"], abs=0)
    assert abs(motion.last["energy_error"]) < 1e-13


def test_body_torque(folder: Path) -> None:
    """A constant torque in the axes of a symmetric body."""
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0.5, 0, 3",
            "t_end = 10  samples = 11",
            "torque_body = 0.2, 0.1, 0.06",
        ),
    )
    omega = [motion.last[f"omega{i}"] for i in (1, 2, 3)]
    assert omega == pytest.approx([0.1615452243395345, -0.5108514627490013, 5], abs=1e-12)


def write_cubic(folder: Path) -> None:
    """Write a table whose spline is the cubic itself."""
    rows = [
        f"{t},0,0,{0.1 - 0.2 * t + 0.05 * t**2 - 0.003 * t**3!r}" for t in (0, 1, 2.5, 4, 7, 10)
    ]
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + "\n".join(rows) + "\n")


@pytest.mark.parametrize("method", ["taylor", "dop853", "arkode_erk"])
def test_torque_table(folder: Path, method: str) -> None:
    """A spline through rows of a cubic is the cubic; its integral is the spin."""
    write_cubic(folder)
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0, 0, 3",
            "t_end = 10  samples = 11",
            "torque_table = 'torque.csv'  torque_interpolation = 'spline'",
            f"method = '{method}'  relative_tolerance = 1e-11",
        ),
    )
    assert motion.last["omega3"] == pytest.approx(
        32 / 9, rel=1e-9 if method == "arkode_erk" else 1e-12
    )


def test_monotone_table(folder: Path) -> None:
    """The monotone interpolation does not overshoot: a ramp stays between its levels."""
    (folder / "torque.csv").write_text("t,m1,m2,m3\n0,0,0,0\n1,0,0,0\n2,0,0,1\n3,0,0,1\n")
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0, 0, 0.3",
            "t_end = 3  samples = 301",
            "torque_table = 'torque.csv'  torque_interpolation = 'monotone'",
        ),
    )
    spin = [row["omega3"] for row in motion.rows]
    assert all(spin[i] <= spin[i + 1] + 1e-15 for i in range(300))
    assert spin[100] == pytest.approx(0.3, abs=1e-14)
    # By symmetry the ramp has the mean of its levels.
    assert 0.3 * (spin[200] - 0.3) == pytest.approx(0.5, rel=1e-12)


def test_energy_that_effects_brought(folder: Path) -> None:
    """At rest without weight there is no energy at the start to compare an error with."""
    top = "mass = 1  gravity = 0  inertia = 0.9, 0.9, 0.3  length = 0.5"
    span = "t_end = 2.5  samples = 20"
    motion = move(folder, scene(top, "theta = 3.1", span, "torque_body = -0.7742, 0, 0"))
    assert max(row["work"] for row in motion.rows) > 1
    assert max(abs(row["energy_error"]) for row in motion.rows) < 1e-14
    text = scene(top, "theta = 3.1", span, "torque_body = -0.7742, 0, 0")
    text = text.replace("samples = 20 ", "")
    sweep = "&sweep parameter = 'top.mass'  values(1, :) = 1, 2 /\n"
    output = "&output columns = 'energy_error_max' /\n"
    assert run(folder, "&study kind = 'sweep' /\n" + text + sweep + output).returncode == 0
    table = (folder / "scene.csv").read_text().splitlines()
    rows = csv.DictReader(line for line in table if not line.startswith("#"))
    assert max(float(row["energy_error_max"]) for row in rows) < 1e-14


def test_start_from_rest(folder: Path) -> None:
    """From rest the body starts along the u of lambda u_i = (T_i - M u_i)/I_i."""
    for method in ("taylor", "dop853"):
        motion = move(
            folder,
            scene(
                SKEW,
                "quaternion = 0.8, 0.6, 0, 0  omega = 0, 0, 0",
                "t_end = 1e-4  samples = 2",
                "friction_torque = 0.5",
                f"method = '{method}'  relative_tolerance = 1e-12",
            ),
        )
        omega = [motion.last[f"omega{i}"] for i in (1, 2, 3)]
        size = math.hypot(*omega)
        assert size / 1e-4 == pytest.approx(4.793614857683359, rel=1e-7)
        direction = [w / size for w in omega]
        assert direction == pytest.approx(
            [0.9952122644708552, 0.01037778559206357, -0.09718461922031603], abs=1e-6
        )


def test_shaken_loose(folder: Path) -> None:
    """A lying body starts when a growing torque exceeds the friction, and only then."""
    (folder / "torque.csv").write_text("t,m1,m2,m3\n0,0,0,0\n10,0,0,1\n")
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0, 0, 0",
            "t_end = 10  samples = 101",
            "friction_torque = 0.5  torque_table = 'torque.csv'",
        ),
    )
    assert motion.status == "ok"
    for row in motion.rows:
        beyond = max(row["t"] - 5, 0)
        assert row["omega3"] == pytest.approx(0.1 * beyond**2 / 2 / 0.3, abs=1e-9)


def test_smooth_friction_creeps(folder: Path) -> None:
    """Smoothed friction never holds a body: it creeps with eps |T|/sqrt(M^2 - T^2)."""
    motion = move(
        folder,
        scene(
            FREE,
            "theta = 1  omega = 0, 0, 0",
            "t_end = 1  samples = 11",
            "friction_torque = 0.5  friction_smoothing = 0.01  torque_body = 0, 0, 0.3",
            "method = 'gauss_6'  steps = 2000",
        ),
    )
    assert motion.status == "ok"
    assert motion.last["omega3"] == pytest.approx(0.01 * 0.3 / 0.4, rel=1e-9)


@pytest.mark.parametrize(("rate", "rises"), [(39.6, True), (39.8, False)])
def test_upright_by_vibration(folder: Path, rate: float, rises: bool) -> None:
    """A vertical vibration of the pivot holds a body upright from a rate of 39.678 rad/s on."""
    motion = move(
        folder,
        scene(
            TOP,
            "theta = 1e-6  omega = 0, 0, 0",
            "t_end = 60  samples = 6001",
            f"vibration_amplitude = 0, 0, 0.15  vibration_rate = {rate}",
            "relative_tolerance = 1e-10",
        ),
    )
    largest = max(math.hypot(row["gamma1"], row["gamma2"]) for row in motion.rows)
    assert (largest > 1e-4) == rises


def test_sweep(folder: Path) -> None:
    """Cases of a sweep: closed form without effects, rest with friction, and the time of rest."""
    text = (
        f"&study kind = 'sweep' /\n&top {FREE} /\n&initial theta = 1  omega = 0, 0, 12 /\n"
        "&span t_end = 100 /\n&effects friction_torque = 0.1 /\n"
        "&integration relative_tolerance = 1e-12 /\n"
        "&sweep parameter = 'effects.friction_torque'  values(1, :) = 0, 0.05, 0.1 /\n"
        "&output columns = 'psi_end', 't_stuck', 'energy_error_max' /\n"
    )
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    lines = [
        line for line in (folder / "scene.csv").read_text().splitlines() if not line.startswith("#")
    ]
    rows = list(csv.DictReader(lines))
    assert [row["status"] for row in rows] == ["ok", "at_rest", "at_rest"]
    assert float(rows[0]["psi_end"]) == pytest.approx(1200, rel=1e-12)
    for row, torque in zip(rows[1:], (0.05, 0.1), strict=True):
        assert float(row["t_stuck"]) == pytest.approx(0.3 * 12 / torque, rel=1e-10)
        assert float(row["psi_end"]) == pytest.approx(0.3 * 144 / (2 * torque), rel=1e-10)
        assert float(row["energy_error_max"]) < 1e-11


def test_resolved_input(folder: Path) -> None:
    """The group is in the resolved input only where the input has it."""
    base = f"&top {TOP} /\n&initial theta = 1  psi_rate = 10 /\n&span t_end = 1  samples = 2 /\n"
    assert run(folder, base).returncode == 0
    assert "effects" not in (folder / "scene.csv").read_text()
    assert run(folder, base + "&effects earth_rate = 0 latitude_deg = 50 /\n").returncode == 0
    text = (folder / "scene.csv").read_text()
    assert "&effects" in text
    assert "work of all effects" not in text


START = "theta = 1  psi_rate = 10"
SPAN = "t_end = 1"


@pytest.mark.parametrize(
    ("effects", "words"),
    [
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
    ],
)
def test_bad_effects(folder: Path, effects: str, words: tuple[str, ...]) -> None:
    """Each mistake in the group is refused with its key and what to do."""
    refused(folder, scene(TOP, START, SPAN, effects), "scene.nml:4", *words)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,0,0,0\n", "2"),
        ("0,0,0,0\n0,0,0,1\n", "do not increase"),
        ("0.1,0,0,0\n2,0,0,1\n", "begins at"),
        ("0,0,0,0\n0.5,0,0,1\n", "ends at"),
        ("0,0,0,nan\n1,0,0,1\n", "not finite"),
        ("0,0,0,x\n1,0,0,1\n", "is not a number"),
    ],
)
def test_bad_tables(folder: Path, rows: str, words: str) -> None:
    """Each mistake in a table of torques is refused."""
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + rows)
    refused(folder, scene(TOP, START, SPAN, "torque_table = 'torque.csv'"), "torque.csv", words)


@pytest.mark.parametrize(
    ("integration", "word"),
    [
        ("method = 'exact'", "the exact solution exists only"),
        ("method = 'splitting_4'  steps = 100", "splitting_4"),
        ("project = 'invariants'", "conserves neither"),
        ("formulation = 'lagrange'  method = 'dop853'", "rigid_body"),
    ],
)
def test_refused_computations(folder: Path, integration: str, word: str) -> None:
    """What does not hold for bodies with effects is refused."""
    refused(folder, scene(TOP, START, SPAN, "drag_force = 0.1", integration), word)


def test_choice_is_explained(folder: Path) -> None:
    """--check tells which model was taken, and what effects exclude."""
    done = run(
        folder, scene(TOP, START, SPAN, "drag_force = 0.1", "relative_tolerance = 1e-9"), "--check"
    )
    text = " ".join(done.stdout.split())
    assert "taylor" in text
    assert "effects" in text
    assert "excluded" in text
    done = run(folder, scene(TOP, START, SPAN, "rotor_momentum = 0, 0, 1", ""), "--check")
    assert "exact" in done.stdout
    assert "rotor" in done.stdout
