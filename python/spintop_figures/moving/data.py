"""The data of a table in the page: the file itself, packed, or as many of its rows as fit."""

import base64
import gzip
from dataclasses import dataclass

import numpy as np

from spintop_figures.tables.table import Table, cells_in, line_of, lines_of_text, printable


@dataclass(frozen=True)
class Data:
    """A table of texts as it can be saved from the page, and how many of its rows it has."""

    name: str
    packed: bytes
    kept: int
    total: int
    stride: int
    of_cases: int = 1
    """Of a long sweep only one case in so many was read."""

    @property
    def size(self) -> int:
        """Bytes that it takes in the page."""
        return -(-len(self.packed) // 3) * 4

    @property
    def address(self) -> str:
        """The packed file as a data URI."""
        return f"data:application/gzip;base64,{base64.b64encode(self.packed).decode()}"

    @property
    def is_whole(self) -> bool:
        """Whether it has all rows."""
        return self.kept == self.total and self.of_cases == 1

    @property
    def which(self) -> str:
        """Which rows it has, in words."""
        cases = f", of one case in {self.of_cases}" if self.of_cases > 1 else ""
        if self.kept == self.total:
            return f"all {self.total:,} rows{cases}"
        return which_rows(self.stride, self.total) + cases


def which_rows(stride: int, total: int) -> str:
    """Which rows of a table are kept, in words: every 5th of 1,985 rows, and the last."""
    ends = {1: "st", 2: "nd", 3: "rd"}
    end = "th" if stride // 10 % 10 == 1 else ends.get(stride % 10, "th")
    return f"every {stride}{end} of {total:,} rows, and the last"


def lines_of(table: Table) -> tuple[list[str], list[str], list[str]]:
    """The lines of a table before, in and after its rows; written anew where it is no small CSV."""
    path = table.path
    if table.frame:
        # The checksum is that of the lines of a file.
        lines = [line for line in table.frame.split("\n") if not line.startswith("# end: ")]
        first = next(i for i, line in enumerate(lines) if not line.startswith("#")) + 1
        names = cells_in(first, lines[first - 1])
        return lines[:first], written_rows(table, names), lines[first:]
    # not once more for its own lines
    if path.suffix != ".csv" or path.stat().st_size > 64_000_000 or table.stride > 1:
        head = [f"# {key}: {value}" for key, value in table.header.items()]
        head += ["# input:", *(f"#     {line}" for line in table.input.splitlines())]
        names = [*table.rows.columns]
        return [*head, line_of(names)], written_rows(table, names), []
    return lines_of_text(path.read_bytes())


def written_rows(table: Table, names: list[str]) -> list[str]:
    """The rows of these columns as lines, with numbers as the program writes them."""
    texts = {name: table.rows[name].astype(str) for name in names}
    cells = [
        text.str.removesuffix(".0") if table.numeric(name) else text for name, text in texts.items()
    ]
    return [line_of(row) for row in zip(*cells, strict=True)]


def rows_kept(total: int, stride: int) -> np.ndarray:
    """Which rows are kept: one in so many, and the last."""
    return np.unique(np.append(np.arange(0, total, stride), max(total - 1, 0)))[:total]


def pack(table: Table, stride: int = 1) -> Data:
    """A table packed, with one row in so many and the last."""
    head, rows, foot = lines_of(table)
    keep = rows_kept(len(rows), stride)
    if stride > 1:
        note = f"# rows: one in {stride} of {len(rows)}, and the last"
        head = [*head[:-1], note, head[-1]]
        foot = [line for line in foot if not line.startswith("# end: ")]  # of all rows
    text = "\n".join([*head, *(rows[i] for i in keep), *(foot or [""])])
    packed = gzip.compress(text.encode("utf-8"), mtime=0)
    name = printable(table.path.with_suffix(".csv").name)
    return Data(name, packed, len(keep), len(rows), stride, table.stride)


def pack_all(tables: list[Table], room: int) -> list[Data]:
    """All tables packed so that they fit: those that are too large for their share have less rows.

    What smaller tables leave of their shares the larger ones have.
    """
    whole = [pack(table) for table in tables]
    shares = dict.fromkeys(range(len(tables)), 0)
    left, waiting = room, sorted(shares, key=lambda i: whole[i].size)
    for place, i in enumerate(waiting):
        # every table has some, whatever their number
        shares[i] = max(20_000, min(whole[i].size, left // (len(waiting) - place)))
        left = max(0, left - shares[i])
    packed = []
    for table, data, share in zip(tables, whole, shares.values(), strict=True):
        fitting = data
        while fitting.size > share and fitting.kept > 2:
            stride = max(fitting.stride + 1, -(-fitting.stride * fitting.size // share))
            fitting = pack(table, stride)
        packed.append(fitting)
    return packed
