"""The coverage of the intervals of thousands of fits."""

import os
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "program"))

from fit_test import FitCase  # noqa: E402

FITS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))


class CoverageTest(FitCase):
    """95 % intervals cover in 95 % of the fits."""

    def test_coverage(self) -> None:
        """Within 1 %, which is 4.6 standard deviations of the count of 10,000 fits."""
        for count in self.count_covered(FITS):
            self.assertAlmostEqual(count / FITS, 0.95, delta=(1e4 / FITS) ** 0.5 * 0.01)


if __name__ == "__main__":
    unittest.main()
