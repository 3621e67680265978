"""Every fault of disk and memory: each call of a run fails, for every output and every error.

SPINTOP_LONG_CASES is the largest number of places that are tried for a kind of call (default: all).
"""

import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "program"))

from faults_test import CALLS, INPUTS, Fault, FaultCase, sample

MOST = int(os.environ.get("SPINTOP_LONG_CASES", "1000000"))


class AllFaultsTest(FaultCase):
    """All numbers of all calls."""

    def test_every_call(self) -> None:
        """As in the sample."""
        for name in INPUTS:
            prepared = self.prepare(name)
            if prepared is None:
                continue
            expected, counts = prepared
            for call in CALLS:
                for kind, lasts in self.kinds(call):
                    for number in sample(counts[call], MOST, 0):
                        fault = Fault(call, number, kind, lasts)
                        with self.subTest(name, fault=fault):
                            self.check(name, expected, fault)
                print(f"{name}: {call}: {counts[call]} places, {self.tried} faults so far")


if __name__ == "__main__":
    unittest.main()
