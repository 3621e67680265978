"""spintop as a program that is measured: its calls, what it says of a sweep, and the machine."""

import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ.get("SPINTOP_EXE", str(ROOT / "build/release/spintop"))
SOME_FAILED = 3
"""Exit code of spintop if the status of some rows is no good end."""

NUMBER = r"([0-9.]+(?:E[-+]?[0-9]+)?)"
LOG = re.compile(
    rf"sweep of ([0-9]+) cases.*  time +{NUMBER} s on ([0-9]+) threads.*making cases {NUMBER} s, "
    rf"computing {NUMBER} s .*, formatting {NUMBER} s, .*writing {NUMBER} s.*  memory +{NUMBER} MB",
    re.DOTALL,
)


class RunError(Exception):
    """What spintop said when it could not compute."""


@dataclass(frozen=True)
class Run:
    """The log of a sweep: seconds of each part, of all threads together, and memory, MB."""

    cases: int
    threads: int
    elapsed: float
    making: float
    computing: float
    formatting: float
    writing: float
    memory: float

    @property
    def rate(self) -> float:
        """Cases per second of the whole run."""
        return self.cases / self.elapsed

    @property
    def kernel_rate(self) -> float:
        """Cases per second per thread of the computing alone."""
        return self.cases / self.computing


def lack_of_program() -> str:
    """Why nothing can be measured; empty if there is a program."""
    if shutil.which(PROGRAM):
        return ""
    return f"there is no {PROGRAM}; scripts/run --version builds it"


def call(*arguments: object) -> str:
    """Run spintop, and give what it prints."""
    command = [PROGRAM, *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode not in (0, SOME_FAILED):
        raise RunError(result.stderr.strip() or f"spintop ended with {result.returncode}")
    return result.stdout


def run_sweep(scene: Path, threads: int, settings: Iterable[str], folder: Path) -> Run:
    """Run a sweep to a folder, and read its log."""
    overrides = [part for setting in settings for part in ("--set", setting)]
    how = "--quiet", "--restart", "--threads", threads, "-o", folder, *overrides
    found = LOG.search(call(*how, "--", scene))
    if not found:
        raise RunError(f"{scene} is no sweep")
    cases, elapsed, used, *seconds = found.groups()
    return Run(int(cases), int(used), *map(float, (elapsed, *seconds)))


def best_of(runs: list[Run]) -> Run:
    """The least of each figure; of the memory the largest."""
    figures = ("elapsed", "making", "computing", "formatting", "writing")
    least = [min(getattr(run, name) for run in runs) for name in figures]
    return Run(runs[0].cases, runs[0].threads, *least, max(run.memory for run in runs))


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


def processor() -> str:
    """What the machine computes with."""
    try:
        found = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text("utf-8"), re.M)
    except OSError:
        found = None
    return f"{found[1] if found else os.uname().machine}, {processors()} processors"


def table_row(cells: Iterable[str]) -> str:
    """A row of a table in Markdown."""
    return "| " + " | ".join(cells) + " |"


def as_table(header: list[str], rows: Iterable[Iterable[str]] = ()) -> str:
    """A table in Markdown, or its head alone."""
    return "\n".join(map(table_row, (header, ["---"] * len(header), *rows)))
