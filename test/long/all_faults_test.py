"""Every fault of disk and memory: each call of a run fails, for every output and every error.

SPINTOP_LONG_CASES is the largest number of places that are tried for a kind of call (default: all).
"""

import os

from conftest import each
from faults_test import CALLS, INPUTS, Fault, faulty, kinds_of, sample  # noqa: F401

MOST = int(os.environ.get("SPINTOP_LONG_CASES", "1000000"))


@each("call", *CALLS)
@each("name", *INPUTS)
def test_every_call(faulty, name, call):  # noqa: F811 - it is the fixture
    """All numbers of all calls, as in the sample."""
    expected, counts = faulty.prepare(name)
    for kind, lasts in kinds_of(call):
        for number in sample(counts[call], MOST, 0):
            faulty.check(name, expected, Fault(call, number, kind, lasts))
