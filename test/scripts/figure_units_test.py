"""Tests of the units in figures: those of headings and labels, and of tables in other units."""

import itertools
import unittest
import unittest.mock
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.text import Text

from plot_case import TableCase, a_sweep, some_events
from spintop_figures import draw, read_table
from spintop_figures.files import Files, draw_to
from spintop_figures.registry import FIGURES, FigureKind, choose_figures
from spintop_figures.sweeps.quantities import column_shown, known_quantities
from spintop_figures.tables.names import axis_of, with_unit
from spintop_figures.tables.table import Table
from spintop_figures.tables.words import column_units, columns_of, units_of_columns

AXES = {
    "initial.omega3": "rad/s",
    "initial.theta": "rad",
    "initial.theta_deg": "deg",
    "initial.spin_ratio": "",
    "top.mass": "kg",
    "top.length": "m",
    "span.t_end": "s",
}
"""Parameters of each unit."""
SIZE = 6
"""Values of a parameter."""


def quantities_by_unit() -> dict[str, str]:
    """A column of sweeps for each unit that they have."""
    columns = columns_of("sweep").values()
    return {each["unit"] or "": each["name"] for each in columns if not each["words"]}


def a_study(axes: tuple[str, ...], of_axis: float, of_quantity: float) -> Table:
    """A sweep over a grid, with a column of each unit; sizes of the last parameter and of these."""
    values = [np.linspace(1, 2, SIZE) * (of_axis if name == axes[-1] else 1) for name in axes]
    grid = np.array(list(itertools.product(*values)))
    found = of_quantity * (1 + np.arange(len(grid)) / len(grid))
    columns = quantities_by_unit()
    cells = {"case": np.arange(len(grid)) + 1}
    cells |= dict(zip(axes, grid.T, strict=True)) | {"status": "ok"}
    cells |= dict.fromkeys(columns.values(), found)
    units = {name: unit for unit, name in columns.items()} | {name: AXES[name] for name in axes}
    settings = {"study.kind": ["sweep"], "output.columns": list(columns.values())}
    rows = pd.DataFrame(cells)
    return Table(Path("sweep.csv"), {"program": "spintop"}, settings, units, {}, rows, None)


def binned(study: Table) -> Table:
    """Its statistics, each case in a bin of its own."""
    names = list(quantities_by_unit().values())
    cells: dict[str, np.ndarray] = {"bin": np.arange(len(study.rows)) + 1}
    units = {}
    for name in study.axes():
        middles = study.rows[name].to_numpy()
        half = np.diff(np.unique(middles)).min() / 2
        cells |= {name: middles, f"{name}_from": middles - half, f"{name}_to": middles + half}
        units[name] = study.units[name]
    cells |= {"cases": 10.0 + np.arange(len(study.rows)) ** 2, "failed": 0 * middles}
    for name in names:
        numbers = study.rows[name].to_numpy()
        cells |= {f"{name}_{end}": numbers for end in ("mean", "min", "max")}
        cells |= {f"{name}_deviation": 0 * numbers, f"{name}_count": 0 * numbers + 1}
        units[f"{name}_mean"] = study.units[name]
    rows = pd.DataFrame(cells)
    rows = pd.concat([rows.iloc[:1].assign(bin=0), rows], ignore_index=True)
    return replace(study, rows=rows, units=units)


def headings(figure: Figure) -> list[str]:
    """The headings of the panels, each in one line."""
    found = (axes.get_title(loc="left") for axes in figure.axes)
    return [" ".join(text.split()) for text in found if text]


def named(study: Table, kind: str) -> set[str]:
    """The headings that the quantities of a study are to have, in plain units."""
    if kind == "means":
        known = [column_shown(study, name) for name in quantities_by_unit().values()]
    else:
        known = known_quantities(study)
    return {with_unit(each.label, each.unit) for each in known}


def labels(figure: Figure, name: str) -> set[str]:
    """The labels along x or y."""
    found = (getattr(axes, f"get_{name}label")() for axes in figure.axes if axes.get_subplotspec())
    return {" ".join(text.split()) for text in found} - {""}


