"""What is constant to rounding has no events and no period; what varies a little has true ones."""

import math

import pytest

from conftest import each

INERTIA, AXIAL, LENGTH, GRAVITY, SPIN = 0.875, 0.25, math.sqrt(0.75), 9.81, 18.0
TOP = f"&top mass = 1  inertia = 2*{INERTIA}, {AXIAL}  length = {LENGTH!r}  {{}} /\n"
METHODS = {
    "lanes": "method = 'taylor'",
    "lanes, finer": "method = 'taylor'  relative_tolerance = 1e-13",
    "taylor, projected": "method = 'taylor'  project = 'unit'",
    "dop853": "method = 'dop853'",
    "dop853, finer": "method = 'dop853'  relative_tolerance = 1e-13",
    "ode45": "method = 'ode45'",
    "rk4": "method = 'rk4'  steps = 4000",
    "gauss_6": "method = 'gauss_6'  steps = 2000",
}


def rates(which, theta=math.pi / 3):
    """Rates of phi and psi in steady precession: a p^2 - b p + c = 0."""
    a, b, c = INERTIA * math.cos(theta), AXIAL * SPIN, GRAVITY * LENGTH
    larger = b + math.sqrt(b * b - 4 * a * c)
    precession = 2 * c / larger if which == "slow" else larger / (2 * a)
    return precession, SPIN - precession * math.cos(theta)


def nutation_period(which, theta=math.pi / 3):
    """The period of small nutations about steady precession."""
    p, _ = rates(which, theta)
    b = AXIAL * SPIN / INERTIA
    bend = (b - 2 * p * math.cos(theta)) ** 2 + p * math.sin(theta) ** 2 * p
    return 2 * math.pi / math.sqrt(bend)


@each("which", "slow", "fast")
@each("method", *METHODS)
def test_small_nutations(spin, method, which):
    """Nothing, or the period of small nutations: never a number of noise."""
    phi_rate, psi_rate = rates(which)
    changes = 0, 1e-13, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4
    dampings = 1e-20, 1e-16, 1e-13, 1e-11, 1e-9, 1e-7
    text = TOP.format("damping = 0, 0, 1e-20")
    text += "&study kind = 'sweep' /\n"
    text += f"&initial theta = 1  phi_rate = {phi_rate!r}  psi_rate = {psi_rate!r} /\n"
    text += "&span t_end = 12 /\n"
    text += f"&integration formulation = 'rigid_body'  {METHODS[method]} /\n"
    thetas = ", ".join(repr(math.pi / 3 + change) for change in changes)
    text += f"&sweep parameter(1) = 'initial.theta'  values(1,:) = {thetas}\n"
    text += f"  parameter(2) = 'top.damping(3)'  values(2,:) = {', '.join(map(repr, dampings))} /\n"
    text += "&output columns = 'nutation_period', 'precession_per_nutation', 'nutation_rate' /\n"
    rows = spin(text).rows
    assert len(rows) == len(changes) * len(dampings)
    assert set(rows.status) == {"ok"}
    wanted, found = nutation_period(which), set()
    columns = ["initial.theta", "top.damping(3)", "nutation_period", "precession_per_nutation"]
    columns += ["nutation_rate", "notes"]
    for theta, damping, period, *others, notes in rows[columns].itertuples(index=False):
        change = theta - math.pi / 3
        if not math.isnan(period) and damping < 1e-19:
            found.add(change)
        if damping > 1e-15 and change < 10 * damping:
            continue  # The inclination drifts faster than it oscillates.
        if math.isnan(period):
            assert "no full nutation in the span" in notes
            assert all(map(math.isnan, others))
            assert change < (3e-4 if method == "ode45" else 2e-6)
            continue
        assert period == pytest.approx(wanted, rel=0.02)
    if method in ("lanes", "lanes, finer", "dop853, finer"):
        assert len([change for change in found if change > 5e-11]) == 6


@each("integration", "method = 'exact'", *METHODS.values())
def test_stop_at_never_comes(spin, integration):
    """The end of the span is reached, with the note that the event did not occur."""
    text = TOP.format("") + "&study kind = 'sweep' /\n"
    text += "&initial theta_deg = 60  omega3 = 18  steady_precession = 'slow' /\n"
    text += "&sweep parameter(1) = 'initial.omega3'  from = 17  to = 40  count = 40 /\n"
    text += f"&integration {integration} /\n&output columns = 't_end' /\n"
    for event in "turning_points", "theta_rate = 0", "axis_z_rate = 0":
        rows = spin(text + f"&span t_end = 6  stop_at = '{event}' /\n").rows
        assert set(rows.t_end) == {6}
        assert rows.notes.str.contains("stop_at did not occur in the span").all()


