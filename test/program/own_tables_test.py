"""Methods of Butcher tables that a user gives in files: orders, messages, checksums."""

import math

import pytest

from program_test import ProgramCase

TOP = (
    "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.866 /\n"
    "&initial theta_deg = 10, omega3 = 20 /\n&span t_end = 1 /\n"
)
STUDY = TOP + "&study kind = 'work_precision' /\n&work_precision methods = {} repeats = 1 {} /\n"
EIGHTHS = """\
# The 3/8 rule
order 4
0   |
1/3 |  1/3
2/3 | -1/3  1
1   |  1 -1  1
    | 1/8 3/8 3/8 1/8
"""
RADAU = """\
order 3
1/3 | 5/12 -1/12
1   | 3/4   1/4
    | 3/4   1/4
"""
PAIR = """\
order 3 2
0   |
1/2 | 1/2
3/4 | 0 3/4
1   | 2/9 1/3 4/9
    | 2/9 1/3 4/9 0
    | 7/24 1/4 1/3 1/8
"""
DIAGONAL = """\
order 2
0.2928932188134524756 | 0.2928932188134524756
1 | 0.7071067811865475244 0.2928932188134524756
  | 0.7071067811865475244 0.2928932188134524756
"""


class OwnTablesTest(ProgramCase):
    """Tables beside an input."""

    def test_orders(self) -> None:
        """Each kind of table has its order, or its tolerance."""
        tables = {"eighths": EIGHTHS, "pair": PAIR, "diagonal": DIAGONAL}
        for name, text in tables.items():
            self.write(text, f"{name}.txt")
        names = ", ".join(f"'table:{name}.txt'" for name in tables)
        settings = "steps = 800, 1600, tolerances = 1e-4, 1e-6"
        scene = self.write(STUDY.format(names + ", 'table:pair.txt/rigid_body'", settings))
        table = self.compute(scene)
        self.assertEqual(set(table.texts("status")), {"ok"})
        found = zip(
            table.texts("method"),
            table.texts("formulation"),
            table.texts("setting"),
            table.column("orientation_error"),
            strict=True,
        )
        errors = {row[:3]: row[3] for row in found}
        for name, order in (("eighths", 4), ("diagonal", 2)):
            coarse, fine = (
                errors[f"table:{name}", "space_frame", f"steps {steps}"] for steps in (800, 1600)
            )
            self.assertAlmostEqual(math.log2(coarse / fine), order, delta=0.5, msg=name)
        for form in ("space_frame", "rigid_body"):
            coarse, fine = (
                errors["table:pair", form, f"tolerance 1e-0{digit}"] for digit in (4, 6)
            )
            self.assertLess(fine, coarse / 20)
        self.assertRegex(table.resolved(), r"'table:eighths\.txt@[0-9A-F]{16}'")

    def test_a_sweep_and_a_changed_table(self) -> None:
        """The resolved input computes the same again, and refuses another table."""
        self.write(EIGHTHS, "own.txt")
        text = TOP + "&study kind = 'sweep' /\n&output columns = 'theta_end' /\n"
        text += "&integration method = 'table:own.txt', steps = 500 /\n"
        text += "&sweep parameter = 'initial.omega3', values(1,:) = 10, 20, 30 /\n"
        table = self.compute(self.write(text))
        again = self.compute(self.write(table.resolved(), "again.nml"))
        self.assertEqual(again.column("theta_end"), table.column("theta_end"))
        elsewhere = b"\xef\xbb\xbf" + EIGHTHS.replace("\n", "\r\n").encode()
        (self.folder / "own.txt").write_bytes(elsewhere)
        again = self.compute(self.write(table.resolved(), "again.nml"))
        self.assertEqual(again.column("theta_end"), table.column("theta_end"))
        self.write(EIGHTHS + "# another\n", "own.txt")
        run = self.run_program(self.write(table.resolved(), "again.nml"))
        self.assertEqual(run.returncode, 2)
        self.assertIn("the table of coefficients has changed", run.stderr)

    def test_wrong_tables(self) -> None:
        """The message names the file, the line and what is wrong."""
        for old, new, message in (
            ("-1/3  1", "-1/2  1", "own.txt, line 5: the coefficients of stage 3 add up to 0.5"),
            ("order 4", "order 5", "own.txt, line 2: the method does not have order 5"),
            ("1 -1  1", "1 -x  1", "own.txt, line 6: '-x' is not a number"),
            ("1/8 3/8 3/8", "3/8 3/8", "own.txt, line 7: this row has 3 weights"),
            ("order 4\n", "", "own.txt, there is no order"),
            ("order 4", "order 4 3", "own.txt, an embedded method has a second row"),
            (EIGHTHS, "hello\n", "own.txt, line 1: this is neither"),
            (EIGHTHS, PAIR.replace("3 2", "3 3"), "1: the embedded method does not have order 3"),
            (EIGHTHS, RADAU, "own.txt, line 2: stage 1 depends on a later one"),
        ):
            with self.subTest(message):
                self.write(EIGHTHS.replace(old, new), "own.txt")
                scene = self.write(TOP + "&integration method = 'table:own.txt', steps = 9 /\n")
                run = self.run_program(scene)
                self.assertEqual(run.returncode, 2)
                self.assertIn(message, run.stderr)

    def test_a_formulation_with_the_method_of_a_scene(self) -> None:
        """A study that compares methods names pairs; a scene has another key for it."""
        self.write(EIGHTHS, "own.txt")
        scene = self.write(TOP + "&integration method = 'table:own.txt/lagrange', steps = 9 /\n")
        run = self.run_program(scene)
        self.assertEqual(run.returncode, 2)
        self.assertIn("names a formulation as well", run.stderr)
        self.assertIn("integration.formulation = 'lagrange'", run.stderr)


if __name__ == "__main__":
    pytest.main([__file__])
