"""The whole reference set comes out again, with all digits; it takes some minutes."""

import subprocess
import unittest

from conftest import ROOT


class WholeSetTest(unittest.TestCase):
    """scripts/make_reference --check."""

    def test_whole_set(self) -> None:
        """Nothing differs from what is computed."""
        command = [str(ROOT / "scripts/make_reference"), "--check"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if "this build has no FLINT" in run.stderr:
            self.skipTest("this build has no FLINT")
        self.assertEqual(run.returncode, 0, run.stderr)
