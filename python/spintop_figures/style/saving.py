"""Figures as files: PNG, SVG, PDF and others, with the provenance in their metadata."""

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.layout_engine import PlaceHolderLayoutEngine
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from spintop_figures.style.log_axes import draw_minor_ticks, simplify_log_axes
from spintop_figures.style.look import WIDTH, the_look
from spintop_figures.style.options import DEFAULT, Options
from spintop_figures.style.page import Page

Metadata = dict[str, str | None]

DOTS_PER_INCH = 150

COMPRESSION = 3
"""Of PNG files: within a tenth as small as with the usual 6, in little more than half the time."""

PALETTE = 128
"""Colours of a small picture."""
AREAS = 16
"""How many of its most frequent colours do not change."""


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a file, which is replaced when the new one is complete.

    Its ending says of which kind it is: one of FORMATS, else there is a ValueError. Processes may
    draw the same figure at once: each has a part of its own.
    """
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    kind = path.suffix[1:].lower()
    if kind not in FORMATS:
        raise ValueError(f"a figure ends in {', '.join(sorted(FORMATS))}, not in {kind!r}")
    with the_look(options_of(figure)), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        lay_out(figure)
        try:
            WRITERS.get(kind, write_other)(figure, part, kind)
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)


def lay_out(figure: Figure) -> None:
    """Lay a figure out, once for all files, at the resolution of the first."""
    engine = figure.get_layout_engine()
    if engine is None or isinstance(engine, PlaceHolderLayoutEngine):
        return
    figure.set_dpi(dots_of(figure))
    FigureCanvasAgg(figure)
    for axes in figure.axes:
        axes.apply_aspect()
        for spine in axes.spines.values():
            spine.set_in_layout(False)  # it would measure all ticks once more
    minor_ticks = simplify_log_axes(figure)
    engine.execute(figure)
    figure.set_layout_engine("none")
    for ticks in minor_ticks:
        draw_minor_ticks(ticks)
    if isinstance(figure, Page):
        figure.finish()


def options_of(figure: Figure) -> Options:
    """What was asked of a figure."""
    return figure.options if isinstance(figure, Page) else DEFAULT


def dots_of(figure: Figure) -> float:
    """Dots per inch: a narrow figure has as many across as one of a page."""
    return DOTS_PER_INCH * max(1.0, round(WIDTH / figure.get_size_inches()[0], 2))


def write_png(figure: Figure, path: Path, kind: str) -> None:
    """Write a PNG file. Figure.savefig draws everything twice."""
    dots = dots_of(figure)
    figure.set_dpi(dots)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = PngInfo()
    for key, text in metadata_of(figure, kind).items():
        texts.add_itxt(key, text)
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    picture.save(path, "png", pnginfo=texts, dpi=(dots, dots), compress_level=COMPRESSION)


def write_svg(figure: Figure, path: Path, kind: str) -> None:
    """Write an SVG file."""
    figure.set_dpi(DOTS_PER_INCH)
    FigureCanvasSVG(figure).print_svg(str(path), metadata=metadata_of(figure, kind))


def write_other(figure: Figure, path: Path, kind: str) -> None:
    """Write a file of any other kind that matplotlib knows."""
    figure.set_dpi(dots_of(figure))
    figure.savefig(path, format=kind, dpi="figure", metadata=metadata_of(figure, kind))


WRITERS = {"png": write_png, "svg": write_svg}
"""What writes a kind of file, faster than matplotlib does by itself."""

FORMATS = frozenset(FigureCanvasBase.get_supported_filetypes()) - {"raw", "rgba", "pgf"}
"""The kinds of files that a figure can be written to."""

PDF_KEYS = {"Title": "Title", "Description": "Subject", "Software": "Creator", "Source": "Keywords"}


def metadata_of(figure: Figure, kind: str) -> Metadata | None:
    """The provenance of a figure under the names that a kind of file has for it."""
    known = dict(figure.provenance) if isinstance(figure, Page) else {}
    if kind == "svg":
        program = known.pop("Software", None)
        return {**known, "Creator": program, "Date": None}
    if kind == "pdf":
        return {PDF_KEYS[key]: text for key, text in known.items()} | {"CreationDate": None}
    if kind in ("eps", "ps"):
        return {"Creator": known.get("Software", "spintop")}
    return known if kind == "png" else None


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


def reduce_colours(png: Path | BinaryIO) -> Image.Image:
    """A PNG picture with few colours, a third as large when it is saved.

    The palette covers the colours of small marks, too, which a median cut would mix with others. It
    would tint large areas: the most frequent colours get their places in it unchanged.
    """
    with Image.open(png) as file:
        picture = file.convert("RGB")
    small = picture.quantize(PALETTE, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    palette, pixels, places = small.getpalette(), np.asarray(picture), np.asarray(small)
    counted = sorted(picture.getcolors(picture.width * picture.height), reverse=True)
    for _, colour in reversed(counted[:AREAS]):
        place = int(places[(pixels == colour).all(axis=2)][0])
        palette[3 * place : 3 * place + 3] = colour
    small.putpalette(palette)
    return small


def save_small(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG file of few colours, with its metadata."""
    save(figure, path)
    with Image.open(path) as picture:
        texts = PngInfo()
        for key, text in picture.text.items():
            texts.add_itxt(key, text)
    reduce_colours(path).save(path, optimize=True, pnginfo=texts)
