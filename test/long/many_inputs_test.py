"""Thousands of inputs of any kind."""

import os
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from input_fuzzer import FuzzCase  # noqa: E402

INPUTS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))
FIRST = int(os.environ.get("SPINTOP_FIRST_SEED", "1000"))


class FuzzTest(FuzzCase):
    """No input brings the program down."""

    def test_inputs(self) -> None:
        """Keys and values of any kind, and bytes."""
        self.check_seeds(range(FIRST, FIRST + INPUTS))


if __name__ == "__main__":
    unittest.main()
