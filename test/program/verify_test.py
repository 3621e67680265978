"""`spintop verify` on tables of all kinds: parts of sweeps, free bodies, damaged ones."""

import math
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "python")]

from program_test import ProgramCase  # noqa: E402

SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 30 /
&span t_end = 2.0 /
&output columns = 'theta_end', 'theta_end_bound', 'phi_end', 'psi_end', 'proof' /
&sweep parameter(1) = 'initial.psi_rate', values(1,:) = 0.2, 0.5, 3, 40 /
"""
FREE = """\
&study kind = 'trajectory' /
&top mass = 1.0, gravity = 0.0, inertia = 0.9, 1.3, 1.7, centre_of_mass = 0, 0, 0 /
&initial quaternion = 0.5, 0.5, -0.5, 0.5, omega = 0.3, -0.4, 1.1 /
&span t_end = 20.0, samples = 5 /
&output columns = 't', 'theta', 'q0', 'q1', 'q2', 'q3' /
"""
ABOUT_X = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.25, 0.875, 0.875, centre_of_mass = -0.8660254037844387, 0, 0 /
&initial theta_deg = 40, phi_rate = 0.3, omega3 = 2.0 /
&span t_end = 3.0, samples = 5 /
&output columns = 't', 'theta', 'theta_bound', 'q0', 'q1', 'q2', 'q3',
                  'orientation_bound', 'proof' /
"""
MISSING = "this build has no FLINT, which certifies digits"


