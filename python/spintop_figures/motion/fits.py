"""A fit: the measurements with the fitted motion, what is left between them, the values found."""

import math
import re
import textwrap

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from spintop_figures.kinds import figure
from spintop_figures.style.axes import name_axis
from spintop_figures.style.look import FAINT, FAULT, GREY, LINES, by_width, drawn_size
from spintop_figures.style.look import scale as scale_of_letters
from spintop_figures.style.numbers import TIMES, decimals_for, localised, with_power, write
from spintop_figures.style.page import TIME, head, name_outer, new_figure, no_axis
from spintop_figures.tables.names import name_of, raised, sign_of
from spintop_figures.tables.table import Table, TableError, read_table

ENDING, FITTED = "_residual", "_fit"
TABLE = re.compile(r"\.residuals(\d*)\.csv$")
"""What ends the name of a table of residuals: that of the first run has no number."""

PAIR, BELOW = 1.9, 1.2
"""Height of the panels of a column, and of what is below, in inches."""

LINE, LETTERS = 0.185, 30
"""Height of a line of the fitted values in inches, and its letters."""

MEASURED = {"linestyle": "", "marker": "o", "markersize": 2.8, "color": LINES[0]["color"]}
MOTION = {"color": LINES[1]["color"], "linewidth": 1.0, "label": "fitted motion"}
BAND = {"color": FAINT, "alpha": 0.35, "linewidth": 0}


def measured_columns(table: Table) -> list[str]:
    """The columns that were measured."""
    return [name.removesuffix(ENDING) for name in table.rows if name.endswith(ENDING)]


def run_of(table: Table) -> int:
    """The number of the run."""
    found = TABLE.search(table.path.name)
    return int(found[1] or 1) if found else 1


def values_beside(table: Table) -> pd.DataFrame | None:
    """The parameters of the run, if the table of the residuals has that of all beside it."""
    path = table.path.with_name(TABLE.sub(".csv", table.path.name))
    other = table.others.get("rows")
    if not table.frame and path != table.path and path.exists():
        try:
            other = read_table(path)
        except TableError:
            return None
    wanted = {"parameter", "unit", "estimate", "lower", "upper"}
    if other is None or not wanted <= {*other.rows}:
        return None
    name, of_run = other.rows.parameter, f"[{run_of(table)}]"
    return other.rows[~name.str.endswith("]") | name.str.endswith(of_run)]


@figure("fit", "t", unless={"has no column of residuals": measured_columns})
def draw_fit(table: Table) -> Figure:
    """Residuals of a fit against time.

    Two panels for each measured column: it with the fitted motion, and the residuals below.
    """
    names, values = measured_columns(table), values_beside(table)
    lines = [] if values is None else tell_values(values)
    across = by_width(2, 1) if len(names) >= 4 else 1  # many stand two abreast
    down = -(-len(names) // across)
    beside = LINE * len(lines) + BELOW
    height = max(PAIR * down, 3.4 if down == 1 else 0, beside)
    height = by_width(height, PAIR * down + beside)
    runs, run = table.settings.get("fit.data", []), run_of(table)
    which = f", run {run}: {runs[run - 1]}" if 1 < len(runs) >= run else ""
    figure = new_figure(table, f"Fit of a motion to measurements{which}", 1.0 + height)
    figure.get_layout_engine().set(hspace=0.02)
    heights, widths = [PAIR * 1.7 / 2.7, PAIR / 2.7] * down, [drawn_size()[0]]
    if by_width(True, False):
        widths = [(drawn_size()[0] - 2.2) / across] * across + [2.2]  # inches for the fitted values
    else:
        heights.append(beside)
    shape = {"width_ratios": widths, "height_ratios": heights}
    grid = figure.add_gridspec(len(heights), len(widths), **shape)
    side = grid[:, across] if len(widths) > 1 else grid[-1, 0]
    panels: list[Axes] = []
    for place, name in enumerate(names):
        column, line = divmod(2 * place, 2 * down)
        for row in (line, line + 1):
            first = panels[0] if panels else None
            panels.append(figure.add_subplot(grid[row, column], sharex=first))
        draw_column(table, name, *panels[-2:])
    name_outer(panels, TIME)
    axes = no_axis(figure.add_subplot(side))
    handles = [
        Line2D([], [], **MEASURED, label="measured"),
        Line2D([], [], **MOTION),
        Patch(**BAND, label="twice the root mean square"),
    ]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.06, 1.03), borderpad=0)
    style = {"xycoords": "axes fraction", "textcoords": "offset points", "va": "top"}
    style |= {"fontsize": "small", "parse_math": False}
    for number, (line, is_name) in enumerate(lines, start=4):
        shift = 0, -72 * LINE * scale_of_letters() * number
        weight = "bold" if is_name else "normal"
        axes.annotate(line, (0.0, 1.0), shift, **style, fontweight=weight)
    return figure


