"""Some hundred inputs of any kind; the long tests have more."""

import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from input_fuzzer import FuzzCase  # noqa: E402


class FuzzTest(FuzzCase):
    """No input brings the program down."""

    def test_inputs(self) -> None:
        """Keys and values of any kind, and bytes."""
        self.check_seeds(range(300))


if __name__ == "__main__":
    unittest.main()
