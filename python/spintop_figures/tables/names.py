"""What everything is called in figures, reports and films: the one list of names.

The registry of the program, of which copies are here, and the headers of tables have a description
and a unit for each column. In `names.csv` are names short enough for an axis, a title or a legend,
with their symbols; what has none of its own is named by its parts. `name_of` and `axis_of` find
them.
"""

import csv
import functools
import json
import math
import re
from collections.abc import Mapping
from contextvars import ContextVar
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import pandas as pd


class Name(NamedTuple):
    """How something is called: words, a formula for an axis, and a sign within a line of text."""

    words: str
    formula: str = ""
    sign: str = ""


with Path(__file__).with_suffix(".csv").open(encoding="utf-8", newline="") as file:
    NAMES = {row.pop("key"): Name(**row) for row in csv.DictReader(file)}
"""Columns of tables and keys of the input, with what they are called by themselves; methods,
formulations, kinds of studies and of the tables beside them, statuses and verdicts. As everywhere,
what is not among them is its own words."""

ANGLES = {"phi", "theta", "psi"}
INITIAL = {*ANGLES, *(f"{name}_rate" for name in ANGLES), "omega", "omega3", "quaternion"}
"""Keys of the group `initial` that are columns, too: as keys they are initial."""

KEY = re.compile(r"(?:(\w+)(?:\((\d+)\))?\.)?(\w+)(?:\((\d+)(?:,(\d+))?\))?")
"""A group, a key or a column, and which elements of an array."""

MASSES = ("kg", "g", "mg", "lb", "oz")
"""Units of keys that are none of columns."""

LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
RAISED = str.maketrans("-\N{MINUS SIGN}0123456789", "⁻⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits of a power of ten, or of a unit."""

UNITS: ContextVar[Mapping[str, str]] = ContextVar("UNITS", default=MappingProxyType({}))
"""The units that axes shall have by columns, as the look says."""

UNIT_WORDS = {"deg": "degrees"}
"""Units that figures write otherwise than tables."""


def unit_shown(column: str, unit: str) -> tuple[str, float]:
    """The unit in which a column is drawn, and the factor to it.

    Angles are in degrees. Errors stay in radians, in which tolerances and verdicts are given, and
    what is asked for in them, as `theta_rad`.
    """
    if unit == "rad" and not re.search(r"error|_rad$", column):
        return UNIT_WORDS["deg"], math.degrees(1)
    return unit, 1.0


def raised(unit: str) -> str:
    """A unit as in print: kg m², µs, degrees."""
    words = re.sub(r"\bus\b", "µs", UNIT_WORDS.get(unit, unit))
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(RAISED), words)


def find_name(key: str) -> Name:
    """The name of a column, of a key of the input such as `top.inertia(1)`, or of a word."""
    if key in NAMES:
        return NAMES[key]
    if key.startswith("uncertainty."):
        return Name(f"radius of the {name_of(key.partition('.')[2])}")
    column, derivative, other = key.partition("__")
    if derivative:
        return Name(f"change of {name_of(column)} with {name_of(other)}")
    if table := re.fullmatch(r"arkode_(\w+?)((?:_\d+)+)", key):
        parts = table[1].split("_")  # people, or the kind of the table
        words = (part.upper() if re.search(r"\d|rk$", part) else part.title() for part in parts)
        return Name(f"{'-'.join(words)} {table[2].strip('_').replace('_', '-')}")
    group, _, name = key.rpartition(".")
    stem, _, suffix = key.rpartition("_")
    of_key = group and name not in NAMES and suffix in {*MASSES, *(s for _, s in column_units())}
    if of_key or column_of(key)[1]:
        key = stem
    if not (parts := KEY.fullmatch(key)):
        return Name(key)
    group, part, name, *places = parts.groups()
    known = NAMES.get(name) or Name(words_in(name))
    place = "".join(str(int(i) - (name == "quaternion")) for i in filter(None, places))
    if place:
        sign = known.sign and known.sign + place.translate(LOWERED)
        known = Name(f"{known.words} {sign or place}", sign=sign)
    if group == "initial" and name in INITIAL:
        known = Name(f"initial {known.words}", at_start(known.formula), at_start(known.sign))
    if group in ("offset", "scale"):
        known = Name(f"{group} of {known.sign or known.words}")
    return known._replace(words=f"{known.words} of part {part or 1}") if group == "part" else known


def words_in(name: str) -> str:
    """What the parts of a key say."""
    endings = {"_fast_top": " of a fast top", "_bound": ", bound", "_max": ", largest"}
    for ending, words in (endings | {"_end": " at the end"}).items():
        if name.endswith(ending):
            return name_of(name.removesuffix(ending)) + words
    if name.startswith("work_"):
        return f"work of {name[5:].replace('_', ' ')}"
    return name.replace("_", " ")


def at_start(symbol: str) -> str:
    """A symbol with the zero of the start."""
    if symbol.endswith("_3$"):
        return symbol[:-3] + "_{30}$"
    return symbol[:-1] + "_0$" if symbol.endswith("$") else symbol and symbol + "₀"


