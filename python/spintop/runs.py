"""Runs of inputs, sweeps over arrays and fits: long calls, with progress and an end by Ctrl-C."""

import ctypes
import json
import sys
import tempfile
import threading
from collections.abc import Callable, Container, Mapping, Sequence
from concurrent.futures import Future, wait
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from spintop import inputs
from spintop.library import PROGRESS, InputError, ask, library
from spintop.results import Figures, Result

if TYPE_CHECKING:
    from spintop_figures.tables.table import Table as FileTable


Progress = bool | Callable[[float], object]
"""True for a line on standard error, or a function of the share that is done, from 0 to 1."""
Measurements = Mapping[str, ArrayLike]
"""The columns of a run by their names."""
PAUSE = 0.1
"""Seconds between two reports of the progress, and until a signal is handled at the latest."""


def call(name: str, *arguments: Any, progress: Progress = False) -> Any:
    """Ask a function of the library that may take long, in a thread of its own.

    The calling thread waits for signals and reports. What interrupts it, as Ctrl-C does, stops the
    call. A signal does not end a waiting that begins just after it, nor is the waiting thread told
    of one that another takes: it looks for signals after each pause.
    """
    if progress is not True and progress and not callable(progress):
        raise InputError("progress is True, or a function of the share that is done", code=2)
    report = show if progress is True else progress or (lambda share: None)
    done, stops, ended = 0.0, False, Future()

    def answer(share: float, _: object) -> int:
        """Note how far the call is, and say whether it is to stop."""
        nonlocal done
        done = share
        return int(stops)

    asks = PROGRESS(answer)

    def work() -> None:
        try:
            library().spintop_on_progress(asks, None)
            ended.set_result(ask(name, *arguments))
        except BaseException as error:
            ended.set_exception(error)

    # A thread whose `join` is interrupted is taken to have ended by some versions of Python.
    thread = threading.Thread(target=work, daemon=True)
    try:
        thread.start()
        while not wait([ended], PAUSE).done:
            report(done)
    except BaseException:
        stops = True
        while thread.ident and not ended.done():
            with suppress(KeyboardInterrupt):
                wait([ended])
        raise
    result = ended.result()
    report(1.0)
    return result


def show(share: float) -> None:
    """Show the share that is done, in one line."""
    end = "\n" if share >= 1 else ""
    print(f"\rspintop: {share:4.0%}", end=end, file=sys.stderr, flush=True)


