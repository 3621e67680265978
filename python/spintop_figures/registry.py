"""Which figures there are, and to which tables they belong."""

import importlib
from collections.abc import Sequence

from matplotlib.figure import Figure

from spintop_figures.columns import columns_kind
from spintop_figures.kinds import COMPARISONS, FIGURES, FigureKind
from spintop_figures.style.look import Options
from spintop_figures.tables.own_units import in_own_units
from spintop_figures.tables.table import Table, TableError

MODULES = {
    "motion": "trajectory sphere reduced residuals drift fits events",
    "sweeps": "curves table1 maps scatter statistics",
    "methods": "trials precision tolerance benchmarks peers",
}
"""Where figures are drawn, in the order in which they are listed."""

for folder, names in MODULES.items():
    for module in names.split():
        importlib.import_module(f"spintop_figures.{folder}.{module}")

PLACES = [f"spintop_figures.{f}.{module}" for f in MODULES for module in MODULES[f].split()]
FIGURES.sort(key=lambda kind: PLACES.index(kind.make.__module__))  # some modules import others


def choose_figures(
    table: Table, names: list[str] | None = None
) -> tuple[list[FigureKind], list[str]]:
    """The figures to draw from a table, and what is wrong with those that should be drawn too."""
    table = in_own_units(table)
    if unknown := set(names or ()) - {kind.name for kind in FIGURES}:
        known = ", ".join(kind.name for kind in FIGURES)
        return [], [f"there is no figure {min(unknown)}; there are {known}"]
    wanted = [
        kind for kind in FIGURES if (kind.name in names if names else kind.is_expected(table))
    ]
    refusals = {kind: kind.refusal(table) for kind in wanted}
    good = [kind for kind in wanted if not refusals[kind]]
    return good, [f"{refusals[kind]}: no {kind.name} figure" for kind in wanted if refusals[kind]]


def draw(tables: Table | Sequence[Table], name: str = "", **options: object) -> Figure:
    """Draw the figure of this name of a table, or one of several tables, such as `traces`.

    Without a name, the columns `y` of the tables over their column `x` (time). The other options
    are those of `style.look.Options`: width, title, dark, style, font_size, decimal_comma; of
    chosen columns log and range. Raises a TableError that says why there is no such figure, and a
    ValueError or a TypeError where an option is wrong.
    """
    asked = Options(**options)
    alone = isinstance(tables, Table)
    if asked.y and name:
        raise ValueError("a figure has a name or columns y, not both")
    if asked.y:
        kind, tables, alone = columns_kind(asked), [tables] if alone else list(tables), False
    else:
        kinds = {kind.name: kind for kind in (FIGURES if alone else COMPARISONS)}
        if name not in kinds:
            raise TableError(f"there is no figure {name}; there are {', '.join(kinds)}")
        kind = kinds[name]
    for table in [tables] if alone else tables:
        if refusal := kind.refusal(table):
            raise TableError(f"{refusal}: no {kind.name} figure")
    return kind.draw(tables, asked)
