"""Messages about invalid values and foreign names, the first row, and counted evaluations."""

import re

import pytest

from conftest import CLOSED, GOOD, ROOT, each, output
from proof_test import HAS_FLINT, MISSING

SWEEP = GOOD[: GOOD.index("&output")].replace("&top", "&study kind = 'sweep' /\n&top")
DAMPED = GOOD.replace("&top", "&top damping = 0.1, 0.1, 0.1").replace("'lagrange'", "'auto'")
AXIS = "&sweep parameter(1) = '{}', values(1,:) = {} /\n"


def hint(spin, text, *settings):
    return " ".join(spin.refuse(text, *settings).split())


CHARACTERS = ("\n", "\r", "\t", "\x0b", "\x0c", "\x1b", "\x1c", "\x7f", "\x85", "\u2028", "\u2029")


@each("key", "study.title", "output.file", "sweep.table", "span.stop_at")
def test_control_characters(spin, key):
    """Anything that would end a line of the table for some reader is refused, in every text."""
    for character in CHARACTERS:
        for text in ("a{}b", "'a{}b'", "{}b", "a{}"):
            spin.refuse(GOOD, f"{key}={text.format(character)}")


def test_control_characters_of_a_file(spin):
    for character in CHARACTERS[:-1]:
        spin.refuse(f"{GOOD}&study title = 'a{character}b' /\n")
    title = "Kreisel \u00e4\u00df \u03b8"
    assert title in "\n".join(spin(GOOD, f"study.title={title}").comments)


DEGREES = "is in rad/s: 1 rad/s = 57.29577951308232 deg/s"
UNITS, OF_RATES = "units are rad, mrad, deg", "units are rad/s, mrad/s, deg/s"
QUOTES = "a number with its unit is in quotes, as '20 deg'"


DRAWN = "&sweep parameter(1) = 'initial.phi_rate' combine = 'random' cases = 9 distribution(1) ="
DRAWN += " 'lognormal' deviation(1) = 0.1 mean(1) = '1 rpm' /"
DRAGGED = "&effects drag_moment = 0, 0, 0.1 drag_exponent = 2 /\n"
TILTED = GOOD.replace("theta = 0.19634954084936207", "quaternion = 1, 0, 0.1, 0")
TILTED = TILTED.replace("psi_rate = 1.0", "omega = 0, 0, 1").replace("'lagrange'", "'auto'")
OMEGA3 = "&sweep parameter(1) = 'initial.omega3', from(1) = 1, to(1) = 2, count(1) = 2 /"
HINTS = {
    GOOD: [
        # Degrees where radians belong, and other units.
        ("initial.theta=20", "theta is out of range", "in [0, pi] rad; theta_deg takes degrees"),
        ("initial.phi_rate_deg=3", f"'phi_rate' {DEGREES}"),
        ("initial.omega3_rpm=3", "'omega3' is in rad/s: 1 rad/s = 9.549296585513721 rpm"),
        ("output.columns=t,theta_rpm", "'theta_rpm': rpm is no unit of a quantity in rad"),
        ("output.columns=t,theta_rpm", "theta is in rad", "a suffix: _rad, _mrad, _deg, _mdeg"),
        ("output.columns=t,tetha", "there is no column 'tetha'", "did you mean 'theta'?"),
        ("&sweepsweep count(1) = 2 /", "unknown group &sweepsweep", "did you mean '&sweep'?"),
        ("output.columns=t,theta_degr", "there is no column 'theta_degr'"),
        ("output.columns=t,q0_deg", "a number without a unit is wanted"),
        ("output.columns=t,theta_deg,theta_deg", "column 'theta_deg' is named twice"),
        ("initial.theta=20 rpm", "rpm is no unit of a quantity in rad", UNITS),
        ("top.mass=25,5 g", "not a number: 25,5 g", "decimals follow a point"),
        ("initial.theta=20 dge", "'dge' is not a unit; did you mean 'deg'?", UNITS),
        ("initial.theta=20 kg m^2/s", "kg m^2/s is no unit of a quantity in rad", UNITS),
        # Keys and columns that are elsewhere, or need something.
        ("span.rtol=1e-9", "did you mean 'relative_tolerance' in group &integration?"),
        ("output.columns=t,lyapunov_exponent", "'lyapunov_exponent': sweeps and stability studies"),
        (
            *("output.columns=t,time_s", "a trajectory has no column 'time_s': stability studies,"),
            "work-precision studies and studies of benchmarks have it",
        ),
        ("study.kind=stability; stability.methods=rk4,exact", "is not among the compared methods"),
    ],
    CLOSED: [
        ("output.columns=work_friction", "'work_friction' needs effects, which this body"),
        ("study.kind=work_precision; work_precision.reference=quadrupel", "mean 'quadruple'?"),
    ],
    SWEEP: [
        (AXIS.format("initial.omega3_deg", 1), "the spin is given twice"),
        (AXIS.format("initial.theta", "1, 20"), "theta_deg takes degrees"),
        # The unit of an axis is that of its parameter.
        (
            *("&sweep from(1) = '1 rpm', to(1) = 2, count(1) = 2 /", "from(1) has a unit, but"),
            "sweep.parameter(1) is not given",
        ),
        ("sweep.from=0,5; sweep.parameter(1)=top.mass", "axis 2 has no", "decimals follow a point"),
        (DRAWN, "the logarithm of initial.phi_rate: a number without a unit"),
        (DRAGGED + AXIS.format("effects.drag_exponent", "1, 4"), "drag_exponent must be in [1, 3]"),
        (
            AXIS.format("initial.theta", 1) + "; output.columns=theta_min,gamma1",
            "a sweep has no column 'gamma1': trajectories have it",
        ),
    ],
    SWEEP.replace("psi_rate", "phi_rate") + OMEGA3: [
        ("sweep.from(1)='3 deg'", "omega3: deg is no unit of a quantity in rad/s", OF_RATES),
        ("sweep.from(1)=3 m", "omega3: m is no unit of a quantity in rad/s", OF_RATES),
        ("sweep.to(1)=3 rpn", "initial.omega3: 'rpn' is not a unit", OF_RATES),
        (
            *(
                "sweep.parameter(1)=initial.omega3_rpm; sweep.from(1)=3 g",
                "quantity in rpm",
                OF_RATES,
            ),
            "rpm, rps",
        ),
    ],
    GOOD.replace("psi_rate", "psi_rate_deg"): [("", f"'psi_rate' {DEGREES}")],
    GOOD.replace("psi_rate = 1.0", "psi_rate = 2 rpm"): [("", QUOTES)],
    GOOD.replace("psi_rate = 1.0", "psi_rate = 2rpm"): [("", QUOTES)],
    GOOD.replace("mass = 1.0", "mass = 25,5"): [
        ("", "too many values for mass", "it takes one value; decimals follow a point")
    ],
    GOOD[GOOD.index("&initial") :]
    + 2 * "&part shape = 'point_mass' mass = 1 place = 0, 0, 1 /\n": [
        ("part.mass=22,4", "too many values for mass", "decimals follow a point", "mass(2:3)")
    ],
    GOOD.replace("mass = 1.0", "mass = '25,5 g'"): [
        ("", "a comma in the number '25,5 g'", "decimals follow a point")
    ],
    # The length of a quaternion is named.
    TILTED: [("", "norm of the quaternion is 1.004987562112089, not 1")],
}
"""Inputs, each with settings and groups that are wrong, and what is said."""


