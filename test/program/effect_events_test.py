"""The events stuck, slip and knot: rest under dry friction, departure, and rows of a table.

A body without weight turns about its own axis: I3 = 0.3, dry moment 0.25. The torque about the
axis grows by 0.1 N m/s to 0.4 N m at t = 4, and then falls at the same rate: the body departs at
2.5 s, and comes to rest again.
"""

import csv
import math
import os
import subprocess
from pathlib import Path

import pytest

EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
BODY = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0 /\n"
SPIN_DOWN = (
    BODY.replace(" /", "  damping = 0, 0, 0.01 /")
    + "&initial theta = 1  omega = 0, 0, 12 /\n"
    + "&effects friction_torque = 0.02  friction_coefficient = 0.3  friction_radius = 0.01"
    + "  drag_moment = 0, 0, 0.003 /\n"
)
T_STUCK, PSI_STUCK = 23.86289777879196, 85.16613498183026
TABLE = "t,m1,m2,m3\n0,0,0,0\n4,0,0,0.4\n12,0,0,-0.4\n"
DRIVEN = (
    BODY
    + "&initial omega = 0, 0, 0  theta = 1 /\n"
    + "&effects friction_torque = 0.25  torque_table = 'torque.csv' /\n"
)
SLIP, STUCK = 2.5, 5.5 + math.sqrt(4.5)


