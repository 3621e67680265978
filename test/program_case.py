"""Tests of the program by classes of unittest, for the suites that do not use `spin`."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from conftest import GOOD, ROOT

PROGRAM = os.environ["SPINTOP_EXE"]


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
