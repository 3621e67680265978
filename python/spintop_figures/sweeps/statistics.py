"""The statistics of a sweep: maps or curves over its bins, and the distributions over all cases."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.style.axes import letters_of, name_axis, name_rows, set_degree_ticks
from spintop_figures.style.look import FAINT, FAULT, GREY, GROUND, HIDDEN, LINES, by_width
from spintop_figures.style.numbers import MINUS, write, write_count
from spintop_figures.style.page import head, is_left, name_outer, panel_figure
from spintop_figures.sweeps import maps
from spintop_figures.sweeps.quantities import of_column, scale_panels
from spintop_figures.tables.names import column_name, name_of, unit_shown
from spintop_figures.tables.table import Table, TableError, read_table


class Bins(NamedTuple):
    """The bins of a quantity: its column, the edges and the middles."""

    column: str
    edges: np.ndarray
    middles: np.ndarray

    @property
    def is_log(self) -> bool:
        """Whether the middles have equal ratios rather than equal differences."""
        if self.edges[0] <= 0 or self.middles.size < 3:
            return False
        steps, ratios = np.diff(self.middles), np.diff(np.log(self.middles))
        return bool(np.ptp(ratios) < 1e-6 * ratios.max() and np.ptp(steps) > 1e-6 * steps.max())


def bins_of(table: Table) -> list[Bins]:
    """The bins of each quantity that the cases are binned over."""
    names, rows = list(table.rows.columns), table.rows[table.rows["bin"] > 0]  # 0 is all cases
    found = []
    for name in names[1 : names.index("cases") : 3]:
        low, high, middles = (rows[name + end].to_numpy(float) for end in ("_from", "_to", ""))
        found.append(Bins(name, np.append(np.unique(low), high.max()), np.unique(middles)))
    return found


def gathered(table: Table) -> list[str]:
    """The columns of numbers that have statistics."""
    means = [name.removesuffix("_mean") for name in table.rows if name.endswith("_mean")]
    return [name for name in means if f"{name}_deviation" in table.rows]


def object_to_beside(table: Table, what: str) -> str:
    """A table of histograms or indices belongs to that of the statistics."""
    path = beside(table.path, what)
    there = what in table.others if table.frame else path.exists()
    return "" if there else f"has no {path.name} beside it"


def rows_beside(table: Table, what: str) -> pd.DataFrame:
    """The rows of the histograms or of the indices that belong to a table of statistics."""
    other = table.others.get(what) or read_table(beside(table.path, what))
    return other.rows


def beside(path: Path, what: str) -> Path:
    """A table beside a table of statistics: of the histograms, or the indices."""
    return path.with_name(f"{path.stem.removesuffix('.statistics')}.{what}{path.suffix}")


def tell_cases(table: Table) -> str:
    """How many cases there are, and how many of them failed."""
    row = table.rows.iloc[0]
    failed = f", {write_count(row['failed'])} of them failed" if row["failed"] else ""
    return f"{write_count(row['cases'])} cases{failed}"


def describe(table: Table, column: str) -> tuple[str, str, float]:
    """What a column of the cases is called, the unit in which it is drawn, the factor to that."""
    meaning = table.meanings.get(f"{column}_mean", "").removeprefix("mean: ")
    return column_name(column, meaning), *unit_shown(column, table.units.get(f"{column}_mean", ""))


@figure("statistics", "cases", unless={"has no bins": bins_of})
def draw_means(table: Table) -> Figure:
    """Means of a sweep over its bins, and the number of cases."""
    bins, names = bins_of(table), gathered(table)
    rows = table.rows[table.rows["bin"] > 0]
    over = " and ".join(name_of(each.column) for each in bins)
    title = f"Means over {over}: {tell_cases(table)}"
    if len(bins) == 2 and names and is_even(rows["cases"].to_numpy(float)):
        title += f", about {write(rows['cases'].mean(), 3)} in each bin"
    else:
        names.append("")
    share = "xy" if len(bins) == 2 else "x"
    figure, panels = panel_figure(table, title, len(names), *maps.HEIGHTS, share=share)
    for name, axes in zip(names, panels, strict=True):
        if len(bins) == 2:
            draw_map(axes, table, bins, rows, name)
        else:
            draw_curve(axes, table, bins[0], rows, name)
    for bin_, which in zip(bins, "xy", strict=False):
        ends = bin_.edges[0], bin_.edges[-1]
        scale_panels(panels, which, table, bin_.column, bin_.is_log, ends)
    return figure


def is_even(cases: np.ndarray) -> bool:
    """Whether the numbers of cases in bins differ no more than those of random cases do."""
    return bool(cases.size > 1 and cases.var() <= 1.5 * cases.mean())  # it is 1 of random ones


def draw_map(axes: Axes, table: Table, bins: list[Bins], rows: pd.DataFrame, name: str) -> None:
    """A map of a mean, or of the number of cases; bins without values are hatched."""
    axes.patch.set(**maps.BLANK)
    words, unit, factor = describe(table, name) if name else ("number of cases", "", 1.0)
    values = factor * rows[f"{name}_mean" if name else "cases"].to_numpy(float)
    after, extend, colours = "", "neither", None
    if name:
        norm, extend = maps.scale_of(of_column(f"{name}_mean"), values)
    else:
        values = np.where(values > 0, values, np.nan)
        is_wide = np.isfinite(values).any() and np.nanmax(values) > 100 * np.nanmin(values)
        norm, colours = LogNorm() if is_wide else Normalize(), maps.COLOURS
    cells = np.ma.masked_invalid(values.reshape(bins[1].middles.size, bins[0].middles.size))
    bar = maps.draw_cells(axes, [each.edges for each in bins], cells, norm, extend, colours)
    if name and maps.is_signed(norm):
        after = f"; {MINUS}:\u00a0below\u00a0zero"
        maps.mark_negative(axes, *(each.middles for each in bins), cells)
    head(axes, words, bar.ax.yaxis, unit, after)


def draw_curve(axes: Axes, table: Table, bins: Bins, rows: pd.DataFrame, name: str) -> None:
    """A mean with standard deviation and extremes, or the number of cases, over one quantity."""
    if not name:
        axes.stairs(rows["cases"].to_numpy(float), bins.edges, fill=True, color=HIDDEN)
        axes.set_ylim(bottom=0)
        head(axes, "number of cases", axes.yaxis)
        return
    words, unit, factor = describe(table, name)
    middle, keys = rows[bins.column].to_numpy(float), ("mean", "deviation", "min", "max")
    mean, spread, low, high = (factor * rows[f"{name}_{key}"].to_numpy(float) for key in keys)
    axes.fill_between(middle, low, high, color=FAINT, linewidth=0, label="minimum to maximum")
    ends = np.maximum(mean - spread, low), np.minimum(mean + spread, high)
    axes.fill_between(middle, *ends, color=HIDDEN, linewidth=0, label="standard deviation")
    axes.plot(middle, mean, **LINES[0], label="mean")
    head(axes, words, axes.yaxis, unit)
    if axes.get_subplotspec().is_first_row() and is_left(axes):
        axes.legend(loc="best")


@figure(
    "statistics",
    "cases",
    objection=lambda table: (
        object_to_beside(table, "histogram") if gathered(table) else "has no column of numbers"
    ),
)
def draw_distributions(table: Table) -> Figure:
    """Histograms of a sweep over all cases, with quantiles."""
    histograms = rows_beside(table, "histogram").groupby("column", sort=False)
    found = {str(name): rows for name, rows in histograms}
    if not found:
        raise TableError("has no value in any column")
    names = [name for name in gathered(table) if name in found]
    title = f"Distributions over {tell_cases(table)}"
    figure, panels = panel_figure(table, title, len(names), maps.HEIGHTS[0], 3.0, share="")
    for name, axes in zip(names, panels, strict=True):
        draw_distribution(axes, table, name, found[name])
    return figure


def draw_distribution(axes: Axes, table: Table, name: str, found: pd.DataFrame) -> None:
    """The density of the cases over a column, whose intervals differ in width."""
    row = table.rows.iloc[0]
    words, unit, factor = describe(table, name)
    low, high, cases = (found[key].to_numpy(float) for key in ("from", "to", "cases"))
    low, width = factor * low, factor * (high - low)
    if not width.any():
        axes.axvline(low[0], **LINES[0])
        axes.set_yticks([])
    else:
        share = cases / cases.sum()
        density = np.divide(share, width, out=np.zeros_like(share), where=width > 0)
        to_next = np.append(np.diff(low), width[-1])  # a slit between bars is not drawn
        widths = np.where(to_next < 1.05 * width, to_next, width)
        axes.bar(low, density, widths, align="edge", color=HIDDEN, linewidth=0)
        if density.max() > 300 * density[density > 0].min():
            axes.set_yscale("log")
        if unit == "degrees":
            set_degree_ticks(axes.xaxis, np.append(low, low[-1] + width[-1]), most=7)
        quantiles = [key for key in table.rows if key.startswith(f"{name}_q")]
        marks = {f"{write(100 * float(key.rpartition('_q')[2]))} %": row[key] for key in quantiles}
        shown = marks if len(marks) <= 7 else {}
        mark_values(axes, {"mean": row[f"{name}_mean"], **shown}, factor)
        name_axis(axes.yaxis, "density", {"": "", "degrees": "per degree"}.get(unit, f"per {unit}"))
    name_axis(axes.xaxis, words, unit)
    none = int(row["cases"] - row["failed"] - row[f"{name}_count"])
    if none:
        axes.set_title(f"{write_count(none)} cases have no value", fontsize="small")


def mark_values(axes: Axes, marks: dict[str, float], factor: float) -> None:
    """Lines at the mean and at quantiles, named above the panel where no bar is in the way."""
    left, right = axes.get_xlim()
    axes.set_xlim(left, right)
    last = -np.inf
    style = {"xycoords": "axes fraction", "fontsize": "small", "rotation": 90, "ha": "center"}
    for words, value in sorted(marks.items(), key=lambda mark: mark[1]):
        if np.isfinite(value):
            place = (factor * value - left) / (right - left)
            last = max(place, last + 2.2 / letters_of(axes, "x"))  # letters apart
            look = LINES[1] if words == "mean" else {"color": GREY, "linestyle": ":"}
            axes.axvline(factor * value, **look | {"linewidth": 1.0})
            axes.annotate(words, (last, 1.02), va="bottom", color=look["color"], **style)


INDICES = ("first_order", "total")

LOOKS = (
    (-0.13, LINES[0]["color"], {"marker": "o", "label": "first order"}),
    (0.13, LINES[1]["color"], {"marker": "D", "label": "total", "markerfacecolor": GROUND}),
)
"""How far the two indices of a factor stand from its line, their colours and marks; the factors are
1 apart."""


@figure(
    "statistics",
    "cases",
    objection=lambda table: (
        object_to_beside(table, "indices")
        if table.setting("statistics.indices") == "sobol"
        else "has no Sobol' indices"
    ),
)
def draw_indices(table: Table) -> Figure:
    """First-order and total Sobol' indices of a sweep with their intervals."""
    found = rows_beside(table, "indices")
    if not np.isfinite(found["first_order"].to_numpy(float)).any():
        raise TableError("has no column that varies")
    groups = list(found.groupby("column", sort=False))
    title = by_width("Sobol' indices with 95 % intervals", "Sobol' indices")
    most = max(len(rows) for _, rows in groups)
    title += f": {tell_cases(table)}"
    figure, panels = panel_figure(table, title, len(groups), 0.75 + 0.34 * most)
    for axes, (name, rows) in zip(panels, groups, strict=True):
        head(axes, describe(table, str(name))[0])
        draw_dots(axes, rows)
    ends = found[[f"{index}_{end}" for index in INDICES for end in ("low", "high")]].to_numpy(float)
    ends = ends[np.isfinite(ends)]
    low, high = ends.min(initial=0.0), ends.max(initial=0.5)
    room = 0.03 * (high - low)
    # to a half at least, and no further than that beyond 0 and 1, where intervals are wide
    panels[0].set_xlim(max(low - room, -0.5), min(high + room, 1.5))
    panels[0].set_ylim(most - 0.5, -0.5)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=2, borderpad=0)
    for axes in panels:
        axes.tick_params(labelleft=is_left(axes), left=False)
    name_outer(panels, ["share of the variance"])
    return figure


def draw_dots(axes: Axes, rows: pd.DataFrame) -> None:
    """The indices of a column as dots with intervals; a column without indices says so."""
    places = np.arange(len(rows))
    name_rows(axes, [*map(name_of, rows["factor"])])
    axes.axvline(0, color=GREY, linewidth=0.6, zorder=0)
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
