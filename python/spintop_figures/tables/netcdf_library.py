"""Reading NetCDF tables in the format NetCDF-4, by the C library with which spintop wrote them."""

import ctypes
import ctypes.util
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from spintop_figures.tables.netcdf import Attributes, FormatError, Variable

GLOBAL = -1
"""The number of the file among its variables, for attributes."""
CHARACTERS = 2
LONGEST_NAME = 256
TYPES = {1: np.int8, 2: np.uint8, 3: np.int16, 4: np.int32, 5: np.float32, 6: np.float64}


class Library:
    """The library, whose calls raise an error where they fail."""

    def __init__(self) -> None:
        name = ctypes.util.find_library("netcdf")
        if name is None:
            raise FormatError(
                "is of the format NetCDF-4, and no NetCDF library is found to read it"
            )
        self.functions = ctypes.CDLL(name)
        self.functions.nc_strerror.restype = ctypes.c_char_p

    def call(self, name: str, *arguments: object) -> None:
        """Call a function of the library."""
        status = getattr(self.functions, name)(*arguments)
        if status:
            reason = self.functions.nc_strerror(status).decode(errors="replace")
            raise FormatError(f"cannot be read: {reason}")

    def integer(self, name: str, *arguments: object) -> int:
        """The result of a function that gives one integer."""
        found = ctypes.c_int()
        self.call(name, *arguments, ctypes.byref(found))
        return found.value

    def name(self, function: str, *arguments: object) -> str:
        """The result of a function that gives a name."""
        room = ctypes.create_string_buffer(LONGEST_NAME + 1)
        self.call(function, *arguments, room)
        return room.value.decode()

    @contextmanager
    def opened(self, path: Path) -> Iterator[int]:
        """The number of an open file."""
        file = self.integer("nc_open", str(path).encode(), 0)
        try:
            yield file
        finally:
            self.functions.nc_close(file)

    def attributes(self, file: int, variable: int, count: int) -> Attributes:
        """The attributes of a variable, or of the file."""
        found: Attributes = {}
        for place in range(count):
            name = self.name("nc_inq_attname", file, variable, place)
            length = ctypes.c_size_t()
            kind = ctypes.c_int()
            place_of = (ctypes.byref(kind), ctypes.byref(length))
            self.call("nc_inq_att", file, variable, name.encode(), *place_of)
            if kind.value not in TYPES:
                continue
            values = np.empty(length.value, TYPES[kind.value])
            self.call("nc_get_att", file, variable, name.encode(), address(values))
            found[name] = values.tobytes().decode() if kind.value == CHARACTERS else values
        return found

    def variable(self, file: int, number: int, dimensions: list[tuple[str, int]]) -> Variable:
        """A variable with all its values."""
        axes = (ctypes.c_int * self.integer("nc_inq_varndims", file, number))()
        self.call("nc_inq_vardimid", file, number, axes)
        own = self.attributes(file, number, self.integer("nc_inq_varnatts", file, number))
        shape = tuple(dimensions[axis][1] for axis in axes)
        values = np.empty(shape, TYPES[self.integer("nc_inq_vartype", file, number)])
        self.call("nc_get_var", file, number, address(values))
        return Variable(tuple(dimensions[axis][0] for axis in axes), own, values)


def address(values: np.ndarray) -> ctypes.c_void_p:
    """The place of an array in memory."""
    return values.ctypes.data_as(ctypes.c_void_p)


def read_netcdf4(path: Path) -> tuple[Attributes, dict[str, Variable]]:
    """The attributes of a file and its variables."""
    library = Library()
    with library.opened(path) as file:
        dimensions = []
        for number in range(library.integer("nc_inq_ndims", file)):
            length = ctypes.c_size_t()
            library.call("nc_inq_dimlen", file, number, ctypes.byref(length))
            dimensions.append((library.name("nc_inq_dimname", file, number), length.value))
        attributes = library.attributes(file, GLOBAL, library.integer("nc_inq_natts", file))
        variables = {
            library.name("nc_inq_varname", file, number): library.variable(file, number, dimensions)
            for number in range(library.integer("nc_inq_nvars", file))
        }
    return attributes, variables
