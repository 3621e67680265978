"""Bodies that are composed of parts, or given by an inertia tensor, in runs of the program."""

import re

import numpy as np
import pytest

from conftest import ROOT

TOP = (ROOT / "input/composed_top.nml").read_text()
PART = "&part shape = 'disc' mass = 2 radius = 0.1 thickness = 0.02 place = {} axis = {} /\n"
START = (
    "&initial quaternion = {}, {}, 0, 0  omega = {} /\n&span t_end = 3 samples = 31 /\n"
    "&output columns = 't', 'com_x', 'com_y', 'com_z', 'lz', 'energy', 'inherent_error' /\n"
)


def test_results_are_in_the_axes_of_the_parts(spin):
    """Euler's equations hold in these axes, in which the body has a product of inertia."""
    columns = "R1,R2,energy,lz,com_x,com_y,com_z,omega1,omega2,omega3"
    rows = spin("composed_top", f"output.columns={columns}").rows
    assert rows[["R1", "R2"]].abs().to_numpy().max() < 1e-12
    for name in ("energy", "lz"):
        assert rows[name].to_numpy() == pytest.approx(rows[name][0], rel=5e-10)
    distance = np.linalg.norm(rows[["com_x", "com_y", "com_z"]], axis=1)
    assert distance == pytest.approx(0.049776039, abs=5e-9)
    assert rows.omega3[0] == 200


def test_the_header_is_the_input(spin):
    """The resolved input repeats the groups; run again, it gives the same rows."""
    first = spin("composed_top", "span.samples=11")
    expected, text = first.rows, first.head
    assert text.count("&part") == 4
    assert spin(text).rows.equals(expected)


def test_an_inclined_top_is_exact(spin):
    """A top whose parts are inclined in the body axes has the motion of the upright one."""
    upright = spin(PART.format("0, 0, 0.5", "0, 0, 1") + START.format(0.6, 0.8, "1, 2, 30")).rows
    # The axes of the second body are turned about x by the angle whose sine is 0.6.
    # q = p conj(turn).
    s, c = 0.1**0.5, 0.9**0.5
    omega = f"1, {2 * 0.8 + 30 * 0.6}, {-2 * 0.6 + 30 * 0.8}"
    start = START.format(0.6 * c - 0.8 * s, 0.8 * c + 0.6 * s, omega)
    inclined = spin(PART.format("0, 0.3, 0.4", "0, 3, 4") + start)
    assert "principal axes" in inclined.out
    assert inclined.rows.to_numpy() == pytest.approx(upright.to_numpy(), abs=5e-12)


def test_parts_are_swept(spin):
    """A number of a part is an axis, by its place in the list of parts."""
    text = TOP.replace("kind = 'trajectory'", "kind = 'sweep'").replace("samples = 2001", "")
    text += "&sweep parameter(1) = 'part.mass(4)' from(1) = 0.001 to(1) = 0.004 count(1) = 4 /\n"
    rows = spin(text).rows
    assert list(rows.status) == ["ok"] * 4
    assert rows.theta_end.nunique() == 4
    alone = spin("composed_top", "part.mass(4)=0.002", "output.columns=theta").rows
    assert rows.theta_end[1] == pytest.approx(alone.theta.iloc[-1], abs=5e-10)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("'rod'", "'rode'", "did you mean 'rod'?"),
        ("density = 2700", "", "neither mass nor density of the part is given"),
        ("thickness = 0.02", "", "part.thickness(4) is not given"),
        ("gravity = 9.81", "mass = 1", "top.mass is not for a body of parts"),
        ("axis = 1, 0, 0", "axis = 0, 0, 0", "has no direction"),
    ],
)
def test_messages(spin, old, new, said):
    """A wrong part is reported where it is given."""
    error = spin.refuse(TOP.replace(old, new))
    assert said in error
    assert re.search(r"scene\.nml:\d+:\d+: error: ", error)