# Body z stays where it is, whatever these effects do.
STILL = {
    "precession": "&initial theta_deg = 60  omega3 = 18  steady_precession = 'slow' /\n",
    "below": "&initial theta_deg = 120  omega3 = 7  steady_precession = 'fast' /\n",
    "hanging": "&initial theta_deg = 180 /\n",
    "hanging and turning": "&initial theta_deg = 180  psi_rate = 4 /\n",
    "sleeping": "&initial theta_deg = 0  psi_rate = 30 /\n",
    "vibrating": "&initial theta_deg = 180 /\n&effects vibration_amplitude = 0, 0, 0.01"
    "  vibration_rate = 50 /\n",
    "with a rotor": "&initial theta_deg = 180  psi_rate = 4 /\n"
    "&effects rotor_momentum = 0, 0, 2 /\n",
    "in air": "&initial theta_deg = 180  psi_rate = 9 /\n&effects drag_moment = 3*0.01 /\n",
    "rubbing": "&initial theta_deg = 180  psi_rate = 9 /\n&effects friction_torque = 0.01 /\n",
    "on the Earth": "&initial theta_deg = 180  psi_rate = 9 /\n&effects earth_rate = 0.1"
    "  latitude_deg = 90 /\n",
}


@each("scene", *STILL)
@each("method", "auto", "taylor", "dop853", "rk4")
def test_no_events(spin, scene, method):
    if (scene, method) == ("rubbing", "taylor"):
        return
    text = TOP.format("") + STILL[scene] + "&integration method = '" + method
    text += "'  formulation = 'rigid_body'  steps = 3000 /\n" if method == "rk4" else "' /\n"
    names = "'turning_points', 'theta_rate = 0', 'axis_z_rate = 0'"
    text += f"&output columns = 't'  events = {names} /\n&span t_end = 8  samples = 3 /\n"
    assert len(spin(text).table("events")) == 0


def test_a_torque_that_comes_later(spin):
    """What is constant until a table of torques begins is not constant."""
    torque = "t,m1,m2,m3\n0,0,0,0\n2,0,0,0\n3,0.3,0,0\n9,0.3,0,0\n"
    text = TOP.format("") + STILL["hanging"] + "&effects torque_table = 'torque.csv' /\n"
    text += "&span t_end = 8  samples = 3 /\n&output columns = 't'  events = 'turning_points' /\n"
    assert len(spin(text, torque=torque).table("events")) > 3


# Constants of motions over thousands of nutations, as exact as the arithmetic allows.

NUTATIONS, STEPS_A_NUTATION = 2000, 11
SCENE = """\
&study kind = 'trajectory' /
&top mass = 1  inertia = {first}, {first}, 0.25  length = 0.8660254037844387 /
&initial theta = {theta}  psi_rate = {rate} /
&span t_end = {end}  samples = 2 /
&integration formulation = '{formulation}'  method = 'taylor'  max_steps = 10000000 /
&output columns = 't', 'energy_error', 'lz', 'norm_error' /
"""
TOPS, I3 = 24, 0.25
CHI_SQUARE = 91.0
"""So large is the sum of squares of 24 standard normal numbers in one case of 10^9."""
SIZES = {"energy": 0.8, "momentum": 2.0, "norm": 0.25}
"""The standard deviation after n steps in 1e-16 sqrt(n): of the walk, not of one drawing of it."""


def scene_of(formulation, k, nutations):
    """The input of the k-th top. Its momentum about the axis is the same in each step."""
    share = k / (TOPS - 1)
    data = {"first": 0.895 + 0.04 * share, "theta": 0.49 + 0.68 * share, "rate": rate_of(k)}
    return SCENE.format(formulation=formulation, end=1.5 * nutations, **data)


def rate_of(k):
    return 4.94 - 1.13 * k / (TOPS - 1)


@each("formulation", "space_frame", "rigid_body")
def test_constants(spin, formulation):
    """Energy, momentum about the vertical and norm wander by the root of steps.

    Errors of independent walks of n steps are normal with a variance of n, so that the sum of
    their squares scatters as chi-square.
    """
    unit = 1e-16 * math.sqrt(NUTATIONS * STEPS_A_NUTATION)
    sums = dict.fromkeys(SIZES, 0.0)
    for k in range(TOPS):
        scene = scene_of(formulation, k, NUTATIONS)
        start, end = spin(scene, "integration.relative_tolerance=0").rows.iloc[[0, -1]].itertuples()
        ends = {
            "energy": end.energy_error,
            "momentum": (end.lz - start.lz) / (I3 * rate_of(k)),
            "norm": end.norm_error,
        }
        for name, error in ends.items():
            sums[name] += (error / (SIZES[name] * unit)) ** 2
    assert all(total < CHI_SQUARE for total in sums.values()), sums


def test_zero(spin):
    """Zero is the finest tolerance of the method, and a tolerance below it is refused."""
    scene = scene_of("rigid_body", 0, 10)
    zero, finest = (spin(scene, f"integration.relative_tolerance={x}").texts for x in (0, "1e-20"))
    assert zero.lz.equals(finest.lz)
    # Sweeps in lanes reach it as well.
    sweep = ("study.kind=sweep", "sweep.parameter=initial.theta", "sweep.values(1,:)=0.3,0.9")
    columns = "output.columns=energy_error_max"
    rows = spin(scene, "integration.relative_tolerance=0", *sweep, columns).rows
    assert (rows.energy_error_max < 1e-14).all()
    error = spin.refuse(scene, "integration.relative_tolerance=1e-21")
    assert "cannot reach a tolerance below 1e-20" in error
