"""Tests of the axes of a sweep as a user gives them: combinations, drawn values, tables."""

import itertools
import re

import numpy as np
import pytest

from conftest import CLOSED, each, listed, output, quoted

SWEEP = CLOSED + "&study kind = 'sweep' /\n"
FREE = SWEEP.replace("    psi_rate = 1.0\n", "").replace("    theta = 0.19634954084936207\n", "")
NUTATION = output("theta_min", "theta_max")
DRAWN = (
    "cases = 700, parameter(1) = 'initial.theta_deg', from(1) = 10, to(1) = 170,"
    " parameter(2) = 'initial.omega3', from(2) = 1, to(2) = 100, spacing(2) = 'log',"
    " parameter(3) = 'initial.theta_rate', values(3,:) = -1, 1 /\n"
)
HYPERCUBE = FREE + NUTATION + "&sweep combine = 'latin_hypercube', " + DRAWN


@each("combine", "random", "latin_hypercube")
def test_drawn_sweeps(spin, combine):
    """Values lie in their ranges; of another seed they are others."""
    text = HYPERCUBE.replace("latin_hypercube", combine)
    run = spin(text)
    rows = run.rows
    theta = rows["initial.theta_deg"]
    assert len(rows) == 700
    assert theta.between(10, 170).all()
    assert rows["initial.omega3"].between(1, 100).all()
    # The start is a turning point only without a rate: between both otherwise.
    assert (rows.theta_min < np.radians(theta)).all()
    assert (np.radians(theta) < rows.theta_max).all()
    other = spin(text, "sweep.seed=2147483646").rows
    assert not set(theta) & set(other["initial.theta_deg"])
    # What a table's header holds draws the same.
    assert spin(run.head, name="again").texts.equals(run.texts)


@each("cases", 1, 2, 3)
def test_a_latin_hypercube_of_a_few_cases(spin, cases):
    thetas = spin(HYPERCUBE, f"sweep.cases={cases}").rows["initial.theta_deg"]
    assert sorted(int((x - 10) / 160 * cases) for x in thetas) == list(range(cases))


def test_zip(spin):
    """Values side by side; of unequal numbers they are refused by name."""
    text = FREE + NUTATION + "&sweep combine = 'zip', parameter = 'initial.theta',"
    text += " 'initial.omega3', values(1,:) = 0.5, 1, 2, from(2) = 3, to(2) = 5, count(2) = 3 /\n"
    rows = spin(text).rows
    assert list(rows["initial.theta"]) == [0.5, 1, 2]
    assert list(rows["initial.omega3"]) == [3, 4, 5]
    error = spin.refuse(text, "sweep.count(2)=4")
    assert "initial.theta has 3, initial.omega3 has 4" in error
    assert "scene.nml" in error


def test_steady_precession_of_each_case(spin):
    text = FREE.replace("&initial\n", "&initial steady_precession = 'slow', omega3 = 40\n")
    text += output("theta_min", "theta_max", "precession_rate")
    text += "&sweep parameter(1) = 'initial.theta', values(1,:) = 0.3, 1, 1.5, 2.5 /\n"
    moment, axial, lever = 0.875, 0.25 * 40, 9.81 * 0.8660254037844387
    rows = spin(text).rows
    theta, rate = rows["initial.theta"], rows.precession_rate
    assert list(rows.theta_min) == pytest.approx(list(theta), abs=1e-7)
    assert list(rows.theta_max) == pytest.approx(list(theta), abs=1e-7)
    steady = moment * rate**2 * np.cos(theta) - axial * rate + lever
    assert list(steady) == pytest.approx([0] * 4, abs=1e-9)


@each("name", "nutation", "precession")
def test_spans_in_periods_of_each_case(spin, name):
    text = FREE.replace("&initial\n", "&initial theta = 1, omega3 = 40\n")
    text = text.replace("    t_end = 0.5\n", "") + output("t_end", f"{name}_period")
    text += f"&sweep parameter(1) = 'span.{name}s', values(1,:) = 0.5, 1, 3 /\n"
    rows = spin(text).rows
    expected = np.array([0.5, 1, 3]) * rows[f"{name}_period"]
    np.testing.assert_allclose(rows.t_end, expected, rtol=1e-14)


