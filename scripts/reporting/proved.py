"""Numbers with a proved bound beside them: which of their digits are proved."""

import math
from collections.abc import Sequence

from markupsafe import Markup, escape

from reporting.cells import NOTHING, is_number, minus

SUFFIX = "_bound"
"""Behind the name of a column in that of its bounds."""

MOST, MORE = 17, 2
"""Digits of a cell, and how many of the best known one are not proved."""


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
            texts.append(str(cell) if isinstance(cell, str) else NOTHING)
        elif proved is None or not math.isfinite(cell):
            texts.append(minus(f"{cell:.{decimals}f}" if math.isfinite(cell) else str(cell)))
        else:
            texts.append(in_parts(f"{cell:.{decimals}f}", decimals - proved, float(bound)))
    return texts


def in_parts(text: str, rest: int, bound: float) -> Markup:
    """A number of which all but the last few digits are proved."""
    end = len(text) - max(0, rest)
    proved, others = minus(text[:end]).removesuffix("."), text[end:]
    if text[:end].endswith("."):
        others = f".{others}"
    said = minus(f"{bound:.2g}")
    return Markup('<b class="proved" title="off by {} at most">{}</b>{}').format(
        said, escape(proved), escape(others)
    )
