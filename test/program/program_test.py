"""Tests of the program as a user calls it: good input, the paper's numbers, bad input."""

import csv
import math
import os
import re
import resource
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ.get("SPINTOP_EXE", str(ROOT / "build/release/spintop"))
COMPARISONS = "kind = 'stability'", "kind = 'work_precision'", "kind = 'benchmark'"
"""These take long: other tests run parts of them."""
NEEDS_FLINT = {"certified_top", "uncertain_top"}
"""Builds without FLINT refuse these: `verify_test` runs them."""

INPUTS = [
    path
    for path in sorted((ROOT / "input").glob("*.nml"))
    if path.stem not in NEEDS_FLINT and not any(kind in path.read_text() for kind in COMPARISONS)
]
# A build that is not optimised takes minutes for these: there they are computed with less.
KIND = os.environ.get("SPINTOP_TEST_KIND", "release")
IS_OPTIMISED = KIND == "release"
LESS = {
    "long_drift": ("nutations = 1000000", "nutations = 1000"),
    "million_spins": ("count(1) = 1000000", "count(1) = 10000"),
    "spin_tilt_statistics": ("cases = 100000", "cases = 2000"),
}
LARGEST = "million_spins"  # a table of half a gigabyte, too much to be read here in any build
WITHOUT_ROWS = {"nutation_indices", "spin_tilt_statistics"}
FAILING = {"slow_top_scenario1"}  # ends at its turning point, with exit code 3

# Example 1, to as many digits as double precision holds.
LARGEST_PHI_RATE = 67.96567368900274
PERIOD = 2.3859004994933266
PRECESSION_DEG = 188.8551930812859

ERRORS = ["orientation_error", "tip_error"]

WHEEL_TABLE_1 = {  # columns of a sweep beside those of the rebuilt Table 1
    "azimuth_after_period_deg": "phi(Tp)_deg",
    "delta_u": "du_27m=exact",
    "delta_u_fast_top": "du_29c",
    "nutation_rate_fast_top": "k_Eq30",
    "nutation_rate": "k_exact=2pi/Tn",
    "nutation_period": "Tn",
    "precession_rate_fast_top": "phidotavg_32b",
    "precession_rate": "phidotavg_exact",
    "nutations_per_turn_fast_top": "N_Eq54",
    "nutations_per_turn": "N_exact_per_360",
    "nutations_in_period": "N_in_Tp",
    "phi_rate_max": "phidot_max",
    "com_z_min": "zmin",
    "fast_top_ratio": "fast_criterion_p2/a",
    "precession_period": "Tp=2pi/Eq32b",
}

GOOD = """\
&top
    mass = 1.0
    inertia = 0.875, 0.875, 0.25
    length = 0.8660254037844387
/
&initial
    theta = 0.19634954084936207
    psi_rate = 1.0
/
&span
    t_end = 0.5
/
&integration
    formulation = 'lagrange'
    method = 'rk4'
    steps = 10
/
&output
    columns = 't', 'theta', 'R4'
/
"""


