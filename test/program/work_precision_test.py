"""The work-precision study: its table, its summary, what it refuses."""

import math
from typing import NamedTuple

import pandas as pd
import pytest

from conftest import ROOT, each

NAME = "work_precision_slow_top"
SLOW_TOP = (ROOT / f"input/{NAME}.nml").read_text()
SKEW = """
&study kind = 'work_precision' /
&top mass = 1  inertia = 1, 1.5, 2.25  centre_of_mass = 0.1, 0.05, 0.2 /
&initial quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1 /
&span t_end = 5 /
"""
ANGLES = ("phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate")


class Study(NamedTuple):
    rows: pd.DataFrame
    said: str

    def of(self, method):
        return self.rows[self.rows.method == method].set_index("setting")


def study(spin, scene, methods, *settings, code=0):
    settings = [f"work_precision.{setting}" for setting in (f"methods={methods}", *settings)]
    run = spin(scene, *settings, code=code)
    return Study(run.rows, run.out)


def test_errors_costs_and_order(spin):
    """Errors fall as the order of a method says, costs grow, rows are sorted by time."""
    methods = "exact,taylor,splitting_2,dop853/lagrange"
    found = study(spin, NAME, methods, "tolerances=1e-6,1e-9,1e-12", "steps=800,1600,3200")
    rows = found.rows
    assert len(rows) == 10
    assert rows.time_s.is_monotonic_increasing
    assert rows.time_s[0] > 0
    assert set(rows.status) == {"ok"}
    assert set(rows.problem) == {NAME}

    steps = found.of("splitting_2")
    for column in ("orientation_error", "error_max", "theta_error_max"):
        coarse, fine = steps[column][["steps 1600", "steps 3200"]]
        assert math.log2(coarse / fine) == pytest.approx(2, abs=0.1), column
    assert steps.steps["steps 800"] == 800
    assert steps.evaluations["steps 800"] >= 800

    series = found.of("taylor").loc[[f"tolerance {t}" for t in ("1e-06", "1e-09", "1e-12")]]
    assert series.error_max.is_monotonic_decreasing
    assert series.error_max.iloc[-1] < 1e-10
    assert series.formulation.iloc[-1] == "space_frame"

    exact = found.of("exact").loc["-"]
    assert (exact.formulation, exact.steps) == ("closed_form", 0)
    assert 0 < exact.error_max < 1e-13
    assert exact.reference == "quadruple precision"
    assert exact.reference_error < 1e-15
    assert exact.reference_check < 1e-13


def test_steps_alone(spin):
    """Without tolerances methods use a fixed step size if they can; their errors decrease."""
    found = study(spin, NAME, "taylor,dop853/lagrange", "steps=200,400")
    assert set(found.of("dop853").index) == {"steps 200", "steps 400"}
    assert "tolerance 1e-06" in found.of("taylor").index
    coarse, fine = found.of("dop853").error_max[["steps 200", "steps 400"]]
    assert coarse / fine > 2**4


@each(
    "tolerances, methods, code, failed",
    ("1e-12,1e-13", "dop853", 3, "all 2 runs: 2"),
    ("1e-3,1e-12", "dop853", 0, "1 of 2 runs: 1"),
    ("1e-12,1e-13", "dop853,rk4", 0, "2 of 3 runs: 2"),
)
def test_runs_that_fail(spin, tolerances, methods, code, failed):
    """Where all do, or some, the summary begins with it; steps that are given need no limit."""
    text = (
        "&study kind = 'work_precision' /\n"
        "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.866 /\n"
        "&initial theta_deg = 10, omega3 = 20 /\n&span nutations = 20 /\n"
        "&integration max_steps = 300 /\n"
    )
    found = study(spin, text, methods, f"tolerances={tolerances}", "steps=4000", code=code)
    second = found.said.splitlines()[1]
    assert second.startswith(f"  failed    {failed} step_limit")
    assert "; increase integration.max_steps" in second
    assert set(found.rows.status[found.rows.setting == "steps 4000"]) <= {"ok"}


