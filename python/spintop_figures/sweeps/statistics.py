"""The statistics of a sweep: maps or curves over its bins, and the distributions over all cases."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from spintop_figures.style.lines import set_degree_ticks
from spintop_figures.style.look import FAINT, GREY, HIDDEN, LINES, by_width
from spintop_figures.style.numbers import MINUS, numbers, write, write_count
from spintop_figures.style.page import add_panels, head, is_lowest, new_figure, panel_rows, width_of
from spintop_figures.sweeps.maps import LEAST_HEIGHT, PANEL_HEIGHT, scale_name
from spintop_figures.sweeps.quantities import Quantity, parameter_words, the_column, unit_shown
from spintop_figures.sweeps.scales import COLOURS, colours_of, is_signed, scale_of
from spintop_figures.tables.names import axis_of, column_name, with_unit
from spintop_figures.tables.netcdf import read_netcdf
from spintop_figures.tables.table import Table, TableError, read_table

ENDING = ".statistics.csv"
EQUAL = 1e-6
"""Relative difference below which steps or ratios are equal."""
MOST_QUANTILES = 7
"""Quantiles that a distribution shows at most."""
SLIT = 0.05
"""A gap between two intervals that is narrower than this part of them is not drawn."""
DARK = -0.5
"""Bins below this part of the largest size have dark colours."""
EVEN = 1.5
"""Variance over mean of the cases in bins, which is 1 of random ones, up to which they are even."""
NAME_ROOM = 0.16
"""Distance of the names of two lines, in inches."""


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
        return bool(np.ptp(ratios) < EQUAL * ratios.max() and np.ptp(steps) > EQUAL * steps.max())


class Distribution(NamedTuple):
    """The histogram of a column: the ends of its intervals and the cases in them."""

    low: np.ndarray
    high: np.ndarray
    cases: np.ndarray


def bins_of(table: Table) -> list[Bins]:
    """The bins of each quantity that the cases are binned over."""
    names = list(table.rows.columns)
    found = []
    for name in names[1 : names.index("cases") : 3]:
        rows = table.rows[table.rows["bin"] > 0]
        low, high = rows[f"{name}_from"].to_numpy(float), rows[f"{name}_to"].to_numpy(float)
        edges = np.append(np.unique(low), high.max())
        found.append(Bins(name, edges, np.unique(rows[name].to_numpy(float))))
    return found


def gathered(table: Table) -> list[str]:
    """The columns of numbers that have statistics."""
    return [
        name.removesuffix("_mean")
        for name in table.rows
        if f"{name.removesuffix('_mean')}_deviation" in table.rows and name.endswith("_mean")
    ]


def object_to_bins(table: Table) -> str:
    """There is something over which the cases are binned."""
    return "" if bins_of(table) else "has no bins"


def object_to_distributions(table: Table) -> str:
    """There are numbers, and their histograms where they are looked for."""
    if not gathered(table):
        return "has no column of numbers"
    return object_to_beside(table, "histogram")


def object_to_beside(table: Table, what: str) -> str:
    """A table of histograms or indices belongs to that of the statistics."""
    path = beside(table.path, what)
    there = what in table.others if table.frame else path.exists()
    return "" if there or table.path.suffix == ".nc" else f"has no {path.name} beside it"


def rows_beside(table: Table, what: str) -> pd.DataFrame:
    """The rows of the histograms or of the indices that belong to a table of statistics."""
    other = table.others.get(what) or read_table(beside(table.path, what))
    return other.rows


def beside(path: Path, what: str) -> Path:
    """A table beside a table of statistics: of the histograms, or the indices."""
    stem = path.name.removesuffix(ENDING) if path.name.endswith(ENDING) else path.stem
    return path.with_name(f"{stem}.{what}.csv")


def distributions_of(table: Table) -> dict[str, Distribution]:
    """The histogram of each column."""
    if table.path.suffix == ".nc":
        _, variables = read_netcdf(table.path)
        found = {}
        for name, variable in variables.items():
            if name.endswith("_histogram"):
                column = name.removesuffix("_histogram")
                ends = variables[f"{column}_interval_bounds"].values.astype(float)
                found[column] = Distribution(ends[:, 0], ends[:, 1], variable.values.astype(float))
        return found
    rows = rows_beside(table, "histogram")
    return {
        str(name): Distribution(*(part[key].to_numpy(float) for key in ("from", "to", "cases")))
        for name, part in rows.groupby("column", sort=False)
    }


def tell_cases(table: Table) -> str:
    """How many cases there are, and how many of them failed."""
    row = table.rows.iloc[0]
    failed = f", {write_count(row['failed'])} of them failed" if row["failed"] else ""
    return f"{write_count(row['cases'])} cases{failed}"


def label(table: Table, column: str) -> str:
    """A parameter or a column with its unit, as an axis names it."""
    return axis_of(column, table.units.get(column, ""))


def describe(table: Table, column: str) -> tuple[str, str, float]:
    """What a column of the cases is called, the unit in which it is drawn, the factor to that."""
    meaning = table.meanings.get(f"{column}_mean", "").removeprefix("mean: ")
    return column_name(column, meaning), *unit_shown(column, table.units.get(f"{column}_mean", ""))


def draw_statistics(table: Table) -> Figure:
    """The mean of each column over the bins, and the number of cases."""
    bins = bins_of(table)
    rows = table.rows[table.rows["bin"] > 0]
    names = gathered(table)
    is_noise = len(bins) == 2 and names and is_even(rows["cases"].to_numpy(float))
    names += [] if is_noise else [""]
    count = len(names)
    over = " and ".join(parameter_words(each.column) for each in bins)
    title = f"Means over {over}: {tell_cases(table)}"
    if "" not in names:
        title += f", about {write(rows['cases'].mean(), 3)} in each bin"
    figure = new_figure(table, title, 1.2 + max(PANEL_HEIGHT * panel_rows(count), LEAST_HEIGHT))
    panels = add_panels(figure, count, sharey=len(bins) == 2)
    for name, axes in zip(names, panels, strict=True):
        if len(bins) == 2:
            draw_map(axes, table, bins, rows, name)
        else:
            draw_curve(axes, table, bins[0], rows, name)
    for axes in panels:
        label_bins(axes, table, bins)
    return figure


def is_even(cases: np.ndarray) -> bool:
    """Whether the numbers of cases in bins differ no more than those of random cases do."""
    return bool(cases.size > 1 and cases.var() <= EVEN * cases.mean())


def draw_map(axes: Axes, table: Table, bins: list[Bins], rows: pd.DataFrame, name: str) -> None:
    """A map of a mean, or of the number of cases; bins without values are hatched."""
    axes.patch.set(facecolor="white", edgecolor="0.7", hatch="////")
    shape = bins[1].edges.size - 1, bins[0].edges.size - 1
    if name:
        words, unit, factor = describe(table, name)
        values = factor * rows[f"{name}_mean"].to_numpy(float)
        norm, extend = scale_of(Quantity((name,), name, unit, the_column(f"{name}_mean")), values)
        colours, heading = colours_of(norm), with_unit(words, unit)
        values = np.clip(values, norm.vmin, norm.vmax)
        if is_signed(norm):
            heading += f"; {MINUS}: below zero"
            mark_negative(axes, *(rows[each.column].to_numpy(float) for each in bins), values)
    else:
        values = rows["cases"].to_numpy(float)
        values = np.where(values > 0, values, np.nan)
        above = values[np.isfinite(values)]
        wide = above.size and above.max() > 100 * above.min()
        norm, extend, colours = LogNorm() if wide else None, "neither", COLOURS
        heading = "number of cases"
    head(axes, heading)
    cells = np.ma.masked_invalid(values.reshape(shape))
    image = axes.pcolormesh(
        bins[0].edges, bins[1].edges, cells, cmap=colours, norm=norm, rasterized=True
    )
    axes.figure.colorbar(image, ax=axes, extend=extend, pad=0.02, aspect=18)


def mark_negative(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray) -> None:
    """A minus in each bin below zero, as signs are not seen in print without colours."""
    style = {"marker": "_", "linestyle": "", "markersize": 3, "markeredgewidth": 0.8}
    dark = values < DARK * np.nanmax(np.abs(values))
    for chosen, colour in (((values < 0) & ~dark, "black"), (dark, "white")):
        axes.plot(x[chosen], y[chosen], color=colour, rasterized=True, **style)


def draw_curve(axes: Axes, table: Table, bins: Bins, rows: pd.DataFrame, name: str) -> None:
    """A mean with standard deviation and extremes, or the number of cases, over one quantity."""
    if not name:
        axes.stairs(rows["cases"].to_numpy(float), bins.edges, fill=True, color=HIDDEN)
        head(axes, "number of cases")
        axes.set_ylim(bottom=0)
        return
    middle = rows[bins.column].to_numpy(float)
    words, unit, factor = describe(table, name)
    mean, deviation, low, high = (
        factor * rows[f"{name}_{key}"].to_numpy(float)
        for key in ("mean", "deviation", "min", "max")
    )
    axes.fill_between(middle, low, high, color=FAINT, linewidth=0, label="minimum to maximum")
    axes.fill_between(
        middle,
        np.maximum(mean - deviation, low),
        np.minimum(mean + deviation, high),
        color=HIDDEN,
        linewidth=0,
        label="standard deviation",
    )
    axes.plot(middle, mean, **LINES[0], label="mean")
    head(axes, with_unit(words, unit))
    if not axes.get_subplotspec().is_first_row() or not axes.get_subplotspec().is_first_col():
        return
    axes.legend(loc="best", fontsize=8)


def label_bins(axes: Axes, table: Table, bins: list[Bins]) -> None:
    """Scales and labels of the binned quantities, at the left and lowest panels only."""
    spot = axes.get_subplotspec()
    plain = numbers()
    axes.set_xscale(scale_name(bins[0].is_log))
    axes.set_xlim(bins[0].edges[0], bins[0].edges[-1])
    if bins[0].is_log:
        axes.xaxis.set_major_formatter(plain)
    if is_lowest(axes):
        axes.set_xlabel(label(table, bins[0].column))
    if len(bins) < 2:
        return
    axes.set_yscale(scale_name(bins[1].is_log))
    axes.set_ylim(bins[1].edges[0], bins[1].edges[-1])
    if bins[1].is_log:
        axes.yaxis.set_major_formatter(plain)
    if table.units.get(bins[1].column) == "deg":
        set_degree_ticks(axes.yaxis, bins[1].edges)
    if spot.is_first_col():
        axes.set_ylabel(label(table, bins[1].column))


def draw_distributions(table: Table) -> Figure:
    """The distribution of each column over all cases, with its mean and quantiles."""
    found = distributions_of(table)
    if not found:
        raise TableError("has no value in any column: no distributions figure")
    names = [name for name in gathered(table) if name in found]
    title = f"Distributions over {tell_cases(table)}"
    figure = new_figure(table, title, 1.2 + max(PANEL_HEIGHT * panel_rows(len(names)), 3.0))
    across = min(by_width(2, 1), len(names))
    cells = figure.add_gridspec(-(-len(names) // across), across)
    for place, name in enumerate(names):
        axes = figure.add_subplot(cells[divmod(place, across)])
        draw_distribution(axes, table, name, found[name])
    return figure


def draw_distribution(axes: Axes, table: Table, name: str, found: Distribution) -> None:
    """The density of the cases over a column, whose intervals differ in width."""
    row = table.rows.iloc[0]
    words, unit, factor = describe(table, name)
    low, width = factor * found.low, factor * (found.high - found.low)
    if not width.any():
        axes.axvline(low[0], **LINES[0])
        axes.set_yticks([])
    else:
        share = found.cases / found.cases.sum()
        density = np.divide(share, width, out=np.zeros_like(share), where=width > 0)
        axes.bar(low, density, without_slits(low, width), align="edge", color=HIDDEN, linewidth=0)
        if density.max() > 300 * density[density > 0].min():
            axes.set_yscale("log")
        if unit == "degrees":
            set_degree_ticks(axes.xaxis, np.append(low, low[-1] + width[-1]), most=7)
        quantiles = [key for key in table.rows if key.startswith(f"{name}_q")]
        marks = {f"{write(100 * float(key.rpartition('_q')[2]))} %": row[key] for key in quantiles}
        shown = marks if len(marks) <= MOST_QUANTILES else {}
        mark_values(axes, {"mean": row[f"{name}_mean"], **shown}, factor)
        per = {"": "", "degrees": "per degree"}.get(unit, f"per {unit}")
        axes.set_ylabel(with_unit("density", per))
    axes.set_xlabel(with_unit(words, unit))
    none = int(row["cases"] - row["failed"] - row[f"{name}_count"])
    if none:
        axes.set_title(f"{write_count(none)} cases have no value", loc="left", fontsize=8.5)


def without_slits(low: np.ndarray, width: np.ndarray) -> np.ndarray:
    """The widths of bars as they are drawn: they reach to the next one if that is near."""
    to_next = np.append(np.diff(low), width[-1])
    return np.where(to_next < (1 + SLIT) * width, to_next, width)


def mark_values(axes: Axes, marks: dict[str, float], factor: float) -> None:
    """Lines at the mean and at quantiles, named above the panel where no bar is in the way."""
    left, right = axes.get_xlim()
    axes.set_xlim(left, right)
    last = -np.inf
    for words, value in sorted(marks.items(), key=lambda mark: mark[1]):
        if not np.isfinite(value):
            continue
        place = (factor * value - left) / (right - left)
        last = max(place, last + NAME_ROOM / width_of(axes))
        look = LINES[1] if words == "mean" else {"color": GREY, "linestyle": ":"}
        axes.axvline(factor * value, **look | {"linewidth": 1.0})
        style = {"fontsize": 8, "color": look["color"], "rotation": 90, "ha": "center"}
        axes.annotate(words, (last, 1.02), xycoords="axes fraction", va="bottom", **style)
