"""The reference set: its files agree, its numbers are true, and its checkers find what is wrong."""

import datetime
import itertools
import json
import shutil
import sys

import numpy as np
import pytest

from conftest import KIND, ROOT, each, execute, largest
from mechanics import product
from proof_test import CERTIFIED, change, needs_flint, verify

REFERENCE = ROOT / "reference"
sys.path.append(str(REFERENCE))

from check import angles, check, order, read, turned  # noqa: E402
from referencing.reference_set import main  # noqa: E402

INDEX = json.loads((REFERENCE / "index.json").read_text(encoding="utf-8"))
NAMES = sorted(INDEX["motions"])
QUICK = [
    *("bobylev_steklov", "constant_torque", "euler_equations", "free_asymmetric", "free_symmetric"),
    *("free_principal", "free_intermediate", "free_sphere", "free_small"),
    *("free_tensor", "hess", "motor", "separatrix", "slow_top", "staude", "tumbling_brick"),
]
"""Motions that are computed again in a second."""
LARGEST = 1_500_000


def slack_of(body):
    """Whether a body can exist, as engines check it: relative, negative if it cannot."""
    centre = np.array(body["centre_of_mass"])
    about = centre @ centre * np.eye(3) - np.outer(centre, centre)
    moments = np.linalg.eigvalsh(np.array(body["inertia"]) - body["mass"] * about)
    return float(min(moments[0], moments[0] + moments[1] - moments[2]) / moments[2])


def stacked(columns, names):
    return np.stack([columns[name] for name in names], 1)


Q, OMEGA = [f"q{i}" for i in range(4)], ["omega1", "omega2", "omega3"]
SPACE, MATRIX = ["omega_x", "omega_y", "omega_z"], [f"r{i}{j}" for i in "123" for j in "123"]


def test_files_agree():
    for folder, ending in (("inputs", ".nml"), ("motions", ".json"), ("motions", ".csv")):
        found = sorted(path.stem for path in (REFERENCE / folder).glob(f"*{ending}"))
        assert found == NAMES
    assert len(NAMES) >= 40
    size = sum(path.stat().st_size for path in REFERENCE.rglob("*") if path.is_file())
    assert size < LARGEST


@each("name", *NAMES)
def test_files_of_a_motion_agree(name):
    data, columns = read(name)
    assert (data["version"], data["licence"]) == (INDEX["version"], "CC0-1.0")
    assert list(columns) == list(data["columns"])
    q, omega, space, matrix = (stacked(columns, names) for names in (Q, OMEGA, SPACE, MATRIX))
    scale = 1 + np.abs(omega).max()
    assert np.abs(np.linalg.norm(q, axis=1) - 1).max() < 1e-13
    assert np.abs(turned(q, omega) - space).max() < 1e-13 * scale
    by_matrix = np.einsum("nij,nj->ni", matrix.reshape(-1, 3, 3), omega)
    assert np.abs(by_matrix - space).max() < 1e-13 * scale
    assert q[0].tolist() == data["start"]["quaternion"]
    given = (REFERENCE / "inputs" / f"{name}.nml").read_text(encoding="utf-8")
    assert ("theta" in data["start"]) == ("theta =" in given)
    assert slack_of(data["body"]) > -1e-14
    assert np.array_equal(columns["q0"], columns["q4"])
    assert data["errors"]["attitude"]["value"] < 1e-13


@needs_flint
def test_numbers_are_true(spin):
    """The program verifies every table, and proves attitudes and omega where it can."""
    tables = [REFERENCE / "motions" / f"{name}.csv" for name in NAMES]
    said = spin.call("verify", *tables).out
    for name, table in zip(NAMES, tables, strict=True):
        if INDEX["motions"][name]["attitude"]["kind"] == "proved":
            data, columns = read(name)
            assert data["errors"]["omega"]["kind"] == "proved"
            count = 7 * len(columns["t"])
            assert f"{table}: {count} numbers proved, 0 unproved, 0 wrong" in said


@needs_flint
@each("name", "free_tensor", "heavy_tensor", "grioli")
def test_products_of_inertia(spin, name):
    """Certified digits are those of the set, and `verify` finds what is not."""
    names = ["t", *Q, *OMEGA, "omega1_bound", "orientation_bound", "proof"]
    columns = "output.columns=" + ",".join(names)
    scene = (REFERENCE / "inputs" / f"{name}.nml").read_text(encoding="utf-8")
    printed = spin(scene, columns).rows
    assert set(printed.proof) == {"proved"}
    assert largest(printed.orientation_bound) < 1e-6
    assert ", 0 wrong" in verify(spin)
    certified = spin(scene, columns, CERTIFIED).rows
    assert largest(certified.orientation_bound) < 4e-16
    assert "0 unproved, 0 wrong" in verify(spin, "--strict")
    data, motion = read(name)
    for names, quantity in ((Q, "attitude"), (OMEGA, "omega")):
        error = data["errors"][quantity]["value"] + 4e-15
        for column in names:
            assert list(certified[column]) == pytest.approx(list(motion[column]), abs=2 * error)
    change(spin, "q2", 3, repr(float(certified.q2[2]) + 1e-14))
    assert "first wrong  row 3, q2" in verify(spin, code=3)