def run(
    given: inputs.Input,
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
    return run_input(with_columns(given, columns), folder, threads, progress)


def run_input(
    given: inputs.Input, folder: str | Path | None, threads: int, progress: Progress, *paths: str
) -> Result:
    """Run an input; messages of one by groups have no places in a text, and no paths of files."""
    text, name = inputs.read_input(given)
    where = None if folder is None else str(folder)
    with inputs.without_places(given, *paths):
        place = call("run", text, name, where, inputs.thread_count(threads), progress=progress)
    result = Result(place, name)
    if isinstance(given, Mapping):
        result.warnings = inputs.plain(result.warnings, *paths)
    return result


def with_columns(given: inputs.Input, columns: str | Sequence[str] | None) -> inputs.Input:
    """An input of groups with columns in its group `output`."""
    if columns is None:
        return given
    if not isinstance(given, Mapping):
        message = "columns are an argument for a dictionary: here they are the key output.columns"
        raise InputError(message, code=2)
    return {**given, "output": {**given.get("output", {}), "columns": inputs.names_in(columns)}}


def sweep(
    given: inputs.Input,
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
    study = given.get("study", {}) if isinstance(given, Mapping) else None
    if isinstance(study, Mapping):
        given = {**given, "study": {"kind": "sweep", **study}}
    text, name = inputs.read_input(given)
    named = {
        name: np.atleast_1d(inputs.numbers(values, name)) for name, values in parameters.items()
    }
    try:
        arrays = [np.ascontiguousarray(array) for array in np.broadcast_arrays(*named.values())]
    except ValueError as error:
        raise InputError(f"the arrays have different shapes: {error}", code=2) from error
    grid = grid_of(named, arrays[0].shape) if arrays and arrays[0].ndim > 1 else None
    count, threads = arrays[0].size if arrays else 0, inputs.thread_count(threads)
    with inputs.without_places(given):
        axes = dict(zip(parameters, arrays, strict=True))
        return Result(call("sweep", text, axes, count, threads, progress=progress), name, grid)


def grid_of(named: Mapping[str, np.ndarray], shape: tuple[int, ...]) -> dict[str, np.ndarray]:
    """The dimensions of arrays that are broadcast together, with the values along each.

    A dimension has the name of the first parameter that varies along it alone.
    """
    grid: dict[str, np.ndarray] = {}
    sizes = {name: (1,) * (len(shape) - array.ndim) + array.shape for name, array in named.items()}
    for axis, length in enumerate(shape):
        along = (name for name, array in named.items() if 1 < array.size == sizes[name][axis])
        name = next((name for name in along if name not in grid), f"axis{axis + 1}")
        grid[name] = named[name].ravel() if name in named else np.arange(length)
    return grid


def registry(topic: str = "") -> Any:
    """What `spintop list TOPIC --json` shows, as lists and dictionaries; without a topic all."""
    text = ask("list", topic or None, 1)
    try:
        return json.loads(ctypes.string_at(text))
    finally:
        ctypes.CDLL(None).free(ctypes.c_void_p(text))


def find_column(there: Container[str], name: str, unit: str) -> tuple[str, float]:
    """The name of a column with its own unit, or with another one, and the size of that.

    The name is empty if none is there; without a unit a column has no other one.
    """
    if name in there:
        return name, 1.0
    others = registry("columns")["column_units"] if unit else ()
    names = {f"{name}_{each['suffix']}": each["size"] for each in others if each["of"] == unit}
    return next(((known, size) for known, size in names.items() if known in there), ("", 1.0))


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


def fit(
    data: Measurements | Sequence[Measurements],
    unknown: str | Sequence[str],
    given: Mapping[str, Mapping[str, Any]],
    *,
    columns: Mapping[str, str] | Sequence[str] | None = None,
    unknown_each: str | Sequence[str] | Mapping[str, Sequence[float] | None] = (),
    sigma: float | Sequence[float] | Measurements | Sequence[Measurements] | None = None,
    profile: bool = True,
    progress: Progress = False,
) -> Result:
    """Find numbers of an input from measurements: `{"t": [...], "theta": [...]}`.

    `data` has the times (s) and columns of trajectories, in their units, or in those that their
    names end in, as `{"t_ms": [...], "theta_deg": [...]}`; a pandas frame will do, whose index may
    have the times as dates or time differences. `columns` maps others, with their units, as
    `{"t": "time (ms)", "omega1": "gx (dps)"}`, or names the measured ones. `nan` is no reading.
    A list of such data has several runs of the body. `unknown` names the sought numbers, as
    `top.inertia(3)` or `offset.theta`; their values in `given`, the groups of the input, are where
    the search begins. `unknown_each` names those of which each run has its own, `initial.*` and
    `offset.*`; a mapping gives each the values of the runs where the search begins. `sigma` is the
    standard deviation of all columns or of each, in their units, in their order or by their names,
    where an array has one per row; a list of such mappings has one for each run; without it each
    column has its own, which is estimated. The tables of the result are `rows`, a row per
    parameter, and `residuals`, of the second run `residuals2` ..., which `plot` of the result
    draws. It is not `ok` if the search does not converge, the data do not determine the parameters,
    or the motion does not explain the data. Other keys of the group `fit`, as `loss`, and groups
    `sensor` may stand in `given`. The `warnings` of the result say what is odd about the data and
    the residuals. `progress` and Ctrl-C are as for `run`; the share grows with starts and
    intervals.
    """
    runs = [*data] if inputs.is_list(data) else [data]
    named = [each for each in sigma if isinstance(each, Mapping)] if inputs.is_list(sigma) else []
    by_run = named or [sigma] * len(runs)
    if len(by_run) != len(runs):
        raise InputError(f"sigma: {len(by_run)} for {len(runs)} runs", code=2)
    inputs.check_groups(given, "given")
    mapped = columns if isinstance(columns, Mapping) else {}
    tables = [measurements(*each, mapped) for each in zip(runs, by_run, strict=True)]
    known = None if named or isinstance(sigma, Mapping) else sigma
    own: dict[str, Any] = {"data": (), "sigma": known, "profile": profile}
    own |= {
        "unknown": inputs.names_in(unknown) or None,
        "unknown_each": inputs.names_in(unknown_each) or None,
    }
    own["start_each"] = [*unknown_each.values()] if isinstance(unknown_each, Mapping) else None
    if columns is not None:
        pairs = (f"{name} = {source}" for name, source in mapped.items())
        own["columns"] = tuple(pairs) if mapped else inputs.names_in(columns)
    scene = {name.lower(): keys for name, keys in given.items()}
    study, others = (
        {key.lower(): value for key, value in scene.get(name, {}).items()}
        for name in ("study", "fit")
    )
    if twice := [key for key in own if key in others]:
        raise InputError(f"fit.{twice[0]} is an argument of fit", code=2)
    with tempfile.TemporaryDirectory() as folder:
        for number, table in enumerate(tables, 1):
            path = Path(folder) / f"measured{number}.csv"
            cells = ([str(each) for each in column.tolist()] for column in table.values())
            lines = [",".join(map(quoted, table)), *map(",".join, zip(*cells, strict=True))]
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            own["data"] += (str(path),)
        scene |= {"study": study | {"kind": "fit"}, "fit": others | own}
        return run_input(scene, None, 0, progress, *own["data"])


def quoted(text: object) -> str:
    """A text as a cell of a table."""
    return '"' + " ".join(str(text).replace('"', "'").split()) + '"'


def readings(values: ArrayLike, name: str, is_time: bool, takes_words: bool) -> np.ndarray:
    """An array of numbers, or of cells with dates; with other words where these may stand."""
    array = np.asanyarray(values)
    if array.dtype.kind == "M" and (is_time or takes_words):
        return np.datetime_as_string(array.astype("M8[ns]"))
    if array.dtype.kind == "m" and (is_time or takes_words):
        return array / np.timedelta64(1, "s")
    if array.dtype.kind in "OU" and (takes_words or hasattr(next(array.flat, 0), "isoformat")):
        return np.array([quoted(each) for each in array.flat]).reshape(array.shape)
    return inputs.numbers(values, name)


def measurements(
    data: Measurements, sigma: Any, mapped: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """The columns of a run, of one length, and those of deviations given by their names."""
    inputs.check_groups(data, "data")
    given = dict(data.items())
    time = find_column(given, "t", "s")[0] or find_column(mapped, "t", "s")[0]
    if not time and np.asanyarray(getattr(data, "index", 0)).dtype.kind in "mMO":
        given, time = {"t": data.index} | given, "t"
    if not (time and given):
        hint = 'give t, in s from the start, or map it: columns={"t": "NAME (ms)", ...}'
        raise InputError(f"the measurements have no times: {hint}", code=2)
    columns = {
        str(name): readings(each, str(name), name == time, bool(mapped))
        for name, each in given.items()
    }
    first = time if time in columns else next(iter(columns))
    shape = columns[first].shape
    for name, column in columns.items():
        if column.ndim != 1 or column.shape != shape:
            shapes = f"{name} has the shape {column.shape}, but {first} {shape}"
            raise InputError(shapes, code=2)
    if not isinstance(sigma, Mapping):
        return columns
    measured = [name for name in mapped or columns if name != time]
    for name in [*sigma, *measured]:
        if name not in measured:
            raise InputError(f"sigma: {name} is not measured", code=2)
        if name not in sigma:
            raise InputError(f"sigma: that of {name} is missing", code=2)
        values = inputs.numbers(sigma[name], f"sigma of {name}")
        if values.shape not in ((), shape):
            raise InputError(f"sigma: {name} has the shape {values.shape}", code=2)
        columns[f"{name}_sigma"] = np.broadcast_to(values, shape)
    return columns
