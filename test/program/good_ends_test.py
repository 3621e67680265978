"""Every kind of run tells a good end from a failure alike.

Two tops go through all kinds: one that dry friction brings to rest, a good end, and one whose steps
do not suffice half way. The code of a run is that of its cases, with one of them or many, in parts,
and where nothing is left to compute. `python_ends_test` has the kinds of Python and of the scripts.
"""

import csv
import json
import math
import os
import re
import subprocess
from pathlib import Path

import pytest

PROGRAM = os.environ["SPINTOP_EXE"]

TOP = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.8660254037844387 /\n"
SCENE = (
    TOP + "&initial theta_deg = 40  psi_rate = 10 /\n&effects friction_torque = 9 /\n"
    "&span t_end = 2 /\n"
)
SHORT_OF_STEPS = "&integration max_steps = 40 /\n"
ENDS = [pytest.param("", True, id="at_rest"), pytest.param(SHORT_OF_STEPS, False, id="step_limit")]
SWEEP = (  # the last top comes to rest in more than 40 steps
    "&study kind = 'sweep' /\n" + SCENE + "&sweep parameter(1) = 'initial.psi_rate'"
    "  values(1, :) = 5, 20, 10 /\n"
)
COLUMNS = "&output columns = 'theta_end', 't_stuck'"
STATISTICS = "&statistics columns = 'theta_end', 't_stuck' /\n"
WITH_ROWS, WITHOUT_ROWS = COLUMNS + " /\n", "&output rows = 'none' /\n"
FAILED = 3
NETCDF = ("--set", "output.format=netcdf")


def run(folder: Path, text: str, *options: str) -> int:
    """The exit code of the program with an input, whose tables are in the folder."""
    scene = folder / "scene.nml"
    scene.write_text(text)
    command = [PROGRAM, "--quiet", *options, "-o", folder, scene]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in (0, FAILED), done.stderr
    return done.returncode


def rows_of(folder: Path, name: str = "scene") -> list[dict[str, str]]:
    """The rows of a table."""
    lines = (folder / f"{name}.csv").read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def good_ends() -> set[str]:
    """The statuses of good ends, as the program lists them."""
    command = [PROGRAM, "list", "statuses", "--json"]
    listed = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    return {entry["name"] for entry in listed["statuses"] if entry["good"]}


def formats(folder: Path) -> list[tuple[str, ...]]:
    """The options of the formats that this build writes."""
    scene = folder / "scene.nml"
    scene.write_text(SWEEP)
    done = subprocess.run([PROGRAM, "--check", scene, *NETCDF], capture_output=True, check=False)
    return [(), NETCDF] if done.returncode == 0 else [()]


def test_list() -> None:
    """The flag says which statuses are those of motions that were computed to their end."""
    assert good_ends() == {"ok", "at_rest"}


@pytest.mark.parametrize(("keys", "good"), ENDS)
def test_trajectory(folder: Path, keys: str, good: bool) -> None:
    """The rows go on at rest; the code is the same where nothing is left to compute."""
    code = 0 if good else FAILED
    for options in formats(folder):
        assert run(folder, SCENE + keys, "--set", "span.samples=101", *options) == code
        assert run(folder, SCENE + keys, "--set", "span.samples=101", "--resume", *options) == code
    assert (len(rows_of(folder)) == 101) is good
    said = re.findall(r"^# status: (\w+)", (folder / "scene.csv").read_text(), re.MULTILINE)
    assert [word in good_ends() for word in said] == [good]


@pytest.mark.parametrize(("keys", "good"), ENDS)
def test_sweep(folder: Path, keys: str, good: bool) -> None:
    """A sweep fails if a case does; the code is the same where nothing is left to compute."""
    code = 0 if good else FAILED
    for options in formats(folder):
        assert run(folder, SWEEP + WITH_ROWS + keys, *options) == code
        assert run(folder, SWEEP + WITH_ROWS + keys, "--resume", *options) == code
    rows = rows_of(folder)
    assert [row["status"] in good_ends() for row in rows] == [True, True, good]
    assert [math.isfinite(float(row["t_stuck"])) for row in rows] == [True, True, good]