def test_method_of_the_header(spin):
    """Where a tolerance is an axis, the header names that of the first case as such."""
    text = SWEEP + "&integration method = 'taylor' /\n" + output("theta_end")
    text += "&sweep parameter(1) = 'integration.relative_tolerance'  values(1,:) = 1e-6, 1e-9 /\n"
    told = "relative tolerance 1e-06, absolute 1e-12, in the first case;"
    told += " then that of the column integration.relative_tolerance"
    assert told in " ".join(spin(text).comments)


def test_whole_numbers(spin):
    text = SWEEP + "&integration method = 'rk4' /\n" + output("evaluations")
    text += "&sweep parameter(1) = 'integration.steps', from(1) = 10, to(1) = 1000,"
    given = text + " count(1) = 3, spacing(1) = 'log' /\n"
    start = 1
    for scene in (given, text + " combine = 'random', cases = 50 /\n"):
        rows = spin(scene).rows
        steps = rows["integration.steps"]
        assert len(rows) == 50 or list(steps) == [10, 100, 1000]
        assert (steps == steps.astype(int)).all()
        assert list(rows.evaluations) == list(4 * steps + start)
    assert "integration.steps must be a whole number" in spin.refuse(given, "sweep.count(1)=4")


LAWS = (
    FREE + output("theta_end", "theta_min") + "&sweep combine = '{}', cases = 600,"
    " parameter = 'initial.quaternion', 'initial.omega3', 'top.mass', distribution = 'sphere',"
    " 'normal', 'lognormal', mean(2:3) = 20, 0.1, "
)
CORRELATED = "covariance(2,2) = 4, covariance(3,2) = -0.1, covariance(3,3) = 0.01 /\n"


@each("combine", "random", "latin_hypercube", "sobol", "saltelli")
def test_distributions(spin, combine):
    """Each column has the value of its parameter, whatever the threads and the parts."""
    text = LAWS.format(combine) + CORRELATED
    if combine == "saltelli":
        assert "need independent axes" in spin.refuse(text)
        text = LAWS.format(combine) + "deviation(2:3) = 2, 0.1 /\n"
    run = spin(text)
    texts = run.texts
    parts = [f"initial.quaternion({k})" for k in (1, 2, 3, 4)]
    assert list(texts)[1:7] == [*parts, "initial.omega3", "top.mass"]
    assert len(texts) == 600
    spin(text, "--threads=1", "--shard=5/7", "--output=part")
    part = (spin.folder / "part/scene.5-of-7.csv").read_bytes()
    assert part.split(b"notes\n")[1].partition(b"# end: ")[0] in run.path.read_bytes()
    assert spin(run.head, name="again").texts.equals(texts)
    # A case by itself, with the values of its columns, moves as in the sweep.
    row = texts.iloc[417]
    keys = ["initial.quaternion=" + ",".join(row[parts])]
    keys += [f"{key}={row[key]}" for key in ("initial.omega3", "top.mass")]
    alone = text.split("&output")[0].replace("'sweep'", "'trajectory'") + output("t", "theta")
    theta = spin(alone, *keys, "integration.method=exact").rows.theta
    assert theta.iloc[-1] == pytest.approx(float(row.theta_end), abs=1e-9)


@each(
    "name, values, reason",
    ("top.inertia(3)", (2, 0.3), "top.inertia(3): no body has these moments of inertia"),
    ("top.inertia(2)", (0.7, 0.875), "integration.method: the exact solution exists only"),
)
def test_a_first_case_that_cannot_be_computed_is_a_failed_case(spin, name, values, reason):
    """The order of the cases does not matter, be there no such body, or no closed form."""
    text = SWEEP + NUTATION + "&integration method = 'exact' /\n"
    text += f"&sweep parameter = '{name}', values(1,:) = {{}}, {{}} /\n"
    for order in (values, values[::-1]):
        rows = spin(text.format(*order), code=3).rows.set_index(name)
        assert list(rows.status[list(values)]) == ["bad_input", "ok"]
        assert reason in rows.notes[values[0]]
    assert reason.split(": ")[1] in spin.refuse(text.format(values[0], values[0]))


