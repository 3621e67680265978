"""The pictures of a report: those that scripts/plot drew, else drawn here by the same functions."""

import base64
import io
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from spintop_figures.files import draw_to
from spintop_figures.registry import FigureKind, choose_figures
from spintop_figures.style.look import Options
from spintop_figures.tables.table import Table, TableError
from spintop_figures.tables.words import LANGUAGE

TYPES = {".svg": "svg+xml", ".png": "png"}
"""What scripts/plot makes; the smaller file stands in the page as it is."""

OF_PAPER = re.compile(r" \((?:Figures?|Table) [^)]*\)$")
"""What a description of a figure says of the paper, which holds for its own runs only."""

THUMBNAIL_WIDTH, THUMBNAIL_QUALITY = 240, 30
"""Pixels of a thumbnail, which is shown at half that width, and its quality as a WebP."""


def data_uri(kind: str, data: bytes) -> str:
    """A picture as an address that holds it."""
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


@dataclass
class Picture:
    """A picture of a table as addresses, and its width and height in pixels."""

    name: str
    what: str
    address: str
    thumbnail: str
    extent: tuple[int, int]


def pictures_of(table: Table, problems: list[str] | None = None) -> list[Picture]:
    """The pictures that belong to a table; why others cannot be drawn joins the problems."""
    problems = [] if problems is None else problems
    kinds, refusals = choose_figures(table)
    problems += refusals
    pictures = []
    for kind in kinds:
        try:
            pictures.append(find_picture(table, kind))
        except TableError as error:
            problems.append(str(error))
    return pictures


def find_picture(table: Table, kind: FigureKind) -> Picture:
    """A picture as it lies beside its table, if it is whole and not older, else drawn anew."""
    name = f"{table.path.stem}_{kind.name}"
    paths = [table.path.with_name(name + ending) for ending in TYPES]
    made = table.path.stat().st_mtime
    language = LANGUAGE.get()
    if language == "en" and all(path.is_file() and path.stat().st_mtime >= made for path in paths):
        try:
            return picture_of(name, kind, paths)
        except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
            pass  # damaged
    with tempfile.TemporaryDirectory() as scratch:
        drawn = draw_to(kind, table, Path(scratch) / name, Options(language=language))
        return picture_of(name, kind, drawn)


def picture_of(name: str, kind: FigureKind, paths: list[Path]) -> Picture:
    """A picture from its files."""
    files = {path.suffix: path.read_bytes() for path in paths}
    ending = min(files, key=lambda ending: len(files[ending]))
    small = io.BytesIO()
    with Image.open(io.BytesIO(files[".png"])) as full:
        extent = full.size
        shrunk = full.convert("RGB")
    shrunk.thumbnail((THUMBNAIL_WIDTH, extent[1]))
    shrunk.save(small, "WEBP", quality=THUMBNAIL_QUALITY)
    address = data_uri(TYPES[ending], files[ending])
    what = OF_PAPER.sub("", kind.what)
    return Picture(name, what, address, data_uri("webp", small.getvalue()), extent)
