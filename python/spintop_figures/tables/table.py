"""Reading a table of spintop, of text or NetCDF: its header, its rows, its status.

And its columns in other units than their own: `theta_deg` is the column `theta` in degrees.
"""

import csv
import io
import itertools
import re
import tempfile
import zlib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from spintop_figures.tables.names import (
    column_of,
    converted_to,
    name_of,
    number_in,
    unit_shown,
    units_of_columns,
    words_of,
)

if TYPE_CHECKING:
    from xarray import Variable

NOTE = "does not end with the number and the checksum of its rows: it may have been cut or changed"
"""The note on a table of an earlier version."""

FORMAT = "1"
"""Format of the tables that can be read."""

BESIDE = {"event": "events", "bin": "statistics", "column": "histogram"}
"""The tables beside those of studies, by their first columns. One of events may have no rows."""

VALUE = re.compile(r"'((?:[^']|'')*)'|([^\s,]+)")
ASSIGNMENT = re.compile(r"([a-z]\w*(?:\([^)]*\))?)\s*=\s*(.*)", re.IGNORECASE)
COLUMN = re.compile(r"(\S+?)(?:\s+\[(.*?)\])?:\s*(.*)")
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?inf|nan", re.IGNORECASE | re.ASCII)

END = re.compile(r"(\d+) rows, CRC-32 ([0-9A-F]{8})")
HEAD, END_KEY = re.compile(rb"(#.*\n)*"), b"\n# end: "
"""The head of a table, and what begins the last line of a complete one, as in `# end: 20 rows,
CRC-32 9C2E1F05`. The CRC-32 is zlib's, over all bytes from the line of names to the last line. In
NetCDF the attribute `end` says the same of the rows as 64-bit numbers, row by row."""


class TableError(Exception):
    """What is wrong with a table, in one line."""


def printable(text: object) -> str:
    """The text with whatever a terminal would obey or not know written as an escape sequence.

    Control characters, those that change the direction of writing, and bytes of a file name that
    are none of the locale's encoding become `\\x1b`, `\\u202e` and the like.
    """
    text = str(text)
    if text.isprintable():
        return text
    # bytes of a file name are surrogates, \\udc80 and above
    escaped = (ascii(each)[1:-1].replace("udc", "x") for each in text)
    return "".join(
        own if own.isprintable() else other for own, other in zip(text, escaped, strict=True)
    )


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
        if "factor" in self.rows:
            return "indices"
        return BESIDE.get(self.rows.columns[0], self.setting("study.kind"))

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

    def column(self, name: str) -> np.ndarray:
        """The numbers of a column."""
        return self.rows[name].to_numpy(float)

    def shown(self, name: str, unit: str = "") -> tuple[np.ndarray, str]:
        """The numbers of a column as they are drawn, and their unit, this one if none is told."""
        unit, factor = unit_shown(name, self.units.get(name) or unit)
        return self.column(name) * factor, unit

    def finite(self, column: str) -> np.ndarray:
        """Which rows have a finite number in a column."""
        return np.isfinite(self.column(column))

    def axes(self) -> list[str]:
        """The swept parameters: the columns between `case` and `status`."""
        return swept(list(self.rows.columns))


def cases_at(table: Table, at: Mapping[str, object]) -> Table:
    """The cases of a sweep that are nearest to values of swept parameters, which then are none."""
    rows, told = table.rows, []
    if not at:
        return table
    for name, value in at.items():
        if name not in table.axes() or len(table.axes()) - len(at) < 1:
            raise TableError(f"has no {name} among several swept parameters, for a value of it")
        unit = table.units.get(name, "")
        try:
            nearest = rows[name].iloc[(rows[name] - number_in(value, unit)).abs().argmin()]
        except ValueError as wrong:
            raise TableError(str(wrong)) from None
        rows = rows[rows[name] == nearest].drop(columns=name)
        told.append(f"{name_of(name)} {nearest:.6g} {unit}".strip())
    title = "; ".join(filter(None, (table.title, *told)))
    return replace(table, rows=rows.reset_index(drop=True), header=table.header | {"title": title})


