"""What the figures of a sweep show: quantities made of its columns, and its parameters."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from spintop_figures.style.axes import Places, name_axis, set_degree_ticks
from spintop_figures.style.numbers import write, write_count
from spintop_figures.style.page import is_left, is_lowest
from spintop_figures.tables import names
from spintop_figures.tables.table import Table

ERRORS = {"log_over": 10, "floor": 1e-15}
"""Errors are compared by ratios, and 1e-15 is the rounding error of an angle or a relative one."""

CLASSES = (
    *("loop", "cusp", "wave", "steady", "sleeping", "upright", "hanging"),
    *("separatrix", "libration", "circulation"),
)
"""Classes of motion in the order in which they are drawn; others come after them."""


class Quantity(NamedTuple):
    """A quantity of a case, of columns of the table."""

    columns: tuple[str, ...]
    label: str
    unit: str
    values: Callable[[pd.DataFrame], pd.Series]
    log_over: float = 1e3
    """Values above zero over a larger ratio have a log scale."""
    none: str = ""
    """What a value is called that is nothing but rounding beside the largest."""
    floor: float = 0.0
    """The rounding error of a relative error or an angle: smaller values say nothing."""
    most: str = ""
    """What a case is called that has the largest value, where many have it."""

    def shown(self, values: np.ndarray) -> np.ndarray:
        """Values as they are drawn: what is below rounding stands there."""
        return np.maximum(values, self.floor) if self.floor else values

    def is_noise(self, values: pd.Series) -> bool:
        """Whether all values are about as small as rounding errors: a picture of noise."""
        return bool(self.floor and values.max() <= 10 * self.floor)

    def is_none(self, values: np.ndarray) -> np.ndarray:
        """Which values are nothing but rounding, where that has a name."""
        finite = values[np.isfinite(values)]
        if not self.none or not finite.size:
            return np.zeros(values.shape, dtype=bool)
        # eigenvalues are double at the limit of stability: the root of rounding is seen
        return np.abs(values) <= 1e-6 * np.abs(finite).max()

    def heights(self, values: np.ndarray) -> tuple[np.ndarray, str]:
        """Where values stand on their axis, and what its name says of those that stand at zero."""
        values, none = self.shown(values), self.is_none(values)
        values = np.where(none, 0.0, values)
        if self.has_log_scale(values):
            values = np.where(values > 0, values, np.nan)
        return values, f"; 0: {self.none}" if none.any() else ""

    def has_log_scale(self, values: np.ndarray) -> bool:
        """Whether values above zero or equal to it have a log scale."""
        finite = values[np.isfinite(values)]
        return bool(finite.min(initial=0) >= 0 and is_wide(finite[finite > 0], self.log_over))


def column_shown(table: Table, name: str) -> Quantity:
    """A column as a quantity, named by its meaning."""
    unit = table.units.get(name, "")
    return of_column(name, names.column_name(name, table.meanings.get(name, "")), unit)


def of_column(name: str, label: str = "", unit: str = "", **settings: object) -> Quantity:
    """A column as a quantity in the unit in which it is drawn."""
    unit, factor = names.unit_shown(name, unit)
    values = (lambda rows: rows[name]) if factor == 1 else (lambda rows: factor * rows[name])
    return Quantity((name,), label or names.column_name(name), unit, values, **settings)


QUANTITIES = (
    of_column("motion_class"),
    Quantity(
        ("theta_min", "theta_max"),
        "range of the inclination",
        "degrees",
        lambda rows: np.degrees(rows["theta_max"] - rows["theta_min"]),
    ),
    of_column("precession_per_nutation", unit="rad"),
    of_column("growth_rate", unit="1/s", none="stable"),
    Quantity(
        ("upright_multiplier",),
        "growth per period, upright",
        "",
        lambda rows: np.log(rows["upright_multiplier"]),
        none="stable",
    ),
    of_column("lyapunov_exponent", unit="1/s"),
    of_column("orientation_error", "orientation error", "rad", **ERRORS),
    of_column("energy_error_max", **ERRORS),
    of_column("t_end", unit="s", most="whole span"),
    of_column("evaluations", log_over=10),
)
"""Those that any table shows that has their columns."""

COSTS = ("evaluations",)
"""Columns that are drawn last."""


def known_quantities(table: Table) -> list[Quantity]:
    """The quantities that a table has values of: those above, and all that its input names."""
    known = [quantity for quantity in QUANTITIES if not table.missing(quantity.columns)]
    shown = {name for quantity in known for name in quantity.columns}
    for name in table.settings.get("output.columns", []):
        if name not in shown and name in table.rows:
            known.append(column_shown(table, name))
    known.sort(key=lambda quantity: quantity.columns == COSTS)
    good = succeeded(table).replace([np.inf, -np.inf], np.nan)
    return [quantity for quantity in known if quantity.values(good).notna().any()]


def quantities_of(table: Table) -> list[Quantity]:
    """The quantities that a figure shows: not those that are constant or rounding, unless all."""
    there, good = known_quantities(table), succeeded(table)
    varying = [each for each in there if not is_constant(each.values(good))] or there
    return [each for each in varying if not each.is_noise(each.values(good))] or varying


def is_constant(values: pd.Series) -> bool:
    """Whether a quantity has the same value in all of several cases."""
    if is_words(values):
        return values.nunique() == 1 < len(values)
    finite = values[np.isfinite(values)]
    # a smaller range is rounding
    return bool(finite.size > 1 and np.ptp(finite) <= 1e-9 * np.abs(finite).max())


def tell_hidden(table: Table) -> str:
    """The quantities that are not drawn: constants, with their values, and rounding."""
    shown = [quantity.columns for quantity in quantities_of(table)]
    constant, noise = [], []
    for quantity in known_quantities(table):
        values = quantity.values(succeeded(table))
        if quantity.columns in shown:
            continue
        if quantity.is_noise(values):
            noise.append(f"{quantity.label} at rounding, {write(values.max(), 2)} at most")
        elif quantity.columns != COSTS or values.any():
            value = values.dropna().iloc[0]
            text = value if is_words(values) else f"{write(value)} {quantity.unit}".strip()
            constant.append(f"{quantity.label}: {text}")
    words = (f"in all cases {'; '.join(constant)}" if constant else "", "; ".join(noise))
    return "".join(f" ({each})" for each in words if each)


def is_words(values: pd.Series) -> bool:
    """Whether values are words."""
    return not pd.api.types.is_numeric_dtype(values)


def succeeded(table: Table) -> pd.DataFrame:
    """The cases that succeeded."""
    return table.rows[names.ended_well(table.rows)]


def order_classes(words: pd.Series) -> list[str]:
    """The classes that there are, in their order."""
    known = {name: place for place, name in enumerate(CLASSES)}
    return sorted(words.unique(), key=lambda name: (known.get(name, len(known)), name))


def draw_class_ticks(axes: Axes, values: pd.Series, among: pd.Series) -> np.ndarray:
    """Name the classes among some values at the ticks of y; all values as their numbers."""
    classes = order_classes(among)
    axes.set_yticks(range(len(classes)), labels=[*map(names.name_of, classes)])
    return values.map({name: float(code) for code, name in enumerate(classes)}).to_numpy(float)


def is_wide(values: np.ndarray, ratio: float = 12) -> bool:
    """Whether values belong on a log axis."""
    finite = values[np.isfinite(values)]
    return bool(finite.size > 1 and finite.min() > 0 and finite.max() > ratio * finite.min())


def has_log_axis(table: Table, name: str) -> bool:
    """Whether a swept parameter is spaced by ratios, or listed over a wide range."""
    parameters = table.settings.get("sweep.parameter", [])
    own = {name, name.partition("(")[0]}  # of a vector all elements are swept alike
    place = table.axes().index(name) + 1
    number = next((i for i, each in enumerate(parameters, 1) if each in own), place)
    if {f"sweep.values({number},:)", "sweep.table"} & table.settings.keys():
        return is_wide(table.rows[name].to_numpy(float))

    def element(key: str) -> str:
        listed = table.settings.get(key, [])  # in which one may stand alone, as `spacing(2)`
        return listed[number - 1] if number <= len(listed) else table.setting(f"{key}({number})")

    return element("sweep.distribution") == "lognormal" or element("sweep.spacing") == "log"


def scale_panels(
    panels: Sequence[Axes],
    which: str,
    table: Table,
    name: str,
    is_log: bool,
    ends: Sequence[float] | None = None,
    letters: int = 0,
    steps: int = 0,
) -> None:
    """The scale of a column along x or y of panels, and its name where they are at the edge.

    It has these ends, if any, and so many steps between its ticks at most.
    """
    unit = table.units.get(name, "")
    for axes in panels:
        axes.set(**{f"{which}scale": "log" if is_log else "linear"})
        if ends is not None:
            axes.set(**{f"{which}lim": tuple(ends)})
    for axes in panels:
        axis = axes.xaxis if which == "x" else axes.yaxis
        if steps and not is_log:
            axis.set_major_locator(Places(steps))
        elif which == "y" and unit == "deg":
            set_degree_ticks(axis, table.column(name))
        is_named = is_lowest(axes) if which == "x" else is_left(axes) or steps
        if is_named:
            name_axis(axis, names.axis_of(name), unit, plain=True, letters=letters)
        if steps and is_log:
            axis.set_minor_formatter("")
        if which == "x":
            axes.tick_params(which="both", labelbottom=is_named)


def tell_failed(table: Table) -> str:
    """How many cases have a cross, and why."""
    counts = names.count_failures(table.rows).items()
    reasons = ", ".join(f"{write_count(count)} {names.name_of(status)}" for status, count in counts)
    return f" (crossed: {reasons})" if reasons else ""


def tell_rest(table: Table) -> str:
    """What a title says of cases and quantities that are not drawn as the others."""
    return tell_failed(table) + tell_hidden(table)
