"""The whole reference set comes out again, with all digits; it takes some minutes."""

import pytest

from conftest import MISSING, ROOT, execute


def test_whole_set():
    run = execute(ROOT / "scripts/make_reference", "--check", code=None)
    if MISSING in run.stderr:
        pytest.skip(MISSING)
    assert run.returncode == 0, run.stderr
