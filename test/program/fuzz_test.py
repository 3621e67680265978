"""Some hundred inputs of any kind: none brings the program down. The long tests have more."""

import re
import signal
import subprocess
from pathlib import Path

from conftest import EXE, each
from random_inputs import wild_input

PATIENCE = 300
"""Seconds after which a check of an input hangs; it takes some hundredths."""

CODES = (0, 2, 4)
"""Exit codes of `--check`."""

CRASHES = re.compile(r"Fortran runtime|Backtrace|Sanitizer|core dumped|internal error", re.I)
OBEYED = re.compile(
    "[\0-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Characters that a terminal obeys, and bytes that are none."""

PLACE = re.compile(r"^(?P<place>\S+):\d+:\d+: (error|warning): .+$")
CARET = re.compile(r"^\s*\| \s*\^+")


@each("first", 0, 100, 200)
def test_inputs(folder, first):
    check_seeds(folder, range(first, first + 100))


def check_seeds(folder: Path, seeds: range) -> None:
    """The program takes or refuses these inputs; it says why, and where."""
    faults = []
    for seed in seeds:
        (folder / "a.nml").write_bytes(wild_input(EXE, seed))
        faults += [f"{seed}: {fault}" for fault in faults_of(folder / "a.nml")]
    assert not faults, f"{len(faults)} faults:\n" + "\n".join(faults[:400])


def faults_of(path: Path) -> list[str]:
    """Errors in the answer to an input."""
    command = [EXE, "--check", path.name]
    options = {"cwd": path.parent, "capture_output": True, "timeout": PATIENCE}
    run = subprocess.run(command, check=False, **options)
    if run.returncode < 0:
        return [f"signal {signal.Signals(-run.returncode).name}"]
    faults = []
    if run.returncode not in CODES:
        faults.append(f"exit code {run.returncode}")
    said = [stream.decode(errors="surrogateescape") for stream in (run.stdout, run.stderr)]
    for text in said:
        if crash := CRASHES.search(text):
            faults.append(f"says {crash[0]}: {text[-200:]!r}")
        if bad := OBEYED.search(text):
            faults.append(f"shows {bad[0]!r} as it is")
    if run.returncode == 2:
        faults += unplaced(said[1])
    elif run.returncode == 0 and "error:" in said[1]:
        faults.append("is taken in spite of an error")
    return faults


def unplaced(text: str) -> list[str]:
    """Errors that do not say where they are."""
    blocks = [block.split("\n") for block in text.split("\n\n") if "error: " in block]
    if not blocks:
        return [f"is refused without a reason: {text[:200]!r}"]
    return [
        f"has no place or no caret: {block[:5]!r}"
        for block in blocks
        if not PLACE.match(block[0]) or not any(CARET.match(line) for line in block)
    ]