@each("text, case", *[(text, case) for text, cases in HINTS.items() for case in cases])
def test_hints(spin, text, case):
    wrong, *words = case
    parts = wrong.split("; ") if wrong else []
    text += "".join(part for part in parts if "&" in part)
    said = hint(spin, text, *(part for part in parts if "&" not in part))
    for word in words:
        assert word in said


BLANK, MINUS = "\u00a0", "\u2212"


@each(
    "old, new, character, wanted",
    ("mass = 1.0", "mass: 1.0", ":", "a key is followed by ="),
    ("mass = 1.0", "mass = 1.0 # kg, don't", "#", "a comment starts with !"),
    ("mass = 1.0", "! [#;]\nmass = 1.0; title", ";", "values are separated by commas"),
    ("inertia =", "inertia[1] =", "[", "a subscript is in parentheses"),
    ("'rk4'", "\u2018rk4\u2019", "\u2018", "a text is in straight quotes"),
    ("'t', ", "\u201ct\u201d, ", "\u201c", "a text is in straight quotes"),
    ("mass = 1.0", f"mass{BLANK}= 1.0", BLANK, "write an ordinary blank"),
    ("0.25\n", f"0.25{BLANK}", BLANK, "write an ordinary blank"),
    ("= 0.5", f"= {MINUS}0.5", MINUS, "a minus sign is -"),
)
def test_foreign_characters(spin, old, new, character, wanted):
    """A character without a meaning is named at its place, alone, with what to write."""
    text = GOOD.replace(old, new, 1)
    first = new.index(character, new.rfind("\n") + 1)
    before = text[: text.index(new) + first]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    said = spin.refuse(text)
    assert f":{line}:{column}: error: unexpected " in said
    assert wanted in said
    assert re.search(r"\b1 error\n", said)


def test_characters_of_texts(spin):
    assert "title = 'a / b &c'" in spin(GOOD, "--check", "study.title=a / b &c").out
    spin(f"! [#;] {MINUS}\n&study title = '[a]; #1: \u201cb\u201d' /\n{GOOD}")


