"""The page of a figure: its title above, its caption below, and its panels; and its final size."""

import math
import textwrap
from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spintop_figures.style.axes import WithComma, write_axes
from spintop_figures.style.cells import Cells
from spintop_figures.style.colours import DARK, for_dark, is_dark, recolour, replaced
from spintop_figures.style.log_axes import axes_of
from spintop_figures.style.look import GREY, LINES, by_width, drawn_width, letters, width_of_page
from spintop_figures.style.numbers import with_comma
from spintop_figures.style.options import CENTIMETRE, DEFAULT, LETTERS, SMALLEST, Options
from spintop_figures.style.provenance import caption_of, provenance_of
from spintop_figures.tables.causes import TableError
from spintop_figures.tables.table import Table

TITLE_LETTERS, CAPTION_LETTERS, HEAD_LETTERS = 10.3, 15, 14
"""Letters in an inch of titles, captions and headings of panels."""

TICK_LETTERS = 9
"""Size of the letters at ticks, in points."""


class Page(Figure):
    """A figure that knows the provenance of what it shows, and how it was asked for."""

    provenance: dict[str, str]
    options: Options = DEFAULT
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
    tables: Table | Sequence[Table], what: str, height: float, width: float | None = None
) -> Page:
    """A figure with its title above, and the title of its table, or of its tables, below.

    Height and width are in inches of the usual letters; without a width it is that of the page.
    """
    tables = [tables] if isinstance(tables, Table) else list(tables)
    width = width or drawn_width()
    figure = Page(figsize=(width, height), layout="constrained")
    figure.provenance, figure.waiting = provenance_of(tables), []
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, hspace=0.03)
    title = wrap_title(what, width)
    figure.suptitle(title, x=0.012, ha="left", fontsize=11, fontweight="bold", parse_math=False)
    if caption := caption_of(tables, int(width * CAPTION_LETTERS)):
        style = {"fontsize": 9, "color": GREY, "parse_math": False}
        figure.supxlabel(caption, x=0.012, ha="left", **style)
    return figure


def wrap_title(title: str, width: float) -> str:
    """A title in lines that fit on a figure of this width, in inches of the usual letters."""
    return textwrap.fill(title, int(width * TITLE_LETTERS))


def wrap_labels(figure: Figure) -> None:
    """Break the words below panels that are wider than the figure."""
    letters = int(HEAD_LETTERS * by_width(0.8, 0.55) * figure.get_size_inches()[0])
    for axes in figure.axes:
        words = axes.get_xlabel()
        if "$" not in words and max(map(len, words.split("\n"))) > letters:
            axes.set_xlabel(textwrap.fill(words, letters))


def finish(figure: Figure, options: Options) -> Figure:
    """Give a figure that is drawn the numbers of its axes, and what a user asks of it."""
    write_axes(figure)
    wrap_labels(figure)
    if options.title is not None and (title := figure._suptitle):
        title.set_text(wrap_title(options.title, figure.get_size_inches()[0]))
        if not options.title:
            figure.supxlabel("")
    if (change := recolouring(options)) is not None:
        recolour(figure, change)
    scale(figure, options)
    if options.decimal_comma:
        write_commas(figure)
    if isinstance(figure, Page):
        figure.options = options
    return figure


def recolouring(options: Options) -> Callable[[object], object] | None:
    """What changes the colours: of lines to those of a style sheet, all for dark ground."""
    sheet = options.sheet()
    change = for_dark(DARK) if options.dark else None
    if is_dark(sheet):
        change = for_dark(sheet["figure.facecolor"])
    if cycle := sheet.get("axes.prop_cycle"):
        lines = [to_hex(line["color"]) for line in LINES]
        change = replaced(dict(zip(lines, cycle.by_key()["color"], strict=False)), change)
    return change


