"""How far the constants of a long motion drift: several methods beside each other."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure, unless
from spintop_figures.methods.known import rank_of, style_of
from spintop_figures.moving.assumptions import CONSERVED, broken, symmetric
from spintop_figures.style.look import GREY, by_width
from spintop_figures.style.page import TIME, head, legend_below, name_outer, panel_figure
from spintop_figures.style.provenance import describe_run
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

LEAST = 1e-18
"""What is smaller is not drawn."""

CONSTANTS = {
    "energy_error": ("relative energy error", ""),
    "lz": ("change of $L_z$", "J s"),
    "l3": ("change of $L_3$", "J s"),
    "norm_error": ("norm error $|q|-1$ of the quaternion", ""),
}
"""Columns that are drawn where all tables have them; of those with a unit the change is drawn."""

ASSUMES = {"l3": (symmetric,)}
"""For which bodies they are constant, beside those that the figure is for."""


def running_maximum(table: Table, column: str) -> tuple[np.ndarray, np.ndarray]:
    """Times after the start, and how far a constant was off at most until then."""
    t, value = table.column("t"), table.column(column)
    off = np.abs(value - value[0] if CONSTANTS[column][1] else value)
    return t[1:], np.fmax.accumulate(off[1:])


def method_of(table: Table) -> tuple[str, str]:
    """The method of a run and its formulation."""
    return table.model_and_method[::-1]


@figure(
    "trajectory",
    "t energy_error",
    objection=unless(
        lambda table: (running_maximum(table, "energy_error")[1] > LEAST).any(),
        "has no error of the energy above zero",
    ),
    assumes=CONSERVED,
    together=True,
)
def draw_drift(tables: Sequence[Table]) -> Figure:
    """Drift of the first integrals and of the quaternion norm in long runs of several methods.

    The running maximum of each constant's error against time, with guide lines.
    """

    def lacks(table: Table, name: str) -> object:
        return table.missing([name]) or table.empty([name]) or broken(ASSUMES.get(name, ()), table)

    there = [name for name in CONSTANTS if not any(lacks(table, name) for table in tables)]
    methods = [method_of(table)[0] for table in tables]
    title = "Drift of the first integrals"
    figure, panels = panel_figure(tables, title, len(there), 2.6, 0, 1.9, "x", has_foot=True)
    ordered = sorted(tables, key=lambda table: rank_of(method_of(table)[0]))
    for column, axes in zip(there, panels, strict=True):
        axes.set(xscale="log", yscale="log")
        for table in ordered:
            t, off = running_maximum(table, column)
            style = style_of(*method_of(table)) | {"markevery": (0.05, 0.12)}
            method = method_of(table)[0]
            twice = methods.count(method) > 1  # then all of the run tells them apart
            label = describe_run(table).replace(", ", "\n") if twice else name_of(method)
            axes.plot(t, np.where(off > LEAST, off, np.nan), **style, label=label)
        draw_guides(axes)
        words, unit = CONSTANTS[column]
        head(axes, words, axes.yaxis, unit)
    name_outer(panels, TIME)
    handles, labels = panels[0].get_legend_handles_labels()
    columns = 2 if any("\n" in label for label in labels) else by_width(4, 2)
    legend_below(panels, handles, columns)
    return figure


def draw_guides(axes: Axes) -> None:
    """Lines that grow as powers of time, from the middle of the left side."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    style = {"textcoords": "offset points", "va": "center", "fontsize": "small", "color": GREY}
    # rounding errors of one sign grow with time, those of either with its root
    for power, label in ((1.0, "$t$"), (0.5, r"$t^{1/2}$")):
        start = np.sqrt(low * high) / (right / left) ** (power / 2)
        ends = start, start * (right / left) ** power
        axes.plot((left, right), ends, color=GREY, linewidth=0.8, linestyle=":")
        axes.annotate(label, (right, ends[1]), (3, 0), annotation_clip=False, **style)
    axes.set(xlim=(left, right), ylim=(low, high))
