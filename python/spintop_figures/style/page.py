"""The page of a figure: its title above, its caption below, and its panels."""

import textwrap
from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.look import GREY, WIDTH
from spintop_figures.style.provenance import caption_of, provenance_of
from spintop_figures.tables.table import Table

LETTERS = 14
"""Letters of the heading of a panel in an inch."""


class Page(Figure):
    """A figure that knows the provenance of what it shows."""

    provenance: dict[str, str]
    waiting: list[Callable[[], None]]
    """What is done after the layout."""

    def align_ylabels(self, axs: Sequence[Axes] | None = None) -> None:
        """Align the labels after the layout, which has room for all, and is faster without."""
        self.waiting.append(lambda: Figure.align_ylabels(self, axs))

    def finish(self) -> None:
        """Do what was left for after the layout."""
        while self.waiting:
            self.waiting.pop()()


def new_figure(
    tables: Table | Sequence[Table], what: str, height: float, width: float = WIDTH
) -> Page:
    """A figure with its title above, and the title of its table, or of its tables, below."""
    tables = [tables] if isinstance(tables, Table) else list(tables)
    figure = Page(figsize=(width, height), layout="constrained")
    figure.provenance, figure.waiting = provenance_of(tables), []
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, hspace=0.03)
    title = textwrap.fill(what, int(width * 10.3))
    figure.suptitle(title, x=0.012, ha="left", fontsize=11, fontweight="bold", parse_math=False)
    if caption := caption_of(tables, int(width * 15)):
        style = {"fontsize": 9, "color": GREY, "parse_math": False}
        figure.supxlabel(caption, x=0.012, ha="left", **style)
    return figure


def add_panels(figure: Figure, count: int, sharey: bool = True) -> list[Axes]:
    """Two panels in a row over the same x, all of one size."""
    across = min(count, 2)
    cells = figure.add_gridspec(-(-count // across), across)
    panels: list[Axes] = []
    for place in range(count):
        first = panels[0] if panels else None
        spot = cells[divmod(place, across)]
        panels.append(figure.add_subplot(spot, sharex=first, sharey=first if sharey else None))
    return panels


def is_lowest(axes: Axes) -> bool:
    """Whether no panel is below another one of its grid."""
    spot = axes.get_subplotspec()
    others = [other.get_subplotspec() for other in axes.figure.axes if other.get_subplotspec()]
    return not any(
        other.get_gridspec() is spot.get_gridspec()
        and other.rowspan.start >= spot.rowspan.stop
        and other.colspan.start <= spot.colspan.start < other.colspan.stop
        for other in others
    )


def head(axes: Axes, words: str) -> None:
    """The heading of a panel, in lines no longer than the panel is wide."""
    lines = textwrap.fill(words, int(LETTERS * width_of(axes)))
    axes.set_title(lines, loc="left", fontsize=9.5, pad=4)


def width_of(axes: Axes) -> float:
    """About how wide a panel is, in inches, before it is laid out."""
    spot = axes.get_subplotspec()
    return 0.85 * axes.figure.get_size_inches()[0] * len(spot.colspan) / spot.get_gridspec().ncols
