"""Tests of what a terminal shows: widths, colours, the plan of --check, the topics of list."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios

import pytest

from conftest import CLOSED, EXE, GOOD, ROOT, Spin, each

COLUMNS = 60
ESCAPE = "\x1b["
SLOW_TOP = ROOT / "input/slow_top.nml"


def show(spin, *words, columns=COLUMNS, **environment):
    try:
        ours, its = pty.openpty()
    except OSError as error:
        pytest.skip(f"no terminal can be opened: {error}")
    fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    known = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
    given = {"cwd": spin.folder, "env": known | {"TERM": "xterm"} | environment}
    process = subprocess.Popen([EXE, *words], stdout=its, stderr=its, **given)
    os.close(its)
    shown = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    os.close(ours)
    process.wait()
    return shown.decode().replace("\r\n", "\n")


def widest(lines):
    return max(map(len, lines))


def test_plan_comes_last(spin):
    """After the input, as comments, as wide as the terminal; together they can be run."""
    shown = show(spin, "--check", SLOW_TOP)
    lines = shown.splitlines()
    comments = [line for line in lines if line.startswith("!")]
    assert lines[-len(comments) :] == comments
    assert lines[0] == "&study"
    assert len(comments) > 12
    assert widest(line for line in comments if " " in line.strip("! ")) <= COLUMNS
    assert "!   fast top  (I3 omega3)^2/(2 I1 m g l) = 0.0042038027\n!             (much" in shown
    spin(shown, "--check")
    wide = spin.call("--check", SLOW_TOP).out.splitlines()
    assert next(line for line in wide if line.startswith("!   fast")).endswith("0.0073566548)")


def test_groups_that_matter(spin):
    """Those of the study, given or not, and those that the input gives."""

    def groups(name, *settings):
        return re.findall(r"^&(\w+)", spin(name, "--check", *settings).out, re.MULTILINE)

    case = ["study", "top", "initial", "span", "integration", "output"]
    assert groups("slow_top") == case
    assert groups("spinning_wheel_sweep") == [*case, "sweep"]
    assert "sweep" not in groups("work_precision_slow_top")
    assert "sweep" in groups("slow_top", "sweep.seed=3")
    assert "initial" not in groups("stability")


def test_colours(spin):
    """Errors and marks have colours on a terminal, unless NO_COLOR is set or it is dumb."""
    wrong = spin.write("&study kind = 'trajectoryy' /\n")
    shown = show(spin, wrong)
    assert f": {ESCAPE}1;31merror:{ESCAPE}0m " in shown
    assert f"{ESCAPE}1;32m^" in shown
    plain = re.sub(r"\x1b\[[0-9;]*m", "", shown)
    assert show(spin, wrong, NO_COLOR="1") == plain
    assert show(spin, wrong, TERM="dumb") == plain
    assert ESCAPE not in spin.call(wrong, code=2).stderr


def test_summary(spin):
    shown = show(spin, "--quiet", SLOW_TOP, "--set", "span.samples=11")
    assert widest(line for line in shown.splitlines() if line.startswith("  ")) <= COLUMNS
    assert "status    ok at t" in shown


@each("width", 100, COLUMNS)
def test_progress(spin, width):
    """A bar that is overwritten, in a line that has room."""
    settings = ["sweep.count(1)=60", "sweep.count(2)=50", "integration.method=rk4"]
    settings += ["integration.steps=2000", "output.columns=theta_max,orientation_error,evaluations"]
    options = [f"--set={setting}" for setting in settings]
    scene = ROOT / "input/map_spin_tilt.nml"
    shown = show(spin, scene, *options, "--threads", "1", columns=width)
    lines = [line for line in shown.split("\r") if line.startswith("map_spin_tilt:")]
    assert lines
    bar = r"\[#*\.*\] " if width > COLUMNS else ""
    for line in lines:
        assert re.search(rf"map_spin_tilt: {bar}\d+ %, \d+ of 3000 ca", line)
        assert len(line.partition(ESCAPE)[0]) < width


@each("columns", 50, 72, 120)
def test_width_of_messages(spin, columns):
    """Words are wrapped; the line with the place stays one, for tools."""
    wide = spin.refuse(GOOD.replace("mass", "masss").replace("'rk4'", "'nonsensical'"))
    shown = show(spin, "scene.nml", columns=columns, NO_COLOR="1")
    for text, width in ((shown, columns), (wide, 100)):
        lines = text.strip("\n").split("\n")
        places = [line for line in lines if line.startswith("scene.nml")]
        assert len(places) == wide.count("error: ")
        assert widest(line for line in lines if not line.startswith("scene.nml")) <= width
    assert "".join(shown.split()) == "".join(wide.split())


@each("topic", "", "columns", "methods", "parameters", "events")
def test_width_of_lists(spin, topic):
    """Lists are wrapped on a terminal, and have the same words for other programs."""
    shown = show(spin, "list", *topic.split(), NO_COLOR="1")
    assert "".join(shown.split()) == "".join(spin.call("list", *topic.split()).out.split())
    assert widest(shown.splitlines()) <= COLUMNS


# Names of files with characters that a terminal obeys: shown on one line, escaped.

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


@each("text", GOOD, SWEEP)
@each("options", [], ["--check"], ["--progress"])
def test_every_kind_of_study(spin, text, options):
    run = spin.call(spin.write(text, NAME), *options)
    check(run.out)
    if run.stderr:
        check(run.stderr)
    if options == ["--check"]:
        spin(run.out, "--check")


def test_messages(spin):
    check(spin.call(spin.write(GOOD.replace("mass", "maas"), NAME), code=2).stderr)
    scene = spin.write(GOOD, NAME)
    check(spin.call(scene, scene, code=2).stderr)


STUDY = "&study kind = '{}' /\n"
CASES = MOTION + STUDY.format("sweep") + "&sweep table = 'scene.csv' /\n"
PRECISION = CLOSED + STUDY.format("work_precision")
PRECISION += "&work_precision reference = 'scene.csv', methods = 'rk4', steps = 100 /\n"
FIT = CLOSED + STUDY.format("fit") + "&fit data = 'scene.csv', unknown = 'initial.psi_rate' /\n"
ANGLES = "t,phi,theta,psi\n0,0,0.2,0\n0.1,0,0.2,0.1\n0.2,0,0.2,0.2\n"


@each(
    "text, table",
    (CLOSED + "&effects torque_table = 'scene.csv' /\n", "t,m1,m2,m3\n0,0,0,0\n1,0,0,0\n"),
    (CASES, "initial.psi_rate\n1\n2\n"),
    (CASES + "&output file = 'scene.csv' /\n", "initial.psi_rate\n1\n2\n"),
    (PRECISION, ""),
    (FIT, ANGLES),
)
def test_what_is_read_is_not_replaced(spin, text, table):
    """By no table: cases, torques, measurements, a reference."""
    if not table:
        columns = "output.columns=t,q0,q1,q2,q3,omega1,omega2,omega3"
        table = spin(MOTION, columns).path.read_text()
    error = spin.refuse(text, "--output=.", scene=table)
    assert "its table ./scene.csv would replace the file that is read as" in error
    assert (spin.folder / "scene.csv").read_text() == table


def test_inputs_are_not_replaced(spin):
    """An input by its log, one by the table of another."""
    scene = spin.folder / spin.write(SWEEP, "scene.log")
    assert "would replace" in spin.refuse(scene, "--output=.")
    names = spin.write(GOOD, "other.nml"), spin.write(GOOD, "other.csv")
    spin.call(*names, "--set=output.file=x", "--output=.", code=2)
    assert (spin.folder / "other.csv").read_text() == GOOD


@each("name, file", ("spin_1.5", "spin_1.5.csv"), ("a.csv", "a.csv"), ("b.v2.csv", "b.v2.csv"))
def test_points_in_the_name_of_a_table(spin, name, file):
    spin(MOTION, f"output.file={name}")
    assert (spin.folder / "output" / file).exists()


# A run prints what a person reads; the rest with --verbose.

MOST = 10
EVENTS = "&output columns = 't', 'theta' events = 'turning_points' /\n"
FIVE = "&study kind = 'sweep' /\n&sweep parameter = 'top.mass' from = 1 to = 9 count = 5 /\n"


@each(
    "text, details",
    (CLOSED + EVENTS, ("model", "constants", "fast top", "cost")),
    (CLOSED + "&integration method = 'dop853' /\n", ("model", "constants", "fast top", "cost")),
    (CLOSED + FIVE, ("model", "ended", "parts", "memory")),
    ids=["trajectory", "integrated", "sweep"],
)
def test_details(spin: Spin, text: str, details: tuple[str, ...]) -> None:
    """The lines of a run are few, and all of them are among those of --verbose."""
    short = spin(text).out.splitlines()
    whole = spin(text, "-v").out.splitlines()
    assert len(short) <= MOST
    assert [words(line) for line in short] == [
        words(line) for line in whole if not line.strip().startswith(details)
    ]
    assert all(any(line.startswith(f"  {word}") for line in whole) for word in details)
    if "sweep" in text:
        log = (spin.folder / "output/scene.log").read_text(encoding="utf-8").splitlines()
        assert [words(line) for line in log] == [words(line) for line in whole]


def words(line: str) -> str:
    """The keyword of a line, and its text unless this is a time."""
    is_timed = line.startswith(("  time", "  ended", "  parts", "  memory", "  cost"))
    return line[:12] if is_timed else line