def swept(names: list[str]) -> list[str]:
    """The swept parameters among the columns of a sweep."""
    if names[0] != "case" or "status" not in names:
        return []
    return names[1 : names.index("status")]


def read_table(path: str | Path) -> Table:
    """Read a table, or raise a TableError that says why it is none."""
    path = Path(path)
    try:
        if path.suffix != ".nc":
            return table_of_text(path, path.read_bytes())
        return table_of_netcdf(path, *read_netcdf(path))
    except OSError as error:
        raise TableError((error.strerror or str(error)).lower()) from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        if path.suffix != ".nc":
            raise
        raise TableError("is damaged or cut short") from error


def table_in_memory(
    path: Path, frame: str, columns: Mapping[str, np.ndarray], others: Mapping[str, Table]
) -> Table:
    """A table in memory as if it were read from this file, the text of which is without rows."""
    table = table_of_text(path, frame.encode("utf-8"), columns)
    return replace(table, frame=frame, others=others)


def lines_of_text(data: bytes) -> tuple[list[str], list[str], list[str]]:
    """The lines of a table before, in and after its rows; of the head the last names the columns.

    A mark of UTF-8, and other ends of lines than line feeds, are taken away.
    """
    text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    first = next((i for i, line in enumerate(lines) if line and line[0] != "#"), len(lines))
    last = max((i for i, line in enumerate(lines) if line and line[0] != "#"), default=first)
    return lines[: first + 1], lines[first + 1 : last + 1], lines[last + 1 :]


def table_of_text(
    path: Path, data: bytes, columns: Mapping[str, np.ndarray] | None = None
) -> Table:
    """The table in a text; its rows are there, or else they are columns in memory."""
    head, inside, last = lines_of_text(data)
    if "\0" in "".join(head[:1]):
        raise TableError("is no table of spintop: it is no text in UTF-8")
    lines = [*head, *inside, *last]
    if number := next((number for number, line in enumerate(lines, 1) if "\0" in line), 0):
        raise TableError(f"line {number} has a byte of value 0: the file is damaged")
    head, inside, last = ([*map(printable, part)] for part in (head, inside, last))
    has_names = not head[-1].startswith("#") and bool(head[-1])
    *top, names_line = head if has_names else [*head, ""]
    header, settings, units, meanings = read_head([line[1:].strip() for line in top])
    check_program(header)
    if not data.endswith((b"\n", b"\r")):
        raise TableError("is cut short: its last line has no end")
    notes = [line[1:].strip() for line in (*inside, *last) if line.startswith("#")]
    status = next((line[7:].strip() for line in notes if line.startswith("status:")), None)
    kind = settings.get("study.kind", [""])[0]
    if kind == "trajectory" and status is None:
        raise TableError("is cut short: its last line, the status, is missing")
    if not has_names:
        raise TableError("is cut short: it names no columns")
    names = names_of(len(head), names_line)
    body = [
        (number, line)
        for number, line in enumerate(inside, start=len(head) + 1)
        if line and not line.startswith("#")
    ]
    stride = stride_of(kind, names, len(body) if columns is None else len(columns[names[0]]))
    if columns is None:
        rows = read_rows(names, body[::stride], words_of(kind))
    else:
        rows = rows_of({name: columns[name][::stride] for name in names})
    if rows.empty and names[0] != "event":
        raise TableError("has no rows" + (f" (status: {status})" if status else ""))
    if problem := problem_of_text(data) if columns is None else "":
        raise TableError(problem + place_of(names, body))
    said = tuple(line[9:].strip() for line in notes if line.startswith("in words:"))
    note = NOTE if problem is None else ""
    columns_said = (header, settings, units, meanings)
    return Table(path, *columns_said, rows, status, stride, input_of(top), said, note)


