"""Reading a table of spintop: its head of `#` lines, its rows, its status."""

import io
import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from figures.netcdf import FormatError, Variable, cells_of, read_netcdf

EVENT = "event"
"""First column of a table of events, which may have no rows."""

MANY_CASES = 20_000
"""Rows of a sweep over one parameter beyond which only some are kept, about KEPT_CASES."""
KEPT_CASES = 5_000
UNITS = {"1": "", "degree": "deg"}
"""Units that NetCDF tables name otherwise, as UDUNITS knows them."""
VALUE = re.compile(r"'((?:[^']|'')*)'|([^\s,]+)")
ASSIGNMENT = re.compile(r"([a-z]\w*(?:\([^)]*\))?)\s*=\s*(.*)", re.IGNORECASE)
COLUMN = re.compile(r"(\S+?)(?:\s+\[(.*?)\])?:\s*(.*)")


class TableError(Exception):
    """What is wrong with a table, in one line."""


@dataclass(frozen=True)
class Table:
    """A table that was read.

    `header` holds the `key: value` lines of its head, `settings` the resolved input by
    `group.key` and `input` as text, `units` and `meanings` those of the columns, `status` how a
    trajectory ended, `words` what a work-precision study says below its rows. Of a long sweep over
    one parameter only every `stride`-th row is kept, more than a figure can show.
    """

    path: Path
    header: dict[str, str]
    settings: dict[str, list[str]]
    units: dict[str, str]
    meanings: dict[str, str]
    rows: pd.DataFrame
    status: str | None
    stride: int = 1
    input: str = ""
    words: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """The title that the input gives."""
        return self.header.get("title", "")

    @property
    def kind(self) -> str:
        """The kind of the study, or `events` for the table of a trajectory's events."""
        return "events" if self.rows.columns[0] == EVENT else self.setting("study.kind")

    def setting(self, key: str) -> str:
        """The first value of a setting, such as study.kind; empty if it has none."""
        return self.settings.get(key, [""])[0]

    def missing(self, columns: Iterable[str]) -> list[str]:
        """Those of these columns that are not there."""
        return [name for name in columns if name not in self.rows]

    def empty(self, columns: Iterable[str]) -> list[str]:
        """Those of these columns that are there but have no finite number."""
        there = [name for name in columns if name in self.rows]
        return [name for name in there if not (self.numeric(name) and self.finite(name).any())]

    def numeric(self, column: str) -> bool:
        """Whether a column holds numbers, and no words."""
        return pd.api.types.is_numeric_dtype(self.rows[column])

    def finite(self, column: str) -> np.ndarray:
        """Which rows have a finite number in a column."""
        return np.isfinite(self.rows[column].to_numpy(float))

    def axes(self) -> list[str]:
        """The swept parameters: the columns between `case` and `status`."""
        return swept(list(self.rows.columns))


def swept(names: list[str]) -> list[str]:
    """The swept parameters among the columns of a sweep."""
    if names[0] != "case" or "status" not in names:
        return []
    return names[1 : names.index("status")]


def read_table(path: Path) -> Table:
    """Read a table, or raise a TableError that says why it is none."""
    return read_netcdf_table(path) if path.suffix == ".nc" else read_text_table(path)


def read_netcdf_table(path: Path) -> Table:
    """Read the NetCDF table of a sweep."""
    try:
        attributes, variables = read_netcdf(path)
    except OSError as error:
        raise TableError((error.strerror or str(error)).lower()) from error
    except FormatError as error:
        raise TableError(str(error)) from error
    if not str(attributes.get("program", "")).startswith("spintop"):
        raise TableError("is no table of spintop: its attributes name no program")
    header = {key: str(value) for key, value in attributes.items()}
    resolved = header.pop("input", "")
    lines = resolved.split("\n")
    _, settings, _, _ = read_head([line.strip() for line in lines])
    columns = {str(variable.attributes["column"]): variable for variable in variables.values()}
    stride = stride_of(settings, list(columns), columns["case"].values.size)
    cells = {name: cells_of(column, columns["case"]) for name, column in columns.items()}
    rows = pd.DataFrame({name: native(column[::stride]) for name, column in cells.items()})
    units = {name: attribute(column, "units") for name, column in columns.items()}
    meanings = {name: attribute(column, "long_name") for name, column in columns.items()}
    return Table(path, header, settings, units, meanings, rows, None, stride, resolved)


def attribute(variable: Variable, name: str) -> str:
    """An attribute of a variable, empty if it has none; a unit as tables of texts have it."""
    text = str(variable.attributes.get(name, ""))
    return UNITS.get(text, text) if name == "units" else text


