"""The interface for C: its examples in C99 and C++17, linked with the library of this build."""

import json
import re

import pytest

from conftest import EXE, KIND, ROOT, each, execute

EXTRA = {"sanitized": "-fsanitize=address,undefined", "coverage": "--coverage"}.get(KIND, "")
WARNINGS = "-Wall -Wextra -pedantic -Werror"
TOP = "&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 /"
START = "&initial theta_deg = 11.25 psi_rate = 1 /"
DRIVER = ROOT / "test/support/c_driver.txt"
STOPPING = """\
#include <spintop.h>
#include <stdio.h>

static int ask(double share, void *data) {
    if (share < 0 || share > 1) printf("share %g\\n", share);
    return ++*(int *)data == 3;
}

int main(void) {
    const char *input = "&top mass = 1 inertia = 0.9, 1, 0.3 length = 0.5 /\\n"
                        "&initial theta = 1 psi_rate = 9 /\\n&span t_end = 1e9 samples = 3 /\\n"
                        "&integration max_steps = 2147483646 /\\n";
    int asked = 0;
    spintop_error *error = NULL;
    spintop_on_progress(ask, &asked);
    if (spintop_run(input, NULL, NULL, 0, &error) != NULL) return 1;
    printf("%d %d %s\\n", asked, error->code, error->message);
    spintop_error_delete(error);
    return 0;
}
"""


def numbers(text):
    return [float(word) for word in text.split()]


def build(folder, source, compiler):
    program = folder / source.stem
    command = (
        f". '{ROOT}/scripts/setup' && {compiler} {WARNINGS} {EXTRA} -I'{ROOT}/include'"
        f" -c '{source}' -o object.o && gfortran -fopenmp {EXTRA} object.o"
        f" '{EXE.parent}/lib/libspintop.a' $(all_link_flags) $(libraries_of_manifest)"
        f" -lstdc++ -lm -o '{program}'"
    )
    execute("bash", "-c", command, cwd=folder)
    return program


@pytest.fixture(scope="module")
def driver_program(tmp_path_factory):
    return build(tmp_path_factory.mktemp("c programs"), DRIVER, "gcc -std=c99 -x c")


@pytest.fixture
def driver(spin, driver_program):
    """Calls the driver, which must write nothing to standard error; what it says."""

    def call(*words, code=0, environment=None):
        return run_it(spin, driver_program, *words, code=code, environment=environment)

    return call


def run_it(spin, program, *words, code=0, environment=None):
    run = spin.call(*words, command=(program,), code=code, environment=environment)
    assert run.stderr == ""
    return run.out


def test_c99(spin):
    """The example in C: two motions, the events, the message on a wrong input."""
    source = ROOT / "doc/examples/one_top.c"
    text = run_it(spin, build(spin.folder, source, "gcc -std=c99"))
    assert "interface 1\n" in text
    assert "\ntheta              [rad] 0.19634954084936" in text
    error = re.search(r"^orientation_error +\[rad\] (\S+) (\S+) (\S+)$", text, re.M)
    assert float(error[1]) < 1e-15
    assert 0 < float(error[2]) < 1e-5
    slope = re.search(r"^theta__top.mass +\[rad/kg\] (\S+) (\S+) (\S+)$", text, re.M)
    # A heavier top nutates faster: at 2 s it is on its way up.
    assert float(slope[1]) == 0
    assert float(slope[3]) == pytest.approx(-0.9141317, abs=1e-6)
    assert "table events: 2 rows\nlower_turning_point 1 " in text
    assert re.search(r"code 2, input:1:13\ninput:1:13: error: ", text)


def test_cpp(spin):
    """The example in C++: a sweep and arrays give the same bits; threads; an exception."""
    source = ROOT / "doc/examples/many_tops.cpp"
    text = run_it(spin, build(spin.folder, source, "g++ -std=c++17"))
    assert "1000 tops, theta_max of the first " in text
    assert ", equal\n0 of 8 threads differ\n" in text
    assert "element 1 of initial.theta must be" in text


def test_a_motion_that_ends(driver):
    text = f"{TOP} {START} &span t_end = 9 / &output columns = 'theta' /"
    text += "&integration method = 'taylor' max_steps = 3 /"
    *rows, told = driver("at", text, "0", "0.001", "9", code=3).splitlines()
    assert re.search(r"^0\.196\S+ +0\.196\S+ +-?nan *$", " ".join(rows))
    assert told.startswith("3|step_limit||0|0|step_limit: the maximum number of steps")


EXACT = f"{TOP} {START} &span t_end = 2 / &output columns = 'theta' /"
FIXED = EXACT + "&integration method = 'rk4' steps = 4 /"
ADAPTIVE = EXACT + "&integration method = 'ode45' /"