def draw_column(table: Table, name: str, above: Axes, below: Axes) -> None:
    """A measured column with the fitted motion; below, the residuals with twice their size."""
    t, unit = table.column("t"), table.units.get(name, "")
    measured, fitted, left = (table.column(name + end) for end in ("", FITTED, ENDING))
    if unit == "rad":
        measured, fitted, left = (np.degrees(part) for part in (measured, fitted, left))
        unit = "deg"
    above.plot(t, fitted, **MOTION)
    above.plot(t, measured, **MEASURED, label="measured")
    head(above, sign_of(name), above.yaxis, unit, pad=3)
    # residuals so much larger than most that nothing else would be seen beside them: at the edge
    most, size = 8, 1.4826 * np.nanmedian(np.abs(left))  # the deviation, of normal residuals
    outside = np.abs(left) > most * size if size > 0 else np.zeros(left.shape, bool)
    deviation = float(np.sqrt(np.nanmean(left[~outside] ** 2)))
    below.axhspan(-2 * deviation, 2 * deviation, **BAND)
    below.axhline(0, color=GREY, linewidth=0.8)
    below.plot(t, left, **MEASURED)
    size = " ".join(filter(None, (write(deviation, 2), raised(unit))))
    words = f"root mean square {size}"
    if outside.any():
        words += f" without {np.count_nonzero(outside)} outliers"
        edge = most * deviation
        below.set_ylim(-edge, edge)
        for there, marker in ((left > 0, "^"), (left < 0, "v")):
            place = t[outside & there], np.where(left[outside & there] > 0, 0.9, -0.9) * edge
            below.plot(*place, marker, color=FAULT, markersize=5, zorder=3)
    style = {"loc": "right", "fontsize": "small", "color": GREY, "pad": 2, "parse_math": False}
    below.set_title(words, **style)
    below.margins(x=0.01)
    name_axis(below.yaxis, "residual")


def tell_values(values: pd.DataFrame) -> list[tuple[str, bool]]:
    """The fitted values in lines, of which those of names are bold."""
    lines = []
    for row in values.itertuples():
        name = name_of(row.parameter.partition("[")[0])
        lines += [(line, True) for line in textwrap.wrap(name, LETTERS)]
        unit = raised(row.unit) if isinstance(row.unit, str) else ""
        size = abs(row.estimate)
        power = 0 if 1e-3 <= size < 1e5 or not size else 3 * math.floor(math.log10(size) / 3)
        factor = f"{TIMES}{with_power('1', power)}" if power else ""
        half = (row.upper - row.lower) / 2 / 10.0**power
        decimals = decimals_for(half, 0) if 0 < half < math.inf else 6
        numbers = (row.estimate, row.lower, row.upper)
        told = [localised(f"{number / 10.0**power:.{decimals}f}") for number in numbers]
        lines.append((f"{told[0]}{factor} {unit}".strip(), False))
        lines += [(f"95 %: {told[1]} to {told[2]}", False), ("", False)]
    return lines
