"""Inputs of the program as dictionaries: groups of keys with their values."""

import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from decimal import Decimal
from itertools import chain
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from spintop.library import InputError, SpintopError

Group = Mapping[str, Any] | Sequence[Mapping[str, Any]]
"""Keys with their values; a group that stands more than once, as `part`, is a list of such."""
Input = str | Path | Mapping[str, Group]
"""A path of an input, the text of one (with at least one `&`), or its groups as a dictionary."""
KEY = re.compile(r"([a-z]\w*)( *\([\d:, ]*\))?", re.ASCII | re.IGNORECASE)
"""A group or a key of an input, or elements of a key: `inertia`, `values(1,:)`."""
PLACED = re.compile(r"input(?::\d+:\d+)?: ((?:error|warning): .*)")
"""The first line of a message of the program with its place."""
SHOWN = re.compile(r" *\d* \|(?: *\^+(\.\.\.)?)?(?P<hint> .*)?")
"""A line of a message that shows the text of the input, or marks the place, with a hint."""


def frozen(value: Any) -> Any:
    """A copy of a value without arrays and numbers of numpy, and without lists that can change."""
    if isinstance(value, Mapping):
        return {key: frozen(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    return tuple(map(frozen, value)) if is_list(value) else value


def numbers(values: Any, what: str) -> np.ndarray:
    """An array of numbers; other things that numpy would convert, such as dates, are refused."""
    array = np.asanyarray(values)
    if np.ma.is_masked(array):
        raise InputError(f"{what}: masked values are no numbers; leave them out", code=2)
    is_real = array.dtype.kind in "biuf"
    if array.dtype.kind == "O":
        is_real = all(isinstance(value, Real | Decimal) for value in array.flat)
    if array.dtype.kind in "mM":
        hint = "give seconds as numbers: (x - x[0]) / numpy.timedelta64(1, 's')"
        raise InputError(f"{what}: dates and times are no numbers; {hint}", code=2)
    if not is_real:
        raise InputError(f"{what}: real numbers are wanted, not {array.dtype}", code=2)
    return np.asarray(array, dtype=np.float64)


def names_in(names: str | Sequence[str]) -> tuple[str, ...]:
    """Some names, or one."""
    return (names,) if isinstance(names, str) else tuple(names)


def thread_count(threads: int) -> int:
    """A number of threads, as the library takes it."""
    if threads not in range(4097):
        raise InputError(f"threads = {threads}: 0 (all cores) to 4096", code=2)
    return int(threads)


def literal(value: Any) -> str:
    """A value as it stands in a namelist: numbers in the shortest form that gives the same bits."""
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        if len(value.splitlines()) > 1 or value.endswith(("\n", "\r")):
            what = "has more than one line, and is no value of an input"
            raise InputError(f"{value!r} {what}", code=2)
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float | np.floating):
        if not math.isfinite(value):
            raise InputError(f"{value} is no value of an input", code=2)
        return repr(float(value))
    raise InputError(f"a {type(value).__name__} is no value of an input", code=2)


def is_list(value: Any) -> bool:
    """Whether a value has elements."""
    return isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)


def assignments(key: str, value: Any) -> list[str]:
    """The lines that assign a value, a list, or rows of lists (`key(1,:) = ...`)."""
    if not is_list(value):
        return [f"{key} = {literal(value)}"]
    if value and all(row is None or is_list(row) for row in value):
        rows = [(i, row) for i, row in enumerate(value, 1) if row is not None]
        return [line for i, row in rows for line in assignments(f"{key}({i},:)", row)]
    return [f"{key} = {', '.join(literal(element) for element in value)}"]


def check_groups(keys: Any, what: str) -> None:
    """Refuse what has no names with their values, as a dictionary or a frame of pandas has."""
    if not hasattr(keys, "items"):
        kind = type(keys).__name__
        raise InputError(f"{what}: names with their values are wanted, not {kind}", code=2)


def lines_of(group: str, keys: Mapping[str, Any]) -> list[str]:
    """The lines of a group: a line per assignment; None omits a key."""
    check_groups(keys, f"&{group}")
    for name, what in ((group, "group"), *((key, "key") for key in keys)):
        # another one would be read as something else in a namelist
        form = KEY.fullmatch(name) if isinstance(name, str) else None
        if form is None or (what == "group" and form[2]):
            raise InputError(f"{name!r} is no name of a {what}", code=2)
    given = (assignments(key, frozen(value)) for key, value in keys.items() if value is not None)
    return [f"&{group}", *(f"    {line}" for line in chain.from_iterable(given)), "/"]


def namelist(groups: Mapping[str, Group]) -> str:
    """The text of an input."""
    lines = []
    for group, keys in groups.items():
        for each in keys if is_list(keys) else [keys]:
            lines += lines_of(group, each)
    return "\n".join(lines) + "\n"


def plain(report: str, *paths: str) -> str:
    """Messages without lines of a text that was made of groups, and without the paths of files."""
    lines = []
    for path in paths:
        report = report.replace(f"{path}: ", "")
    for line in report.splitlines():
        if placed := PLACED.fullmatch(line):
            lines.append(placed[1])
        elif not (shown := SHOWN.fullmatch(line)):
            lines.append(line)
        elif "^" in line and shown["hint"]:
            lines.append(f"  {shown['hint'].strip()}")
    return "\n".join(lines)


@contextmanager
def without_places(given: Input, *paths: str) -> Iterator[None]:
    """Raise errors without places in a text that nobody wrote, if an input is given by groups."""
    try:
        yield
    except SpintopError as error:
        if isinstance(given, Mapping):
            error.args = (plain(str(error), *paths),)
            error.source, error.line, error.column = "", 0, 0
        raise


def read_input(given: Input) -> tuple[str, str]:
    """The text of an input, and its name in messages."""
    if isinstance(given, Mapping):
        return namelist(given), "input"
    if not isinstance(given, str | os.PathLike):
        check_groups(given, "input")
    if isinstance(given, str) and "&" in given:
        return given, "input"
    path = Path(given)
    try:
        return path.read_text(encoding="utf-8", errors="surrogateescape"), str(path)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}", code=2) from error
