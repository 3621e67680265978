"""What spreadsheets and editors do to a table so that it cannot be read, in words."""

import codecs
from collections.abc import Sequence

from spintop_figures.tables.characters import printable

ENCODINGS = {
    b"\xff\xfe\0\0": "UTF-32",
    b"\0\0\xfe\xff": "UTF-32",
    b"\xff\xfe": "UTF-16",
    b"\xfe\xff": "UTF-16",
}
"""Encodings by the bytes that such a file begins with; longer ones come first."""
SEPARATORS = {";": "semicolons", printable("\t"): "tabs"}
NO_BREAK = tuple(map(printable, "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{FIGURE SPACE}"))
"""As lines have them that are read: what is not printable is written out."""


class TableError(Exception):
    """What is wrong with a table, in one line."""


def plain(data: bytes) -> bytes:
    """The bytes of a table without a mark of UTF-8, and with line feeds alone."""
    for mark, name in ENCODINGS.items():
        if data.startswith(mark):
            raise TableError(f"is a text in {name}: save it in UTF-8")
    data = data.removeprefix(codecs.BOM_UTF8)
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def changed_header(lines: Sequence[str]) -> str:
    """What was done to the lines of a header; empty if nothing of this kind was."""
    if lines[:1] == [""]:
        return "its first line is empty"
    if any(line.startswith('"#') for line in lines):
        return "its header is in quotes, as spreadsheets write it: save the table unchanged"
    if any(space in line for line in lines if line.startswith("#") for space in NO_BREAK):
        return "its header has no-break spaces"
    return ""


def wrong_separator(line: str) -> str:
    """Why the names of the columns cannot be told apart; empty if they can."""
    for mark, name in SEPARATORS.items():
        if mark in line:
            return f"its cells are separated by {name}, not by commas"
    return ""


def spaces_in(text: str) -> str:
    """Which spaces of a name or a number are too many; empty if none is."""
    if any(space in text for space in NO_BREAK):
        return "a no-break space"
    return "a space" if text != text.strip() else ""
