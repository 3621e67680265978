"""The cases that a figure draws as points: by class, and a random sample of too many."""

import itertools
from typing import NamedTuple

import numpy as np
import pandas as pd

from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.sweeps.quantities import order_classes, succeeded
from spintop_figures.tables.table import Table

MOST_CASES, LEAST_CASES = 10_000, 300
"""Size of the random sample of many cases, and of each class and of the failed cases."""

LOOKS = (
    ("#12355b", "o"),
    ("#d1641b", "^"),
    ("#93cfc0", "s"),
    ("#7a5195", "D"),
    ("#e3c65b", "v"),
    ("#2f6f4f", "P"),
    ("#a9a9a9", "X"),
    ("#5f1f2a", "<"),
    ("#6fa8dc", ">"),
)
"""Colours and markers of classes; the first three are far apart in lightness."""

DENSE = 1500
"""More cases of one class would hide each other as points."""


class Layer(NamedTuple):
    """Cases of a class, or all that succeeded: which are drawn, of how many, and how."""

    name: str
    rows: pd.DataFrame
    count: int
    colour: str
    marker: str


class Cloud(NamedTuple):
    """The cases that are drawn."""

    layers: list[Layer]
    """Those that succeeded, the most numerous below."""
    failed: pd.DataFrame
    rasterized: bool
    """Whether an SVG stores them as pixels."""

    @property
    def rows(self) -> pd.DataFrame:
        """Those that succeeded."""
        return pd.concat([layer.rows for layer in self.layers])

    @property
    def count(self) -> int:
        """How many there are in all."""
        return len(self.rows) + len(self.failed)

    @property
    def is_dense(self) -> bool:
        """Whether the cases would hide each other as points."""
        return len(self.layers) == 1 and len(self.rows) > DENSE

    @property
    def area(self) -> float:
        """Of a point, in square points of print: less where there are many."""
        return float(np.clip(15 / len(self.rows) ** 0.25, 1.6, 5.0)) ** 2


def make_cloud(table: Table, panels: int) -> Cloud:
    """The cases that are drawn in so many panels, by class where the table has classes."""
    good = succeeded(table)
    words = good["motion_class"] if "motion_class" in good else pd.Series("", good.index)
    classes = order_classes(words)
    groups = [good[words == name] for name in classes]
    *chosen, failed = thin([*groups, table.rows.drop(good.index)])
    counts = map(len, groups)
    layers = [
        Layer(name, rows, count, *look)
        for name, rows, count, look in zip(classes, chosen, counts, itertools.cycle(LOOKS))
    ]
    layers.sort(key=lambda layer: -layer.count)
    drawn = sum(map(len, chosen)) + len(failed)
    return Cloud(layers, failed, drawn * panels > MANY_POINTS)


def thin(groups: list[pd.DataFrame]) -> list[pd.DataFrame]:
    """A random sample of many cases, the same one each time; rare groups are complete."""
    share = min(1.0, MOST_CASES / sum(map(len, groups)))
    thinned = []
    for group in groups:
        count = min(len(group), max(round(share * len(group)), LEAST_CASES))
        thinned.append(group.sample(count, random_state=0).sort_index())
    return thinned
