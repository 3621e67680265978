"""Extremes of sweeps are those over the span, however short: of a tenth of a nutation, or of many.

They are compared with those of many rows of the trajectory, for the exact motion and by several
methods: in vector lanes, and one case after another.
"""

import math

import numpy as np
import pytest

from conftest import each, output

REST = "&initial theta = 0.9  phi_rate = 0.4  theta_rate = -0.7  psi_rate = 9 /\n"
HEAVY = (
    "&top mass = 1  inertia = 0.9, 0.7, 0.3  centre_of_mass = 0.02, -0.03, 0.4\n"
    "     damping = 3*0.02 /\n" + REST
)
FREE = "&top mass = 1  inertia = 0.9, 0.7, 0.3  length = 0 /\n" + REST
TENSOR = """\
&top mass = 2  inertia_tensor(1,:) = 0.7, 0.12, -0.1  inertia_tensor(2,2:3) = 0.9, 0.15
     inertia_tensor(3,3) = 0.6  centre_of_mass = 0.1, -0.15, 0.3 /
&initial theta = 1  psi = 0.3  phi_rate = 1  psi_rate = 5 /
"""
LANES = "method = 'taylor'"
ALONE = "method = 'taylor'  project = 'unit'"
STEPS = 8400
SHARES = 0.1, 0.5, 0.9, 2.1
"""Spans in units of about a nutation."""
RATES = ["phi_rate_max", "theta_rate_max", "com_z_min"]
ALL = ["theta_min", "theta_max", "delta_u", *RATES, "force_max", "force_z_min", "force_z_max"]
SPANS = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = {} /\n"


def extremes(rows):
    theta = rows.theta.min(), rows.theta.max()
    force = np.linalg.norm(rows[["force_x", "force_y", "force_z"]], axis=1)
    return {
        "theta_min": theta[0],
        "theta_max": theta[1],
        "delta_u": math.cos(theta[0]) - math.cos(theta[1]),
        "phi_rate_max": max(rows.phi_rate, key=abs),
        "theta_rate_max": rows.theta_rate.abs().max(),
        "com_z_min": rows.com_z.min(),
        "force_max": force.max(),
        "force_z_min": rows.force_z.min(),
        "force_z_max": rows.force_z.max(),
    }


@each(
    "body, nutation, method, columns",
    (HEAVY, 2.1, LANES, ALL),
    (HEAVY, 2.1, ALONE, ALL),
    (HEAVY, 2.1, "method = 'dop853'", ALL),
    (TENSOR, 1.6, LANES, ALL),
    (FREE, 1.7, "method = 'exact'", RATES),
    (FREE, 1.7, LANES, RATES),
    (FREE, 1.7, "method = 'dop853'", RATES),
)
def test_extremes(spin, body, nutation, method, columns):
    """In each span, all together and each alone; what needs a whole nutation says so."""
    spans = [share * nutation for share in SHARES]
    accurate = "" if "exact" in method else "  relative_tolerance = 1e-11"
    sweep = f"{body}&integration {method}{accurate} /\n" + SPANS.format(", ".join(map(repr, spans)))
    found = spin(sweep + output(*columns, "nutation_period")).rows
    alone = {name: spin(sweep + output(name)).rows for name in columns}
    precise = "&integration relative_tolerance = 1e-12 /\n" if body != FREE else ""
    forces = "force_x", "force_y", "force_z"
    rows = spin(
        f"{body}{precise}&span t_end = {spans[-1]!r}  samples = {STEPS + 1} /\n"
        + output("t", "theta", "theta_rate", "phi_rate", "com_z", *forces)
    ).rows
    assert not rows.isna().to_numpy().any()
    for i, span in enumerate(spans):
        known = extremes(rows[: round(STEPS * span / spans[-1]) + 1])
        for name in columns:
            value = found[name][i]
            assert value == pytest.approx(known[name], rel=1e-5, abs=1e-7), (span, name)
            assert alone[name][name][i] == pytest.approx(value, rel=1e-9), (span, name)
            assert not alone[name].notes[i], (span, name)
        has_period = not np.isnan(found.nutation_period[i])
        assert ("no full nutation" in found.notes[i]) != has_period, span
    assert np.isnan(found.nutation_period[0])
    assert not np.isnan(found.nutation_period[len(spans) - 1])


