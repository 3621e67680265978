"""A body that a vertical vibration holds upright: swept motions agree with the multipliers."""

import csv
import math
import os
import subprocess
from pathlib import Path

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
INPUT = Path(__file__).resolve().parents[2] / "input/kapitza_map.nml"
SPAN = 4.0


def sweep(folder: Path, *settings: str) -> list[dict[str, str]]:
    """The rows of the map with other settings."""
    words = [word for setting in settings for word in ("--set", setting)]
    command = [EXE, "--quiet", "-o", folder, *words, INPUT]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = (folder / "kapitza_map.csv").read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def test_map(folder: Path) -> None:
    """Bodies fall where deviations grow fast enough, and stay where all multipliers are 1."""
    rows = sweep(folder, "sweep.count(1)=4", "sweep.count(2)=4")
    fallen = stable = 0
    for row in rows:
        rate = float(row["effects.vibration_rate"])
        growth = math.log(float(row["upright_multiplier"])) * rate / (2 * math.pi)
        if growth * SPAN > 6:
            fallen += 1
            assert float(row["t_end"]) < SPAN, row
        elif growth < 1e-6:
            stable += 1
            assert float(row["t_end"]) == SPAN, row
    assert min(fallen, stable) >= 3
    assert fallen + stable >= 13


def test_boundary(folder: Path) -> None:
    """The least rate that holds the body of the input is a limit of Mathieu's equation."""
    rows = sweep(
        folder,
        "sweep.from(1)=39.6781155",
        "sweep.to(1)=39.6781157",
        "sweep.count(1)=2",
        "sweep.from(2)=0.15",
        "sweep.to(2)=0.15",
        "sweep.count(2)=1",
        "output.columns=upright_multiplier",
    )
    below, above = (float(row["upright_multiplier"]) for row in rows)
    assert below > 1 + 1e-6
    assert abs(above - 1) < 1e-9


def test_notes(folder: Path) -> None:
    """Other bodies have no such multiplier, and the note says why."""
    rows = sweep(
        folder,
        "effects.drag_force=0.1",
        "sweep.count(1)=1",
        "sweep.count(2)=1",
        "output.columns=upright_multiplier",
    )
    assert rows[0]["upright_multiplier"] == "nan"
    assert "the only effect must be a vertical vibration" in rows[0]["notes"]
