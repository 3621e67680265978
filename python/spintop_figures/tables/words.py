"""What the registry of the program says of columns: their units, meanings, which hold words."""

import functools
import json
from pathlib import Path

COPIES = Path(__file__).parent
"""Where copies of registries are. scripts/manual_tables renews them, and a test compares them."""

OF_PEERS = frozenset({"program"})
"""Columns of words that scripts/compare_peers adds to those of the program."""


def listed(topic: str) -> dict[str, list]:
    """What `spintop list TOPIC --json` gives, from its copy."""
    return json.loads((COPIES / f"{topic}.json").read_text(encoding="utf-8"))


@functools.cache
def registry() -> dict:
    """The registry of columns."""
    return listed("columns")


def columns_of(study: str) -> dict[str, dict]:
    """The columns of a kind of study by name: unit, description, and whether they hold words."""
    return {column["name"]: column for column in registry()["columns"] if column["study"] == study}


@functools.cache
def units_of_columns() -> dict[str, str]:
    """The units of the columns of all kinds of study by name; empty where there is none."""
    return {column["name"]: column["unit"] or "" for column in registry()["columns"]}


@functools.cache
def column_units() -> dict[tuple[str, str], dict]:
    """Other units of columns, by the unit of a column and the suffix of its name."""
    return {(unit["of"], unit["suffix"]): unit for unit in registry()["column_units"]}


@functools.cache
def words_of(study: str) -> frozenset[str]:
    """The columns of words in the tables of a kind of study; all others hold numbers."""
    own = {name for name, column in columns_of(study).items() if column["words"]}
    return OF_PEERS.union(own, registry()["other_words"])
