"""Some hundred inputs of any kind: none brings the program down. The long tests have more."""

import pytest

from input_fuzzer import check_seeds


@pytest.mark.parametrize("first", [0, 100, 200])
def test_inputs(folder, first):
    check_seeds(folder, range(first, first + 100))
