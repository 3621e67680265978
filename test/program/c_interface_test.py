"""The interface for C: its examples in C99 and C++17, linked with the library of this build."""

import itertools
import json
import os
import re
import shutil
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path
from typing import ClassVar

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
KIND = os.environ.get("SPINTOP_TEST_KIND", "release")
EXTRA = {"sanitized": "-fsanitize=address,undefined", "coverage": "--coverage"}.get(KIND, "")
WARNINGS = "-Wall -Wextra -pedantic -Werror"
TOP = "&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 /"
START = "&initial theta_deg = 11.25 psi_rate = 1 /"


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


def numbers(text: str) -> list[float]:
    """The numbers of a line."""
    return [float(word) for word in text.split()]


@pytest.mark.usefixtures("folder")
class CInterfaceTest(unittest.TestCase):
    """Each program is compiled without warnings, and linked with the static library."""

    folder: Path
    programs: ClassVar[Path]

    @classmethod
    def setUpClass(cls) -> None:
        """A folder for the programs, each of which is built once."""
        cls.programs = Path(tempfile.mkdtemp(prefix="spintop test "))
        cls.addClassCleanup(shutil.rmtree, cls.programs)

    def build(self, source: Path, compiler: str) -> Path:
        """Compile a program and link it, unless that was done."""
        program = self.programs / source.stem
        if program.exists():
            return program
        manifest = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))
        libraries = " ".join("-l" + library for library in manifest["build"]["link"])
        command = (
            f". '{ROOT}/.venv/bin/activate' && {compiler} {WARNINGS} {EXTRA} -I'{ROOT}/include'"
            f" -c '{source}' -o object.o && gfortran -fopenmp {EXTRA} object.o"
            f" '{EXE.parent}/lib/libspintop.a' $FPM_LDFLAGS {libraries} -lstdc++ -lm -o '{program}'"
        )
        done = subprocess.run(
            ["bash", "-c", command], cwd=self.folder, capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return program

    def run_it(self, program: Path, *arguments: str, code: int = 0) -> str:
        """Run a program, which must write nothing to standard error."""
        done = subprocess.run(
            [program, *arguments], capture_output=True, text=True, check=False, cwd=self.folder
        )
        self.assertEqual((done.returncode, done.stderr), (code, ""), done.stdout)
        return done.stdout

    def driver(self) -> Path:
        """The driver of this suite."""
        return self.build(ROOT / "test/support/c_driver.txt", "gcc -std=c99 -x c")

    def table(self, text: str, *options: str) -> dict[str, list[str]]:
        """The columns of the table that the program writes for an input."""
        path = self.folder / "by_program.nml"
        path.write_text(text, encoding="utf-8")
        command = [EXE, "--quiet", "-o", str(self.folder / "by program"), *options, str(path)]
        subprocess.run(command, check=True, capture_output=True)
        return self.read("by_program.csv")

    def read(self, name: str) -> dict[str, list[str]]:
        """The columns of a table of the program."""
        text = (self.folder / "by program" / name).read_text(encoding="utf-8")
        names, *rows = [line.split(",") for line in text.splitlines() if line[0] != "#"]
        return {name: [row[i] for row in rows] for i, name in enumerate(names)}

    def test_c99(self) -> None:
        """The example in C: two motions, the events, the message on a wrong input."""
        text = self.run_it(self.build(ROOT / "doc/examples/one_top.c", "gcc -std=c99"))
        self.assertIn("interface 1\n", text)
        self.assertIn("\ntheta              [rad] 0.19634954084936", text)
        error = re.search(r"^orientation_error +\[rad\] (\S+) (\S+) (\S+)$", text, re.M)
        self.assertLess(float(error[1]), 1e-15)
        self.assertTrue(0 < float(error[2]) < 1e-5, text)
        slope = re.search(r"^theta__top.mass +\[rad/kg\] (\S+) (\S+) (\S+)$", text, re.M)
        # A heavier top nutates faster: at 2 s it is on its way up.
        self.assertEqual(float(slope[1]), 0)
        self.assertAlmostEqual(float(slope[3]), -0.9141317, delta=1e-6)
        self.assertIn("table events: 2 rows\nlower_turning_point 1 ", text)
        self.assertRegex(text, r"code 2, input:1:13\ninput:1:13: error: ")

    def test_cpp(self) -> None:
        """The example in C++: a sweep and arrays give the same bits; threads; an exception."""
        text = self.run_it(self.build(ROOT / "doc/examples/many_tops.cpp", "g++ -std=c++17"))
        self.assertIn("1000 tops, theta_max of the first ", text)
        self.assertIn(", equal\n0 of 8 threads differ\n", text)
        self.assertIn("element 1 of initial.theta must be", text)

    def test_exact_motion_has_the_bits_of_the_program(self) -> None:
        """Columns at the times of a table; also of a body whose axis is turned, and a free one."""
        driver = self.driver()
        bodies = (
            TOP,
            "&top mass = 1 inertia = 0.25, 0.875, 0.875 centre_of_mass = 0.5, 0, 0 /",
            "&top mass = 2 inertia = 0.3, 0.5, 0.7 centre_of_mass = 0, 0, 0 /",
        )
        rest = (
            "&initial phi = 0.3 theta = 1 psi = -2 phi_rate = 0.5 theta_rate = -0.2 psi_rate = 9 /"
            "&span t_end = 12.5 samples = 41 /"
            "&output columns = 't', 'phi', 'theta', 'psi', 'omega1', 'energy', 'force_x' /"
        )
        for body in bodies:
            with self.subTest(body):
                table = self.table(body + rest)
                lines = self.run_it(driver, "at", body + rest, *table["t"]).splitlines()
                self.assertEqual(len(lines), 41)
                for i, line in enumerate(lines):
                    expected = [float(column[i]) for column in table.values()]
                    self.assertEqual(numbers(line), expected)

    def test_integration_has_the_bits_of_the_program(self) -> None:
        """Dense output of an adaptive method, and the steps of a fixed one."""
        driver = self.driver()
        for settings in ("method = 'ode45' relative_tolerance = 1e-8", "method = 'rk4' steps = 80"):
            with self.subTest(settings):
                text = (
                    f"{TOP} {START} &span t_end = 2 samples = 9 /"
                    f"&integration {settings} / &output columns = 't', 'theta', 'psi' /"
                )
                table = self.table(text)
                lines = self.run_it(driver, "at", text, *table["t"]).splitlines()
                expected = [
                    [float(cell) for cell in row] for row in zip(*table.values(), strict=True)
                ]
                self.assertEqual([numbers(line) for line in lines], expected)

    def test_work_of_effects(self) -> None:
        """The work of effects, and the energy error without it, are those of the program."""
        text = (
            f"{TOP} {START} &effects drag_moment = 0.1, 0.1, 0.1 / &span t_end = 2 samples = 9 /"
            "&integration method = 'dop853' / &output columns = 't', 'work', 'energy_error' /"
        )
        table = self.table(text)
        lines = self.run_it(self.driver(), "at", text, *table["t"]).splitlines()
        expected = [[float(cell) for cell in row] for row in zip(*table.values(), strict=True)]
        self.assertEqual([numbers(line) for line in lines], expected)
        self.assertLess(expected[-1][1], -1e-3)

    def test_a_motion_that_ends(self) -> None:
        """Rows that were not reached are NaN, and the error has the status."""
        text = (
            f"{TOP} {START} &span t_end = 9 / &output columns = 'theta' /"
            "&integration method = 'taylor' max_steps = 3 /"
        )
        *rows, told = self.run_it(self.driver(), "at", text, "0", "0.001", "9", code=3).splitlines()
        self.assertRegex(" ".join(rows), r"^0\.196\S+ +0\.196\S+ +-?nan *$")
        self.assertRegex(told, r"^3\|step_limit\|\|0\|0\|step_limit: the maximum number of steps")

    def test_wrong_times(self) -> None:
        """Times that are not finite, decreasing, or between steps are refused."""
        rest = "&span t_end = 2 / &output columns = 'theta' /"
        driver = self.driver()
        exact = f"{TOP} {START} {rest}"
        fixed = exact + "&integration method = 'rk4' steps = 4 /"
        adaptive = exact + "&integration method = 'ode45' /"
        for text, times in (
            (exact, ("1", "nan")),
            (exact, ("inf",)),
            (adaptive, ("2", "1")),
            (adaptive, ("-1", "1")),
            (fixed, ("0", "0.7", "1")),
            (fixed, ("0", "3")),
        ):
            with self.subTest(f"{text} {times}"):
                told = self.run_it(driver, "at", text, *times, code=2).splitlines()[-1]
                self.assertRegex(told, r"^2\|bad_(samples|span)\|")
        self.run_it(driver, "at", exact, "5", "-3", "0")
        self.run_it(driver, "at", fixed, "0", "0.5", "2")

    def test_wrong_inputs(self) -> None:
        """Messages are those of the program, with the place; a sweep is no top."""
        driver = self.driver()
        told = self.run_it(driver, "at", f"{TOP}\n&initial thta = 1 /", "0", code=2)
        self.assertRegex(told, r"(?s)^2\|\|top\|2\|10\|top:2:10: error: unknown key 'thta'.*theta")
        told = self.run_it(driver, "at", "no namelist", "0", code=2)
        self.assertRegex(told, r"^2\|\|top\|1\|1\|top:1:1: error: text outside a group")
        other = "&study kind = 'stability' / &output file = 'x' /"
        told = self.run_it(driver, "at", other, "0", code=2)
        self.assertIn("the input of a top is that of a trajectory", told)
        told = self.run_it(driver, "run", f"{TOP} {START}", code=2)
        self.assertIn("the time span is not given", told)
        told = self.run_it(driver, "list", "methos", code=2)
        self.assertIn("did you mean 'methods'?", told)

    def test_null_pointers(self) -> None:
        """Where something has to be they are errors, at each place of each function."""
        told = self.run_it(self.driver(), "null", f"{TOP} {START} &span t_end = 1 /")
        errors = [line for line in told.splitlines() if "|" in line]
        self.assertEqual(len(errors), 19)
        for line in errors:
            self.assertRegex(line, r"^2\|\|.*( is a null pointer| is null|the file has no group)$")

    def test_odd_numbers_and_names(self) -> None:
        """Sizes beyond all memory, negative counts and empty names are refused, never answered."""
        told = self.run_it(self.driver(), "odd", f"{TOP} {START} &span t_end = 1 /")
        errors = [line for line in told.splitlines() if "|" in line]
        source = (ROOT / "test/support/c_driver.txt").read_text(encoding="utf-8")
        calls = source.split("int give_odd(")[1].split("\n}\n")[0].count(") tell(error)")
        self.assertEqual(len(errors), calls, told)
        for line in errors:
            self.assertRegex(line, r"^2\|\|")

    def test_environment_of_the_run_time_library(self) -> None:
        """A sign that gfortran writes on request is in no text."""
        text = (
            f"{TOP} {START} &span t_end = 1 / &integration method = 'rk4' steps = 4 max_steps = 3 /"
        )
        calls = [("run", text), ("list", "parameters"), ("at", text, "0", "9")]
        for call in calls:
            found = []
            for environment in ({}, {"GFORTRAN_OPTIONAL_PLUS": "y"}):
                done = subprocess.run(
                    [self.driver(), *call],
                    env=os.environ | environment,
                    capture_output=True,
                    text=True,
                    check=False,
                    cwd=self.folder,
                )
                found.append((done.returncode, done.stdout, done.stderr))
            self.assertEqual(*found)

    def test_small_stacks(self) -> None:
        """A thread of the caller may have the stack that the header asks for."""
        rest = f"{START} &span t_end = 1 samples = 5 /"
        asymmetric = TOP.replace("0.875, 0.875", "0.9, 0.7")
        calls = [("list", ""), ("tops", "1"), ("at", f"{TOP} {rest}", "0.5", "1")]
        calls += [("run", f"{TOP} {rest}"), ("sweep", f"&study kind = 'sweep' / {TOP} {rest}")]
        events = "&output events = 'turning_points' columns = 't', 'theta' /"
        calls += [("events", f"{TOP} {rest} {events}")]
        for method in json.loads(self.run_it(self.driver(), "list", "methods"))["methods"]:
            name = method["name"]
            steps = "steps = 100" * (name != "exact")
            calls += [("run", f"{asymmetric} {rest} &integration method = '{name}' {steps} /")]
        for call in calls:
            with self.subTest(call=call):
                done = subprocess.run(
                    [self.driver(), "stack", "768", *call],
                    capture_output=True,
                    text=True,
                    check=False,
                    cwd=self.folder,
                )
                self.assertIn(done.returncode, (0, 2, 3), done.stdout + done.stderr)

    def test_events_of_a_top(self) -> None:
        """The cells of the program's table: exact, by steps of both kinds, up to an end."""
        driver = self.driver()
        settings = ("exact", "taylor", "dop853", "rk4")
        for method, end in itertools.product(settings, ("", "stop_at = 'theta = 0.6'")):
            with self.subTest(f"{method} {end}"):
                text = (
                    f"{TOP} &initial theta_deg = 11.25 psi_rate = 1 / &span t_end = 9 {end} /"
                    "&output columns = 't', 'theta', 'energy'"
                    " events = 'lower_turning_points', 'theta = 0.6 rising' /"
                    f"&integration method = '{method}' {'steps = 900' * (method == 'rk4')} /"
                )
                lines = self.run_it(driver, "events", text).splitlines()
                self.assertEqual(lines[0], "events")
                columns = {line.split("|")[0]: line.split("|")[3] for line in lines[1:]}
                self.table(text)
                table = self.read("by_program.events.csv")
                self.assertEqual(list(columns), list(table))
                self.assertGreater(len(table["t"]), 0 if end else 5)
                self.assertEqual(columns.pop("event").strip(), " ".join(table.pop("event")))
                for name, cells in columns.items():
                    self.assertEqual(numbers(cells), [float(cell) for cell in table[name]], name)

    def test_events_that_are_none(self) -> None:
        """A motion without them has an empty table, a top without them an error."""
        text = f"{TOP} {START} &span t_end = 1 /"
        told = self.run_it(self.driver(), "events", text, code=2)
        self.assertIn("has no events: name them in output.events", told)
        lines = self.run_it(self.driver(), "events", text + "&output events = 'theta = 3' /")
        self.assertTrue(lines.startswith("events\nevent||the event|\nnumber||"), lines)
        text += "&integration method = 'taylor' max_steps = 3 / &output events = 'theta = 3' /"
        self.run_it(self.driver(), "events", text.replace("t_end = 1", "t_end = 900"), code=3)

    def test_derivatives_of_a_top(self) -> None:
        """Those of the program's trajectory, bit by bit: in closed form, and integrated."""
        bodies = (
            f"{TOP} &initial theta = 0.4 psi_rate = 12 /",
            "&top mass = 1 inertia = 0.9, 0.7, 0.25 centre_of_mass = 0.05, 0, 0.8 damping = 3*.01 /"
            "&initial theta = 0.4 psi_rate = 12 / &integration method = 'dop853' /",
        )
        rest = (
            "&span t_end = 2 samples = 5 / &output columns = 't', 'phi__top.mass', 'theta',"
            " 'theta__initial.psi_rate', 'theta__top.mass' /"
        )
        for body in bodies:
            with self.subTest(body):
                table = self.table(body + rest)
                lines = self.run_it(self.driver(), "at", body + rest, *table["t"]).splitlines()
                rows = zip(*table.values(), strict=True)
                expected = [[float(cell) for cell in row] for row in rows]
                self.assertEqual([numbers(line) for line in lines], expected)
                self.assertGreater(abs(expected[-1][4]), 1e-3)

    def test_derivatives_that_are_none(self) -> None:
        """Nothing depends on the span; with another I1 there is no closed form."""
        rest = "&span t_end = 2 / &output columns = 'theta__{}' /"
        for key, message in (
            ("span.t_end", "the times of a top are given"),
            ("top.inertia(1)", "with another top.inertia(1) there is no motion"),
        ):
            text = f"{TOP} {START} &integration method = 'exact' /" + rest.format(key)
            self.assertIn(message, self.run_it(self.driver(), "at", text, "1", code=2))

    def test_tables_in_memory(self) -> None:
        """Those of a trajectory with events, with units, and no file is left."""
        text = (
            f"{TOP} {START} &span nutations = 2 samples = 5 /"
            "&output columns = 't', 'theta' events = 'lower_turning_points' /"
        )
        temporary = self.folder / "temporary"
        temporary.mkdir()
        os.environ["TMPDIR"] = str(temporary)
        try:
            lines = self.run_it(self.driver(), "run", text).splitlines()
        finally:
            del os.environ["TMPDIR"]
        self.assertEqual(list(temporary.iterdir()), [])
        table = self.table(text)
        self.assertEqual(lines[0], "rows")
        self.assertTrue(lines[1].startswith("t|s|time|"), lines[1])
        theta = lines[2].split("|")
        self.assertEqual(theta[:2], ["theta", "rad"])
        self.assertEqual(numbers(theta[3]), [float(cell) for cell in table["theta"]])
        self.assertEqual(lines[3], "events")
        self.assertEqual(lines[4].split("|")[3], "lower_turning_point lower_turning_point ")

    def test_a_sweep_in_memory(self) -> None:
        """The cells of the program's table, words among them; failed cases give code 3."""
        text = (
            f"&study kind = 'sweep' / {TOP} &initial theta = 0.5 / &span t_end = 1 /"
            "&sweep parameter = 'initial.psi_rate' from = 0 to = 30 count = 7 /"
            "&output columns = 'theta_max', 'nutation_period', 'motion_class' /"
        )
        lines = self.run_it(self.driver(), "run", text).splitlines()
        columns = [line.split("|") for line in lines[1:]]
        table = self.table(text)
        self.assertEqual([column[0] for column in columns], list(table))
        for name, _, _, cells in columns:
            if name == "notes":
                continue
            words = name in ("status", "motion_class")
            found = cells.split() if words else numbers(cells)
            expected = table[name] if words else [float(cell) for cell in table[name]]
            self.assertEqual(found, expected, name)
        units = {column[0]: column[1] for column in columns}
        self.assertEqual((units["theta_max"], units["nutation_period"]), ("rad", "s"))

    def test_a_folder(self) -> None:
        """With a folder the table is a file, too, equal to the program's but for the date."""
        text = f"{TOP} {START} &span t_end = 1 samples = 3 /"
        self.run_it(self.driver(), "run", text, str(self.folder / "kept"))
        found = (self.folder / "kept" / "run.csv").read_text(encoding="utf-8").splitlines()
        self.table(text)
        expected = (self.folder / "by program" / "by_program.csv").read_text("utf-8").splitlines()
        dated = re.compile("# (date|options|revision): ")
        both = [[line for line in lines if not dated.match(line)] for lines in (found, expected)]
        self.assertEqual(*both)

    def test_arithmetic_of_the_caller(self) -> None:
        """Rounding and traps of the caller change no bit, end no process, and stay as they were."""
        start = START + "&span t_end = 3 /"
        top = TOP + start
        general = "&top mass = 1 inertia = 0.9, 0.7, 0.25 centre_of_mass = 0.05, 0, 0.8 /" + start
        sweep = "&study kind = 'sweep' /"
        calls = (
            ("tops", "1"),
            ("at", top, "0", "1.5", "1000"),
            ("at", top + "&output columns = 'theta', 'theta__top.mass' /", "0", "7"),
            ("at", general + "&integration method = 'taylor' /", "0", "1", "20"),
            ("sweep", top + sweep + "&output columns = 'theta_max', 'phi_end' /"),
            ("sweep", general + sweep + "&output columns = 'theta_max', 'lyapunov_exponent' /"),
            ("run", top + "&output columns = 'all' /"),
            ("run", general + "&integration method = 'arkode_erk' /"),
            ("events", top + "&output events = 'lower_turning_points' /"),
            ("list", "methods"),
        )
        driver = self.driver()
        for call in calls:
            expected = self.run_it(driver, *call)
            for arithmetic in ("upward", "toward zero", "traps"):
                with self.subTest(call=call, arithmetic=arithmetic):
                    os.environ["ARITHMETIC"] = arithmetic
                    self.addCleanup(os.environ.pop, "ARITHMETIC", None)
                    self.assertEqual(self.run_it(driver, *call), expected)
            os.environ.pop("ARITHMETIC")

    def test_number_of_threads(self) -> None:
        """More threads than a system has room for are as many as there is work for."""
        driver = self.driver()
        self.assertEqual(
            self.run_it(driver, "tops", "2000000000"), self.run_it(driver, "tops", "1")
        )

    @unittest.skipIf(KIND == "sanitized", "its allocator does not count")
    @pytest.mark.slow
    def test_memory(self) -> None:
        """Each kind of call gives back all that it took, also after an error."""
        driver = self.driver()
        # Without the caches of threads, whose blocks count as used.
        os.environ["GLIBC_TUNABLES"] = "glibc.malloc.tcache_count=0"
        self.addCleanup(os.environ.pop, "GLIBC_TUNABLES")
        motion = f"{TOP} {START} &span t_end = 1 samples = 3 /"
        some = "&output columns = 't', 'theta' events = 'lower_turning_points' /"
        sweep = "&sweep parameter = 'initial.psi_rate' values = 0, 9 / &output columns = 'notes' /"
        data = f"&fit data = '{ROOT}/input/fit.csv' unknown = 'top.inertia(3)' /"
        for arguments in (
            ("at", motion + some, "0", "0.5"),
            ("at", motion + some, "0", "nan"),
            ("at", motion + "&initial thta = 1 /", "0"),
            ("at", motion + "&integration method = 'arkode_erk' /", "0", "1"),
            ("at", motion + "&output columns = 'theta__top.mass' /", "0", "1"),
            ("events", motion + some),
            ("run", motion + some),
            ("run", motion + "&integration method = 'taylor' max_steps = 3 /"),
            ("run", f"&study kind = 'sweep' / {motion} {sweep}"),
            ("run", f"&study kind = 'fit' / {TOP} {START} {data}"),
            ("list", "columns"),
        ):
            with self.subTest(arguments):
                last = self.run_it(driver, "again", *arguments).splitlines()[-1]
                self.assertEqual(last, "grown by 0 bytes")

    def test_a_stopped_run(self) -> None:
        """A run asks its caller, and ends with an error when that wants it to."""
        source = self.programs / "stopping.c"
        source.write_text(STOPPING, encoding="utf-8")
        text = self.run_it(self.build(source, "gcc -std=c99"))
        self.assertEqual(text, "3 3 stopped, as the caller wants\n")

    def test_lists(self) -> None:
        """The registries are those of the program."""
        for topic in ("methods", "columns", ""):
            command = [EXE, "list", *([topic] if topic else []), "--json"]
            expected = subprocess.run(command, check=True, capture_output=True).stdout
            found = self.run_it(self.driver(), "list", topic)
            self.assertEqual(json.loads(found), json.loads(expected))


if __name__ == "__main__":
    unittest.main()
