"""Sobol' indices of a sweep: the share of each factor in the variance of each column."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.look import FAINT, FAULT, LINES, by_width
from spintop_figures.style.numbers import write_count
from spintop_figures.style.page import add_panels, head, is_lowest, new_figure
from spintop_figures.sweeps.statistics import (
    describe,
    object_to_beside,
    rows_beside,
    tell_cases,
)
from spintop_figures.tables.names import name_of
from spintop_figures.tables.netcdf import read_netcdf
from spintop_figures.tables.table import Table, TableError

APART = 0.13
"""How far the two indices of a factor stand from its line; the factors are 1 apart."""
LEAST_RANGE = 0.5
"""The axis reaches to this share at least."""
FURTHEST = 0.5
"""How far the axis goes beyond 0 and 1 at most, where intervals are wide."""
FACTOR_HEIGHT, FRAME_HEIGHT = 0.34, 0.75
"""Of a factor, and of what is above and below the factors of a panel, in inches."""
INDICES = ("first_order", "total")


def object_to_indices(table: Table) -> str:
    """Indices were computed, and their table is there where it is looked for."""
    if table.setting("statistics.indices") != "sobol":
        return "has no Sobol' indices"
    return object_to_beside(table, "indices")


def indices_of(table: Table) -> pd.DataFrame:
    """A row for each column and factor: the indices, the ends of their intervals, the groups."""
    if table.path.suffix == ".nc":
        return indices_of_netcdf(table.path)
    return rows_beside(table, "indices")


def indices_of_netcdf(path: Path) -> pd.DataFrame:
    """The same of a NetCDF file."""
    _, variables = read_netcdf(path)
    factors = str(variables["factor"].attributes["flag_meanings"]).split()
    parts = []
    for key, variable in variables.items():
        if not key.endswith("_first_order"):
            continue
        stem = key.removesuffix("_first_order")
        cells: dict[str, object] = {
            "column": [str(variable.attributes["column"])] * len(factors),
            "factor": factors,
        }
        for index in INDICES:
            cells[index] = variables[f"{stem}_{index}"].values.astype(float)
            ends = variables[f"{stem}_{index}_bounds"].values.astype(float)
            cells[f"{index}_low"], cells[f"{index}_high"] = ends[:, 0], ends[:, 1]
        cells["groups"] = int(variables[f"{stem}_groups"].values)
        cells["left_out"] = int(variables[f"{stem}_groups_left_out"].values)
        parts.append(pd.DataFrame(cells))
    return pd.concat(parts, ignore_index=True)


def draw_indices(table: Table) -> Figure:
    """The indices of each column as dots with their intervals, a line a factor."""
    found = indices_of(table)
    if not np.isfinite(found["first_order"].to_numpy(float)).any():
        raise TableError("has no column that varies: no indices figure")
    groups = list(found.groupby("column", sort=False))
    title = by_width("Sobol' indices with 95 % intervals", "Sobol' indices")
    title = f"{title}: {tell_cases(table)}"
    most = max(len(rows) for _, rows in groups)
    row = FRAME_HEIGHT + FACTOR_HEIGHT * most
    figure = new_figure(table, title, 1.2 + row * ((len(groups) + 1) // 2))
    panels = add_panels(figure, len(groups), sharey=True)
    low, high = 0.0, LEAST_RANGE
    for axes, (name, rows) in zip(panels, groups, strict=True):
        draw_dots(axes, describe(table, str(name))[0], rows)
        ends = rows[[f"{index}_{end}" for index in INDICES for end in ("low", "high")]]
        ends = ends.to_numpy(float)
        if np.isfinite(ends).any():
            low, high = min(low, np.nanmin(ends)), max(high, np.nanmax(ends))
    room = 0.03 * (high - low)
    panels[0].set_xlim(max(low - room, -FURTHEST), min(high + room, 1 + FURTHEST))
    panels[0].set_ylim(most - 0.5, -0.5)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=2, borderpad=0)
    for axes in panels:
        axes.tick_params(labelleft=axes.get_subplotspec().is_first_col(), left=False)
        if is_lowest(axes):
            axes.set_xlabel("share of the variance")
    return figure


def draw_dots(axes: Axes, name: str, rows: pd.DataFrame) -> None:
    """The indices of a column as dots with intervals; a column without indices says so."""
    places = np.arange(len(rows))
    axes.set_yticks(places, [name_factor(factor) for factor in rows["factor"]])
    axes.axvline(0, color="0.4", linewidth=0.6, zorder=0)
    for place in places:
        axes.axhline(place, color=FAINT, linewidth=0.5, zorder=0)
    head(axes, name)
    looks = (
        (-APART, "first order", LINES[0]["color"], {"marker": "o"}),
        (APART, "total", LINES[1]["color"], {"marker": "D", "markerfacecolor": "white"}),
    )
    for index, (shift, label, colour, look) in zip(INDICES, looks, strict=True):
        values = rows[index].to_numpy(float)
        low, high = (rows[f"{index}_{end}"].to_numpy(float) for end in ("low", "high"))
        there = places + shift
        known = np.isfinite(high) & np.isfinite(low)
        axes.hlines(there[known], low[known], high[known], color=colour, linewidth=1.4)
        style = look | {"color": colour, "markersize": 5, "linestyle": "", "zorder": 3}
        axes.plot(values, there, **style, label=label)
    left_out = int(rows["left_out"].iloc[0])
    if not np.isfinite(rows["first_order"].to_numpy(float)).any():
        axes.annotate("no indices", (0.5, 0.5), xycoords="axes fraction", ha="center", color=FAULT)
    elif left_out:
        groups = write_count(left_out + rows["groups"].iloc[0])
        text = f"{write_count(left_out)} of {groups} groups left out"
        axes.set_title(text, loc="right", fontsize=8.5, color=FAULT, pad=4)


def name_factor(factor: str) -> str:
    """A factor in words, with its symbol where it has one."""
    return name_of(factor)
