"""Which figures there are, and to which tables they belong."""

import importlib
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from spintop_figures.kinds import COMPARISONS, FIGURES, FigureKind, as_list, unknown
from spintop_figures.style.axes import DEGREES, draw_line, letters_of, name_axis, set_degree_ticks
from spintop_figures.style.look import LINES, Options
from spintop_figures.style.page import describe_run, name_outer, panel_figure
from spintop_figures.tables.names import axis_of, name_of, shown_in
from spintop_figures.tables.table import Table, TableError, cases_at, in_own_units

MODULES = (
    *("motion.trajectory", "motion.sphere", "motion.reduced", "motion.residuals", "motion.fits"),
    *("motion.events", "sweeps.curves", "sweeps.maps", "sweeps.scatter", "sweeps.statistics"),
    *("methods.trials", "methods.precision", "methods.peers"),
)
"""Where figures are drawn, in the order in which they are listed."""

LOADED = [importlib.import_module(f"spintop_figures.{name}").__name__ for name in MODULES]
FIGURES.sort(key=lambda kind: LOADED.index(kind.make.__module__))  # some modules import others

PANEL_HEIGHT, ALONE = 1.9, 3.4
"""Of a panel of several and of a single one, in inches."""


def columns_kind(options: Options) -> FigureKind:
    """The figure of the columns that a user chose."""
    return FigureKind(
        "columns",
        "columns of choice, of all tables together",
        "",
        (options.x, *options.y),
        lambda tables: draw_columns(tables, options),
        lambda table: object_to_columns(table, options),
        together=True,
    )


def draw_columns(tables: Sequence[Table], options: Options) -> Figure:
    """A panel a column, over the same other column; several tables have a line each."""
    *first, last = map(name_of, options.y)
    title = f"{', '.join(first)} and {last}" if first else last
    title = f"{title[0].upper()}{title[1:]} against {name_of(options.x)}"
    count = len(options.y)
    least = ALONE if count == 1 else 0.0
    figure, panels = panel_figure(tables, title, count, PANEL_HEIGHT, least, 1.1, "x", across=1)
    labels = labels_of(tables)
    for name, axes in zip(options.y, panels, strict=True):
        spread = []
        for line, table in enumerate(tables):
            x, (y, unit) = table.shown(options.x)[0], table.shown(name)
            style = {"marker": "o", "markersize": 3} if len(x) < 60 else {}  # few rows have marks
            draw_line(axes, x, y, line % len(LINES), **style)
            spread.append(y)
        for axis in options.log:
            axes.set(**{f"{axis}scale": "log"})
        if "y" not in options.log and unit in DEGREES:
            set_degree_ticks(axes.yaxis, np.concatenate(spread))
        axes.margins(x=0.01)
        for axis, ends in options.range.items():
            column = name if axis == "y" else options.x
            factor = shown_in(axis_of(column), tables[0].shown(column)[1])[0]
            # None leaves an end where it is
            getattr(axes, f"set_{axis}lim")(*(end and end / factor for end in ends))
        name_axis(axes.yaxis, axis_of(name), unit)
    name_outer(panels, (axis_of(options.x), tables[0].shown(options.x)[1]))
    if len(tables) > 1:
        room = letters_of(panels[0], "x") - 7  # without the line beside a label
        labels = [textwrap.fill(label, room) for label in labels]
        columns = max(1, min(len(labels), room // max(map(len, labels))))
        place = {"loc": "lower left", "bbox_to_anchor": (0, 1), "ncols": columns}
        panels[0].legend(labels=labels, **place, borderpad=0.2, handlelength=2.6)
    figure.align_ylabels()
    return figure


def labels_of(tables: Sequence[Table]) -> list[str]:
    """What tells the tables apart: their titles, else how they were computed, else their names."""
    for words in (lambda table: table.title, describe_run, lambda table: table.path.stem):
        labels = [words(table) for table in tables]
        if all(labels) and len(set(labels)) == len(labels):
            return labels
    return [str(table.path) for table in tables]


def object_to_columns(table: Table, options: Options) -> str:
    """Columns of numbers are drawn, log axes have something above zero."""
    names = (options.x, *options.y)
    if wordless := [name for name in names if not table.numeric(name)]:
        return f"has words in column {', '.join(wordless)}"
    logs = {"x": [options.x], "y": options.y}
    for name in (name for axis in options.log for name in logs[axis]):
        if not (table.column(name) > 0).any():
            return f"has nothing above zero in column {name}"
    return ""


def choose_figures(
    table: Table, names: list[str] | None = None
) -> tuple[list[FigureKind], list[str]]:
    """The figures to draw from a table, and what is wrong with those that should be drawn too."""
    table = in_own_units(table)
    if wrong := set(names or ()) - {kind.name for kind in FIGURES}:
        return [], [unknown(min(wrong), FIGURES)]
    wanted = [
        kind
        for kind in FIGURES
        if (kind.name in names if names else not kind.refusal(table, has_cells=False))
    ]
    found = [(kind, kind.refusal(table)) for kind in wanted]
    problems = [f"{refusal}: no {kind.name} figure" for kind, refusal in found if refusal]
    return [kind for kind, refusal in found if not refusal], problems


def draw(tables: Table | Sequence[Table], name: str = "", **options: object) -> Figure:
    """Draw the figure of this name of a table, or one of several tables, such as `traces`.

    Without a name, the columns `y` of the tables over their column `x` (time). The other options
    are those of `style.look.Options`: width, title, dark, style, font_size, decimal_comma,
    language, unit, line, at; of chosen columns log and range. Raises a TableError that says why
    there is no such figure, and a ValueError or a TypeError where an option is wrong.
    """
    asked = Options(**options)
    if asked.y and name:
        raise ValueError("a figure has a name or columns y, not both")
    known = FIGURES if isinstance(tables, Table) else COMPARISONS
    tables = [cases_at(table, asked.at) for table in as_list(tables)]
    kinds = [columns_kind(asked)] if asked.y else [kind for kind in known if kind.name == name]
    if not kinds:
        raise TableError(unknown(name, known))
    (kind,) = kinds
    for table in tables:
        if refusal := kind.refusal(table):
            raise TableError(f"{refusal}: no {kind.name} figure")
    return kind.draw(tables, asked)