def test_front(spin):
    """A row is on the front if no stepping method is as fast and as exact."""
    rows = study(spin, NAME, "taylor,rk4,splitting_4,dop853", "steps=100,400,1600").rows
    for row in rows.itertuples():
        better = (rows.time_s < row.time_s) & (rows.error_max <= row.error_max)
        assert row.front == ("no" if better.any() else "yes")


def chosen(found):
    return found.rows[found.rows["auto"] == "yes"]


def test_what_auto_takes(spin):
    """Rows of the method that would be chosen for their tolerance are marked."""
    found = study(spin, SKEW, "taylor,dop853,rk4", "tolerances=1e-6", "steps=100")
    assert list(chosen(found).method) == ["taylor"]
    assert "auto      takes no more than 2 times" in found.said
    assert list(chosen(study(spin, NAME, "exact,taylor", "tolerances=1e-6")).method) == ["exact"]
    settings = "formulations=lagrange", "tolerances=1e-3,1e-9"
    rows = chosen(study(spin, NAME, "ode45,dop853,rk4", *settings))
    assert set(rows.method) == {"dop853"}
    assert set(rows.setting) == {"tolerance 0.001", "tolerance 1e-09"}


def motion(spin, columns, samples, *settings):
    kind = ("study.kind=trajectory", f"output.columns={columns}", f"span.samples={samples}")
    return spin(NAME, *kind, *settings)


def test_errors_of_columns_are_those_of_trajectories(spin):
    """The last rows of two trajectories differ by what the study says."""
    row = study(spin, NAME, "dop853/lagrange", "tolerances=1e-6").rows.iloc[0]
    columns = ",".join([*ANGLES, "energy_error"])
    exact = motion(spin, columns, 101, "integration.method=exact").rows.iloc[-1]
    how = ("relative_tolerance=1e-6", "method=dop853", "formulation=lagrange")
    settings = [f"integration.{setting}" for setting in how]
    other = motion(spin, columns, 101, *settings).rows.iloc[-1]
    for name in ANGLES:
        difference = abs(exact[name] - other[name])
        assert difference / row[f"{name}_error"] == pytest.approx(1, abs=1e-5)


def test_any_body(spin):
    found = study(spin, SKEW, "exact,taylor,rkmk_4", "tolerances=1e-12", "steps=400")
    assert set(found.rows.method) == {"taylor", "rkmk_4"}
    for words in ("exact/", "omitted", "dop853 agrees"):
        assert words in found.said
    assert found.rows.reference_error[0] < 1e-14
    assert found.rows.reference_check[0] < 1e-12
    assert found.of("taylor").error_max["tolerance 1e-12"] < 1e-10


def test_stored_reference(spin):
    stored = motion(spin, "q0,q1,q2,q3,t,omega1,omega2,omega3,theta", 41).path
    stored = stored.rename(spin.folder / "stored.csv")
    settings = ("taylor,rk4", "steps=400,800", "tolerances=1e-8")
    found = study(spin, NAME, *settings, f"reference={stored}")
    assert set(found.rows.reference) == {"stored.csv"}
    direct = study(spin, NAME, *settings, "reference=exact")
    for method, setting in (("rk4", "steps 800"), ("taylor", "tolerance 1e-08")):
        left, right = (one.of(method).loc[setting] for one in (found, direct))
        for column in ("orientation_error", "theta_error"):
            assert left[column] / right[column] == pytest.approx(1, abs=1e-4)


def test_swept_problems(spin):
    axis = ("parameter=initial.theta", "from=0.2", "to=0.6", "count=3")
    settings = [
        f"work_precision.{x}" for x in ("methods=taylor,rk4", "steps=100", "tolerances=1e-6")
    ]
    rows = spin(NAME, *settings, *(f"sweep.{setting}" for setting in axis)).rows
    assert len(rows) == 6
    tilts = dict(zip(rows.problem, rows["initial.theta"], strict=True))
    names = [f"{NAME}.{k}" for k in (1, 2, 3)]
    assert [round(tilts[name], 12) for name in names] == [0.2, 0.4, 0.6]


