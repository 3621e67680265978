"""Columns in other units than their own: `theta_deg` is the column `theta` in degrees."""

from dataclasses import replace
from typing import NamedTuple

from spintop_figures.tables.table import Table
from spintop_figures.tables.words import column_units, units_of_columns


class Converted(NamedTuple):
    """What the name of a column in another unit says: its column, the unit, its size in `own`."""

    column: str
    unit: str
    size: float
    own: str


def converted(name: str) -> Converted | None:
    """What a name says; None if it is that of a column in its own unit, or of none."""
    own = units_of_columns()
    column, _, suffix = name.rpartition("_")
    if name in own or column not in own:
        return None
    unit = column_units().get((own[column], suffix))
    return unit and Converted(column, unit["unit"], unit["size"], own[column])


def in_own_units(table: Table) -> Table:
    """The table with all its columns in their own units too, in which figures are drawn."""
    there = {name: converted(name) for name in table.rows}
    lacking = {
        name: found for name, found in there.items() if found and found.column not in table.rows
    }
    if not lacking:
        return table
    cells = {found.column: table.rows[name] * found.size for name, found in lacking.items()}
    units = {found.column: found.own for found in lacking.values()}
    meanings = {found.column: table.meanings.get(name, "") for name, found in lacking.items()}
    return replace(
        table,
        rows=table.rows.assign(**cells),
        units=table.units | units,
        meanings=table.meanings | meanings,
    )
