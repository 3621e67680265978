"""Text of files and names of files as a terminal may show it."""


def printable(text: object) -> str:
    """The text with whatever a terminal would obey or not know written as an escape sequence.

    Control characters, those that change the direction of writing, and bytes of a file name that
    are none of the locale's encoding become `\\x1b`, `\\u202e` and the like.
    """
    return "".join(
        character if character.isprintable() else escape(character) for character in str(text)
    )


def escape(character: str) -> str:
    """A character as Python would write it in a text."""
    if 0xDC80 <= ord(character) <= 0xDCFF:  # a byte of a file name
        return f"\\x{ord(character) - 0xDC00:02x}"
    return character.encode("unicode_escape").decode()
