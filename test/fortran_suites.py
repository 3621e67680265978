"""pytest collects the Fortran suites too: each @test of a file NAME.pf is a test.

A suite is one program, build/KIND/test/NAME or, under pFUnit, build/KIND/pfunit/NAME/NAME. With
-d, a program of pFUnit or of its stand-in says which test begins, fails and ends. It is read as far
as the test that pytest is at, so that each test has its own time and its own limit; one that
outlasts the limit ends the program, and so the rest of the suite, which fails.
"""

import os
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
TEST = re.compile(r"^ *@test *\n *subroutine +(\w+)", re.MULTILINE | re.IGNORECASE)
EVENT = re.compile(r"^[.FEI]* *(Start:|Failure in|end:) +<(?:\w+\.)?(\w+)>")


class Suite(pytest.File):
    """A file of Fortran tests, and their program."""

    process: subprocess.Popen | None = None

    def collect(self) -> Iterator["FortranTest"]:
        """Give an item for each test; what else a file may hold is checked by who translates it."""
        self.names = TEST.findall(self.path.read_text(encoding="utf-8"))
        for name in self.names:
            yield FortranTest.from_parent(self, name=name)

    def start(self) -> subprocess.Popen[str]:
        """Start the program, with nothing read of it yet."""
        kind, name = os.environ.get("SPINTOP_TEST_KIND", "release"), self.path.stem
        folder = f"pfunit/{name}" if os.environ.get("PFUNIT_DIR") else "test"
        self.passed: set[str] = set()
        self.failed: dict[str, str] = {}  # what was said in these tests
        self.running, self.said = "", []
        return subprocess.Popen(
            [ROOT / "build" / kind / folder / name, "-d"], cwd=ROOT, text=True, errors="replace",
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip

    def read_line(self) -> bool:
        """Read a line of the program's output, unless it has ended."""
        line = self.process.stdout.readline()
        event = EVENT.match(line)
        if not event:
            self.said.append(line)
        elif event[1] == "Start:":
            self.running, self.said = event[2], []
        elif event[1] == "Failure in":
            self.failed[event[2]] = ""
        elif event[2] in self.failed:
            self.failed[event[2]] = "".join(self.said).strip()
        else:
            self.passed.add(event[2])
        return line != ""

    def reason(self, name: str) -> str:
        """Run the program to the end of a test; say why it failed, or nothing."""
        self.process = self.process or self.start()
        while name not in self.passed and not self.failed.get(name) and self.read_line():
            pass
        if self.failed.get(name) or (name in self.passed and name != self.names[-1]):
            return self.failed.get(name, "")
        while self.read_line():
            pass
        code, said = self.process.wait(), "".join(self.said[-40:])
        if name in self.failed:  # pFUnit says at its end what was wrong
            return said
        if name in self.passed and (code == 0 or self.failed):
            return ""
        return f"{said}the program ended with {code}, in {self.running}"

    def teardown(self) -> None:
        """End the program, of which some tests may not have been wanted."""
        if self.process:
            self.process.kill()
            self.process.wait()


class FortranTest(pytest.Item):
    def runtest(self) -> None:
        """Ask the program; at the limit of time it ends too."""
        try:
            reason = self.parent.reason(self.name)
        except BaseException:
            self.parent.teardown()
            raise
        if reason:
            pytest.fail(reason, pytrace=False)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException]) -> str:
        """Show the reason, without the way to it."""
        return str(excinfo.value)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Name the test as those of Python are named."""
        return self.path, None, f"{self.path.stem}.{self.name}"


def pytest_collect_file(parent: pytest.Collector, file_path: Path) -> Suite | None:
    return Suite.from_parent(parent, path=file_path) if file_path.suffix == ".pf" else None
