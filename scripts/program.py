"""spintop as a program that scripts call, what it says of a sweep, and the machine."""

import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("SPINTOP_EXE", str(ROOT / "build/release/spintop"))
SOME_FAILED = 3
"""Exit code of spintop if the status of some rows is no good end."""

PARTS = ("sweep of", "time", "computing", "writing", "memory")
"""Numbers in the log of a sweep: cases, seconds, those of all threads together, and memory, MB."""


class ProgramError(Exception):
    """What spintop said when it could not compute."""


def lack_of_program() -> str:
    """Why nothing can be measured; empty if there is a program."""
    if shutil.which(PROGRAM):
        return ""
    return f"there is no {PROGRAM}; scripts/run --version builds it"


def call(*arguments: object, allowed: int = 0) -> str:
    """Run spintop, and give what it prints; a ProgramError is what it says when it fails.

    That is with an exit code other than zero and the one that is allowed.
    """
    command = [PROGRAM, *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode not in (0, allowed):
        said = result.stderr.strip() or result.stdout.strip()
        raise ProgramError(said or f"spintop ended with {result.returncode}")
    return result.stdout


def run_sweep(
    scene: Path, threads: int, settings: Iterable[str], folder: Path
) -> dict[str, float]:
    """Run a sweep to a folder, and give the numbers in its log."""
    overrides = [part for setting in settings for part in ("--set", setting)]
    how = "--quiet", "--verbose", "--restart", "--threads", threads, "-o", folder, *overrides
    log = call(*how, "--", scene, allowed=SOME_FAILED)
    found = {name: re.search(rf"\b{name} +([0-9.E+-]+) (?:cases|s|MB)\b", log) for name in PARTS}
    if not all(found.values()):
        raise ProgramError(f"{scene} is no sweep")
    return {name: float(match[1]) for name, match in found.items()}


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
