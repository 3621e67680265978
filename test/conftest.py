"""Shared by the Python suites: the program under test, scratch folders, and their counts."""

import os
import tempfile
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

pytest_plugins = ["fortran_suites"]

# scripts/test names the program to test; a bare pytest takes the release build.
os.environ.setdefault("SPINTOP_EXE", str(ROOT / "build/release/spintop"))


@pytest.fixture
def folder(request: pytest.FixtureRequest) -> Iterator[Path]:
    """A new folder that is removed afterwards; its path has a space.

    A class with `@pytest.mark.usefixtures("folder")` has it as `self.folder`, also in `setUp`.
    """
    with tempfile.TemporaryDirectory(prefix="spintop test ") as name:
        if request.instance is not None:
            request.instance.folder = Path(name)
        yield Path(name)


class Counts:
    """Counts each test once, as passed or failed; what cannot be collected is a failed test."""

    def __init__(self) -> None:
        self.failed: set[str] = set()
        self.passed: set[str] = set()
        self.reasons: dict[str, None] = {}  # for which tests were skipped, in their order

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Note the outcome of a collection."""
        self.note(report, "collect")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note the outcome of a phase of a test or of a subtest."""
        self.note(report, report.when)

    def note(self, report: pytest.CollectReport | pytest.TestReport, phase: str) -> None:
        """Count it, or keep why something was skipped, which is no expected failure."""
        if report.failed:
            self.failed.add(report.nodeid)
        elif report.skipped:
            if not hasattr(report, "wasxfail"):
                where = report.longrepr
                text = where[2] if isinstance(where, tuple) else str(where)
                self.reasons.setdefault(text.removeprefix("Skipped: "))
        elif phase == "call":
            self.passed.add(report.nodeid)

    def pytest_report_teststatus(
        self, report: pytest.CollectReport | pytest.TestReport
    ) -> tuple[str, str, str] | None:
        """Show failures only."""
        return None if report.failed else ("", "", "")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> Generator[None]:
        """Print the counts, after all else."""
        yield
        if session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and self.reasons:
            session.exitstatus = pytest.ExitCode.OK
        terminal = session.config.get_terminal_writer()
        for reason in self.reasons:
            terminal.line(f"  left out: {reason}")
        passed = len(self.passed - self.failed)
        terminal.line(f"{passed} passed, {len(self.failed)} failed", flush=True)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option of scripts/test."""
    parser.addoption("--counts", action="store_true", help='end with "N passed, N failed"')


def pytest_configure(config: pytest.Config) -> None:
    """Count, if asked to; what runs in several processes is counted in the first."""
    if config.getoption("counts") and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Counts(), "spintop-counts")
