"""Every number that a sweep may vary changes the motion, or is refused: no axis is ignored."""

import itertools
import re

from conftest import each, listed

BODY = "&top mass = 1 inertia = 0.9, 0.8, 0.3 centre_of_mass = 0.1, 0.05, 0.7 /\n"
SYMMETRIC = "&top mass = 1 inertia = 0.9, 0.9, 0.3 length = 0.7 /\n"
ANGLES = "&initial theta = 0.4 omega3 = 7 /\n"
VECTORS = "&initial quaternion = 0.8, 0.6, 0, 0 omega = 1, 2, 7 /\n"
PARTS = (
    "&part shape = 'cone' density = 7800 radius = 0.02 thickness = 0.1 /\n"
    "&part shape = 'cylinder' mass = 0.5 radius = 0.1 thickness = 0.02 place = 0.1, 0, 0.5 /\n"
)
EFFECTS = (
    "&effects vibration_amplitude = 0.01, 0, 0.02 vibration_rate = 20 torque_body = 0.1, 0.1, 0.1"
    " torque_body_amplitude = 0.1, 0.2, 0.1 torque_body_rate = 3"
    " rotor_momentum = 0, 0, 0.5 earth_rate = 0.01 latitude = 1 /\n"
)
REST = (
    "&study kind = 'sweep' /\n&span t_end = 0.5 /\n"
    "&output columns = 'theta_end', 'phi_end', 'psi_end', 'force_max', 't_end' /\n"
)
#: What only says how a motion is computed need not change it.
GROUPS = ("top", "part", "initial", "effects", "span")


def numbers():
    """All numbers of these groups; of lists and of groups that repeat the first three."""
    names = []
    for parameter in listed("parameters"):
        if parameter["group"] not in GROUPS or parameter["type"] not in ("real", "integer"):
            continue
        sizes = re.findall(r"\d+", parameter["full_name"].removeprefix(parameter["name"]))
        ranges = [range(1, min(3, int(size)) + 1) for size in sizes]
        for place in itertools.product(*ranges):
            subscripts = ",".join(map(str, place))
            names.append(parameter["name"] + (f"({subscripts})" if place else ""))
    return names


@each(
    "scene",
    BODY + ANGLES,
    BODY + VECTORS,
    SYMMETRIC + ANGLES,
    PARTS + ANGLES,
    BODY + ANGLES + EFFECTS,
)
def test_no_axis_is_ignored(spin, scene):
    """With two values of a number the motions end differently, or the sweep is refused."""
    names = numbers()
    assert {"initial.omega(1)", "top.inertia_tensor(1,3)"} < set(names)
    varied = 0
    for name in names:
        axis = f"&sweep parameter(1) = '{name}' values(1,:) = 0.31, 0.37 /\n"
        run = spin(scene + REST + axis, "--restart", code=(0, 2, 3))
        if run.code != 2:
            varied += 1
            ends = run.texts.iloc[:, 3:-1]
            assert len(ends.drop_duplicates()) > 1, name
    assert varied > 5


def test_parts_of_vectors(spin):
    """All elements have values or vary, whatever gives the cases."""
    grid = "&sweep parameter(1) = 'top.mass' values(1,:) = 1\n"
    grid += "parameter(2) = 'initial.omega(1)' values(2,:) = 1, 2 /\n"
    told = r"initial\.omega\(2\) is missing(\n.*)+initial\.omega\(1\) varies and requires it"
    assert re.search(told, spin.refuse(BODY + ANGLES + REST + grid))
    scene = SYMMETRIC + ANGLES + REST + "&sweep table = 'cases.csv' /\n"
    told = r"centre_of_mass\(1\) is missing(\n.*)+top\.centre_of_mass\(3\) varies"
    assert re.search(told, spin.refuse(scene, cases="top.centre_of_mass(3)\n0.5\n"))
    start = "&initial theta = 0.4 /\n&sweep combine = 'zip',"
    axes = " parameter = 'initial.omega(1)', 'initial.omega(3)', 'initial.omega(2)',"
    values = " values(1,:) = 1, 2, values(2,:) = 3, 4, values(3,:) = 5, 6 /\n"
    varied = spin(BODY + REST + start + axes + values).texts
    start = "&initial theta = 0.4 omega = 1, 5, 3 /\n"
    mass = "&sweep parameter = 'top.mass' values(1,:) = 1 /\n"
    given = spin(BODY + REST + start + mass).texts
    assert list(given.iloc[0, 3:]) == list(varied.iloc[0, 5:])
