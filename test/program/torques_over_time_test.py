"""Torques that depend on the time: harmonic ones, and tables with jumps."""

import csv
import math
from pathlib import Path

import pytest

from effects_test import FREE, SKEW, move, refused, run, scene

A, B, W, F = 0.05, 0.4, 7.3, 0.6
SPHERE = "mass = 1  gravity = 9.81  inertia = 0.5, 0.5, 0.5  centre_of_mass = 0, 0, 0"
METHODS = {
    "taylor": ("method = 'taylor'  relative_tolerance = 1e-14", 1e-12),
    "taylor_quadruple": ("method = 'taylor_quadruple'  relative_tolerance = 1e-20", 1e-13),
    "dop853": ("method = 'dop853'  relative_tolerance = 1e-12", 1e-10),
    "arkode": ("method = 'arkode_erk'  relative_tolerance = 1e-11", 1e-8),
    "gauss": ("method = 'gauss_8'  steps = 1000", 1e-11),
    "lie": ("method = 'rkmk_4'  steps = 4000", 1e-7),
}


def integral(t: float) -> float:
    """The integral of A + B cos(W t + F)."""
    return A * t + B / W * (math.sin(W * t + F) - math.sin(F))


@pytest.mark.parametrize("method", METHODS)
def test_about_an_axis_of_the_body(folder: Path, method: str) -> None:
    """The spin has the integral of the torque, and the work its energy."""
    integration, tolerance = METHODS[method]
    effects = (
        f"torque_body = 0, 0, {A}  torque_body_amplitude = 0, 0, {B}"
        f"  torque_body_rate = {W}  torque_body_phase = 0, 0, {F}"
    )
    span = "t_end = 10  samples = 21"
    motion = move(folder, scene(FREE, "theta = 1  omega = 0, 0, 3", span, effects, integration))
    for row in motion.rows:
        spin = 3 + integral(row["t"]) / 0.3
        assert row["omega3"] == pytest.approx(spin, abs=tolerance)
        assert row["work_torque"] == pytest.approx(0.15 * (spin**2 - 9), abs=10 * tolerance)
        assert abs(row["energy_error"]) < 10 * tolerance


@pytest.mark.parametrize("method", METHODS)
def test_about_axes_of_space(folder: Path, method: str) -> None:
    """The momentum of a sphere in space has the integral of the torque, whatever its attitude."""
    integration, tolerance = METHODS[method]
    effects = (
        f"torque_space = 0, 0, {A}  torque_space_amplitude = {B}, 0, {B}"
        f"  torque_space_rate = {W}"
        f"  torque_space_phase_deg = {math.degrees(F)}, 0, {math.degrees(F)}"
    )
    span = "t_end = 5  samples = 11"
    motion = move(folder, scene(SPHERE, "theta = 1  omega = 1, 2, 3", span, effects, integration))
    first = motion.rows[0]
    gamma = [first[f"gamma{i}"] for i in (1, 2, 3)]
    up = 0.5 * sum(g * w for g, w in zip(gamma, (1, 2, 3), strict=True))
    # phi = psi = 0: space x is body x.
    across = 0.5
    other = 0.25 * 14 - up**2 - across**2
    for row in motion.rows:
        lz = up + integral(row["t"])
        lx = across + integral(row["t"]) - A * row["t"]
        assert row["lz"] == pytest.approx(lz, abs=tolerance)
        assert row["energy"] == pytest.approx(lx**2 + lz**2 + other, abs=10 * tolerance)


def test_methods_agree(folder: Path) -> None:
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
        integration, _ = METHODS[name]
        motion = move(
            folder, scene(SKEW, "theta = 1  psi_rate = 10", "t_end = 1", effects, integration)
        )
        ends[name] = [motion.last[key] for key in ("q0", "q1", "q2", "q3", "lz", "work_torque")]
        assert abs(motion.last["energy_error"]) < 1e-11
    assert ends["taylor"] == pytest.approx(ends["taylor_quadruple"], abs=2e-12)
    assert ends["dop853"] == pytest.approx(ends["taylor_quadruple"], abs=1e-9)


