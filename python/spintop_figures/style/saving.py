"""Figures as files: PNG and SVG, with the provenance in their metadata."""

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.layout_engine import PlaceHolderLayoutEngine
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from spintop_figures.style.log_axes import draw_minor_ticks, simplify_log_axes
from spintop_figures.style.look import the_look
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
    """Write a figure to a PNG or SVG file, which is replaced when the new one is complete.

    Processes may draw the same figure at once: each has a part of its own.
    """
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    kind = path.suffix[1:]
    with the_look(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        lay_out(figure)
        try:
            WRITERS[kind](figure, part, metadata_of(figure, kind))
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)


def lay_out(figure: Figure) -> None:
    """Lay a figure out, once for all files, at the resolution of the first."""
    engine = figure.get_layout_engine()
    if engine is None or isinstance(engine, PlaceHolderLayoutEngine):
        return
    figure.set_dpi(DOTS_PER_INCH)
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


def write_png(figure: Figure, path: Path, metadata: Metadata) -> None:
    """Write a PNG file. Figure.savefig draws everything twice."""
    figure.set_dpi(DOTS_PER_INCH)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    texts = PngInfo()
    for key, text in metadata.items():
        texts.add_itxt(key, text)
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    dpi = (DOTS_PER_INCH, DOTS_PER_INCH)
    picture.save(path, "png", pnginfo=texts, dpi=dpi, compress_level=COMPRESSION)


def write_svg(figure: Figure, path: Path, metadata: Metadata) -> None:
    """Write an SVG file."""
    figure.set_dpi(DOTS_PER_INCH)
    FigureCanvasSVG(figure).print_svg(str(path), metadata=metadata)


WRITERS = {"png": write_png, "svg": write_svg}
"""What writes a kind of file."""


def metadata_of(figure: Figure, kind: str) -> Metadata:
    """The provenance of a figure under the names that a kind of file has for it."""
    known = dict(figure.provenance) if isinstance(figure, Page) else {}
    if kind == "svg":
        program = known.pop("Software", None)
        return {**known, "Creator": program, "Date": None}
    return known


def save_as(
    figure: Figure, stem: str | Path, endings: Sequence[str] = ("png", "svg")
) -> list[Path]:
    """Write a figure to files that differ in their endings, which come after the stem."""
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
