"""Inputs of the program as dictionaries: groups of keys with their values."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from spintop.library import InputError

Input = str | Path | Mapping[str, Mapping[str, Any]]
"""A path of an input, the text of one (with at least one `&`), or its groups as a dictionary."""


def literal(value: Any) -> str:
    """A value as it stands in a namelist: numbers in the shortest form that gives the same bits."""
    if isinstance(value, bool | np.bool_):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, float | np.floating):
        if not np.isfinite(value):
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
    if np.ndim(value) == 0:
        return [f"{key} = {literal(np.asarray(value)[()])}"]
    if len(value) and all(row is None or is_list(row) for row in value):
        rows = [(i, row) for i, row in enumerate(value, 1) if row is not None]
        return [line for i, row in rows for line in assignments(f"{key}({i},:)", row)]
    return [f"{key} = {', '.join(literal(element) for element in value)}"]


def namelist(groups: Mapping[str, Mapping[str, Any]]) -> str:
    """The text of an input: a line per assignment; None omits a key."""
    lines = []
    for group, keys in groups.items():
        lines.append(f"&{group}")
        for key, value in keys.items():
            if value is not None:
                lines += [f"    {line}" for line in assignments(key, value)]
        lines.append("/")
    return "\n".join(lines) + "\n"


def read_input(given: Input) -> tuple[str, str]:
    """The text of an input, and its name in messages."""
    if isinstance(given, Mapping):
        return namelist(given), "input"
    if isinstance(given, str) and "&" in given:
        return given, "input"
    path = Path(given)
    try:
        return path.read_text(encoding="utf-8", errors="surrogateescape"), str(path)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}", code=2) from error
