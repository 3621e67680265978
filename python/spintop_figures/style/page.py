"""The page of a figure: its title above, its caption below, its panels; and its files.

Files are PNG, SVG, PDF and others, with the provenance in their metadata: title, run and program of
the tables, in words.
"""

import math
import os
import textwrap
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import FigureCanvasBase, RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.layout_engine import PlaceHolderLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from spintop_figures.style import look
from spintop_figures.style.axes import letters_of, name_axis, wrapped
from spintop_figures.style.numbers import write, write_count
from spintop_figures.tables.names import is_good_end, name_of, number_in
from spintop_figures.tables.table import Table, TableError, printable
from spintop_figures.tables.words import say

TITLE_LETTERS = 10.3
"""Letters in an inch of titles."""

PANEL_WIDTH, NARROW, LEAST_PANEL = 3.55, 1.8, (1.0, 0.42)
"""Of each of many panels, in inches, and of as many as can stand abreast where there is no height;
width and height of the smallest that shows anything."""

FOOT, BESIDE = 0.01, 26
"""Height of a foot, or its width, over those of a panel; letters of a title beside a panel."""

EDGE = 0.05
"""Inches by which the edge of a letter may be beyond that of its page."""

TIME = "time t", "s"
AT = {"color": look.GREY, "linewidth": 1.0, "linestyle": "--", "zorder": 1.5}
"""Lines at values of choice."""


class Page(Figure):
    """A figure with the provenance of what it shows, which is always drawn in its own look."""

    provenance: dict[str, str]
    options: look.Options = look.DEFAULT

    def draw(self, renderer: RendererBase) -> None:
        """Draw it, whoever asks for it."""
        with look.the_look(self.options):
            super().draw(renderer)


def new_figure(
    tables: Table | Sequence[Table], what: str, height: float, width: float | None = None
) -> Page:
    """A figure with its title above, and the title of its table, or of its tables, below.

    Height and width are in inches of the usual letters; without a width it is that of the page. A
    figure that wants another width has smaller letters where it is to be narrower.
    """
    tables = [tables] if isinstance(tables, Table) else list(tables)
    asked = look.drawn_size()[0] * look.scale()
    if width and width > look.drawn_size()[0] and not math.isclose(asked, look.DEFAULT.inches()):
        size = look.LETTERS * asked / width
        if size < look.SMALLEST:
            least = math.ceil(width * look.SMALLEST / look.LETTERS / look.CENTIMETRE)
            raise TableError(f"needs a width of {least} cm")
        mpl.rcParams["font.size"] = size  # within the look, which sets it back
    width, height = width or look.drawn_size()[0], min(height, look.drawn_size()[1])
    figure = Page(figsize=(width * look.scale(), height * look.scale()), layout="constrained")
    figure.provenance = provenance_of(tables)
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06, hspace=0.03)
    style = {"x": 0.012, "ha": "left", "parse_math": False}
    title = textwrap.fill(say(what), int(width * TITLE_LETTERS))
    figure.suptitle(title, fontsize=11 * look.scale(), fontweight="bold", **style)
    if caption := caption_of(tables, int(15 * width)):
        figure.supxlabel(
            caption, fontsize=max(9 * look.scale(), look.SMALLEST), color=look.GREY, **style
        )
    return figure


def finish(figure: Page, options: look.Options, tables: Sequence[Table]) -> Page:
    """Give a figure that is drawn the title, the lines and the language that a user asks for.

    A title takes the place of both, that of the figure and that of its table below it.
    """
    figure.options = options
    for which, values in options.line.items():
        draw_lines_at(figure, which, values)
    if options.language != "en":
        translate(figure)
    if options.title is not None:
        width = figure.get_size_inches()[0] / look.scale()
        figure._suptitle.set_text(textwrap.fill(options.title, int(width * TITLE_LETTERS)))
        if below := figure._supxlabel:
            below.set_text(say(joined(map(warning_of, tables))) if options.title else "")
    return figure


def panels_of(figure: Figure) -> list[Axes]:
    """The panels of a figure, without what stands beside them."""
    return [axes for axes in figure.axes if axes.axison and axes.get_subplotspec()]