def test_departures(folder: Path) -> None:
    """A body that dry friction holds starts when the torque exceeds it: A sin(W t) = M."""
    effects = (
        "friction_torque = 0.5  torque_body_amplitude = 0, 0, 1  torque_body_rate = 0.1\n"
        "torque_body_phase_deg = 0, 0, -90"
    )
    text = scene(FREE, "theta = 1  omega = 0, 0, 0", "t_end = 10", effects)
    text += "&output events = 'slip' /\n"
    assert run(folder, text).returncode == 0
    lines = (folder / "scene.events.csv").read_text().splitlines()
    (row,) = csv.DictReader(line for line in lines if not line.startswith("#"))
    assert float(row["t"]) == pytest.approx(math.asin(0.5) / 0.1, abs=1e-8)


def test_sweep_from_zero(folder: Path) -> None:
    """An amplitude is an axis, which may start from zero: there the body has no such effect."""
    text = "&study kind = 'sweep' /\n" + scene(
        FREE,
        "theta = 1  omega = 0, 0, 3",
        "t_end = 2",
        f"torque_body_rate = {W}  torque_body_phase = 0, 0, {F}  torque_body_amplitude = 0, 0, 0",
    )
    text += (
        "&sweep parameter = 'effects.torque_body_amplitude(3)'  values(1, :) = 0, 0.4 /\n"
        "&output columns = 'psi_end', 'energy_error_max' /\n"
    )
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    lines = (folder / "scene.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    angle = B / W * (-(math.cos(W * 2 + F) - math.cos(F)) / W - 2 * math.sin(F)) / 0.3
    swing = float(rows[1]["psi_end"]) - float(rows[0]["psi_end"])
    assert swing == pytest.approx(angle, abs=1e-8)


@pytest.mark.parametrize(
    ("effects", "word"),
    [
        ("torque_body_amplitude = 0, 0, 1", "torque_body_rate"),
        ("torque_space_rate = 1", "torque_space_amplitude"),
        ("torque_body_phase = 0, 0, 1", "torque_body_amplitude"),
        ("torque_body_amplitude = 0, 0, 1  torque_body_rate = 0", "> 0"),
        (
            "torque_space_amplitude = 0, 0, 1  torque_space_rate = 1  torque_space_phase = 0, 0, 1"
            "  torque_space_phase_deg = 0, 0, 1",
            "given twice",
        ),
    ],
)
def test_bad_harmonics(folder: Path, effects: str, word: str) -> None:
    """What is missing beside an amplitude, a rate or a phase is named."""
    text = scene(FREE, "theta = 1  psi_rate = 10", "t_end = 1", effects)
    refused(folder, text, "scene.nml:4", word)


STEPS = "t,m1,m2,m3\n0,0,0,0.3\n1,0,0,0.3\n1,0,0,-0.2\n2.5,0,0,-0.2\n2.5,0,0,0.5\n4,0,0,0.5\n"


def spin_under_steps(t: float) -> float:
    """The integral of the torques of that table, from 1 rad/s, of a body with 0.3 kg m^2."""
    changes = 0.3 * min(t, 1) - 0.2 * min(max(t - 1, 0), 1.5) + 0.5 * max(t - 2.5, 0)
    return 1 + changes / 0.3


@pytest.mark.parametrize("method", ["taylor", "taylor_quadruple", "dop853", "ode45", "arkode"])
@pytest.mark.parametrize("end", ["4", "2.5", "3.3"])
def test_jumps(folder: Path, method: str, end: str) -> None:
    """Steps end where the torque jumps, and each sees the torque of its side."""
    (folder / "torque.csv").write_text(STEPS)
    integration, _ = METHODS.get(method, (f"method = '{method}'  relative_tolerance = 1e-6", 0))
    effects = "torque_table = 'torque.csv'"
    text = scene(FREE, "theta = 1  omega = 0, 0, 1", f"t_end = {end}  samples = 81", effects)
    motion = move(folder, text.replace("relative_tolerance = 1e-14", integration))
    assert motion.rows[-1]["t"] == float(end)
    for row in motion.rows:
        spin = spin_under_steps(row["t"])
        assert row["omega3"] == pytest.approx(spin, abs=2e-14)
        assert row["work_torque"] == pytest.approx(0.15 * (spin**2 - 1), abs=1e-14)


def test_jumps_of_a_tumbling_body(folder: Path) -> None:
    """Jumps are those of motions that end and begin there, in every kind of piece."""
    rows = ["0,1,0,0", "1,0,1,0", "2,0,0,1", "3,1,1,0"]
    others = ["3,0,-1,1", "4,0,0,1", "4.5,1,-2,0", "6,0,0,0"]
    (folder / "first.csv").write_text("\n".join(["t,m1,m2,m3", *rows]) + "\n")
    later = [f"{float(row.split(',')[0]) - 3},{row.partition(',')[2]}" for row in others]
    (folder / "second.csv").write_text("\n".join(["t,m1,m2,m3", *later]) + "\n")
    (folder / "both.csv").write_text("\n".join(["t,m1,m2,m3", *rows, *others]) + "\n")
    names = ("q0", "q1", "q2", "q3", "omega1", "omega2", "omega3")
    for kind in ("linear", "monotone", "spline"):
        for axes in ("body", "space"):
            how = f"torque_interpolation = '{kind}'  torque_axes = '{axes}'"
            start = "theta = 1  psi_rate = 5"
            ends = {}
            for name, span in (("first", 3), ("second", 3), ("both", 6)):
                effects = f"torque_table = '{name}.csv'  {how}"
                if name == "second":
                    last = [repr(ends["first"][key]) for key in names]
                    start = f"quaternion = {', '.join(last[:4])}  omega = {', '.join(last[4:])}"
                if name == "both":
                    start = "theta = 1  psi_rate = 5"
                text = scene(SKEW, start, f"t_end = {span}  samples = 2", effects)
                ends[name] = move(folder, text).last
            found, known = ([ends[one][key] for key in names] for one in ("both", "second"))
            assert found == pytest.approx(known, abs=1e-11), (kind, axes)


def test_jumps_over_friction(folder: Path) -> None:
    """A torque that jumps over the friction moves a resting body; below it friction stops it."""
    rows = "0,0,0,0\n1,0,0,0.4\n1,0,0,0.8\n2,0,0,0.8\n2,0,0,0.2\n9,0,0,0.2\n"
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + rows)
    text = scene(
        FREE,
        "theta = 1  omega = 0, 0, 0",
        "t_end = 9",
        "friction_torque = 0.5  torque_table = 'torque.csv'",
    )
    assert run(folder, text + "&output events = 'slip', 'stuck', 'knot' /\n").returncode == 0
    lines = (folder / "scene.events.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    found = [(row["event"], float(row["t"])) for row in rows]
    # The spin is 1 rad/s at t = 2; 0.3 kg m^2 and 0.3 N m take it in 1 s.
    known = [("slip", 1), ("knot", 1), ("knot", 2), ("stuck", 3), ("knot", 9)]
    assert sorted(name for name, _ in found) == sorted(name for name, _ in known)
    for name, t in known:
        assert any(other == name and abs(at - t) < 1e-7 for other, at in found), found


@pytest.mark.parametrize(
    ("rows", "interpolation", "words"),
    [
        ("0,0,0,0\n1,0,0,0\n1,0,0,1\n1,0,0,2\n2,0,0,1\n", "linear", "do not increase"),
        ("0,0,0,0\n1,0,0,0\n1,0,0,1\n", "linear", "up to a jump, has 1 rows"),
        ("0,0,0,0\n1,0,0,0\n1,0,0,1\n2,0,0,1\n3,0,0,1\n", "monotone", "from t = 0 to 1"),
    ],
)
def test_bad_jumps(folder: Path, rows: str, interpolation: str, words: str) -> None:
    """Three rows of one time, and pieces with too few rows, are refused."""
    (folder / "torque.csv").write_text("t,m1,m2,m3\n" + rows)
    effects = f"torque_table = 'torque.csv'  torque_interpolation = '{interpolation}'"
    refused(folder, scene(FREE, "theta = 1  psi_rate = 1", "t_end = 1", effects), words)
