"""Tests of the stand-in for pFUnit: scripts/pf2f90.py and the modules in test/funit."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
HEAD = "module suite\nuse funit\nimplicit none\ncontains\n"
TAIL = "end module suite\n"


def a_test(name: str, *body: str) -> str:
    """A .pf test subroutine."""
    return "\n".join(["@test", f"subroutine {name}()", *body, f"end subroutine {name}", ""])


class StandInTest(unittest.TestCase):
    """Converts small files, and runs one."""

    def setUp(self) -> None:
        """Work in a folder that goes away."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def call(self, *command: str | Path) -> subprocess.CompletedProcess:
        """Run a command in the folder."""
        return subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)

    def convert(self, text: str) -> subprocess.CompletedProcess:
        """Convert a text as the file suite.pf."""
        source = self.folder / "suite.pf"
        source.write_text(text, encoding="utf-8")
        script = ROOT / "scripts" / "pf2f90.py"
        return self.call(sys.executable, script, source, self.folder / "suite.f90")

    def test_refusals_name_file_and_line(self) -> None:
        """What pFUnit would take differently, or the stand-in lacks, does not pass silently."""
        refused = {
            "@assertTrue(.true.) ! why": "ends its line",
            "if (.true.) @assertTrue(.true.)": "a line of its own",
            "@assertEqual(1, &": "on one line",
            "@assertEqual(1)": "2 value(s)",
            "@assertEqual(1.0, 2.0, 0.5)": "not '0.5'",
            "@assertTrue(.true., tolerance=1.0)": "message=...",
            "@assertRelativelyEqual(1.0, 2.0)": "tolerance",
            "@assertEqual(-1, not(0))": "a matcher",
            "@assertIsInfinite(1.0)": "@assertIsInfinite",
            "@disable": "@disable",
            "@test": "subroutine NAME()",
            "@mpiTest(npes=[1])": "@mpiTest",
        }
        for line, reason in refused.items():
            with self.subTest(line):
                result = self.convert(HEAD + a_test("passes") + line + "\n" + TAIL)
                self.assertEqual(result.returncode, 1)
                self.assertRegex(result.stderr, r"suite\.pf:[89]: ")
                self.assertIn(reason, result.stderr)

    def test_names_that_pfunit_has_are_refused(self) -> None:
        """An entity of a suite's module cannot have a name that pFUnit's own module brings in."""
        head = "module suite\nuse funit\n"
        for line in (
            "use runs, only: near",
            "use runs, only: a, run => b",
            "real, parameter :: t = 0.5",
            "real :: x(2, 3), Test(4)",
            "type, extends(thing_t) :: subject",
        ):
            with self.subTest(line):
                result = self.convert(head + line + "\ncontains\n" + a_test("passes") + TAIL)
                self.assertEqual(result.returncode, 1)
                self.assertIn("suite.pf:3: pFUnit has a", result.stderr)
        for first in (
            "subroutine run(x)",
            "integer function run(x)",
            "pure function RUN(x) result(y)",
        ):
            with self.subTest(first):
                body = first + "\nreal, intent(in) :: x\nend subroutine\n"
                result = self.convert(HEAD + a_test("passes") + body + TAIL)
                self.assertRegex(result.stderr, r"(?i)suite\.pf:8: pFUnit has a 'run'")
        # Names inside procedures, types and interfaces, and names that pFUnit would see renamed.
        own = "interface\nsubroutine f(run)\nreal :: run\nend subroutine\nend interface\n"
        own += "type :: thing_t\nreal :: t\nend type\nuse runs, only: mine => run\n"
        inner = a_test("passes", "real :: t", "select type (x)", "type is (real)", "end select")
        result = self.convert(head + own + "contains\n" + inner + a_test("other") + TAIL)
        self.assertEqual(result.stderr, "")

    def test_failures_are_counted(self) -> None:
        """A failing assert fails its test, ends it, and gives the exit code 1."""
        text = HEAD + "".join(
            [
                a_test("passes", "@assertEqual('a, (b', ' a, (b')"),
                a_test(
                    "section",
                    "real(kind(1d0)) :: m(2, 2) = reshape([1d0, 2d0, 3d0, 4d0], [2, 2])",
                    "@assertEqual(m(2, :), -[-2d0, -4d0])",
                ),
                a_test(
                    "nan", "real(kind(1d0)) :: x = 0", "@assertEqual(1d0, x / x, tolerance=9d9)"
                ),
                a_test("shape", "@assertEqual([1, 2], [1])", "@assertFail('too late')"),
                a_test("types", "@assertEqual(1d0, 1)"),
                a_test("order", "@assertLessThan(1, [2, 1], message='a message')"),
                a_test("zero", "@assertRelativelyEqual(0d0, 0d0, tolerance=1d0)"),
            ]
        )
        self.assertEqual(self.convert(text + TAIL).stderr, "")
        sources = [ROOT / "test/funit/boxes.f90", ROOT / "test/funit/funit.f90", "suite.f90"]
        built = self.call("gfortran", "-cpp", "-w", *sources, "-o", "suite")
        self.assertEqual(built.returncode, 0, built.stderr)
        result = self.call("./suite")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout.splitlines()[-1], "suite: 2 passed, 5 failed")
        self.assertIn("order (suite.pf:30): not 1 < 1 in element 2 | a message", result.stdout)
        self.assertNotIn("too late", result.stdout)


if __name__ == "__main__":
    unittest.main()
