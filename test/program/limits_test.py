"""Limits of the system: memory, stack, standard streams."""

import os
import platform
import re
import resource
import shutil
from pathlib import Path

import pytest

from conftest import CLOSED, EXE, GOOD, KIND, ROOT, each, execute, texts

STUDY = (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 40 /\n"
)
SWEEP = GOOD.split("&output")[0] + STUDY
LEAST_STACK = 448 * 1024  # that is accepted


def limited(kind, size):
    return lambda: resource.setrlimit(kind, (size, size))


def small(spin, *words, code=0, size=LEAST_STACK):
    """Run with small stacks, of the first thread and of the others; returns what was said."""
    options = {"environment": {"OMP_STACKSIZE": f"{size // 1024}k"}, "code": code}
    options["preexec_fn"] = limited(resource.RLIMIT_STACK, size)
    run = spin.call(*words, "--threads=2", **options)
    return run.out + run.stderr


NAMES = "slow_top slow_top_lagrange_cn2 slow_top_lagrange_ode45 slow_top_events"
NAMES += " damped_top rigid_body_chaotic separatrix spinning_wheel_sweep"
EVERYTHING = "--set=output.columns=all"
STABILITY = "&study kind = 'stability' /\n&stability cases = 'sleeping_above' /\n"
PRECISION = CLOSED + (
    "&study kind = 'work_precision' /\n"
    "&work_precision methods = 'rk4', 'taylor', steps = 100, tolerances = 1e-6, repeats = 1 /\n"
)


@each(
    "text, options",
    (SWEEP.replace("steps = 10", "steps = 100"), [EVERYTHING]),
    (CLOSED + STUDY, [EVERYTHING]),
    (CLOSED + STUDY, ["--set=span.stop_at=lower_turning_points", "--set=span.t_end=9"]),
    (STABILITY, []),
    (PRECISION, []),
    (PRECISION, ["--set=work_precision.reference=quadruple"]),
)
def test_every_kind_of_study(spin, text, options):
    """What costs most goes on the smallest accepted stack."""
    small(spin, spin.write(text), *options)


def test_inputs(spin):
    for names, *options in (
        (NAMES,),
        ("random_tops", "--set=sweep.cases=600"),
        ("damped_bodies", "--set=sweep.count=600"),
    ):
        small(spin, *(ROOT / f"input/{name}.nml" for name in names.split()), *options)


@each("topic", "methods", "columns", "parameters", "cases")
def test_lists(spin, topic):
    spin.call("list", topic, preexec_fn=limited(resource.RLIMIT_STACK, LEAST_STACK))


def test_too_small_a_stack_is_refused(spin):
    """Exit code 2 before anything is done, with what to do."""
    said = small(spin, spin.write(SWEEP), size=LEAST_STACK - 4096, code=2)
    assert "the stack limit is 444 kB" in said
    assert "ulimit -s" in said
    assert spin.produced() == set()


@each("name", "OMP_STACKSIZE", "GOMP_STACKSIZE")
@each("text, kilobytes", ("100k", 100), ("100", 100), (" 65536 b ", 64), ("0M", 0))
def test_too_small_stacks_of_threads(spin, name, text, kilobytes):
    error = spin(SWEEP, environment={name: text}, code=2).stderr
    assert f"a stack of {kilobytes} kB" in error
    assert "OMP_STACKSIZE" in error
    assert spin.produced() == set()


@each("text", "512K", "1 M", "2g", "nonsense")
def test_stacks_that_suffice(spin, text):
    spin(SWEEP, environment={"OMP_STACKSIZE": text})


@pytest.mark.skipif(KIND != "release", reason="frames of other builds")
@pytest.mark.skipif(platform.machine() != "x86_64", reason="instructions of another processor")
@pytest.mark.skipif(not shutil.which("objdump"), reason="there is no objdump")
def test_no_procedure_takes_much():
    """A third of the smallest stack at most, so that those that call each other fit into it."""
    code = execute("objdump", "--disassemble", "--no-show-raw-insn", EXE).stdout
    frames, name = {}, ""
    pattern = r"^[0-9a-f]+ <(?P<name>.*)>:$|\bsub +\$0x(?P<size>[0-9a-f]{1,8}),%rsp"
    for found in re.finditer(pattern, code, re.MULTILINE):
        if found["size"] is None:
            name = found["name"]
        else:
            frames[name] = max(frames.get(name, 0), int(found["size"], 16))
    assert len(frames) > 1000
    assert {name: size for name, size in frames.items() if size > LEAST_STACK / 3} == {}


def short(spin, text, *options, megabytes):
    """What is said of a run that does not get the memory that it needs: exit code 5."""
    limit = limited(resource.RLIMIT_AS, megabytes * 2**20)
    return spin.call(spin.write(text), *options, code=5, preexec_fn=limit).stderr


