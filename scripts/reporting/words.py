"""What a report writes beside the names and numbers of figures: counts, kinds, errors."""

from spintop_figures.style.numbers import true_minus, write, write_count
from spintop_figures.tables.names import name_of

DIGITS = 4

NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
"""Counts up to ten are words."""

KINDS = {
    "trajectory": ("trajectory", "trajectories"),
    "sweep": ("sweep", "sweeps"),
    "fit": ("table of a fit", "tables of fits"),
    "events": ("table of events", "tables of events"),
    "statistics": ("table of statistics", "tables of statistics"),
    "histogram": ("histogram", "histograms"),
    "indices": ("table of indices", "tables of indices"),
    "work_precision": ("work-precision study", "work-precision studies"),
    "stability": ("stability study", "stability studies"),
    "benchmark": ("benchmark", "benchmarks"),
}
"""A kind of table: one, and several."""

SEVERAL = "those of the column"
"""How the header of a table begins the method, or the formulation, that differs from row to row."""


def with_error(value: float, error: float) -> str:
    """A number with its standard error, which has two digits."""
    if not error > 0:
        return write(value)
    decimals = max(0, 1 - int(f"{error:.1e}".partition("e")[2]))
    texts = (f"{x:.{decimals}f}" for x in (value, error))
    if decimals > 2 * DIGITS or abs(value) >= 10 ** (2 * DIGITS):
        texts = (write(value, 2 * DIGITS), write(error, 2))
    return true_minus(" ± ".join(texts))


def counted(number: int, one: str, several: str = "") -> str:
    """So many of something: in words up to ten, else in digits."""
    word = NUMBERS[number] if number < len(NUMBERS) else write_count(number)
    return f"{word} {one if number == 1 else several or one + 's'}"


def of_kind(kind: str, number: int) -> str:
    """So many tables of a kind."""
    plain = kind.replace("_", " ")
    return counted(number, *KINDS.get(kind, (f"table: {plain}", f"tables: {plain}")))


def method_of(model: str, method: str) -> str:
    """A method with its formulation."""
    if method.startswith(SEVERAL):
        return "several"
    if method in ("", "exact"):
        return "exact solution" if method else ""
    return ", ".join(map(name_of, (method, model)))
