"""Which columns hold words, from the registry of the program."""

import functools
import json
from pathlib import Path

COPY = Path(__file__).with_name("columns.json")
"""What `spintop list columns --json` gave."""

OF_PEERS = frozenset({"program"})
"""Columns of words that scripts/compare_peers adds to those of the program."""


@functools.cache
def words_of(study: str) -> frozenset[str]:
    """The columns of words in the tables of a kind of study; all others hold numbers."""
    registry = json.loads(COPY.read_text(encoding="utf-8"))
    own = {
        column["name"]
        for column in registry["columns"]
        if column["study"] == study and column["words"]
    }
    return OF_PEERS.union(own, registry["other_words"])
