"""Numbers in pictures, in one notation: those within texts, and those at ticks.

A minus is a minus, powers of ten are raised, thousands have separators.
"""

import math
import re
from contextvars import ContextVar

from spintop_figures.tables.names import RAISED
from spintop_figures.tables.words import LANGUAGE

MINUS, TIMES, DASH = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}", "\N{EN DASH}"

DIGITS = 4
"""Significant digits of a number in a text."""

PLAIN = -3, 6
"""Powers of ten from and below which a number is written without a power."""

POINT_OR_SEPARATOR = re.compile(r"(?<=\d)[.,](?=\d)")
POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([-+]?\d+)")
COMMA = ContextVar("COMMA", default=False)
"""Whether numbers have decimal commas, as the look says."""


def speak(language: str) -> None:
    """Have all words and numbers in a language, but those of figures, which have their own."""
    LANGUAGE.set(language)
    COMMA.set(language != "en")


def write(value: float, digits: int = DIGITS) -> str:
    """A number with so many significant digits, such as 0.25, 12,350 or 1.2 times 10⁻⁹."""
    if not math.isfinite(value):
        return DASH if math.isnan(value) else ("∞" if value > 0 else f"{MINUS}∞")
    if value == 0:
        return "0"
    mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
    place = int(power)
    if PLAIN[0] <= place < PLAIN[1]:
        text = f"{float(f'{value:.{digits - 1}e}'):,.{max(0, digits - 1 - place)}f}"
        return localised(text.rstrip("0").rstrip(".") if "." in text else text)
    return with_power(mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa, place)


def with_power(mantissa: str, power: int) -> str:
    """A mantissa and a power of ten; a mantissa of one is left out."""
    ten = f"10{str(power).translate(RAISED)}"
    return {"1": "", "-1": MINUS}.get(mantissa, f"{localised(mantissa)}{TIMES}") + ten


def in_print(text: str) -> str:
    """A text with the numbers in it that programs write as 1e-06."""
    return POWER.sub(lambda number: with_power(number[1], int(number[2])), text)


def write_count(count: float) -> str:
    """How many, with separators between thousands."""
    return localised(f"{round(count):,}")


def write_fixed(value: float, decimals: int) -> str:
    """A number with so many decimals, or with two digits where they would make it zero."""
    if value == 0:
        return "0"
    text = f"{value:,.{decimals}f}"
    return localised(text) if float(text.replace(",", "")) else write(value, 2)


def decimals_for(span: float, least: int) -> int:
    """How many decimals tell numbers over a span apart, with two digits of it."""
    return max(least, 1 - math.floor(math.log10(span))) if 0 < span < math.inf else least


def localised(text: str) -> str:
    """A number as text with a minus for its hyphen, and a decimal comma where that is asked for."""
    text = true_minus(text)
    return with_comma(text) if COMMA.get() else text


def true_minus(text: str) -> str:
    """A number as text with a minus for its hyphen."""
    return text.replace("-", MINUS)


def with_comma(text: str) -> str:
    """A text whose numbers have decimal commas, and thin spaces between thousands."""
    marks = {".": ",", ",": "\N{NARROW NO-BREAK SPACE}"}
    return POINT_OR_SEPARATOR.sub(lambda mark: marks[mark[0]], text)