class Table:
    """A table of the program or a reference table: comments, names, rows of texts.

    The line of its end is not among the comments; table_end_test checks it.
    """

    def __init__(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        lines = text.splitlines()
        if lines[-1].startswith("# end: "):
            lines.pop()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        self.header = [line[2:] for line in lines[:first]]
        self.trailer = [line for line in lines[first:] if line.startswith("#")]
        rows = list(csv.reader(line for line in lines[first:] if not line.startswith("#")))
        self.names, self.rows = rows[0], rows[1:]
        self.last_line = lines[-1]
        self.ends_line = text.endswith("\n")

    def texts(self, name: str) -> list[str]:
        """A column as it stands there."""
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def column(self, name: str) -> list[float]:
        """A column of numbers."""
        return [float(text) for text in self.texts(name)]

    def largest(self, name: str) -> float:
        """The largest size of a column."""
        return max(abs(value) for value in self.column(name))

    def resolved(self) -> str:
        """The resolved namelist in the header."""
        begin = self.header.index("input:") + 1
        return "\n".join(self.header[begin : self.header.index("columns:")]) + "\n"


def digits(number: str) -> str:
    """The significant digits of a number."""
    return re.sub(r"e.*|\D", "", number).strip("0")


class ProgramCase(unittest.TestCase):
    """Runs the program in a folder that goes away."""

    command: tuple[str | Path, ...] = (PROGRAM,)  # that starts it

    def setUp(self) -> None:
        """Work in a new folder."""
        folder = tempfile.TemporaryDirectory(prefix="spintop test ")  # a path with a space
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, *arguments: str | Path, **options: object) -> subprocess.CompletedProcess:
        """Call the program, by default with --quiet."""
        environment = os.environ | options.pop("environment", {})
        return subprocess.run(
            [*self.command, *map(str, arguments)],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=1200,
            **options,
        )

    def write(self, text: str = GOOD, name: str = "scene.nml") -> Path:
        """Write an input file."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def scene(self, name: str) -> Path:
        """An input that comes with the program."""
        return ROOT / "input" / f"{name}.nml"

    def table(self, name: str = "scene", folder: str = "output") -> Table:
        """Read a table."""
        return Table(self.folder / folder / f"{name}.csv")

    def compute(self, scene: Path, *settings: str, code: int = 0) -> Table:
        """Run a scene with settings GROUP.KEY=VALUE; its exit code must be as expected."""
        overrides = [part for setting in settings for part in ("--set", setting)]
        result = self.run_program(scene, *overrides)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return self.table(scene.stem)

    def produced(self) -> list[str]:
        """Everything in the folder but input files."""
        paths = sorted(self.folder.rglob("*"))
        return [str(p.relative_to(self.folder)) for p in paths if p.suffix != ".nml"]

    def refuse(self, scene: Path | str, *arguments: str) -> str:
        """The program must refuse: exit code 2, a diagnosis, nothing created. Returns it."""
        before = self.produced()
        result = self.run_program(scene, *arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(self.produced(), before)
        return result.stderr


class TableChecks(ProgramCase):
    """Checks of the tables of the supplied inputs."""

    def with_less(self, scene: Path) -> Path:
        """The input, or a copy that is computed sooner."""
        if scene.stem not in LESS or (IS_OPTIMISED and scene.stem != LARGEST):
            return scene
        text = scene.read_text(encoding="utf-8")
        self.assertIn(LESS[scene.stem][0], text)
        return self.write(text.replace(*LESS[scene.stem]), scene.name)

    def check_tables(self, inputs: list[Path], folder: str, output: str) -> None:
        """Each input has its table, and each table is whole."""
        tables = [path.name for path in (self.folder / folder).glob("*.csv")]
        endings = (".events.csv", ".histogram.csv", ".indices.csv", ".residuals.csv")
        beside = [name for name in tables if name.endswith(endings)]
        fits = ("fit", "inclinometer", "mounted_sensor", "spin_down", "tip_camera")
        expected = [f"{fit}.residuals.csv" for fit in fits]
        expected += ["nutation_indices.histogram.csv", "nutation_indices.indices.csv"]
        expected += ["slow_top_events.events.csv", "spin_tilt_statistics.histogram.csv"]
        self.assertEqual(sorted(beside), sorted(expected))
        self.assertEqual(len(tables) - len(beside), len(inputs))
        for scene in inputs:
            with self.subTest(scene.stem):
                self.assertIn(f"{scene}: ", output)
                self.check_table(scene, folder)

    def check_table(self, scene: Path, folder: str) -> None:
        """A table is whole, and its header describes its columns."""
        table = self.table(scene.stem + ".statistics" * (scene.stem in WITHOUT_ROWS), folder)
        self.assertTrue(table.ends_line)
        self.assertEqual(len(table.names), len(set(table.names)))
        for row in table.rows:
            self.assertEqual(len(row), len(table.names))
        units = table.header[table.header.index("columns:") + 1 :]
        described = [line.split()[0].rstrip(":") for line in units]
        self.assertEqual(described, table.names)
        if "status" in table.names:
            self.assertEqual(set(table.texts("status")), {"ok"})
            self.assertEqual(table.column("case"), list(range(1, len(table.rows) + 1)))
            self.assertFalse(any(line.startswith("date") for line in table.header))
        elif scene.stem in WITHOUT_ROWS:
            self.assertEqual(table.column("bin"), list(range(len(table.rows))))
            self.assertFalse(any(line.startswith("date") for line in table.header))
        elif scene.stem in FAILING:
            self.assertRegex(table.last_line, r"^# status: turning_point at t = 1\.1929502")
        else:
            self.assertRegex(table.last_line, r"^# status: (ok|at_rest at t = [0-9.]+)$")
            self.assertTrue(any(line.startswith("date: ") for line in table.header))


class GoodInputTest(TableChecks):
    """The supplied inputs run, and their tables have the documented contents."""

    @unittest.skipIf(KIND == "release", "all_inputs_test runs all inputs, by scripts/run")
    def test_every_input_runs(self) -> None:
        """All inputs at once; the largest exit code counts, and each table is whole."""
        inputs = [self.with_less(path) for path in INPUTS]
        result = self.run_program(*inputs, "-o", "deep/er/folder")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.check_tables(inputs, "deep/er/folder", result.stdout)

    def test_each_input_has_its_exit_code(self) -> None:
        """A check of each: none is refused, whatever others do."""
        for scene in INPUTS:
            with self.subTest(scene.stem):
                result = self.run_program(scene, "--check")
                self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.produced(), [])
        self.assertEqual(self.run_program(ROOT / "input/slow_top_scenario1.nml").returncode, 3)
        self.assertEqual(self.run_program(ROOT / "input/slow_top.nml").returncode, 0)

    def test_the_resolved_input_gives_the_same_table(self) -> None:
        """The output of --check and the input in a table's header run, with the same result."""
        for name in ("slow_top_lagrange_rk4", "spinning_wheel", "spinning_wheel_paper"):
            with self.subTest(name):
                scene = ROOT / "input" / f"{name}.nml"
                quick = ["integration.relative_tolerance=1e-4"] if name.endswith("paper") else []
                first = self.compute(scene, *quick)
                overrides = [part for setting in quick for part in ("--set", setting)]
                checked = self.run_program(scene, "--check", *overrides)
                for i, text in enumerate((checked.stdout, first.resolved())):
                    again = self.compute(self.write(text, f"again{i}.nml"))
                    self.assertEqual(again.names, first.names)
                    self.assertEqual(again.rows, first.rows)
                    self.assertEqual(again.resolved(), first.resolved())

    def test_numbers_read_back_to_the_same_bits(self) -> None:
        """The shortest form that does: repr() of Python is one."""
        table = self.compute(self.write())
        for name in table.names:
            for text in table.texts(name):
                self.assertEqual(len(digits(text)), len(digits(repr(float(text)))), text)
        self.assertEqual(table.texts("t")[-1], "0.5")
        self.assertEqual(float(table.texts("theta")[0]), 0.19634954084936207)

    def test_overrides(self) -> None:
        """--set takes lists, subscripts, words without quotes, several at once, the last wins."""
        scene = self.write()
        table = self.compute(scene, "output.columns=t,theta")
        self.assertEqual(table.names, ["t", "theta"])
        self.assertEqual(len(table.rows), 11)
        table = self.compute(scene, "integration.steps=20", "integration.method=rk2")
        self.assertEqual(len(table.rows), 21)
        self.assertIn("method = 'rk2'", table.resolved())
        # The other two moments stay; without symmetry no formulation here will do.
        error = self.refuse(scene, "--set", "top.inertia(2)=0.8")
        self.assertIn("symmetric", error)
        table = self.compute(scene, "top.inertia(3)=0.5")
        self.assertIn("inertia = 0.875, 0.875, 0.5", table.resolved())
        table = self.compute(scene, "output.columns=all")
        self.assertGreaterEqual(len(table.names), 40)
        self.assertEqual(table.names[:2] + table.names[38:40], ["t", "phi", *ERRORS])
        self.run_program(scene, "--set", "output.file=other name")
        self.assertEqual(self.table("other name").rows, self.compute(scene).rows)

    def test_folders_and_names(self) -> None:
        """-o makes nested folders; output.file names the table; nothing else is left behind."""
        scene = self.write()
        self.assertEqual(self.run_program(scene, "--output=a/b c").returncode, 0)
        self.assertEqual(
            self.run_program(scene, "-o", "d", "--set", "output.file=x.y").returncode, 0
        )
        expected = ["a", "a/b c", "a/b c/scene.csv", "d", "d/x.y.csv"]
        self.assertEqual(self.produced(), expected)

    def test_several_inputs_with_the_same_table_are_refused(self) -> None:
        """Two inputs that would write the same table."""
        self.write()
        (self.folder / "sub").mkdir()
        error = self.refuse("scene.nml", "scene.nml")
        self.assertIn("is also that of", error)

    def test_one_bad_input_stops_all(self) -> None:
        """All inputs are validated before the first runs."""
        good = self.write()
        self.write(GOOD.replace("mass", "mas"), "bad.nml")
        error = self.refuse(good, "bad.nml")
        self.assertIn("bad.nml:2:5: error", error)

    def test_threads_do_not_change_a_sweep(self) -> None:
        """The same bytes on one thread and on two, with more cases than a block holds."""
        scene = self.write(
            GOOD.replace("t_end = 0.5", "t_end = 0.05").split("&output")[0]
            + "&study kind = 'sweep' /\n&sweep parameter(1) = 'initial.theta_deg', from(1) = 1,"
            " to(1) = 179, count(1) = 15, parameter(2) = 'initial.psi_rate', from(2) = 0.1,"
            " to(2) = 1000, count(2) = 14, spacing(2) = 'log' /\n"
        )
        scene.write_text(
            scene.read_text().replace("    theta = 0.19634954084936207\n", "    theta_deg = 5\n")
        )
        contents = []
        for threads in ("1", "2", "5"):
            result = self.run_program(scene, "--threads", threads, "-o", threads)
            self.assertEqual(result.returncode, 0, result.stderr)
            contents.append((self.folder / threads / "scene.csv").read_bytes())
        self.assertEqual(contents[0], contents[1])
        self.assertEqual(contents[0], contents[2])
        table = self.table(folder="1")
        self.assertEqual(len(table.rows), 210)
        thetas = table.column("initial.theta_deg")
        self.assertEqual(thetas[:15], [1.0] * 14 + [1 + 178 / 14])
        self.assertAlmostEqual(table.column("initial.psi_rate")[1], 0.1 * 10 ** (4 / 13), 12)
        self.assertEqual(table.column("initial.psi_rate")[13], 1000)

    def test_a_sweep_marks_its_failed_cases(self) -> None:
        """A case at a pole fails; the other rows are complete."""
        scene = self.write(
            GOOD.replace("&output\n    columns = 't', 'theta', 'R4'\n/\n", "")
            + "&study kind = 'sweep' /\n"
            "&sweep parameter(1) = 'initial.theta', values(1,:) = 0.5, 0, 1 /\n"
        )
        table = self.compute(scene, code=3)
        self.assertEqual(table.texts("status"), ["ok", "pole", "ok"])
        self.assertEqual(table.texts("theta_end")[1], "nan")
        self.assertIn("pole", table.texts("notes")[1])
        self.assertEqual(self.produced(), ["output", "output/scene.csv", "output/scene.log"])

    def test_lists_help_and_version(self) -> None:
        """Every topic lists what the input accepts."""
        expected = {
            "methods": ["rk4", "ode45", "arkode_dirk", "crank_nicolson_2", "exact"],
            "formulations": ["euler", "lagrange", "energy_rate", "lagrange_energy"],
            "columns": ["orientation_error", "force_n", "nutations_per_turn_fast_top"],
            "shapes": ["spinning_wheel", "ring", "cone", "inertia"],
            "events": ["turning_points", "azimuth_turns", "COLUMN = VALUE"],
            "parameters": ["top.inertia", "initial.theta_deg", "sweep.values", "span.nutations"],
        }
        for topic, words in expected.items():
            result = self.run_program("list", topic)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            for word in words:
                self.assertIn(word, result.stdout)
        result = self.run_program("--version")
        self.assertRegex(result.stdout, r"^spintop \d+\.\d+\.\d+ ")
        result = self.run_program("--help")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for option in (
            "--output DIR",
            "--set GROUP.KEY=VALUE",
            "--threads N",
            "--check",
            "--quiet",
        ):
            self.assertIn(option, result.stdout)
        self.assertEqual(self.produced(), [])

    def test_decimal_commas_and_quiet(self) -> None:
        """A locale with decimal commas changes nothing; results alone go to standard output."""
        scene = self.write()
        expected = self.compute(scene).rows
        locale = {"LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8", "LC_NUMERIC": "de_DE.UTF-8"}
        result = self.run_program(
            scene, "--set", "top.length=0.8660254037844387", environment=locale
        )
        self.assertEqual(result.returncode, 0)
        self.assertEqual(self.table().rows, expected)
        self.assertEqual(result.stderr, "")
        self.assertIn("output/scene.csv", result.stdout)


