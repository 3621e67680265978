"""Limits of the system: memory, stack, standard streams."""

import os
import platform
import re
import resource
import shutil

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
