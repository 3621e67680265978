"""Tables in memory: the columns of a run as numpy arrays."""

import ctypes
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from spintop.library import CColumn, CResult, CTable, double_array, library, text_of

if TYPE_CHECKING:
    import pandas
    import xarray

    from spintop.animation import Animation


class Owner:
    """Deletes a result of the library when nothing needs it any longer."""

    def __init__(self, place: "ctypes._Pointer[CResult]") -> None:
        """Take over a result."""
        self.place = place
        self.delete = library().spintop_result_delete

    def __del__(self) -> None:
        """Delete it."""
        if hasattr(self, "delete"):
            self.delete(self.place)

    def __reduce__(self) -> Any:
        """Refuse a copy: the memory is the library's."""
        raise TypeError("a result is not copied or pickled; `to_pandas` of its tables is")


class Table(Mapping[str, np.ndarray]):
    """A table: `table["theta"]` is the column `theta`, in SI units and radians.

    Numbers are arrays over the memory of the library, without a copy; words are arrays of str.
    """

    def __init__(self, table: CTable, owner: Owner) -> None:
        """Take a table of a result."""
        self.name = text_of(table.name)
        """What it is: `rows`, `events` or `statistics`."""
        self.row_count = int(table.row_count)
        """Number of rows."""
        columns = [table.columns[i] for i in range(table.column_count)]
        self._owner = owner
        self._columns: dict[str, CColumn] = {text_of(column.name): column for column in columns}
        self._arrays: dict[str, np.ndarray] = {}
        self.units = {name: text_of(column.unit) for name, column in self._columns.items()}
        """The unit of each column; empty where there is none."""
        self.meanings = {name: text_of(column.what) for name, column in self._columns.items()}
        """The meaning of each column."""

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by its name."""
        if name not in self._arrays:
            self._arrays[name] = self._array(self._columns[name])
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        """The names of the columns."""
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns."""
        return len(self._columns)

    def __repr__(self) -> str:
        """Name, rows and columns."""
        return f"<spintop.Table {self.name}: {self.row_count} rows of {', '.join(self)}>"

    def _array(self, column: CColumn) -> np.ndarray:
        """The values of a column."""
        values = np.empty(0)
        if self.row_count:
            values = np.frombuffer(double_array(column.values, self.row_count, self._owner))
        values.flags.writeable = False
        if not column.words:
            return values
        words = [text_of(column.words[i]) for i in range(column.word_count)]
        return np.array(words, dtype=str)[values.astype(np.intp)] if words else values.astype(str)

    def to_pandas(self) -> "pandas.DataFrame":
        """The table as a data frame of pandas."""
        import pandas as pd

        return pd.DataFrame({name: self[name] for name in self})

    def to_xarray(self) -> "xarray.Dataset":
        """The table as a data set of xarray, over the dimension `case` or `row`, with units."""
        import xarray as xr

        dimension = "case" if "case" in self else "row"
        variables = {
            name: (dimension, self[name], {"units": self.units[name], "long_name": meaning})
            for name, meaning in self.meanings.items()
            if name != dimension
        }
        coordinates = {dimension: self[dimension].astype(int)} if dimension in self else None
        return xr.Dataset(variables, coordinates)


class Result:
    """What a run gives: its tables, and how it ended."""

    def __init__(
        self,
        place: "ctypes._Pointer[CResult]",
        draw: "Callable[..., dict[str, Any]] | None" = None,
        show: "Callable[[], Animation] | None" = None,
    ) -> None:
        """Take over a result of the library; `draw` draws its figures, `show` its motion."""
        result = place.contents
        owner = Owner(place)
        self.ok = result.code == 0
        """Whether the motion, or all cases, succeeded."""
        self.summary = text_of(result.summary)
        """Plan, cost and end of the run, for a reader; empty for a sweep in memory."""
        self.warnings = text_of(result.warnings)
        """Warnings of the input and of the run; empty if there are none."""
        found = [Table(result.tables[i], owner) for i in range(result.table_count)]
        self.tables = {table.name: table for table in found}
        """The tables by name."""
        self._draw, self._show = draw, show

    @cached_property
    def rows(self) -> Table:
        """The table of the run: a row per sample of a trajectory, or per case of a sweep."""
        return self.tables["rows"]

    @cached_property
    def events(self) -> Table | None:
        """The events of a trajectory; None if the input lists none."""
        return self.tables.get("events")

    @cached_property
    def statistics(self) -> Table | None:
        """The statistics of a sweep; None if the input asks for none."""
        return self.tables.get("statistics")

    def __getitem__(self, name: str) -> np.ndarray:
        """A column of `rows`."""
        return self.rows[name]

    def __repr__(self) -> str:
        """The tables."""
        end = "" if self.ok else ", not ok"
        return f"<spintop.Result: {', '.join(map(repr, self.tables.values()))}{end}>"

    def plot(self, *figures: str) -> dict[str, Any]:
        """Draw the figures that `scripts/plot` draws of this run, or those named, by name.

        The tables of a run without a folder are in no file: it is repeated into one.
        """
        if self._draw is None:
            raise TypeError("only the tables of spintop.run can be drawn")
        return self._draw(*figures)

    def animate(self) -> "Animation":
        """Show the top in motion, in a notebook or a file: the viewer of a report.

        The run is a trajectory with the columns `phi theta psi` or `q0` to `q3`. The table of a run
        without a folder is in no file: it is repeated into one.
        """
        if self._show is None:
            raise TypeError("only a trajectory of spintop.run can be shown")
        return self._show()
