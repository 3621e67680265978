"""The curves of a work-precision study: errors of a method against its cost."""

import itertools
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pandas as pd

from spintop_figures.methods.known import rank_of
from spintop_figures.methods.styles import style_of
from spintop_figures.tables.ends import ended_well
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table

EXACT = "exact"
"""The method that takes no steps."""

TARGET = 1e-9
"""The error by whose cost methods are compared, rad."""


class Curve(NamedTuple):
    """A method under a formulation: its label, and its rows from the coarsest to the finest."""

    method: str
    formulation: str
    label: str
    rows: pd.DataFrame

    def style(self) -> dict[str, object]:
        """How it is drawn, in every figure alike; the formulation fills markers if it is told."""
        return style_of(self.method, self.formulation if self.label != self.method else "")


def fineness(setting: str) -> float:
    """How fine a setting is: a number of steps, or one over a tolerance; 0 if it is neither."""
    word, _, value = setting.partition(" ")
    if word == "steps":
        return float(value)
    return 1 / float(value) if word == "tolerance" else 0.0


def problems_of(table: Table) -> list[str]:
    """The problems, in the order in which the table has them first."""
    return list(dict.fromkeys(table.rows["problem"]))


def curves_of(rows: pd.DataFrame, columns: Iterable[str]) -> list[Curve]:
    """The curves of a problem, by family, of rows that went well and have these columns.

    A label names the formulation only where a method has several.
    """
    columns = list(columns)
    sound = ended_well(rows) & np.isfinite(rows[columns].astype(float)).all(axis=1)
    several = rows.groupby("method")["formulation"].nunique() > 1
    curves = []
    for (method, formulation), part in rows[sound].groupby(["method", "formulation"], sort=False):
        label = f"{name_of(method)}, {name_of(formulation)}" if several[method] else name_of(method)
        order = part["setting"].map(fineness).sort_values(kind="stable").index
        curves.append(Curve(method, formulation, label, part.loc[order]))
    return sorted(curves, key=lambda curve: (*rank_of(curve.method), curve.label))


def time_to(curve: Curve, target: float = TARGET, cost: str = "time_s") -> float:
    """The least cost at which a method reaches an error, nan if it does not.

    Between two settings the logarithms of cost and error are on a line.
    """
    with np.errstate(divide="ignore"):
        time, error = (np.log(curve.rows[name].to_numpy(float)) for name in (cost, "error_max"))
    goal = np.log(target)
    times = [time[0]] if error[0] <= goal else []
    for (t0, e0), (t1, e1) in itertools.pairwise(zip(time, error, strict=True)):
        if e1 <= goal < e0:
            share = 1.0 if np.isneginf(e1) else (goal - e0) / (e1 - e0)
            times.append(t0 + share * (t1 - t0))
    return float(np.exp(min(times))) if times else float("nan")