def name_of(key: str) -> str:
    """What something is called in a title or a legend: words without formulas."""
    return find_name(key).words


def column_name(column: str, meaning: str = "") -> str:
    """What a column is called, by what its table says of it if it has no name of its own."""
    known = find_name(column).words
    return known if column in NAMES or "__" in column or not meaning else meaning


def sign_of(key: str) -> str:
    """The shortest name: the sign within a line of text, else words."""
    name = find_name(key)
    return name.sign or name.words


def axis_of(key: str, unit: str = "", between: str = " ") -> str:
    """Words, formula and unit, as the label of an axis."""
    name = find_name(key)
    return with_unit(between.join(filter(None, (name.words, name.formula))), unit)


def with_unit(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} ({raised(unit)})" if unit else name


@functools.cache
def listed(topic: str) -> dict[str, list]:
    """What `spintop list TOPIC --json` gives, from its copy.

    scripts/manual_tables renews the copies, and a test compares them.
    """
    return json.loads(Path(__file__).with_name(f"{topic}.json").read_text(encoding="utf-8"))


def columns_of(study: str) -> dict[str, dict]:
    """The columns of a kind of study by name: unit, description, and whether they hold words."""
    return {
        column["name"]: column
        for column in listed("columns")["columns"]
        if column["study"] == study
    }


@functools.cache
def units_of_columns() -> dict[str, str]:
    """The units of the columns of all kinds of study by name; empty where there is none."""
    return {column["name"]: column["unit"] or "" for column in listed("columns")["columns"]}


@functools.cache
def column_units() -> dict[tuple[str, str], dict]:
    """Other units of columns, by the unit of a column and the suffix of its name."""
    return {(unit["of"], unit["suffix"]): unit for unit in listed("columns")["column_units"]}


def column_of(name: str) -> tuple[str, dict | None]:
    """The column that a name is of, and the unit that it says, if that is not the column's own."""
    own, (column, _, suffix) = units_of_columns(), name.rpartition("_")
    unit = None if name in own else column_units().get((own.get(column), suffix))
    return (column, unit) if unit else (name, None)


def converted_to(unit: str, other: str) -> tuple[float, str] | None:
    """How many of another unit one unit is, and that unit; None where they differ in kind.

    The other may be the suffix of a name, as in `phi_rate_deg`, whose unit is deg/s.
    """
    unit, other = ("deg" if each == UNIT_WORDS["deg"] else each for each in (unit, other))
    known = column_units().items()
    sizes = {own: each["size"] for (own, _), each in known if each["unit"] == unit}
    found = (
        (sizes[own] / each["size"], each["unit"])
        for (own, suffix), each in known
        if own in sizes and other in (suffix, each["unit"])
    )
    return (1.0, unit) if unit == other else next(found, None)


def number_in(text: object, unit: str) -> float:
    """A number, which may have another unit behind it, in a unit; else there is a ValueError."""
    number, given = re.fullmatch(r"\s*([-+]?[\d.]+(?:e[-+]?\d+)?)?(.*)", str(text), re.I).groups()
    found = converted_to(given.strip() or unit, unit)
    if not found or number is None:
        raise ValueError(f"{text!r} is no number" + f" in {unit}" * bool(unit))
    return float(number) * found[0]


def shown_in(words: str, unit: str) -> tuple[float, str]:
    """The factor to the unit that is asked for an axis that has these words, and the unit."""
    for key, other in UNITS.get().items():
        keys = (key, f"initial.{key}") if key else ()
        known = {named(each).replace("$", "") for each in keys for named in (name_of, axis_of)}
        found = converted_to(unit, other)
        if found and (not key or words.replace("$", "") in known):
            return found[0], UNIT_WORDS.get(found[1], found[1])
    return 1.0, unit


@functools.cache
def words_of(study: str) -> frozenset[str]:
    """The columns of words in the tables of a kind of study; all others hold numbers."""
    own = {name for name, column in columns_of(study).items() if column["words"]}
    return frozenset({"program", *own, *listed("columns")["other_words"]})  # by scripts/compare


@functools.cache
def good_ends() -> frozenset[str]:
    """The statuses of motions that were computed to their end."""
    return frozenset(status["name"] for status in listed("statuses")["statuses"] if status["good"])


def is_good_end(status: object) -> bool:
    """Whether a status is that of a good end; more words may follow, as in `at_rest at t = 3`."""
    return re.split(r"[ :]", str(status), maxsplit=1)[0] in good_ends()


def ended_well(rows: pd.DataFrame) -> pd.Series:
    """Which rows have a status of a good end."""
    return rows["status"].isin(good_ends())


def count_failures(rows: pd.DataFrame) -> dict[str, int]:
    """How many rows there are with each other status, the most frequent first."""
    return rows["status"][~ended_well(rows)].value_counts().to_dict()