@pytest.mark.parametrize(("keys", "good"), ENDS)
@pytest.mark.parametrize("output", [WITH_ROWS, WITHOUT_ROWS], ids=["rows", "no rows"])
def test_statistics(folder: Path, keys: str, good: bool, output: str) -> None:
    """Cases at rest are in the statistics: t_stuck has a mean."""
    code = 0 if good else FAILED
    text = SWEEP + STATISTICS + output + keys
    for options in formats(folder):
        assert run(folder, text, *options) == code
        assert run(folder, text, "--resume", *options) == code
    row = rows_of(folder, "scene.statistics")[0]
    assert [int(row[name]) for name in ("cases", "failed", "t_stuck_count")] == [
        *(3, 0 if good else 1, 3 if good else 2)
    ]
    assert 0 < float(row["t_stuck_mean"]) < 2


@pytest.mark.parametrize(("keys", "good"), ENDS)
@pytest.mark.parametrize("output", [WITH_ROWS, STATISTICS + WITHOUT_ROWS], ids=["rows", "no rows"])
def test_parts(folder: Path, keys: str, good: bool, output: str) -> None:
    """Each part of a sweep has the code of its own cases."""
    for options in ([], ["--resume"]):
        codes = [
            run(folder, SWEEP + output + keys, "--shard", f"{part}/3", *options)
            for part in (1, 2, 3)
        ]
        assert codes == [0, 0, 0 if good else FAILED]


@pytest.mark.parametrize(
    ("method", "step"),
    [("taylor", 0), ("dop853", 0), ("ode45", 0), ("rk4", 1e-3), ("gauss_8", 1e-3)],
)
def test_stop_at_rest(folder: Path, method: str, step: float) -> None:
    """A motion that ends when it comes to rest has that time as t_stuck; fixed steps a step off."""
    control = f"step = {step}" if step else "relative_tolerance = 1e-9"
    text = SWEEP.replace("t_end = 2", "t_end = 2  stop_at = 'stuck'")
    text += f"{COLUMNS}, 't_end' /\n&integration method = '{method}'  {control} /\n"
    assert run(folder, text) == 0
    for row in rows_of(folder):
        assert row["status"] in good_ends()
        assert float(row["t_stuck"]) == pytest.approx(float(row["t_end"]), rel=0, abs=step)
        assert row["notes"] == ""


def test_body_that_moves_again(folder: Path) -> None:
    """A motion that ends with a departure is not at rest: t_stuck is that of the end."""
    text = SWEEP.replace("9 /", "9  vibration_amplitude = 0, 0, 0.05  vibration_rate = 30 /")
    text = text.replace("t_end = 2", "t_end = 2  stop_at = 'slip'")
    assert run(folder, text + WITH_ROWS) == 0
    for row in rows_of(folder):
        left = "stop_at did not occur in the span" not in row["notes"]
        assert math.isnan(float(row["t_stuck"])) is left
        assert ("not stopped by dry friction" in row["notes"]) is left


@pytest.mark.parametrize(("keys", "good"), ENDS)
def test_fit(folder: Path, keys: str, good: bool) -> None:
    """The friction is found from a motion that comes to rest, if its model does to its end."""
    truth = SCENE + "&output columns = 't', 'phi', 'theta', 'psi' /\n"
    assert run(folder, truth, "--set", "span.samples=41") == 0
    (folder / "scene.csv").rename(folder / "measured.csv")
    text = (
        "&study kind = 'fit' /\n"
        + SCENE.replace("torque = 9", "torque = 8.7")
        + (f"&fit data = '{folder / 'measured.csv'}'  unknown = 'effects.friction_torque' /\n")
    )
    assert run(folder, text + keys) == (0 if good else FAILED)
    if good:
        assert float(rows_of(folder)[0]["estimate"]) == pytest.approx(9, rel=1e-6)


def test_comparisons_of_methods(folder: Path) -> None:
    """Methods are compared on motions at rest too; the failure of one is a result."""
    for kind, keys in {
        "stability": "cases = 'input'",
        "work_precision": "repeats = 1  tolerances = 1e-6",
    }.items():
        text = f"&study kind = '{kind}' /\n{SCENE}&{kind} methods = 'taylor', 'dop853'  {keys} /\n"
        assert run(folder, text) == 0
        rows = rows_of(folder)
        assert len(rows) == 2
        for row in rows:
            assert row["status"] in good_ends()
            assert float(row["orientation_error"]) < 1e-5
            assert row.get("verdict", "accurate") in ("accurate", "drifts")
