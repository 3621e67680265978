"""Error against cost of the engines: a line for the best method of each, its name at its end."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullLocator

from engines import ENGINES

PANELS = {"free_asymmetric": "A free box that tumbles", "heavy_top": "A fast heavy top"}
STYLES = {
    "equations": {"color": "black", "marker": "o", "linestyle": "-"},
    "robots": {"color": "#0072b2", "marker": "s", "linestyle": "-"},
    "games": {"color": "#d55e00", "marker": "^", "linestyle": "--"},
}
"""Of each kind of engine: colours of Okabe and Ito, of different grey, and with their own marks."""
WIDTH, HEIGHT = 132 / 25.4, 7.6
"""Inches."""
LEAST, MOST = 1e-15, 4.0
"""Errors that are drawn, rad."""
GAP = 0.042
"""Between two names, as a part of the height of a panel."""


def best_line(rows: pd.DataFrame) -> pd.DataFrame:
    """The method with the least error: its points than which none is both cheaper and better."""
    rows = rows[np.isfinite(rows["attitude"]) & np.isfinite(rows["cost"])]
    if not len(rows):
        return rows
    rows = rows[rows["method"] == rows.loc[rows["attitude"].idxmin(), "method"]]
    rows = rows.sort_values(["cost", "attitude"])
    best = rows["attitude"].cummin().shift(fill_value=np.inf)
    return rows[rows["attitude"] < best]


def spread(heights: list[float]) -> list[float]:
    """Places of names near these heights (parts of the panel), which keep apart, from below."""
    order = np.argsort(heights, kind="stable")
    placed = np.array(heights, dtype=float)
    last = 0.0
    for i in order:
        placed[i] = last = max(placed[i], last + GAP)
    last = 1.0 + GAP / 2
    for i in order[::-1]:
        placed[i] = last = min(placed[i], last - GAP)
    return placed.tolist()


def draw_panel(axes: Axes, table: pd.DataFrame) -> None:
    """The lines of a motion, with names on the right."""
    axes.set(xscale="log", yscale="log", ylim=(LEAST, MOST))
    ends = []
    for engine in ENGINES:
        line = best_line(table[table["engine"] == engine.name])
        if not len(line):
            continue
        errors = np.clip(line["attitude"], LEAST * 1.3, MOST)
        axes.plot(line["cost"], errors, linewidth=0.9, markersize=2.8, **STYLES[engine.kind])
        ends.append((line["cost"].iloc[-1], errors.iloc[-1], engine))
    span = np.log(MOST / LEAST)
    places = spread([np.log(error / LEAST) / span for _, error, _ in ends])
    for (cost, error, engine), place in zip(ends, places, strict=True):
        colour = STYLES[engine.kind]["color"]
        axes.annotate(
            engine.name, (cost, error), (1.06, place), textcoords="axes fraction", fontsize=6.5,
            color=colour, va="center", annotation_clip=False,
            arrowprops={"arrowstyle": "-", "linewidth": 0.35, "color": colour, "alpha": 0.6,
                        "relpos": (0, 0.5), "shrinkA": 0},
        )  # fmt: skip
    axes.yaxis.set_major_locator(LogLocator(numticks=9))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(color="0.92", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_ylabel("largest error of the attitude (rad)")


def draw(table: pd.DataFrame, path: Path) -> None:
    """Draw the panels to a file."""
    look = {"font.size": 8, "svg.fonttype": "none", "svg.hashsalt": "spintop"}
    with plt.rc_context(look):
        figure, panels = plt.subplots(2, 1, figsize=(WIDTH, HEIGHT), sharex=True)
        for axes, (motion, title) in zip(panels, PANELS.items(), strict=True):
            draw_panel(axes, table[table["motion"] == motion])
            axes.set_title(title, loc="left", fontsize=8.5)
        panels[-1].set_xlabel("processor time per second of motion (s)")
        figure.subplots_adjust(left=0.12, right=0.78, top=0.965, bottom=0.06, hspace=0.12)
        figure.savefig(path, dpi=200, metadata={"Date": None} if path.suffix == ".svg" else None)
        plt.close(figure)
