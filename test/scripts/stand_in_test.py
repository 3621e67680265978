"""Tests of the stand-in for pFUnit: scripts/pf2f90.py and the modules in test/funit."""

import subprocess
import sys
import unittest
from pathlib import Path

import pytest

from conftest import ROOT

HEAD = "module suite\nuse funit\nimplicit none\ncontains\n"
TAIL = "end module suite\n"


def a_test(name: str, *body: str) -> str:
    """A .pf test subroutine."""
    return "\n".join(["@test", f"subroutine {name}()", *body, f"end subroutine {name}", ""])


@pytest.mark.usefixtures("folder")
class StandInTest(unittest.TestCase):
    """Converts small files, and runs one."""

    folder: Path

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
        """What the stand-in lacks does not pass silently."""
        refused = {
            "@assertTrue(.true.) ! why": "on one line",
            "@assertEqual(1, &": "on one line",
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