class PaperTest(ProgramCase):
    """The numbers of the paper's examples, through summaries and tables."""

    def test_example_1_in_numbers(self) -> None:
        """The summary of --check, and the exact table."""
        summary = self.run_program(self.scene("slow_top"), "--check").stdout
        for number in (
            "0.2451963201 J s",
            "8.4574665409 J",
            "174.7699132287 deg",
            "67.9656736890 rad/s",
            "2.3859004995 s",
            "188.8551930813 deg",
        ):
            self.assertIn(number, summary)
        table = self.compute(
            self.scene("slow_top"), "output.columns=t,theta,phi,phi_rate,energy,lz"
        )
        self.assertEqual(len(table.rows), 1985)
        self.assertAlmostEqual(table.column("t")[-1], 3 * PERIOD, 13)
        self.assertAlmostEqual(math.degrees(table.column("phi")[-1]), 3 * PRECESSION_DEG, 9)
        self.assertAlmostEqual(table.column("theta")[-1], math.pi / 16, 9)
        self.assertLess(table.largest("phi_rate"), LARGEST_PHI_RATE + 1e-9)
        # 1984 intervals: row 331 is half a row from the bottom, so look at a finer half period.
        table = self.compute(
            self.scene("slow_top"),
            "span.nutations=1",
            "span.samples=3",
            "output.columns=t,theta,phi_rate,force_z",
        )
        self.assertAlmostEqual(math.degrees(table.column("theta")[1]), 174.769913228745063, 11)
        self.assertAlmostEqual(table.column("phi_rate")[1], LARGEST_PHI_RATE, 9)
        self.assertAlmostEqual(table.column("force_z")[1], 42.982609437226322723, 9)
        self.assertAlmostEqual(table.column("force_z")[0], 9.4899678059724527476, 12)

    def test_accurate_methods_agree_with_the_reference(self) -> None:
        """ode45 and ARKODE at relative tolerance 1e-12: 1e-9 rad over three nutations."""
        reference = Table(ROOT / "test/reference/a1_slow_top.csv")
        rows = [dict(zip(reference.names, map(float, row), strict=True)) for row in reference.rows]
        rows = [row for row in rows if row["t"] <= 7.2]
        self.assertEqual(len(rows), 9)
        text = self.scene("slow_top").read_text().replace("nutations = 3", "t_end = 7.2")
        scene = self.write(text.replace("samples = 1985", "samples = 721"))
        for method in ("ode45", "arkode_erk", "arkode_dirk", "exact"):
            for form in ("auto",) if method == "exact" else ("lagrange", "euler", "rigid_body"):
                settings = [f"integration.method={method}", f"integration.formulation={form}"]
                if method != "exact":
                    settings += [
                        f"integration.{kind}_tolerance=1e-12" for kind in ("relative", "absolute")
                    ]
                table = self.compute(scene, "output.columns=t,q0,q1,q2,q3,phi,theta,psi", *settings)
                for row in rows:
                    i = round(100 * row["t"])
                    self.assertAlmostEqual(table.column("t")[i], row["t"], 14)
                    q = [table.column(f"q{k}")[i] for k in range(4)]
                    p = [row[f"q{k}"] for k in range(4)]
                    distance = min(math.dist(p, q), math.dist(p, [-x for x in q]))
                    self.assertLess(4 * math.asin(distance / 2), 1e-9, f"{settings} {row['t']}")
                    for name in ("phi", "theta", "psi"):
                        self.assertAlmostEqual(table.column(name)[i], row[name], 7)

    def test_the_default_equations_keep_1e_9_for_long(self) -> None:
        """ode45 and ARKODE at relative tolerance 1e-12 at all rows of the reference, to 50 s."""
        reference = Table(ROOT / "test/reference/a1_slow_top.csv")
        rows = [time for time in reference.column("t") if 10 * time == round(10 * time)]
        self.assertEqual(rows[-3:], [10.0, 20.0, 50.0])
        text = self.scene("slow_top").read_text().replace("nutations = 3", "t_end = 50")
        scene = self.write(text.replace("samples = 1985", "samples = 501"))
        for method in ("ode45", "arkode_erk"):
            table = self.compute(
                scene,
                f"integration.method={method}",
                "integration.relative_tolerance=1e-12",
                "output.columns=t,orientation_error",
            )
            errors = table.column("orientation_error")
            for time in rows:
                self.assertLess(errors[round(10 * time)], 1e-9, f"{method} at {time} s")

    def test_rk4_needs_992_steps(self) -> None:
        """248 steps are lost in both formulations; 992 keep R4 at 0.1."""
        scene = self.scene("slow_top_lagrange_rk4")
        columns = "output.columns=t,R4,phi,orientation_error"
        table = self.compute(scene, "integration.steps=248", columns)
        self.assertGreater(table.largest("R4"), 1e6)
        table = self.compute(
            scene, "integration.steps=248", "integration.formulation=euler", columns, code=3
        )
        self.assertRegex(table.last_line, r"^# status: non_finite at t = \d\.\d+$")
        self.assertEqual(table.column("t")[-1], float(table.last_line.split()[-1]))
        self.assertGreater(len(table.rows), 10)
        self.assertLess(len(table.rows), 249)
        self.assertTrue(all(math.isfinite(float(x)) for row in table.rows for x in row))
        table = self.compute(scene, columns)
        self.assertEqual(len(table.rows), 993)
        self.assertLessEqual(table.largest("R4"), 0.1)
        self.assertEqual(f"{table.largest('R4'):.2g}", "0.082")
        self.assertAlmostEqual(
            abs(math.degrees(table.column("phi")[-1]) - 3 * PRECESSION_DEG), 2.0, 1
        )
        table = self.compute(scene, "integration.formulation=euler", columns)
        self.assertEqual(f"{table.largest('R4'):.2g}", "0.025")
        self.assertAlmostEqual(
            abs(math.degrees(table.column("phi")[-1]) - 3 * PRECESSION_DEG), 0.9, 1
        )

    def test_rk2_needs_3968_steps(self) -> None:
        """R4 of RK2: not with 992 steps, but with 3968."""
        scene = self.scene("slow_top_lagrange_rk4")
        for form, least, code in (("lagrange", "0.085", 0), ("euler", "0.11", 3)):
            settings = [
                "integration.method=rk2",
                f"integration.formulation={form}",
                "output.columns=t,R4",
            ]
            table = self.compute(scene, *settings, code=code)
            self.assertGreater(table.largest("R4"), 0.11)
            table = self.compute(scene, *settings, "integration.steps=3968")
            self.assertEqual(f"{table.largest('R4'):.2g}", least)

    def test_scenario_2_keeps_the_energy_and_loses_the_azimuth(self) -> None:
        """R4 below 1e-13 beside an azimuth that is wrong by what the erratum on Eq 51 says."""
        table = self.compute(self.scene("slow_top_scenario2_rk4"))
        for name in ("R4", "phi", "orientation_error"):
            self.assertIn(name, table.names)
        exact = self.compute(self.scene("slow_top"), "span.samples=993")
        self.assertLess(table.largest("R4"), 1e-13)
        wrong = [
            abs(math.degrees(a - b))
            for a, b in zip(table.column("phi"), exact.column("phi"), strict=True)
        ]
        self.assertAlmostEqual(wrong[-1], 1.76, 2)
        self.assertAlmostEqual(max(wrong), 2.24, 2)
        self.assertGreater(math.degrees(table.largest("orientation_error")), 1.8)
        table = self.compute(self.scene("slow_top_scenario2_rk4"), "integration.steps=248")
        exact = self.compute(self.scene("slow_top"), "span.samples=249")
        self.assertLess(table.largest("R4"), 1e-13)
        wrong = [
            abs(math.degrees(a - b))
            for a, b in zip(table.column("phi"), exact.column("phi"), strict=True)
        ]
        self.assertAlmostEqual(wrong[-1], 38.9, 1)
        # Once a nutation, at the lowest point.
        self.assertAlmostEqual(max(wrong[83:166]), 92.6, 1)
        self.assertAlmostEqual(max(wrong[166:]), 161.7, 1)

    def test_table_1(self) -> None:
        """Every row of both tables as rebuilt, to 1e-6 relative or 1e-9 rad."""
        for name, inertia in (
            ("spinning_wheel_paper", "paper_I1_without_ml2"),
            ("spinning_wheel_sweep", "corrected_I1_with_ml2"),
        ):
            reference = Table(ROOT / f"test/reference/table1_{inertia}.csv")
            table = self.compute(self.scene(name))
            self.assertEqual(len(table.rows), 20)
            self.assertEqual(table.column("initial.spin_ratio"), reference.column("lambda"))
            for ours, theirs in WHEEL_TABLE_1.items():
                for a, b in zip(table.column(ours), reference.column(theirs), strict=True):
                    self.assertLessEqual(abs(a - b), max(1e-6 * abs(b), 1e-9), f"{name}: {ours}")
            if name.endswith("paper"):
                azimuth = dict(
                    zip(
                        table.column("initial.spin_ratio"),
                        table.column("azimuth_after_period_deg"),
                        strict=True,
                    )
                )
                for ratio, degrees in ((0.5, 340.014), (1.0, 428.098), (2.0, 373.185)):
                    self.assertAlmostEqual(azimuth[ratio], degrees, 3)


