"""What all figures share: look, title, footer with the provenance, saving."""

import os
import re
import textwrap
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MultipleLocator
from PIL import Image

from figures.table import Table

WIDTH = 7.2
"""Width of a figure in inches: a page's text column, so that nothing is scaled down."""

LINES = (
    {"color": "#12355b", "linestyle": "-"},
    {"color": "#d1641b", "linestyle": "--"},
    {"color": "#5aa9a3", "linestyle": "-."},
    {"color": "#8a6fae", "linestyle": ":"},
)
"""Lines that differ in colour, in lightness and in dashes."""

FAINT = "0.8"
GREY = "0.35"

FAULT = "#b0392a"
"""What failed or is wrong."""

WIDE_RANGE, USUAL = 3e4, 0.2
"""A quantity goes on a log axis if its largest size is more than so many times the size that it
exceeds in all but this part of the rows. The paper's residuals stay on linear ones, as printed."""

PALETTE = 128
"""Colours of a small picture."""

MANY_POINTS = 20_000
"""Longer lines are stored as pixels in an SVG."""

RIGHT_ANGLES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720)

mpl.rcParams.update(
    {
        "font.size": 10,
        "axes.labelsize": 10,
        "axes.titlesize": 10,
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
        "savefig.dpi": 150,
        "svg.hashsalt": "spintop",
    }
)
warnings.filterwarnings("ignore", message="Glyph .* missing")


def new_figure(
    tables: Table | Sequence[Table], what: str, height: float, width: float = WIDTH
) -> Figure:
    """A figure with its title above, and below it where its table, or its tables, come from."""
    tables = [tables] if isinstance(tables, Table) else list(tables)
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, hspace=0.03)
    title = textwrap.fill(what, int(width * 10.3))
    figure.suptitle(title, x=0.012, ha="left", fontsize=11, fontweight="bold", parse_math=False)
    figure.supxlabel(
        footer(tables, int(width * 15)),
        x=0.012,
        ha="left",
        fontsize=9,
        color=GREY,
        parse_math=False,
    )
    return figure


def add_panels(figure: Figure, count: int, sharey: bool = True) -> list[Axes]:
    """Two panels in a row over the same x; the first of an odd number has its row to itself."""
    cells = figure.add_gridspec((count + 1) // 2, 2)
    panels: list[Axes] = []
    for place in range(count % 2, count + count % 2):
        first = panels[0] if panels else None
        spot = cells[0, :] if count % 2 and not panels else cells[divmod(place, 2)]
        panels.append(figure.add_subplot(spot, sharex=first, sharey=first if sharey else None))
    return panels


def footer(tables: Sequence[Table], width: int) -> str:
    """Titles, runs, program and revision, and how a run ended if not well; each once."""
    lines = []
    for words in (title_of, run_of, program_of):
        text = "; ".join(dict.fromkeys(words(table) for table in tables))
        lines += textwrap.wrap(text, width)
    return "\n".join(lines)


def title_of(table: Table) -> str:
    """The title of a table."""
    return table.title


def run_of(table: Table) -> str:
    """How a table was computed, and how that ended if not well."""
    run = describe_run(table)
    if table.status not in (None, "ok"):
        status = re.sub(r"\d+\.\d{6,}", lambda time: f"{float(time[0]):.6g}", table.status)
        run += f"; ended with status {status} s"
    if table.stride > 1:
        run += f"; one case in {table.stride} is drawn"
    return run[0].upper() + run[1:]


def program_of(table: Table) -> str:
    """The program that made a table, and its revision."""
    return f"{table.header['program']}, revision {table.header.get('revision', 'unknown')}"


def describe_run(table: Table) -> str:
    """Formulation, method, and steps or tolerances, in words."""
    method = table.setting("integration.method")
    if "setting" in table.rows:
        return "methods, formulations and settings as named"
    if "method" in table.rows:
        return ", ".join(["methods and formulations as named", *describe_tolerances(table)])
    if method == "exact":
        return "exact solution"
    formulation = table.setting("integration.formulation")
    if "auto" in (method, formulation):
        formulation = table.header.get("model", "").split(":")[0]
        method = table.header.get("method", "").split(":")[0]
        if method == "exact":
            return "exact solution"
    words = [f"formulation {formulation}", f"method {method}"]
    if butcher := table.setting("integration.table"):
        words.append(f"table {butcher}")
    if steps := table.setting("integration.steps"):
        words.append(f"{steps} steps")
    elif step := table.setting("integration.step"):
        words.append(f"steps of {step} s")
    else:
        words += describe_tolerances(table)
    return ", ".join(words)


def describe_tolerances(table: Table) -> list[str]:
    """The tolerances that the input gives."""
    given = [
        f"{kind} tolerance {value}"
        for kind in ("relative", "absolute")
        if (value := table.setting(f"integration.{kind}_tolerance"))
    ]
    return given or ["default tolerances"]


def with_unit(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} ({unit})" if unit else name


def draw_line(axes: Axes, x: np.ndarray, y: np.ndarray, line: int = 0, **options: object) -> None:
    """Draw a curve; what is not finite is left out."""
    finite = np.where(np.isfinite(y), y, np.nan)
    axes.plot(x, finite, **LINES[line], rasterized=len(y) > MANY_POINTS, **options)


def has_wide_range(y: np.ndarray) -> bool:
    """Whether a linear axis would show nothing but the largest values."""
    sizes = np.abs(y[np.isfinite(y) & (y != 0)])
    return sizes.size > 0 and sizes.max() / WIDE_RANGE > np.quantile(sizes, USUAL)


def draw_sizes(axes: Axes, x: np.ndarray, y: np.ndarray) -> None:
    """Draw absolute values on a log axis, without those that are zero."""
    x, sizes = x[y != 0], np.abs(y[y != 0])
    sizes[~np.isfinite(sizes)] = np.nan
    axes.set_yscale("log")
    draw_line(axes, x, sizes)
    axes.set_ylim(max(np.nanmin(sizes) / 3, 1e-307), min(np.nanmax(sizes) * 3, 1e308))
    axes.yaxis.set_major_locator(LogLocator(numticks=7))


def set_degree_ticks(axes: Axes, degrees: np.ndarray) -> None:
    """Ticks at round parts or multiples of a turn, six at most."""
    span = np.ptp(degrees[np.isfinite(degrees)])
    step = next((step for step in RIGHT_ANGLES if span <= 5 * step), None)
    if step is not None and span > 2 * RIGHT_ANGLES[0]:
        axes.yaxis.set_major_locator(MultipleLocator(step))


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG or SVG file, which is replaced when the new one is complete."""
    part = path.with_name(path.name + ".part")
    kind = path.suffix[1:]
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once is enough
    try:
        figure.savefig(part, format=kind, metadata={"Date": None} if kind == "svg" else None)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def save_as(figure: Figure, stem: Path, endings: Sequence[str] = ("png", "svg")) -> list[Path]:
    """Write a figure to files that differ in their endings, which come after the stem."""
    targets = [stem.with_name(f"{stem.name}.{ending}") for ending in endings]
    for target in targets:
        save(figure, target)
    return targets


def reduce_colours(png: Path | BinaryIO) -> Image.Image:
    """A PNG picture with few colours, a third as large when it is saved."""
    with Image.open(png) as picture:
        return picture.convert("RGB").quantize(PALETTE, dither=Image.Dither.NONE)


def save_small(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG file of few colours."""
    save(figure, path)
    reduce_colours(path).save(path, optimize=True)