@each(
    "setting, more",
    ("effects.earth_rate=1 rev/day", "effects.latitude=0.7"),
    ("effects.vibration_rate=50 Hz", "effects.vibration_amplitude=0,0,0.01"),
    ("top.length=0.3 yards", "initial.spin_ratio=2"),
    ("top.inertia=1,1,x", "integration.method=exact"),
    ("top.damping=1,1,one", "output.columns=work_damping"),
    ("study.kind=swep", "output.columns=theta_max"),
)
def test_errors_that_follow(spin, setting, more):
    """What cannot be read is reported, and nothing that would follow from it."""
    said = hint(spin, CLOSED.replace("psi_rate = 1.0", ""), setting, more)
    assert re.search(r"\b1 error$", said)


def test_names_of_other_programs(spin):
    """Each other name leads to a key that exists, in its group or in another one."""
    source = (ROOT / "src/scenes/scene_keys.f90").read_text(encoding="utf-8")
    names = re.findall(r"'([a-z]\w*)=(\w+)\.(\w+)'", source)
    assert len(names) > 40
    said = hint(spin, GOOD, *(f"{group}.{other}=1" for other, group, _ in names))
    known = {entry["name"] for entry in spin.listed("parameters")}
    for other, group, key in names:
        assert f"unknown key '{other}' in group &{group}" in said
        assert f"did you mean '{key}'?" in said
        assert f"{group}.{key}" in known


@each(
    "name, own",
    ("rk45", "ode45"),
    ("RK45", "ode45"),
    ("dopri5", "ode45"),
    ("verlet", "splitting_2"),
    ("implicit_midpoint", "crank_nicolson_2"),
    ("rk44", "rk4"),
)
def test_names_that_others_use(spin, name, own):
    assert f"did you mean '{own}'?" in hint(spin, GOOD, f"integration.method={name}")
    study = "study.kind=work_precision", "integration.method=auto"
    said = hint(spin, CLOSED, *study, f"work_precision.methods=rk4,{name}")
    assert f"did you mean '{own}'?" in said


def test_an_unknown_effect(spin):
    error = spin.refuse(CLOSED + "&effects no_friction = 1 /\n", "output.columns=work_friction")
    assert "unknown key 'no_friction'" in error
    assert "work_friction" not in error


@each(
    "settings, element",
    (["top.inertia=0.5,0.5,2.5"], "2.5"),
    (["top.inertia=0.5,-1,0.5"], "-1"),
    (["output.columns=t,theta,thetta"], "thetta"),
    (["output.columns=t,theta,t"], ",t"),
    (["output.events=maximum theta,nonsense"], "nonsense"),
    (["study.kind=stability", "stability.cases=thousand_nutations,nonsense"], "nonsense"),
    (["study.kind=stability", "stability.methods=rk4,ode45,nonsense"], "nonsense"),
    (["study.kind=stability", "stability.methods=rk4,ode45/nonsense"], "ode45/nonsense"),
    # No part of an override is ignored: a slash, a group, another key are refused.
    *((["top.length=1" + rest], rest) for rest in (" / &x", "/", " &span", " mass=2")),
    (["top.inertia=1,1,1 / 3"], " / 3"),
    (["study.title='a' / b"], " / b"),
    (["output.columns='t' / 'theta'"], " / 'theta'"),
)
def test_carets_point_at_elements(spin, settings, element):
    column = settings[-1].rindex(element) + 1 + element.startswith((",", " "))
    said = "unexpected text after the value" if element[0] in " /" else ""
    assert f"--set:1:{column}: error: {said}" in spin.refuse(GOOD, *settings)


def test_a_caret_in_a_file(spin):
    text = SWEEP + "&sweep parameter(1) = 'top.mass'\nvalues(1,:) = 1, 2, -3, 4 /\n"
    line = text[: text.index("values(1")].count("\n") + 1
    assert f"scene.nml:{line}:21: error: top.mass must be > 0" in spin.refuse(text)


@each("key", "relative_tolerance", "absolute_tolerance")
def test_a_tolerance_that_is_not_used(spin, key):
    """The motion is known in closed form: it is said, and computed all the same."""
    assert f"warning: integration.{key} is not used" in spin(CLOSED, f"integration.{key}=1e-3").err
    said = spin(CLOSED, "--check", f"integration.{key}=1e-3").out
    assert f"integration.{key} is not used." in " ".join(said.replace("\n! ", " ").split())
    assert spin(CLOSED).stderr == ""
    adaptive = GOOD.replace("    steps = 10\n", "")
    assert "not used" not in spin(adaptive, "integration.method=ode45").stderr


