"""The page of a figure: its title above, its caption below, and its panels."""

import math
import textwrap
from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure

from spintop_figures.style.axes import letters_of, name_axis, wrapped
from spintop_figures.style.look import (
    CENTIMETRE,
    DEFAULT,
    GREY,
    LETTERS,
    SMALLEST,
    Options,
    by_width,
    drawn_width,
    scale,
    the_look,
)
from spintop_figures.style.provenance import caption_of, provenance_of
from spintop_figures.tables.characters import TableError
from spintop_figures.tables.table import Table

TITLE_LETTERS, CAPTION_LETTERS = 10.3, 15
"""Letters in an inch of titles and captions."""

TIME = "time t", "s"

LABELS = {"x": "labelbottom", "y": "labelleft"}
"""The settings of the numbers at the ticks of an axis."""


class Page(Figure):
    """A figure with the provenance of what it shows, which is always drawn in its own look."""

    provenance: dict[str, str]
    options: Options = DEFAULT

    def draw(self, renderer: RendererBase) -> None:
        """Draw it, whoever asks for it."""
        with the_look(self.options):
            super().draw(renderer)


def new_figure(
    tables: Table | Sequence[Table], what: str, height: float, width: float | None = None
) -> Page:
    """A figure with its title above, and the title of its table, or of its tables, below.

    Height and width are in inches of the usual letters; without a width it is that of the page. A
    figure that wants another width has smaller letters where it is to be narrower.
    """
    tables = [tables] if isinstance(tables, Table) else list(tables)
    asked = drawn_width() * scale()
    if width and width > drawn_width() and not math.isclose(asked, DEFAULT.inches()):
        size = LETTERS * asked / width
        if size < SMALLEST:
            least = math.ceil(width * SMALLEST / LETTERS / CENTIMETRE)
            raise TableError(f"needs a width of {least} cm")
        mpl.rcParams["font.size"] = size  # within the look, which sets it back
    width = width or drawn_width()
    figure = Page(figsize=(width * scale(), height * scale()), layout="constrained")
    figure.provenance = provenance_of(tables)
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, hspace=0.03)
    style = {"x": 0.012, "ha": "left", "parse_math": False}
    title = textwrap.fill(what, int(width * TITLE_LETTERS))
    figure.suptitle(title, fontsize=11 * scale(), fontweight="bold", **style)
    if caption := caption_of(tables, int(width * CAPTION_LETTERS)):
        figure.supxlabel(caption, fontsize=max(9 * scale(), SMALLEST), color=GREY, **style)
    return figure


def finish(figure: Page, options: Options) -> Page:
    """Give a figure that is drawn the title that a user asks for."""
    figure.options = options
    if options.title is not None:
        width = figure.get_size_inches()[0] / scale()
        figure.suptitle(textwrap.fill(options.title, int(width * TITLE_LETTERS)))
        if not options.title:
            figure.supxlabel("")
    return figure


def panel_figure(
    tables: Table | Sequence[Table],
    title: str,
    count: int,
    height: float,
    least: float = 0.0,
    above: float = 1.2,
    share: str = "xy",
    has_foot: bool = False,
    across: int | None = None,
) -> tuple[Page, list[Axes]]:
    """A figure of panels that share axes, all of one size, two in a row on a page.

    Heights, in inches: of a row, of all rows at least, and of what is above and below them. A foot
    is a last row of the grid for a legend.
    """
    across = min(count, across or by_width(2, 1))
    down = -(-count // across)
    figure = new_figure(tables, title, above + max(height * down, least))
    ratios = [1.0] * down + [0.01] * has_foot
    grid = figure.add_gridspec(len(ratios), across, height_ratios=ratios)
    panels: list[Axes] = []
    for place in range(count):
        shared = {f"share{axis}": panels[0] for axis in share} if panels else {}
        panels.append(figure.add_subplot(grid[divmod(place, across)], **shared))
    return figure, panels


def time_panels(
    table: Table, title: str, count: int, height: float, across: int | None = None, **grid: object
) -> tuple[Page, list[Axes]]:
    """A figure of panels over the same time, which the lowest ones name."""
    across = across or by_width(2, 1)
    figure = new_figure(table, title, height)
    panels = figure.subplots(-(-count // across), across, sharex=True, squeeze=False, **grid)
    for axes in panels[-1]:
        name_axis(axes.xaxis, *TIME)
    for axes in panels.flat:
        axes.margins(x=0.01)
    figure.align_ylabels()
    return figure, list(panels.flat)


def no_axis(axes: Axes) -> Axes:
    """Room for a legend or for words."""
    axes.set_axis_off()
    return axes


def is_lowest(axes: Axes) -> bool:
    """Whether no panel is below another one of its grid, of which the last row may not be full."""
    spot = axes.get_subplotspec()
    spots = filter(None, (other.get_subplotspec() for other in axes.figure.axes))
    same = [other for other in spots if other.get_gridspec() is spot.get_gridspec()]
    below = [other for other in same if other.rowspan.start >= spot.rowspan.stop]
    return not any(other.colspan == spot.colspan for other in below)


def is_left(axes: Axes) -> bool:
    """Whether a panel is at the left of its grid."""
    return axes.get_subplotspec().is_first_col()


def name_outer(panels: Sequence[Axes], x: Sequence[str] = (), y: Sequence[str] = ()) -> None:
    """Name the axes of panels, by words and a unit, at the left and at the lowest panels only."""
    for axes in panels:
        for name, axis, is_named in ((x, axes.xaxis, is_lowest), (y, axes.yaxis, is_left)):
            if name:
                axis.set_tick_params(**{LABELS[axis.axis_name]: is_named(axes)})
            if name and is_named(axes):
                name_axis(axis, *name)


def legend_below(panels: Sequence[Axes], handles: Sequence[Artist], columns: int) -> None:
    """A legend in the foot of the grid of panels."""
    below = no_axis(panels[0].figure.add_subplot(panels[0].get_gridspec()[-1, :]))
    below.legend(handles=handles, loc="upper center", ncols=columns, handlelength=3)


def head(
    axes: Axes,
    words: str,
    axis: Axis | None = None,
    unit: str = "",
    after: str = "",
    pad: float = 4,
) -> None:
    """The heading of a panel, in lines no longer than it is wide; it may name one of its axes."""
    axes.set_title(wrapped(words + after, letters_of(axes, "x")), loc="left", pad=pad)
    if axis:
        name_axis(axis, words, unit, after, axes._left_title)


def legend_above(axes: Axes, columns: int, **style: object) -> None:
    """A legend above the right end of a panel, with so many columns on a page."""
    place = {"loc": "lower right", "bbox_to_anchor": (1.01, 1.0), "ncols": by_width(columns, 2)}
    axes.legend(**place | {"columnspacing": 1.2, "borderpad": 0.2} | style)
