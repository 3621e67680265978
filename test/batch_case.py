"""Test cases that run the program on many inputs at once."""

import csv
import os
import subprocess
import tempfile
import unittest
from collections.abc import Collection, Mapping
from pathlib import Path

PROGRAM = os.environ.get(
    "SPINTOP_EXE", str(Path(__file__).resolve().parent.parent / "build/release/spintop")
)
MISSING = "this build has no FLINT"


class BatchCase(unittest.TestCase):
    """Tables of inputs; a build without FLINT skips the test."""

    def compute(
        self, texts: Mapping[str, str], codes: Collection[int] = (0,)
    ) -> dict[str, list[dict[str, str]]]:
        """Return the rows of each input by its name; the exit code is one of `codes`."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for key, text in texts.items():
                (folder / f"{key}.nml").write_text(text, encoding="utf-8")
            command = [PROGRAM, "--quiet", "-o", ".", *(f"{key}.nml" for key in texts)]
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if MISSING in run.stderr:
                self.skipTest(MISSING)
            self.assertIn(run.returncode, codes, run.stderr[:2000])
            tables = {key: (folder / f"{key}.csv").read_text(encoding="utf-8") for key in texts}
        return {
            key: list(csv.DictReader(x for x in text.splitlines() if not x.startswith("#")))
            for key, text in tables.items()
        }
