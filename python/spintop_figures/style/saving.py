"""Figures as files: PNG, SVG, PDF and others, with the provenance in their metadata."""

import os
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.layout_engine import PlaceHolderLayoutEngine
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from spintop_figures.style.look import DEFAULT, WIDTH, the_look

DOTS_PER_INCH = 150

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
    options = getattr(figure, "options", DEFAULT)
    with the_look(options), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        lay_out(figure)
        try:
            if kind == "png":  # Figure.savefig draws everything twice
                # within a tenth as small as with 6, in little more than half the time
                settings = {"pil_kwargs": {"compress_level": 3}}
                FigureCanvasAgg(figure).print_png(str(part), metadata=metadata, **settings)
            elif kind == "svg":
                figure.set_dpi(DOTS_PER_INCH)
                FigureCanvasSVG(figure).print_svg(str(part), metadata=metadata)
            else:
                figure.savefig(part, format=kind, dpi="figure", metadata=metadata or None)
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)


def lay_out(figure: Figure) -> None:
    """Lay a figure out, once for all files. A narrow one has as many dots across as a page."""
    width = figure.get_size_inches()[0]
    figure.set_dpi(DOTS_PER_INCH * max(1.0, round(WIDTH / width, 2)))
    engine = figure.get_layout_engine()
    if engine is None or isinstance(engine, PlaceHolderLayoutEngine):
        return
    FigureCanvasAgg(figure)
    for axes in figure.axes:
        axes.apply_aspect()
        for spine in axes.spines.values():
            spine.set_in_layout(False)  # it would measure all ticks once more
    with the_look(getattr(figure, "options", DEFAULT)):
        engine.execute(figure)
    figure.set_layout_engine("none")


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
    """Write a figure to a PNG file of few colours, with its metadata: a third as large.

    The palette covers the colours of small marks, too, which a median cut would mix with others. It
    would tint large areas: the most frequent colours get their places in it unchanged.
    """
    save(figure, path)
    with Image.open(path) as file:
        texts, picture = PngInfo(), file.convert("RGB")
        for key, text in file.text.items():
            texts.add_itxt(key, text)
    small = picture.quantize(128, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    palette, pixels, places = small.getpalette(), np.asarray(picture), np.asarray(small)
    counted = sorted(picture.getcolors(picture.width * picture.height), reverse=True)
    for _, colour in reversed(counted[:16]):  # the most frequent colours
        place = int(places[(pixels == colour).all(axis=2)][0])
        palette[3 * place : 3 * place + 3] = colour
    small.putpalette(palette)
    small.save(path, optimize=True, pnginfo=texts)
