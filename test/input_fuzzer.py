"""Conditions on the answer to any input: used by a short and a long suite."""

import os
import re
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from random_inputs import wild_input

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("SPINTOP_EXE", str(ROOT / "build/release/spintop"))
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


class FuzzCase(unittest.TestCase):
    """Checks inputs of any kind."""

    def check_seeds(self, seeds: range) -> None:
        """The program takes or refuses these inputs; it says why, and where."""
        faults = []
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "a.nml"
            for seed in seeds:
                path.write_bytes(wild_input(PROGRAM, seed))
                faults += [f"{seed}: {fault}" for fault in self.faults_of(path)]
        if faults:
            self.fail(f"{len(faults)} faults:\n" + "\n".join(faults[:400]))

    def faults_of(self, path: Path) -> list[str]:
        """Errors in the answer to an input."""
        run = subprocess.run(
            [PROGRAM, "--check", path.name],
            cwd=path.parent,
            capture_output=True,
            check=False,
            timeout=PATIENCE,
        )
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
            faults += self.unplaced(said[1])
        elif run.returncode == 0 and "error:" in said[1]:
            faults.append("is taken in spite of an error")
        return faults

    def unplaced(self, text: str) -> list[str]:
        """Errors that do not say where they are."""
        blocks = [block.split("\n") for block in text.split("\n\n") if "error: " in block]
        if not blocks:
            return [f"is refused without a reason: {text[:200]!r}"]
        return [
            f"has no place or no caret: {block[:5]!r}"
            for block in blocks
            if not PLACE.match(block[0]) or not any(CARET.match(line) for line in block)
        ]
