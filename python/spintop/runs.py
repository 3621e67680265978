"""Runs of inputs, and sweeps over arrays."""

import ctypes
import json
import tempfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spintop.animation import Animation, animate
from spintop.inputs import Input, numbers, read_input, thread_count
from spintop.library import CResult, InputError, bytes_of, library, new_place, raise_error
from spintop.results import Result

if TYPE_CHECKING:
    from spintop_figures.tables.table import Table as FileTable


def run(given: Input, *, folder: str | Path | None = None, threads: int = 0) -> Result:
    """Run an input: a path, the text of one, or a dictionary of its groups.

    The result has the tables in memory. With a folder they are also written there, as by the
    program. `threads` 0 takes all cores. An InputError has the message of the program with file,
    line and column; a motion that ends early is a result that is not `ok`.
    """
    read = read_input(given)
    result = call_run(*read, None if folder is None else str(folder), threads)
    return Result(result, partial(figures_of, read, threads), partial(animation_of, read, threads))


def call_run(text: str, name: str, folder: str | None, threads: int) -> "ctypes._Pointer[CResult]":
    """Run the text of an input."""
    place = new_place()
    where = None if folder is None else bytes_of(folder)
    threads = thread_count(threads)
    result = library().spintop_run(bytes_of(text), bytes_of(name), where, threads, place)
    raise_error(place)
    return result


def sweep(given: Input, parameters: Mapping[str, ArrayLike], *, threads: int = 0) -> Result:
    """Run a sweep over arrays: `{"initial.theta": [...], "top.length": [...]}`, side by side.

    `given` is an input with study.kind = 'sweep' and without a group `sweep`. Arrays have one
    shape, or are single values. The table has a row per case, in their order; failed cases have
    a status and a note. Without parameters there is one case.
    """
    text, _ = read_input(given)
    arrays = [numbers(values, name) for name, values in parameters.items()]
    try:
        arrays = [np.ravel(array) for array in np.broadcast_arrays(*arrays)]
    except ValueError as error:
        raise InputError(f"the arrays have different shapes: {error}", code=2) from error
    arrays = [np.ascontiguousarray(array) for array in arrays]
    count = len(arrays)
    place = new_place()
    result = library().spintop_sweep(
        *(bytes_of(text), count),
        (ctypes.c_char_p * count)(*(bytes_of(name) for name in parameters)),
        (ctypes.c_void_p * count)(*(array.ctypes.data for array in arrays)),
        *(arrays[0].size if arrays else 0, thread_count(threads), place),
    )
    raise_error(place)
    return Result(result)


def registry(topic: str = "") -> Any:
    """What `spintop list TOPIC --json` shows, as lists and dictionaries; without a topic all."""
    place = new_place()
    text = library().spintop_list(bytes_of(topic) if topic else None, 1, place)
    raise_error(place)
    try:
        return json.loads(ctypes.string_at(text))
    finally:
        free(text)


def free(address: int) -> None:
    """Free memory that the library allocated for its caller."""
    release = ctypes.CDLL(None).free
    release.argtypes = [ctypes.c_void_p]
    release(address)


def read(path: str | Path) -> "FileTable":
    """Read a table that the program wrote: its rows as a data frame, units, settings, status."""
    from spintop_figures.tables.table import read_table

    return read_table(Path(path))


def plot(table: "FileTable | str | Path", *names: str) -> dict[str, Any]:
    """Draw the figures that `scripts/plot` draws of a table, or those named: figures by name."""
    from spintop_figures.registry import choose_figures
    from spintop_figures.tables.table import TableError

    if isinstance(table, str | Path):
        table = read(table)
    kinds, problems = choose_figures(table, list(names) or None)
    if problems:
        raise TableError("; ".join(problems))
    return {kind.name: kind.draw(table) for kind in kinds}


def figures_of(given: tuple[str, str], threads: int, *names: str) -> dict[str, Any]:
    """Draw the figures of a run, which is repeated into a folder."""
    with tempfile.TemporaryDirectory() as folder:
        call_run(*given, folder, threads)
        found: dict[str, Any] = {}
        for path in sorted(Path(folder).glob("*.csv")):
            is_main = "." not in path.stem
            if is_main or not names:
                found |= plot(path, *names)
        return found


def animation_of(given: tuple[str, str], threads: int) -> Animation:
    """Show the motion of a run, which is repeated into a folder."""
    with tempfile.TemporaryDirectory() as folder:
        call_run(*given, folder, threads)
        (path,) = (path for path in Path(folder).glob("*.csv") if "." not in path.stem)
        return animate(path)
