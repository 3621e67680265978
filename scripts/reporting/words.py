"""How a report writes numbers, units, counts, parameters and statuses: in words, not in keys."""

import re

from spintop_figures.motion.events import describe_event
from spintop_figures.tables.names import UNIT_WORDS, name_of, sign_of

DIGITS = 4
TIMES = "\N{MULTIPLICATION SIGN}"

POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
INDICES = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
GREEK = {
    **{"phi": "φ", "theta": "θ", "psi": "ψ"},
    **{"omega": "ω", "lambda": "λ", "delta": "Δ"},
}
RELATIONS = {">>": "≫", "<<": "≪", ">=": "≥", "<=": "≤"}
SYMBOL = re.compile(rf"\b({'|'.join(GREEK)})(\d?)\b")
MOMENT = re.compile(r"\bI([123])\b")
ROOT = re.compile(r"\bsqrt\((\w+)\)")
POWER = re.compile(r"\^(-?\d+)")
RELATION = re.compile("|".join(RELATIONS))

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

GOOD = "ok"
COMPLETED = "completed"
SEVERAL = "those of the column"
"""How the header of a table begins the method, or the formulation, that differs from row to row."""


def short(value: float, digits: int = DIGITS) -> str:
    """A number with a few digits, a power of ten as one, and a true minus sign."""
    mantissa, e, power = f"{value:.{digits}g}".partition("e")
    text = mantissa.replace("-", "\N{MINUS SIGN}")
    return f"{text} {TIMES} 10{str(int(power)).translate(POWERS)}" if e else text


def with_error(value: float, error: float) -> str:
    """A number with its standard error, which has two digits."""
    if not error > 0:
        return short(value)
    decimals = max(0, 1 - int(f"{error:.1e}".partition("e")[2]))
    texts = (f"{x:.{decimals}f}" for x in (value, error))
    if decimals > 2 * DIGITS or abs(value) >= 10 ** (2 * DIGITS):
        texts = (short(value, 2 * DIGITS), short(error, 2))
    return " ± ".join(texts).replace("-", "\N{MINUS SIGN}")


def counted(number: int, one: str = "", several: str = "") -> str:
    """So many: in words up to ten if a noun follows, else in digits, thousands apart."""
    if not one:
        return f"{number:,}"
    word = NUMBERS[number] if number < len(NUMBERS) else f"{number:,}"
    return f"{word} {one if number == 1 else several or one + 's'}"


def of_kind(kind: str, number: int) -> str:
    """So many tables of a kind."""
    plain = kind.replace("_", " ")
    return counted(number, *KINDS.get(kind, (f"table: {plain}", f"tables: {plain}")))


def typeset(text: str) -> str:
    """A formula of plain characters with powers, roots, Greek letters and signs as in print."""
    text = POWER.sub(lambda found: found[1].translate(POWERS), text)
    text = SYMBOL.sub(lambda found: GREEK[found[1]] + found[2].translate(INDICES), text)
    text = MOMENT.sub(lambda found: "I" + found[1].translate(INDICES), text)
    return RELATION.sub(lambda found: RELATIONS[found[0]], ROOT.sub(r"√\1", text))


def unit_of(unit: str) -> str:
    """A unit of a table as in print: kg m², µs, degrees."""
    unit = UNIT_WORDS.get(unit, unit)
    return POWER.sub(lambda found: found[1].translate(POWERS), re.sub(r"\bus\b", "µs", unit))


def column_of(name: str) -> str:
    """A column within a line of text."""
    return sign_of(name)


def parameter_of(key: str) -> str:
    """A parameter within a line of text."""
    return name_of(key)


def event_of(name: str) -> str:
    """An event in words."""
    return describe_event(name)


def outcome_of(status: str) -> str:
    """A status, or a verdict, in words: the time in it has a few digits."""
    if status == GOOD:
        return COMPLETED
    shortened = re.sub(r"\d+\.\d+", lambda found: short(float(found[0])), status)
    words = shortened.replace("_", " ")
    return f"{words} s" if shortened != status else words


def method_of(model: str, method: str) -> str:
    """A method with its formulation."""
    if method.startswith(SEVERAL):
        return "several"
    if method in ("", "exact"):
        return "exact solution" if method else ""
    return ", ".join(map(name_of, (method, model)))
