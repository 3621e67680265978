"""Columns of choice over another one, of one table or of several."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.lines import draw_line, set_degree_ticks
from spintop_figures.style.look import LINES, drawn_width
from spintop_figures.style.options import Options
from spintop_figures.style.page import label_text, new_figure
from spintop_figures.style.provenance import describe_run
from spintop_figures.sweeps.quantities import unit_shown
from spintop_figures.tables.names import axis_of, name_of
from spintop_figures.tables.table import Table

PANEL_HEIGHT, ALONE = 1.9, 3.4
"""Of a panel of several and of a single one, in inches."""

LEGEND_LETTERS, HANDLE = 12.5, 7
"""Letters of a legend in an inch, and those that a line takes beside its label."""

MANY_ROWS = 60
"""Fewer rows have marks."""


def draw_columns(tables: Sequence[Table], options: Options) -> Figure:
    """A panel a column, over the same other column; several tables have a line each."""
    names = options.y
    height = 1.1 + (ALONE if len(names) == 1 else PANEL_HEIGHT * len(names))
    figure = new_figure(tables, title_of(options), height)
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    labels = labels_of(tables)
    for name, axes in zip(names, panels, strict=True):
        spread = []
        for line, table in enumerate(tables):
            x, y = shown(table, options.x), shown(table, name)
            style = {"marker": "o", "markersize": 3} if len(x) < MANY_ROWS else {}
            draw_line(axes, x, y, line % len(LINES), label=labels[line], **style)
            spread.append(y)
        set_scales(axes, options, np.concatenate(spread), unit_of(tables[0], name))
        axes.set_ylabel(
            label_text(axis_of(name, unit_of(tables[0], name)), axes.figure, len(names))
        )
    panels[-1].set_xlabel(axis_of(options.x, unit_of(tables[0], options.x)))
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


def title_of(options: Options) -> str:
    """The columns in words."""
    names = [name_of(name) for name in options.y]
    *first, last = names
    listed = f"{', '.join(first)} and {last}" if first else last
    title = f"{listed} against {name_of(options.x)}"
    return title[0].upper() + title[1:]


def unit_of(table: Table, name: str) -> str:
    """The unit in which a column is drawn."""
    return unit_shown(name, table.units.get(name, ""))[0]


def shown(table: Table, name: str) -> np.ndarray:
    """The numbers of a column in that unit."""
    return unit_shown(name, table.units.get(name, ""))[1] * table.rows[name].to_numpy(float)


def set_scales(axes: Axes, options: Options, values: np.ndarray, unit: str) -> None:
    """The scales and the ranges that are asked for; angles have round ticks."""
    for axis in options.log:
        axes.set(**{f"{axis}scale": "log"})
    if "y" not in options.log and unit == "degrees":
        set_degree_ticks(axes.yaxis, values)
    axes.margins(x=0.01)
    for axis, (low, high) in options.range.items():
        getattr(axes, f"set_{axis}lim")(low, high)  # None leaves an end where it is


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
        if not (shown(table, name) > 0).any():
            return f"has nothing above zero in column {name}"
    return ""
