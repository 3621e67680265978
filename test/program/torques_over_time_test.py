"""Torques that depend on the time."""

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