def test_right_times(driver):
    driver("at", EXACT, "5", "-3", "0")
    driver("at", FIXED, "0", "0.5", "2")


OTHER = "&study kind = 'stability' / &output file = 'x' /"
TIMES = r"(?m)^2\|bad_(samples|span)\|.*\n*\Z"


@each(
    "words, told",
    (("at", f"{TOP}\n&initial thta = 1 /", "0"), r"(?s)^2\|\|top\|2\|10\|top:2:10: .*theta"),
    (("at", "no namelist", "0"), r"^2\|\|top\|1\|1\|top:1:1: error: text outside a group"),
    (("at", OTHER, "0"), "the input of a top is that of a trajectory"),
    (("run", f"{TOP} {START}"), "the time span is not given"),
    (("list", "methos"), r"did you mean 'methods'\?"),
    (("at", EXACT, "1", "nan"), TIMES),
    (("at", EXACT, "inf"), TIMES),
    (("at", ADAPTIVE, "2", "1"), TIMES),
    (("at", ADAPTIVE, "-1", "1"), TIMES),
    (("at", FIXED, "0", "0.7", "1"), TIMES),
    (("at", FIXED, "0", "3"), TIMES),
)
def test_wrong_inputs(driver, words, told):
    """Messages are those of the program, with the place; a sweep is no top."""
    assert re.search(told, driver(*words, code=2))


def errors_of(driver, kind):
    told = driver(kind, f"{TOP} {START} &span t_end = 1 /")
    return [line for line in told.splitlines() if "|" in line]


def test_null_pointers(driver):
    """Where something has to be they are errors, at each place of each function."""
    errors = errors_of(driver, "null")
    assert len(errors) == 19
    for line in errors:
        assert re.search(r"^2\|\|.*( is a null pointer| is null|the file has no group)$", line)


def test_odd_numbers_and_names(driver):
    """Sizes beyond all memory, negative counts and empty names are refused, never answered."""
    errors = errors_of(driver, "odd")
    source = DRIVER.read_text(encoding="utf-8")
    calls = source.split("int give_odd(")[1].split("\n}\n")[0].count(") tell(error)")
    assert len(errors) == calls
    assert all(line.startswith("2||") for line in errors)


STOPPED = f"{TOP} {START} &span t_end = 1 / &integration method = 'rk4' steps = 4 max_steps = 3 /"


@each(
    "words, code",
    (("run", STOPPED), 0),
    (("list", "parameters"), 0),
    (("at", STOPPED, "0", "9"), 2),
)
def test_environment_of_the_run_time_library(driver, words, code):
    """A sign that gfortran writes on request is in no text."""
    signed = driver(*words, code=code, environment={"GFORTRAN_OPTIONAL_PLUS": "y"})
    assert signed == driver(*words, code=code)


REST = f"{START} &span t_end = 1 samples = 5 /"
EVENTS = "&output events = 'turning_points' columns = 't', 'theta' /"
CALLS = [("list", ""), ("tops", "1"), ("at", f"{TOP} {REST}", "0.5", "1"), ("run", f"{TOP} {REST}")]
CALLS += [("sweep", f"&study kind = 'sweep' / {TOP} {REST}"), ("events", f"{TOP} {REST} {EVENTS}")]


def test_small_stacks(spin, driver_program):
    """A thread of the caller may have the stack that the header asks for."""
    asymmetric = TOP.replace("0.875, 0.875", "0.9, 0.7")
    calls = list(CALLS)
    for method in spin.listed("methods"):
        steps = "steps = 100" * (method["name"] != "exact")
        how = f"&integration method = '{method['name']}' {steps} /"
        calls.append(("run", f"{asymmetric} {REST} {how}"))
    for words in calls:
        spin.call("stack", "768", *words, command=(driver_program,), code=(0, 2, 3))


def test_events_that_are_none(driver):
    """A motion without them has an empty table, a top without them an error."""
    text = f"{TOP} {START} &span t_end = 1 /"
    assert "has no events: name them in output.events" in driver("events", text, code=2)
    lines = driver("events", text + "&output events = 'theta = 3' /")
    assert lines.startswith("events\nevent||the event|\nnumber||")
    text += "&integration method = 'taylor' max_steps = 3 / &output events = 'theta = 3' /"
    driver("events", text.replace("t_end = 1", "t_end = 900"), code=3)


def test_derivatives_that_are_none(driver):
    """Nothing depends on the span; with another I1 there is no closed form."""
    text = f"{TOP} {START} &integration method = 'exact' /&span t_end = 2 /"
    for key, message in (("span.t_end", "are given"), ("top.inertia(1)", "there is no motion")):
        assert message in driver("at", f"{text} &output columns = 'theta__{key}' /", "1", code=2)


