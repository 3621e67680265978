"""Runs of inputs, and sweeps over arrays."""

import ctypes
import json
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spintop.calls import Progress, call
from spintop.inputs import Input, names_in, numbers, plain, read_input, thread_count, without_places
from spintop.library import (
    CResult,
    InputError,
    bytes_of,
    columns_of,
    library,
    new_place,
    raise_error,
)
from spintop.results import Figures, Result

if TYPE_CHECKING:
    from spintop_figures.tables.table import Table as FileTable


def run(
    given: Input,
    *,
    columns: str | Sequence[str] | None = None,
    folder: str | Path | None = None,
    threads: int = 0,
    progress: Progress = False,
) -> Result:
    """Run an input: a path, the text of one, or a dictionary of its groups.

    The result has the tables in memory. With a folder they are also written there, as by the
    program. `columns` are those of the group `output` of a dictionary. `threads` 0 takes all cores.
    `progress` is True for a line on standard error, or a function that is called with the share
    that is done, from 0 to 1. An InputError has the message of the program with file, line and
    column; a motion that ends early is a result that is not `ok`. Ctrl-C ends the call.
    """
    given = with_columns(given, columns)
    read = read_input(given)
    with without_places(given):
        place = call_run(*read, None if folder is None else str(folder), threads, progress)
    result = Result(place, read[1])
    if isinstance(given, Mapping):
        result.warnings = plain(result.warnings)
    return result


def with_columns(given: Input, columns: str | Sequence[str] | None) -> Input:
    """An input of groups with columns in its group `output`."""
    if columns is None:
        return given
    if not isinstance(given, Mapping):
        message = "columns are an argument for a dictionary: here they are the key output.columns"
        raise InputError(message, code=2)
    return {**given, "output": {**given.get("output", {}), "columns": names_in(columns)}}


def call_run(
    text: str, name: str, folder: str | None, threads: int, progress: Progress = False
) -> "ctypes._Pointer[CResult]":
    """Run the text of an input."""
    place = new_place()
    where = None if folder is None else bytes_of(folder)
    threads = thread_count(threads)
    arguments = (bytes_of(text), bytes_of(name), where, threads, place)
    result = call(library().spintop_run, *arguments, progress=progress)
    raise_error(place)
    return result


def sweep(
    given: Input,
    parameters: Mapping[str, ArrayLike],
    *,
    columns: str | Sequence[str] | None = None,
    threads: int = 0,
    progress: Progress = False,
) -> Result:
    """Run a sweep over arrays: `{"initial.theta": [...], "top.length": [...]}`, side by side.

    `given` is an input without a group `sweep`. Arrays have one shape, or shapes that numpy
    broadcasts to one, which the columns of the table have, too: `theta[:, None]` with a `rate` of
    one dimension is a grid. Failed cases have a status and a note. Without parameters there is
    one case. `columns`, `progress` and Ctrl-C are as for `run`.
    """
    given = with_columns(given, columns)
    text, name = read_input(as_sweep(given))
    named = {name: np.atleast_1d(numbers(values, name)) for name, values in parameters.items()}
    try:
        arrays = [np.ascontiguousarray(array) for array in np.broadcast_arrays(*named.values())]
    except ValueError as error:
        raise InputError(f"the arrays have different shapes: {error}", code=2) from error
    grid = grid_of(named, arrays[0].shape) if arrays and arrays[0].ndim > 1 else None
    columns = columns_of(dict(zip(parameters, arrays, strict=True)))
    count, place = arrays[0].size if arrays else 0, new_place()
    asked = (bytes_of(text), *columns, count, thread_count(threads), place)
    result = call(library().spintop_sweep, *asked, progress=progress)
    with without_places(given):
        raise_error(place)
    return Result(result, name, grid)


def as_sweep(given: Input) -> Input:
    """An input of groups whose kind of study, where it has none, is a sweep."""
    if not isinstance(given, Mapping):
        return given
    study = given.get("study", {})
    if not isinstance(study, Mapping) or "kind" in study:
        return given
    return {**given, "study": {"kind": "sweep", **study}}


def grid_of(named: Mapping[str, np.ndarray], shape: tuple[int, ...]) -> dict[str, np.ndarray]:
    """The dimensions of arrays that are broadcast together, with the values along each.

    A dimension has the name of the first parameter that varies along it alone.
    """
    grid: dict[str, np.ndarray] = {}
    for axis, length in enumerate(shape):
        alone = tuple(length if i == axis else 1 for i in range(len(shape)))
        along = (name for name, array in named.items() if name not in grid and fits(array, alone))
        name = next(along, f"axis{axis + 1}")
        grid[name] = named[name].ravel() if name in named else np.arange(length)
    return grid


def fits(array: np.ndarray, shape: tuple[int, ...]) -> bool:
    """Whether an array has a shape, in which leading dimensions of length 1 may be left out."""
    return array.size > 1 and (1,) * (len(shape) - array.ndim) + array.shape == shape


def registry(topic: str = "") -> Any:
    """What `spintop list TOPIC --json` shows, as lists and dictionaries; without a topic all."""
    place = new_place()
    text = library().spintop_list(bytes_of(topic) if topic else None, 1, place)
    raise_error(place)
    try:
        return json.loads(ctypes.string_at(text))
    finally:
        free(text)


def find_column(there: Container[str], name: str, unit: str) -> tuple[str, float]:
    """The name of a column with its own unit, or with another one, and the size of that.

    The name is empty if none is there; without a unit a column has no other one.
    """
    if name in there:
        return name, 1.0
    others = registry("columns")["column_units"] if unit else ()
    names = {f"{name}_{each['suffix']}": each["size"] for each in others if each["of"] == unit}
    return next(((known, size) for known, size in names.items() if known in there), ("", 1.0))


def free(address: int) -> None:
    """Free memory that the library allocated for its caller."""
    release = ctypes.CDLL(None).free
    release.argtypes = [ctypes.c_void_p]
    release(address)


def read(path: str | Path) -> "FileTable":
    """Read a table that the program wrote: its rows as a data frame, units, settings, status."""
    from spintop_figures.tables.table import read_table

    return read_table(Path(path))


def plot(table: "FileTable | str | Path", *names: str, **options: object) -> Figures:
    """Draw the figures that `scripts/plot` draws of a table, or those named: figures by name.

    The options are those of `spintop_figures.draw`: width, title, dark, style, font_size,
    decimal_comma; with y there is one figure `columns` of these columns over x, with log and range.
    A notebook shows them; each is a figure of matplotlib, with `savefig`.
    """
    from spintop_figures.registry import choose_figures, draw
    from spintop_figures.style.look import Options
    from spintop_figures.tables.table import TableError

    if isinstance(table, str | Path):
        table = read(table)
    if options.get("y"):
        return Figures({"columns": draw(table, **options)})
    asked = Options(**options)
    kinds, problems = choose_figures(table, list(names) or None)
    if problems:
        raise TableError("; ".join(problems))
    return Figures((kind.name, kind.draw(table, asked)) for kind in kinds)
