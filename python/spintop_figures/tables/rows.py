"""The names of the columns of a table of texts, and its rows."""

import csv
import io
import re
from collections.abc import Collection, Iterable, Mapping

import numpy as np
import pandas as pd

from spintop_figures.tables.causes import TableError, spaces_in, wrong_separator
from spintop_figures.tables.characters import printable

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?inf|nan", re.IGNORECASE | re.ASCII)
LARGEST_INTEGER = 2.0**53
LONGEST = 40
"""Characters of a cell that a message quotes at most."""


def names_of(number: int, line: str) -> list[str]:
    """The names of the columns, which stand in this line."""
    if problem := wrong_separator(line):
        raise TableError(f"line {number}: {problem}")
    names = cells_in(number, line)
    for place, name in enumerate(names):
        if not name.strip():
            raise TableError(f"line {number}: column {place + 1} has no name")
        if spaces := spaces_in(name):
            raise TableError(f"line {number}: the name of column {place + 1} has {spaces}")
        if name in names[:place]:
            raise TableError(f"line {number}: there are two columns {printable(name)}")
    return names


def cells_in(number: int, line: str) -> list[str]:
    """The cells of this line; quotes are around those with a comma."""
    try:
        return next(csv.reader([line], strict=True)) if '"' in line else line.split(",")
    except csv.Error as error:
        raise TableError(f"line {number}: quotes must be around the whole cell") from error


def line_of(cells: Iterable[object]) -> str:
    """A line with these cells, with quotes around those with a comma."""
    return ",".join(f'"{cell}"' if "," in str(cell) else str(cell) for cell in cells)


def read_rows(
    names: list[str], body: list[tuple[int, str]], words: Collection[str] = ()
) -> pd.DataFrame:
    """The rows of columns with these names, from lines with their numbers in the file.

    The columns that hold words are named; all others hold numbers.
    """
    for number, line in body:
        cells = len(cells_in(number, line)) if '"' in line else line.count(",") + 1
        if cells != len(names):
            raise TableError(f"line {number} has {cells} cells in place of {len(names)}")
    rows = pd.read_csv(
        io.StringIO("\n".join([line_of(names), *(line for _, line in body)])),
        keep_default_na=False,
        na_values=["nan"],
        low_memory=False,
        lineterminator="\n",
        dtype={name: str for name in names if name in words},
    )
    for name in rows if len(rows) else ():
        column = rows[name]
        is_bool = pd.api.types.is_bool_dtype(column)
        if name in words or (pd.api.types.is_numeric_dtype(column) and not is_bool):
            continue
        wrong = [is_word(cell) for cell in column]
        if any(wrong):
            bad = wrong.index(True)
            cell = printable(str(column[bad]))
            cell = cell if len(cell) <= LONGEST else f"{cell[:LONGEST]}..."
            cause = f": it has {spaces}" if (spaces := spaces_in(str(column[bad]))) else ""
            where = f"line {body[bad][0]}: '{cell}' in {printable(name)}"
            raise TableError(f"{where} is no number{cause}")
        rows[name] = [float(cell) for cell in column]  # integers that are too long for 64 bits
    return rows


def rows_of(columns: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """The rows of columns in memory, as they are read from a file: whole numbers are integers."""
    rows = pd.DataFrame(columns)
    for name, values in columns.items():
        is_number = values.dtype.kind == "f" and values.size
        if is_number and (values % 1 == 0).all() and np.abs(values).max() < LARGEST_INTEGER:
            rows[name] = values.astype(np.int64)
    return rows


def is_word(cell: object) -> bool:
    """Whether a cell holds something that is no number."""
    if isinstance(cell, bool):
        return True
    return not isinstance(cell, int | float | np.number) and not NUMBER.fullmatch(str(cell).strip())
