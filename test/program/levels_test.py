"""Tests of SPINTOP_LEVEL: the levels of the processor agree, and one level has one result."""

import pytest

LEVELS = ("v2", "v3", "v4")
"""From the lowest on; a machine has the first of them."""
EFFECTS = """\
&effects drag_moment = 1e-3, 2e-3, 1e-3  vibration_amplitude = 0.01, 0, 0.02  vibration_rate = 9
    earth_rate = 0.3  latitude_deg = 50  rotor_torque = 0, 0, 0.01 /
"""
BODY = """\
&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0.02, 0.8
    damping = 0.01, 0.02, 0.01 /
&initial theta_deg = 20  omega = 0.1, 0.2, 8 /
&span t_end = 3 /
"""
INPUTS = {
    "one": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n",
    "affected": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n"
    + EFFECTS,
    "stages": "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n"
    "&integration method = 'dop853'  relative_tolerance = 1e-12 /\n" + EFFECTS,
    "many": "&study kind = 'sweep' /\n&sweep parameter = 'initial.theta_deg' from = 5 to = 60"
    " count = 20 /\n&output columns = 'theta_end', 'psi_end', 'theta_rate_end' /\n",
}


def at_level(spin, name, level):
    """The table at a level, where empty is as good as not set: its level, its lines, numbers."""
    run = spin(INPUTS[name] + BODY, environment={"SPINTOP_LEVEL": level})
    (line,) = [line for line in run.comments if line.startswith("processor: ")]
    lines = run.path.read_text(encoding="utf-8").splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    numbers = run.rows.select_dtypes("number").to_numpy()
    return line.removeprefix("processor: ").removeprefix("x86-64-"), rows, numbers


@pytest.mark.parametrize("name", INPUTS)
def test_levels(spin, name):
    """Each level of the machine is named in the table, has the same bytes again, and differs from
    others by rounding and tolerance."""
    highest, *_ = at_level(spin, name, "")
    levels = LEVELS[: LEVELS.index(highest) + 1] if highest in LEVELS else ()
    *_, first = at_level(spin, name, levels[0] if levels else "")
    assert first.size
    for level in levels:
        found, rows, numbers = at_level(spin, name, level)
        assert found == level
        assert rows == at_level(spin, name, level)[1]
        assert numbers == pytest.approx(first, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("level", ["v9", "V3", "native", " ", "v2 ."])
def test_other_words(spin, level):
    """A level that the processor does not have is refused."""
    run = spin(INPUTS["one"] + BODY, environment={"SPINTOP_LEVEL": level}, code=2)
    told = f"SPINTOP_LEVEL is '{level}', but the levels of this processor are: "
    assert told in run.stderr
    assert not run.path.exists()