@each("lengths, warned", ("0.1, 0.2, 3, 4", 3), ("3, 0.1, 4", None), ("0.1, 0.2", 0))
def test_every_case_of_a_sweep_is_looked_at(spin, lengths, warned):
    """An inertia that no body has is told of once; in a case that is not the first, with it."""
    error = spin(SWEEP + AXIS.format("top.length", lengths)).stderr
    assert error.count("no mass distribution has this inertia") == (warned != 0)
    if warned:
        assert f"warning: case {warned}: no mass distribution has this inertia" in error
    assert "case 1" not in error
    assert warned != 0 or error == ""


def test_what_damping_changes_is_not_constant(spin):
    said = spin(DAMPED, "--check").out
    assert "constants" not in said
    assert re.search(r"start +Lz = .* J s, E = .* J; the damping changes both", said)
    assert "constants c1 = Lz" in spin(GOOD, "--check").out


HEAD = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&span t_end = 0.1 samples = 2 /
"""
Q = ["q0", "q1", "q2", "q3"]
HEAD += output(
    *("t", "phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate"),
    *("omega1", "omega2", "omega3", *Q, "energy_error", "R3", "R4"),
)


@each(
    "way",
    {"phi": 0.1, "theta": 0.3, "psi": -0.7, "phi_rate": 0, "theta_rate": 0, "psi_rate": 1.1},
    {"phi": 0, "theta": 1.7, "psi": 0, "phi_rate": 0.9, "theta_rate": -0.3, "omega3": 4.7},
    {"theta": 2.9, "phi_rate": 1.3, "theta_rate": 0.1, "omega3": -0.7},
    {"phi": 1, "theta": 1.1, "psi": 2, "omega": [0.1, 0.2, 0.7]},
    {"quaternion": [0.5, -0.5, 0.5, 0.5], "omega": [0.3, 0, 0.7]},
    {"quaternion": [-0.48, 0.64, 0.36, 0.48], "omega": [0.3, 0.1, -7]},
    ids=" ".join,
)
@each("form", "auto", "euler", "lagrange", "lagrange_energy", "rigid_body", "space_frame")
def test_every_way_to_give_a_start(spin, form, way):
    """The first row is the start as it was given: each number to its last digit."""
    start = ", ".join(f"{key} = {str(value).strip('[]')}" for key, value in way.items())
    numbers = {key: value for key, value in way.items() if not isinstance(value, list)}
    numbers |= {f"q{i}": value for i, value in enumerate(way.get("quaternion", []))}
    numbers |= {f"omega{i}": value for i, value in enumerate(way.get("omega", []), 1)}
    settings = [f"integration.formulation={form}", "integration.method=rk4", "integration.steps=8"]
    run = spin(f"{HEAD}&initial {start} /\n", *settings * (form != "auto"))
    row = run.texts.iloc[0]
    for name, number in numbers.items():
        assert float(row[name]) == number, name
    assert [float(row[name]) for name in ("t", "energy_error", "R3", "R4")] == [0] * 4
    assert "-0" not in list(row)


@each("sign", -1, 1)
@each("method", "exact", "taylor")
def test_the_next_row_is_close(spin, sign, method):
    """No angle and no sign of the quaternion jumps after the start."""
    quaternion = ", ".join(str(sign * x) for x in (0.48, -0.64, -0.36, -0.48))
    text = f"{HEAD}&initial quaternion = {quaternion}, omega = 0.3, 0.1, -2 /\n"
    rows = spin(text, f"integration.method={method}", "span.t_end=1e-3").rows
    first, second = rows[["phi", "theta", "psi", *Q]].to_numpy()
    assert second == pytest.approx(first, abs=0.01)


def test_evaluations_do_not_count_comparisons(spin):
    """The interval between error checks of a work-precision study has no influence on them."""
    text = CLOSED.replace("&top", "&study kind = 'work_precision' /\n&top")
    text += "&work_precision methods = 'dop853', 'ode45', 'arkode_erk', 'taylor', 'gauss_4'\n"
    text += "tolerances = 1e-9, steps = 200, repeats = 1 /\n"
    runs = (spin(text, f"span.samples={samples}").texts for samples in (2, 101))
    few, many = (dict(zip(run.method, run.evaluations, strict=True)) for run in runs)
    assert few == many


@pytest.mark.skipif(HAS_FLINT, reason="this build has FLINT")
def test_a_build_without_flint(spin):
    """A build without FLINT names what is missing, and computes everything else."""
    error = spin.refuse(CLOSED, "--check", "output.columns=t,theta,theta_bound")
    assert f"column 'theta_bound': {MISSING}" in error
    assert "SPINTOP_FLINT=1 scripts/setup" in error
    assert MISSING in spin.refuse(CLOSED, "--check", "output.certified=.true.")
    spin(CLOSED)
    assert MISSING in spin.call("verify", "output/scene.csv", code=2).stderr
