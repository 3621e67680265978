"""The pictures of a report: those that scripts/plot drew, else drawn here by the same functions."""

import base64
import io
import struct
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from markupsafe import Markup
from PIL import Image

from reporting.drawing import Drawing, Glyphs, NotDrawnError
from reporting.paper import caption_of, runs_of
from spintop_figures.files import draw_to
from spintop_figures.registry import FigureKind, choose_figures
from spintop_figures.style.saving import reduce_colours
from spintop_figures.tables.table import Table, TableError

SMALL = 100_000
"""Bytes up to which a picture is an element of the page, which can be enlarged and stays sharp."""

DRAWN = (".svg", ".png")
"""What scripts/plot makes."""

INLINE, FEW_COLOURS, COARSE, THUMBNAIL = "inline", "few colours", "coarse", "thumbnail"
"""Forms in the page: an SVG element; a PNG that looks as the one of scripts/plot and takes a third;
the same at half the resolution; and a small WebP for the contents."""

THUMBNAIL_WIDTH, THUMBNAIL_QUALITY = 240, 30
"""Pixels of a thumbnail, which is shown at half that width, and its quality as a WebP."""

EXTENT_OF_PNG = slice(16, 24)
"""The bytes of a PNG that hold its width and height."""


@dataclass
class Picture:
    """A picture of a table, in the forms there are of it; `form` is the one that is shown."""

    name: str
    what: str
    forms: dict[str, bytes]
    form: str = FEW_COLOURS

    @property
    def size(self) -> int:
        """Bytes that it takes in the page."""
        return self.size_as(self.form)

    def size_as(self, form: str) -> int:
        """Bytes that a form of it takes in the page, a PNG as base64."""
        length = len(self.forms[form])
        return length if form == INLINE else -(-length // 3) * 4

    @property
    def extent(self) -> tuple[int, int]:
        """Width and height in pixels, by which the page keeps its place free."""
        return struct.unpack(">II", self.forms[".png"][EXTENT_OF_PNG])

    @property
    def address(self) -> str:
        """The picture itself, as a data URI."""
        return f"data:image/png;base64,{base64.b64encode(self.forms[self.form]).decode()}"

    @property
    def thumbnail(self) -> str:
        """The small one, as a data URI."""
        return f"data:image/webp;base64,{base64.b64encode(self.forms[THUMBNAIL]).decode()}"

    @property
    def element(self) -> Markup:
        """The picture as an element of the page; empty if it is shown as a PNG."""
        return Markup(self.forms[INLINE].decode() if self.form == INLINE else "")

    def take_in(self, glyphs: Glyphs, label: str) -> None:
        """Make it an element of the page, if that is small enough."""
        try:
            element = Drawing(self.forms[".svg"], glyphs, label).element().encode()
        except NotDrawnError:
            return
        self.forms[INLINE] = element
        if self.size_as(INLINE) <= max(SMALL, self.size_as(FEW_COLOURS)):
            self.form = INLINE


def pictures_of(table: Table, problems: list[str] | None = None) -> list[Picture]:
    """The pictures that belong to a table; why others cannot be drawn joins the problems."""
    kinds, refusals = choose_figures(table)
    runs = runs_of(table)
    pictures = []
    if problems is not None:
        problems += refusals
    with tempfile.TemporaryDirectory() as scratch:
        for kind in kinds:
            try:
                picture = find_picture(table, kind, Path(scratch))
                pictures.append(replace(picture, what=caption_of(kind, runs)))
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
    return Picture(name, kind.what, forms)


def forms_of(paths: Sequence[Path]) -> dict[str, bytes]:
    """The forms of a picture that lies in these files; none if the files are damaged."""
    try:
        forms = {path.suffix: path.read_bytes() for path in paths}
        png = forms[".png"]
        return forms | {FEW_COLOURS: with_few_colours(png), THUMBNAIL: thumbnail_of(png)}
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return {}


def thumbnail_of(png: bytes) -> bytes:
    """A WebP as wide as a thumbnail."""
    small = io.BytesIO()
    with Image.open(io.BytesIO(png)) as full:
        height = round(THUMBNAIL_WIDTH * full.height / full.width)
        shrunk = full.convert("RGB").resize((THUMBNAIL_WIDTH, height), Image.Resampling.LANCZOS)
    shrunk.save(small, "WEBP", quality=THUMBNAIL_QUALITY)
    return small.getvalue()


def with_few_colours(png: bytes, part: int = 1) -> bytes:
    """A PNG of few colours, with so small a part of the pixels in a row."""
    reduced = io.BytesIO()
    picture = reduce_colours(io.BytesIO(png))
    if part > 1:
        with Image.open(io.BytesIO(png)) as full:
            smaller = io.BytesIO()
            full.convert("RGB").reduce(part).save(smaller, "PNG")
        picture = reduce_colours(smaller)
    picture.save(reduced, "PNG", optimize=True)
    return reduced.getvalue()


def fit(pictures: list[Picture], room: int) -> list[Picture]:
    """Have all pictures fit in so many bytes, if that can be; those that became coarse.

    The largest take their smallest form, then half their resolution. None is left out.
    """
    coarse: list[Picture] = []
    for picture in sorted(pictures, key=lambda picture: -picture.size):
        if sum(p.size for p in pictures) <= room:
            return coarse
        forms = [form for form in (INLINE, FEW_COLOURS) if form in picture.forms]
        picture.form = min(forms, key=picture.size_as)
    for picture in sorted(pictures, key=lambda picture: -picture.size):
        if sum(p.size for p in pictures) <= room:
            return coarse
        picture.forms[COARSE] = with_few_colours(picture.forms[".png"], 2)
        if picture.size_as(COARSE) < picture.size:
            picture.form = COARSE
            coarse.append(picture)
    return coarse
