"""The pictures of a report: those that scripts/plot drew, else drawn here by the same functions."""

import base64
import io
import struct
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from figures.drawing import draw_to
from figures.registry import FigureKind, choose_figures
from figures.style import reduce_colours
from figures.table import Table, TableError

SMALL = 150_000
"""Bytes up to which a picture is taken as SVG, which can be enlarged and stays sharp."""

MEDIA = {".svg": "image/svg+xml", ".png": "image/png"}
DRAWN = tuple(MEDIA)
"""What scripts/plot makes."""

FEW_COLOURS = "few colours"
"""The form of a PNG that looks the same and takes a third."""

MEDIA[FEW_COLOURS] = MEDIA[".png"]

EXTENT_OF_PNG = slice(16, 24)
"""The bytes of a PNG that hold its width and height."""


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


def pictures_of(table: Table, problems: list[str] | None = None) -> list[Picture]:
    """The pictures that belong to a table; why others cannot be drawn joins the problems."""
    kinds, _ = choose_figures(table)
    pictures = []
    with tempfile.TemporaryDirectory() as scratch:
        for kind in kinds:
            try:
                pictures.append(find_picture(table, kind, Path(scratch)))
            except TableError as error:
                if problems is not None:
                    problems.append(str(error))
    return pictures


def find_picture(table: Table, kind: FigureKind, scratch: Path) -> Picture:
    """A picture as it lies beside its table, if it is not older, else drawn anew."""
    name = f"{table.path.stem}_{kind.name}"
    paths = [table.path.with_name(name + ending) for ending in DRAWN]
    made = table.path.stat().st_mtime
    forms: dict[str, bytes] = {}
    if all(path.is_file() and path.stat().st_mtime >= made for path in paths):
        forms = forms_of(paths)
    if not forms:
        forms = forms_of(draw_to(kind, table, scratch / name))
    form = ".svg" if len(forms[".svg"]) <= SMALL else FEW_COLOURS
    return Picture(name, kind.what, forms, form)


def forms_of(paths: Sequence[Path]) -> dict[str, bytes]:
    """The forms of a picture that lies in these files; none if the files are damaged."""
    try:
        forms = {path.suffix: path.read_bytes() for path in paths}
        return forms | {FEW_COLOURS: with_few_colours(forms[".png"])}
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return {}


def with_few_colours(png: bytes) -> bytes:
    """A PNG of few colours."""
    reduced = io.BytesIO()
    reduce_colours(io.BytesIO(png)).save(reduced, "PNG", optimize=True)
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
