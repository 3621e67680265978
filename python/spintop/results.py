"""Tables in memory: the columns of a run as numpy arrays."""

import base64
import ctypes
import html
import io
import weakref
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spintop.library import CColumn, CResult, CTable, library, text_of

if TYPE_CHECKING:
    import pandas
    import xarray

    from spintop.animation import Animation
    from spintop_figures.tables.table import Table as FileTable


class Owner:
    """Has what the library made, and deletes it when nothing needs it any longer."""

    def __init__(self, place: Any, delete: str) -> None:
        """Take over a result or a top, and the name of the function that deletes it."""
        self.place = place
        # Not at the end of Python, when functions that it calls then may still read columns.
        weakref.finalize(self, getattr(library(), f"spintop_{delete}"), place).atexit = False

    def __reduce__(self) -> Any:
        """Refuse a copy: the memory is the library's."""
        raise TypeError("a result is not copied or pickled; `to_pandas` of its tables is")


Texts = dict[str, str]


def described(columns: Any, count: int) -> tuple[dict[str, CColumn], Texts, Texts]:
    """Columns of the library by name, their units, and their meanings."""
    known = {text_of(columns[i].name): columns[i] for i in range(count)}
    units = {name: text_of(column.unit) for name, column in known.items()}
    return known, units, {name: text_of(column.what) for name, column in known.items()}


class Columns(Mapping[str, np.ndarray]):
    """Columns by name, with units: what tables and motions have in common."""

    def __init__(self, columns: Mapping[str, Any], units: Texts, meanings: Texts) -> None:
        """Take columns, or what they are made of."""
        self._columns = columns
        self.units = units
        """The unit of each column; empty where there is none."""
        self.meanings = meanings
        """The meaning of each column."""

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by its name."""
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        """The names of the columns."""
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns."""
        return len(self._columns)

    def _dimensions(self) -> dict[str, np.ndarray]:
        """The dimensions of the columns and the values along them."""
        raise NotImplementedError

    def to_pandas(self) -> "pandas.DataFrame":
        """The columns as a data frame of pandas; those of more dimensions in the order of C."""
        import pandas as pd

        return pd.DataFrame({name: np.ravel(self[name]) for name in self})

    def to_xarray(self) -> "xarray.Dataset":
        """The columns as a data set of xarray with units, over the dimensions that they have.

        These are `case`, `row` or `t`; for a sweep over a grid the parameters, each with its
        values, or `axis1`, `axis2` where no parameter varies along one axis alone.
        """
        import xarray as xr

        dimensions = self._dimensions()
        names = tuple(dimensions)
        known = (("units", self.units), ("long_name", self.meanings))
        told = {
            name: {key: texts[name] for key, texts in known if name in texts}
            for name in (*self, *names)
        }
        columns = {name: (names, self[name], told[name]) for name in self if name not in names}
        along = {name: (name, values, told[name]) for name, values in dimensions.items()}
        return xr.Dataset(columns, along)

    def _repr_html_(self) -> str:
        """The columns in a notebook: the first rows and the last."""
        try:
            frame = self.to_pandas()
        except ImportError:
            return f"<pre>{html.escape(repr(self))}</pre>"
        return str(frame.to_html(max_rows=20, border=0, notebook=True, show_dimensions=True))


