"""The look that all figures share: sizes, lines, colours, and matplotlib's settings."""

import shutil
from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl

from spintop_figures.style.colours import is_dark
from spintop_figures.style.options import DEFAULT, LEAST_LETTERS, LETTERS, Options

WIDTH = 7.2
"""Width of a figure in inches: a page's text column, so that nothing is scaled down."""

NARROW = 5.0
"""Inches of the usual letters up to which a figure is narrow: panels stand below each other."""

LINES = (
    {"color": "#12355b", "linestyle": "-"},
    {"color": "#d1641b", "linestyle": "--"},
    {"color": "#2da4a1", "linestyle": "-."},
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
    "font.size": LETTERS,
    "figure.figsize": (WIDTH, WIDTH),
    "axes.labelsize": LETTERS,
    "axes.titlesize": LETTERS,
    "axes.titley": 1.0,  # to look for a free place takes a quarter of the time
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "legend.fontsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.formatter.useoffset": False,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "agg.path.chunksize": 10_000,
    "svg.hashsalt": "spintop",
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
}
"""Settings of matplotlib. They hold while a figure is drawn or saved, not for other figures."""

SIZES = ("figure.figsize", *(key for key in SETTINGS if key.endswith("size")))
"""Those that have to do with the size of letters: figures are drawn with these, then scaled."""


def the_look(options: Options = DEFAULT) -> AbstractContextManager[None]:
    """A context in which matplotlib has these settings, and LaTeX only if it is there.

    A style sheet changes them, but for the sizes of letters and of the figure: a figure is drawn
    with letters of the usual size, and then scaled (`letters`).
    """
    has_latex = bool(shutil.which("latex") and shutil.which("dvipng"))
    sheet = options.sheet()
    if is_dark(sheet):  # the colours are turned over afterwards
        sheet = {key: value for key, value in sheet.items() if not key.endswith("color")}
    kept = {key: value for key, value in sheet.items() if key not in SIZES}
    usetex = kept.get("text.usetex", mpl.rcParams["text.usetex"]) and has_latex
    page = {"figure.figsize": (width_of_page(options) / letters(options), WIDTH)}
    return mpl.rc_context({**SETTINGS, **kept, **page, "text.usetex": usetex})


def width_of_page(options: Options) -> float:
    """The width that a figure is to have, in inches."""
    if options.width is not None:
        return options.inches()
    return float(options.sheet().get("figure.figsize", (WIDTH,))[0])


def letters(options: Options) -> float:
    """The size of letters over the usual one: they grow with the page, and shrink a little."""
    size = options.font_size or options.sheet().get("font.size")
    if size:
        return float(size) / LETTERS
    return max(LEAST_LETTERS / LETTERS, width_of_page(options) / WIDTH)


def drawn_width() -> float:
    """The width in inches on which figures are drawn with the usual letters, in this context.

    Outside of the look, where a figure is drawn without options, it is that of a page.
    """
    has_look = mpl.rcParams["svg.hashsalt"] == SETTINGS["svg.hashsalt"]
    return float(mpl.rcParams["figure.figsize"][0]) if has_look else WIDTH


def by_width(wide: Any, narrow: Any) -> Any:
    """The first on a figure as wide as a page, the second on one as narrow as a column."""
    return wide if drawn_width() > NARROW else narrow
