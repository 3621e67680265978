"""Thousands of inputs of any kind: none brings the program down."""

import os

from fuzz_test import check_seeds

INPUTS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))
FIRST = int(os.environ.get("SPINTOP_FIRST_SEED", "1000"))


def test_inputs(folder):
    check_seeds(folder, range(FIRST, FIRST + INPUTS))
