"""Motions that reverse, exactly or nearly, under forces against the velocity.

There the Taylor series goes on with the force of the old direction; so it does in a motion that is
nearly plane, as far as its terms can tell. The same holds where the support force passes through
zero, on whose magnitude friction depends. What must agree: the motion by Runge-Kutta, which needs
no series, that by Taylor's method in double and quadruple precision, and the end of a sweep's case.
"""

import math
from itertools import pairwise

import pytest

from conftest import each, output

TOP = "&top mass = 1  inertia = 0.9, 0.9, 0.25  length = 0.3  gravity = 9.81 /\n"
FREE = TOP.replace("9.81", "0")
SWING = TOP + "&initial theta = 0.5  psi = 0.7  theta_rate = 1  omega3 = {} /\n"
SPIN = TOP + "&initial theta = 0  omega3 = {} /\n"
BALANCED = "&top mass = 1  inertia = 0.9, 0.9, 0.3  centre_of_mass = {} /\n"
TURNING = BALANCED + "&initial theta = 0.5  omega3 = 12 /\n"
STILL = BALANCED + "&initial theta = 0.5 /\n"
ROD = (
    "&top mass = 1  inertia = 0.9, 0.9, {}  length = 0.5 /\n"
    "&initial theta = 1.141592653589793  omega3 = 20 /\n"
)
LOAD = "friction_coefficient = 0.3  friction_radius = 0.03"
SHAKEN = LOAD + "  vibration_amplitude = 0, 0, 0.05  vibration_rate = 30"
TABLE = "t,m1,m2,m3\n0,0,0,0.1\n1,0,0,-1\n3,0,0,-2\n"
SPLINE = "t,m1,m2,m3\n0,0,0,0\n1,0,0,0.3\n2,0,0,0\n3,0,0,-0.3\n4,0,0,0\n6,0,0,0\n"
DRAG, DRY = "drag_moment = 0.1, 0.1, 0.1", "friction_torque = 0.1"
SLIGHT = "vibration_amplitude = 0, 0, 0.04  vibration_rate = 17"
BY_TABLE = "  torque_table = 'table.csv'"
BY_SPLINE = "  torque_table = 'spline.csv'  torque_interpolation = 'spline'"
SCENES = {
    "drag": (SWING, DRAG, 8),
    "drag 1.5": (SWING, f"{DRAG}  drag_exponent = 1.5", 5),
    "force": (SWING, "drag_force = 5", 8),
    "vibration": (SWING, f"{DRAG}  vibration_amplitude = 0, 0, 0.1  vibration_rate = 15", 4),
    "smoothed": (SWING, f"{DRY}  friction_smoothing = 1e-6", 5),
    "dry": (SWING, f"friction_torque = 0.4  {SLIGHT}", 4),
    "spin": (SPIN, "drag_moment = 0, 0, 0.05  torque_body = 0, 0, -0.2", 6),
    "table": (f"{FREE}&initial theta = 1  omega3 = 0.3 /\n", f"{DRY}{BY_TABLE}", 3),
    "spline": (f"{FREE}&initial theta = 1  omega3 = 0 /\n", f"{DRY}{BY_SPLINE}", 6),
    "spinning rod": (ROD, "drag_force = 0.5", 8),
    "rod without momentum": (ROD, "drag_force = 0.5  rotor_momentum = 0, 0, -6", 8),
    "support": (TURNING, SHAKEN, 2),
    "smoothed support": (TURNING, SHAKEN + "  friction_smoothing = 1e-3", 2),
    "support at rest": (STILL, SHAKEN + "  torque_body = 0, 0, 0.03", 2),
}
PLACES = ("0, 0, 0", "1e-6, 0, 1e-6", "1e-2, 0, 1e-2")
SPINS = {
    **{SWING: ("0", "1e-9", "1e-3"), SPIN: ("2",), ROD: ("1e-8", "1e-6", "1e-5", "1e-4")},
    **{TURNING: PLACES, STILL: PLACES[:1]},
}
"""What is put into the start of a scene: the spin, a moment of inertia, or the centre of mass."""
CASES = [(name, spin) for name, (start, *_) in SCENES.items() for spin in SPINS.get(start, ("",))]
TOLERANCE = 3e-9
"""Of Taylor's method with its default tolerance, 1e-9."""


def last_row(spin, text):
    return spin(text, "--threads=1", table=TABLE, spline=SPLINE).rows.iloc[-1]


def between(a, b):
    """Two angles apart, but for half turns: a plane motion goes through poles."""
    return abs(math.remainder(a - b, math.pi))


@each("name, place", *CASES)
def test_all_ways_agree(spin, name, place):
    """The end of the motion; and the account of the energy is closed."""
    start, effects, t_end = SCENES[name]
    scene = start.format(place) + f"&effects {effects} /\n"
    ends = {}
    # Near zeros of the support force there are many steps, of which the errors add up.
    # An estimate may not see what a step across one of them errs, unless it is short.
    near, short = (1e-12, 1e-14) if place in PLACES else (1e-9, 1e-13)
    motion = f"{scene}&span t_end = {t_end}  samples = 2 /\n"
    motion += output("t", "theta", "psi", "omega3", "energy_error")
    for method, tolerance in (("dop853", short), ("taylor", near), ("taylor_quadruple", 1e-20)):
        how = f"&integration method = '{method}'  relative_tolerance = {tolerance} /\n"
        ends[method] = last_row(spin, motion + how)
    known = ends["dop853"]
    for method, end in ends.items():
        assert end.theta == pytest.approx(known.theta, abs=TOLERANCE), method
        assert between(end.psi, known.psi) < TOLERANCE, method
        assert end.omega3 == pytest.approx(known.omega3, abs=TOLERANCE), method
        assert abs(end.energy_error) < TOLERANCE, method
    sweep = f"&study kind = 'sweep' /\n{scene}&span t_end = {t_end} /\n"
    sweep += f"&sweep parameter(1) = 'span.t_end'  values(1,:) = {t_end / 2}, {t_end} /\n"
    sweep += f"&integration relative_tolerance = {near} /\n"
    end = last_row(spin, sweep + output("theta_end", "psi_end", "energy_error_max"))
    assert end.theta_end == pytest.approx(known.theta, abs=TOLERANCE)
    assert between(end.psi_end, known.psi) < TOLERANCE
    assert end.energy_error_max < TOLERANCE


def test_support_force_through_zero(spin):
    """The spin of a balanced body falls with the integral of m |g - A W^2 cos Wt|."""
    scene = TURNING.format("0, 0, 0") + f"&effects {SHAKEN} /\n&span t_end = 2  samples = 2 /\n"
    amplitude, rate, g = 0.05, 30, 9.81

    def impulse(t):
        return g * t - amplitude * rate * math.sin(rate * t)

    zeros = math.acos(g / (amplitude * rate**2))
    ends = [0.0, *((2 * math.pi * k + sign * zeros) / rate for k in range(10) for sign in (-1, 1))]
    ends = [*sorted(end for end in ends if 0 <= end < 2), 2.0]
    total = sum(abs(impulse(b) - impulse(a)) for a, b in pairwise(ends))
    scene += output("t", "omega3", "energy_error")
    for tolerance in (1e-9, 1e-13):
        how = f"&integration method = 'taylor'  relative_tolerance = {tolerance} /\n"
        omega3 = last_row(spin, scene + how).omega3
        assert omega3 == pytest.approx(12 - 0.3 * 0.03 / 0.3 * total, abs=30 * tolerance)
