"""Some hundred inputs of any kind: none brings the program down. The long tests have more."""

from conftest import each
from input_fuzzer import check_seeds


@each("first", 0, 100, 200)
def test_inputs(folder, first):
    check_seeds(folder, range(first, first + 100))
