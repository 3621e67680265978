"""NetCDF tables of spintop, classic or NetCDF-4, as xarray reads them by netCDF4."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from spintop_figures.tables.characters import TableError, printable
from spintop_figures.tables.names import unit_of_netcdf
from spintop_figures.tables.table import (
    NOTE,
    Table,
    check_program,
    problem_of_cells,
    read_head,
    stride_of,
)

if TYPE_CHECKING:
    from xarray import Variable


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


def read_netcdf_table(path: Path) -> Table:
    """Read the NetCDF table of a sweep, of a trajectory, or of statistics."""
    try:
        return table_of(path, *read_netcdf(path))
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise TableError("is damaged or cut short") from error


def table_of(path: Path, found: dict[str, object], variables: dict[str, "Variable"]) -> Table:
    """The table that a NetCDF file holds."""
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
    if problem := said and problem_of_cells(said, list(numbers.values())):
        raise TableError(problem)
    cells = {name: in_words(columns[name], values)[::stride] for name, values in numbers.items()}
    known |= {"units": attributes(columns, "units"), "meanings": attributes(columns, "long_name")}
    note = "" if said else NOTE
    return Table(**known, rows=pd.DataFrame(cells), status=status, stride=stride, note=note)


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


def attributes(columns: dict[str, "Variable"], name: str) -> dict[str, str]:
    """An attribute of each column, empty if it has none; units as tables of texts have them."""
    texts = {column: printable(each.attrs.get(name, "")) for column, each in columns.items()}
    return {c: unit_of_netcdf(t) for c, t in texts.items()} if name == "units" else texts
