"""Sobol' indices of a sweep: the share of each factor in the variance of each column."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.look import FAULT, HIDDEN, LINES
from spintop_figures.style.page import add_panels, head, new_figure
from spintop_figures.sweeps.maps import PANEL_HEIGHT
from spintop_figures.sweeps.statistics import beside, describe, tell_cases
from spintop_figures.tables.names import PARAMETERS
from spintop_figures.tables.netcdf import read_netcdf
from spintop_figures.tables.table import Table, TableError, read_table

WIDTH = 0.38
"""Width of a bar; the factors are 1 apart."""
LEAST_RANGE = 0.5
"""The axis reaches to this share at least."""
FURTHEST = 0.5
"""How far the axis goes beyond 0 and 1 at most, where intervals are wide."""
MANY_FACTORS = 5
"""Factors from which their names are rotated."""
INDICES = ("first_order", "total")


def object_to_indices(table: Table) -> str:
    """Indices were computed, and their table is there where it is looked for."""
    if table.setting("statistics.indices") != "sobol":
        return "has no Sobol' indices"
    if table.path.suffix != ".nc" and not beside(table.path, "indices").exists():
        return f"has no {beside(table.path, 'indices').name} beside it"
    return ""


def indices_of(table: Table) -> pd.DataFrame:
    """A row for each column and factor: the indices, the ends of their intervals, the groups."""
    if table.path.suffix == ".nc":
        return indices_of_netcdf(table.path)
    return read_table(beside(table.path, "indices")).rows


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
    """The indices of each column as bars with their intervals."""
    found = indices_of(table)
    if not np.isfinite(found["first_order"].to_numpy(float)).any():
        raise TableError("has no column that varies: no indices figure")
    groups = list(found.groupby("column", sort=False))
    title = f"First-order and total Sobol' indices: {tell_cases(table)}"
    height = 1.4 + max(PANEL_HEIGHT * ((len(groups) + 1) // 2), 2.0)
    figure = new_figure(table, title, height)
    panels = add_panels(figure, len(groups), sharey=True)
    low, high = 0.0, LEAST_RANGE
    for axes, (name, rows) in zip(panels, groups, strict=True):
        draw_bars(axes, describe(table, str(name))[0], rows)
        ends = rows[[f"{index}_{end}" for index in INDICES for end in ("low", "high")]]
        ends = ends.to_numpy(float)
        if np.isfinite(ends).any():
            low, high = min(low, np.nanmin(ends)), max(high, np.nanmax(ends))
    room = 0.03 * (high - low)
    panels[0].set_ylim(max(low - room, -FURTHEST), min(high + room, 1 + FURTHEST))
    panels[0].legend(loc="best", fontsize=8)
    for axes in panels:
        spot = axes.get_subplotspec()
        axes.tick_params(labelbottom=spot.is_last_row(), labelleft=spot.is_first_col())
        if spot.is_first_col():
            axes.set_ylabel("share of the variance")
    return figure


def draw_bars(axes: Axes, name: str, rows: pd.DataFrame) -> None:
    """The bars of a column; a column without indices says so."""
    places = np.arange(len(rows))
    labels = [PARAMETERS.get(factor, factor.rpartition(".")[2]) for factor in rows["factor"]]
    tilt = {"rotation": 30, "ha": "right"} if len(labels) >= MANY_FACTORS else {}
    axes.set_xticks(places, labels, **tilt)
    axes.axhline(0, color="0.4", linewidth=0.6)
    head(axes, name)
    looks = ((-1, "first order", LINES[0]["color"]), (1, "total", HIDDEN))
    for index, (side, label, colour) in zip(INDICES, looks, strict=True):
        values = rows[index].to_numpy(float)
        low, high = (rows[f"{index}_{end}"].to_numpy(float) for end in ("low", "high"))
        there = places + side * WIDTH / 2
        axes.bar(there, values, WIDTH, color=colour, label=label)
        known = np.isfinite(high)
        errors = np.array([values - low, high - values])[:, known]
        axes.errorbar(
            there[known],
            values[known],
            errors,
            fmt="none",
            ecolor="0.1",
            elinewidth=0.9,
            capsize=2.5,
            label="95 % interval" if side > 0 else None,
        )
    left_out = int(rows["left_out"].iloc[0])
    if not np.isfinite(rows["first_order"].to_numpy(float)).any():
        axes.annotate("no indices", (0.5, 0.5), xycoords="axes fraction", ha="center", color=FAULT)
    elif left_out:
        text = f"{left_out:,} of {left_out + int(rows['groups'].iloc[0]):,} groups left out"
        axes.set_title(text, loc="right", fontsize=8.5, color=FAULT, pad=4)
