"""Tests of the stand-in for pFUnit: scripts/pf2f90.py and the modules in test/funit."""

import sys
import unittest

import pytest

from conftest import ROOT, execute

HEAD = "module suite\nuse funit\nimplicit none\ncontains\n"
TAIL = "end module suite\n"


def a_test(name: str, *body: str) -> str:
    return "\n".join(["@test", f"subroutine {name}()", *body, f"end subroutine {name}", ""])


@pytest.mark.usefixtures("folder")
class StandInTest(unittest.TestCase):
    def convert(self, text: str, code: int = 0) -> str:
        source = self.folder / "suite.pf"
        source.write_text(text, encoding="utf-8")
        words = (sys.executable, ROOT / "scripts/pf2f90.py", source, self.folder / "suite.f90")
        return execute(*words, code=code).stderr

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
                said = self.convert(HEAD + a_test("passes") + line + "\n" + TAIL, code=1)
                self.assertRegex(said, r"suite\.pf:[89]: ")
                self.assertIn(reason, said)

    def test_failures_are_counted(self) -> None:
        """A failing assert fails its test, ends it, and gives the exit code 1."""
        matrix = "real(kind(1d0)) :: m(2, 2) = reshape([1d0, 2d0, 3d0, 4d0], [2, 2])"
        zero = "real(kind(1d0)) :: x = 0"
        tests = (
            a_test("passes", "@assertEqual('a, (b', ' a, (b')"),
            a_test("section", matrix, "@assertEqual(m(2, :), -[-2d0, -4d0])"),
            a_test("nan", zero, "@assertEqual(1d0, x / x, tolerance=9d9)"),
            a_test("shape", "@assertEqual([1, 2], [1])", "@assertFail('too late')"),
            a_test("types", "@assertEqual(1d0, 1)"),
            a_test("order", "@assertLessThan(1, [2, 1], message='a message')"),
            a_test("zero", "@assertRelativelyEqual(0d0, 0d0, tolerance=1d0)"),
        )
        self.assertEqual(self.convert("".join([HEAD, *tests, TAIL])), "")
        sources = [ROOT / "test/funit/boxes.f90", ROOT / "test/funit/funit.f90", "suite.f90"]
        execute("gfortran", "-cpp", "-w", *sources, "-o", "suite", cwd=self.folder)
        result = execute("./suite", cwd=self.folder, code=1)
        self.assertEqual(result.stdout.splitlines()[-1], "suite: 2 passed, 5 failed")
        self.assertIn("order (suite.pf:30): not 1 < 1 in element 2 | a message", result.stdout)
        self.assertNotIn("too late", result.stdout)
