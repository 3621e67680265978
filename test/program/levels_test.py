"""Tests of SPINTOP_LEVEL: the levels of the processor agree, and one level has one result."""

import os
import subprocess
from pathlib import Path

import pytest

PROGRAM = os.environ.get("SPINTOP_EXE", "build/release/spintop")
LEVELS = ("v2", "v3", "v4")
"""Those that the machine has not are its highest."""
BODY = """\
&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0.02, 0.8
    damping = 0.01, 0.02, 0.01 /
&initial theta_deg = 20  omega = 0.1, 0.2, 8 /
&span t_end = 3 /
"""
INPUTS = {
    "one": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n",
    "many": "&study kind = 'sweep' /\n&sweep parameter = 'initial.theta_deg' from = 5 to = 60"
    " count = 20 /\n&output columns = 'theta_end', 'psi_end', 'theta_rate_end' /\n",
}


def rows(folder: Path, name: str, level: str) -> list[str]:
    """The rows of the table that the program makes at a level."""
    path = folder / f"{name}.nml"
    path.write_text(INPUTS[name] + BODY, encoding="utf-8")
    command = [PROGRAM, "--quiet", "-o", str(folder), str(path)]
    subprocess.run(
        command, check=True, capture_output=True, env=os.environ | {"SPINTOP_LEVEL": level}
    )
    table = (folder / f"{name}.csv").read_text(encoding="utf-8")
    return [line for line in table.splitlines() if not line.startswith("#")]


def numbers(table: list[str]) -> list[float]:
    """All numbers below the names of the columns."""
    cells = [cell for line in table[1:] for cell in line.split(",")]
    return [float(cell) for cell in cells if cell.replace("-", "").replace("+", "")[:1].isdigit()]


@pytest.mark.parametrize("name", INPUTS)
def test_levels(folder: Path, name: str) -> None:
    """Each level has the same bytes again, and differs from others by rounding and tolerance."""
    first = numbers(rows(folder, name, LEVELS[0]))
    assert first
    for level in LEVELS:
        table = rows(folder, name, level)
        assert table == rows(folder, name, level)
        assert numbers(table) == pytest.approx(first, rel=1e-8, abs=1e-8)


def test_other_words(folder: Path) -> None:
    """A level that there is not is no level: the highest is used."""
    assert rows(folder, "one", "") == rows(folder, "one", "v9")
