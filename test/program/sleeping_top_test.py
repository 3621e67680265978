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