class ExactMotionTest(ProgramCase):
    """The exact motion, as sweeps and trajectories show it."""

    def test_table_1_without_a_step(self) -> None:
        """The closed form alone gives every column of Table 1."""
        for name, inertia in (
            ("spinning_wheel_paper", "paper_I1_without_ml2"),
            ("spinning_wheel_sweep", "corrected_I1_with_ml2"),
        ):
            reference = Table(ROOT / f"test/reference/table1_{inertia}.csv")
            text = self.scene(name).read_text(encoding="utf-8")
            text = re.sub(r"&integration.*?\n/\n", "", text, flags=re.DOTALL)
            table = self.compute(self.write(text, f"{name}_exact.nml"))
            self.assertIn("exact", next(line for line in table.header if "method: " in line))
            self.assertEqual(set(table.column("evaluations")), {0})
            for ours, theirs in WHEEL_TABLE_1.items():
                for a, b in zip(table.column(ours), reference.column(theirs), strict=True):
                    self.assertLessEqual(abs(a - b), max(1e-12 * abs(b), 1e-12), f"{name}: {ours}")

    def test_long_sweeps_do_not_depend_on_threads(self) -> None:
        """Many blocks of cases; the same bytes on any number of threads."""
        text = GOOD.split("&integration")[0].replace("    psi_rate = 1.0\n", "")
        text += "&study kind = 'sweep' /\n&sweep parameter(1) = 'initial.psi_rate', from(1) = 0.01,"
        text += " to(1) = 100, count(1) = 20000, spacing(1) = 'log' /\n"
        scene = self.write(text)
        contents = []
        for threads in ("1", "2", "4"):
            result = self.run_program(scene, "--threads", threads, "-o", threads)
            self.assertEqual(result.returncode, 0, result.stderr)
            contents.append((self.folder / threads / "scene.csv").read_bytes())
        self.assertEqual(contents[0], contents[1])
        self.assertEqual(contents[0], contents[2])
        self.assertEqual(len(self.table(folder="1").rows), 20000)

    def test_classes_of_motion(self) -> None:
        """Released with the precession against, without and with the steady one."""
        text = (
            GOOD.split("&integration")[0]
            .replace("psi_rate = 1.0", "omega3 = 40")
            .replace("0.19634954084936207", "1.0")
        )
        text += "&output columns = 'motion_class', 'force_max' /\n&study kind = 'sweep' /\n"
        text += "&sweep parameter(1) = 'initial.phi_rate', values(1,:) = -0.5, 0, 0.5 /\n"
        table = self.compute(self.write(text))
        self.assertEqual(table.texts("motion_class"), ["loop", "cusp", "wave"])

    def test_precession_through_a_pole(self) -> None:
        """It is the mean of those of motions that pass the pole closely on its two sides."""
        theta, mgl, momentum = 0.5, 9.81 * 0.8660254037844387, 0.25 * 5
        rate = momentum / 0.875 / (1 + math.cos(theta))  # of phi, for a passage of the pole itself
        energy = 9 + 2 * mgl / 0.875 * (1 - math.cos(theta))
        lines = ["initial.theta,initial.phi_rate,initial.theta_rate", "0.0,0.0,3.0"]
        for phi_rate in (rate * (1 + 1e-9), rate * (1 - 1e-9)):
            theta_rate = math.sqrt(energy - (math.sin(theta) * phi_rate) ** 2)
            lines.append(f"{theta},{phi_rate},{theta_rate}")
        (self.folder / "cases.csv").write_text("\n".join(lines) + "\n", encoding="ascii")
        text = (
            "&study kind = 'sweep' /\n&sweep table = 'cases.csv' /\n"
            + GOOD.split("&integration")[0]
        )
        text = text.replace("psi_rate = 1.0", "phi_rate = 0, theta_rate = 0, omega3 = 5")
        table = self.compute(self.write(text), "output.columns=all")
        for name in ("precession_per_nutation", "spin_per_nutation", "precession_rate"):
            through, *beside = table.column(name)
            self.assertAlmostEqual(through, sum(beside) / 2, delta=1e-6)
        for name in ("precession_per_nutation", "spin_per_nutation"):
            _, *beside = table.column(name)
            self.assertAlmostEqual(abs(beside[0] - beside[1]), 2 * math.pi, delta=1e-6)

    def test_stability_of_starts(self) -> None:
        """Sleeping below and above the threshold spin, and an inclined start that is not steady."""
        text = (
            GOOD.split("&integration")[0]
            .replace("psi_rate = 1.0", "omega3 = 0")
            .replace("t_end = 0.5", "t_end = 30")
        )
        text += "&output columns = 'growth_rate', 'lyapunov_exponent' /\n&study kind = 'sweep' /\n"
        text += "&sweep parameter = 'initial.theta', 'initial.omega3', values(1,:) = 0, 0.5,"
        text += " values(2,:) = 10, 40 /\n"
        table = self.compute(self.write(text))
        pull, gyration = 9.81 * 0.8660254037844387 / 0.875, 0.25 * 10 / 0.875
        growth = math.sqrt(pull - gyration**2 / 4)
        slow, fast, *inclined = table.column("growth_rate")
        self.assertAlmostEqual(slow, growth, delta=1e-13)
        self.assertAlmostEqual(fast, 0.0, delta=1e-13)
        self.assertTrue(all(math.isnan(rate) for rate in inclined))
        notes = table.texts("notes")
        self.assertTrue(all("no growth rate" in note for note in notes[2:]))
        self.assertFalse(any("no growth rate" in note for note in notes[:2]))
        slow, *stable = table.column("lyapunov_exponent")
        self.assertAlmostEqual(slow, growth, delta=0.1)
        for exponent in stable:
            self.assertLess(abs(exponent), 0.25)

    def test_a_top_hung_up_the_other_way_moves_the_same(self) -> None:
        """The centre of mass below the pivot on body z, or about body x: turned inside and back."""
        columns = "output.columns=com_x,com_y,com_z,force_z"
        text = GOOD.split("&integration")[0].replace("psi_rate = 1.0", "psi_rate = 2.0")
        above = self.compute(self.write(text, "above.nml"), columns)
        below = text.replace("length = 0.866", "length = -0.866")
        theta = math.pi - 0.19634954084936207
        below = below.replace("theta = 0.19634954084936207", f"theta = {theta}")
        below = below.replace("psi_rate = 2.0", "psi_rate = -2.0, phi_deg = 180")
        below = self.compute(self.write(below, "below.nml"), columns)
        for name in ("com_x", "com_y", "com_z", "force_z"):
            for a, b in zip(above.column(name), below.column(name), strict=True):
                self.assertLessEqual(abs(a - b), 1e-12 * (1 + abs(a)), name)


