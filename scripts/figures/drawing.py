"""Figures of tables as files, and as messages where a table cannot be drawn."""

import sys
import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from figures.characters import printable
from figures.registry import FigureKind
from figures.style import save_as
from figures.table import Table, TableError

LARGEST = 1e150
"""Numbers beyond have squares and sums that overflow; a figure of them shows nothing. Of a run that
overflowed, as its status says, they are left out."""


def draw_to(kind: FigureKind, tables: Table | Sequence[Table], stem: Path) -> list[Path]:
    """Draw a figure to PNG and SVG, or raise a TableError that says why that cannot be."""
    alone = isinstance(tables, Table)
    known = [without_overflow(table) for table in ([tables] if alone else tables)]
    for table in known:
        if wide := too_large(table, kind.columns):
            raise TableError(f"{wide}: no {kind.name} figure")
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return save_as(kind.draw(known[0] if alone else known), stem)
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        first = printable((str(error).splitlines() or [""])[0]) or type(error).__name__
        raise TableError(f"the {kind.name} figure cannot be drawn: {first}") from error


def without_overflow(table: Table) -> Table:
    """A run that overflowed without the numbers that are too large; any other table as it is."""
    if not (table.status or "").startswith("non_finite"):
        return table
    rows = table.rows.copy()
    for name in rows.columns:
        if table.numeric(name):
            rows[name] = rows[name].where(~(rows[name].abs() > LARGEST))
    return replace(table, rows=rows)


def too_large(table: Table, columns: Sequence[str]) -> str:
    """Which of the numbers of a table are too large to be drawn; empty if none is."""
    for name in columns:
        if not table.numeric(name):
            continue
        values = np.abs(table.rows[name].to_numpy(float))
        if (values[np.isfinite(values)] > LARGEST).any():
            return f"has numbers beyond {LARGEST:g} in column {name}"
    return ""


def show_path(path: Path) -> None:
    """Print the name of a file: its own bytes, but a terminal gets what it can show."""
    print(printable(path) if sys.stdout.isatty() else path)
