"""The key numbers of a table: what one wants to know of it first. They are of its rows."""

import numpy as np

from spintop_figures.motion.events import describe_event
from spintop_figures.style.numbers import write, write_count, write_fixed
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table


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
            found[name_of(axis)] = f"{write(values.min())} to {write(values.max())}"
    least, most = column(table, "theta_min"), column(table, "theta_max")
    if least.size and most.size:
        found["θ"] = f"{degrees(least.min())} to {degrees(most.max())}"
    return found


def of_methods(table: Table) -> dict[str, str]:
    """How many problems and methods are compared, and the smallest error."""
    found = {}
    for name, plural in (("problem", "problems"), ("case", "cases"), ("method", "methods")):
        if name in table.rows and not table.numeric(name):
            found[plural] = write_count(table.rows[name].nunique())
    errors = column(table, "orientation_error")
    if (errors := errors[errors > 0]).size:
        found["smallest orientation error"] = f"{write(errors.min())} rad"
    return found


def of_events(table: Table) -> dict[str, str]:
    """How often each event happened."""
    counts = table.rows["event"].astype(str).value_counts()
    return {describe_event(name): write_count(count) for name, count in counts.items()}


KINDS = {
    "trajectory": of_trajectory,
    "sweep": of_sweep,
    "work_precision": of_methods,
    "stability": of_methods,
    "events": of_events,
}


def key_numbers(table: Table) -> dict[str, str]:
    """The key numbers of a table by their names; none of a kind that is not known here."""
    return KINDS.get(table.kind, lambda _: {})(table)
