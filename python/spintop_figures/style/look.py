"""The look that all figures share: sizes, lines, colours, and matplotlib's settings."""

import shutil
from contextlib import AbstractContextManager

import matplotlib as mpl

WIDTH = 7.2
"""Width of a figure in inches: a page's text column, so that nothing is scaled down."""

LINES = (
    {"color": "#12355b", "linestyle": "-"},
    {"color": "#d1641b", "linestyle": "--"},
    {"color": "#5aa9a3", "linestyle": "-."},
    {"color": "#8a6fae", "linestyle": ":"},
)
"""Lines that differ in colour, in lightness and in dashes."""

HIDDEN = "#9db3cb"
"""The first line where it is behind or below something: a paler tint of its colour."""

DOTS = {"color": LINES[0]["color"], "linestyle": "", "marker": ".", "markersize": 4}
"""Rows that are too far apart to be joined."""

FAINT = "0.8"
GREY = "0.35"

FAULT = "#b0392a"
"""What failed or is wrong."""

SETTINGS = {
    "font.size": 10,
    "axes.labelsize": 10,
    "axes.titlesize": 10,
    "axes.titley": 1.0,  # to look for a free place takes a quarter of the time
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "legend.fontsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.formatter.limits": (-3, 4),
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "agg.path.chunksize": 10_000,
    "svg.hashsalt": "spintop",
}
"""Settings of matplotlib. They hold while a figure is drawn or saved, not for other figures."""


def the_look() -> AbstractContextManager[None]:
    """A context in which matplotlib has these settings, and LaTeX only if it is there."""
    has_latex = bool(shutil.which("latex") and shutil.which("dvipng"))
    return mpl.rc_context({**SETTINGS, "text.usetex": mpl.rcParams["text.usetex"] and has_latex})