def native(cells: np.ndarray) -> np.ndarray:
    """Cells in the byte order of this machine."""
    return cells.astype(cells.dtype.newbyteorder("="))


def stride_of(settings: dict[str, list[str]], names: list[str], count: int) -> int:
    """How many rows there are for one that a figure can show."""
    is_long = settings.get("study.kind") == ["sweep"] and count > MANY_CASES
    return count // KEPT_CASES if is_long and len(swept(names)) == 1 else 1


def read_text_table(path: Path) -> Table:
    """Read a table of texts."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise TableError((error.strerror or str(error)).lower()) from error
    lines = text.splitlines() if "\r\n" in text else text.split("\n")
    first = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    header, settings, units, meanings = read_head([line[1:].strip() for line in lines[:first]])
    if not header.get("program", "").startswith("spintop"):
        raise TableError("is no table of spintop: its head names no program")
    if not text.endswith("\n"):
        raise TableError("is cut short: its last line has no end")
    body = [line for line in lines[first:] if line and not line.startswith("#")]
    last = [line[1:].strip() for line in lines[first:] if line.startswith("#")]
    status = next((line[7:].strip() for line in last if line.startswith("status:")), None)
    if settings.get("study.kind") == ["trajectory"] and status is None:
        raise TableError("is cut short: its last line, the status, is missing")
    if not body:
        raise TableError("is cut short: it names no columns")
    stride = stride_of(settings, body[0].split(","), len(body) - 1)
    rows = read_rows([body[0], *body[1::stride]], first + 1)
    if rows.empty and not body[0].startswith(f"{EVENT},"):
        raise TableError("has no rows" + (f" (status: {status})" if status else ""))
    resolved = input_of(lines[:first])
    words = tuple(line[9:].strip() for line in last if line.startswith("in words:"))
    return Table(path, header, settings, units, meanings, rows, status, stride, resolved, words)


def input_of(head: list[str]) -> str:
    """The resolved input in the lines of a head, without what marks it as a comment."""
    lines = [line.removeprefix("# ") for line in head]
    if "input:" not in lines:
        return ""
    below = lines[lines.index("input:") + 1 :]
    inside = itertools.takewhile(lambda line: line.startswith("    "), below)
    return "\n".join(line.removeprefix("    ") for line in inside)


def read_head(
    lines: list[str],
) -> tuple[dict[str, str], dict[str, list[str]], dict[str, str], dict[str, str]]:
    """The `key: value` lines of a head, the resolved input, units and meanings of the columns."""
    header: dict[str, str] = {}
    settings: dict[str, list[str]] = {}
    units: dict[str, str] = {}
    meanings: dict[str, str] = {}
    group = key = ""
    in_columns = False
    for line in lines:
        assignment = ASSIGNMENT.fullmatch(line)
        if line.startswith("&"):
            group, key = line[1:].strip().lower(), ""
        elif line == "/":
            group = ""
        elif group and assignment:
            key = f"{group}.{assignment[1].lower()}"
            settings[key] = read_values(assignment[2])
        elif group and key:
            settings[key] += read_values(line)
        elif line == "columns:":
            in_columns = True
        elif in_columns and (column := COLUMN.match(line)):
            units[column[1]] = column[2] or ""
            meanings[column[1]] = column[3]
        elif ":" in line:
            name, _, value = line.partition(":")
            header[name.strip().lower()] = value.strip()
    return header, settings, units, meanings


def read_values(text: str) -> list[str]:
    """The values of a namelist assignment, without their quotes."""
    return [word or quoted.replace("''", "'") for quoted, word in VALUE.findall(text)]


def read_rows(body: list[str], first: int) -> pd.DataFrame:
    """The rows below the line of column names, which is line `first` of the file.

    A column holds numbers or words, and is read as what its cells are.
    """
    names = body[0].split(",")
    for number, line in enumerate(body[1:], start=first + 1):
        cells = line.count(",") + 1
        if cells != len(names):
            raise TableError(f"line {number} has {cells} cells in place of {len(names)}")
    text = io.StringIO("\n".join(body))
    rows = pd.read_csv(text, keep_default_na=False, na_values=["nan"], low_memory=False)
    for name in rows if len(rows) else ():
        if pd.api.types.is_numeric_dtype(rows[name]):
            continue
        words = [is_word(cell) for cell in rows[name]]
        if not all(words) and any(words):
            bad = words.index(True)
            raise TableError(f"line {first + 1 + bad}: {rows[name][bad]!r} in {name} is no number")
    return rows


def is_word(cell: object) -> bool:
    """Whether a cell holds something that is no number."""
    try:
        float(cell)
    except ValueError:
        return True
    return False
