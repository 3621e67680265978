"""Names of files with characters that a terminal obeys: shown on one line, escaped."""

import pytest

from conftest import CLOSED, GOOD

NAME = "a\nb\tc\x1b[31m.nml"
SHOWN = "a\\nb\\tc\\x1b[31m"
MOTION = GOOD.split("&output")[0]
SWEEP = MOTION + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 3 /\n"
)


def check(said):
    """The message contains the printable form of the name, and no control characters."""
    assert SHOWN in said
    assert "\x1b" not in said
    assert not any(line.startswith(("b ", "b\t", "b?")) for line in said.splitlines())


@pytest.mark.parametrize("text", [GOOD, SWEEP])
@pytest.mark.parametrize("options", [[], ["--check"], ["--progress"]])
def test_every_kind_of_study(spin, text, options):
    """Summaries, the explanation of --check, which is an input, and progress."""
    run = spin.call(spin.write(text, NAME), *options)
    check(run.out)
    if run.stderr:
        check(run.stderr)
    if options == ["--check"]:
        spin(run.out, "--check")


def test_messages(spin):
    """Errors in a file, and two files of one table."""
    check(spin.call(spin.write(GOOD.replace("mass", "maas"), NAME), code=2).stderr)
    scene = spin.write(GOOD, NAME)
    check(spin.call(scene, scene, code=2).stderr)


STUDY = "&study kind = '{}' /\n"
CASES = MOTION + STUDY.format("sweep") + "&sweep table = 'scene.csv' /\n"
PRECISION = CLOSED + STUDY.format("work_precision")
PRECISION += "&work_precision reference = 'scene.csv', methods = 'rk4', steps = 100 /\n"
FIT = CLOSED + STUDY.format("fit") + "&fit data = 'scene.csv', unknown = 'initial.psi_rate' /\n"
ANGLES = "t,phi,theta,psi\n0,0,0.2,0\n0.1,0,0.2,0.1\n0.2,0,0.2,0.2\n"


@pytest.mark.parametrize(
    ("text", "table"),
    [
        (CLOSED + "&effects torque_table = 'scene.csv' /\n", "t,m1,m2,m3\n0,0,0,0\n1,0,0,0\n"),
        (CASES, "initial.psi_rate\n1\n2\n"),
        (CASES + "&output file = 'scene.csv' /\n", "initial.psi_rate\n1\n2\n"),
        (PRECISION, ""),
        (FIT, ANGLES),
    ],
)
def test_what_is_read_is_not_replaced(spin, text, table):
    """By no table: cases, torques, measurements, a reference."""
    if not table:
        columns = "output.columns=t,q0,q1,q2,q3,omega1,omega2,omega3"
        table = spin(MOTION, columns).path.read_text()
    error = spin.refuse(text, "--output=.", scene=table)
    assert "its table ./scene.csv would replace the file that is read as" in error
    assert (spin.folder / "scene.csv").read_text() == table


@pytest.mark.parametrize("name", ["scene.csv", "scene.log"])
def test_inputs_are_not_replaced(spin, name):
    """An input, whatever its name, by its table or its log."""
    scene = spin.folder / spin.write(SWEEP, name)
    assert "would replace" in spin.refuse(scene, "--output=.")


def test_other_inputs_are_not_replaced(spin):
    """One input by the table of another."""
    names = spin.write(GOOD, "other.nml"), spin.write(GOOD, "other.csv")
    spin.call(*names, "--set=output.file=x", "--output=.", code=2)
    assert (spin.folder / "other.csv").read_text() == GOOD


@pytest.mark.parametrize(
    ("name", "file"), [("spin_1.5", "spin_1.5.csv"), ("a.csv", "a.csv"), ("b.v2.csv", "b.v2.csv")]
)
def test_points_in_the_name_of_a_table(spin, name, file):
    """Only the ending of its format is one."""
    spin(MOTION, f"output.file={name}")
    assert (spin.folder / "output" / file).exists()