def problem_of_text(data: bytes) -> str | None:
    """What is wrong with a table; None if nothing is known to be, as there is no such line.

    The answer is empty for a table that is as it was written.
    """
    before, end, said = data.replace(b"\r\n", b"\n").rpartition(END_KEY)
    if not end:
        return None
    if said.find(b"\n") != len(said) - 1:
        return 'was changed after it was written: lines follow the one that begins with "# end:"'
    rows = HEAD.sub(b"", before + b"\n", 1)
    count = sum(not line.startswith(b"#") for line in rows.splitlines()) - 1
    return compare(said.decode("ascii", errors="replace").strip(), count, zlib.crc32(rows))


def compare(said: str, rows: int, crc: int) -> str:
    """How the end of a table differs from what is there; empty if it does not."""
    match = END.fullmatch(said)
    if match and int(match[1]) == rows and int(match[2], 16) == crc:
        return ""
    if match and int(match[1]) != rows:
        difference = f"it has {rows} rows, and its end says {match[1]}"
    else:
        difference = "its rows do not have the CRC-32 of its end"
    return f"was changed after it was written: {difference}"


def check_program(header: Mapping[str, str]) -> None:
    """Refuse what is no table of spintop, or one of another format than that known here."""
    if not header.get("program", "").startswith("spintop"):
        raise TableError("is no table of spintop: its header names no program")
    found = header.get("format", f"0 ({header['program']})")
    if found != FORMAT:
        known = f"figures are drawn of format {FORMAT}"
        raise TableError(f"is a table of format {printable(found)}, and {known}: write it again")


def stride_of(kind: str, names: list[str], count: int) -> int:
    """How many rows there are for one that a figure can show."""
    is_long = kind == "sweep" and count > 20_000 and len(swept(names)) == 1
    return count // 5_000 if is_long else 1  # about so many are kept


def names_of(number: int, line: str) -> list[str]:
    """The names of the columns, which stand in this line."""
    names = cells_in(number, line)
    for place, name in enumerate(names):
        if not name.strip():
            raise TableError(f"line {number}: column {place + 1} has no name")
        if not re.fullmatch(r"[^\s;\\]+", name):
            wrong = "has a space or a separator in its name"
            raise TableError(f"line {number}: column {place + 1} {wrong}")
        if name in names[:place]:
            raise TableError(f"line {number}: there are two columns {name}")
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
        is_number = pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column)
        if name in words or is_number:
            continue
        for (number, _), cell in zip(body, map(str, column), strict=True):
            if is_word(cell):
                cell = printable(cell if len(cell) <= 40 else f"{cell[:40]}...")
                raise TableError(f"line {number}: '{cell}' in {name} is no number")
        rows[name] = [float(cell) for cell in column]  # integers that are too long for 64 bits
    return rows


def rows_of(columns: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """The rows of columns in memory, as they are read from a file: whole numbers are integers."""
    rows = pd.DataFrame(columns)
    for name, values in columns.items():
        is_number = values.dtype.kind == "f" and values.size
        if is_number and (values % 1 == 0).all() and np.abs(values).max() < 2.0**53:
            rows[name] = values.astype(np.int64)
    return rows


def is_word(cell: object) -> bool:
    """Whether a cell holds something that is no number."""
    if isinstance(cell, bool):
        return True
    return not isinstance(cell, int | float | np.number) and not NUMBER.fullmatch(str(cell).strip())


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


def in_own_units(table: Table, wanted: Iterable[str] = ()) -> Table:
    """The table with all its columns in their own units too, in which figures are drawn.

    And with those that are wanted in other units, as their names say: `theta_deg` of `theta`.
    """
    for name in table.rows:
        column, unit = column_of(name)
        if unit and column not in table.rows:
            table = with_column(table, column, name, unit["size"], unit["of"])
    for name in wanted:
        column, _, suffix = name.rpartition("_")
        if suffix and name not in table.rows and column in table.rows:
            own = table.units.get(column) or units_of_columns().get(column, "")
            if found := converted_to(own, suffix):
                table = with_column(table, name, column, *found)
    return table


def with_column(table: Table, name: str, other: str, factor: float, unit: str) -> Table:
    """The table with one more column, which is so many times another one."""
    meanings = table.meanings | {name: table.meanings.get(other, "")}
    rows = table.rows.assign(**{name: table.rows[other] * factor})
    return replace(table, rows=rows, units=table.units | {name: unit}, meanings=meanings)


def read_netcdf(path: Path) -> tuple[dict[str, object], dict[str, "Variable"]]:
    """The attributes of a file and its variables in their order, with numbers as they stand there.

    A data set of xarray would have coordinates before all others.
    """
    try:
        import netCDF4  # noqa: F401
        from xarray.backends import NetCDF4DataStore
    except ImportError as error:
        raise TableError(
            "is read by the Python packages netCDF4 and xarray, which are not installed: `pip "
            "install netCDF4 xarray`, in a checkout `.venv/bin/pip install --no-deps netCDF4 "
            "xarray cftime certifi -c scripts/requirements.lock`"
        ) from error
    if path.stat().st_size == 0:
        raise TableError("is empty")
    try:
        # The library takes no name that is not in the encoding of the locale.
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder, "table.nc")
            link.symlink_to(path.absolute())
            with NetCDF4DataStore.open(link) as store:
                variables, attributes = store.load()
                return dict(attributes), {name: each.load() for name, each in variables.items()}
    except (OSError, RuntimeError, ValueError) as error:
        raise TableError("is no NetCDF file, or is damaged or cut short") from error


