#!/usr/bin/env python3
"""Run one file of Python unit tests, and report its counts as the Fortran suites do.

usage: unittest_suite.py FILE.py        the last line is "NAME: N passed, N failed"
"""

import io
import sys
import unittest
from pathlib import Path


def main(path: Path) -> int:
    """Run the tests of a file; return 1 if one failed."""
    tests = unittest.TestLoader().discover(str(path.parent), path.name, str(path.parent))
    details = io.StringIO()
    result = unittest.TextTestRunner(details, buffer=True).run(tests)
    bad = len(result.failures) + len(result.errors) + len(result.unexpectedSuccesses)
    good = result.testsRun - len(result.skipped) - len(result.expectedFailures) - bad
    for reason in dict.fromkeys(reason for _, reason in result.skipped):
        print(f"  left out: {reason}")
    if bad:
        print(details.getvalue())
    print(f"{path.stem}: {max(good, 0)} passed, {bad} failed", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