class EventTest(ProgramCase):
    """Events: their table, the end of a motion, quantities measured by them."""

    LISTED = "output.events=turning_points,theta = 1.5 falling,psi_deg = 90 every turn rising"

    def events(self, name: str = "scene") -> Table:
        """The table of events."""
        return Table(self.folder / "output" / f"{name}.events.csv")

    def test_a_table_of_events(self) -> None:
        """By the exact motion and by steps: the same events, each a row of the chosen columns."""
        setup = ["output.columns=t,theta,psi", "span.t_end=5", self.LISTED]
        tables = {}
        for method in ("exact", "dop853", "rk4"):
            settings = [f"integration.method={method}"]
            if method == "rk4":
                settings += ["integration.steps=20000"]
            scene = self.write(re.sub(r"&integration[^/]*/", "", GOOD), f"{method}.nml")
            rows = self.compute(scene, *setup, *settings)
            self.assertEqual(len(rows.rows), 20001 if method == "rk4" else 1001)
            tables[method] = self.events(method)
            self.assertEqual(tables[method].last_line, "# status: ok")
        exact = tables["exact"]
        self.assertEqual(exact.names, ["event", "number", "t", "theta", "psi"])
        header = exact.header[exact.header.index("columns:") + 1 :]
        self.assertEqual([line.split()[0].strip(":") for line in header], exact.names)
        self.assertEqual(
            [f"{event} {number}" for event, number, *_ in exact.rows],
            [
                "psi_deg=90 every turn rising 1",
                "lower_turning_point 1",
                "theta=1.5 falling 1",
                "upper_turning_point 1",
                "lower_turning_point 2",
                "psi_deg=90 every turn rising 2",
                "theta=1.5 falling 2",
                "upper_turning_point 2",
            ],
        )
        times = dict(zip(((row[0], row[1]) for row in exact.rows), exact.column("t"), strict=True))
        for number in (1, 2):
            upper = times["upper_turning_point", str(number)]
            lower = times["lower_turning_point", str(number)]
            self.assertAlmostEqual(upper, number * PERIOD, delta=1e-14)
            self.assertAlmostEqual(lower, (number - 0.5) * PERIOD, delta=1e-14)
        for row in exact.rows:
            if row[0].startswith("theta"):
                self.assertAlmostEqual(float(row[3]), 1.5, delta=1e-14)
            if row[0].startswith("psi"):
                turns = (float(row[4]) - math.pi / 2) / (2 * math.pi)
                self.assertAlmostEqual(turns, round(turns), delta=1e-14)
        for method, error in (("dop853", 1e-7), ("rk4", 1e-6)):
            self.assertEqual([row[:2] for row in tables[method].rows], [r[:2] for r in exact.rows])
            pairs = zip(tables[method].column("t"), exact.column("t"), strict=True)
            self.assertLess(max(abs(a - b) for a, b in pairs), error)

    def test_no_events_make_an_empty_table(self) -> None:
        """A table of events without rows, and no table without events in the input."""
        self.compute(self.write(), "output.events='theta = 3'")
        self.assertEqual(self.events().rows, [])
        self.assertEqual(self.produced(), ["output", "output/scene.csv", "output/scene.events.csv"])
        self.compute(self.write(name="other.nml"))
        self.assertNotIn("output/other.events.csv", self.produced())

    def test_an_event_ends_the_motion(self) -> None:
        """The last row is the event, and the summary says so; or that it did not come."""
        for method in (["method=exact"], ["method=dop853"], ["method=rk4", "steps=8000"]):
            with self.subTest(method):
                scene = self.write(re.sub(r"&integration[^/]*/", "", GOOD))
                settings = [f"integration.{setting}" for setting in method]
                settings += ["span.t_end=8", "span.stop_at=upper_turning_points"]
                settings += ["span.stop_after=2", "output.columns=t,theta,theta_rate"]
                arguments = [part for setting in settings for part in ("--set", setting)]
                result = self.run_program(scene, *arguments)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertRegex(result.stdout, r"\n  end +upper_turning_point \(stop_at\)\n")
                table = self.table()
                self.assertEqual(table.last_line, "# status: ok")
                times = table.column("t")
                self.assertEqual(times, sorted(set(times)))
                self.assertAlmostEqual(times[-1], 2 * PERIOD, delta=1e-7)
                self.assertAlmostEqual(table.column("theta")[-1], math.pi / 16, delta=1e-7)
                self.assertAlmostEqual(table.column("theta_rate")[-1], 0, delta=1e-12)
                result = self.run_program(scene, *arguments, "--set", "span.t_end=3")
                self.assertIn("occurred fewer than 2 times in the span", result.stdout)
                self.assertEqual(self.table().column("t")[-1], 3)

    def test_rows_of_a_motion_that_an_event_ends(self) -> None:
        """Spread equally up to the event; with a fixed step size every step, whatever `samples`."""
        scene = self.write(re.sub(r"&integration[^/]*/", "", GOOD))
        settings = ["span.t_end=1000", "span.samples=16", "span.stop_at=upper_turning_points"]
        for method in ("exact", "taylor", "dop853", "ode45"):
            table = self.compute(scene, f"integration.method={method}", *settings)
            times = table.column("t")
            self.assertEqual(len(times), 16, method)
            self.assertAlmostEqual(times[-1], PERIOD, delta=1e-1 if method == "ode45" else 1e-6)
            for i, t in enumerate(times):
                self.assertAlmostEqual(t, times[-1] * i / 15, delta=1e-14)
            self.assertEqual(table.last_line, "# status: ok")
        steps = ("integration.method=rk4", "integration.steps=300", "span.t_end=3")
        table = self.compute(scene, *settings[1:], *steps)
        times = table.column("t")
        for i, t in enumerate(times[:-1]):
            self.assertAlmostEqual(t, 0.01 * i, delta=1e-14)
        self.assertEqual(len(times), int(times[-1] / 0.01) + 2)

    def test_a_value_that_overflows_is_no_good_end(self) -> None:
        """Rows of a motion, at an event or not, and of a sweep: a status, and no inf or nan."""
        text = GOOD.split("&integration")[0].replace("t_end = 0.5", "t_end = 1e-100")
        scene = self.write(text.replace("length = 0.8660254037844387", "length = 1e200"))
        for method in ("exact", "splitting_2", "dop853"):
            settings = [f"integration.method={method}", "span.stop_at=theta_deg = 12"]
            if method == "splitting_2":
                settings.append("integration.steps=10")
            table = self.compute(scene, *settings, "output.columns=t,kinetic,com_z,force_z", code=3)
            self.assertIn("# status: non_finite", table.last_line)
            self.assertTrue(all(math.isfinite(float(x)) for row in table.rows for x in row))

    def test_work_is_bounded(self) -> None:
        """An event that never comes, in a motion that is never known: the work allowed, no more."""
        scene = self.write(re.sub(r"&integration[^/]*/", "", GOOD))
        for method in (["method=exact"], ["method=dop853"], ["method=rk4", "steps=100"]):
            settings = [f"integration.{setting}" for setting in method]
            settings += ["span.t_end=1000", "span.stop_at=com_z = 3", "integration.max_steps=150"]
            table = self.compute(scene, *settings, code=3)
            self.assertIn("# status: step_limit at t = ", table.last_line)
            self.assertLess(float(table.last_line.split()[-1]), 1000)
        sweep = (
            "&sweep parameter(1) = 'initial.omega3', values(1,:) = 1, 2 / &study kind = 'sweep' /\n"
        )
        scene = self.write(GOOD.split("&integration")[0].replace("psi_rate = 1.0", "") + sweep)
        for column in ("lyapunov_exponent", "largest_singular_value"):
            settings = (f"output.columns={column}", "span.t_end=1000", "integration.max_steps=20")
            table = self.compute(scene, *settings, code=3)
            self.assertEqual(table.texts("status"), ["step_limit"] * 2)
            self.assertEqual(table.texts(column), ["nan"] * 2)

    def test_an_event_ends_the_cases_of_a_sweep(self) -> None:
        """Every case to its second lower turning point, in closed form and by steps."""
        scene = self.write(
            "&study kind = 'sweep' /\n"
            "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /\n"
            "&initial theta = 1 /\n"
            "&span t_end = 20, stop_at = 'lower_turning_points', stop_after = 2 /\n"
            "&sweep parameter(1) = 'initial.omega3', values(1,:) = 0.5, 2, 20 /\n"
        )
        exact = self.compute(scene)
        self.assertEqual(exact.names[-2], "t_end")
        steps = self.compute(scene, "integration.method=dop853")
        for period, end, other, theta, largest in zip(
            *(exact.column(name) for name in ("nutation_period", "t_end")),
            steps.column("t_end"),
            *(exact.column(name) for name in ("theta_end", "theta_max")),
            strict=True,
        ):
            self.assertAlmostEqual(end, 1.5 * period, delta=1e-13)
            self.assertAlmostEqual(other, end, delta=1e-7)
            self.assertAlmostEqual(theta, largest, delta=1e-13)
        self.assertLess(steps.largest("orientation_error"), 1e-6)
        late = self.compute(scene, "span.stop_after=16")
        columns = (late.column("nutation_period"), late.column("t_end"), late.texts("notes"))
        came = []
        for period, end, note in zip(*columns, strict=True):
            came.append(15.5 * period < 20)
            self.assertAlmostEqual(end, 15.5 * period if came[-1] else 20, delta=1e-12)
            self.assertEqual(note, "" if came[-1] else "stop_at did not occur in the span")
        self.assertEqual(set(came), {True, False})

    def test_bodies_without_closed_form_are_computed_together(self) -> None:
        """They end as one at a time, under any method and on any number of threads."""
        scene = self.write(
            "&study kind = 'sweep' /\n"
            "&top mass = 1, inertia = 0.875, 0.7, 0.25, length = 0.8660254037844387,\n"
            "     damping = 0.01, 0.01, 0.005 /\n"
            "&initial theta_deg = 11.25, phi_rate = 0 /\n"
            "&span t_end = 3 /\n"
            "&integration relative_tolerance = 1e-12, max_steps = 40 /\n"
            "&output columns = 't_end', 'theta_end', 'phi_end', 'psi_end', 'theta_rate_end' /\n"
            "&sweep parameter(1) = 'initial.omega3', from(1) = 0.5, to(1) = 40, count(1) = 600,\n"
            "       spacing(1) = 'log' /\n"
        )
        contents = []
        for threads in ("1", "3"):
            result = self.run_program(scene, "--threads", threads, "-o", threads)
            self.assertEqual(result.returncode, 3, result.stderr)
            contents.append((self.folder / threads / "scene.csv").read_bytes())
        self.assertEqual(contents[0], contents[1])
        together = self.table(folder="1")
        self.assertIn("taylor", together.resolved() + "".join(together.header))
        exactly = ("integration.relative_tolerance=1e-15", "integration.max_steps=100000")
        alone = self.compute(scene, "integration.method=dop853", *exactly)
        self.assertEqual(set(alone.texts("status")), {"ok"})
        status = together.texts("status")
        for name in ("t_end", "theta_end", "phi_end", "psi_end", "theta_rate_end"):
            for how, ours, other in zip(
                status, together.texts(name), alone.column(name), strict=True
            ):
                if how == "ok":
                    self.assertAlmostEqual(float(ours), other, delta=1e-8)
                else:
                    self.assertEqual(ours, "nan")
        for how, note in zip(status, together.texts("notes"), strict=True):
            self.assertEqual("max_steps" in note, how == "step_limit")
        self.assertEqual(set(status), {"ok", "step_limit"})

    def test_a_body_without_closed_form_is_measured(self) -> None:
        """A slightly asymmetric body beside the symmetric one; a short span has no nutation."""
        scene = self.write(
            "&study kind = 'sweep' /\n"
            "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /\n"
            "&initial theta_deg = 40, omega3 = 25, phi_rate = -2 /\n"
            "&span t_end = 12 /\n&integration method = 'dop853', relative_tolerance = 1e-12 /\n"
            "&sweep parameter(1) = 'top.inertia(2)', values(1,:) = 0.875, 0.87500001 /\n"
        )
        names = (
            *("theta_min", "theta_max", "delta_u", "nutation_period", "precession_per_nutation"),
            *("nutations_in_period", "phi_rate_max", "com_z_min", "spin_per_nutation"),
        )
        table = self.compute(scene, "output.columns=motion_class," + ",".join(names))
        self.assertEqual(table.texts("motion_class"), ["loop", "loop"])
        for name in names:
            symmetric, other = table.column(name)
            self.assertAlmostEqual(other / symmetric, 1, delta=1e-6, msg=name)
        columns = "output.columns=motion_class,theta_max,nutation_period"
        short = self.compute(scene, "span.t_end=0.5", columns)
        self.assertEqual(short.texts("motion_class"), ["loop", "none"])
        self.assertEqual(short.texts("nutation_period")[1], "nan")
        self.assertGreater(short.column("theta_max")[1], 0.7)
        self.assertIn("no full nutation in the span", short.texts("notes")[1])

    def test_what_a_body_does_not_have_is_noted(self) -> None:
        """A symmetric body, one that is not, and a damped one; computed alone and together."""
        scene = self.write(
            "&study kind = 'sweep' /\n"
            "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /\n"
            "&initial theta_deg = 40, omega3 = 25, phi_rate = -2 /\n"
            "&span t_end = 1 /\n"
            "&sweep combine = 'zip', parameter = 'top.inertia(2)', 'top.damping(3)',\n"
            "    values(1,:) = 0.875, 0.8, 0.875, values(2,:) = 0, 0, 0.01 /\n"
        )
        compared = ("orientation_error", "inherent_error")
        fast = [f"{name}_fast_top" for name in ("delta_u", "nutation_rate", "precession_rate")]
        fast += ["nutations_per_turn_fast_top", "fast_top_ratio"]
        no_motion, no_formulas = "no exact solution for comparison: ", "no fast-top formulas: "
        for more in ([], ["theta_max"]):
            for method in ("taylor", "dop853"):
                table = self.compute(
                    scene,
                    f"integration.method={method}",
                    "output.columns=" + ",".join([*compared, *fast, "precession_period", *more]),
                )
                notes = table.texts("notes")
                self.assertNotIn("no ", notes[0])
                self.assertIn(no_motion + "the body is not symmetric", notes[1])
                self.assertIn(no_formulas + "they need a symmetric body", notes[1])
                self.assertIn(no_motion + "the body is damped", notes[2])
                self.assertNotIn(no_formulas, notes[2])
                self.assertNotIn("nan", table.texts("precession_period"))
                for name in compared:
                    cells = [text == "nan" for text in table.texts(name)]
                    self.assertEqual(cells, [False, True, True], name)
                for name in fast:
                    cells = [text == "nan" for text in table.texts(name)]
                    self.assertEqual(cells, [False, True, False], name)
        spinless = self.compute(
            scene, "initial.omega3=0", "output.columns=nutations_in_period", code=0
        )
        self.assertIn("no precession period T_p", spinless.texts("notes")[0])

    def test_a_turned_body_has_the_events_of_the_body_as_given(self) -> None:
        """A top about body x, turned inside, and one a little asymmetric, which is not."""
        scene = self.write(
            "&top mass = 1, inertia = 0.25, 0.875, 0.875, centre_of_mass = 0.8660254, 0, 0 /\n"
            "&initial theta = 1.1, phi = 0.2, psi = 0.4, phi_rate = 1,"
            " theta_rate = 0.3, psi_rate = 2 /\n"
            "&span t_end = 10 /\n"
            "&output columns = 't', 'theta', 'phi', 'psi', events = 'turning_points',\n"
            "    'azimuth_turns', 'psi = 0.4 every turn', 'phi = 1' /\n"
        )
        self.compute(scene)
        turned = self.events()
        self.compute(scene, "top.inertia(3)=0.87500000001")
        given = self.events()
        self.assertGreater(len(turned.rows), 30)
        self.assertEqual([row[:2] for row in turned.rows], [row[:2] for row in given.rows])
        for name in ("t", "theta", "phi", "psi"):
            for one, other in zip(turned.column(name), given.column(name), strict=True):
                self.assertAlmostEqual(one, other, delta=1e-6)

    def test_bad_events(self) -> None:
        """Place, problem and advice for each mistake."""
        mistakes = {
            "output.events=turning_point": "did you mean 'turning_points'?",
            "output.events=thta = 1": "did you mean 'theta'?",
            "output.events='theta = 1', 'theta = 1 rising'": "named twice",
            "span.stop_at=theta = x": "not a number: x",
            "span.stop_after=2": "there is no event to stop at",
        }
        scene = self.write()
        for setting, advice in mistakes.items():
            with self.subTest(setting):
                error = self.refuse(scene, "--set", setting)
                self.assertIn(advice, error)
                self.assertRegex(error, r"^--set:1:\d+: error: ")
        scene = self.write(GOOD.replace("t_end = 0.5", "t_end = 0.5\n    stop_at = 'thta = 1'"))
        self.assertRegex(self.refuse(scene), r"scene.nml:12:15: error: there is no column 'thta'")
        sweep = "&study kind = 'sweep' /\n&sweep parameter(1) = 'top.mass', values(1,:) = 1 /\n"
        scene = self.write(GOOD.split("&output")[0] + sweep)
        error = self.refuse(scene, "--set", "output.events=turning_points")
        self.assertIn("only a trajectory has a table of events", error)
        error = self.refuse(scene, "--set", "span.stop_at=orientation_error = 1")
        self.assertIn("needs the exact solution", error)


