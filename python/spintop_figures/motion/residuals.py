"""How far off a run is: its residuals, its true error, and how far its constants drift."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.methods.known import rank_of, style_of
from spintop_figures.motion.trajectory import draw_column, panels, share_limits
from spintop_figures.moving.assumptions import CONSERVED, symmetric
from spintop_figures.style import page
from spintop_figures.style.axes import Powers, draw_sizes, few_ticks, has_wide_range, name_axis
from spintop_figures.style.look import GREY, LINES, by_width
from spintop_figures.style.numbers import write
from spintop_figures.tables.names import columns_of, name_of
from spintop_figures.tables.table import Table

TOGETHER = ("R1", "R2")
"""Residuals of one kind, which have one scale."""


@figure(
    "trajectory",
    "t orientation_error",
    unless={  # the axis is a log one
        "has no error above zero in column orientation_error": lambda table: (
            table.column("orientation_error") > 0
        ).any()
    },
)
def draw_error(table: Table) -> Figure:
    """Orientation error against time."""
    has_energy = "R4" in table.rows and bool(table.rows["R4"].any())
    title = f"Orientation error: {page.describe_run(table)}"
    figure, axes = page.time_panels(
        table, title, 1 + has_energy, 5.0 if has_energy else 3.6, across=1
    )
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
    unless={
        "is of the exact solution, which has no residuals": lambda table: (
            page.model_of(table)[1] != "exact"
        )
    },
    assumes=CONSERVED,
)
def draw_residuals(table: Table) -> Figure:
    """Residuals R1 to R4 against time (Figures 2 to 7)."""
    figure, axes = panels(table, f"Residuals: {page.describe_run(table)}")
    by_name = dict(zip(("R1", "R2", "R3", "R4"), axes, strict=True))
    pair_is_log = any(has_wide_range(table.column(name)) for name in TOGETHER)
    for name, axes in by_name.items():
        is_pair, y = name in TOGETHER, table.column(name)
        if np.any(y) and (pair_is_log if is_pair else has_wide_range(y)):
            draw_sizes(axes, table.column("t"), y)
            name_axis(axes.yaxis, f"$|R_{name[1]}|$", table.units.get(name, ""))
        else:
            draw_column(axes, table, name, f"$R_{name[1]}$")
        if not np.any(y):
            axes.set_yticks([0])
            axes.text(0.5, 0.6, "zero throughout", transform=axes.transAxes, ha="center")
        known = columns_of("trajectory")[name]["description"]
        page.head(axes, f"{name}: {table.meanings.get(name, known).partition(' (')[0]}", pad=18)
        largest = np.abs(y[np.isfinite(y)]).max()
        words = f"largest {write(largest, 2)}" if largest else "zero"
        words = f"scale of {'R1 and R2' if is_pair else f'{name} alone'}; {words}"
        style = {"textcoords": "offset points", "ha": "right", "fontsize": "small", "color": GREY}
        axes.annotate(words, (1, 1), (0, 4), "axes fraction", **style)
    share_limits(*(by_name[name] for name in TOGETHER if np.any(table.column(name))))
    return figure


LEAST = 1e-18
"""What is smaller is not drawn."""

CONSTANTS = {
    "energy_error": ("relative energy error", ""),
    "lz": ("change of $L_z$", "J s"),
    "l3": ("change of $L_3$", "J s"),
    "norm_error": ("norm error $|q|-1$ of the quaternion", ""),
}
"""Columns that are drawn where all tables have them; of those with a unit the change is drawn."""


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
    unless={
        "has no error of the energy above zero": lambda table: (
            running_maximum(table, "energy_error")[1] > LEAST
        ).any()
    },
    assumes=CONSERVED,
    together=True,
)
def draw_drift(tables: Sequence[Table]) -> Figure:
    """Drift of the first integrals and of the quaternion norm in long runs of several methods.

    The running maximum of each constant's error against time, with guide lines.
    """

    def lacks(table: Table, name: str) -> object:
        varies = name == "l3" and symmetric(table)
        return table.missing([name]) or table.empty([name]) or varies

    there = [name for name in CONSTANTS if not any(lacks(table, name) for table in tables)]
    methods = [method_of(table)[0] for table in tables]
    title = "Drift of the first integrals"
    figure, panels = page.panel_figure(tables, title, len(there), 2.6, 0, 1.9, "x", has_foot=True)
    ordered = sorted(tables, key=lambda table: rank_of(method_of(table)[0]))
    for column, axes in zip(there, panels, strict=True):
        axes.set(xscale="log", yscale="log")
        for table in ordered:
            t, off = running_maximum(table, column)
            style = style_of(*method_of(table)) | {"markevery": (0.05, 0.12)}
            method = method_of(table)[0]
            twice = methods.count(method) > 1  # then all of the run tells them apart
            label = page.describe_run(table).replace(", ", "\n") if twice else name_of(method)
            axes.plot(t, np.where(off > LEAST, off, np.nan), **style, label=label)
        draw_guides(axes)
        words, unit = CONSTANTS[column]
        page.head(axes, words, axes.yaxis, unit)
    page.name_outer(panels, page.TIME)
    handles, labels = panels[0].get_legend_handles_labels()
    columns = 2 if any("\n" in label for label in labels) else by_width(4, 2)
    page.legend_below(panels, handles, columns)
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