NORMAL = f"""{FREE}{NUTATION}
&sweep combine = 'sobol', seed = 0, cases = 64, parameter = 'top.mass', 'initial.theta',
    distribution = 'normal', 'sphere', mean = 1, deviation = 0.7 /
"""


def test_draws_out_of_range_are_failed_cases(spin):
    rows = spin(NORMAL, code=3).rows
    failed = rows.status == "bad_input"
    assert 0 < failed.sum() < 10
    assert ((rows["top.mass"] <= 0) == failed).all()
    assert set(rows.notes[failed]) == {"top.mass must be > 0"}


def test_sixteen_axes(spin):
    """As many may be drawn, go side by side or make a grid; no key names one more."""
    names = ("top.damping", "top.inertia", "top.centre_of_mass")
    keys = [f"{name}({k})" for name in names for k in (1, 2, 3)] + ["top.mass", "top.gravity"]
    keys += [f"initial.{name}" for name in ("theta", "phi", "psi", "omega3", "theta_rate")]
    text = FREE.replace("length", "! length") + output("theta_end")
    text += f"&sweep {{}}, parameter = {quoted(keys)},"
    text += f" from = {', '.join(['1'] * 16)}, to = {', '.join(['1.01'] * 16)} /\n"
    rows = spin(text.format("cases = 40, combine = 'sobol'")).rows
    assert list(rows)[1:17] == keys
    assert (rows[keys].nunique() == 40).all()
    said = spin(text.format("count = " + ", ".join(["2"] * 16)), "--check").out
    assert "65536 cases" in said


BILLIONS = 3_000_000_000


@each("kind", "drawn", "grid")
def test_more_cases_than_32_bits_count(spin, kind):
    """The last of a million parts of three billion cases, drawn and in a grid."""
    text = FREE + NUTATION + "&sweep combine = 'sobol', " + DRAWN.replace("700", str(BILLIONS))
    if kind == "grid":
        text = FREE + NUTATION + "&sweep parameter = "
        text += "'initial.theta_deg', 'initial.omega3', 'initial.phi',"
        text += " from = 10, 1, 0, to = 170, 100, 1, count = 3000, 1000, 1000 /\n"
    run = spin(text, "--shard=1000000/1000000")
    assert f"cases {BILLIONS - 2999} to {BILLIONS} of {BILLIONS}" in run.out
    rows = run.table("1000000-of-1000000")
    assert list(rows.case) == list(range(BILLIONS - 2999, BILLIONS + 1))
    if kind == "grid":
        assert list(rows.iloc[-1, 1:4]) == [170, 100, 1]
        assert rows.iloc[:, 2].nunique() == 3
    assert f"{BILLIONS} cases: " in spin(text, "--check").out


def test_check_forecasts(spin):
    """The size of the table that is then written, within a tenth; memory and time are named."""
    text = FREE + NUTATION + "&sweep combine = 'random', " + DRAWN.replace("700", "5000")
    ballast = b"\1" * (500 << 20)  # of this process, which is not the memory of the program
    said = spin(text, "--check", "--threads=2").out
    del ballast
    memory = re.search(r"! +memory +about (\S+) MB\n", said)
    assert float(memory[1]) < 400
    found = re.search(r"! +table +about (\S+) kB, (\S+) bytes per case", said)
    time = r"! +time +about \S+ \w+ on 2 threads, from (200|4992) cases in \S+ m?s\n"
    assert re.search(time, said)
    assert "a case takes" not in said
    columns = "output.columns=theta_min,lyapunov_exponent,theta_max"
    dear = spin(text, "--check", columns).out
    assert re.search(r"! +columns +with lyapunov_exponent a case takes \S+ times as long", dear)
    size = spin(text).path.stat().st_size
    assert float(found[1]) * 1000 == pytest.approx(size, abs=0.1 * size)
    assert not list(spin.folder.glob("output/*.part"))
    spin(said, "--check")


