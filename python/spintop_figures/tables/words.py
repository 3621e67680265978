"""What the registry of the program says of columns: which hold words, and what all mean."""

import functools
import json
from pathlib import Path

COPY = Path(__file__).with_name("columns.json")
"""What `spintop list columns --json` gave."""

OF_PEERS = frozenset({"program"})
"""Columns of words that scripts/compare_peers adds to those of the program."""


@functools.cache
def registry() -> dict:
    """The registry of columns."""
    return json.loads(COPY.read_text(encoding="utf-8"))


def columns_of(study: str) -> dict[str, dict]:
    """The columns of a kind of study by name: unit, description, and whether they hold words."""
    return {column["name"]: column for column in registry()["columns"] if column["study"] == study}


@functools.cache
def words_of(study: str) -> frozenset[str]:
    """The columns of words in the tables of a kind of study; all others hold numbers."""
    own = {name for name, column in columns_of(study).items() if column["words"]}
    return OF_PEERS.union(own, registry()["other_words"])
