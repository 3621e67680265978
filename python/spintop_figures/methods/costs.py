"""Error of the methods of a stability study against evaluations, one panel per case."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullLocator

from spintop_figures.methods.known import families
from spintop_figures.methods.styles import Look, look_of
from spintop_figures.methods.trials import cases_by_reference, object_to_trials, trials
from spintop_figures.style.look import FAINT, GREY
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

ACROSS = 3
"""Panels in a row."""

PANEL_HEIGHT, LEAST_HEIGHT = 1.35, 2.6
"""Of a panel, and of all of them, in inches."""

LEAST_ERROR = 1e-15
"""Smaller errors are drawn here, rad."""

FACES = {"accurate": 1.0, "drifts": 0.35, "wrong": 0.0}
"""How full the marker of a verdict is; the other verdicts have none."""

NAMES = {"accurate": "full: accurate", "drifts": "pale: drifts", "wrong": "empty: wrong"}


def object_to_costs(table: Table) -> str:
    """The trials have to be known, and one to have gone to its end."""
    if objection := object_to_trials(table):
        return objection
    return "" if not judged(table.rows).empty else "has no trial that went to its end"


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """The trials that went to their end, at some cost."""
    return rows[rows["verdict"].isin(FACES) & (rows["evaluations"] > 0)]


def draw_costs(table: Table) -> Figure:
    """Error against evaluations, one panel per case, one marker per method."""
    rows = judged(trials(table))
    cases = [case for part in cases_by_reference(rows).values() for case in part]
    across = min(ACROSS, len(cases))
    down = -(-len(cases) // across)
    height = max(PANEL_HEIGHT, LEAST_HEIGHT / down)
    figure = new_figure(table, "Error of the methods against evaluations", 2.4 + height * down)
    grid = figure.add_gridspec(down + 1, across, height_ratios=[height] * down + [1.1])
    first = figure.add_subplot(grid[0, 0])
    set_scales(first, rows)
    panels = [first]
    for place in range(1, len(cases)):
        panels.append(figure.add_subplot(grid[divmod(place, across)], sharex=first, sharey=first))
    for case, axes in zip(cases, panels, strict=True):
        draw_case(axes, rows[rows["case"] == case])
        axes.set_title(case, loc="left", fontsize=9, pad=3)
    for place, axes in enumerate(panels):
        is_left, is_low = place % across == 0, place + across >= len(cases)
        axes.tick_params(labelleft=is_left, labelbottom=is_low)
    panels[down // 2 * across].set_ylabel(
        "largest error of the attitude (rad)", y=0.5 if down % 2 else 1.1
    )
    add_legend(figure.add_subplot(grid[down, :]), rows)
    return figure


def draw_case(axes: Axes, rows: pd.DataFrame) -> None:
    """The trials of a case, above the inherent error of its motion."""
    floor = max(rows["inherent_error"].max(), LEAST_ERROR)
    axes.axhspan(1e-30, floor, color=FAINT, linewidth=0, zorder=0)
    for family in families():
        for verdict, fullness in FACES.items():
            chosen = rows[(rows["family"] == family) & (rows["verdict"] == verdict)]
            errors = np.maximum(chosen["orientation_error"], LEAST_ERROR)
            axes.plot(chosen["evaluations"], errors, **marker(look_of(family), fullness))


def marker(look: Look, fullness: float) -> dict[str, object]:
    """How a family is marked."""
    return {
        "linestyle": "",
        "marker": look.marker,
        "markersize": 9 if look.marker == "*" else 6,
        "markerfacecolor": (look.colour, fullness),
        "markeredgecolor": look.colour,
        "markeredgewidth": 0.8,
    }


def set_scales(axes: Axes, rows: pd.DataFrame) -> None:
    """Log axes, from the least to the largest of all cases."""
    costs, errors = rows["evaluations"], rows["orientation_error"]
    axes.set(xscale="log", yscale="log")
    axes.set_xlim(costs.min() / 2, costs.max() * 2)
    axes.set_ylim(max(errors.min(), LEAST_ERROR) / 10, errors.max() * 10)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=6))
        axis.set_minor_locator(NullLocator())


def add_legend(axes: Axes, rows: pd.DataFrame) -> None:
    """What the markers mean, below the panels."""
    known = [family for family in families() if (rows["family"] == family).any()]
    handles = [Line2D([], [], label=family, **marker(look_of(family), 1)) for family in known]
    grey = Look("o", GREY)
    for verdict, fullness in FACES.items():
        handles.append(Line2D([], [], label=NAMES[verdict], **marker(grey, fullness)))
    handles.append(Patch(color=FAINT, linewidth=0, label="inherent error"))
    axes.axis("off")
    legend = axes.legend(
        handles=handles,
        loc="upper center",
        ncols=4,
        columnspacing=1.2,
        handletextpad=0.4,
        title="function evaluations (a Taylor series of order p counts as p)",
        title_fontsize=10,
    )
    legend.set_in_layout(False)  # it may be wider than the panels
