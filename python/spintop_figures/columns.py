"""Columns of choice over another one, of one table or of several."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import FigureKind
from spintop_figures.style.axes import draw_line, name_axis, set_degree_ticks
from spintop_figures.style.look import LINES, Options, drawn_width
from spintop_figures.style.page import new_figure
from spintop_figures.style.provenance import describe_run
from spintop_figures.tables.names import axis_of, name_of
from spintop_figures.tables.table import Table

PANEL_HEIGHT, ALONE = 1.9, 3.4
"""Of a panel of several and of a single one, in inches."""

LEGEND_LETTERS, HANDLE = 12.5, 7
"""Letters of a legend in an inch, and those that a line takes beside its label."""


def columns_kind(options: Options) -> FigureKind:
    """The figure of the columns that a user chose."""
    return FigureKind(
        "columns",
        "columns of choice, of all tables together",
        "",
        (options.x, *options.y),
        lambda tables: draw_columns(tables, options),
        lambda table: object_to_columns(table, options),
    )


def draw_columns(tables: Sequence[Table], options: Options) -> Figure:
    """A panel a column, over the same other column; several tables have a line each."""
    *first, last = map(name_of, options.y)
    title = f"{', '.join(first)} and {last}" if first else last
    title = f"{title[0].upper()}{title[1:]} against {name_of(options.x)}"
    count = len(options.y)
    figure = new_figure(tables, title, 1.1 + (ALONE if count == 1 else PANEL_HEIGHT * count))
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    labels = labels_of(tables)
    for name, axes in zip(options.y, panels, strict=True):
        spread = []
        for line, table in enumerate(tables):
            x, (y, unit) = table.shown(options.x)[0], table.shown(name)
            style = {"marker": "o", "markersize": 3} if len(x) < 60 else {}  # few rows have marks
            draw_line(axes, x, y, line % len(LINES), label=labels[line], **style)
            spread.append(y)
        for axis in options.log:
            axes.set(**{f"{axis}scale": "log"})
        if "y" not in options.log and unit == "degrees":
            set_degree_ticks(axes.yaxis, np.concatenate(spread))
        axes.margins(x=0.01)
        for axis, (low, high) in options.range.items():
            getattr(axes, f"set_{axis}lim")(low, high)  # None leaves an end where it is
        name_axis(axes.yaxis, axis_of(name), unit)
    name_axis(panels[-1].xaxis, axis_of(options.x), tables[0].shown(options.x)[1])
    if len(tables) > 1:
        add_legend(panels[0])
    figure.align_ylabels()
    return figure


def add_legend(axes: Axes) -> None:
    """Which line is which table, in as many columns as fit above the panels."""
    handles, labels = axes.get_legend_handles_labels()
    room = LEGEND_LETTERS * 0.85 * drawn_width()
    columns = max(1, min(len(labels), int(room / (max(map(len, labels)) + HANDLE))))
    labels = [textwrap.fill(label, int(room) - HANDLE) for label in labels]
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1)}
    axes.legend(handles, labels, **place, ncols=columns, borderpad=0.2, handlelength=2.6)


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
