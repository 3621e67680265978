"""The key numbers of a table: what one wants to know of it first. They are of its rows."""

import numpy as np

from reporting.words import counted, with_error
from spintop_figures.motion.events import describe_event
from spintop_figures.style.numbers import write, write_count, write_fixed
from spintop_figures.tables.names import columns_of, name_of, raised, sign_of
from spintop_figures.tables.table import Table

MEAN, LEAST, MOST = "_mean", "_min", "_max"
"""Ends of the columns of a table of statistics."""

RESIDUAL = "_residual"


def column(table: Table, name: str) -> np.ndarray:
    """The finite numbers of a column; none if it is not there."""
    if name not in table.rows or not table.numeric(name):
        return np.array([])
    values = table.rows[name].to_numpy(float)
    return values[np.isfinite(values)]


def degrees(angle: float) -> str:
    """An angle in degrees: small ones with digits, others with two decimals."""
    value = float(np.degrees(angle))
    text = write_fixed(value, 2) if abs(value) >= 1 else write(value)
    return f"{text}\N{DEGREE SIGN}"


def quantity(value: float, unit: str, digits: int = 4) -> str:
    """A number with its unit; an angle in degrees."""
    if unit == "rad":
        return degrees(value)
    return " ".join(filter(None, (write(value, digits), unit_of(unit))))


def between(least: float, most: float, unit: str = "") -> str:
    """A range of numbers with their unit."""
    return f"{quantity(least, 'rad' if unit == 'rad' else '')} to {quantity(most, unit)}"


def of_trajectory(table: Table) -> dict[str, str]:
    """Span, inclination, the largest force, and the errors that the table has."""
    found = {}
    if (t := column(table, "t")).size:
        found["span"] = f"{write(t[-1] - t[0])} s"
    if (theta := column(table, "theta")).size:
        found["θ"] = f"{degrees(theta.min())} to {degrees(theta.max())}"
    forces = [column(table, f"force_{axis}") for axis in "xyz"]
    if forces[0].size and len({force.size for force in forces}) == 1:
        found["largest force"] = f"{write(np.sqrt(sum(force**2 for force in forces)).max())} N"
    if (error := np.abs(column(table, "energy_error"))).size:
        found["energy error"] = f"{write(error.max())} J"
    if (error := column(table, "orientation_error")).size:
        found["orientation error"] = degrees(error.max())
    return found


def of_sweep(table: Table) -> dict[str, str]:
    """The range of each parameter that is swept, and of the inclination."""
    found = {}
    for axis in table.axes():
        if (values := column(table, axis)).size:
            unit = table.units.get(axis, "")
            found[name_of(axis)] = between(values.min(), values.max(), unit)
    least, most = column(table, "theta_min"), column(table, "theta_max")
    if least.size and most.size:
        found["θ"] = f"{degrees(least.min())} to {degrees(most.max())}"
    return found


def of_methods(table: Table) -> dict[str, str]:
    """How many problems and methods are compared, and the smallest error."""
    found = {}
    for name, plural in (("problem", "problems"), ("case", "cases"), ("method", "methods")):
        if name in table.rows and not table.numeric(name):
            found[plural] = str(table.rows[name].nunique())
    errors = column(table, "orientation_error")
    if (errors := errors[errors > 0]).size:
        found["smallest orientation error"] = f"{write(errors.min())} rad"
    return found


def swept_column(name: str) -> tuple[str, str]:
    """What a column of a sweep is called, and its unit."""
    known = columns_of("sweep").get(name)
    return (known["description"], known["unit"]) if known else (sign_of(name), "")


def of_events(table: Table) -> dict[str, str]:
    """How often each event happened."""
    counts = table.rows["event"].astype(str).value_counts()
    return {describe_event(name): counted(count, "time") for name, count in counts.items()}


def unit_of(cell: object) -> str:
    """A unit; empty if there is none, or none is said."""
    return raised(cell) if isinstance(cell, str) and cell != "1" else ""


def of_fit(table: Table) -> dict[str, str]:
    """The values that were found with their standard errors; or the size of the residuals."""
    rows = table.rows
    if "parameter" in rows and not table.missing(("estimate", "standard_error")):
        units = rows["unit"] if "unit" in rows else [""] * len(rows)
        values = zip(
            rows["parameter"], rows["estimate"], rows["standard_error"], units, strict=True
        )
        return {
            name_of(str(key)): f"{with_error(value, error)} {unit_of(unit)}".strip()
            for key, value, error, unit in values
        }
    found = {}
    for name in rows:
        if name.endswith(RESIDUAL) and (values := column(table, name)).size:
            size = quantity(np.sqrt(np.mean(values**2)), table.units.get(name, ""))
            found[f"rms residual of {sign_of(name.removesuffix(RESIDUAL))}"] = size
    return found


def of_statistics(table: Table) -> dict[str, str]:
    """How many cases, and of each quantity the mean and the range: in the row of all cases."""
    everything = table.rows.iloc[0]
    found = {}
    if "cases" in table.rows:
        found["cases"] = write_count(int(everything["cases"]))
    for name in [name for name in table.rows if name.endswith(MEAN)]:
        words, unit = swept_column(name.removesuffix(MEAN))
        ends = [everything.get(name.removesuffix(MEAN) + end, np.nan) for end in (LEAST, MOST)]
        ranged = f" ({between(*ends, unit)})" if np.isfinite(ends).all() else ""
        found[f"mean {words}"] = quantity(everything[name], unit) + ranged
    return found


def of_histogram(table: Table) -> dict[str, str]:
    """The fullest interval of each quantity, and how many cases are in it."""
    found = {}
    for name, rows in table.rows.groupby("column", sort=False):
        fullest = rows.loc[rows["cases"].idxmax()]
        share = 100 * fullest["cases"] / rows["cases"].sum()
        words, unit = swept_column(str(name))
        ends = between(fullest["from"], fullest["to"], unit)
        found[f"most frequent {words}"] = f"{ends} ({write(share, 2)} % of the cases)"
    return found


def of_indices(table: Table) -> dict[str, str]:
    """The factor that decides most of each quantity."""
    found = {}
    for name, rows in table.rows.dropna(subset="total").groupby("column", sort=False):
        most = rows.loc[rows["total"].idxmax()]
        share = f"{write(100 * most['total'], 3)} %"
        found[f"most of {swept_column(str(name))[0]}"] = f"{name_of(str(most['factor']))}, {share}"
    return found


def of_columns(table: Table) -> dict[str, str]:
    """What any table has: the range of its first columns of numbers."""
    numbers = [name for name in table.rows if column(table, name).size][:3]
    ranges = {name: column(table, name) for name in numbers}
    return {sign_of(name): between(x.min(), x.max()) for name, x in ranges.items()}


KINDS = {
    "trajectory": of_trajectory, "sweep": of_sweep, "work_precision": of_methods,
    "stability": of_methods, "events": of_events, "fit": of_fit, "statistics": of_statistics,
    "histogram": of_histogram, "indices": of_indices,
}  # fmt: skip


def key_numbers(table: Table) -> dict[str, str]:
    """The key numbers of a table by their names; of an unknown kind, the ranges of columns."""
    if table.rows.empty:
        return {}
    return KINDS.get(table.kind, of_columns)(table) or of_columns(table)
