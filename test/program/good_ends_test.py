"""Every kind of run tells a good end from a failure alike.

Two tops go through all kinds: one that dry friction brings to rest, a good end, and one whose steps
do not suffice half way. The code of a run is that of its cases, with one of them or many, in parts,
and where nothing is left to compute. `python_ends_test` has the kinds of Python and of the scripts.
"""

import numpy as np
import pytest

from conftest import each, listed, netcdf_is_missing

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
NETCDF = "output.format=netcdf"
GOOD_ENDS = {entry["name"] for entry in listed("statuses") if entry["good"]}


def formats():
    ways = [[]] if netcdf_is_missing() else [[], [NETCDF]]
    return [[*way, *more] for way in ways for more in ([], ["--resume"])]


def test_list():
    assert {"ok", "at_rest"} == GOOD_ENDS


@each("keys, good", *ENDS)
def test_trajectory(spin, keys, good):
    """The rows go on at rest; the code is the same where nothing is left to compute."""
    for options in formats():
        run = spin(SCENE + keys, "span.samples=101", *options, code=0 if good else FAILED)
    assert (len(run.rows) == 101) is good
    (said,) = (line for line in run.comments if line.startswith("status: "))
    assert (said.split()[1] in GOOD_ENDS) is good


@each("keys, good", *ENDS)
def test_sweep(spin, keys, good):
    for options in formats():
        run = spin(SWEEP + WITH_ROWS + keys, *options, code=0 if good else FAILED)
    assert list(run.rows.status.isin(GOOD_ENDS)) == [True, True, good]
    assert list(np.isfinite(run.rows.t_stuck)) == [True, True, good]


@each("keys, good", *ENDS)
@each("output", WITH_ROWS, WITHOUT_ROWS, ids=["rows", "no rows"])
def test_statistics(spin, keys, good, output):
    """Cases at rest are in the statistics: t_stuck has a mean."""
    for options in formats():
        run = spin(SWEEP + STATISTICS + output + keys, *options, code=0 if good else FAILED)
    row = run.table("statistics").iloc[0]
    assert list(row[["cases", "failed", "t_stuck_count"]]) == [3, not good, 3 if good else 2]
    assert 0 < row.t_stuck_mean < 2


@each("keys, good", *ENDS)
@each("output", WITH_ROWS, STATISTICS + WITHOUT_ROWS, ids=["rows", "no rows"])
def test_parts(spin, keys, good, output):
    for options in ([], ["--resume"]):
        for part, code in ((1, 0), (2, 0), (3, 0 if good else FAILED)):
            spin(SWEEP + output + keys, f"--shard={part}/3", *options, code=code)


@each("method, step", ("taylor", 0), ("dop853", 0), ("ode45", 0), ("rk4", 1e-3), ("gauss_8", 1e-3))
def test_stop_at_rest(spin, method, step):
    """A motion that ends when it comes to rest has that time as t_stuck; fixed steps a step off."""
    control = f"step = {step}" if step else "relative_tolerance = 1e-9"
    text = SWEEP.replace("t_end = 2", "t_end = 2  stop_at = 'stuck'")
    text += f"{COLUMNS}, 't_end' /\n&integration method = '{method}'  {control} /\n"
    rows = spin(text).rows
    assert rows.status.isin(GOOD_ENDS).all()
    assert list(rows.t_stuck) == pytest.approx(list(rows.t_end), rel=0, abs=step)
    assert (rows.notes == "").all()


def test_body_that_moves_again(spin):
    """A motion that ends with a departure is not at rest: t_stuck is that of the end."""
    text = SWEEP.replace("9 /", "9  vibration_amplitude = 0, 0, 0.05  vibration_rate = 30 /")
    text = text.replace("t_end = 2", "t_end = 2  stop_at = 'slip'")
    rows = spin(text + WITH_ROWS).rows
    left = ~rows.notes.str.contains("stop_at did not occur in the span")
    assert (rows.t_stuck.isna() == left).all()
    assert (rows.notes.str.contains("not stopped by dry friction") == left).all()


@each("keys, good", *ENDS)
def test_fit(spin, keys, good):
    """The friction is found from a motion that comes to rest, if its model does to its end."""
    truth = SCENE + "&output columns = 't', 'phi', 'theta', 'psi' /\n"
    measured = spin(truth, "span.samples=41").path.read_text()
    text = "&study kind = 'fit' /\n" + SCENE.replace("torque = 9", "torque = 8.7")
    text += "&fit data = 'measured.csv'  unknown = 'effects.friction_torque' /\n"
    run = spin(text + keys, code=0 if good else FAILED, measured=measured)
    assert not good or run.rows.estimate[0] == pytest.approx(9, rel=1e-6)


@each(
    "kind, keys",
    ("stability", "cases = 'input'"),
    ("work_precision", "repeats = 1  tolerances = 1e-6"),
)
def test_comparisons_of_methods(spin, kind, keys):
    """Methods are compared on motions at rest too; the failure of one is a result."""
    text = f"&study kind = '{kind}' /\n{SCENE}&{kind} methods = 'taylor', 'dop853'  {keys} /\n"
    rows = spin(text).rows
    assert len(rows) == 2
    assert rows.status.isin(GOOD_ENDS).all()
    assert (rows.orientation_error < 1e-5).all()
    assert kind != "stability" or rows.verdict.isin(["accurate", "drifts"]).all()