def test_too_many_rows(spin):
    text = GOOD.replace("method = 'rk4'", "method = 'ode45'").replace("steps = 10", "")
    said = short(spin, text, "--set=span.samples=2000000000", megabytes=1000)
    assert "not enough memory for the times of 2000000000 rows" in said
    assert "span.samples" in said
    assert spin.produced() == {"output"}


def test_too_many_threads(spin):
    assert "there is no more memory" in short(spin, SWEEP, "--threads=500", megabytes=200)
    assert "output/scene.csv" not in spin.produced()


def redirected(spin, redirection, *words, code):
    """What standard error says of a call from a shell with a redirection."""
    shell = ("bash", "-c", f'exec "$@" {redirection}', "bash", EXE)
    return spin.call(*words, command=shell, code=code, timeout=60).stderr


@each(
    "redirection, reason", (">/dev/full", "No space left on device"), (">&-", "Bad file descriptor")
)
def test_output_that_takes_nothing(spin, redirection, reason):
    """Exit code 4 and a message, for every command; the tables are complete."""
    scene, sweep = spin.write(GOOD), spin.write(SWEEP, "sweep.nml")
    merged = ["merge", "output/merged.csv", *spin.parts(sweep, 2)]
    others = [["--help"], ["--version"], ["list", "columns"], ["--check", scene], [scene], [sweep]]
    for words in (*others, merged):
        said = redirected(spin, redirection, *words, code=4)
        assert said == f"cannot write to standard output: {reason}\n"
    output = spin.folder / "output"
    assert "\n# status: ok\n" in (output / "scene.csv").read_text()
    swept = texts(output / "sweep.csv")
    assert len(swept) == 40
    assert texts(output / "merged.csv").equals(swept)


def test_other_inputs_run_all_the_same(spin):
    redirected(spin, ">/dev/full", spin.write(GOOD), spin.write(GOOD, "two.nml"), code=4)
    one, two = (texts(spin.folder / f"output/{name}.csv") for name in ("scene", "two"))
    assert one.equals(two)


@each(
    "redirection, code",
    ("<&-", 0),
    ("2>&-", 0),
    (">&- 2>&-", 4),
    ("<&- >&- 2>&-", 4),
    ("2>/dev/full", 0),
)
def test_closed_streams_do_not_leak_into_files(spin, redirection, code):
    """A file does not get the number of a closed stream, and with it what is said there.

    A full standard error changes neither the table nor the exit code.
    """
    expected = spin(SWEEP, "--output=open").path.read_bytes()
    redirected(spin, redirection, "scene.nml", "--progress", code=code)
    assert (spin.folder / "output/scene.csv").read_bytes() == expected


def test_errors_that_nobody_reads(spin):
    redirected(spin, "2>/dev/full", "--bad", code=2)


def test_a_reader_that_has_gone():
    """SIGPIPE, as of any program: 128 and its number in a shell."""
    done = execute("bash", "-c", '("$0" list columns; echo $? >&2) | true', EXE)
    assert done.stderr in ("141\n", "0\n")


@each("text", GOOD, SWEEP)
def test_a_folder_under_the_name_of_the_table(spin, text):
    (spin.folder / "output/scene.csv").mkdir(parents=True)
    assert "output/scene.csv: it is a folder" in spin(text, code=4).stderr
    assert "output/scene.csv.part" not in spin.produced()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written(spin):
    (spin.folder / "output").mkdir(mode=0o500)
    spin(GOOD, code=4)


# One budget, `max_steps`, for all work of a case.

STOPPED = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 11.25, psi_rate = 1.0 /
&span t_end = 20, samples = 11, stop_at = 'lower_turning_points', stop_after = 3 /
&integration method = 'dop853', formulation = 'space_frame', relative_tolerance = 1e-13 /
&output columns = 't', 'theta' /
"""


def test_a_motion_computed_again(spin):
    """The rows of a motion that ended at an event come from a second computation: it counts too."""
    said = spin(STOPPED, "--verbose").out
    steps, rejected = re.search(r"(\d+) steps, (\d+) rejected", said).groups()
    # Those of both computations; the looks for events in the first are fewer than half of them.
    both = int(steps) + int(rejected)
    run = spin(STOPPED, f"integration.max_steps={both}", code=3)
    assert "step_limit at t = " in run.out
    spin(STOPPED, f"integration.max_steps={both * 8}")


# The environment of the run-time library of gfortran changes nothing that the program writes.

SWEPT = GOOD.split("&output")[0] + (
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


VARIABLES = variables()
SETTINGS = [{name: value} for name in VARIABLES for value in ("y", "6")]
SETTINGS += [dict.fromkeys(VARIABLES, "y"), dict.fromkeys(VARIABLES, "1")]


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
    spin.write(SWEPT, "sweep.nml")
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
