"""Tests of the counts at the end of a Python suite: nothing that fails is lost."""

import shutil
import sys
from pathlib import Path

from conftest import ROOT, each, execute

PLUGINS = ("test/conftest.py", "test/fortran_suites.py", "pytest.ini")
SUITE = """\
import unittest
import pytest

@pytest.mark.usefixtures("folder")
class MixedTest(unittest.TestCase):
    def setUp(self):
        self.file = self.folder / "a file"

    def test_good(self):
        self.file.write_text("text")
        print("noise")

    def test_bad(self):
        self.assertEqual(1, 2)

    def test_one_bad_part(self):
        for number in range(3):
            with self.subTest(number):
                self.assertNotEqual(number, 1)

    def test_good_parts(self):
        for number in range(3):
            with self.subTest(number):
                self.assertGreater(number, -1)

    def test_skipped(self):
        self.skipTest("a reason")

    @unittest.expectedFailure
    def test_unexpected(self):
        pass

class NoClassTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        raise ValueError("no class")

    def test_lost(self):
        pass

def test_function(folder):
    assert " " in str(folder)

def test_untidy(request):
    request.addfinalizer(lambda: 1 / 0)
"""


def run_suite(folder: Path, text: str, **environment: str) -> tuple[int, list[str]]:
    for name in PLUGINS:
        shutil.copy(ROOT / name, folder)
    (folder / "some_test.py").write_text(text, encoding="utf-8")
    words = ("-m", "pytest", "-qq", "--tb=short", "--counts", folder / "some_test.py")
    run = execute(sys.executable, *words, code=None, environment=environment)
    return run.returncode, (run.stdout + run.stderr).splitlines()


def test_each_test_counts_once(folder: Path) -> None:
    """Parts, classes and what comes after a test count as that test."""
    code, lines = run_suite(folder, SUITE)
    assert code == 1
    assert lines[-1] == "3 passed, 5 failed"
    assert "  left out: a reason" in lines
    assert "noise" not in lines


@each("text", "import no_such_module\n", "def test_one(:\n")
def test_what_cannot_be_collected_fails(folder: Path, text: str) -> None:
    code, lines = run_suite(folder, text)
    assert code != 0
    assert lines[-1] == "0 passed, 1 failed"


def test_a_suite_that_ends_python_fails(folder: Path) -> None:
    code, lines = run_suite(folder, "def test_good():\n    pass\n\nexit(0)\n")
    assert code != 0
    assert "0 passed, 0 failed" in lines


def test_no_test_is_an_error(folder: Path) -> None:
    code, lines = run_suite(folder, "def no_tset():\n    pass\n")
    assert code != 0
    assert lines[-1] == "0 passed, 0 failed"


def test_a_suite_that_is_left_out_says_why(folder: Path) -> None:
    text = "import pytest\npytest.skip('no such thing here', allow_module_level=True)\n"
    code, lines = run_suite(folder, text)
    assert code == 0
    assert lines[-2:] == ["  left out: no such thing here", "0 passed, 0 failed"]
