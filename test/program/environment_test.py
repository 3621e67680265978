"""The environment of the run-time library of gfortran changes nothing that the program writes."""

import re
from pathlib import Path

import pytest

from conftest import GOOD, each, execute

SWEEP = GOOD.split("&output")[0] + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 9 /\n"
)
MEASURED = re.compile(
    r"^(!? +(cost|time|ended|parts|memory|columns +with) |# date:).*\n", re.MULTILINE
)
"""Lines of a summary and of a header that differ from run to run."""
DOCUMENTED = (
    "UNBUFFERED_ALL UNBUFFERED_PRECONNECTED SHOW_LOCUS OPTIONAL_PLUS LIST_SEPARATOR CONVERT_UNIT"
    " ERROR_BACKTRACE FORMATTED_BUFFER_SIZE UNFORMATTED_BUFFER_SIZE"
)
"""The variables of gfortran's manual, without their prefix, but for numbers of standard streams.

Where two of these have the same number the library of gfortran ends the program itself.
"""
CALLS = {
    "trajectory": ("motion.nml",),
    "sweep": ("sweep.nml",),
    "check": ("sweep.nml", "--check"),
    "list": ("list", "methods", "--json"),
    "refusal": ("sweep.nml", "--set", "top.mass=-1"),
}


def variables():
    """The documented variables, and what else looks like one in the library of this compiler."""
    names = {f"GFORTRAN_{name}" for name in DOCUMENTED.split()}
    library = Path(execute("gfortran", "-print-file-name=libgfortran.so").stdout.strip())
    if library.is_file():  # there may be a static one alone
        found = re.findall(rb"\0(GFORTRAN_[A-Z_]+)(?=\0)", library.read_bytes())
        names |= {name.decode() for name in found if not name.endswith(b"_UNIT")}
    return sorted(names)


NAMES = variables()
SETTINGS = [{name: value} for name in NAMES for value in ("y", "6")]
SETTINGS += [dict.fromkeys(NAMES, "y"), dict.fromkeys(NAMES, "1")]


def outputs(spin, environment):
    """What the program writes with these variables: codes, streams and tables."""
    found = {}
    for call, words in CALLS.items():
        run = spin.call(*words, code=tuple(range(-20, 256)), environment=environment)
        found[call] = run.code, MEASURED.sub("", run.out + run.stderr)
    for path in sorted((spin.folder / "output").glob("*.csv")):
        found[path.name] = MEASURED.sub("", path.read_text(encoding="utf-8"))
        path.unlink()
    return found


@each("setting", *SETTINGS, ids=lambda one: " ".join(map("=".join, one.items())))
def test_variables_of_the_library(spin, setting):
    spin.write(GOOD, "motion.nml")
    spin.write(SWEEP, "sweep.nml")
    expected = outputs(spin, {})
    assert [expected[call][0] for call in CALLS] == [0, 0, 0, 0, 2]
    assert {"motion.csv", "sweep.csv"} < set(expected)
    assert outputs(spin, setting) == expected


# Tests of SPINTOP_LEVEL: the levels of the processor agree, and one level has one result.

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
ONE = "&study kind = 'trajectory' /\n&output columns = 't', 'q0', 'q1', 'q2', 'q3' /\n"
INPUTS = {
    "one": ONE,
    "affected": ONE + EFFECTS,
    "stages": ONE + EFFECTS + "&integration method = 'dop853'  relative_tolerance = 1e-12 /\n",
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


@each("name", *INPUTS)
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


@each("level", "v9", "V3", "native", " ", "v2 .")
def test_other_words(spin, level):
    run = spin(INPUTS["one"] + BODY, environment={"SPINTOP_LEVEL": level}, code=2)
    told = f"SPINTOP_LEVEL is '{level}', but the levels of this processor are: "
    assert told in run.stderr
    assert not run.path.exists()