def test_check_tells_of_the_axes(spin):
    said = spin("random_tops", "--check").out
    assert "4000 cases: a Latin hypercube sample with seed 2012" in said
    assert "initial.theta_deg: any value from 5 to 175; first case " in said
    said = spin("spinning_wheel_sweep", "--check").out
    assert "20 cases: all combinations" in said
    assert "20 listed values; first case 0.1, last case 10\n" in said


TABLE = FREE + NUTATION + "&sweep table = 'cases.csv' /\n"


@each(
    "text",
    b"initial.theta,top.inertia(3)\n0.5,0.25\n1,0.3\n",
    b'# some tops\n\n initial.theta , "top.inertia(3)"\r\n\r\n .5,\t0.25\r\n#\n1, "0.3"',
    b'\xef\xbb\xbf"initial.theta",top.inertia(3)\n0.5d0 ,25e-2\n 1.0,.3 \n\n',
)
def test_a_table_gives_the_cases(spin, text):
    """Same results as with axes; comments, blanks, quotes and all kinds of line ends."""
    axes = "&sweep combine = 'zip', parameter = 'initial.theta', 'top.inertia(3)',"
    axes += " values(1,:) = 0.5, 1, values(2,:) = 0.25, 3d-1 /\n"
    expected = spin(FREE + NUTATION + axes).texts
    spin.write(text, "cases.csv")
    texts = spin(TABLE).texts
    assert list(texts)[:3] == ["case", "initial.theta", "top.inertia(3)"]
    assert texts.equals(expected)


def test_the_path_is_relative_to_the_input(spin):
    for name in ("data", "deep"):
        (spin.folder / name).mkdir()
        spin.write("initial.theta\n0.5\n", f"{name}/cases.csv")
    scene = TABLE.replace("cases.csv", "data/cases.csv")
    assert len(spin(scene).rows) == 1
    spin.write(TABLE, "deep/scene.nml")
    assert len(spin("deep/scene.nml", "--output=here").rows) == 1
    assert len(spin(scene, f"sweep.table='{spin.folder / 'deep/cases.csv'}'").rows) == 1


def test_a_changed_table_is_noticed(spin):
    """The resolved input holds the checksum, and refuses another table."""
    run = spin(TABLE, cases="initial.theta\n0.5\n")
    head, texts = run.head, run.texts
    assert re.search(r"table_checksum = '[0-9A-F]{8}'", head)
    assert spin(head, name="again").texts.equals(texts)
    assert "the table has changed" in spin.refuse(head, cases="initial.theta\n0.6\n")
    assert spin(TABLE).head != head


@each("given", "theta = 1.2", "theta_deg = 70", "theta = '70 deg'")
@each("name, value", ("theta", 0.5), ("theta_deg", 30))
def test_an_angle_is_replaced_in_any_unit(spin, given, name, value):
    """An axis, a table of cases and a setting replace what the input has of the angle."""
    start = FREE.replace("&initial\n", f"&initial psi_rate = 1 {given}\n") + NUTATION
    text = start + f"&sweep parameter(1) = 'initial.{name}', values(1,:) = {value} /\n"
    run = spin(text)
    again = spin(run.head, name="again")
    table = spin(start + "&sweep table = 'cases.csv' /\n", cases=f"initial.{name}\n{value}\n")
    mass = "&sweep parameter(1) = 'top.mass', values(1,:) = 1 /\n"
    override = spin(start + mass, f"initial.{name}={value}")
    for rows in (run.rows, again.rows, table.rows, override.rows):
        assert rows.theta_min[0] == pytest.approx(value if value < 1 else np.radians(value))
    twice = start.replace(given, "theta = 1  theta_deg = 2")
    assert "the angle is given twice" in spin.refuse(twice + mass)


