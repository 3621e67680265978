"""The cells of tables as texts: one notation per column, so that decimal points align."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from markupsafe import Markup

from spintop_figures.style.numbers import DASH, true_minus

DIGITS = 10
"""Significant digits of the largest number of a column."""

LOWEST, HIGHEST = -2, 7
"""Powers of ten between which the largest number of a column is written without a power."""

WIDEST, SMALL_PART = 6, 0.1
"""Powers of ten between the largest number of a column without powers and its small ones, which
are so large a part of all."""

BOUND = "_bound"
"""Behind the name of a column in that of its proved bounds."""

MOST, MORE = 17, 2
"""Digits of a cell with a bound, and how many of the best known one are not proved."""


def is_number(cell: object) -> bool:
    """Whether a cell holds a number, which nan is not."""
    return isinstance(cell, int | float | np.number) and not isinstance(cell, bool) and cell == cell


def texts_of(cells: Sequence[object] | pd.Series) -> list[str]:
    """The cells of a column as texts, all with as many decimals."""
    numbers = [cell for cell in cells if is_number(cell)]
    if not numbers:
        return [word_of(cell) for cell in cells]
    write = writer_for(numbers)
    return [write(cell) if is_number(cell) else word_of(cell) for cell in cells]


def word_of(cell: object) -> str:
    """A cell without a number."""
    return str(cell) if isinstance(cell, str) else DASH


def writer_for(numbers: list[float]) -> object:
    """What writes the numbers of a column: whole, with decimals, or with a power of ten."""
    sizes = [abs(float(x)) for x in numbers if x and math.isfinite(x)]
    if all(isinstance(x, int | np.integer) for x in numbers):
        return lambda x: true_minus(str(x))
    if not sizes:
        return lambda x: "0" if x == 0 else true_minus(str(x))
    ends = (max(sizes), np.quantile(sizes, SMALL_PART))
    top, bottom = (math.floor(math.log10(x)) for x in ends)
    if not LOWEST <= top < HIGHEST or top - bottom > WIDEST:
        return lambda x: true_minus(f"{x:.{DIGITS - 1}e}")
    # No decimals that every number has as zero.
    most = max(0, DIGITS - 1 - top)
    needed = max(len(f"{float(x):.{most}f}".rstrip("0").partition(".")[2]) for x in numbers)
    return lambda x: true_minus(f"{float(x):.{needed}f}")


def decimals_of(bound: float) -> int | None:
    """The last decimal to half a unit of which a number with this error is right; none if none."""
    if not 0 <= bound <= 0.5:
        return None
    return MOST if bound == 0 else min(MOST, math.floor(-math.log10(2 * bound)))


def proved_texts(cells: Sequence[object], bounds: Sequence[object]) -> list[str]:
    """The cells of a column: proved digits are set apart from others; the bound is their title."""
    numbers = [x for x in cells if is_number(x) and math.isfinite(x)]
    known = [decimals_of(float(b)) if is_number(b) else None for b in bounds]
    whole = len(str(int(max((abs(x) for x in numbers), default=0))))
    most = max((d for d in known if d is not None), default=MOST) + MORE
    decimals = max(0, min(most, MOST - whole))
    texts = []
    for cell, bound, proved in zip(cells, bounds, known, strict=True):
        if not is_number(cell):
            texts.append(word_of(cell))
        elif proved is None or not math.isfinite(cell):
            texts.append(true_minus(f"{cell:.{decimals}f}"))
        else:
            texts.append(in_parts(f"{cell:.{decimals}f}", decimals - proved, float(bound)))
    return texts


def in_parts(text: str, rest: int, bound: float) -> Markup:
    """A number of which all but the last few digits are proved."""
    end = len(text) - max(0, rest)
    end -= text[:end].endswith(".")
    said = true_minus(f"{bound:.2g}")
    return Markup('<b class="proved" title="off by {} at most">{}</b>{}').format(
        said, true_minus(text[:end]), text[end:]
    )