def test_what_gives_up_has_no_errors(spin):
    """A method that stops is a row with its status, and others go on."""
    pole = SKEW.replace("0.8, 0.6, 0, 0", "1, 0, 0, 0").replace("1, 1.5, 2.25", "1, 1, 0.5")
    pole = pole.replace("0.1, 0.05, 0.2", "0, 0, 0.2")
    methods = "taylor,dop853/lagrange,rkmk_4/lagrange"
    found = study(spin, pole, methods, "tolerances=1e-9")
    stuck = found.of("dop853").loc["tolerance 1e-09"]
    assert (stuck.status, stuck.front) == ("pole", "no")
    assert math.isnan(stuck.error_max)
    assert math.isnan(stuck.tip_error)
    assert found.of("taylor").error_max["tolerance 1e-09"] < 1e-6
    assert "rkmk_4/lagrange: integration.formulation" in found.said


def test_a_tolerance_too_fine_leaves_out_no_other(spin):
    """Settings that a method cannot keep are omitted with one message; others have rows."""
    found = study(spin, NAME, "taylor", "tolerances=1e-31,1e-6,1e-21,1e-9")
    assert set(found.of("taylor").index) == {"tolerance 1e-06", "tolerance 1e-09"}
    assert found.said.count("omitted") == 1
    found = study(spin, NAME, "taylor", "tolerances=1e-31", code=3)
    assert len(found.rows) == 0
    assert "has no rows" in found.said


def test_settings_of_integration_go_to_those_who_take_them(spin):
    """The exact motion takes none of them, explicit methods no solver."""
    keys = "absolute_tolerance = 1e-13 solver = 'fixed_point' project = 'unit'"
    text = f"{SLOW_TOP}&integration {keys} /\n"
    found = study(spin, text, "exact,rk4,gauss_4", "steps=100")
    assert set(found.rows.method) == {"exact", "rk4", "gauss_4"}
    assert "omitted" not in found.said


def test_a_body_at_rest_without_weight(spin):
    """Has neither energy nor momentum, and no error of them."""
    rest = SKEW.replace("0.5, 0.5, 1 /", "0, 0, 0 /").replace("top mass", "top gravity = 0  mass")
    rows = study(spin, rest, "taylor,rk4").rows
    assert (rows[["energy_error", "lz_error"]] == 0).all(axis=None)


def test_in_a_pole_phi_and_psi_have_no_errors(spin):
    """The axis of a sleeping top stays in it."""
    text = "&study kind = 'work_precision' /\n"
    text += "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.5 /\n"
    text += "&initial theta = 0  psi_rate = 25 /\n&span t_end = 1 /\n"
    rows = study(spin, text, "taylor,exact,rk4", "tolerances=1e-9", "steps=400").rows
    assert set(rows.status) == {"ok"}
    assert (rows.orientation_error < 1e-3).all()
    assert (rows.theta_error < 1e-6).all()
    without = ["phi_error", "psi_error", "phi_rate_error", "psi_error_max"]
    assert rows[without].isna().all(axis=None)


def test_angles_are_those_of_the_attitude(spin):
    """A pendulum passes the vertical, where Lagrange's angle theta leaves its range."""
    swing = SKEW.replace("1, 1.5, 2.25", "1, 1, 0.5").replace("0.1, 0.05, 0.2", "0, 0, 0.2")
    swing = swing.replace("quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1", "theta_deg = 45")
    row = study(spin, swing, "dop853/lagrange", "tolerances=1e-10").rows.iloc[0]
    assert row.status == "ok"
    assert all(row[f"{name}_error_max"] < 1e-6 for name in ANGLES)


def test_a_reference_that_cannot_be_checked(spin):
    """The exact motion of a long span is there though no method comes to the end of it."""
    text = SLOW_TOP.replace("t_end = 6.66 ", "t_end = 1e9 ")
    text += "&integration max_steps = 1000 /\n"
    found = study(spin, text, "taylor", "tolerances=1e-9", "reference=exact", code=3)
    assert list(found.rows.status) == ["step_limit"]
    assert math.isnan(found.rows.reference_check[0])
    assert "could not be checked" in found.said