TWO = "initial.theta,top.mass\n0.5,1\n"


@each(
    "text, parts",
    (None, ["scene.nml:", ":16: error: cannot read ", "cases.csv"]),
    ("", ["the table is empty"]),
    ("# nothing\n", ["the table is empty"]),
    ("initial.theta\n", ["cases.csv:1:1: error: the table has no rows"]),
    ("initial.thata\n1\n", ["cases.csv:1:1: ", "did you mean 'initial.theta'?"]),
    ("initial.theta,case\n1,1\n", ["cases.csv:1:15: ", "unknown parameter 'case'"]),
    ("initial.theta,\n1,1\n", ["cases.csv:1:15: ", "a column has no name"]),
    ("initial.theta,study.kind\n1,1\n", ["cases.csv:1:15: ", "is not a number"]),
    ("initial.theta,sweep.seed\n1,1\n", ["cases.csv:1:15: ", "cannot vary"]),
    ("initial.theta,sensor.offset(1)\n1,1\n", ["cases.csv:1:15: ", "cannot vary"]),
    ("initial.theta,initial.theta\n1,1\n", ["cases.csv:1:15: ", "on two axes"]),
    ("phi,top.inertia_tensor(1,2)\n1,1\n", ["cases.csv:1:5: ", "a comma parts the name"]),
    (TWO + "0.6\n", ["cases.csv:3:1: ", "the row ends before top.mass"]),
    (TWO + "0.6,1,2\n", ["cases.csv:3:7: ", "more cells than the table has columns"]),
    (TWO + "0.6,\n", ["cases.csv:3:5: ", "no value for top.mass"]),
    (TWO + "0.6,nan\n", ["cases.csv:3:5: ", "not a number"]),
    (TWO + "#\n\n0.6,  1x\n", ["cases.csv:5:7: ", "not a number: 1x"]),
    (TWO + "0.6,-1\n", ["cases.csv:3:5: ", "top.mass must be > 0"]),
    (TWO + '0.6,"1\n', ["cases.csv:3:5: ", "quotes must be around the whole cell"]),
    (TWO + '0.6,"1"2\n', ["cases.csv:3:5: ", "quotes must be around the whole cell"]),
    ("initial.theta\n\0\n", ["NUL"]),
    ("initial.theta,integration.steps\n1,1.5\n", ["cases.csv:2:3: ", "whole number"]),
    (TWO + "x,1\n0.5,-1\n", ["cases.csv:3:1: ", "cases.csv:4:5: ", "2 errors"]),
)
def test_bad_tables(spin, text, parts):
    error = spin.refuse(TABLE, **({"cases": text} if text is not None else {}))
    places = [error.index(part) for part in parts]
    assert places == sorted(places)


@each(
    "text, setting, part",
    (NORMAL, "sweep.mean=-10", "first 64 cases can be computed, the first because top.mass"),
    (NORMAL, "sweep.distribution(2)=uniform", "axis 2 has no values"),
    (NORMAL, "sweep.distribution(2)=spherical", "one of: uniform, normal, lognormal, sphere"),
    (NORMAL, "sweep.deviation=0", "deviation(1) is out of range"),
    (NORMAL, "sweep.cases=1e3", "a whole number is written 1000"),
    (NORMAL, "sweep.cases=9007199254740992", "is too large"),
    (NORMAL, "sweep.cases=2000000000000000", "must be in [1, 1e15]"),
    (NORMAL, "sweep.parameter(17)=top.mass", "parameter(16)"),
    (TABLE, "sweep.parameter(1)=top.mass", "the cases are given twice"),
    (TABLE, "sweep.combine=zip", "the rows of the table are the cases"),
    (TABLE, "sweep.cases=3", "the rows of the table are the cases"),
    (TABLE, "study.kind=trajectory", "a trajectory has no axes"),
)
def test_wrong_settings(spin, text, setting, part):
    assert part in spin.refuse(text, setting, cases="initial.theta\n0.5\n")


# Every number that a sweep may vary changes the motion, or is refused: no axis is ignored.

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
