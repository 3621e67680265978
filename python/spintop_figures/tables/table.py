"""Reading a table of spintop: its header of `#` lines, its rows, its status."""

import itertools
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from spintop_figures.tables.causes import TableError, changed_header, plain
from spintop_figures.tables.characters import printable
from spintop_figures.tables.ending import problem_of_cells, problem_of_text
from spintop_figures.tables.names import unit_of_netcdf
from spintop_figures.tables.netcdf import Attributes, Variable, along, cells_of, read_netcdf
from spintop_figures.tables.rows import is_word, names_of, read_rows, rows_of
from spintop_figures.tables.words import words_of

NOTE = "does not end with the number and the checksum of its rows: it may have been cut or changed"
"""The note on a table of an earlier version."""

FORMAT = "1"
"""Format of the tables that can be read."""

BIN, COLUMN_NAME = "bin", "column"
"""First columns of the statistics of a sweep, and of their histograms."""
FACTOR = "factor"
"""A column of their Sobol' indices."""

EVENT = "event"
"""First column of a table of events, which may have no rows."""

MANY_CASES = 20_000
"""Rows of a sweep over one parameter beyond which only some are kept, about KEPT_CASES."""
KEPT_CASES = 5_000
VALUE = re.compile(r"'((?:[^']|'')*)'|([^\s,]+)")
ASSIGNMENT = re.compile(r"([a-z]\w*(?:\([^)]*\))?)\s*=\s*(.*)", re.IGNORECASE)
COLUMN = re.compile(r"(\S+?)(?:\s+\[(.*?)\])?:\s*(.*)")