class VerifyTest(ProgramCase):
    """With FLINT."""

    def setUp(self) -> None:
        super().setUp()
        check = self.run_program("--check", self.write(FREE), "--set", "output.certified=.true.")
        if MISSING in check.stderr:
            self.skipTest("this build has no FLINT")

    def verify(self, name: str, code: int = 0) -> str:
        """What is said of a table."""
        run = self.run_program("verify", f"output/{name}.csv")
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def put(self, name: str, text: str) -> None:
        """Write a table."""
        (self.folder / f"output/{name}.csv").write_text(text)

    def test_parts_of_a_sweep(self) -> None:
        scene = self.write(SWEEP)
        for part in ("1/3", "2/3", "3/3"):
            run = self.run_program("--shard", part, scene)
            self.assertEqual(run.returncode, 0, run.stderr)
        counted = [self.verify(f"scene.{i}-of-3").split()[1] for i in (1, 2, 3)]
        self.compute(scene)
        whole = self.verify("scene")
        self.assertIn(f"{sum(map(int, counted))} numbers proved, 0 unproved, 0 wrong", whole)

    def lines_of_table(self) -> list[str]:
        """The lines of the table, without the last one: an edited table has another checksum."""
        text = (self.folder / "output/scene.csv").read_text()
        lines = text.splitlines(keepends=True)
        self.assertTrue(lines[-1].startswith("# end: "))
        return lines[:-1]

    def test_free_body(self) -> None:
        """The quaternion is proved with its sign; phi and psi are with their turns."""
        scene = self.write(FREE)
        self.compute(scene)
        self.assertIn("25 numbers proved, 0 unproved, 0 wrong", self.verify("scene"))
        lines = self.lines_of_table()
        cells = lines[-2].split(",")
        lines[-2] = ",".join([*cells[:2], str(-float(cells[2])), *cells[3:]])
        self.put("turned", "".join(lines))
        self.assertIn("first wrong  row 5, q0 = ", self.verify("turned", code=3))
        self.compute(scene, "output.columns=t,theta,phi,psi")
        self.assertIn("15 numbers proved, 0 unproved, 0 wrong", self.verify("scene"))
        lines = self.lines_of_table()
        cells = lines[-2].split(",")
        lines[-2] = ",".join([*cells[:2], str(float(cells[2]) + 2 * math.pi), *cells[3:]])
        self.put("turned", "".join(lines))
        self.assertIn("first wrong  row 5, phi = ", self.verify("turned", code=3))

    def test_axis_x(self) -> None:
        """A top about body x that hangs: bounds, and certified numbers."""
        scene = self.write(ABOUT_X)
        table = self.compute(scene)
        self.assertEqual(set(table.texts("proof")), {"proved"})
        self.assertLess(table.largest("orientation_bound"), 1e-14)
        self.assertIn("25 numbers proved", self.verify("scene"))
        self.compute(scene, "output.certified=.true.", "integration.method=dop853")
        self.assertIn("25 numbers proved", self.verify("scene"))

    def test_inputs(self) -> None:
        """Those that come with the program and need FLINT."""
        certified = self.compute(self.scene("certified_top"))
        self.assertIn("707 numbers proved, 0 unproved, 0 wrong", self.verify("certified_top"))
        self.assertLess(certified.largest("theta_bound"), 4e-16)
        uncertain = self.compute(self.scene("uncertain_top"))
        self.assertLess(uncertain.largest("orientation_bound"), 1e-3)
        self.assertGreater(uncertain.largest("orientation_bound"), 1e-4)
        self.assertIn(" 0 wrong", self.verify("uncertain_top"))

    def test_uncertainty_of_what_is_not_given(self) -> None:
        for radius, words in (
            ("uncertainty.initial.theta=1e-9", "the attitude is given by a quaternion"),
            ("uncertainty.initial.phi_rate=1e-9", "the angular velocity is given by omega"),
        ):
            settings = ["--set", radius, "--set", "output.columns=t,theta,theta_bound"]
            run = self.run_program("--check", self.write(FREE), *settings)
            self.assertEqual(run.returncode, 2)
            self.assertIn(words, run.stderr)

    def test_effects(self) -> None:
        """A rotor, by the exact solution on the axis, integrated on another; no dry friction."""
        for effect, largest in (
            ("rotor_momentum = 0.1, 0, 0", 1e-14),
            ("rotor_momentum = 0, 0, 0.1", 1e-8),  # the error of the integration
            ("friction_torque = 0.01", math.inf),
        ):
            effects = f"&effects {effect} /\n&span"
            scene = self.write(ABOUT_X.replace("&span", effects), "rotor.nml")
            self.assertEqual(self.run_program(scene).returncode, 0)
            word = "proved" if largest < 1 else "unproved"
            self.assertEqual(set(self.table("rotor").texts("proof")), {word})
            if word == "proved":
                self.assertLess(self.table("rotor").largest("orientation_bound"), largest)
                proved = 25 if largest < 1e-10 else 5  # of the others nothing is claimed
                self.assertIn(f"{proved} numbers proved, {25 - proved} unp", self.verify("rotor"))

    def test_other_versions(self) -> None:
        """A table of another version is verified as long as its input is understood."""
        self.compute(self.write(FREE))
        text = (self.folder / "output/scene.csv").read_text()
        first = next(line for line in text.splitlines() if line.startswith("# program: "))
        self.put("older", text.replace(first, "# program: spintop 0.0.1"))
        self.assertIn("0 wrong", self.verify("older"))
        self.put("newer", text.replace("omega = ", "spin_vector = "))
        self.assertIn("unknown key 'spin_vector'", self.verify("newer", code=2))

    def test_edited_sweeps(self) -> None:
        """Wrong: no number, bound, proof, parameter, or rows that are not those of the input."""
        scene = self.write(SWEEP)
        self.compute(scene)
        lines = self.lines_of_table()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        names = lines[first].strip().split(",")
        rows = lines[first + 1 :]

        def edited(row: int, name: str, cell: str) -> list[str]:
            cells = rows[row].split(",")
            cells[names.index(name)] = cell
            return [*rows[:row], ",".join(cells), *rows[row + 1 :]]

        for name, changed, words in (
            ("nan", edited(1, "theta_end", "nan"), "row 2, theta_end = nan: not a finite number"),
            ("inf", edited(0, "theta_end", "inf"), "row 1, theta_end = inf: not a"),
            ("bound", edited(2, "theta_end_bound", "nan"), "row 3, theta_end_bound is nan"),
            ("unproved", edited(0, "proof", "unproved"), "row 1, proof = unproved: its bounds"),
            ("none", edited(0, "proof", "none"), "row 1, proof = none: its bounds"),
            ("infinite", edited(3, "theta_end_bound", "inf"), "row 4, proof = proved: its bounds"),
            (
                "value",
                edited(3, "initial.psi_rate", "7"),
                "row 4, initial.psi_rate = 7: the case has 40",
            ),
            ("shorter", rows[:-1], "3 rows, where the input has 4 cases"),
            ("hole", [rows[0], *rows[2:]], "3 rows, where the input has 4 cases"),
            ("doubled", [rows[0], *rows], "5 rows, where the input has 4 cases"),
            ("order", [rows[1], rows[0], *rows[2:]], "row 1, case = 2: not the case 1"),
            ("same", [rows[0], rows[0], *rows[2:]], "row 2, case = 1: not the case 2"),
            ("empty", [], "0 rows, where the input has 4 cases"),
        ):
            with self.subTest(name):
                self.put(name, "".join([*lines[: first + 1], *changed]))
                self.assertIn(f"first wrong  {words}", self.verify(name, code=3))

    def test_edited_trajectories(self) -> None:
        """Rows are at their times, all of them, and an attitude is a number."""
        self.compute(self.write(FREE))
        lines = self.lines_of_table()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        head, rows, status = lines[: first + 1], lines[first + 1 : -1], lines[-1:]
        for name, changed, words in (
            ("cut", rows, "the table is cut short: it has no status"),
            ("hole", [*rows[:2], *rows[3:], *status], "4 rows, where the input asks for 5"),
            ("none", status, "0 rows, where the input asks for 5"),
            ("doubled", [rows[0], *rows, *status], "6 rows, where the input asks for 5"),
            ("same", [*rows[:2], rows[1], *rows[3:], *status], "row 3, t = 5: not after"),
            (
                "time",
                [rows[0], rows[1].replace("5,", "4,", 1), *rows[2:], *status],
                "row 2, t = 4: not a",
            ),
            (
                "nan",
                [*rows[:4], "20,nan" + rows[4][rows[4].index(",", 3) :], *status],
                "row 5, theta = nan",
            ),
        ):
            with self.subTest(name):
                self.put(name, "".join([*head, *changed]))
                self.assertIn(f"first wrong  {words}", self.verify(name, code=3))
        early = FREE.replace("samples = 5", "samples = 5, stop_at = 'theta = 1.2'")
        self.compute(self.write(early, "early.nml"))
        self.assertIn(" 0 wrong", self.verify("early"))

    def test_damaged_tables(self) -> None:
        self.compute(self.write(FREE))
        text = (self.folder / "output/scene.csv").read_text()
        rows = [line for line in text.splitlines(keepends=True) if not line.startswith("#")]
        for name, damaged, words in (
            ("short", text[: text.index(rows[-1]) + 30], "a row has a cell for each column"),
            ("word", text.replace("\n0,", "\nnone,"), "is not a number"),
            ("bare", "".join(rows), "the file has no group"),
            ("empty", "", "the file has no group"),
            ("wide", text.replace("\n0,", "\n0,1,"), "more cells than"),
        ):
            with self.subTest(name):
                self.put(name, damaged)
                self.assertIn(words, self.verify(name, code=2))
