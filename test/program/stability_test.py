"""The stability study: its table, its verdicts, what it refuses."""

import math

import numpy as np
import pytest

from conftest import each

VERDICTS = {"accurate", "drifts", "wrong", "failed", "unsuitable", "no_reference"}
OWN = (
    "&study kind = 'stability' /\n&top mass = 1, inertia = 1, {}, 0.5, length = 0.5 /\n"
    "&initial theta = 0.5, omega3 = 10 /\n&span t_end = {} /\n"
    "&stability cases = {}, methods = {} /\n"
)


def study(spin, cases, methods):
    rows = spin("stability", f"stability.cases={cases}", f"stability.methods={methods}").rows
    assert set(rows.verdict) <= VERDICTS
    return {(row.case, row.method, row.formulation): row for row in rows.itertuples()}


def test_verdicts(spin):
    """A good method is accurate, a poor one wrong, one with poles gives up at them."""
    cases, methods = "slow_top,through_upright,intermediate_axis", "euler_forward,taylor"
    rows = study(spin, cases, methods + ",dop853/lagrange")
    assert len(rows) == 9
    good = rows["slow_top", "taylor", "space_frame"]
    assert (good.verdict, good.reference, good.reason) == ("accurate", "exact solution", "")
    assert good.orientation_error < 1e-9
    poor = rows["slow_top", "euler_forward", "space_frame"]
    assert poor.verdict == "wrong"
    assert poor.orientation_error > 0.1
    assert "orientation error" in poor.reason
    stuck = rows["through_upright", "dop853", "lagrange"]
    assert (stuck.verdict, stuck.status) == ("failed", "pole")
    assert "pole" in stuck.reason
    free = rows["intermediate_axis", "taylor", "rigid_body"]
    assert (free.verdict, free.reference) == ("accurate", "exact solution")
    assert rows["intermediate_axis", "dop853", "lagrange"].verdict == "unsuitable"


def test_growth_of_sleeping_tops(spin):
    """Upright growth rates change from zero to positive at the threshold."""
    above, below = study(spin, "sleeping_above,sleeping_below", "taylor").values()
    assert (above.case, below.case) == ("sleeping_above", "sleeping_below")
    assert abs(above.upright_growth) < 1e-6
    # sqrt(4 I1 mgl - (I3 omega3)^2)/(2 I1)
    expected = math.sqrt(4 * 0.875 * 8.495709211125343 - 3.75**2) / 1.75
    assert below.upright_growth == pytest.approx(expected, abs=5e-10)


def test_own_case(spin):
    rows = spin(OWN.format(1.2, 3, "'input'", "'dop853', 'splitting_8'")).rows
    assert list(rows.case) == ["input", "input"]
    assert set(rows.verdict) == {"accurate"}
    assert rows.steps[1] == 8000


def test_a_case_without_a_reference(spin):
    """Its rows have the status of its reference; those of the other cases stay."""
    text = OWN.format(1.2, 3, "'input', 'slow_top'", "'dop853', 'taylor'")
    run = spin(text + "&integration max_steps = 3 /\n", code=3)
    assert list(run.rows.case) == ["input", "input", "slow_top", "slow_top"]
    without, others = run.rows[:2], run.rows[2:]
    assert set(without.verdict) == {"no_reference"}
    assert set(without.status) == {"step_limit"}
    assert without.orientation_error.isna().all()
    assert without.reason.str.contains("no reference: the maximum number of steps").all()
    assert set(others.verdict) == {"accurate"}
    assert "1 no_reference" in run.out


@each("steps, has_one", (1000, True), (15, False))
def test_the_exponent_takes_no_more_than_the_work_allowed(spin, steps, has_one):
    """A motion of too many steps has no reference; the exact solution needs no steps."""
    text = OWN.format(1, 30, "'input'", "'taylor'")
    run = spin(text, f"integration.max_steps={steps}", code=0 if has_one else 3)
    assert ("failed    all 1 runs: 1 step_limit" in run.out) != has_one
    assert math.isnan(run.rows.lyapunov_exponent[0]) != has_one


@each(
    "setting, said",
    ("stability.cases=slow_tip", "did you mean 'slow_top'"),
    ("stability.methods=taylr", "did you mean 'taylor'"),
    ("stability.methods=taylor/lagrang", "did you mean 'lagrange'"),
    ("integration.method=rk4", "a stability study compares methods and formulations"),
    ("integration.formulation=euler", "a stability study compares methods and formulations"),
)
def test_refusals(spin, setting, said):
    assert said in spin.refuse("stability", setting)


def test_catalogue_is_listed(spin):
    names = [case["name"] for case in spin.listed("cases")]
    assert len(names) > 20
    assert "million_nutations" in names
    assert len(names) == len(set(names))


# A body that a vertical vibration holds upright: swept motions agree with the multipliers.

SPAN = 4.0
ONE = ("sweep.count(1)=1", "sweep.count(2)=1", "output.columns=upright_multiplier")


def test_map(spin):
    """Bodies fall where deviations grow fast enough, and stay where all multipliers are 1."""
    rows = spin("kapitza_map", "sweep.count(1)=4", "sweep.count(2)=4").rows
    growth = np.log(rows.upright_multiplier) * rows["effects.vibration_rate"] / (2 * np.pi)
    falls, stays = growth * SPAN > 6, growth < 1e-6
    assert (rows.t_end[falls] < SPAN).all()
    assert (rows.t_end[stays] == SPAN).all()
    assert min(falls.sum(), stays.sum()) >= 3
    assert (falls | stays).sum() >= 13


def test_boundary(spin):
    """The least rate that holds the body of the input is a limit of Mathieu's equation."""
    rates = ("sweep.from(1)=39.6781155", "sweep.to(1)=39.6781157", "sweep.count(1)=2")
    run = spin("kapitza_map", *ONE, *rates, "sweep.from(2)=0.15", "sweep.to(2)=0.15")
    below, above = run.rows.upright_multiplier
    assert below > 1 + 1e-6
    assert abs(above - 1) < 1e-9


def test_notes(spin):
    rows = spin("kapitza_map", *ONE, "effects.drag_force=0.1").rows
    assert np.isnan(rows.upright_multiplier[0])
    assert "the only effect must be a vertical vibration" in rows.notes[0]
