"""How far the constants of a long motion drift: several methods beside each other."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.methods.known import rank_of
from spintop_figures.methods.styles import style_of
from spintop_figures.motion.trajectory import TIME, numbers
from spintop_figures.moving.assumptions import Assumption, broken, symmetric
from spintop_figures.style.look import GREY, by_width
from spintop_figures.style.page import new_figure
from spintop_figures.style.provenance import describe_run
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

LEAST = 1e-18
"""What is smaller is not drawn."""

GUIDES = ((1.0, "$t$"), (0.5, r"$t^{1/2}$"))
"""Rounding errors of one sign grow with time, those of either sign with its root."""


class Constant(NamedTuple):
    """A constant of the motion: its column, its label, whether it is the change that is drawn."""

    column: str
    label: str
    changes: bool
    assumes: tuple[Assumption, ...] = ()
    """For which bodies it is constant, beside those that the figure is for."""


CONSTANTS = (
    Constant("energy_error", "relative energy error", False),
    Constant("lz", "change of $L_z$ (J s)", True),
    Constant("l3", "change of $L_3$ (J s)", True, (symmetric,)),
    Constant("norm_error", "norm error $|q|-1$ of the quaternion", False),
)
"""Those that are drawn where all tables have them."""


def running_maximum(table: Table, constant: Constant) -> tuple[np.ndarray, np.ndarray]:
    """Times after the start, and how far a constant was off at most until then."""
    t, value = numbers(table, "t"), numbers(table, constant.column)
    off = np.abs(value - value[0] if constant.changes else value)
    return t[1:], np.fmax.accumulate(off[1:])


def object_to_drift(table: Table) -> str:
    """Log axes show errors above zero, after the start."""
    _, off = running_maximum(table, CONSTANTS[0])
    return "" if (off > LEAST).any() else "has no error of the energy above zero"


def method_of(table: Table) -> tuple[str, str]:
    """The method of a run and its formulation."""
    model, method = table.model_and_method
    return method, model


def label_of(table: Table, tables: Sequence[Table]) -> str:
    """The method, or all of the run where the method is there twice."""
    methods = [method_of(other)[0] for other in tables]
    method = method_of(table)[0]
    return (
        name_of(method) if methods.count(method) == 1 else describe_run(table).replace(", ", "\n")
    )


def draw_drift(tables: Sequence[Table]) -> Figure:
    """The running maximum of each constant's error against time, with guide lines."""
    there = [
        constant
        for constant in CONSTANTS
        if not any(
            table.missing([constant.column])
            or table.empty([constant.column])
            or broken(constant.assumes, table)
            for table in tables
        )
    ]
    across = min(by_width(2, 1), len(there))
    down = -(-len(there) // across)
    figure = new_figure(tables, "Drift of the first integrals", 1.9 + 2.6 * down)
    cells = figure.add_gridspec(down + 1, across, height_ratios=[1] * down + [0.01])
    panels: list[Axes] = []
    for place in range(len(there)):
        first = panels[0] if panels else None
        panels.append(figure.add_subplot(cells[divmod(place, across)], sharex=first))
    ordered = sorted(tables, key=lambda table: rank_of(method_of(table)[0]))
    for constant, axes in zip(there, panels, strict=True):
        axes.set(xscale="log", yscale="log")
        for table in ordered:
            t, off = running_maximum(table, constant)
            off = np.where(off > LEAST, off, np.nan)
            style = style_of(*method_of(table)) | {"markevery": (0.05, 0.12)}
            axes.plot(t, off, **style, label=label_of(table, tables))
        draw_guides(axes)
        axes.set_title(constant.label, loc="left", pad=4)
    for axes in panels[:-across]:
        axes.tick_params(labelbottom=False)
    for axes in panels[-across:]:
        axes.set_xlabel(TIME)
    below = figure.add_subplot(cells[down, :])
    below.set_axis_off()
    handles, labels = panels[0].get_legend_handles_labels()
    columns = 2 if any("\n" in label for label in labels) else by_width(4, 2)
    below.legend(handles, labels, loc="upper center", ncols=columns, handlelength=3)
    return figure


def draw_guides(axes: Axes) -> None:
    """Lines that grow as powers of time, from the middle of the left side."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    t = np.array([left, right])
    for power, label in GUIDES:
        start = np.sqrt(low * high) / (right / left) ** (power / 2)
        axes.plot(t, start * (t / left) ** power, color=GREY, linewidth=0.8, linestyle=":")
        axes.annotate(
            label, (right, start * (right / left) ** power), (3, 0), textcoords="offset points",
            va="center", fontsize=9, color=GREY, annotation_clip=False,
        )  # fmt: skip
    axes.set(xlim=(left, right), ylim=(low, high))
