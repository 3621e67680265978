"""Fits of numbers of an input to measurements."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spintop.inputs import names_in, numbers, read_input
from spintop.library import InputError
from spintop.results import Figures, Result
from spintop.runs import call_run, figures_of


def fit(
    data: Mapping[str, ArrayLike],
    unknown: str | Sequence[str],
    given: Mapping[str, Mapping[str, Any]],
    *,
    sigma: float | Sequence[float] | None = None,
    profile: bool = True,
) -> Result:
    """Find numbers of an input from measurements: `{"t": [...], "theta": [...]}`.

    `data` has the times (s) and columns of trajectories, in their units; a pandas frame will do.
    `unknown` names the sought numbers, as `top.inertia(3)`; their values in `given`, the groups of
    the input, are where the search begins. `sigma` is the standard deviation of all columns or of
    each, in their units; without it one that is common to all is estimated. The tables of the
    result are `rows`, a row per parameter, and `residuals`, which `plot` of the result draws. It is
    not `ok` if the search does not converge, or if the data do not determine the parameters.
    Other keys of the group `fit`, as `loss`, may stand in `given`. The `warnings` of the result
    say what is odd about the data and the residuals.
    """
    columns = {name: numbers(values, name) for name, values in data.items()}
    if "t" not in columns or len({column.shape for column in columns.values()}) != 1:
        raise InputError("the measurements need `t`, and columns of its length", code=2)
    wanted = {"unknown": names_in(unknown), "sigma": sigma, "profile": profile}

    def draw(*names: str) -> Figures:
        """Draw the figures of the fit, which is repeated."""
        with written_input(columns, wanted, given) as scene:
            return figures_of(read_input(scene), 0, *names)

    with written_input(columns, wanted, given) as scene:
        return Result(call_run(*read_input(scene), None, 0), draw)


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