class Table(Columns):
    """A table: `table["theta"]` is the column `theta`, in SI units and radians.

    Numbers are arrays over the memory of the library, without a copy; words are arrays of str.
    Columns of a sweep over arrays have the shape of the arrays.
    """

    def __init__(
        self, table: CTable, owner: Owner, grid: Mapping[str, np.ndarray] | None = None
    ) -> None:
        """Take a table of a result; the rows of a sweep over a grid have its dimensions."""
        self._owner = owner
        super().__init__(*described(table.columns, table.column_count))
        self.name = text_of(table.name)
        """What it is: `rows`, `events`, `statistics`, `histogram`, `indices` or `residuals`, of a
        second run `residuals2`."""
        self.row_count = int(table.row_count)
        """Number of rows."""
        self.frame = text_of(table.frame)
        """Its text as a CSV file without the rows: header, names, status; empty of `Top.events`."""
        self._arrays: dict[str, np.ndarray] = {}
        self._grid = dict(grid or {})
        self.shape = tuple(map(len, self._grid.values())) or (self.row_count,)
        """The shape of each column."""

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by its name."""
        if name in self._arrays:
            return self._arrays[name]
        column, values = self._columns[name], np.empty(0)
        if self.row_count:
            memory = (ctypes.c_double * self.row_count).from_address(column.values)
            memory.owner = self._owner  # which lives as long as the array
            values = np.frombuffer(memory)
        values.flags.writeable = False
        if column.words:
            words = [text_of(column.words[i]) for i in range(column.word_count)]
            values = np.array(words or [""], dtype=str)[values.astype(np.intp)]
        return self._arrays.setdefault(name, values.reshape(self.shape))

    def __repr__(self) -> str:
        """Name, rows and columns."""
        return f"<spintop.Table {self.name}: {self.row_count} rows of {', '.join(self)}>"

    def _dimensions(self) -> dict[str, np.ndarray]:
        """The dimensions of the columns and the values along them."""
        if self._grid:
            return self._grid
        if "case" in self:
            return {"case": self["case"].astype(int)}
        if self.name == "rows" and "t" in self and bool(np.all(np.diff(self["t"]) > 0)):
            return {"t": self["t"]}
        return {"row": np.arange(self.row_count)}


class Figures(dict[str, Any]):
    """Figures of matplotlib by name; a notebook shows them."""

    def _repr_html_(self) -> str:
        """The figures, one below the other, as pictures with their names."""
        lines = []
        for name, figure in self.items():
            page = io.BytesIO()
            figure.savefig(page, format="png", dpi=110)
            data = base64.b64encode(page.getvalue()).decode()
            look = f'alt="" style="max-width: 100%" src="data:image/png;base64,{data}"'
            lines.append(f"<p>{html.escape(name)}</p>\n<img {look}>")
        return "\n".join(lines)


class Result:
    """What a run gives: its tables, and how it ended."""

    def __init__(
        self,
        place: "ctypes._Pointer[CResult]",
        name: str = "input",
        grid: Mapping[str, np.ndarray] | None = None,
    ) -> None:
        """Take over a result of the library, of an input with this name."""
        result, owner = place.contents, Owner(place, "result_delete")
        self.ok = result.code == 0
        """Whether the motion, or all cases, succeeded."""
        self.summary = text_of(result.summary)
        """Plan, cost and end of the run, for a reader; empty for a sweep in memory."""
        self.warnings = text_of(result.warnings)
        """Warnings of the input and of the run; empty if there are none."""
        found = [Table(result.tables[i], owner, grid) for i in range(result.table_count)]
        self.tables = {table.name: table for table in found}
        """The tables by name."""
        self.events = self.tables.get("events")
        """The events of a trajectory; None if the input lists none."""
        self.statistics = self.tables.get("statistics")
        """The statistics of a sweep; None if the input asks for none."""
        self._name = Path(name).stem

    @cached_property
    def rows(self) -> Table:
        """The table of the run: a row per sample of a trajectory, or per case of a sweep."""
        return self.tables["rows"]

    def __getitem__(self, name: str) -> np.ndarray:
        """A column of `rows`."""
        return self.rows[name]

    def __repr__(self) -> str:
        """The tables."""
        end = "" if self.ok else ", not ok"
        return f"<spintop.Result: {', '.join(map(repr, self.tables.values()))}{end}>"

    @cached_property
    def _drawn(self) -> dict[str, "FileTable"]:
        """The tables as figures have them, by name."""
        from spintop_figures.tables.table import table_in_memory

        drawn: dict[str, FileTable] = {}
        for name, table in self.tables.items():
            if not table.frame:
                raise TypeError("events of a top have no figures: `spintop.run` of an input has")
            path = Path(f"{self._name}.{name}.csv" if drawn else f"{self._name}.csv")
            columns = {column: np.ravel(table[column]) for column in table}
            drawn[name] = table_in_memory(path, table.frame, columns, drawn)
        return drawn

    def plot(self, *figures: str) -> Figures:
        """Draw the figures that `scripts/plot` draws of these tables, or those named, by name.

        A notebook shows them; each is a figure of matplotlib, with `savefig`.
        """
        from spintop.runs import plot
        from spintop_figures.registry import choose_figures

        found, tables = Figures(), [*self._drawn.values()]
        for name in figures:
            mine = [table for table in tables if choose_figures(table, [name])[0]]
            found.update(plot((mine or tables)[0], name))
        for name, table in () if figures else self._drawn.items():
            run = name.removeprefix("residuals") if name.startswith("residuals") else ""
            found.update({kind + run: figure for kind, figure in plot(table).items()})
        return found

    def animate(self) -> "Animation":
        """Show the top in motion, in a notebook or a file: the viewer of a report.

        The run is a trajectory with the columns `phi theta psi` or `q0` to `q3`.
        """
        from spintop.animation import animate

        return animate(next(iter(self._drawn.values())))
