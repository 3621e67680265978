"""Error against time of spintop and of other programs on the same problem."""

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.methods.styles import style_of
from spintop_figures.style.look import FAINT, by_width
from spintop_figures.style.page import add_panels, is_lowest, new_figure, panel_rows
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

DOCUMENTED = ("peers_work_precision_slow_top",)
"""Pictures of scripts/compare_peers that doc/figures has, too, by the stems of their files."""
OWN = "spintop"
OWN_METHODS = ("taylor", "splitting_8", "dop853", "ode45")
"""Methods of spintop that are drawn, as in every figure."""
PEER_MARKERS = {
    "heyoka": "h",
    "Boost.odeint": "^",
    "SUNDIALS": "s",
    "SciPy": "o",
    "MuJoCo": "D",
    "GNU Octave": "X",
}
PEER_GREY = "0.45"
LEAST_ERROR, LARGEST_ERROR = 1e-17, 3.2
"""Errors are drawn between these, rad: the one stands for zero too, no turn is beyond pi."""
PANEL_HEIGHT, ALONE = 2.9, 4.2
"""Of a row of panels and of a single one, in inches."""
TICKS = 9
"""At most, on the width of a figure."""


def object_to_peers(table: Table) -> str:
    """Something has to have gone to its end."""
    return "" if ended_well(table.rows).any() else "has no row that went to its end"


def draw_peers(table: Table) -> Figure:
    """The cheapest way to each error: a line a method of spintop, a grey one each other program."""
    problems = list(table.rows["problem"].unique())
    panel = ALONE if len(problems) == 1 else PANEL_HEIGHT
    title = (
        f"Error against time: {name_of(problems[0])}"
        if len(problems) == 1
        else "Error against time"
    )
    figure = new_figure(table, title, 1.9 + panel * panel_rows(len(problems)))
    panels = add_panels(figure, len(problems))
    handles: dict[str, object] = {}
    for name, axes in zip(problems, panels, strict=True):
        rows = table.rows[(table.rows["problem"] == name) & ended_well(table.rows)]
        handles |= draw_problem(axes, rows, min(len(problems), 2))
        if len(problems) > 1:
            axes.set_title(name_of(name), loc="left", fontsize=9.5, pad=4)
        place = axes.get_subplotspec()
        if place.is_first_col():
            axes.set_ylabel("error of the attitude at the end (rad)")
        if is_lowest(axes):
            axes.set_xlabel("time (s)")
    order = [*OWN_METHODS, "exact", *PEER_MARKERS, "floor"]
    known = [handles[name] for name in order if name in handles]
    place, columns = by_width("right center", "lower center"), by_width(1, 2)
    figure.legend(handles=known, loc=f"outside {place}", ncols=columns, handlelength=2.6)
    return figure


def draw_problem(axes: Axes, rows: pd.DataFrame, across: int) -> dict[str, object]:
    """One problem, in a row of so many panels; gives what the legend shows, by name."""
    handles: dict[str, object] = {}
    axes.set(xscale="log", yscale="log", ylim=(LEAST_ERROR, 10))
    floor = rows["inherent_error"].max()
    if math.isfinite(floor):
        handles["floor"] = axes.axhspan(
            LEAST_ERROR / 10, floor, color=FAINT, linewidth=0, label="inherent error"
        )
    for program, marker in PEER_MARKERS.items():
        style = {"color": PEER_GREY, "linewidth": 0.9, "marker": marker, "markersize": 4.5}
        style |= {"markerfacecolor": "white"}
        draw_front(axes, rows[rows["program"] == program], program, style, handles)
    own = rows[rows["program"] == OWN]
    for method in OWN_METHODS:
        style = style_of(method) | {"linestyle": "-", "linewidth": 1.6}
        draw_front(axes, own[own["method"] == method], method, style, handles)
    style = style_of("exact") | {"linestyle": "", "markersize": 9}
    draw_front(axes, own[own["method"] == "exact"], "exact", style, handles)
    for axis, ticks in ((axes.xaxis, TICKS // across), (axes.yaxis, TICKS)):
        axis.set_major_locator(LogLocator(numticks=ticks))
        axis.set_minor_locator(NullLocator())
    axes.grid(color="0.92", linewidth=0.6)
    axes.set_axisbelow(True)
    return handles


def draw_front(
    axes: Axes, rows: pd.DataFrame, name: str, style: dict, handles: dict[str, object]
) -> None:
    """The rows than which no other of these is both cheaper and more exact."""
    rows = rows.sort_values(["time_s", "orientation_error"])
    errors = rows["orientation_error"].to_numpy(float)
    best = np.minimum.accumulate(errors) if errors.size else errors
    chosen = np.append(True, best[1:] < best[:-1])[: errors.size] & (errors <= LARGEST_ERROR)
    if not chosen.any():
        return
    label = name if name in PEER_MARKERS else f"{OWN}, {name_of(name)}"
    (handles[name],) = axes.plot(
        rows["time_s"].to_numpy(float)[chosen],
        np.maximum(errors[chosen], LEAST_ERROR * 2),
        label=label,
        zorder=2 if name in PEER_MARKERS else 3,
        **style,
    )
