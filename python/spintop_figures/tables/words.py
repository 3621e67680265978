"""What the registry of the program says of columns: their units, meanings, which hold words."""

import functools
import json
import re
from pathlib import Path

import pandas as pd


@functools.cache
def listed(topic: str) -> dict[str, list]:
    """What `spintop list TOPIC --json` gives, from its copy.

    scripts/manual_tables renews the copies, and a test compares them.
    """
    return json.loads(Path(__file__).with_name(f"{topic}.json").read_text(encoding="utf-8"))


def columns_of(study: str) -> dict[str, dict]:
    """The columns of a kind of study by name: unit, description, and whether they hold words."""
    return {
        column["name"]: column
        for column in listed("columns")["columns"]
        if column["study"] == study
    }


@functools.cache
def units_of_columns() -> dict[str, str]:
    """The units of the columns of all kinds of study by name; empty where there is none."""
    return {column["name"]: column["unit"] or "" for column in listed("columns")["columns"]}


@functools.cache
def column_units() -> dict[tuple[str, str], dict]:
    """Other units of columns, by the unit of a column and the suffix of its name."""
    return {(unit["of"], unit["suffix"]): unit for unit in listed("columns")["column_units"]}


@functools.cache
def words_of(study: str) -> frozenset[str]:
    """The columns of words in the tables of a kind of study; all others hold numbers."""
    own = {name for name, column in columns_of(study).items() if column["words"]}
    return frozenset({"program", *own, *listed("columns")["other_words"]})  # by scripts/compare


@functools.cache
def good_ends() -> frozenset[str]:
    """The statuses of motions that were computed to their end."""
    return frozenset(status["name"] for status in listed("statuses")["statuses"] if status["good"])


def is_good_end(status: object) -> bool:
    """Whether a status is that of a good end; more words may follow, as in `at_rest at t = 3`."""
    return re.split(r"[ :]", str(status), maxsplit=1)[0] in good_ends()


def ended_well(rows: pd.DataFrame) -> pd.Series:
    """Which rows have a status of a good end."""
    return rows["status"].isin(good_ends())


def count_failures(rows: pd.DataFrame) -> dict[str, int]:
    """How many rows there are with each other status, the most frequent first."""
    return rows["status"][~ended_well(rows)].value_counts().to_dict()