@dataclass(frozen=True)
class Table:
    """A table that was read.

    `header` holds the `key: value` lines of its header, `settings` the resolved input by
    `group.key` and `input` as text, `units` and `meanings` those of the columns, `status` how a
    trajectory ended, `words` what a work-precision study says below its rows. Of a long sweep over
    one parameter only every `stride`-th row is kept, more than a figure can show. `note` is not
    empty if the table does not end with the number and the checksum of its rows, as this version
    writes them. Of a table in memory `frame` is the text of a file without the rows, and `others`
    has the tables of its run by their names; those of a file are beside it.
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
    note: str = ""
    frame: str = ""
    others: Mapping[str, "Table"] = field(default_factory=dict, repr=False)

    @property
    def title(self) -> str:
        """The title that the input gives."""
        return self.header.get("title", "")

    @property
    def kind(self) -> str:
        """The kind of the study, or of the table beside that of the study."""
        beside = {EVENT: "events", BIN: "statistics", COLUMN_NAME: "histogram"}
        if FACTOR in self.rows:
            return "indices"
        return beside.get(self.rows.columns[0], self.setting("study.kind"))

    def setting(self, key: str) -> str:
        """The first value of a setting, such as study.kind; empty if it has none."""
        return self.settings.get(key, [""])[0]

    def number(self, key: str, default: float = np.nan) -> float:
        """A number of the resolved input, or what holds without it."""
        text = self.setting(key)
        return default if not text or is_word(text) else float(text)

    @property
    def model_and_method(self) -> tuple[str, str]:
        """The formulation and the method that computed it, as its header names them."""
        model, method = (self.header.get(key, "").split(":")[0] for key in ("model", "method"))
        return model, method

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

    def has_words(self, column: str) -> bool:
        """Whether a column of words has no numbers alone; a problem may have any name."""
        return column == "problem" or self.rows.empty or any(map(is_word, self.rows[column]))

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


def read_table(path: str | Path) -> Table:
    """Read a table, or raise a TableError that says why it is none."""
    path = Path(path)
    return read_netcdf_table(path) if path.suffix == ".nc" else read_text_table(path)


def read_netcdf_table(path: Path) -> Table:
    """Read the NetCDF table of a sweep or of a trajectory."""
    try:
        return table_of_netcdf(path, *read_netcdf(path))
    except OSError as error:
        raise TableError((error.strerror or str(error)).lower()) from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise TableError("is damaged or cut short") from error


def table_of_netcdf(path: Path, attributes: Attributes, variables: dict[str, Variable]) -> Table:
    """The table that a NetCDF file holds."""
    if not str(attributes.get("program", "")).startswith("spintop"):
        raise TableError("is no table of spintop: its attributes name no program")
    texts = {key: str(value) for key, value in attributes.items()}
    check_format(texts)
    said = texts.pop("end", "")
    lines = [printable(line) for line in texts.pop("input", "").split("\n")]
    resolved = "\n".join(lines)
    header = {key: printable(text) for key, text in texts.items()}
    _, settings, _, _ = read_head([line.strip() for line in lines])
    if "all_cases" in variables:
        return table_of_statistics(path, header, settings, variables, resolved)
    columns = {printable(each.attributes["column"]): each for each in variables.values()}
    if not columns:
        raise TableError("has no columns")
    grid = columns.get("case", next(iter(columns.values())))
    status = header.pop("status", None)
    if grid.values.size == 0:
        raise TableError("has no rows" + (f" (status: {status})" if status else ""))
    stride = stride_of(settings, list(columns), grid.values.size)
    if problem := said and problem_of_cells(said, [along(each, grid) for each in columns.values()]):
        raise TableError(problem)
    cells = {name: cells_of(column, grid) for name, column in columns.items()}
    rows = pd.DataFrame({name: column[::stride] for name, column in cells.items()})
    units = {name: attribute(column, "units") for name, column in columns.items()}
    meanings = {name: attribute(column, "long_name") for name, column in columns.items()}
    note = "" if said else NOTE
    return Table(path, header, settings, units, meanings, rows, status, stride, resolved, (), note)


def table_of_statistics(
    path: Path,
    header: dict[str, str],
    settings: dict[str, list[str]],
    variables: dict[str, Variable],
    resolved: str,
) -> Table:
    """The statistics in a NetCDF file as a table: a row of all cases, then one of each bin."""
    over = variables["cases"].dimensions[::-1] if "cases" in variables else ()
    shape = tuple(variables[name].values.size for name in over[::-1])
    count = int(np.prod(shape)) if over else 0
    cells: dict[str, np.ndarray] = {BIN: np.arange(count + 1)}
    units, meanings = {}, {}
    none = [np.nan]
    for place, axis in enumerate(over):
        name = printable(variables[axis].attributes["column"])
        along = [-1 if i == len(over) - 1 - place else 1 for i in range(len(over))]
        ends = variables[f"{axis}_bounds"].values
        parts = {"": variables[axis].values, "_from": ends[:, 0], "_to": ends[:, 1]}
        for ending, values in parts.items():
            grid = np.broadcast_to(values.reshape(along), shape).reshape(-1)
            cells[name + ending] = np.concatenate([none, grid])
            units[name + ending] = attribute(variables[axis], "units")
            meanings[name + ending] = attribute(variables[axis], "long_name")
    for key, variable in variables.items():
        if not key.startswith("all_"):
            continue
        name = printable(variable.attributes["column"])
        of_bins = variables.get(key.removeprefix("all_"))
        grid = of_bins.values.reshape(-1) if of_bins else np.full(count, np.nan)
        cells[name] = np.concatenate([[float(variable.values)], grid])
        units[name], meanings[name] = attribute(variable, "units"), attribute(variable, "long_name")
    return Table(path, header, settings, units, meanings, pd.DataFrame(cells), None, 1, resolved)


def check_format(header: Mapping[str, str]) -> None:
    """Refuse a table of another format than the one that is known here."""
    found = header.get("format", f"0 ({header['program']})")
    if found != FORMAT:
        known = f"figures are drawn of format {FORMAT}"
        raise TableError(f"is a table of format {printable(found)}, and {known}: write it again")


def attribute(variable: Variable, name: str) -> str:
    """An attribute of a variable, empty if it has none; a unit as tables of texts have it."""
    text = printable(variable.attributes.get(name, ""))
    return unit_of_netcdf(text) if name == "units" else text


def stride_of(settings: dict[str, list[str]], names: list[str], count: int) -> int:
    """How many rows there are for one that a figure can show."""
    is_long = settings.get("study.kind") == ["sweep"] and count > MANY_CASES
    return count // KEPT_CASES if is_long and len(swept(names)) == 1 else 1


def read_text_table(path: Path) -> Table:
    """Read a table of texts."""
    try:
        data = plain(path.read_bytes())
    except OSError as error:
        raise TableError((error.strerror or str(error)).lower()) from error
    return table_of_text(path, data)


def table_in_memory(
    path: Path, frame: str, columns: Mapping[str, np.ndarray], others: Mapping[str, Table]
) -> Table:
    """A table in memory as if it were read from this file, the text of which is without rows."""
    table = table_of_text(path, frame.encode("utf-8"), columns)
    return replace(table, frame=frame, others=others)


def table_of_text(
    path: Path, data: bytes, columns: Mapping[str, np.ndarray] | None = None
) -> Table:
    """The table in a text; its rows are there, or else they are columns in memory."""
    text = data.decode("utf-8", errors="replace")
    lines = text.split("\n")
    first = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    if not text.replace("\n", "").replace("\0", "").isprintable():
        lines = [line if line.isprintable() else printable(line) for line in lines]
    header, settings, units, meanings = read_head([line[1:].strip() for line in lines[:first]])
    if not header.get("program", "").startswith("spintop"):
        cause = changed_header(lines) or "its header names no program"
        raise TableError(f"is no table of spintop: {cause}")
    check_format(header)
    if not text.endswith("\n"):
        raise TableError("is cut short: its last line has no end")
    if "\0" in text:
        number = text[: text.index("\0")].count("\n") + 1
        raise TableError(f"line {number} has a byte of value 0: the file is damaged")
    body = [
        (number, line)
        for number, line in enumerate(lines[first:], start=first + 1)
        if line and not line.startswith("#")
    ]
    last = [line[1:].strip() for line in lines[first:] if line.startswith("#")]
    status = next((line[7:].strip() for line in last if line.startswith("status:")), None)
    if settings.get("study.kind") == ["trajectory"] and status is None:
        raise TableError("is cut short: its last line, the status, is missing")
    if not body:
        raise TableError("is cut short: it names no columns")
    names = names_of(*body[0])
    if columns is None:
        stride = stride_of(settings, names, len(body) - 1)
        words = words_of(next(iter(settings.get("study.kind", ())), ""))
        rows = read_rows(names, body[1::stride], words)
    else:
        stride = stride_of(settings, names, len(columns[names[0]]))
        rows = rows_of({name: columns[name][::stride] for name in names})
    if rows.empty and names[0] != EVENT:
        raise TableError("has no rows" + (f" (status: {status})" if status else ""))
    if problem := problem_of_text(data) if columns is None else "":
        raise TableError(problem + place_of(names, body[1:]))
    resolved = input_of(lines[:first])
    said = tuple(line[9:].strip() for line in last if line.startswith("in words:"))
    note = NOTE if problem is None else ""
    return Table(
        path, header, settings, units, meanings, rows, status, stride, resolved, said, note
    )


def place_of(names: list[str], body: list[tuple[int, str]]) -> str:
    """Where the rows of a changed table are out of order, if they are known to be."""
    if names[0] not in ("case", "t"):
        return ""
    places = [float(line.split(",", 1)[0]) for _, line in body]
    for row, (before, place) in enumerate(itertools.pairwise(places), start=2):
        if place <= before or (names[0] == "case" and place != before + 1):
            return f"; row {row} (line {body[row - 1][0]}) is out of order: {names[0]} is {place:g}"
    return ""


def input_of(head: list[str]) -> str:
    """The resolved input in the lines of a header, without what marks it as a comment."""
    lines = [line.removeprefix("# ") for line in head]
    if "input:" not in lines:
        return ""
    below = lines[lines.index("input:") + 1 :]
    inside = itertools.takewhile(lambda line: line.startswith("    "), below)
    return "\n".join(line.removeprefix("    ") for line in inside)


def read_head(
    lines: list[str],
) -> tuple[dict[str, str], dict[str, list[str]], dict[str, str], dict[str, str]]:
    """The `key: value` lines of a header, the resolved input, units and meanings of the columns.

    The second of several groups of one name, such as part, has the name part(2).
    """
    header: dict[str, str] = {}
    settings: dict[str, list[str]] = {}
    units: dict[str, str] = {}
    meanings: dict[str, str] = {}
    groups: list[str] = []
    group = key = ""
    in_columns = False
    for line in lines:
        assignment = ASSIGNMENT.fullmatch(line)
        if line.startswith("&"):
            group, key = line[1:].strip().lower(), ""
            groups.append(group)
            if groups.count(group) > 1:
                group += f"({groups.count(group)})"
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
