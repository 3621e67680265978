"""The languages of figures, films and reports, from the dictionary that the live page has, too.

What is written is English. Its longest parts that the dictionary has are said in the language that
is asked for, if it is another; an entry with places for values is for the live page alone.
"""

import functools
import json
import re
from contextvars import ContextVar
from pathlib import Path

LANGUAGES = ("en", "de", "fr")
LANGUAGE = ContextVar("LANGUAGE", default="en")
"""The language that is spoken, as the look says."""

DICTIONARY = Path(__file__).with_name("dictionary.json")


@functools.cache
def dictionary() -> dict[str, dict[str, str]]:
    """The words of each key in all languages."""
    return json.loads(DICTIONARY.read_text(encoding="utf-8"))


@functools.cache
def phrases(language: str) -> tuple[re.Pattern, dict[str, str]]:
    """What finds the English phrases in a text, and what they are, with capitals or without."""
    known = {}
    for entry in (each for each in dictionary().values() if "{" not in each["en"]):
        one, other = (entry[each].strip().replace("\u00ad", "") for each in ("en", language))
        for change in (str, lambda text: text[:1].upper() + text[1:]):
            known[change(one)] = change(other)
    longest = sorted(known, key=len, reverse=True)
    parts = "|".join(re.escape(each).replace(r"\ ", r"\s+") for each in longest)
    return re.compile(rf"(?<!\w)(?:{parts})(?!\w)"), known


def say(text: str) -> str:
    """A text in the language that is spoken."""
    if LANGUAGE.get() == "en":
        return text
    pattern, known = phrases(LANGUAGE.get())
    return pattern.sub(lambda found: known[" ".join(found[0].split())], text)