def texts(figure: Figure) -> list[str]:
    """All texts of a figure."""
    return sorted(text.get_text() for text in figure.findobj(Text))


class SweepTest(unittest.TestCase):
    """Figures of sweeps: every unit of a quantity over every unit of an axis."""

    def check(self, of_axis: float, of_quantity: float) -> None:
        """Draw all; look at those of the quantities and of the last parameter that are about 1."""
        for last in AXES:
            first = next(name for name in AXES if name != last)
            one, two = (a_study(axes, of_axis, of_quantity) for axes in ((last,), (first, last)))
            for kind, study in (("curves", one), ("means", one), ("maps", two), ("means", two)):
                with self.subTest(axes=study.axes(), kind=kind):
                    figure = draw(binned(study) if kind == "means" else study, kind)
                    if of_axis == 1:
                        name = "xy"[len(study.axes()) - 1]
                        assert axis_of(last, AXES[last]) in labels(figure, name)
                    if of_quantity == 1:
                        assert named(study, kind) <= {*headings(figure)}

    def test_units(self) -> None:
        """Neither its unit nor its prefix is that of the other one."""
        self.check(1e-5, 1.0)
        self.check(1.0, 1e-5)


class OtherUnitsTest(TableCase):
    """Tables whose columns have other units are drawn as those in their own."""

    def tables(self) -> list[Table]:
        """Tables that have all figures of columns with units."""
        found = [read_table(self.put("events.csv", some_events(400)))]
        sweep = read_table(self.put("sweep.csv", a_sweep()))
        found.append(
            replace(sweep, units={name: units_of_columns().get(name) for name in sweep.rows})
        )
        for name in ("separatrix", "slow_top_euler_ode45", "friction_to_rest", "fit"):
            settings = ["span.samples=60"] if name != "fit" else []
            settings += ["output.columns=all"] if name == "separatrix" else []
            self.compute(name, *settings)
            end = ".residuals.csv" if name == "fit" else ".csv"
            found.append(read_table(self.folder / f"{name}{end}"))
        return found

    def in_other_units(self, table: Table, names: list[str], number: int) -> Table:
        """The table with these columns in the other unit of this number."""
        rows, units, meanings = table.rows.copy(), dict(table.units), dict(table.meanings)
        for name in names:
            own = units_of_columns()[name]
            others = [each for (of, _), each in column_units().items() if of == own]
            if not others:
                continue
            other = others[number % len(others)]
            new = f"{name}_{other['suffix']}"
            rows = rows.assign(**{name: rows[name] / other["size"]}).rename(columns={name: new})
            units[new], meanings[new] = other["unit"], meanings.pop(name, "")
        return replace(table, rows=rows, units=units, meanings=meanings)

    def test_units(self) -> None:
        """Every figure of columns, which are in another unit each time, has the same texts."""
        most = max(sum(of == unit for of, _ in column_units()) for unit in ("s", "rad", "m", "N"))
        warnings.simplefilter("ignore")
        drawn: set[str] = set()
        for table in self.tables():
            for kind in choose_figures(table)[0]:
                names = [
                    name
                    for name in (kind.columns if kind.name == "fit" else table.rows)
                    if name in units_of_columns() and table.numeric(name)
                ]
                others = [self.in_other_units(table, names, number) for number in range(most)]
                with self.subTest(kind=kind.name):
                    assert {kind.refusal(other) for other in others} == {""}
                    self.compare(kind, table, others[len(drawn) % most])
                drawn.add(kind.name)
        wanted = {each.name for each in FIGURES if set(each.columns) & {"t", "theta", "com_z"}}
        assert wanted <= drawn

    def compare(self, kind: FigureKind, own: Table, other: Table) -> None:
        """Draw two tables that say the same."""
        files = Files(formats=("own",))
        with unittest.mock.patch("spintop_figures.files.save_as") as save:
            for table in (other, own):
                draw_to(kind, table, self.folder / "a", files)
        one, two = (texts(call.args[0]) for call in save.call_args_list)
        assert one == two