def test_a_reference_beyond_the_work_allowed(spin):
    """The motion in quadruple precision takes no more steps than any other."""
    settings = ("work_precision.methods=rk4", "work_precision.steps=2", "integration.max_steps=3")
    run = spin(SKEW, *settings, code=3)
    assert "has no reference: the maximum number of steps" in run.out + run.stderr


def test_cheapest(spin):
    """The sentence names the fastest of the rows that are exact enough."""
    methods = "work_precision.methods=exact,taylor,rk4"
    run = spin(NAME, methods, "work_precision.tolerances=1e-4,1e-8", "work_precision.steps=800")
    enough = run.rows[(run.rows.method != "exact") & (run.rows.error_max <= 1e-6)]
    best = enough.loc[enough.time_s.idxmin()]
    name = f"{best.method}/{best.formulation}, {best.setting}"
    assert f"for 1e-06 the cheapest is {name}: " in run.out
    assert "for 1e-12 no method is accurate enough" in run.out
    assert "the exact solution takes " in run.out
    table = run.path.read_text()
    assert f"\n# in words: for 1e-06 the cheapest is {name}: " in table
    assert "\n# in words: auto: takes no more than 2 times" in table


RK4 = "work_precision.methods=rk4"
AXIS = ("sweep.from=1", "sweep.to=2", "sweep.count=2")


@each(
    "settings, part",
    (["work_precision.methods=tailor"], "did you mean 'taylor'"),
    (
        ["work_precision.methods=arkode_verner_8_5_6"],
        "it is a table: name 'arkode_erk', and give integration.table = 'arkode_verner_8_5_6'",
    ),
    (["work_precision.methods=rk4/lagrang"], "did you mean 'lagrange'"),
    ([RK4, "span.samples=8"], "7 intervals do not divide 100"),
    (["integration.method=rk4"], "compares methods"),
    (["integration.relative_tolerance=1e-3"], "varies the tolerance"),
    (["output.columns=t"], "the columns of this study are fixed"),
    (["work_precision.reference=nothing.csv"], "nothing.csv: No such file"),
    (["work_precision.reference=exact"], "no exact solution"),  # of a body that has none
    (["work_precision.repeats=0"], "work_precision.repeats"),
    (["work_precision.tolerances=2"], "work_precision.tolerances"),
    (["span.stop_at=maximum"], "to the end of its span"),
    (["output.events=turning_points"], "only a trajectory has a table of events"),
    (["sweep.parameter=integration.steps", *AXIS], "varies the steps"),
    (["sweep.parameter=work_precision.repeats", *AXIS], "work_precision.repeats cannot vary"),
)
def test_refusals(spin, settings, part):
    scene = SKEW if "=exact" in settings[0] else NAME
    assert part in spin.refuse(scene, *settings)


HEAD = "t,q0,q1,q2,q3,omega1,omega2,omega3\n"
ROW = "0,0.995184726672197,0.098017140329561,0,0,0,0,1\n"


@each(
    "text, part",
    ("t,q0\n0,1\n", "no column q1"),
    (HEAD + ROW, "1 rows"),
    (HEAD + ROW + "7,1,0,0,0,0,0,1\n", "row 2 of the table is for t = 7"),
    (HEAD + ROW + "6.66,1,0,0,1,0,0,1\n", "whose norm is not 1"),
    (HEAD + ROW.replace("0,1\n", "0,2\n") + "6.66,1,0,0,0,0,0,1\n", "has another start"),
    (HEAD + ROW + "6.66,1,0,0,x,0,0,1\n", "x"),
    (HEAD + ROW + "6.66,1,0\n", "the row ends before q2"),
    ("", "the table is empty"),
)
def test_tables_that_are_no_reference(spin, text, part):
    table = spin.folder / "reference.csv"
    setting = f"work_precision.reference={table}"
    assert part in spin.refuse(NAME, setting, reference=text)
