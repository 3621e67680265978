"""Sobol' indices of a sweep: the share of each factor in the variance of each column."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.style.axes import name_axis
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, LINES, by_width
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import add_panels, head, is_left, is_lowest, new_figure, panel_rows
from spintop_figures.sweeps.statistics import describe, object_to_beside, rows_beside, tell_cases
from spintop_figures.tables.names import name_of
from spintop_figures.tables.netcdf import read_netcdf
from spintop_figures.tables.table import Table, TableError

LEAST_RANGE, FURTHEST = 0.5, 0.5
"""The axis reaches to this share at least, and this far beyond 0 and 1 at most, where intervals are
wide."""
FACTOR_HEIGHT, FRAME_HEIGHT = 0.34, 0.75
"""Of a factor, and of what is above and below the factors of a panel, in inches."""
INDICES = ("first_order", "total")

APART = 0.13
LOOKS = (
    (-APART, LINES[0]["color"], {"marker": "o", "label": "first order"}),
    (APART, LINES[1]["color"], {"marker": "D", "label": "total", "markerfacecolor": GROUND}),
)
"""How far the two indices of a factor stand from its line, their colours and marks; the factors are
1 apart."""


def object_to_indices(table: Table) -> str:
    """Indices were computed, and their table is there where it is looked for."""
    if table.setting("statistics.indices") != "sobol":
        return "has no Sobol' indices"
    return object_to_beside(table, "indices")


def indices_of(table: Table) -> pd.DataFrame:
    """A row for each column and factor: the indices, the ends of their intervals, the groups."""
    if table.path.suffix != ".nc":
        return rows_beside(table, "indices")
    _, data = read_netcdf(table.path)
    factors, parts = str(data["factor"].attrs["flag_meanings"]).split(), []
    for stem in (key.removesuffix("_first_order") for key in data if key.endswith("_first_order")):
        column = str(data[f"{stem}_first_order"].attrs["column"])
        cells: dict[str, object] = {"column": [column] * len(factors), "factor": factors}
        for index in INDICES:
            ends = data[f"{stem}_{index}_bounds"].values.astype(float)
            cells[index] = data[f"{stem}_{index}"].values.astype(float)
            cells[f"{index}_low"], cells[f"{index}_high"] = ends[:, 0], ends[:, 1]
        cells["groups"] = int(data[f"{stem}_groups"].values)
        cells["left_out"] = int(data[f"{stem}_groups_left_out"].values)
        parts.append(pd.DataFrame(cells))
    return pd.concat(parts, ignore_index=True)


@figure(
    "indices",
    "first-order and total Sobol' indices of a sweep with their intervals",
    kind="statistics",
    needs="cases",
    objection=object_to_indices,
)
def draw_indices(table: Table) -> Figure:
    """The indices of each column as dots with their intervals, a line a factor."""
    found = indices_of(table)
    if not np.isfinite(found["first_order"].to_numpy(float)).any():
        raise TableError("has no column that varies")
    groups = list(found.groupby("column", sort=False))
    title = by_width("Sobol' indices with 95 % intervals", "Sobol' indices")
    most = max(len(rows) for _, rows in groups)
    height = 1.2 + (FRAME_HEIGHT + FACTOR_HEIGHT * most) * panel_rows(len(groups))
    figure = new_figure(table, f"{title}: {tell_cases(table)}", height)
    panels = add_panels(figure, len(groups), sharey=True)
    for axes, (name, rows) in zip(panels, groups, strict=True):
        head(axes, describe(table, str(name))[0])
        draw_dots(axes, rows)
    ends = found[[f"{index}_{end}" for index in INDICES for end in ("low", "high")]].to_numpy(float)
    ends = ends[np.isfinite(ends)]
    low, high = ends.min(initial=0.0), ends.max(initial=LEAST_RANGE)
    room = 0.03 * (high - low)
    panels[0].set_xlim(max(low - room, -FURTHEST), min(high + room, 1 + FURTHEST))
    panels[0].set_ylim(most - 0.5, -0.5)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=2, borderpad=0)
    for axes in panels:
        axes.tick_params(labelleft=is_left(axes), left=False)
        if is_lowest(axes):
            name_axis(axes.xaxis, "share of the variance")
    return figure


def draw_dots(axes: Axes, rows: pd.DataFrame) -> None:
    """The indices of a column as dots with intervals; a column without indices says so."""
    places = np.arange(len(rows))
    axes.set_yticks(places, [name_of(factor) for factor in rows["factor"]])
    axes.axvline(0, color=GREY, linewidth=0.6, zorder=0)
    for place in places:
        axes.axhline(place, color=FAINT, linewidth=0.5, zorder=0)
    for index, (shift, colour, look) in zip(INDICES, LOOKS, strict=True):
        values, low, high = (rows[index + end].to_numpy(float) for end in ("", "_low", "_high"))
        there = places + shift
        known = np.isfinite(high) & np.isfinite(low)
        axes.hlines(there[known], low[known], high[known], color=colour, linewidth=1.4)
        style = look | {"color": colour, "markersize": 5, "linestyle": "", "zorder": 3}
        axes.plot(values, there, **style)
    left_out = int(rows["left_out"].iloc[0])
    if not np.isfinite(rows["first_order"].to_numpy(float)).any():
        axes.annotate("no indices", (0.5, 0.5), xycoords="axes fraction", ha="center", color=FAULT)
    elif left_out:
        groups = write_count(left_out + rows["groups"].iloc[0])
        text = f"{write_count(left_out)} of {groups} groups left out"
        axes.set_title(text, loc="right", fontsize="small", color=FAULT)
