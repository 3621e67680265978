"""Published benchmarks: how far the published numbers are off, and what an equal error costs."""

import re
import textwrap

import numpy as np
from matplotlib.figure import Figure

from spintop_figures.kinds import figure, unless
from spintop_figures.style.axes import few_ticks, name_axis, name_rows
from spintop_figures.style.look import GREY, LINES, by_width
from spintop_figures.style.numbers import with_power, write
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

LEAST = 1e-17
"""Smaller errors are drawn here."""

ROW, LETTERS = (0.44, 0.62), (44, 22)
"""Height of a line in inches, and letters of what was published, on a page and in a column."""


@figure(
    "benchmark",
    "published_error error truth_error time_s",
    words="benchmark quantity published_method",
    objection=unless(
        lambda table: table.rows["published_error"].notna().any(),
        "has no published number to compare with",
    ),
    sparse=True,
)
def draw_benchmarks(table: Table) -> Figure:
    """Errors of published numbers and of spintop.

    The errors of all quantities of a publication on a line: published, spintop's, the truth's.

    Spintop's are those of its cheapest run that has at most a hundredth of the published error.
    """
    rows = table.rows[table.rows["published_error"].notna()]
    groups = list(rows.groupby(["benchmark", "published_method"], sort=False))
    figure = new_figure(table, "Published benchmarks", 1.5 + by_width(*ROW) * len(groups))
    axes = figure.add_subplot()
    looks = (
        ("published_error", "published", {"marker": "D", "color": LINES[1]["color"]}),
        ("error", "spintop, in this time", {"marker": "o", "color": LINES[0]["color"]}),
        ("truth_error", "reference", {"marker": "|", "color": GREY}),
    )
    beside = {"xycoords": axes.get_yaxis_transform(), "va": "center", "fontsize": "small"}
    for place, (_, part) in enumerate(groups):
        for column, label, look in looks:
            errors = np.maximum(part[column].dropna().to_numpy(float), LEAST)
            style = look | {"linestyle": "", "markersize": 5, "alpha": 0.8}
            axes.plot(errors, np.full(errors.shape, place), **style, label="" if place else label)
        longest = part["time_s"].max() * 1e6
        time = f"{write(longest, 2)} µs" if np.isfinite(longest) else ""  # else not computed
        axes.annotate(time, (1.01, place), **beside, color=GREY)
    axes.set_xscale("log")
    few_ticks(axes.xaxis, by_width(9, 4))
    name_rows(axes, [describe(*map(str, key)) for key, _ in groups])
    name_axis(axes.xaxis, by_width("error of a quantity, in its unit", "error, in its unit"))
    if by_width(True, False):
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper right", ncols=3)
    else:
        axes.legend(loc="upper right", bbox_to_anchor=(1.2, -0.1), borderpad=0)
    return figure


def describe(benchmark: str, method: str) -> str:
    """A benchmark and what was published, in three short lines at most."""
    method = re.sub(r"\b1e(-?\d+)", lambda power: with_power("1", int(power[1])), method)
    lines = textwrap.wrap(method, by_width(*LETTERS), max_lines=2, placeholder=" …")
    return "\n".join([benchmark.replace("_", " "), *lines])