def table_of_netcdf(
    path: Path, found: dict[str, object], variables: dict[str, "Variable"]
) -> Table:
    """The table that a NetCDF file holds: of a sweep, of a trajectory, or of statistics."""
    header = {key: str(value) for key, value in found.items()}
    lines = [printable(line) for line in header.pop("input", "").split("\n")]
    said = header.pop("end", "")
    header = {key: printable(text) for key, text in header.items()}
    check_program(header)
    settings = read_head([line.strip() for line in lines])[1]
    known = {"path": path, "header": header, "settings": settings, "input": "\n".join(lines)}
    columns = {printable(each.attrs["column"]): each for each in variables.values()}
    if not columns:
        raise TableError("has no columns")
    grid = columns.get("case", next(iter(columns.values())))
    status = header.pop("status", None)
    if grid.size == 0:
        raise TableError("has no rows" + (f" (status: {status})" if status else ""))
    stride = stride_of(settings.get("study.kind", [""])[0], list(columns), grid.size)
    numbers = {name: each.set_dims(grid.sizes).values.ravel() for name, each in columns.items()}
    rows = np.column_stack([column.astype("<f8") for column in numbers.values()])
    if problem := said and compare(said, len(rows), zlib.crc32(rows.tobytes())):
        raise TableError(problem)
    cells = {name: in_words(columns[name], values)[::stride] for name, values in numbers.items()}
    known["units"], known["meanings"] = (
        {name: printable(each.attrs.get(key, "")) for name, each in columns.items()}
        for key in ("units", "long_name")
    )
    known["units"] = {name: unit_of_netcdf(unit) for name, unit in known["units"].items()}
    note = "" if said else NOTE
    return Table(**known, rows=pd.DataFrame(cells), status=status, stride=stride, note=note)


def unit_of_netcdf(text: str) -> str:
    """A unit of a NetCDF table, in which UDUNITS knows the words, as tables of texts have it."""
    own = {"degree": "deg", "revolution": "rev", "standard_free_fall": "g0"}
    return "" if text == "1" else re.sub(r"^[^ */^]+", lambda word: own.get(word[0], word[0]), text)


def in_words(variable: "Variable", values: np.ndarray) -> np.ndarray:
    """The cells of a column: numbers, or the words that stand for their values or their bits."""
    words = str(variable.attrs.get("flag_meanings", "")).split()
    if "flag_values" in variable.attrs:
        return np.array(words)[values]
    if "flag_masks" in variable.attrs:
        masks = [int(mask) for mask in np.atleast_1d(variable.attrs["flag_masks"])]
        pairs = list(zip(masks, words, strict=True))
        texts = {bits: "; ".join(w for m, w in pairs if bits & m) for bits in set(values.tolist())}
        return np.array([texts[bits] for bits in values.tolist()])
    return values
