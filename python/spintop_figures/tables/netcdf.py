"""Reading NetCDF tables of spintop, classic or NetCDF-4, by the package netCDF4."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spintop_figures.tables.causes import TableError

Attributes = dict[str, str | np.ndarray]


@dataclass(frozen=True)
class Variable:
    """A variable: the names of its dimensions, its attributes, its values."""

    dimensions: tuple[str, ...]
    attributes: Attributes
    values: np.ndarray


def read_netcdf(path: Path) -> tuple[Attributes, dict[str, Variable]]:
    """The attributes of a file and its variables."""
    try:
        from netCDF4 import Dataset
    except ImportError as error:
        raise TableError(
            "is read by the Python package netCDF4, which is not installed: `pip install netCDF4`, "
            "in a checkout `.venv/bin/pip install --no-deps -r scripts/requirements_netcdf.txt`"
        ) from error
    if path.stat().st_size == 0:
        raise TableError("is empty")
    try:
        # The library takes no name that is not in the encoding of the locale, and cannot open
        # every classic file in memory.
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder, "table.nc")
            link.symlink_to(path.absolute())
            with Dataset(link) as file:
                file.set_auto_maskandscale(False)
                variables = {
                    name: Variable(each.dimensions, attributes_of(each), each[...])
                    for name, each in file.variables.items()
                }
                return attributes_of(file), variables
    except (OSError, RuntimeError) as error:
        raise TableError("is no NetCDF file, or is damaged or cut short") from error


def attributes_of(place: object) -> Attributes:
    """The attributes of a file or of a variable: texts, and arrays of numbers."""
    found = {name: place.getncattr(name) for name in place.ncattrs()}
    return {
        name: value if isinstance(value, str) else np.atleast_1d(value)
        for name, value in found.items()
    }


def along(variable: Variable, grid: Variable) -> np.ndarray:
    """The values of a column in the order of the cases, which `grid` has all."""
    values = variable.values
    if variable.dimensions != grid.dimensions:
        axis = grid.dimensions.index(variable.dimensions[0])
        shape = [-1 if i == axis else 1 for i in range(grid.values.ndim)]
        values = np.broadcast_to(values.reshape(shape), grid.values.shape)
    return values.reshape(-1)


def cells_of(variable: Variable, grid: Variable) -> np.ndarray:
    """The cells of a column in the order of the cases, which `grid` has all: numbers or words."""
    values = along(variable, grid)
    if "flag_values" in variable.attributes:
        return np.array(str(variable.attributes["flag_meanings"]).split())[values]
    if "flag_masks" in variable.attributes:
        words = str(variable.attributes["flag_meanings"]).split()
        masks = [int(mask) for mask in variable.attributes["flag_masks"]]
        pairs = list(zip(masks, words, strict=True))
        texts = {bits: "; ".join(w for m, w in pairs if bits & m) for bits in set(values.tolist())}
        return np.array([texts[bits] for bits in values.tolist()])
    return values
