"""The residuals of a run and its true error against time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure, unless
from spintop_figures.motion.trajectory import draw_column, panels, share_limits
from spintop_figures.moving.assumptions import CONSERVED
from spintop_figures.style.axes import Powers, draw_sizes, few_ticks, has_wide_range, name_axis
from spintop_figures.style.look import GREY, LINES
from spintop_figures.style.numbers import write
from spintop_figures.style.page import head, time_panels
from spintop_figures.style.provenance import describe_run, model_of
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import columns_of

TOGETHER = ("R1", "R2")
"""Residuals of one kind, which have one scale."""


@figure(
    "trajectory",
    "t orientation_error",
    objection=unless(
        lambda table: (table.column("orientation_error") > 0).any(),
        "has no error above zero in column orientation_error",  # the axis is a log one
    ),
)
def draw_error(table: Table) -> Figure:
    """Orientation error against time."""
    has_energy = "R4" in table.rows and bool(table.rows["R4"].any())
    title = f"Orientation error: {describe_run(table)}"
    figure, axes = time_panels(table, title, 1 + has_energy, 5.0 if has_energy else 3.6, across=1)
    t, error = table.column("t"), table.column("orientation_error")
    draw_sizes(axes[0], t, error)
    name_axis(axes[0].yaxis, "orientation error", "rad")
    degrees = axes[0].secondary_yaxis("right", functions=(np.degrees, np.radians))
    degrees.set_ylabel("(degrees)")
    few_ticks(degrees.yaxis, 7)
    degrees.yaxis.set_major_formatter(Powers())
    # a dot at the largest, with its size in radians and in degrees
    place = int(np.nanargmax(np.where(np.isfinite(error), error, np.nan)))
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(low, high * (high / low) ** 0.12)  # room for the words
    style = {"color": LINES[1]["color"]}
    axes[0].plot(t[place], error[place], "o", markersize=4.5, zorder=4, **style)
    words = f"largest: {write(error[place], 2)} rad = {write(np.degrees(error[place]), 2)}°"
    side = "right" if t[place] > (t[0] + t[-1]) / 2 else "left"
    style |= {"textcoords": "offset points", "ha": side, "fontsize": "small"}
    axes[0].annotate(words, (t[place], error[place]), (0, 6), **style)
    if has_energy:
        draw_sizes(axes[1], t, table.column("R4"))
        name_axis(axes[1].yaxis, "change of energy\n$|R_4|$", table.units.get("R4", "J"))
    return figure


@figure(
    "trajectory",
    "t R1 R2 R3 R4",
    objection=unless(
        lambda table: model_of(table)[1] != "exact",
        "is of the exact solution, which has no residuals",
    ),
    assumes=CONSERVED,
)
def draw_residuals(table: Table) -> Figure:
    """Residuals R1 to R4 against time (Figures 2 to 7)."""
    figure, axes = panels(table, f"Residuals: {describe_run(table)}")
    by_name = dict(zip(("R1", "R2", "R3", "R4"), axes, strict=True))
    pair_is_log = any(has_wide_range(table.column(name)) for name in TOGETHER)
    for name, axes in by_name.items():
        is_pair = name in TOGETHER
        draw_residual(axes, table, name, pair_is_log if is_pair else None)
        known = columns_of("trajectory")[name]["description"]
        head(axes, f"{name}: {table.meanings.get(name, known).partition(' (')[0]}", pad=18)
        largest = np.abs(table.column(name)[table.finite(name)]).max()
        words = f"largest {write(largest, 2)}" if largest else "zero"
        words = f"scale of {'R1 and R2' if is_pair else f'{name} alone'}; {words}"
        style = {"textcoords": "offset points", "ha": "right", "fontsize": "small", "color": GREY}
        axes.annotate(words, (1, 1), (0, 4), "axes fraction", **style)
    share_limits(*(by_name[name] for name in TOGETHER if np.any(table.column(name))))
    return figure


def draw_residual(axes: Axes, table: Table, name: str, is_log: bool | None) -> None:
    """A residual on its axis, a log one if it needs that; one that is zero throughout says so."""
    y = table.column(name)
    is_log = has_wide_range(y) if is_log is None else is_log
    if is_log and np.any(y):
        draw_sizes(axes, table.column("t"), y)
        name_axis(axes.yaxis, f"$|R_{name[1]}|$", table.units.get(name, ""))
        return
    draw_column(axes, table, name, f"$R_{name[1]}$")
    if not np.any(y):
        axes.set_yticks([0])
        axes.text(0.5, 0.6, "zero throughout", transform=axes.transAxes, ha="center")
