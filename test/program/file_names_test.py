"""Names of files with characters that a terminal obeys: shown on one line, escaped."""

import unittest
from pathlib import Path

from program_test import GOOD, ProgramCase

NAME = "a\nb\tc\x1b[31m.nml"
SHOWN = "a\\nb\\tc\\x1b[31m"
SWEEP = GOOD.split("&output")[0] + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 3 /\n"
)


class FileNamesTest(ProgramCase):
    """Messages about files with arbitrary names."""

    def check(self, said: str) -> None:
        """The message contains the printable form of the name, and no control characters."""
        self.assertIn(SHOWN, said)
        self.assertNotIn("\x1b", said)
        for line in said.splitlines():
            self.assertFalse(line.startswith(("b ", "b\t", "b?")), said)

    def named(self, text: str) -> Path:
        """A file of that name."""
        path = self.folder / NAME
        path.write_text(text, encoding="utf-8")
        return path

    def test_every_kind_of_study(self) -> None:
        """Summaries, the explanation of --check, which is an input, and progress."""
        for text in (GOOD, SWEEP):
            scene = self.named(text)
            for options in ((), ("--check",), ("--progress",)):
                run = self.run_program(scene, *options)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.check(run.stdout)
                if run.stderr:
                    self.check(run.stderr)
        run = self.run_program(self.named(GOOD), "--check")
        again = self.run_program(self.write(run.stdout, "again.nml"), "--check")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_messages(self) -> None:
        """Errors in a file, and two files of one table."""
        run = self.run_program(self.named(GOOD.replace("mass", "maas")))
        self.assertEqual(run.returncode, 2)
        self.check(run.stderr)
        scene = self.named(GOOD)
        run = self.run_program(scene, scene)
        self.assertEqual(run.returncode, 2)
        self.check(run.stderr)

    def test_what_is_read_is_not_replaced(self) -> None:
        """By no table: the input, cases, torques, measurements, a reference, another input."""
        study = "&study kind = '{}' /\n"
        torques = "&effects torque_table = 'scene.csv' /\n"
        cases = study.format("sweep") + "&sweep table = 'scene.csv' /\n"
        precision = GOOD.split("&integration")[0] + study.format("work_precision")
        reading = (
            GOOD.split("&integration")[0] + torques,
            GOOD.split("&output")[0] + cases,
            GOOD.split("&output")[0] + cases + "&output file = 'scene.csv' /\n",
            precision + "&work_precision reference = 'scene.csv', methods = 'rk4', steps = 100 /\n",
            GOOD.split("&integration")[0]
            + study.format("fit")
            + "&fit data = 'scene.csv', unknown = 'initial.psi_rate' /\n",
        )
        data = self.folder / "scene.csv"
        tables = (
            "t,m1,m2,m3\n0,0,0,0\n1,0,0,0\n",
            "initial.psi_rate\n1\n2\n",
            "initial.psi_rate\n1\n2\n",
            None,
            "t,phi,theta,psi\n0,0,0.2,0\n0.1,0,0.2,0.1\n0.2,0,0.2,0.2\n",
        )
        for text, table in zip(reading, tables, strict=True):
            if table is None:
                columns = "output.columns=t,q0,q1,q2,q3,omega1,omega2,omega3"
                stored = self.write(GOOD.split("&output")[0], "stored.nml")
                run = self.run_program(stored, "--set", columns, "--set", "output.file=scene")
                self.assertEqual(run.returncode, 0, run.stderr)
                table = (self.folder / "output" / "scene.csv").read_text()
            data.write_text(table)
            error = self.refuse(self.write(text), "-o", ".")
            self.assertIn("its table ./scene.csv would replace the file that is read as", error)
            self.assertEqual(data.read_text(), table)
        scene = self.write(SWEEP, "scene.csv")
        self.assertIn("would replace", self.refuse(scene, "-o", "."))
        scene = self.write(SWEEP, "scene.log")
        self.assertIn("would replace", self.refuse(scene, "-o", "."))
        other = self.write(GOOD, "other.nml")
        self.write(GOOD, "other.csv")
        run = self.run_program(
            other, self.folder / "other.csv", "--set", "output.file=x", "-o", "."
        )
        self.assertEqual(run.returncode, 2)
        self.assertEqual((self.folder / "other.csv").read_text(), GOOD)

    def test_points_in_the_name_of_a_table(self) -> None:
        """Only the ending of its format is one."""
        scene = self.write(GOOD.split("&output")[0])
        for name, file in (
            ("spin_1.5", "spin_1.5.csv"),
            ("a.csv", "a.csv"),
            ("b.v2.csv", "b.v2.csv"),
        ):
            run = self.run_program(scene, "--set", f"output.file={name}")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertTrue((self.folder / "output" / file).exists(), name)


if __name__ == "__main__":
    unittest.main()
