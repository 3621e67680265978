"""What the table says, in Markdown: at each error the cheapest of spintop and of the others."""

import pandas as pd

from peers.program import as_table
from peers.result import OWN
from spintop_figures.tables.words import ended_well

ERRORS = tuple(float(f"1e-{digits}") for digits in range(3, 13))
NONE = "\N{EN DASH}"


def cheapest(rows: pd.DataFrame, error: float) -> pd.Series | None:
    """The fastest row whose attitude at the end is good enough."""
    good = rows[ended_well(rows) & (rows["orientation_error"] <= error)]
    return None if good.empty else good.loc[good["time_s"].idxmin()]


def as_time(seconds: float) -> str:
    """A time with three digits and a unit."""
    for unit, size in (("us", 1e-6), ("ms", 1e-3), ("s", 1.0)):
        if seconds < 999.5 * size or unit == "s":
            break
    return f"{seconds / size:#.3g}".rstrip(".") + f" {unit}"


def cell_of(row: pd.Series | None) -> str:
    """A time and the method that takes it."""
    return NONE if row is None else f"{as_time(row['time_s'])} {row['method']}/{row['formulation']}"


def ratio(other: pd.Series | None, own: pd.Series | None) -> str:
    """How many times the one takes as long as the other, to two digits."""
    if other is None or own is None:
        return NONE
    factor = float(f"{other['time_s'] / own['time_s']:.2g}")
    return f"{factor:g}" if factor < 10 else f"{factor:.0f}"


def summarise(rows: pd.DataFrame) -> str:
    """Of each problem: who is cheapest, by what factor each is dearer; and a table of all."""
    problems = dict(list(rows.groupby("problem", sort=False)))
    texts = [f"{name}\n\n{tell_problem(group)}" for name, group in problems.items()]
    if len(problems) > 1:
        texts.append(f"all problems\n\n{tell_together(problems)}")
    return "\n\n".join(texts)


def tell_together(problems: dict[str, pd.DataFrame]) -> str:
    """A column for each problem: spintop's time and the ratio of the cheapest other."""
    lines = [
        [f"{error:.0e}", *(as_time_and_ratio(rows, error) for rows in problems.values())]
        for error in ERRORS
    ]
    return as_table(["error, rad", *problems], lines)


def as_time_and_ratio(rows: pd.DataFrame, error: float) -> str:
    """The time of spintop's integration, and how many times as long the cheapest other is."""
    stepping, others = parts_of(rows)
    own = cheapest(stepping, error)
    if own is None:
        return NONE
    return f"{as_time(own['time_s'])}, {ratio(cheapest(others, error), own)}"


def parts_of(rows: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """spintop's rows but those of the closed form, and the rows of the other programs."""
    is_own = rows["program"] == OWN
    return rows[is_own & (rows["method"] != "exact")], rows[~is_own]


def tell_problem(rows: pd.DataFrame) -> str:
    """The tables of a problem."""
    exact = rows[rows["method"] == "exact"]
    stepping, others = parts_of(rows)
    best = [
        [
            f"{error:.0e}",
            cell_of(cheapest(exact, error)).split(" exact")[0],
            cell_of(cheapest(stepping, error)),
            cell_of(cheapest(others, error)),
            ratio(cheapest(others, error), cheapest(stepping, error)),
        ]
        for error in ERRORS
    ]
    header = ["error, rad", "spintop, closed form", "spintop, numerical", "cheapest other", "ratio"]
    factors = [
        [program, *(ratio(cheapest(group, error), cheapest(stepping, error)) for error in ERRORS)]
        for program, group in others.groupby("program", sort=False)
    ]
    text = as_table(header, best)
    if factors:
        title = "time relative to spintop, numerical"
        text += "\n\n" + as_table([title, *(f"{error:.0e}" for error in ERRORS)], factors)
    return text
