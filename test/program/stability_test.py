"""The stability study: its table, its verdicts, what it refuses.

The threshold of the sleeping top: told of a top that starts upright, and in sweeps.
"""

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


TOP = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
CRITICAL = 2 * math.sqrt(9.81 * 0.866 * 0.875) / 0.25
SECOND = "&span t_end = 1 /\n"
SAID = "the top stays upright only because nothing disturbs it"


@each(
    "start, warns",
    ("theta = 0  spin_ratio = 1.8", True),
    ("theta = 0  spin_ratio = 1.9", False),
    ("theta = 1e-6  spin_ratio = 1.8", False),
    ("quaternion = 1, 0, 0, 0  omega = 0, 0, -21", True),
    ("quaternion = 1, 0, 0, 0  omega = 0, 1e-9, -21", False),
    ("theta_deg = 180  omega3 = 1", False),
)
def test_an_upright_start(spin, start, warns):
    """A start exactly upright with too little spin has a warning; the summary has the threshold."""
    run = spin(f"{TOP}&initial {start} /\n{SECOND}")
    assert ("stays upright only because nothing disturbs it" in run.err) is warns
    assert f"a sleeping top is stable from omega3 = {CRITICAL:.10f} rad/s" in run.out


@each(
    "length, start",
    ("0.866", "theta = 0  omega3 = 21"),
    ("-0.866", "quaternion = 0, 1, 0, 0  omega = 0, 0, 21"),
)
def test_damped(spin, length, start):
    """Damping holds no top upright; one with its centre of mass at -z is upright too."""
    damped = TOP.replace("0.866 /", f"{length}  damping = 0.1, 0.1, 0.1 /")
    assert "warning: the top stays upright" in spin(f"{damped}&initial {start} /\n{SECOND}").err


@each(
    "top, effects, start, name, with_effects",
    ("length = 0.866", "rotor_momentum = 0, 0, 3", "omega3 = 15", "omega3", 27),
    ("length = -0.866", "", "omega3 = 15", "omega3", None),
    ("length = 0.866", "earth_rate = 12  latitude_deg = 90", "omega3 = 15", "omega3", 27),
    ("centre_of_mass = 0.866, 0, 0", "", "omega = 15, 0, 0", "omega1", None),
)
def test_spin_of_the_summary(spin, top, effects, start, name, with_effects):
    inertia = "0.25, 0.875, 0.875" if name == "omega1" else "0.875, 0.875, 0.25"
    text = f"&top mass = 1  inertia = {inertia}  {top} /\n{SECOND}&effects {effects} /\n"
    run = spin(f"{text}&initial theta = 1e-6  {start} /\n")
    (line,) = (line for line in run.out.splitlines() if line.startswith("  upright"))
    assert f" rad/s; here {name} = {15:.10f}" in line
    assert f"from {name} = {CRITICAL:.10f}" in line
    if with_effects is None:
        assert line.endswith(f"{15:.10f}")
    else:
        assert float(line.split(" as one of ")[1]) == pytest.approx(with_effects, rel=1e-9)


@each("keys", "drag_moment = 0, 0, 0.001", "friction_torque = 0.1", "damping")
@each("omega3, t_end", (22, 1), (22, 0.01), (21, 1))
def test_slowing_down(spin, keys, omega3, t_end):
    """A top that is exactly upright in the end with less spin than the threshold is told of."""
    text = f"{TOP}&effects {keys} /\n"
    if keys == "damping":
        text = TOP.replace(" /", "  damping = 0, 0, 0.05 /")
    run = spin(f"{text}&initial theta = 0  omega3 = {omega3} /\n&span t_end = {t_end} /\n")
    assert (f"warning: {SAID}" in run.err) is (omega3 < CRITICAL)
    assert (f"note      in the end {SAID}" in run.out) is (omega3 > CRITICAL and t_end == 1)


ROTOR = "/\n&effects rotor_momentum = 0, 0, 1"


@each(
    "old, new, critical, ratio, note",
    ("", "", CRITICAL, 30 / CRITICAL, ""),
    ("length = 0.866", "length = 0.866  damping = 0, 0, 0.1", CRITICAL, 30 / CRITICAL, ""),
    ("/", f"{ROTOR}  drag_force = 1e-3 /", CRITICAL, 34 / CRITICAL, ""),
    ("/", f"{ROTOR} /", CRITICAL, 34 / CRITICAL, ""),
    ("length = 0.866", "length = 0", 0, math.nan, "gravity exerts no torque"),
    ("0.875, 0.25", "0.8, 0.25", math.nan, math.nan, "the body is not symmetric"),
)
def test_columns(spin, old, new, critical, ratio, note):
    """The threshold and the spin over it, for what has one."""
    row = spin(
        f"&study kind = 'sweep' /\n{TOP.replace(old, new) if old else TOP}{SECOND}"
        "&initial theta = 0.1  omega3 = 30 /\n"
        "&sweep parameter = 'initial.theta', values(1,:) = 0.1 /\n"
        "&output columns = 'critical_omega3', 'sleeping_ratio' /\n"
    ).rows.iloc[0]
    found = [row.critical_omega3, row.sleeping_ratio]
    assert found == pytest.approx([critical, ratio], rel=1e-14, nan_ok=True)
    assert note in row.notes if note else row.notes == ""


# Slow departures from rest under dry friction and slow returns to it, against closed forms.

DRY, CURVATURE, INERTIA = 0.5, 0.0125, 0.3
SCENE = (
    "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0 /\n&initial theta = 1  omega = 0, 0, 0 /\n"
    f"&span t_end = 10 /\n&effects friction_torque = {DRY!r}  torque_table = 'torque.csv'"
    "  torque_interpolation = 'spline' /\n"
    "&output columns = 't', 'psi'  events = 'stuck', 'slip' /\n"
)


@each("beyond", 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
@each("peak", 4.3, 5.0)
@each("method", "taylor", "dop853", "taylor_quadruple")
@each("absolute", 1e-12, 1e-16)
def test_short_departure(spin, absolute, method, peak, beyond):
    """However little the torque exceeds the friction, the body departs, and comes to rest.

    The absolute tolerance is that of the angular velocity, rad/s, as the dry moment gives a rate
    of about 1 rad/s; over the deceleration before the rest it is an error of the time.
    """
    rows = [f"{t},0,0,{DRY * (1 + beyond) - CURVATURE * (t - peak) ** 2!r}" for t in (0, 3, 6, 10)]
    integration = f"&integration method = '{method}'  absolute_tolerance = {absolute} /\n"
    events = spin(SCENE + integration, torque="\n".join(["t,m1,m2,m3", *rows, ""])).table("events")
    half = math.sqrt(beyond * DRY / CURVATURE)
    assert list(events.event) == ["slip", "stuck"]
    # Rounding of the torque over its slope; the tolerance over the deceleration.
    rounding = 1e-15 / (2 * CURVATURE * half)
    error = 10 * rounding + 1e-8 * half + absolute / (3 * CURVATURE * half**2 / INERTIA)
    assert events.t[0] == pytest.approx(peak - half, abs=rounding)
    assert events.t[1] == pytest.approx(peak + 2 * half, abs=error)
    turned = 9 / 4 * CURVATURE * half**4 / INERTIA
    assert events.psi[1] - events.psi[0] == pytest.approx(turned, rel=1e-5, abs=3 * half * absolute)