# Motions in which body z passes the lower pole at 1e-6 rad.
BESIDE_POLES = [
    """\
&top mass = 1  inertia = 0.6603094158617984, 0.7847621876864949, 0.2593160816891005
     centre_of_mass = -0.017175524321969594, -0.02, 0.78  damping = 0.01, 0.01, 0.005 /
&initial theta = 2.829913706186562  omega3 = 3.2394348014953644
         phi_rate = -0.8454998918643344  theta_rate = 2.9866871373352657 /
""",
    """\
&top mass = 1  inertia = 0.6804447361426638, 0.6937312351496909, 0.36662318784966325
     centre_of_mass = -0.016117333434512528, -0.02, 0.78  damping = 0.01, 0.01, 0.005 /
&initial theta = 2.9588587094695917  omega3 = 1.6702832838535508
         phi_rate = -1.2832155308899906  theta_rate = 2.849442748767455 /
""",
]


@each("body", *BESIDE_POLES)
def test_rates_beside_poles(spin, body):
    """In lanes and alone the same; a large rate next to a pole makes no cusps of the others."""
    sweep = body + SPANS.format(6) + output("phi_rate_max", "theta_max", "motion_class")
    rates = []
    for method in (LANES, ALONE, "method = 'dop853'"):
        text = f"{sweep}&integration {method}  relative_tolerance = 1e-12 /\n"
        (row,) = spin(text).rows.itertuples()
        assert abs(row.theta_max - math.pi) < 3e-6
        assert row.motion_class != "cusp"
        rates.append(row.phi_rate_max)
    assert abs(rates[0]) > 1e6
    assert rates == pytest.approx(3 * [rates[1]], rel=1e-5)


# Bodies that are all but symmetric, so that they are integrated: cusps for phi_rate = 0, loops and
# waves for others; and plane swings, below the pivot and over the poles.
CLASSES = {
    """\
&top mass = 1  inertia = 0.9, 0.9000000001, 0.3  centre_of_mass = 0, 0, 0.4 /
&initial theta = 0.9  theta_rate = 0  omega3 = 9 /
&sweep parameter = 'initial.phi_rate'  values(1,:) = -0.2, 0, 0.2, 0.6, 1.5 /
""": {"cusp", "loop", "wave"},
    """\
&top mass = 1  inertia = 0.9, 0.7, 0.3  centre_of_mass = 0, 0, 0.4 /
&initial theta = 2  omega = 0, 0, 0 /
&sweep parameter = 'initial.omega(1)'  values(1,:) = 0, 1, 9 /
""": {"libration", "circulation"},
}


@each("scene", *CLASSES)
@each("method", ALONE, "method = 'dop853'")
def test_class_alone(spin, scene, method):
    settings = f"&integration {method}  relative_tolerance = 1e-11 /\n&span t_end = 8 /\n"
    sweep = scene + settings + "&study kind = 'sweep' /\n"
    alone = list(spin(sweep + output("motion_class")).rows.motion_class)
    assert alone == list(spin(sweep + output("motion_class", "phi_rate_max")).rows.motion_class)
    assert CLASSES[scene] <= set(alone)


# Extremes of rates where what is searched is rounding: in a pole, and in a plane through it.
#
# The bound is on the work: `max_steps` is a small part of what a search that divides rounding
# errors would take.

BODY = "&top mass = 1  inertia = 1, 2, 3  length = {} /\n"
WORK = 20000
RUBBING = "&effects friction_torque = 0.1 /\n"


def extreme(spin, scene, span, column, control=""):
    control = f"&integration max_steps = {WORK} {control} /\n"
    rows = spin(scene + SPANS.format(span) + control + output(column)).rows
    assert list(rows.status) == ["ok"]
    return rows[column][0]


@each("effect", "", RUBBING)
def test_start_in_a_pole(spin, effect):
    """The precession rate near the start is that of rows, with friction and without."""
    heavy = BODY.format(1) + effect + "&initial theta = 0  omega = 1, 0.3, 5 /\n"
    text = heavy + "&span t_end = 3 samples = 60001 /\n" + output("t", "phi_rate")
    known = max(spin(text, "integration.relative_tolerance=1e-12").rows.phi_rate[1:], key=abs)
    for method in ("method = 'dop853'", "method = 'taylor' project = 'unit'", ""):
        found = extreme(spin, heavy, "3", "phi_rate_max", method)
        assert found / known == pytest.approx(1, abs=1e-5), method


EARTH = "&effects earth_rate = 0.5 latitude = 0.7 /\n"


