"""Rows whose first time is above 0: the motion starts at 0, whatever the first row is."""

import csv
import json
import os
import subprocess
from pathlib import Path

import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
START = "theta = 0.6  phi = 0.3  theta_rate = 0.3  psi_rate = {}"
BODIES = {
    "symmetric": "inertia = 0.875, 0.875, 0.25  length = 0.6",
    "about x": "inertia = 0.25, 0.875, 0.875  centre_of_mass = 0.6, 0, 0",
    "damped": "inertia = 0.875, 0.875, 0.25  length = 0.6  damping = 3*0.05",
    "asymmetric": "inertia = 0.9, 0.7, 0.4  centre_of_mass = 0.1, -0.05, 0.5",
    "free": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0",
    "spun down": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0  damping = 3*0.3",
}
EFFECTS = (
    "friction_torque = 0.05",
    "drag_moment = 3*0.02",
    "drag_force = 0.2",
    "vibration_amplitude = 0, 0, 0.02  vibration_rate = 25",
    "earth_rate = 0.3  latitude_deg = 60",
    "rotor_momentum = 0, 0, 0.3",
    "torque_body = 0, 0, 0.1",
    "torque_space = 0.1, 0, 0",
)
SCENES = [(body, "", "") for body in BODIES]
SCENES += [("damped", effect, "") for effect in EFFECTS]
COLUMNS = ("phi", "theta", "psi", "omega3")
SPIN = 6.0


def methods() -> list[str]:
    """The methods that have values at any time."""
    listed = subprocess.run([EXE, "list", "methods", "--json"], check=True, capture_output=True)
    return [
        m["name"] for m in json.loads(listed.stdout)["methods"] if m["kind"] in ("both", "adaptive")
    ]


SCENES += [("damped", "", f"method = '{name}'  relative_tolerance = 1e-9") for name in methods()]


def compute(folder: Path, text: str, table: str) -> list[dict[str, str]]:
    """The rows of a table of an input, which must succeed."""
    path = folder / "scene.nml"
    path.write_text(text, encoding="utf-8")
    done = subprocess.run([EXE, "-o", folder, path], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = (folder / table).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@pytest.mark.parametrize(("body", "effect", "integration"), SCENES)
def test_fits(tmp_path: Path, body: str, effect: str, integration: str) -> None:
    """Rows from a third of the span on give the true spin, and residuals of no size."""
    scene = f"&top mass = 1.3  {BODIES[body]} /\n&initial {START} /\n"
    scene += f"&effects {effect} /\n" * bool(effect)
    scene += f"&integration {integration} /\n" * bool(integration)
    names = ", ".join(f"'{name}'" for name in ("t", *COLUMNS))
    span = f"&span t_end = 3  samples = 31 /\n&output columns = {names} /\n"
    rows = compute(tmp_path, scene.format(SPIN) + span, "scene.csv")[10:]
    lines = [",".join(("t", *COLUMNS)), *(",".join(row.values()) for row in rows)]
    (tmp_path / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv'  unknown = 'initial.psi_rate' /\n"
    (found,) = compute(tmp_path, scene.format(1.02 * SPIN) + fit, "scene.csv")
    assert float(found["estimate"]) == pytest.approx(SPIN, rel=1e-6)
    for row in compute(tmp_path, scene.format(SPIN) + fit, "scene.residuals.csv"):
        for name in COLUMNS:
            assert abs(float(row[f"{name}_residual"])) < 1e-6, (row["t"], name)
