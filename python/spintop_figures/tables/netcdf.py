"""Reading NetCDF tables of spintop: the classic format with 64-bit offsets, without records."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

MAGIC, MAGIC_OF_NETCDF4 = b"CDF\x02", b"\x89HDF"
TYPES = {1: ">i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8"}
CHARACTERS = 2
Attributes = dict[str, str | np.ndarray]


class FormatError(Exception):
    """What is wrong with a file, in one line."""


@dataclass(frozen=True)
class Variable:
    """A variable: the names of its dimensions, its attributes, its values."""

    dimensions: tuple[str, ...]
    attributes: Attributes
    values: np.ndarray


class Header:
    """The bytes at the beginning of a file, read one thing after the other."""

    def __init__(self, data: np.ndarray) -> None:
        self.data = data
        self.place = 0

    def take(self, count: int) -> bytes:
        """Some bytes, and what fills them up to a multiple of four."""
        if count < 0 or self.place + count > self.data.size:
            raise FormatError("is cut short")
        taken = self.data[self.place : self.place + count].tobytes()
        self.place += count + -count % 4
        return taken

    def integer(self, width: int = 4) -> int:
        """An integer of so many bytes."""
        return int.from_bytes(self.take(width), "big", signed=True)

    def name(self) -> str:
        """A name."""
        return self.take(self.integer()).decode()

    def entries(self) -> range:
        """What counts the entries of a list, behind the tag that says of what."""
        self.integer()
        return range(self.integer())

    def attributes(self) -> Attributes:
        """A list of attributes."""
        found: Attributes = {}
        for _ in self.entries():
            name, kind, count = self.name(), self.integer(), self.integer()
            values = np.frombuffer(self.take(count * np.dtype(TYPES[kind]).itemsize), TYPES[kind])
            found[name] = values.tobytes().decode() if kind == CHARACTERS else values
        return found


def is_netcdf4(path: Path) -> bool:
    """Whether a file has the format NetCDF-4, which this module does not read."""
    with path.open("rb") as file:
        return file.read(4) == MAGIC_OF_NETCDF4


def read_netcdf(path: Path) -> tuple[Attributes, dict[str, Variable]]:
    """The attributes of a file and its variables, whose values stay on the disk."""
    if path.stat().st_size == 0:
        raise FormatError("is empty")
    data = np.memmap(path, dtype=np.uint8, mode="r")
    header = Header(data)
    if header.take(4) != MAGIC:
        raise FormatError("is no NetCDF file of the classic format with 64-bit offsets")
    try:
        if header.integer() != 0:
            raise FormatError("has records")
        lengths = [(header.name(), header.integer()) for _ in header.entries()]
        attributes = header.attributes()
        variables = {}
        for _ in header.entries():
            name = header.name()
            axes = [lengths[header.integer()] for _ in range(header.integer())]
            own = header.attributes()
            kind, _, offset = header.integer(), header.integer(), header.integer(8)
            shape = tuple(length for _, length in axes)
            values = np.ndarray(shape, TYPES[kind], data, offset)
            variables[name] = Variable(tuple(axis for axis, _ in axes), own, values)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise FormatError("is damaged or cut short") from error
    return attributes, variables


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
