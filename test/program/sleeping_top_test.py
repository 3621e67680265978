"""The threshold of the sleeping top: told of a top that starts upright, and in sweeps."""

import csv
import math
import os
import subprocess
from pathlib import Path

import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
TOP = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
CRITICAL = 2 * math.sqrt(9.81 * 0.866 * 0.875) / 0.25


def run(folder: Path, text: str) -> subprocess.CompletedProcess[str]:
    """The program with an input, which ends well."""
    (folder / "top.nml").write_text(text)
    done = subprocess.run([EXE, "top.nml"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.parametrize(
    ("start", "warns"),
    [
        ("theta = 0  spin_ratio = 1.8", True),
        ("theta = 0  spin_ratio = 1.9", False),
        ("theta = 1e-6  spin_ratio = 1.8", False),
        ("quaternion = 1, 0, 0, 0  omega = 0, 0, -21", True),
        ("quaternion = 1, 0, 0, 0  omega = 0, 1e-9, -21", False),
        ("theta_deg = 180  omega3 = 1", False),
    ],
)
def test_an_upright_start(tmp_path: Path, start: str, warns: bool) -> None:
    """A start exactly upright with too little spin has a warning; the summary has the threshold."""
    done = run(tmp_path, f"{TOP}&initial {start} /\n&span t_end = 1 /\n")
    assert ("stays upright only because nothing disturbs it" in done.stderr) is warns, done.stderr
    assert f"a sleeping top is stable from omega3 = {CRITICAL:.10f} rad/s" in done.stdout


def test_damped(tmp_path: Path) -> None:
    """Damping holds no top upright; one with its centre of mass at -z is upright too."""
    damped = TOP.replace(" /", "  damping = 0.1, 0.1, 0.1 /")
    above = run(tmp_path, f"{damped}&initial theta = 0  omega3 = 21 /\n&span t_end = 1 /\n")
    turned = damped.replace("= 0.866", "= -0.866")
    below = run(
        tmp_path,
        f"{turned}&initial quaternion = 0, 1, 0, 0  omega = 0, 0, 21 /\n&span t_end = 1 /\n",
    )
    assert "warning: the top stays upright" in above.stderr
    assert "warning: the top stays upright" in below.stderr


@pytest.mark.parametrize(
    ("top", "effects", "start", "end", "name", "with_effects"),
    [
        ("length = 0.866", "rotor_momentum = 0, 0, 3", "omega3 = 15", 15, "omega3", 27),
        ("length = -0.866", "", "omega3 = 15", 15, "omega3", None),
        ("length = 0.866", "earth_rate = 12  latitude_deg = 90", "omega3 = 15", 15, "omega3", 27),
        ("centre_of_mass = 0.866, 0, 0", "", "omega = 15, 0, 0", 15, "omega1", None),
    ],
)
def test_spin_of_the_summary(
    tmp_path: Path, top: str, effects: str, start: str, end: float, name: str, with_effects: float
) -> None:
    """The summary has the spin of the input, about the axis that has the centre of mass."""
    inertia = "0.25, 0.875, 0.875" if name == "omega1" else "0.875, 0.875, 0.25"
    text = f"&top mass = 1  inertia = {inertia}  {top} /\n&span t_end = 1 /\n"
    done = run(tmp_path, f"{text}&initial theta = 1e-6  {start} /\n&effects {effects} /\n")
    (line,) = (line for line in done.stdout.splitlines() if line.startswith("  upright"))
    assert f" rad/s; here {name} = {end:.10f}" in line
    assert f"from {name} = {CRITICAL:.10f}" in line
    if with_effects is None:
        assert line.endswith(f"{end:.10f}")
    else:
        assert float(line.split(" as one of ")[1]) == pytest.approx(with_effects, rel=1e-9)


@pytest.mark.parametrize("keys", ["drag_moment = 0, 0, 0.001", "friction_torque = 0.1", "damping"])
@pytest.mark.parametrize(("spin", "t_end"), [(22, 1), (22, 0.01), (21, 1)])
def test_slowing_down(tmp_path: Path, keys: str, spin: float, t_end: float) -> None:
    """A top that is exactly upright in the end with less spin than the threshold is told of."""
    text = TOP.replace(" /", "  damping = 0, 0, 0.05 /") if keys == "damping" else TOP
    text += "" if keys == "damping" else f"&effects {keys} /\n"
    done = run(tmp_path, f"{text}&initial theta = 0  omega3 = {spin} /\n&span t_end = {t_end} /\n")
    said = "the top stays upright only because nothing disturbs it"
    assert (f"warning: {said}" in done.stderr) is (spin < CRITICAL)
    assert (f"note      in the end {said}" in done.stdout) is (spin > CRITICAL and t_end == 1)


@pytest.mark.parametrize(
    ("old", "new", "critical", "ratio", "note"),
    [
        ("", "", CRITICAL, 30 / CRITICAL, ""),
        ("length = 0.866", "length = 0.866  damping = 0, 0, 0.1", CRITICAL, 30 / CRITICAL, ""),
        (
            "/",
            "/\n&effects rotor_momentum = 0, 0, 1  drag_force = 1e-3 /",
            CRITICAL,
            34 / CRITICAL,
            "",
        ),
        ("/", "/\n&effects rotor_momentum = 0, 0, 1 /", CRITICAL, 34 / CRITICAL, ""),
        ("length = 0.866", "length = 0", 0, math.nan, "gravity exerts no torque"),
        ("0.875, 0.25", "0.8, 0.25", math.nan, math.nan, "the body is not symmetric"),
    ],
)
def test_columns(
    tmp_path: Path, old: str, new: str, critical: float, ratio: float, note: str
) -> None:
    """The threshold and the spin over it, for what has one."""
    run(
        tmp_path,
        f"&study kind = 'sweep' /\n{TOP.replace(old, new) if old else TOP}&span t_end = 1 /\n"
        "&initial theta = 0.1  omega3 = 30 /\n"
        "&sweep parameter = 'initial.theta', values(1,:) = 0.1 /\n"
        "&output columns = 'critical_omega3', 'sleeping_ratio' /\n",
    )
    lines = (tmp_path / "output/top.csv").read_text().splitlines()
    (row,) = csv.DictReader(line for line in lines if not line.startswith("#"))
    found = [float(row[name]) for name in ("critical_omega3", "sleeping_ratio")]
    assert found == pytest.approx([critical, ratio], rel=1e-14, nan_ok=True)
    assert note in row["notes"] if note else row["notes"] == ""