def draw_lines_at(figure: Figure, which: str, values: object) -> None:
    """Lines at values of x or of y, which all panels have to have in common."""
    panels = panels_of(figure)
    shared = getattr(panels[0], f"get_shared_{which}_axes")().get_siblings(panels[0])
    unit = getattr(getattr(panels[0], f"{which}axis").get_major_formatter(), "unit", None)
    if unit is None or set(panels) - set(shared):
        raise TableError(f"has no {which} axis with numbers that all panels share, for a line")
    for value in str(values).split(","):
        try:
            place = number_in(value, unit)
        except ValueError as wrong:
            raise TableError(f"has no line at {which} = {value}: {wrong}") from None
        for axes in panels:
            getattr(axes, f"ax{'v' if which == 'x' else 'h'}line")(place, **AT)


def translate(figure: Page) -> None:
    """Say legends, ticks and notes in the language that is spoken; titles of tables stay."""
    titles = [*filter(None, figure.provenance["Title"].split("; "))]
    for text in set(figure.findobj(Text)) - {figure._suptitle, figure._supxlabel}:
        words = text.get_text()
        if not any(title in " ".join(words.split()) for title in titles):
            text.set_text(say(words))
    for axis in figure.findobj(Axis):
        for labels in getattr(getattr(axis.get_major_formatter(), "func", None), "args", ()):
            if isinstance(labels, dict):  # of ticks that have words
                labels |= {place: say(label) for place, label in labels.items()}


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
    ratios: Sequence[float] = (),
) -> tuple[Page, list[Axes]]:
    """A figure of panels that share axes, all of one size, two in a row on a page, more if wider.

    Heights, in inches: of a row, of all rows at least, and of what is above and below them, and the
    ratios of rows where they differ. A foot is a last row of the grid for a legend; where there is
    no height it stands beside a single column.
    """
    wide, high = look.drawn_size()
    most = across or max(look.by_width(2, 1), int(wide / PANEL_WIDTH))
    while above + height * -(-count // most) > high and wide >= NARROW * (most + 1):
        most += 1
    down = -(-count // most)
    across = min(count, most) if across else -(-count // down)
    figure = new_figure(tables, title, above + max(height * down, least))
    beside = has_foot and across == 1 and look.is_slide()
    ratios = [*(ratios or [1.0] * down), *[FOOT] * (has_foot and not beside)]
    widths = [*[1.0] * across, *[FOOT] * beside]
    shape = {"width_ratios": widths, "height_ratios": ratios}
    grid = figure.add_gridspec(len(ratios), len(widths), **shape)
    panels: list[Axes] = []
    for place in range(count):
        shared = {f"share{axis}": panels[0] for axis in share} if panels else {}
        panels.append(figure.add_subplot(grid[divmod(place, across)], **shared))
    return figure, panels


def time_panels(
    table: Table, title: str, count: int, height: float, **grid: object
) -> tuple[Page, list[Axes]]:
    """A figure of panels over the same time, which the lowest ones name."""
    figure, panels = panel_figure(table, title, count, 0, height, 0, "x", **grid)
    name_outer(panels, TIME)
    for axes in panels:
        axes.margins(x=0.01)
    figure.align_ylabels()
    return figure, panels


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
                side = "labelbottom" if axis is axes.xaxis else "labelleft"
                axis.set_tick_params(**{side: is_named(axes)})
            if name and is_named(axes):
                name_axis(axis, *name)


def legend_below(
    panels: Sequence[Axes],
    handles: Sequence[Artist] | Mapping[str, dict],
    columns: int,
    title: str = "",
) -> None:
    """A legend in the foot of the grid of panels: of lines, or of the looks of lines by name.

    It has so many columns at most.
    """
    if isinstance(handles, Mapping):
        handles = [Line2D([], [], **style, label=name) for name, style in handles.items()]
    figure, grid = panels[0].figure, panels[0].get_gridspec()
    is_beside = grid.get_width_ratios()[-1] == FOOT
    below = no_axis(figure.add_subplot(grid[:, -1] if is_beside else grid[-1, :]))
    letters = BESIDE if is_beside else int(1.2 * letters_of(below, "x"))
    style = {"handles": handles, "handlelength": 3, "title": wrapped(title, letters)}
    style |= {"title_fontsize": "small", "loc": "center left" if is_beside else "upper center"}
    for ncols in range(1 if is_beside else columns, 0, -1):
        legend = below.legend(**style, ncols=ncols)
        if legend.get_window_extent().width <= 1.05 * figure.bbox.width:  # with an unseen frame
            break


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
    place = {"loc": "lower right", "bbox_to_anchor": (1.01, 1.0), "borderpad": 0.2}
    place |= {"columnspacing": 1.2, "ncols": look.by_width(columns, 2)}
    axes.legend(**place | style)


FORMATS = frozenset(FigureCanvasBase.get_supported_filetypes()) - {"raw", "rgba", "pgf"}
"""The kinds of files that a figure can be written to."""

KEYS = {
    "png": {name: name for name in ("Title", "Description", "Software", "Source")},
    "svg": {"Title": "Title", "Description": "Description", "Creator": "Software"}
    | {"Source": "Source", "Date": ""},
    "pdf": {"Title": "Title", "Subject": "Description", "Creator": "Software"}
    | {"Keywords": "Source", "CreationDate": ""},
    "eps": {"Creator": "Software"},
    "ps": {"Creator": "Software"},
}
"""The provenance under the names that a kind of file has for it; without a date."""


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a file, which is replaced when the new one is complete.

    Its ending says of which kind it is: one of FORMATS, else there is a ValueError. Processes may
    draw the same figure at once: each has a part of its own.
    """
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    kind = path.suffix[1:].lower()
    if kind not in FORMATS:
        raise ValueError(f"a figure ends in {', '.join(sorted(FORMATS))}, not in {kind!r}")
    known = getattr(figure, "provenance", {})
    metadata = {key: known.get(name) for key, name in KEYS.get(kind, {}).items()}
    options = getattr(figure, "options", look.DEFAULT)
    with look.the_look(options), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        lay_out(figure)
        try:
            if kind == "png":  # Figure.savefig draws everything twice
                # within a tenth as small as with 6, in little more than half the time
                settings = {"pil_kwargs": {"compress_level": 3}}
                FigureCanvasAgg(figure).print_png(str(part), metadata=metadata, **settings)
            elif kind == "svg":
                figure.set_dpi(150)
                FigureCanvasSVG(figure).print_svg(str(part), metadata=metadata)
            else:
                figure.savefig(part, format=kind, dpi="figure", metadata=metadata or None)
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)


def lay_out(figure: Figure) -> None:
    """Lay a figure out, once for all files. A narrow one has as many dots across as a page."""
    width = figure.get_size_inches()[0]
    figure.set_dpi(150 * max(1.0, round(look.WIDTH / width, 2)))
    engine = figure.get_layout_engine()
    if engine is None or isinstance(engine, PlaceHolderLayoutEngine):
        return
    FigureCanvasAgg(figure)
    for axes in figure.axes:
        axes.apply_aspect()
        for spine in axes.spines.values():
            spine.set_in_layout(False)  # it would measure all ticks once more
    with look.the_look(getattr(figure, "options", look.DEFAULT)):
        engine.execute(figure)
    figure.set_layout_engine("none")


def is_crowded(figure: Page) -> bool:
    """Whether a page has too little room for a panel, or for what stands beside the panels."""
    page = figure.get_size_inches()
    with look.the_look(figure.options), warnings.catch_warnings():
        warnings.filterwarnings("error", "constrained_layout not applied")
        try:
            lay_out(figure)
        except UserWarning:
            return True
        shown, least = figure.get_tightbbox(), np.array(LEAST_PANEL) * look.scale()
    sizes = np.reshape([page * axes.get_position().size for axes in panels_of(figure)], (-1, 2))
    return bool(min(shown.min) < -EDGE or (shown.max > page + EDGE).any() or (sizes < least).any())


def save_as(
    figure: Figure, stem: str | Path, endings: Sequence[str] = ("png", "svg")
) -> list[Path]:
    """Write a figure to files that differ in their endings, which come after the stem.

    An ending is one of FORMATS: png, svg, pdf, eps and others; else there is a ValueError.
    """
    stem = Path(stem)
    targets = [stem.with_name(f"{stem.name}.{ending}") for ending in endings]
    for target in targets:
        save(figure, target)
    return targets


def save_small(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG file of 256 colours, with its metadata: less than half as large.

    They cover the colours of small marks, too, which a median cut would mix with others.
    """
    save(figure, path)
    with Image.open(path) as file:
        texts, picture = PngInfo(), file.convert("RGB")
        for key, text in file.text.items():
            texts.add_itxt(key, text)
    small = picture.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    small.save(path, optimize=True, pnginfo=texts)


def provenance_of(tables: Sequence[Table]) -> dict[str, str]:
    """The title, the run, the program and the files of tables, each once, for metadata.

    A run is how a table was computed, and how that ended if not well.
    """
    runs = (joined((describe_run(table), warning_of(table))) for table in tables)
    return {
        "Title": joined(table.title for table in tables),
        "Description": joined(run[0].upper() + run[1:] for run in runs),
        "Software": joined(
            f"{table.header['program']}, revision {table.header.get('revision', 'unknown')}"
            for table in tables
        ),
        "Source": joined(printable(table.path.name) for table in tables),
    }


def joined(texts: object) -> str:
    """Texts that are not empty, each once."""
    return "; ".join(dict.fromkeys(filter(None, texts)))


def caption_of(tables: Sequence[Table], letters: int) -> str:
    """The line below a figure: the title of its table, and what a reader has to know of the rows.

    It has so many letters at most. The title of a single table may be shortened for it.
    """
    known = say(joined(warning_of(table) for table in tables))
    titles = {table.title for table in tables}
    title = titles.pop() if len(titles) == 1 else ""  # panels of several have their titles
    room = letters - (len(known) + 2 if known else 0)
    if len(title) > room:
        title = title[: max(room - 1, 0)].rstrip() + "\N{HORIZONTAL ELLIPSIS}"
    return "; ".join(filter(None, (title, known)))


def warning_of(table: Table) -> str:
    """How a run ended if not well, and whether only some cases are drawn; empty if all is well."""
    words = []
    if table.status is not None and not is_good_end(table.status):
        words.append(f"ended early: {describe_end(table.status)}")
    if table.stride > 1:
        words.append(f"one case in {write_count(table.stride)} is drawn")
    return "; ".join(words)


def describe_end(status: str) -> str:
    """How a motion ended, in words: `pole at t = 1.25` is at a pole at t = 1.25 s."""
    word, at, time = status.partition(" at t = ")
    try:
        return f"{name_of(word)}{at}{write(float(time), 6)} s" if at else name_of(word)
    except ValueError:
        return status


def describe_run(table: Table) -> str:
    """Formulation, method, and steps or tolerances, in words."""
    if "setting" in table.rows:
        return "methods, formulations and settings as named"
    if "method" in table.rows:
        return ", ".join(["methods and formulations as named", *describe_tolerances(table)])
    formulation, method = model_of(table)
    if method == "exact":
        return "exact solution"
    words = [name_of(formulation), name_of(table.setting("integration.table") or method)]
    if steps := table.setting("integration.steps"):
        words.append(f"{write_count(float(steps))} steps")
    elif step := table.setting("integration.step"):
        words.append(f"steps of {step} s")
    else:
        words += describe_tolerances(table)
    return ", ".join(words)


def model_of(table: Table) -> tuple[str, str]:
    """The formulation and the method of a run: those of the input, or what `auto` became."""
    given = table.setting("integration.formulation"), table.setting("integration.method")
    if given[1] == "exact" or "auto" not in given:
        return given
    return table.model_and_method


def describe_tolerances(table: Table) -> list[str]:
    """The tolerances that the input gives."""
    given = [
        f"{kind} tolerance {write(float(value))}"
        for kind in ("relative", "absolute")
        if (value := table.setting(f"integration.{kind}_tolerance"))
    ]
    return given or ["default tolerances"]
