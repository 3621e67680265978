"""What the table says, in Markdown: at each error the cheapest of spintop and of the others."""

import pandas as pd

from peers.result import OWN

ERRORS = tuple(float(f"1e-{digits}") for digits in range(3, 13))
NONE = "\N{EN DASH}"


def cheapest(rows: pd.DataFrame, error: float) -> pd.Series | None:
    """The fastest row whose attitude at the end is good enough."""
    good = rows[(rows["status"] == "ok") & (rows["orientation_error"] <= error)]
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


def as_table(header: list[str], lines: list[list[str]]) -> str:
    """A table in Markdown."""
    rule = ["---"] * len(header)
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (header, rule, *lines))


def summarise(rows: pd.DataFrame) -> str:
    """Two tables of each problem: who is cheapest, and by what factor each is dearer."""
    return "\n\n".join(
        f"{name}\n\n{tell_problem(group)}" for name, group in rows.groupby("problem", sort=False)
    )


def tell_problem(rows: pd.DataFrame) -> str:
    """The tables of a problem."""
    exact = rows[rows["method"] == "exact"]
    stepping = rows[(rows["program"] == OWN) & (rows["method"] != "exact")]
    others = rows[rows["program"] != OWN]
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
