"""Whether motions ended well: the flag `good` of the statuses of the program."""

import functools
import re

import pandas as pd

from spintop_figures.tables.words import listed


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