def scale(figure: Figure, options: Options) -> None:
    """Scale a figure that is drawn with the usual letters to its size, and its letters with it."""
    width, height = figure.get_size_inches()
    factor = letters(options)
    if options.width is not None:
        factor = min(factor, width_of_page(options) / width)
    if factor == 1:
        return
    if factor * LETTERS < SMALLEST:
        least = width * SMALLEST / LETTERS / CENTIMETRE
        raise TableError(f"needs a width of {math.ceil(least)} cm")
    figure.set_size_inches(width * factor, height * factor)
    for artist in figure.findobj(lambda artist: hasattr(artist, "set_fontsize")):
        artist.set_fontsize(scaled_size(artist.get_fontsize(), factor))
    for line in figure.findobj(Line2D):
        line.set(linewidth=line.get_linewidth() * factor, markersize=line.get_markersize() * factor)
    for _, _, axis in axes_of(figure):
        for which in ("major", "minor"):
            size = axis.get_tick_params(which).get("labelsize", TICK_LETTERS)
            axis.set_tick_params(which, labelsize=scaled_size(size, factor))


def scaled_size(size: float, factor: float) -> float:
    """A size of letters after scaling: it stays legible."""
    return max(size * factor, min(size, SMALLEST))


def write_commas(figure: Figure) -> None:
    """Write decimal commas in all texts, and thin spaces between thousands."""
    for _, _, axis in axes_of(figure):
        for which in ("major", "minor"):
            formatter = getattr(axis, f"get_{which}_formatter")()
            if not isinstance(formatter, WithComma):  # of a panel that shares the axis
                getattr(axis, f"set_{which}_formatter")(WithComma(formatter))
    for cells in figure.findobj(Cells):
        cells.rewrite(character=with_comma_alone)
    for artist in figure.findobj(lambda artist: hasattr(artist, "set_text")):
        artist.set_text(with_comma(artist.get_text()))


def with_comma_alone(character: str) -> str:
    """A character of a number with a decimal comma."""
    return "," if character == "." else character


def panel_rows(count: int) -> int:
    """In how many rows panels stand."""
    return -(-count // by_width(2, 1))


def add_panels(figure: Figure, count: int, sharey: bool = True) -> list[Axes]:
    """Panels over the same x, two in a row on a page, all of one size."""
    across = min(count, by_width(2, 1))
    cells = figure.add_gridspec(-(-count // across), across)
    panels: list[Axes] = []
    for place in range(count):
        first = panels[0] if panels else None
        spot = cells[divmod(place, across)]
        panels.append(figure.add_subplot(spot, sharex=first, sharey=first if sharey else None))
    return panels


def three_panels(figure: Figure) -> tuple[list[Axes], Axes]:
    """Three panels in a row, or one below the other on a narrow figure; and room for a legend."""
    rows, columns = by_width((1, 3), (3, 1))
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=(*[1] * rows, by_width(0.06, 0.2)))
    panels = [figure.add_subplot(grid[divmod(place, columns)]) for place in range(3)]
    key = figure.add_subplot(grid[rows, :])
    key.axis("off")
    return panels, key


def label_text(label: str, figure: Figure, down: int) -> str:
    """The label of an axis in lines that fit beside a panel, of which so many are below another."""
    letters = int(HEAD_LETTERS * 0.7 * figure.get_size_inches()[1] / down)
    return textwrap.fill(label, max(letters, 12))


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


def head(axes: Axes, words: str, pad: float = 4) -> None:
    """The heading of a panel, in lines no longer than it is wide, so many points above it."""
    lines = textwrap.fill(words, int(HEAD_LETTERS * width_of(axes)))
    axes.set_title(lines, loc="left", fontsize=9.5, pad=pad)


def width_of(axes: Axes) -> float:
    """About how wide a panel is, in inches, before it is laid out."""
    spot = axes.get_subplotspec()
    return 0.85 * axes.figure.get_size_inches()[0] * len(spot.colspan) / spot.get_gridspec().ncols