@each("pole", 0, math.pi)
@each("length, effect", (0, ""), (0.3, ""), (0.3, RUBBING), (0.3, EARTH))
@each("share", 0.01, 0.1, 0.4)
def test_short_motions_from_a_pole(spin, pole, length, effect, share):
    """Where the precession slows down, the largest rate is the limit in the pole."""
    body = BODY.format(length) + effect
    body += f"&initial theta = {pole!r}  psi = 0.4  omega = 1, 2.5, -4 /\n"
    rows = spin(f"{body}&span t_end = {share} samples = 2001 /\n" + output("t", "phi_rate")).rows
    known = max(rows.phi_rate[2:], key=abs)
    methods = ["method = 'dop853'", "method = 'taylor' project = 'unit'", "method = 'taylor'"]
    for method in methods + [""] * (length == 0):
        found = extreme(spin, body, share, "phi_rate_max", method)
        assert found / known == pytest.approx(1, abs=2e-3), method


@each("omega, psi", ("1.5, 0, 0", 0), ("0, 1.5, 0", 90))
@each("method", "", "method = 'taylor'", "method = 'dop853'")
@each("theta", 0.5, 0.5 * math.pi, math.pi)
def test_free_rotation_through_the_poles(spin, omega, psi, method, theta):
    """About a horizontal principal axis theta turns with omega."""
    start = f"&initial theta = {theta!r}  psi_deg = {psi}  omega = {omega} /\n"
    found = extreme(spin, BODY.format(0) + start, "20", "theta_rate_max", method)
    assert found == pytest.approx(1.5, abs=1e-8)


# What a sweep says of motions that an event ends is what it says of motions that end then.

SWEEP = "&study kind = 'sweep' /\n&sweep parameter = 'initial.omega3'  values(1,:) = {} /\n"
START = "&initial theta_deg = 30  phi_rate = 0.5 /\n"
SYMMETRIC = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
ANY = "&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0, 0.5 /\n"
STOP = "stop_at = 'turning_points'  stop_after = 3"


@each("body", SYMMETRIC, ANY)
@each("method", "auto", "taylor", "dop853")
def test_growth_to_the_event(spin, body, method):
    columns = ["t_end", "largest_singular_value", "lyapunov_exponent"]
    if body == SYMMETRIC:
        columns += ["inherent_error"]
    text = f"{body}{START}&integration method = '{method}' /\n{SWEEP.format(3)}"
    stopping = f"{text}&span t_end = 9  {STOP} /\n"
    (stopped,) = spin(stopping + output(*columns)).rows[columns].to_numpy()
    assert stopped[0] < 8
    whole = spin(f"{text}&span t_end = {float(stopped[0])!r} /\n" + output(*columns)).rows
    assert whole[columns].to_numpy()[0] == pytest.approx(stopped, rel=1e-6)
    alone = spin(stopping + output(columns[1])).rows
    assert alone[columns[1]][0] == stopped[1]


def test_the_turning_point_at_the_end_counts(spin):
    """On whichever side of the end rounding errors put it."""
    spins = ", ".join(str(5 + 0.19 * k) for k in range(60))
    text = f"{ANY}{START}{SWEEP.format(spins)}&span t_end = 40  {STOP} /\n"
    text += output("nutation_period", "precession_per_nutation", "motion_class")
    methods = ("taylor", 1e-9), ("taylor", 1e-12), ("dop853", 1e-10), ("dop853", 1e-12)
    how = "&integration method = '{}'  relative_tolerance = {} /\n"
    first, *others = (spin(text + how.format(*method)).rows for method in methods)
    for other in others:
        assert list(other.motion_class) == list(first.motion_class)
        for name in ("nutation_period", "precession_per_nutation"):
            np.testing.assert_allclose(other[name], first[name], rtol=1e-5, equal_nan=False)


@each("effect", "drag_moment = 3*0.1", "torque_body = 0, 0, 5")
@each("stop", "", STOP)
def test_no_growth_with_effects(spin, effect, stop):
    """The equations of perturbations are those without effects."""
    columns = ["largest_singular_value", "lyapunov_exponent"]
    text = f"{ANY}&effects {effect} /\n{START}&span t_end = 3  {stop} /\n{SWEEP.format(3)}"
    row = spin(text + output(*columns)).rows.iloc[0]
    assert np.isnan(row[columns].astype(float)).all()
    assert "no Lyapunov exponent: it is not measured for bodies with effects" in row.notes
