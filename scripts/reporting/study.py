"""The tables of a study, and what a report says of each."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from reporting.cells import BOUND, proved_texts, texts_of
from reporting.pictures import Picture, pictures_of
from reporting.words import method_of
from spintop_figures.moving.motion import Data, refusal, rows_kept, which_rows
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import describe_end
from spintop_figures.tables.names import ended_well, is_good_end, name_of
from spintop_figures.tables.table import Table, TableError, in_own_units, printable, read_table

MOST_CELLS = 4_000
"""Of longer tables only some rows are shown."""


@dataclass
class Section:
    """A table, and what belongs to it."""

    table: Table
    anchor: str
    pictures: list[Picture]
    data: Data | None = None
    """The rows as they can be saved from the page."""
    cells: int = MOST_CELLS
    """How many cells of the table are shown at most."""
    mark: str = ""
    """What tells it from other tables of the same title."""

    @property
    def name(self) -> str:
        """The name of the file."""
        return printable(self.table.path.name)

    @property
    def title(self) -> str:
        """The title that the input gives, else the name of the file; and what tells it apart."""
        title = self.table.title or self.name
        return f"{title}: {self.mark}" if self.mark else title

    @property
    def outcome(self) -> str:
        """How it ended, or how many rows with which verdict or status, in a few words."""
        if self.table.status is not None:
            return describe_end(self.table.status)
        rows = self.table.rows
        column = next((name for name in ("verdict", "status") if name in rows), None)
        found = rows[column].value_counts() if column else {}
        counts = [f"{write_count(count)} {name_of(str(word))}" for word, count in found.items()]
        return f"all {counts[0]}" if len(counts) == 1 and self.size > 1 else ", ".join(counts)

    @property
    def size(self) -> int:
        """How many rows the table has."""
        return len(self.table.rows)

    @property
    def method(self) -> str:
        """The method that computed it, and the formulation under which it did."""
        return method_of(*self.table.model_and_method)

    @property
    def failed(self) -> bool:
        """Whether a motion or a case did not end well."""
        if self.table.status is not None:
            return not is_good_end(self.table.status)
        rows = self.table.rows
        if "verdict" in rows:  # to fail is a result, there
            return False
        return "status" in rows and not ended_well(rows).all()

    @property
    def moves(self) -> bool:
        """Whether the page can show the top move."""
        return not refusal(self.table)

    def is_proved(self, name: str) -> bool:
        """Whether a column has proved bounds beside it."""
        rows = self.table.rows
        bounds = name + BOUND
        return bounds in rows and self.table.numeric(name) and self.table.numeric(bounds)

    @property
    def has_proofs(self) -> bool:
        """Whether digits of the table are proved."""
        return any(self.is_proved(name) for name in self.table.rows)

    def texts(self, part: pd.DataFrame, name: str) -> list[str]:
        """The cells of a column as texts."""
        if self.is_proved(name):
            return proved_texts(list(part[name]), list(part[name + BOUND]))
        return texts_of(part[name])

    def shown_rows(self) -> tuple[list[list[str]], str]:
        """The rows to show as texts, and which those are; empty if they are all."""
        rows = self.table.rows
        total, most = len(rows), max(1, self.cells // len(rows.columns))
        stride = -(-total // most) if self.table.kind == "trajectory" else 1
        keep = rows_kept(total, stride) if stride > 1 else np.arange(min(total, most))
        which = f"the first {len(keep):,} of {total:,} rows" if len(keep) < total else ""
        if stride > 1:
            which = which_rows(stride, total)
        if self.table.stride > 1:
            which = f"{which or 'rows'}, of one case in {self.table.stride}"
        part = rows.iloc[keep]
        cells = [self.texts(part, name) for name in part]
        return [list(row) for row in zip(*cells, strict=True)], which


def list_tables(folder: Path) -> dict[Path, int]:
    """The files in a folder and below that may be tables, and when each was written (ns).

    Parts of sweeps are none.
    """
    files = [path for path in folder.rglob("*") if path.suffix in (".csv", ".nc")]
    found = sorted(path for path in files if path.is_file() and not is_part(path))
    return {path: path.stat().st_mtime_ns for path in found}


def find_tables(folder: Path, before: dict[Path, int] | None = None) -> list[Path]:
    """The tables in a folder and below, by name.

    Those that were written since `before` was listed come first, in the order in which they were
    written, which is that of the inputs on the command line.
    """
    found = list_tables(folder)
    if before is None:
        return list(found)
    fresh = [path for path in found if before.get(path) != found[path]]
    return sorted(fresh, key=found.get) + [path for path in found if path not in fresh]


def is_part(path: Path) -> bool:
    """Whether a table is one of the parts that `spintop merge` joins."""
    first, of, last = path.stem.rpartition(".")[2].partition("-of-")
    return bool(of) and first.isdigit() and last.isdigit()


def read_study(
    folder: Path, before: dict[Path, int] | None = None
) -> tuple[list[Section], list[str]]:
    """The sections of a report, and what is wrong with files that have none.

    Tables that were written since `before` was listed come first.
    """
    sections: list[Section] = []
    problems: list[str] = []
    for path in find_tables(folder, before):
        try:
            table = in_own_units(read_table(path))
            undrawn: list[str] = []
            pictures = pictures_of(table, undrawn)
        except TableError as error:
            problems.append(f"{printable(path.relative_to(folder))}: {error}")
            continue
        problems += [f"{printable(path.relative_to(folder))}: {problem}" for problem in undrawn]
        anchor = f"table-{len(sections) + 1}"
        sections.append(Section(table, anchor, pictures))
    tell_apart(sections)
    return sections, problems


def tell_apart(sections: list[Section]) -> None:
    """Give tables of the same title a mark each: what of the study it is, its method, its file."""
    marks = (
        lambda section: section.table.path.stem.partition(".")[2],
        lambda section: section.method,
        lambda section: section.name,
    )
    for mark in marks:
        titles = Counter(section.title for section in sections)
        for section in [section for section in sections if titles[section.title] > 1]:
            section.mark = mark(section)
