"""The threshold of the sleeping top: told of a top that starts upright, and in sweeps."""

import math

import pytest

from conftest import each

TOP = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
CRITICAL = 2 * math.sqrt(9.81 * 0.866 * 0.875) / 0.25
SPAN = "&span t_end = 1 /\n"
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
    run = spin(f"{TOP}&initial {start} /\n{SPAN}")
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
    assert "warning: the top stays upright" in spin(f"{damped}&initial {start} /\n{SPAN}").err


@each(
    "top, effects, start, name, with_effects",
    ("length = 0.866", "rotor_momentum = 0, 0, 3", "omega3 = 15", "omega3", 27),
    ("length = -0.866", "", "omega3 = 15", "omega3", None),
    ("length = 0.866", "earth_rate = 12  latitude_deg = 90", "omega3 = 15", "omega3", 27),
    ("centre_of_mass = 0.866, 0, 0", "", "omega = 15, 0, 0", "omega1", None),
)
def test_spin_of_the_summary(spin, top, effects, start, name, with_effects):
    inertia = "0.25, 0.875, 0.875" if name == "omega1" else "0.875, 0.875, 0.25"
    text = f"&top mass = 1  inertia = {inertia}  {top} /\n{SPAN}&effects {effects} /\n"
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
        f"&study kind = 'sweep' /\n{TOP.replace(old, new) if old else TOP}{SPAN}"
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
