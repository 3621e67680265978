"""Extremes of rates where what is searched is rounding: in a pole, and in a plane through it.

The bound is on the work: `max_steps` is a small part of what a search that divides rounding
errors would take.
"""

import math

import pytest

from conftest import each, output

BODY = "&top mass = 1  inertia = 1, 2, 3  length = {} /\n"
SWEEP = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = {} /\n"
WORK = 20000
RUBBING = "&effects friction_torque = 0.1 /\n"


def extreme(spin, scene, span, column, control=""):
    control = f"&integration max_steps = {WORK} {control} /\n"
    rows = spin(scene + SWEEP.format(span) + control + output(column)).rows
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
