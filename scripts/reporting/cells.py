"""The cells of tables as texts: one notation per column, so that decimal points align."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

DIGITS = 10
"""Significant digits of the largest number of a column."""

LOWEST, HIGHEST = -2, 7
"""Powers of ten between which the largest number of a column is written without a power."""

WIDEST, SMALL_PART = 6, 0.1
"""Powers of ten between the largest number of a column without powers and its small ones, which
are so large a part of all."""

NOTHING = "\N{EN DASH}"


def is_number(cell: object) -> bool:
    """Whether a cell holds a number, which nan is not."""
    return isinstance(cell, int | float | np.number) and not isinstance(cell, bool) and cell == cell


def minus(text: str) -> str:
    """With true minus signs."""
    return text.replace("-", "\N{MINUS SIGN}")


def texts_of(cells: Sequence[object] | pd.Series) -> list[str]:
    """The cells of a column as texts, all with as many decimals."""
    numbers = [cell for cell in cells if is_number(cell)]
    if not numbers:
        return [str(cell) if isinstance(cell, str) else NOTHING for cell in cells]
    write = writer_for(numbers)
    return [write(cell) if is_number(cell) else word_of(cell) for cell in cells]


def word_of(cell: object) -> str:
    """A cell without a number."""
    return str(cell) if isinstance(cell, str) else NOTHING


def writer_for(numbers: list[float]) -> object:
    """What writes the numbers of a column: whole, with decimals, or with a power of ten."""
    sizes = [abs(float(x)) for x in numbers if x and math.isfinite(x)]
    if all(isinstance(x, int | np.integer) for x in numbers):
        return lambda x: minus(str(x))
    if not sizes:
        return lambda x: "0" if x == 0 else minus(str(x))
    ends = (max(sizes), np.quantile(sizes, SMALL_PART))
    top, bottom = (math.floor(math.log10(x)) for x in ends)
    if not LOWEST <= top < HIGHEST or top - bottom > WIDEST:
        return lambda x: minus(f"{x:.{DIGITS - 1}e}") if math.isfinite(x) else minus(str(x))
    # No decimals that every number has as zero.
    most = max(0, DIGITS - 1 - top)
    needed = max(len(f"{float(x):.{most}f}".rstrip("0").partition(".")[2]) for x in numbers)
    return lambda x: minus(f"{float(x):.{needed}f}")
