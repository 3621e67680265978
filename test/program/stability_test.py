"""The stability study: its table, its verdicts, what it refuses."""

import csv
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]
VERDICTS = {"accurate", "drifts", "wrong", "failed", "unsuitable", "no_reference"}


class StabilityTest(unittest.TestCase):
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

    def study(self, cases: str, methods: str) -> dict[tuple[str, str, str], dict[str, str]]:
        """The rows of a study by case, method and formulation."""
        result = self.run_program(
            str(ROOT / "input" / "stability.nml"),
            f"--set=stability.cases={cases}",
            f"--set=stability.methods={methods}",
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        with (self.folder / "stability.csv").open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        for row in rows:
            self.assertIn(row["verdict"], VERDICTS)
        return {(row["case"], row["method"], row["formulation"]): row for row in rows}

    def test_verdicts(self) -> None:
        """A good method is accurate, a poor one wrong, one with poles gives up at them."""
        rows = self.study(
            "slow_top,through_upright,intermediate_axis", "euler_forward,taylor,dop853/lagrange"
        )
        self.assertEqual(len(rows), 9)
        good = rows["slow_top", "taylor", "space_frame"]
        self.assertEqual(good["verdict"], "accurate")
        self.assertEqual(good["reference"], "exact solution")
        self.assertLess(float(good["orientation_error"]), 1e-9)
        self.assertEqual(good["reason"], "")
        poor = rows["slow_top", "euler_forward", "space_frame"]
        self.assertEqual(poor["verdict"], "wrong")
        self.assertGreater(float(poor["orientation_error"]), 0.1)
        self.assertIn("orientation error", poor["reason"])
        stuck = rows["through_upright", "dop853", "lagrange"]
        self.assertEqual((stuck["verdict"], stuck["status"]), ("failed", "pole"))
        self.assertIn("pole", stuck["reason"])
        free = rows["intermediate_axis", "taylor", "rigid_body"]
        self.assertEqual(free["verdict"], "accurate")
        self.assertEqual(free["reference"], "exact solution")
        self.assertEqual(rows["intermediate_axis", "dop853", "lagrange"]["verdict"], "unsuitable")

    def test_growth_of_sleeping_tops(self) -> None:
        """Upright growth rates change from zero to positive at the threshold."""
        rows = self.study("sleeping_above,sleeping_below", "taylor")
        above = float(rows["sleeping_above", "taylor", "space_frame"]["upright_growth"])
        below = float(rows["sleeping_below", "taylor", "space_frame"]["upright_growth"])
        self.assertLess(abs(above), 1e-6)
        # sqrt(4 I1 mgl - (I3 omega3)^2)/(2 I1)
        self.assertAlmostEqual(below, (4 * 0.875 * 8.495709211125343 - 3.75**2) ** 0.5 / 1.75, 9)

    def test_own_case(self) -> None:
        """The input's own case takes its place among those of the catalogue."""
        scene = self.folder / "own.nml"
        scene.write_text(
            "&study kind = 'stability' /\n"
            "&top mass = 1, inertia = 1, 1.2, 0.5, length = 0.5 /\n"
            "&initial theta = 0.5, omega3 = 10 /\n&span t_end = 3 /\n"
            "&stability cases = 'input', methods = 'dop853', 'splitting_8' /\n"
        )
        result = self.run_program(str(scene))
        self.assertEqual(result.returncode, 0, result.stderr)
        with (self.folder / "own.csv").open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.assertEqual([row["case"] for row in rows], ["input", "input"])
        self.assertEqual({row["verdict"] for row in rows}, {"accurate"})
        self.assertEqual(rows[1]["steps"], "8000")

    def test_a_case_without_a_reference(self) -> None:
        """Its rows have the status of its reference; those of the other cases stay."""
        scene = self.folder / "own.nml"
        scene.write_text(
            "&study kind = 'stability' /\n"
            "&top mass = 1, inertia = 1, 1.2, 0.5, length = 0.5 /\n"
            "&initial theta = 0.5, omega3 = 10 /\n&span t_end = 3 /\n"
            "&integration max_steps = 3 /\n"
            "&stability cases = 'input', 'slow_top', methods = 'dop853', 'taylor' /\n"
        )
        result = self.run_program(str(scene))
        self.assertEqual(result.returncode, 3, result.stderr)
        with (self.folder / "own.csv").open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.assertEqual([row["case"] for row in rows], ["input", "input", "slow_top", "slow_top"])
        for row in rows[:2]:
            self.assertEqual((row["verdict"], row["status"]), ("no_reference", "step_limit"))
            self.assertEqual(row["orientation_error"], "nan")
            self.assertIn("no reference: the maximum number of steps", row["reason"])
        self.assertEqual({row["verdict"] for row in rows[2:]}, {"accurate"})
        self.assertIn("1 no_reference", result.stdout)

    def test_the_exponent_takes_no_more_than_the_work_allowed(self) -> None:
        """A motion of too many steps has no reference; the exact solution needs no steps."""
        scene = self.folder / "long.nml"
        scene.write_text(
            "&study kind = 'stability' /\n"
            "&top mass = 1, inertia = 1, 1, 0.5, length = 0.5 /\n"
            "&initial theta = 0.5, omega3 = 10 /\n&span t_end = 30 /\n"
            "&stability cases = 'input', methods = 'taylor' /\n"
        )
        for steps, has_one in (("1000", True), ("15", False)):
            result = self.run_program(str(scene), f"--set=integration.max_steps={steps}")
            self.assertEqual(result.returncode, 0 if has_one else 3, result.stderr)
            self.assertEqual("failed    all 1 runs: 1 step_limit" in result.stdout, not has_one)
            with (self.folder / "long.csv").open() as file:
                rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
            self.assertEqual(rows[0]["lyapunov_exponent"] != "nan", has_one)

    def test_unknown_names(self) -> None:
        """Names that are not there are refused, with the nearest."""
        for key, name, hint in (
            ("cases", "slow_tip", "slow_top"),
            ("methods", "taylr", "taylor"),
            ("methods", "taylor/lagrang", "lagrange"),
        ):
            with self.subTest(name):
                result = self.run_program(
                    str(ROOT / "input" / "stability.nml"), f"--set=stability.{key}={name}"
                )
                self.assertEqual(result.returncode, 2)
                self.assertIn(f"did you mean '{hint}'", result.stderr)
        for key, value in (("method", "rk4"), ("formulation", "euler")):
            with self.subTest(key=key):
                result = self.run_program(
                    str(ROOT / "input" / "stability.nml"), f"--set=integration.{key}={value}"
                )
                self.assertEqual(result.returncode, 2)
                self.assertIn("a stability study compares methods and formulations", result.stderr)

    def test_catalogue_is_listed(self) -> None:
        """Every case that runs by default is listed, and some more."""
        result = subprocess.run([EXE, "list", "cases", "--json"], capture_output=True)
        names = [case["name"] for case in json.loads(result.stdout)["cases"]]
        self.assertGreater(len(names), 20)
        self.assertIn("million_nutations", names)
        self.assertEqual(len(names), len(set(names)))


if __name__ == "__main__":
    unittest.main()
