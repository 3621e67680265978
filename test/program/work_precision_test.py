"""The work-precision study: its table, its summary, what it refuses."""

import csv
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]
SLOW_TOP = str(ROOT / "input" / "work_precision_slow_top.nml")
SKEW = """
&study kind = 'work_precision' /
&top mass = 1  inertia = 1, 1.5, 2.25  centre_of_mass = 0.1, 0.05, 0.2 /
&initial quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1 /
&span t_end = 5 /
"""

Row = dict[str, str]


class WorkPrecisionCase(unittest.TestCase):
    """Runs of the program on small studies."""

    def setUp(self) -> None:
        """Make a folder for the results."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, *arguments: str) -> subprocess.CompletedProcess:
        """Run the program."""
        return subprocess.run(
            [EXE, *arguments, "-o", self.folder], capture_output=True, text=True, timeout=1200
        )

    def write(self, text: str) -> str:
        """An input of the test's own."""
        path = self.folder / "own.nml"
        path.write_text(text)
        return str(path)

    def rows(self, name: str) -> list[Row]:
        """The rows of a table."""
        with (self.folder / name).open() as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def study(self, scene: str, methods: str, *settings: str, code: int = 0) -> list[Row]:
        """The rows of a study, and in self.summary what the program says of it."""
        arguments = [f"--set=work_precision.{setting}" for setting in settings]
        result = self.run_program(scene, f"--set=work_precision.methods={methods}", *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.summary = result.stdout
        return self.rows(Path(scene).stem + ".csv")


def of(rows: list[Row], method: str) -> dict[str, Row]:
    """The rows of a method by setting."""
    return {row["setting"]: row for row in rows if row["method"] == method}


class TableTest(WorkPrecisionCase):
    """The contents of the rows."""

    def test_errors_costs_and_order(self) -> None:
        """Errors fall as the order of a method says, costs grow, rows are sorted by time."""
        rows = self.study(
            SLOW_TOP,
            "exact,taylor,splitting_2,dop853/lagrange",
            "tolerances=1e-6,1e-9,1e-12",
            "steps=800,1600,3200",
        )
        self.assertEqual(len(rows), 10)
        times = [float(row["time_s"]) for row in rows]
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[0], 0)
        self.assertEqual({row["status"] for row in rows}, {"ok"})
        self.assertEqual({row["problem"] for row in rows}, {"work_precision_slow_top"})

        steps = of(rows, "splitting_2")
        for column in ("orientation_error", "error_max", "theta_error_max"):
            coarse, fine = (float(steps[f"steps {n}"][column]) for n in (1600, 3200))
            self.assertAlmostEqual(math.log2(coarse / fine), 2, delta=0.1, msg=column)
        self.assertEqual(steps["steps 800"]["steps"], "800")
        self.assertGreaterEqual(int(steps["steps 800"]["evaluations"]), 800)

        series = of(rows, "taylor")
        errors = [float(series[f"tolerance {t}"]["error_max"]) for t in ("1e-06", "1e-09", "1e-12")]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertLess(errors[-1], 1e-10)
        self.assertEqual(series["tolerance 1e-12"]["formulation"], "space_frame")

        exact = of(rows, "exact")["-"]
        self.assertEqual((exact["formulation"], exact["steps"]), ("closed_form", "0"))
        self.assertGreater(float(exact["error_max"]), 0)
        self.assertLess(float(exact["error_max"]), 1e-13)
        self.assertEqual(exact["reference"], "quadruple precision")
        self.assertLess(float(exact["reference_error"]), 1e-15)
        self.assertLess(float(exact["reference_check"]), 1e-13)

    def test_steps_alone(self) -> None:
        """Without tolerances methods use a fixed step size if they can; their errors decrease."""
        rows = self.study(SLOW_TOP, "taylor,dop853/lagrange", "steps=200,400")
        self.assertEqual(set(of(rows, "dop853")), {"steps 200", "steps 400"})
        self.assertIn("tolerance 1e-06", of(rows, "taylor"))
        coarse, fine = (float(of(rows, "dop853")[f"steps {n}"]["error_max"]) for n in (200, 400))
        self.assertGreater(coarse / fine, 2**4)

    def test_runs_that_fail(self) -> None:
        """Where all do, or some, the summary begins with it; steps that are given need no limit."""
        scene = self.write(
            "&study kind = 'work_precision' /\n"
            "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.866 /\n"
            "&initial theta_deg = 10, omega3 = 20 /\n&span nutations = 20 /\n"
            "&integration max_steps = 300 /\n"
        )
        for tolerances, methods, code, failed in (
            ("1e-12,1e-13", "dop853", 3, "all 2 runs: 2"),
            ("1e-3,1e-12", "dop853", 0, "1 of 2 runs: 1"),
            ("1e-12,1e-13", "dop853,rk4", 0, "2 of 3 runs: 2"),
        ):
            with self.subTest(tolerances, methods=methods):
                rows = self.study(
                    scene, methods, f"tolerances={tolerances}", "steps=4000", code=code
                )
                second = self.summary.splitlines()[1]
                self.assertTrue(second.startswith(f"  failed    {failed} step_limit"), second)
                self.assertIn("; increase integration.max_steps", second)
                status = {row["setting"]: row["status"] for row in rows}
                self.assertEqual(status.get("steps 4000", "ok"), "ok")

    def test_front(self) -> None:
        """A row is on the front if no stepping method is as fast and as exact."""
        rows = self.study(SLOW_TOP, "taylor,rk4,splitting_4,dop853", "steps=100,400,1600")
        for row in rows:
            better = [
                other
                for other in rows
                if float(other["time_s"]) < float(row["time_s"])
                and float(other["error_max"]) <= float(row["error_max"])
            ]
            self.assertEqual(row["front"], "no" if better else "yes")

    def test_what_auto_takes(self) -> None:
        """Rows of the method that would be chosen for their tolerance are marked."""
        rows = self.study(self.write(SKEW), "taylor,dop853,rk4", "tolerances=1e-6", "steps=100")
        self.assertEqual([r["method"] for r in rows if r["auto"] == "yes"], ["taylor"])
        self.assertIn("auto      takes no more than 2 times", self.summary)
        rows = self.study(SLOW_TOP, "exact,taylor", "tolerances=1e-6")
        self.assertEqual([r["method"] for r in rows if r["auto"] == "yes"], ["exact"])
        rows = self.study(
            SLOW_TOP, "ode45,dop853,rk4", "formulations=lagrange", "tolerances=1e-3,1e-9"
        )
        chosen = {(r["method"], r["setting"]) for r in rows if r["auto"] == "yes"}
        self.assertEqual(chosen, {("dop853", f"tolerance {x}") for x in ("0.001", "1e-09")})

    def test_errors_of_columns_are_those_of_trajectories(self) -> None:
        """The last rows of two trajectories differ by what the study says."""
        row = self.study(SLOW_TOP, "dop853/lagrange", "tolerances=1e-6")[0]
        ends = []
        for method in (
            "--set=integration.method=exact",
            "--set=integration.relative_tolerance=1e-6",
        ):
            more = []
            if "exact" not in method:
                more = ["--set=integration.method=dop853", "--set=integration.formulation=lagrange"]
            columns = "output.columns=phi,theta,psi,phi_rate,theta_rate,psi_rate,energy_error"
            result = self.run_program(
                SLOW_TOP, method, *more, "--set=study.kind=trajectory", f"--set={columns}",
                "--set=output.file=motion.csv", "--set=span.samples=101",
            )  # fmt: skip
            self.assertEqual(result.returncode, 0, result.stderr)
            ends.append(self.rows("motion.csv")[-1])
        for name in ("phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate"):
            difference = abs(float(ends[0][name]) - float(ends[1][name]))
            self.assertAlmostEqual(difference / float(row[f"{name}_error"]), 1, delta=1e-5)

    def test_any_body(self) -> None:
        """Without an exact motion the reference says how far two methods agree on it."""
        rows = self.study(self.write(SKEW), "exact,taylor,rkmk_4", "tolerances=1e-12", "steps=400")
        self.assertEqual({row["method"] for row in rows}, {"taylor", "rkmk_4"})
        self.assertIn("exact/", self.summary)
        self.assertIn("omitted", self.summary)
        self.assertLess(float(rows[0]["reference_error"]), 1e-14)
        self.assertLess(float(rows[0]["reference_check"]), 1e-12)
        self.assertLess(float(of(rows, "taylor")["tolerance 1e-12"]["error_max"]), 1e-10)
        self.assertIn("dop853 agrees", self.summary)

    def test_stored_reference(self) -> None:
        """A trajectory that was stored gives the errors that the exact motion gives."""
        columns = "output.columns=q0,q1,q2,q3,t,omega1,omega2,omega3,theta"
        result = self.run_program(
            SLOW_TOP, "--set=study.kind=trajectory", f"--set={columns}", "--set=span.samples=41",
            "--set=output.file=stored.csv",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        settings = ("steps=400,800", "tolerances=1e-8")
        stored = f"reference={self.folder / 'stored.csv'}"
        rows = self.study(SLOW_TOP, "taylor,rk4", *settings, stored)
        self.assertEqual({row["reference"] for row in rows}, {"stored.csv"})
        direct = self.study(SLOW_TOP, "taylor,rk4", *settings, "reference=exact")
        for method, setting in (("rk4", "steps 800"), ("taylor", "tolerance 1e-08")):
            left, right = of(rows, method)[setting], of(direct, method)[setting]
            for column in ("orientation_error", "theta_error"):
                ratio = float(left[column]) / float(right[column])
                self.assertAlmostEqual(ratio, 1, delta=1e-4)

    def test_swept_problems(self) -> None:
        """Each case of a sweep is a problem, with its parameters beside it."""
        result = self.run_program(
            SLOW_TOP, "--set=work_precision.methods=taylor,rk4", "--set=work_precision.steps=100",
            "--set=work_precision.tolerances=1e-6", "--set=sweep.parameter=initial.theta",
            "--set=sweep.from=0.2", "--set=sweep.to=0.6", "--set=sweep.count=3",
        )  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = self.rows("work_precision_slow_top.csv")
        self.assertEqual(len(rows), 6)
        tilts = {row["problem"]: float(row["initial.theta"]) for row in rows}
        names = [f"work_precision_slow_top.{k}" for k in (1, 2, 3)]
        self.assertEqual([round(tilts[name], 12) for name in names], [0.2, 0.4, 0.6])

    def test_what_gives_up_has_no_errors(self) -> None:
        """A method that stops is a row with its status, and others go on."""
        pole = SKEW.replace("0.8, 0.6, 0, 0", "1, 0, 0, 0").replace("1, 1.5, 2.25", "1, 1, 0.5")
        pole = pole.replace("0.1, 0.05, 0.2", "0, 0, 0.2")
        rows = self.study(
            self.write(pole), "taylor,dop853/lagrange,rkmk_4/lagrange", "tolerances=1e-9"
        )
        stuck = of(rows, "dop853")["tolerance 1e-09"]
        self.assertEqual(stuck["status"], "pole")
        self.assertEqual((stuck["error_max"], stuck["tip_error"]), ("nan", "nan"))
        self.assertEqual(stuck["front"], "no")
        self.assertLess(float(of(rows, "taylor")["tolerance 1e-09"]["error_max"]), 1e-6)
        self.assertIn("rkmk_4/lagrange: integration.formulation", self.summary)

    def test_a_tolerance_too_fine_leaves_out_no_other(self) -> None:
        """Settings that a method cannot keep are omitted with one message; others have rows."""
        rows = self.study(SLOW_TOP, "taylor", "tolerances=1e-31,1e-6,1e-21,1e-9")
        self.assertEqual(set(of(rows, "taylor")), {"tolerance 1e-06", "tolerance 1e-09"})
        self.assertEqual(self.summary.count("omitted"), 1)
        rows = self.study(SLOW_TOP, "taylor", "tolerances=1e-31", code=3)
        self.assertEqual(rows, [])
        self.assertIn("has no rows", self.summary)

    def test_settings_of_integration_go_to_those_who_take_them(self) -> None:
        """The exact motion takes none of them, explicit methods no solver."""
        scene = (
            Path(SLOW_TOP).read_text()
            + "&integration absolute_tolerance = 1e-13 solver = 'fixed_point' project = 'unit' /\n"
        )
        rows = self.study(self.write(scene), "exact,rk4,gauss_4", "steps=100")
        self.assertEqual({row["method"] for row in rows}, {"exact", "rk4", "gauss_4"})
        self.assertNotIn("omitted", self.summary)

    def test_a_body_at_rest_without_weight(self) -> None:
        """Has neither energy nor momentum, and no error of them."""
        rest = SKEW.replace("0.5, 0.5, 1 /", "0, 0, 0 /")
        rows = self.study(
            self.write(rest.replace("top mass", "top gravity = 0  mass")), "taylor,rk4"
        )
        self.assertEqual({row["energy_error"] for row in rows}, {"0"})
        self.assertEqual({row["lz_error"] for row in rows}, {"0"})

    def test_in_a_pole_phi_and_psi_have_no_errors(self) -> None:
        """The axis of a sleeping top stays in it."""
        top = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.5 /\n"
        scene = top + "&initial theta = 0  psi_rate = 25 /\n&span t_end = 1 /\n"
        scene = self.write("&study kind = 'work_precision' /\n" + scene)
        for row in self.study(scene, "taylor,exact,rk4", "tolerances=1e-9", "steps=400"):
            self.assertEqual(row["status"], "ok")
            self.assertLess(float(row["orientation_error"]), 1e-3)
            self.assertLess(float(row["theta_error"]), 1e-6)
            for name in ("phi_error", "psi_error", "phi_rate_error", "psi_error_max"):
                self.assertEqual(row[name], "nan", (row["method"], name))

    def test_angles_are_those_of_the_attitude(self) -> None:
        """A pendulum passes the vertical, where Lagrange's angle theta leaves its range."""
        swing = SKEW.replace("1, 1.5, 2.25", "1, 1, 0.5").replace("0.1, 0.05, 0.2", "0, 0, 0.2")
        swing = swing.replace("quaternion = 0.8, 0.6, 0, 0  omega = 0.5, 0.5, 1", "theta_deg = 45")
        rows = self.study(self.write(swing), "dop853/lagrange", "tolerances=1e-10")
        self.assertEqual(rows[0]["status"], "ok")
        for name in ("phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate"):
            self.assertLess(float(rows[0][f"{name}_error_max"]), 1e-6, name)

    def test_a_reference_that_cannot_be_checked(self) -> None:
        """The exact motion of a long span is there though no method comes to the end of it."""
        scene = Path(SLOW_TOP).read_text().replace("t_end = 6.66 ", "t_end = 1e9 ")
        scene += "&integration max_steps = 1000 /\n"
        rows = self.study(self.write(scene), "taylor", "tolerances=1e-9", "reference=exact", code=3)
        self.assertEqual([row["status"] for row in rows], ["step_limit"])
        self.assertEqual(rows[0]["reference_check"], "nan")
        self.assertIn("could not be checked", self.summary)

    def test_a_reference_beyond_the_work_allowed(self) -> None:
        """The motion in quadruple precision takes no more steps than any other."""
        scene = self.write(SKEW + "&integration max_steps = 3 /\n")
        methods = "work_precision.methods=rk4"
        command = [
            EXE,
            scene,
            "--set",
            methods,
            "--set",
            "work_precision.steps=2",
            "-o",
            self.folder,
        ]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("has no reference: the maximum number of steps", run.stdout + run.stderr)


class SummaryTest(WorkPrecisionCase):
    """The summary in words."""

    def test_cheapest(self) -> None:
        """The sentence names the fastest of the rows that are exact enough."""
        rows = self.study(SLOW_TOP, "exact,taylor,rk4", "tolerances=1e-4,1e-8", "steps=800")
        enough = [r for r in rows if r["method"] != "exact" and float(r["error_max"]) <= 1e-6]
        best = min(enough, key=lambda row: float(row["time_s"]))
        name = f"{best['method']}/{best['formulation']}, {best['setting']}"
        self.assertIn(f"for 1e-06 the cheapest is {name}: ", self.summary)
        self.assertIn("for 1e-12 no method is accurate enough", self.summary)
        self.assertIn("the exact solution takes ", self.summary)
        table = (self.folder / "work_precision_slow_top.csv").read_text()
        self.assertIn(f"\n# in words: for 1e-06 the cheapest is {name}: ", table)
        self.assertIn("\n# in words: auto: takes no more than 2 times", table)


class BadInputTest(WorkPrecisionCase):
    """Inputs that are refused before anything is computed."""

    def test_refusals(self) -> None:
        """Each names what is wrong."""
        for settings, part in (
            (["work_precision.methods=tailor"], "did you mean 'taylor'"),
            (["work_precision.methods=rk4/lagrang"], "did you mean 'lagrange'"),
            (["work_precision.methods=rk4", "span.samples=8"], "7 intervals do not divide 100"),
            (["integration.method=rk4"], "compares methods"),
            (["integration.relative_tolerance=1e-3"], "varies the tolerance"),
            (["output.columns=t"], "the columns of this study are fixed"),
            (["work_precision.reference=nothing.csv"], "nothing.csv: No such file"),
            (["work_precision.repeats=0"], "work_precision.repeats"),
            (["work_precision.tolerances=2"], "work_precision.tolerances"),
            (["span.stop_at=maximum"], "to the end of its span"),
            (["output.events=turning_points"], "only a trajectory has a table of events"),
            (
                [
                    "sweep.parameter=integration.steps",
                    "sweep.from=10",
                    "sweep.to=20",
                    "sweep.count=2",
                ],
                "varies the steps",
            ),
            (
                [
                    "sweep.parameter=work_precision.repeats",
                    "sweep.from=1",
                    "sweep.to=2",
                    "sweep.count=2",
                ],
                "work_precision.repeats cannot vary",
            ),
        ):
            arguments = [f"--set={setting}" for setting in settings]
            result = self.run_program(SLOW_TOP, *arguments)
            self.assertEqual(result.returncode, 2, settings)
            self.assertIn(part, result.stderr)
        result = self.run_program(self.write(SKEW), "--set=work_precision.reference=exact")
        self.assertEqual(result.returncode, 2)
        self.assertIn("no exact solution", result.stderr)

    def test_tables_that_are_no_reference(self) -> None:
        """A table must have the columns, the times and the start of the motion."""
        head = "t,q0,q1,q2,q3,omega1,omega2,omega3\n"
        row = "0,0.995184726672197,0.098017140329561,0,0,0,0,1\n"
        for text, part in (
            ("t,q0\n0,1\n", "no column q1"),
            (head + row, "1 rows"),
            (head + row + "7,1,0,0,0,0,0,1\n", "row 2 of the table is for t = 7"),
            (head + row + "6.66,1,0,0,1,0,0,1\n", "whose norm is not 1"),
            (head + row.replace("0,1\n", "0,2\n") + "6.66,1,0,0,0,0,0,1\n", "has another start"),
            (head + row + "6.66,1,0,0,x,0,0,1\n", "x"),
            (head + row + "6.66,1,0\n", "the row ends before q2"),
            ("", "the table is empty"),
        ):
            table = self.folder / "reference.csv"
            table.write_text(text)
            result = self.run_program(SLOW_TOP, f"--set=work_precision.reference={table}")
            self.assertEqual(result.returncode, 2, text)
            self.assertIn(part, result.stderr)


if __name__ == "__main__":
    unittest.main()
