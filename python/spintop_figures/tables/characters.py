"""Text of files and names of files as a terminal may show it, and what is wrong with a table."""


class TableError(Exception):
    """What is wrong with a table, in one line."""


def printable(text: object) -> str:
    """The text with whatever a terminal would obey or not know written as an escape sequence.

    Control characters, those that change the direction of writing, and bytes of a file name that
    are none of the locale's encoding become `\\x1b`, `\\u202e` and the like.
    """
    text = str(text)
    return text if text.isprintable() else "".join(map(escape, text))


def escape(character: str) -> str:
    """A character as Python would write it in a text, if it cannot be shown."""
    if character.isprintable():
        return character
    if 0xDC80 <= ord(character) <= 0xDCFF:  # a byte of a file name
        return f"\\x{ord(character) - 0xDC00:02x}"
    return character.encode("unicode_escape").decode()
