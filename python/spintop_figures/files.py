"""Figures of tables as files, and as messages where a table cannot be drawn."""

import multiprocessing
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from spintop_figures.kinds import FigureKind, as_list
from spintop_figures.style.look import DEFAULT, Options
from spintop_figures.style.page import save_as
from spintop_figures.tables.table import Table, TableError, in_own_units, printable

LARGEST = 1e150
"""Numbers beyond have squares and sums that overflow; a figure of them shows nothing. Of a run that
overflowed, as its status says, they are left out."""


def draw_to(
    kind: FigureKind,
    tables: Table | Sequence[Table],
    stem: Path,
    options: Options = DEFAULT,
    formats: Sequence[str] = ("png", "svg"),
) -> list[Path]:
    """Draw a figure to files, or raise a TableError that says why that cannot be."""
    given = map(without_overflow, as_list(tables))
    known = [in_own_units(table, kind.columns) for table in given]
    for table in known:
        for name in filter(table.numeric, kind.columns):
            if (np.abs(table.column(name)[table.finite(name)]) > LARGEST).any():
                message = f"has numbers beyond {LARGEST:g} in column {name}"
                raise TableError(f"{message}: no {kind.name} figure")
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            return save_as(kind.draw(known, options), stem, formats)
    except (OSError, TableError):
        raise
    except Exception as error:
        first = printable((str(error).splitlines() or [""])[0]) or type(error).__name__
        raise TableError(f"the {kind.name} figure cannot be drawn: {first}") from error


def draw_all(
    kinds: Sequence[FigureKind], table: Table, folder: Path, *asked: object
) -> Iterator[list[Path] | TableError]:
    """Draw figures of a table, at once on as many processors as there are; files or errors.

    What is asked of them, options and formats, is as for `draw_to`.
    """
    jobs[:] = [(kind, table, folder / f"{table.path.stem}_{kind.name}", *asked) for kind in kinds]
    workers = min(len(kinds), os.cpu_count() or 1)
    if workers < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from map(draw_job, range(len(jobs)))
        return
    sys.stdout.flush()  # what a child inherits would be written twice
    with ProcessPoolExecutor(workers, multiprocessing.get_context("fork")) as pool:
        yield from pool.map(draw_job, range(len(jobs)))


jobs: list[tuple] = []
"""What a child may draw, which it inherits: the rows of a table are not sent to it."""


def draw_job(number: int) -> list[Path] | TableError:
    """The files of a figure, or why it cannot be drawn, in a child."""
    try:
        return draw_to(*jobs[number])
    except TableError as error:
        return error


def without_overflow(table: Table) -> Table:
    """A run that overflowed without the numbers that are too large; any other table as it is."""
    if not (table.status or "").startswith("non_finite"):
        return table
    numbers = table.rows.select_dtypes("number")
    return replace(table, rows=table.rows.assign(**numbers.mask(numbers.abs() > LARGEST)))


def show_path(path: Path) -> None:
    """Print the name of a file: its own bytes, but a terminal gets what it can show."""
    stream = getattr(sys.stdout, "buffer", None)
    if stream is None:  # it takes texts only, of any characters
        print(printable(path))
        return
    name = os.fsencode(path)
    if sys.stdout.isatty():
        name = printable(path).encode(sys.stdout.encoding, "backslashreplace")
    sys.stdout.flush()
    stream.write(name + b"\n")
    stream.flush()