def test_tables_in_memory(spin, driver):
    """Those of a trajectory with events, with units, and no file is left."""
    text = f"{TOP} {START} &span nutations = 2 samples = 5 /"
    text += "&output columns = 't', 'theta' events = 'lower_turning_points' /"
    temporary = spin.folder / "temporary"
    temporary.mkdir()
    lines = driver("run", text, environment={"TMPDIR": str(temporary)}).splitlines()
    assert list(temporary.iterdir()) == []
    assert lines[0] == "rows"
    assert lines[1].startswith("t|s|time|")
    theta = lines[2].split("|")
    assert theta[:2] == ["theta", "rad"]
    assert numbers(theta[3]) == list(spin(text).rows.theta)
    assert lines[3] == "events"
    assert lines[4].split("|")[3] == "lower_turning_point lower_turning_point "


def test_a_folder(spin, driver):
    """With a folder the table is a file, too, equal to the program's but for the date."""
    text = f"{TOP} {START} &span t_end = 1 samples = 3 /"
    driver("run", text, str(spin.folder / "kept"))
    dated = re.compile("# (date|options|revision): ")
    one, other = (
        [line for line in path.read_text("utf-8").splitlines() if not dated.match(line)]
        for path in (spin.folder / "kept/run.csv", spin(text).path)
    )
    assert one == other


SPAN = START + "&span t_end = 3 /"
ANY = "&top mass = 1 inertia = 0.9, 0.7, 0.25 centre_of_mass = 0.05, 0, 0.8 /" + SPAN
SWEEP = "&study kind = 'sweep' /&output columns = 'theta_max', "


@each("arithmetic", "upward", "toward zero", "traps")
@each(
    "words",
    ("tops", "1"),
    ("at", TOP + SPAN, "0", "1.5", "1000"),
    ("at", TOP + SPAN + "&output columns = 'theta', 'theta__top.mass' /", "0", "7"),
    ("at", ANY + "&integration method = 'taylor' /", "0", "1", "20"),
    ("sweep", TOP + SPAN + SWEEP + "'phi_end' /"),
    ("sweep", ANY + SWEEP + "'lyapunov_exponent' /"),
    ("run", TOP + SPAN + "&output columns = 'all' /"),
    ("run", ANY + "&integration method = 'arkode_erk' /"),
    ("events", TOP + SPAN + "&output events = 'lower_turning_points' /"),
    ("list", "methods"),
)
def test_arithmetic_of_the_caller(driver, words, arithmetic):
    """Rounding and traps of the caller change no bit, end no process, and stay as they were."""
    assert driver(*words, environment={"ARITHMETIC": arithmetic}) == driver(*words)


def test_number_of_threads(driver):
    assert driver("tops", "2000000000") == driver("tops", "1")


MOTION = f"{TOP} {START} &span t_end = 1 samples = 3 /"
SOME = "&output columns = 't', 'theta' events = 'lower_turning_points' /"
AXIS = "&sweep parameter = 'initial.psi_rate' values = 0, 9 / &output columns = 'notes' /"
DATA = f"&fit data = '{ROOT}/input/fit.csv' unknown = 'top.inertia(3)' /"


@pytest.mark.skipif(KIND == "sanitized", reason="its allocator does not count")
@pytest.mark.slow
@each(
    "words",
    ("at", MOTION + SOME, "0", "0.5"),
    ("at", MOTION + SOME, "0", "nan"),
    ("at", MOTION + "&initial thta = 1 /", "0"),
    ("at", MOTION + "&integration method = 'arkode_erk' /", "0", "1"),
    ("at", MOTION + "&output columns = 'theta__top.mass' /", "0", "1"),
    ("events", MOTION + SOME),
    ("run", MOTION + SOME),
    ("run", MOTION + "&integration method = 'taylor' max_steps = 3 /"),
    ("run", f"&study kind = 'sweep' / {MOTION} {AXIS}"),
    ("run", f"&study kind = 'fit' / {TOP} {START} {DATA}"),
    ("list", "columns"),
)
def test_memory(driver, words):
    """Each kind of call gives back all that it took, also after an error."""
    # Without the caches of threads, whose blocks count as used.
    uncached = {"GLIBC_TUNABLES": "glibc.malloc.tcache_count=0"}
    assert driver("again", *words, environment=uncached).splitlines()[-1] == "grown by 0 bytes"


def test_a_stopped_run(spin):
    """A run asks its caller, and ends with an error when that wants it to."""
    source = spin.folder / spin.write(STOPPING, "stopping.c")
    text = run_it(spin, build(spin.folder, source, "gcc -std=c99"))
    assert text == "3 3 stopped, as the caller wants\n"


@each("topic", "methods", "columns", "")
def test_lists(spin, driver, topic):
    expected = spin.call("list", *[topic] * bool(topic), "--json").out
    assert json.loads(driver("list", topic)) == json.loads(expected)
