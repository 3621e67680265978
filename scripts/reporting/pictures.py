"""The pictures of a report: those that scripts/plot drew, else drawn here by the same functions."""

import base64
import io
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from figures.registry import FigureKind, choose_figures
from figures.style import save
from figures.table import Table

SMALL = 150_000
"""Bytes up to which a picture is taken as SVG, which can be enlarged and stays sharp."""

MEDIA = {".svg": "image/svg+xml", ".png": "image/png"}
DRAWN = tuple(MEDIA)
"""What scripts/plot makes."""

FEW_COLOURS = "few colours"
COLOURS = 64
"""A PNG with so few colours looks the same and takes a third."""

MEDIA[FEW_COLOURS] = MEDIA[".png"]


EXTENT_OF_PNG = slice(16, 24)


@dataclass
class Picture:
    """A picture of a table, in the forms there are of it; `form` is the one that is shown."""

    name: str
    what: str
    forms: dict[str, bytes]
    form: str | None

    @property
    def size(self) -> int:
        """Bytes that it takes in the page, as base64."""
        return -(-len(self.forms[self.form]) // 3) * 4 if self.form else 0

    @property
    def extent(self) -> tuple[int, int]:
        """Width and height in pixels, by which the page keeps its place free."""
        return struct.unpack(">II", self.forms[".png"][EXTENT_OF_PNG])

    @property
    def address(self) -> str:
        """The picture itself, as a data URI; empty if it is left out."""
        if not self.form:
            return ""
        return f"data:{MEDIA[self.form]};base64,{base64.b64encode(self.forms[self.form]).decode()}"


def pictures_of(table: Table) -> list[Picture]:
    """The pictures that belong to a table."""
    kinds, _ = choose_figures(table)
    with tempfile.TemporaryDirectory() as scratch:
        return [find_picture(table, kind, Path(scratch)) for kind in kinds]


def find_picture(table: Table, kind: FigureKind, scratch: Path) -> Picture:
    """A picture as it lies beside its table, if it is not older, else drawn anew."""
    name = f"{table.path.stem}_{kind.name}"
    paths = [table.path.with_name(name + ending) for ending in DRAWN]
    made = table.path.stat().st_mtime
    if not all(path.is_file() and path.stat().st_mtime >= made for path in paths):
        figure = kind.draw(table)
        paths = [scratch / path.name for path in paths]
        for path in paths:
            save(figure, path)
    forms = {path.suffix: path.read_bytes() for path in paths}
    forms[FEW_COLOURS] = reduce_colours(forms[".png"])
    form = ".svg" if len(forms[".svg"]) <= SMALL else FEW_COLOURS
    return Picture(name, kind.what, forms, form)


def reduce_colours(png: bytes) -> bytes:
    """A PNG with fewer colours."""
    reduced = io.BytesIO()
    with Image.open(io.BytesIO(png)) as image:
        image.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE).save(
            reduced, "PNG", optimize=True
        )
    return reduced.getvalue()


def fit(pictures: list[Picture], room: int) -> None:
    """Have all pictures fit in so many bytes: the largest become smaller, then are left out."""
    by_size = sorted(pictures, key=lambda picture: -picture.size)
    for picture in by_size:
        if sum(p.size for p in pictures) <= room:
            return
        picture.form = min(picture.forms, key=lambda form: len(picture.forms[form]))
    for picture in sorted(pictures, key=lambda picture: -picture.size):
        if sum(p.size for p in pictures) <= room:
            return
        picture.form = None
