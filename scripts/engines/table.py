"""The score sheet of the engines as tables in Markdown."""

import math

import numpy as np
import pandas as pd

from engines.motions import MOTIONS
from peers.program import as_table

NAMES = [motion.name for motion in MOTIONS]
COMPARED = 1000
"""Steps per second of the errors in the table."""
NONE = "–"  # noqa: RUF001
"""In place of a number that is not there."""
LOST, CLEAR = 1.0, 5.0
"""An error above the one, rad, has no order, nor one that is not so many times above the least."""
GOAL = 1e-3
"""The error whose cost is given, rad."""


def order(rows: pd.DataFrame) -> float:
    """The median of the slopes of the error against the step size, where these show an order."""
    rows = rows[rows["fixed"].fillna(False).astype(bool)].sort_values("setting")
    steps, values = rows["setting"].to_numpy(float), rows["attitude"].to_numpy(float)
    good = [
        math.log(values[i] / values[i + 1]) / math.log(steps[i + 1] / steps[i])
        for i in range(len(rows) - 1)
        if LOST > values[i] > 0 and values[i + 1] > CLEAR * max(values.min(), 1e-15)
    ]
    return float(np.median(good)) if good else math.nan


def cost(rows: pd.DataFrame) -> float:
    """The least cost of an error that is small enough; infinite if there is none."""
    good = rows[rows["attitude"] <= GOAL]
    return good["cost"].min() if len(good) else math.inf


def as_cell(value: float, digits: int = 1) -> str:
    """A number, or a dash for what is not there."""
    return f"{value:.{digits}e}" if math.isfinite(value) else NONE


def methods(table: pd.DataFrame) -> list[tuple[str, str, pd.DataFrame]]:
    """Each method of each engine, with its rows."""
    groups = table.groupby(["engine", "method"], sort=False)
    return [(engine, method, rows) for (engine, method), rows in groups]


def compared(rows: pd.DataFrame, motion: str) -> pd.Series | None:
    """The run at the compared step size, or at the next larger one that there is.

    Of a method without step sizes, that of the smallest error.
    """
    rows = rows[(rows["motion"] == motion) & rows["attitude"].notna()]
    fixed = rows["fixed"].fillna(False).astype(bool)
    if not fixed.any():
        return rows.loc[rows["attitude"].idxmin()] if len(rows) else None
    rows = rows[fixed & (rows["setting"] <= COMPARED)]
    return rows.loc[rows["setting"].idxmax()]


def as_error(row: pd.Series | None) -> str:
    """An error, with the steps per second if these are fewer; a large one is only said to be so."""
    if row is None:
        return NONE
    text = as_cell(row["attitude"]) if row["attitude"] < LOST else "lost"
    return f"{text} ({row['setting']:.0f})" if 1 < row["setting"] < COMPARED else text


def sheet(table: pd.DataFrame) -> str:
    """Versions; errors at one step size; order, drifts and cost."""
    versions = table.drop_duplicates("engine")[["engine", "version"]].itertuples(index=False)
    parts = [", ".join(f"{name} {version}".strip() for name, version in versions)]
    rows = [
        [engine, method, *(as_error(compared(rows, name)) for name in NAMES)]
        for engine, method, rows in methods(table)
    ]
    parts.append(as_table(["engine", "method", *(f"`{name}`" for name in NAMES)], rows))
    rows = []
    for engine, method, group in methods(table):
        box, top = group[group["motion"] == NAMES[1]], group[group["motion"] == NAMES[5]]
        row = compared(group, NAMES[1])
        if row is None:
            rows.append([engine, method, *[NONE] * 6])
            continue
        per_step = row["cost"] / row["setting"] * 1e6 if row["setting"] > 1 else math.nan
        slope = order(box)
        rows.append([
            engine, method, f"{slope:.1f}" if math.isfinite(slope) else NONE,
            as_cell(row["energy"]), as_cell(row["momentum"]),
            f"{per_step:.3g}" if math.isfinite(per_step) else NONE,
            as_cell(cost(box)), as_cell(cost(top)),
        ])  # fmt: skip
    header = ["engine", "method", "order", "energy", "momentum", "us per step"]
    header += [f"cost of 1e-3 rad, `{NAMES[1]}`", f"`{NAMES[5]}`"]
    parts.append(as_table(header, rows))
    return "\n\n".join(parts)
