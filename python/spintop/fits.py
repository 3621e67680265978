"""Fits of numbers of an input to measurements."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spintop.calls import Progress
from spintop.inputs import check_groups, names_in, numbers, plain, read_input, without_places
from spintop.library import InputError
from spintop.results import Result
from spintop.runs import call_run, find_column


def fit(
    data: Mapping[str, ArrayLike],
    unknown: str | Sequence[str],
    given: Mapping[str, Mapping[str, Any]],
    *,
    sigma: float | Sequence[float] | Mapping[str, ArrayLike] | None = None,
    profile: bool = True,
    progress: Progress = False,
) -> Result:
    """Find numbers of an input from measurements: `{"t": [...], "theta": [...]}`.

    `data` has the times (s) and columns of trajectories, in their units, or in those that their
    names end in, as `{"t_ms": [...], "theta_deg": [...]}`; a pandas frame will do. `nan` is no
    reading. `unknown` names the sought numbers, as `top.inertia(3)` or `offset.theta`; their values
    in `given`, the groups of the input, are where the search begins. `sigma` is the standard
    deviation of all columns or of each, in their units, in their order or by their names, where an
    array has one per row; without it one that is common to all is estimated. The tables of the
    result are `rows`, a row per parameter, and `residuals`, which `plot` of the result draws. It is
    not `ok` if the search does not converge, the data do not determine the parameters, or the
    motion does not explain the data. Other keys of the group `fit`, as `loss`, and groups `sensor`
    may stand in `given`. The `warnings` of the result say what is odd about the data and the
    residuals. `progress` and Ctrl-C are as for `run`; the share grows with starts and intervals.
    """
    check_groups(data, "data")
    check_groups(given, "given")
    columns = measurements(data)
    if isinstance(sigma, Mapping):
        columns |= deviations(sigma, columns)
        sigma = None
    wanted = {"unknown": names_in(unknown), "sigma": sigma, "profile": profile}

    with written_input(columns, wanted, given) as scene:
        path = str(scene["fit"]["data"])
        with without_places(scene, path):
            text, name = read_input(scene)
            result = Result(call_run(text, name, None, 0, progress), name)
        result.warnings = plain(result.warnings, path)
        return result


def measurements(data: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
    """The columns of measurements, of one length, with their times."""
    time = time_of(data)
    columns = {name: numbers(values, name) for name, values in data.items()}
    lengths = {name: column.shape for name, column in columns.items()}
    for name, shape in lengths.items():
        if len(shape) != 1 or shape != lengths[time]:
            raise InputError(f"{name} has the shape {shape}, but {time} {lengths[time]}", code=2)
    return columns


def time_of(data: Mapping[str, ArrayLike]) -> str:
    """The name of the times: `t`, or `t_ms` and the like."""
    if name := find_column(data, "t", "s")[0]:
        return name
    raise InputError("the measurements have no times: give t, in s from the start", code=2)


def deviations(
    sigma: Mapping[str, ArrayLike], columns: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Standard deviations by the names of columns, as columns with one per row."""
    time = time_of(columns)
    measured = [name for name in columns if name != time]
    for name in [*sigma, *measured]:
        if name not in measured:
            raise InputError(f"sigma: {name} is not measured", code=2)
        if name not in sigma:
            raise InputError(f"sigma: that of {name} is missing", code=2)
    given = {name: numbers(values, f"sigma of {name}") for name, values in sigma.items()}
    for name, values in given.items():
        if values.shape not in ((), columns[time].shape):
            raise InputError(f"sigma: {name} has the shape {values.shape}", code=2)
    return {
        f"{name}_sigma": np.broadcast_to(values, columns[time].shape)
        for name, values in given.items()
    }


@contextmanager
def written_input(
    columns: Mapping[str, np.ndarray],
    wanted: Mapping[str, Any],
    given: Mapping[str, Mapping[str, Any]],
) -> Iterator[dict[str, Mapping[str, Any]]]:
    """The input of a fit, whose measurements are in a file for as long."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "measured.csv"
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        groups = {name.lower(): keys for name, keys in given.items()}
        own = {"study": {"kind": "fit"}, "fit": {"data": str(path), **wanted}}
        for name, keys in own.items():
            others = {key.lower(): value for key, value in groups.get(name, {}).items()}
            if twice := [key for key in keys if key in others and (name, key) != ("study", "kind")]:
                raise InputError(f"{name}.{twice[0]} is an argument of fit", code=2)
            groups[name] = others | keys
        yield groups