def run(folder: Path, text: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Run an input."""
    (folder / "scene.nml").write_text(text)
    (folder / "torque.csv").write_text(TABLE)
    return subprocess.run(
        [EXE, "--quiet", "-o", folder, *options, folder / "scene.nml"],
        capture_output=True,
        text=True,
        check=False,
    )


def rows_of(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def events(folder: Path, text: str) -> list[tuple[str, float]]:
    """The events of a trajectory, with their times."""
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    return [(row["event"], float(row["t"])) for row in rows_of(folder / "scene.events.csv")]


@pytest.mark.parametrize("method", ["taylor", "dop853", "ode45"])
def test_departure_and_rest(folder: Path, method: str) -> None:
    """They are found in their order, among events of columns."""
    text = (
        DRIVEN
        + "&span t_end = 10 /\n&output columns = 't', 'omega3'"
        + "  events = 'stuck', 'slip', 'knot', 'omega3 = 0.375' /\n"
        + f"&integration method = '{method}'  relative_tolerance = 1e-12 /\n"
    )
    found = events(folder, text)
    names = ["slip", "knot", "omega3=0.375 rising", "omega3=0.375 falling", "stuck"]
    assert sorted(name for name, _ in found) == sorted(names)
    at = dict(found)
    assert [time for _, time in found] == sorted(time for _, time in found)
    assert at["slip"] == pytest.approx(SLIP, abs=1e-13)
    assert at["knot"] == 4
    assert at["stuck"] == pytest.approx(STUCK, abs=1e-9)
    assert at["omega3=0.375 falling"] == pytest.approx(4 + 3, abs=1e-9)


def test_fixed_steps(folder: Path) -> None:
    """The rows of the table are found within steps, rest and departure to a step."""
    text = (
        DRIVEN
        + "&span t_end = 10 /\n&output events = 'stuck', 'slip', 'knot' /\n"
        + "&integration method = 'gauss_8'  steps = 1111 /\n"
    )
    at = dict(events(folder, text))
    assert at["knot"] == 4
    assert at["slip"] == pytest.approx(SLIP, abs=10 / 1111)
    assert at["stuck"] == pytest.approx(STUCK, abs=2 * 10 / 1111)


@pytest.mark.parametrize(("event", "end"), [("stuck", STUCK), ("slip", SLIP), ("knot", 4.0)])
def test_end_of_a_motion(folder: Path, event: str, end: float) -> None:
    """A motion that ends at one has its last row there, with its work."""
    text = (
        DRIVEN
        + f"&span t_end = 10  samples = 5  stop_at = '{event}' /\n"
        + "&output columns = 't', 'omega3', 'work', 'work_torque' /\n"
        + "&integration relative_tolerance = 1e-13 /\n"
    )
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    assert (folder / "scene.csv").read_text().splitlines()[-2] == "# status: ok"
    rows = [
        {key: float(cell) for key, cell in row.items()} for row in rows_of(folder / "scene.csv")
    ]
    assert [row["t"] for row in rows] == pytest.approx([end * i / 4 for i in range(5)], abs=1e-9)
    for row in rows:
        assert row["work"] == pytest.approx(0.15 * row["omega3"] ** 2, abs=1e-10)
    last = rows[-1]
    assert last["omega3"] == pytest.approx(0.375 if event == "knot" else 0, abs=1e-12)
    if event == "stuck":
        assert last["work_torque"] > 0.1


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_work_until_events(folder: Path, method: str) -> None:
    """At events of all sorts the account is closed, whatever rows lie between them."""
    text = (
        DRIVEN.replace("length = 0", "length = 0.5").replace("theta = 1", "theta_deg = 40")
        + "&span t_end = 10 /\n"
        + "&output columns = 't', 'kinetic', 'potential', 'work', 'energy_error'"
        + "  events = 'slip', 'stuck', 'knot', 'turning_points', 'omega3 = 0.1' /\n"
        + f"&integration method = '{method}'  relative_tolerance = 1e-12 /\n"
    )
    for samples in ("2", "101"):
        done = run(folder, text, "--set", f"span.samples={samples}")
        assert done.returncode in (0, 3), done.stderr
        start = rows_of(folder / "scene.csv")[0]
        rows = rows_of(folder / "scene.events.csv")
        assert len(rows) > 3
        for row in rows:
            change = sum(float(row[key]) - float(start[key]) for key in ("kinetic", "potential"))
            assert float(row["work"]) == pytest.approx(change, abs=1e-9), row
            assert abs(float(row["energy_error"])) < 1e-9
        assert any(abs(float(row["work"])) > 0.1 for row in rows)


def test_rest_of_a_spin_down(folder: Path) -> None:
    """Where nothing depends on time there is one rest, at the time of the closed form."""
    text = SPIN_DOWN + "&span t_end = 30 /\n"
    text += "&output columns = 't', 'psi', 'omega3'  events = 'stuck', 'slip' /\n"
    text += "&integration relative_tolerance = 1e-14 /\n"
    found = events(folder, text)
    assert [name for name, _ in found] == ["stuck"]
    assert found[0][1] == pytest.approx(T_STUCK, rel=1e-13)
    row = rows_of(folder / "scene.events.csv")[0]
    assert row["number"] == "1"
    assert float(row["psi"]) == pytest.approx(PSI_STUCK, rel=1e-12)
    assert float(row["omega3"]) == 0


def test_sweep_that_ends_there(folder: Path) -> None:
    """The cases end at rest, at times that are inverse to the moment of friction."""
    text = (
        BODY
        + "&study kind = 'sweep' /\n&initial theta = 1  omega = 0, 0, 5 /\n"
        + "&effects friction_torque = 0.1 /\n&span t_end = 100  stop_at = 'stuck' /\n"
        + "&sweep parameter(1) = 'effects.friction_torque'  values(1, :) = 0.1, 0.2, 0.4 /\n"
        + "&output columns = 't_end', 'psi_end' /\n"
    )
    done = run(folder, text)
    assert done.returncode == 0, done.stderr
    for row, moment in zip(rows_of(folder / "scene.csv"), (0.1, 0.2, 0.4), strict=True):
        assert float(row["t_end"]) == pytest.approx(0.3 * 5 / moment, rel=1e-10)
        assert float(row["psi_end"]) == pytest.approx(0.3 * 5**2 / 2 / moment, rel=1e-10)
        assert row["notes"] == ""


@pytest.mark.parametrize(
    ("effects", "event", "words"),
    [
        ("drag_force = 0.1", "stuck", "only a body with dry friction that is not smoothed"),
        ("friction_torque = 0.1  friction_smoothing = 0.1", "slip", "sticks and slips"),
        ("friction_torque = 0.1", "knot", "needs a table of torques"),
        ("friction_torque = 0.1", "stick", "did you mean 'stuck'"),
    ],
)
def test_bad_input(folder: Path, effects: str, event: str, words: str) -> None:
    """Events that the effects cannot have are refused."""
    text = BODY + f"&initial theta = 1  omega = 0, 0, 5 /\n&effects {effects} /\n"
    done = run(folder, text + f"&span t_end = 1  stop_at = '{event}' /\n")
    assert done.returncode == 2
    assert words in " ".join(done.stderr.split()), done.stderr
