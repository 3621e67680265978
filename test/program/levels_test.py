"""Tests of SPINTOP_LEVEL: the levels of the processor agree, and one level has one result."""

import os
import subprocess
from pathlib import Path

import pytest

PROGRAM = os.environ.get("SPINTOP_EXE", "build/release/spintop")
LEVELS = ("v2", "v3", "v4")
"""From the lowest on; a machine has the first of them."""
EFFECTS = """\
&effects drag_moment = 1e-3, 2e-3, 1e-3  vibration_amplitude = 0.01, 0, 0.02  vibration_rate = 9
    earth_rate = 0.3  latitude_deg = 50  rotor_torque = 0, 0, 0.01 /
"""
BODY = """\
&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0.02, 0.8
    damping = 0.01, 0.02, 0.01 /
&initial theta_deg = 20  omega = 0.1, 0.2, 8 /
&span t_end = 3 /
"""
INPUTS = {
    "one": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n",
    "affected": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n"
    + EFFECTS,
    "stages": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n"
    "&integration method = 'dop853'  relative_tolerance = 1e-12 /\n" + EFFECTS,
    "many": "&study kind = 'sweep' /\n&sweep parameter = 'initial.theta_deg' from = 5 to = 60"
    " count = 20 /\n&output columns = 'theta_end', 'psi_end', 'theta_rate_end' /\n",
}


def run(folder: Path, name: str, level: str) -> subprocess.CompletedProcess:
    """Run the program with SPINTOP_LEVEL set, where empty is as good as not set."""
    path = folder / f"{name}.nml"
    path.write_text(INPUTS[name] + BODY, encoding="utf-8")
    command = [PROGRAM, "--quiet", "-o", str(folder), str(path)]
    environment = os.environ | {"SPINTOP_LEVEL": level}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def lines(folder: Path, name: str, level: str) -> list[str]:
    """The lines of the table that the program makes at a level."""
    done = run(folder, name, level)
    assert done.returncode == 0, done.stderr
    return (folder / f"{name}.csv").read_text(encoding="utf-8").splitlines()


def level_of(table: list[str]) -> str:
    """The level that the header of a table names, such as v3."""
    (line,) = [line for line in table if line.startswith("# processor: ")]
    return line.removeprefix("# processor: ").removeprefix("x86-64-")


def rows(table: list[str]) -> list[str]:
    """The table without its header."""
    return [line for line in table if not line.startswith("#")]


def numbers(table: list[str]) -> list[float]:
    """All numbers below the names of the columns."""
    cells = [cell for line in rows(table)[1:] for cell in line.split(",")]
    return [float(cell) for cell in cells if cell.replace("-", "").replace("+", "")[:1].isdigit()]


@pytest.mark.parametrize("name", INPUTS)
def test_levels(folder: Path, name: str) -> None:
    """Each level of the machine is named in the table, has the same bytes again, and differs from
    others by rounding and tolerance."""
    highest = level_of(lines(folder, name, ""))
    levels = LEVELS[: LEVELS.index(highest) + 1] if highest in LEVELS else ()
    first = numbers(lines(folder, name, levels[0] if levels else ""))
    assert first
    for level in levels:
        table = lines(folder, name, level)
        assert level_of(table) == level
        assert rows(table) == rows(lines(folder, name, level))
        assert numbers(table) == pytest.approx(first, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("level", ["v9", "V3", "native", " ", "v2 ."])
def test_other_words(folder: Path, level: str) -> None:
    """A level that the processor does not have is refused."""
    done = run(folder, "one", level)
    assert done.returncode == 2
    assert f"SPINTOP_LEVEL is '{level}', but the levels of this processor are: " in done.stderr
    assert not (folder / "one.csv").exists()