def test_a_changed_digit_is_found(spin):
    """By the checker, and by the program: the last digit of any number."""
    for ending in ("csv", "json"):
        shutil.copy(REFERENCE / "motions" / f"cusp.{ending}", spin.folder)
    path = spin.folder / "cusp.csv"
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    row = next(i for i, line in enumerate(lines) if line.startswith("t,")) + 7
    cells = lines[row].split(",")
    cells[20] = cells[20][:-1] + str((int(cells[20][-1]) + 1) % 10)
    lines[row] = ",".join(cells)
    path.write_text("".join(lines), encoding="utf-8")
    with pytest.raises(ValueError, match="was changed"):
        read(spin.folder / "cusp.json")
    spin.call("verify", path, code=tuple(range(1, 256)))


@needs_flint
@pytest.mark.skipif(KIND != "release", reason="takes long with run-time checks")
def test_motions_come_out_again():
    """Two of them, others every day, with all digits."""
    day = 2 * datetime.date.today().toordinal()
    chosen = [QUICK[(day + i) % len(QUICK)] for i in (0, 1)]
    assert main(["--check", *chosen]) == 0, chosen
    assert main(["--check", "no_motion"]) == 1
    assert main(["--verify"]) == 2


def test_inherent_errors(spin):
    """Those of the set are those of the program, found by other displacements."""
    scene = REFERENCE / "inputs/slow_top.nml"
    found = spin(scene, "output.columns=t,inherent_error").rows.inherent_error.to_numpy()
    own = read("slow_top")[1]["inherent_error"]
    assert np.abs(np.log(found[5:] / own[5:])).max() < 1


FREE = read("free_asymmetric")[1]
DIRECTIONS = ("body to space", "space to body")
T, ATTITUDE, BODY_RATE = FREE["t"], stacked(FREE, Q), stacked(FREE, OMEGA)


def judge(t, q, *omega, **conventions):
    return check(t, q, *omega, motion="free_asymmetric", **conventions)


@each(
    "scalar, direction, frame, sign",
    *itertools.product(("first", "last"), DIRECTIONS, ("body", "space"), ("plus", "minus")),
)
def test_conventions_are_found(scalar, direction, frame, sign):
    """All of them, with signs of quaternions that jump."""
    q = ATTITUDE * (1 if direction == "body to space" else [1, -1, -1, -1])
    q = q if scalar == "first" else np.roll(q, -1, axis=1)
    q = q * np.where(np.arange(len(q)) % 3, 1, -2)[:, None]
    omega = BODY_RATE if frame == "body" else stacked(FREE, SPACE)
    found = judge(T, q, omega * (1 if sign == "plus" else -1))
    wanted = {"scalar": scalar, "direction": direction, "frame": frame, "sign": sign}
    assert {key: found[key] for key in wanted} == wanted
    assert found["attitude_error"] < 1e-14
    assert found["omega_error"] < 1e-13
    assert found["energy_change"] < 1e-14
    assert found["momentum_change"] < 1e-14


def test_errors_are_measured():
    """A rotation by 1e-5 rad, an angular velocity that is 1e-6 too large."""
    turn = [np.cos(5e-6), 0, np.sin(5e-6), 0]
    turned_by = np.array([product(q, turn) for q in ATTITUDE])
    assert np.allclose(angles(turned_by, ATTITUDE), 1e-5, rtol=1e-9)
    found = judge(T[::2], turned_by[::2], BODY_RATE[::2] * (1 + 1e-6))
    assert found["attitude_error"] == pytest.approx(1e-5, abs=1e-11)
    largest = np.linalg.norm(BODY_RATE[::2], axis=1).max()
    assert found["omega_error"] == pytest.approx(1e-6 * largest, abs=1e-12)
    assert found["energy_change"] == pytest.approx(2e-6, abs=1e-8)
    assert found["attitude_floor"] < 1e-14
    assert "attitude_error     1e-05" in str(found)


def test_named_conventions():
    found = judge(T, ATTITUDE, direction="space to body")
    assert found["direction"] == "space to body"
    assert found["attitude_error"] > 0.1
    with pytest.raises(ValueError, match="'middle' is not one of"):
        judge(T, ATTITUDE, scalar="middle")


def test_what_is_refused():
    for given, words in (
        ((T, ATTITUDE[:, :3]), "four numbers"),
        ((T, ATTITUDE, BODY_RATE[1:]), "three numbers"),
        ((T + 0.01, ATTITUDE), "fewer than two of the times"),
    ):
        with pytest.raises(ValueError, match=words):
            judge(*given)


def test_order():
    assert order([0.1, 0.05, 0.025], [3e-3, 3e-3 / 16, 3e-3 / 256]) == pytest.approx(4, abs=5e-8)


def numbers_of(folder, *command):
    said = execute(*command, cwd=folder).stdout.replace("order of convergence", "order")
    return {line.split()[0]: " ".join(line.split()[1:]) for line in said.splitlines() if line}


@pytest.mark.skipif(KIND != "release", reason="does not use the program under test")
@each("compiler", "g++", "node")
def test_other_languages(folder, compiler):
    """The checkers in C++ and JavaScript find what that in Python finds, but for rounding."""
    if not shutil.which(compiler):
        pytest.skip(f"no {compiler}")
    command = ["node", REFERENCE / "example.mjs"]
    if compiler == "g++":
        warnings = ["-std=c++11", "-Wall", "-Wextra", "-pedantic", "-Werror"]
        source = REFERENCE / "example.cpp"
        execute("g++", *warnings, "-O1", "-o", folder / "example", source)
        command = [folder / "example", REFERENCE / "motions"]
    found = numbers_of(folder, *command)
    for name, value in numbers_of(folder, sys.executable, REFERENCE / "example.py").items():
        if name == "motion":
            continue
        if value[0].isdigit():
            assert float(found[name]) / float(value) == pytest.approx(1, abs=0.05)
        else:
            assert found[name] == value
