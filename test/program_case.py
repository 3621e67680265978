"""Tests of the program by classes of unittest, for the suites that do not use `spin`."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from conftest import GOOD, KIND, ROOT

PROGRAM = os.environ["SPINTOP_EXE"]
COMPARISONS = "kind = 'stability'", "kind = 'work_precision'", "kind = 'benchmark'"
"""These take long: other tests run parts of them."""
NEEDS_FLINT = {"certified_top", "uncertain_top"}
"""Builds without FLINT refuse these: `verify_test` runs them."""

INPUTS = [
    path
    for path in sorted((ROOT / "input").glob("*.nml"))
    if path.stem not in NEEDS_FLINT and not any(kind in path.read_text() for kind in COMPARISONS)
]
# A build that is not optimised takes minutes for these: there they are computed with less.
IS_OPTIMISED = KIND == "release"
LESS = {
    "long_drift": ("nutations = 1000000", "nutations = 1000"),
    "million_spins": ("count(1) = 1000000", "count(1) = 10000"),
    "spin_tilt_statistics": ("cases = 100000", "cases = 2000"),
}
LARGEST = "million_spins"  # a table of half a gigabyte, too much to be read here in any build
WITHOUT_ROWS = {"nutation_indices", "spin_tilt_statistics"}
FAILING = {"slow_top_scenario1"}  # ends at its turning point, with exit code 3


class Table:
    """A table of the program or a reference table: comments, names, rows of texts.

    The line of its end is not among the comments; table_end_test checks it.
    """

    def __init__(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        lines = text.splitlines()
        if lines[-1].startswith("# end: "):
            lines.pop()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        self.header = [line[2:] for line in lines[:first]]
        self.trailer = [line for line in lines[first:] if line.startswith("#")]
        rows = list(csv.reader(line for line in lines[first:] if not line.startswith("#")))
        self.names, self.rows = rows[0], rows[1:]
        self.last_line = lines[-1]
        self.ends_line = text.endswith("\n")

    def texts(self, name: str) -> list[str]:
        """A column as it stands there."""
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def column(self, name: str) -> list[float]:
        """A column of numbers."""
        return [float(text) for text in self.texts(name)]

    def largest(self, name: str) -> float:
        """The largest size of a column."""
        return max(abs(value) for value in self.column(name))

    def resolved(self) -> str:
        """The resolved namelist in the header."""
        begin = self.header.index("input:") + 1
        return "\n".join(self.header[begin : self.header.index("columns:")]) + "\n"


class ProgramCase(unittest.TestCase):
    """Runs the program in a folder that goes away."""

    command: tuple[str | Path, ...] = (PROGRAM,)  # that starts it

    def setUp(self) -> None:
        """Work in a new folder."""
        folder = tempfile.TemporaryDirectory(prefix="spintop test ")  # a path with a space
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, *arguments: str | Path, **options: object) -> subprocess.CompletedProcess:
        """Call the program, by default with --quiet."""
        environment = os.environ | options.pop("environment", {})
        return subprocess.run(
            [*self.command, *map(str, arguments)],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=1200,
            **options,
        )

    def write(self, text: str = GOOD, name: str = "scene.nml") -> Path:
        """Write an input file."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def scene(self, name: str) -> Path:
        """An input that comes with the program."""
        return ROOT / "input" / f"{name}.nml"

    def table(self, name: str = "scene", folder: str = "output") -> Table:
        """Read a table."""
        return Table(self.folder / folder / f"{name}.csv")

    def compute(self, scene: Path, *settings: str, code: int = 0) -> Table:
        """Run a scene with settings GROUP.KEY=VALUE; its exit code must be as expected."""
        overrides = [part for setting in settings for part in ("--set", setting)]
        result = self.run_program(scene, *overrides)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return self.table(scene.stem)

    def produced(self) -> list[str]:
        """Everything in the folder but input files."""
        paths = sorted(self.folder.rglob("*"))
        return [str(p.relative_to(self.folder)) for p in paths if p.suffix != ".nml"]

    def refuse(self, scene: Path | str, *arguments: str) -> str:
        """The program must refuse: exit code 2, a diagnosis, nothing created. Returns it."""
        before = self.produced()
        result = self.run_program(scene, *arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(self.produced(), before)
        return result.stderr


class TableChecks(ProgramCase):
    """Checks of the tables of the supplied inputs."""

    def with_less(self, scene: Path) -> Path:
        """The input, or a copy that is computed sooner."""
        if scene.stem not in LESS or (IS_OPTIMISED and scene.stem != LARGEST):
            return scene
        text = scene.read_text(encoding="utf-8")
        self.assertIn(LESS[scene.stem][0], text)
        return self.write(text.replace(*LESS[scene.stem]), scene.name)

    def check_tables(self, inputs: list[Path], folder: str, output: str) -> None:
        """Each input has its table, and each table is whole."""
        tables = [path.name for path in (self.folder / folder).glob("*.csv")]
        endings = (".events.csv", ".histogram.csv", ".indices.csv", ".residuals.csv")
        beside = [name for name in tables if name.endswith(endings)]
        fits = ("fit", "inclinometer", "mounted_sensor", "spin_down", "tip_camera")
        expected = [f"{fit}.residuals.csv" for fit in fits]
        expected += ["nutation_indices.histogram.csv", "nutation_indices.indices.csv"]
        expected += ["slow_top_events.events.csv", "spin_tilt_statistics.histogram.csv"]
        self.assertEqual(sorted(beside), sorted(expected))
        self.assertEqual(len(tables) - len(beside), len(inputs))
        for scene in inputs:
            with self.subTest(scene.stem):
                self.assertIn(f"{scene}: ", output)
                self.check_table(scene, folder)

    def check_table(self, scene: Path, folder: str) -> None:
        """A table is whole, and its header describes its columns."""
        table = self.table(scene.stem + ".statistics" * (scene.stem in WITHOUT_ROWS), folder)
        self.assertTrue(table.ends_line)
        self.assertEqual(len(table.names), len(set(table.names)))
        for row in table.rows:
            self.assertEqual(len(row), len(table.names))
        units = table.header[table.header.index("columns:") + 1 :]
        described = [line.split()[0].rstrip(":") for line in units]
        self.assertEqual(described, table.names)
        if "status" in table.names:
            self.assertEqual(set(table.texts("status")), {"ok"})
            self.assertEqual(table.column("case"), list(range(1, len(table.rows) + 1)))
            self.assertFalse(any(line.startswith("date") for line in table.header))
        elif scene.stem in WITHOUT_ROWS:
            self.assertEqual(table.column("bin"), list(range(len(table.rows))))
            self.assertFalse(any(line.startswith("date") for line in table.header))
        elif scene.stem in FAILING:
            self.assertRegex(table.last_line, r"^# status: turning_point at t = 1\.1929502")
        else:
            self.assertRegex(table.last_line, r"^# status: (ok|at_rest at t = [0-9.]+)$")
            self.assertTrue(any(line.startswith("date: ") for line in table.header))
