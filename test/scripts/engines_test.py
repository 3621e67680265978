"""scripts/judge_engines: its list, its page, errors and orders, and engines that are missing."""

import contextlib
import importlib.machinery
import importlib.util
import io
import math
import re
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import pytest

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "python")]

import pandas as pd  # noqa: E402

from engines import ENGINES, Engine  # noqa: E402
from engines.figure import draw, spread  # noqa: E402
from engines.motions import MOTIONS, SAMPLES, errors  # noqa: E402
from engines.table import NAMES, order, sheet  # noqa: E402

pytestmark = pytest.mark.slow

FOLDER = ROOT / "scripts/engines"
SHARED = {"__init__.py", "common.py", "common.mjs", "motions.py", "table.py", "figure.py"}
LONGEST = 60
"""Lines of a script but for blank ones, so that authors of an engine can read what is done."""


def load_script() -> object:
    """The script as a module."""
    loader = importlib.machinery.SourceFileLoader("judge", str(ROOT / "scripts/judge_engines"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("judge", loader))
    loader.exec_module(module)
    return module


def turned(angle: float) -> list[list[float]]:
    """Upright states, turned by an angle about z at the end."""
    still = [1.0, 0.0, 0.0, 0.0, *MOTIONS[0].omega]
    last = [math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2), *MOTIONS[0].omega]
    return [still] * (SAMPLES - 1) + [last]


class ListTest(unittest.TestCase):
    """The list is that of the scripts and of the page."""

    def test_scripts(self) -> None:
        """Each engine has a short script, and each script an engine."""
        files = {path.name for path in FOLDER.iterdir() if path.suffix in (".py", ".mjs")} - SHARED
        self.assertEqual(files, {engine.script for engine in ENGINES})
        for name in files:
            lines = (FOLDER / name).read_text(encoding="utf-8").splitlines()
            self.assertLess(sum(map(bool, lines)), LONGEST, name)

    def test_page(self) -> None:
        """The page has all engines with all methods of their scripts, and no others."""
        page = (ROOT / "doc/engines.md").read_text(encoding="utf-8")
        first = page[page.index("| engine | method |") :].split("\n\n")[0].splitlines()[2:]
        told: dict[str, set[str]] = {}
        for line in first:
            engine, method = line.strip("| ").split(" | ")[:2]
            told.setdefault(engine, set()).add(method)
        self.assertEqual(list(told), [engine.name for engine in ENGINES])
        for engine in ENGINES:
            text = (FOLDER / engine.script).read_text(encoding="utf-8")
            listed = re.search(r"METHODS = ([\[({].*?)\n(?=\n|\S)", text, re.DOTALL)[1]
            names = set(re.findall(r'"([^"]+)"(?=[,:\])])', listed)) - {"rate", "position"}
            self.assertEqual(told[engine.name], names, engine.name)


class ErrorTest(unittest.TestCase):
    """Errors, orders, tables and figure."""

    def test_errors(self) -> None:
        """An attitude that is off, at any norm, and a run that was lost."""
        motion, truth = MOTIONS[0], [[1.0, 0.0, 0.0, 0.0]] * SAMPLES
        states = [[2 * x for x in state[:4]] + state[4:] for state in turned(0.1)]
        found = errors(motion, truth, states)
        self.assertAlmostEqual(found["attitude"], 0.1, delta=1e-14)
        self.assertLess(found["energy"], 1e-15)
        self.assertGreater(found["momentum"], 0.01)
        for lost in (states[1:], [*states[1:], [math.nan] * 7]):
            self.assertEqual(errors(motion, truth, lost)["attitude"], math.inf)

    def test_truth(self) -> None:
        """The program knows all motions; a top has not left its start at once."""
        with tempfile.TemporaryDirectory() as name:
            for motion in (MOTIONS[1], MOTIONS[5]):
                truth = motion.truth(Path(name))
                self.assertEqual(len(truth), SAMPLES)
                self.assertAlmostEqual(math.hypot(*truth[-1]), 1, delta=1e-15)

    def table(self) -> pd.DataFrame:
        """A method of order two."""
        return pd.DataFrame(
            {"engine": engine.name, "version": "1", "motion": name, "method": "m", "fixed": True,
             "setting": rate, "attitude": 100 / rate**2, "energy": 0.0, "momentum": 0.0,
             "cost": rate * 1e-6}
            for engine in ENGINES for name in NAMES for rate in (100, 1000, 10000)
        )  # fmt: skip

    def test_tables(self) -> None:
        """The order of made errors, in the table also, and a figure with all names."""
        table = self.table()
        rows = table[(table["engine"] == "MuJoCo") & (table["motion"] == NAMES[1])]
        self.assertAlmostEqual(order(rows), 2.0)
        self.assertIn("| MuJoCo | m | 2.0 | 0.0e+00 | 0.0e+00 | 1 | 1.0e-03 |", sheet(table))
        places = spread([0.5] * 8 + [1.0])
        self.assertGreater(min(b - a for a, b in zip(sorted(places)[:-1], sorted(places)[1:],
                                                     strict=True)), 0.03)  # fmt: skip
        with tempfile.TemporaryDirectory() as name:
            draw(table, Path(name) / "engines.svg")
            text = (Path(name) / "engines.svg").read_text(encoding="utf-8")
        for engine in ENGINES:
            self.assertIn(f">{engine.name}<", text)


class ScriptTest(unittest.TestCase):
    """Runs parts of the script."""

    def test_missing_engines(self) -> None:
        """An engine that is not there is left out by name, in Python and in JavaScript."""
        script, said = load_script(), io.StringIO()
        with (
            tempfile.TemporaryDirectory() as name,
            unittest.mock.patch.object(script, "NODE", Path(name) / "node"),
            unittest.mock.patch.object(script, "VENV", Path(name) / "venv"),
            contextlib.redirect_stderr(said),
        ):
            for file in ("mujoco.py", "rapier.mjs"):
                absent = Engine(f"Absent {file}", file, "no-such-package", "games")
                self.assertEqual(script.judge(absent, {}, 1.0), [])
        self.assertIn("Absent mujoco.py is left out: ", said.getvalue())
        self.assertIn("Absent rapier.mjs is left out: ", said.getvalue())

    def test_unknown_engine(self) -> None:
        """A name that is not in the list is an error that names those that are."""
        script, said = load_script(), io.StringIO()
        with (
            unittest.mock.patch.object(sys, "argv", ["judge_engines", "--engines", "Mujoco"]),
            contextlib.redirect_stderr(said),
            self.assertRaises(SystemExit) as ended,
        ):
            script.parse_arguments()
        self.assertEqual(ended.exception.code, 2)
        self.assertIn("there is no engine Mujoco; there are spintop, ", said.getvalue())


if __name__ == "__main__":
    unittest.main()