class BadInputTest(ProgramCase):
    """All errors are reported at once with their places, and nothing is written."""

    def refuse_text(self, text: str, *parts: str) -> str:
        """The program must refuse a text, and say all these parts."""
        error = self.refuse(self.write(text))
        for part in parts:
            self.assertIn(part, error)
        return error

    def test_diagnostics(self) -> None:
        """Each kind of mistake: the place, what is wrong, what would be right."""
        cases = {
            "unknown key": (
                ("mass =", "mas ="),
                "scene.nml:2:5: error: unknown key 'mas'",
                "'mass'",
            ),
            "unknown group": (("&initial", "&intial"), "scene.nml:6:1", "&intial", "'&initial'"),
            "wrong group": (
                ("t_end = 0.5", "t_end = 0.5\n    theta = 1"),
                "scene.nml:12:5",
                "theta",
                "&initial",
            ),
            "duplicate": (("mass = 1.0", "mass = 1.0\n    mass = 2.0"), "scene.nml:3:5", "mass"),
            "literal": (("mass = 1.0", "mass = 1.0.0"), "scene.nml:2:12", "1.0.0"),
            "decimal comma": (("t_end = 0.5", "t_end = 0,5"), "scene.nml:11:", "t_end"),
            "nan": (("t_end = 0.5", "t_end = nan"), "scene.nml:11:13", "nan"),
            "infinite": (("t_end = 0.5", "t_end = 1e999"), "scene.nml:11:13"),
            "no slash": (("/\n&span", "&span"), "scene.nml:", "initial", "/"),
            "out of range": (("mass = 1.0", "mass = -1.0"), "scene.nml:2:12", "mass", "> 0"),
            "angle": (("theta = 0.19634954084936207", "theta = 4"), "scene.nml:7:13", "theta"),
            "word": (("'rk4'", "'rk5'"), "scene.nml:15:14", "'rk5'", "did you mean 'rk"),
            "formulation": (("'lagrange'", "'lagrnge'"), "scene.nml:14:19", "'lagrange'"),
            "real steps": (("steps = 10", "steps = 10.5"), "scene.nml:16:13", "10.5"),
            "column": (("'theta', 'R4'", "'thetta', 'R4'"), "thetta", "'theta'"),
            "column twice": (("'theta', 'R4'", "'t', 'R4'"), "named twice"),
            "unphysical": (
                ("0.875, 0.875, 0.25", "0.875, 0.875, 2.25"),
                "scene.nml:3:29",
                "the largest exceeds the sum of the others",
            ),
            "no mass": (("mass = 1.0", "mass = 0"), "scene.nml:2:12", "> 0"),
            "mass no number": (("mass = 1.0", "mass = nan"), "scene.nml:2:12", "finite"),
            "too heavy": (("mass = 1.0", "mass = 1e308"), "&top", "outside the range of numbers"),
            "too fast": (("psi_rate = 1.0", "psi_rate = 1e200"), "&initial", "kinetic energy"),
            "upward gravity": (("mass = 1.0", "mass = 1.0, gravity = -1"), "scene.nml:2:", ">= 0"),
            "zero inertia": (("0.875, 0.875, 0.25", "0.875, 0.875, 0"), "scene.nml:3:"),
            "two moments": (("0.875, 0.875, 0.25", "0.875, 0.875"), "scene.nml:3:", "inertia"),
            "two ways": (("psi_rate = 1.0", "psi_rate = 1.0\n    omega3 = 1.0"), "given twice"),
            "two angles": (("psi_rate = 1.0", "theta_deg = 20.0"), "given twice"),
            "two spans": (("t_end = 0.5", "t_end = 0.5, nutations = 1"), "more than once"),
            "no span": (("t_end = 0.5", ""), "the time span is not given"),
            "samples": (
                ("t_end = 0.5", "t_end = 0.5, samples = 4"),
                "scene.nml:11:",
                "number of steps: 9",
                "number of samples: 3",
            ),
            "table": (
                ("'rk4'", "'arkode_erk', table = 'arkode_cash_karp_6_4_4'"),
                "'arkode_cash_karp_6_4_5'",
            ),
            "table of rk4": (("'rk4'", "'rk4', table = 'x'"), "does not use a Butcher table"),
            "slash": (("columns =", "file = 'a/b'\n    columns ="), "slash"),
        }
        for name, ((old, new), *parts) in cases.items():
            with self.subTest(name):
                self.assertIn(old, GOOD)
                error = self.refuse_text(GOOD.replace(old, new, 1), *parts)
                self.assertIn("error: ", error)
                self.assertRegex(error, r"\n +\| *\^|, not |not given|scene\.nml")

    def test_a_caret_marks_the_place(self) -> None:
        """The line, and below it a caret under the word."""
        error = self.refuse_text(GOOD.replace("mass =", "mas ="))
        lines = error.splitlines()
        place = next(i for i, line in enumerate(lines) if line == "2 |     mas = 1.0")
        self.assertTrue(lines[place + 1].startswith("  |     ^^^ "), lines[place + 1])

    def test_all_errors_at_once(self) -> None:
        """Many mistakes of every stage in one report, in the order in which they stand."""
        text = GOOD.replace("mass = 1.0", "mas = 1.0").replace("theta = 0.19", "theta = 9.19")
        text = text.replace("'rk4'", "'rk5'").replace("'R4'", "'R5'")
        error = self.refuse_text(text, "'mas'", "9.19", "rk5", "R5", "4 errors")
        places = [error.index(word) for word in ("'mas'", "9.19", "rk5", "R5")]
        self.assertEqual(places, sorted(places))

    def test_mistakes_of_meaning_are_told_together(self) -> None:
        """Body, start and span are checked although one of them is wrong."""
        text = GOOD.replace("0.875, 0.875, 0.25", "0.875, 0.875, 2.25")
        text = text.replace("psi_rate = 1.0", "psi_rate = 1.0, omega3 = 1.0")
        text = text.replace("t_end = 0.5", "t_end = 0.5, nutations = 1")
        self.refuse_text(text, "the largest exceeds", "the spin is given twice", "more than once")

    def test_sweeps(self) -> None:
        """Axes without parameter, values or sense."""
        sweep = GOOD.split("&output")[0] + "&study kind = 'sweep' /\n"
        cases = {
            "&sweep /": "a sweep needs an axis",
            "&sweep parameter(1) = 'top.lenght', values(1,:) = 1 /": "top.length",
            "&sweep parameter(1) = 'integration.method', values(1,:) = 1 /": "integration.method",
            "&sweep parameter(1) = 'top.length' /": "has no values",
            "&sweep parameter(1) = 'top.mass', values(1,:) = 1, -1 /": "top.mass",
            "&sweep parameter(1) = 'top.mass', values(1,:) = 1, from(1) = 2 /": "given twice",
            "&sweep parameter(1) = 'top.mass', from(1) = 0, to(1) = 1, count(1) = 3,"
            " spacing(1) = 'log' /": "positive ends",
            "&sweep parameter(2) = 'top.mass', values(2,:) = 1 /": "parameter(1)",
            "&sweep parameter = 'top.mass', 'top.mass', values(1,:) = 1,"
            " values(2,:) = 2 /": "on two axes",
            "&sweep parameter(1) = 'top.inertia(4)', values(1,:) = 1 /": "inertia",
            "&sweep parameter(1) = 'integration.steps', values(1,:) = 1.5 /": "steps",
        }
        for text, part in cases.items():
            with self.subTest(text):
                self.refuse_text(sweep + text + "\n", part)
        self.refuse_text(
            GOOD + "&sweep parameter(1) = 'top.mass', values(1,:) = 1 /\n",
            "a trajectory has no axes",
        )

    def test_files_that_are_no_input(self) -> None:
        """Missing, empty, a folder, binary."""
        self.assertIn("missing.nml", self.refuse("missing.nml"))
        self.refuse_text("", "scene.nml")
        (self.folder / "folder.nml").mkdir()
        self.refuse("folder.nml")
        (self.folder / "binary.nml").write_bytes(bytes(range(256)) * 20)
        self.refuse("binary.nml")

    def test_wrong_usage(self) -> None:
        """Options and topics that do not exist, values that make no sense."""
        scene = self.write()
        for arguments, part in (
            (["--outputt", "x"], "'--output'"),
            (["--threads", "0"], "--threads"),
            (["--threads", "two"], "--threads"),
            (["--threads"], "needs a value"),
            (["--set", "top.mas=1"], "mass"),
            (["--set", "top.mass"], "top.mass"),
            (["--set", "top.mass=x"], "mass"),
            (["--set", "span.nutations=2"], "more than once"),
            (["--check=yes"], "takes no value"),
            (["-o", ""], "empty"),
        ):
            with self.subTest(arguments):
                self.assertIn(part, self.refuse(scene, *arguments))
        self.assertIn("'methods'", self.refuse("list", "methdos"))
        self.assertIn("one topic", self.refuse("list", "methods", "cases"))
        self.assertIn("no input", self.refuse("--quiet"))

    def test_a_table_outlives_a_refused_input(self) -> None:
        """An invalid input overwrites nothing."""
        self.compute(self.write())
        before = (self.folder / "output/scene.csv").read_bytes()
        self.refuse_text(GOOD.replace("mass =", "mas ="), "mas")
        self.assertEqual((self.folder / "output/scene.csv").read_bytes(), before)

    def test_a_start_at_a_pole(self) -> None:
        """A status with its time, in a complete file, and exit code 3."""
        for form in ("lagrange", "euler"):
            for theta in ("0", "3.141592653589793"):
                text = GOOD.replace("theta = 0.19634954084936207", f"theta = {theta}")
                table = self.compute(self.write(text), f"integration.formulation={form}", code=3)
                self.assertEqual(table.last_line, "# status: pole at t = 0")
                self.assertEqual(table.names, ["t", "theta", "R4"])
        self.assertEqual(self.produced(), ["output", "output/scene.csv"])

    def test_the_exact_motion_knows_no_pole(self) -> None:
        """An upright start has no phi and psi, but a table without nan."""
        text = GOOD.replace("theta = 0.19634954084936207", "theta = 0").split("&integration")[0]
        table = self.compute(
            self.write(text), "output.columns=t,theta,q0,q3,energy", "span.samples=5"
        )
        self.assertEqual(table.column("theta"), [0.0] * 5)
        self.assertAlmostEqual(table.column("q3")[4], math.sin(0.25), 14)

    def test_used_up_steps(self) -> None:
        """The rows so far are kept."""
        for method in ("ode45", "arkode_erk", "arkode_dirk"):
            text = GOOD.replace("'rk4'", f"'{method}'").replace("    steps = 10\n", "")
            text = text.replace("t_end = 0.5", "t_end = 5")
            table = self.compute(self.write(text), "integration.max_steps=30", code=3)
            self.assertRegex(table.last_line, r"^# status: step_limit at t = \d\.\d+$")
            end = float(table.last_line.split()[-1])
            self.assertLess(end, 5)
            self.assertEqual(len(table.rows), int(end / 0.005 + 1e-9) + 1)
            self.assertGreater(len(table.rows), 2)
        self.assertEqual(self.produced(), ["output", "output/scene.csv"])

    def test_results_that_cannot_be_written(self) -> None:
        """A file where the folder should be, a folder where the table should be: exit code 4."""
        scene = self.write()
        (self.folder / "file").write_text("keep", encoding="utf-8")
        for folder in ("file", "file/below"):
            result = self.run_program(scene, "-o", folder)
            self.assertEqual(result.returncode, 4, result.stderr)
            self.assertIn("file", result.stderr)
        self.assertEqual((self.folder / "file").read_text(encoding="utf-8"), "keep")
        (self.folder / "output/scene.csv").mkdir(parents=True)
        result = self.run_program(scene)
        self.assertEqual(result.returncode, 4)
        self.assertEqual(self.produced(), ["file", "output", "output/scene.csv"])

    def test_a_full_disk(self) -> None:
        """A table that does not fit is an error, and leaves neither table nor part."""

        def limit() -> None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))

        result = self.run_program(self.write(), preexec_fn=limit)
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("scene.csv.part: File too large", result.stderr)
        self.assertEqual(self.produced(), ["output"])

    def test_a_disk_that_fills_up(self) -> None:
        """The same on the way, also while many samples of one step are written."""
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=2m", "none", disk]
        if (
            os.geteuid() != 0
            or subprocess.run(command, capture_output=True, check=False).returncode
        ):
            self.skipTest("takes root")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        rk4 = GOOD.replace("steps = 10", "steps = 100000")
        dense = GOOD.replace("'rk4'", "'ode45'").replace("    steps = 10\n", "")
        dense = dense.replace("t_end = 0.5", "t_end = 0.5, samples = 100001")
        for text in (rk4, dense):
            result = self.run_program(self.write(text), "-o", disk)
            self.assertEqual(result.returncode, 4, result.stderr)
            self.assertIn("scene.csv", result.stderr)
            self.assertEqual(list(disk.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
