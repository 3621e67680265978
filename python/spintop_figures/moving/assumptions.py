"""What figures and pages may assume of a scene, as its resolved input and its body tell.

A figure that holds for some scenes only names its assumptions; `broken` alone decides whether they
hold. What a table does not tell, such as a body in a table without a header, breaks none.
"""

import re
from collections.abc import Callable, Sequence

from spintop_figures.moving.body import read_body
from spintop_figures.tables.table import Table, is_word

Assumption = Callable[[Table], str]
"""Says why it does not hold for a table; empty if it does."""

AUXILIARY = re.compile(
    r"effects\.(friction_(radius|smoothing|interpolation)|drag_exponent|latitude\w*|torque_(axes|interpolation)"
    r"|(vibration|torque_body|torque_space)_(rate|phase\w*))"
)
"""Keys that only say how an effect acts, which others give its strength."""

ALIKE = 1e-12
"""Numbers of a body that differ by less than this part are equal."""


def acting(table: Table, prefix: str) -> list[str]:
    """The keys of an input that begin so, and are swept or have a value that is not zero."""
    given = [
        key
        for key, values in table.settings.items()
        if any(float(value) if not is_word(value) else value for value in values)
    ]
    keys = [key.partition("(")[0] for key in [*given, *table.axes()]]
    found = [key for key in keys if key.startswith(prefix) and not AUXILIARY.fullmatch(key)]
    return list(dict.fromkeys(found))


def no_effects(table: Table) -> str:
    """No effect acts on the body."""
    found = acting(table, "effects.")
    return f"is of a body with {', '.join(found)}" if found else ""


def undamped(table: Table) -> str:
    """There is no viscous damping."""
    return "is of a damped body" if acting(table, "top.damping") else ""


def symmetric(table: Table) -> str:
    """The body is symmetric about body z, with its centre of mass on that axis."""
    body = read_body(table)
    if body is None:
        return ""
    first, second, _ = body.inertia
    off_axis = abs(body.centre[:2]).max() > ALIKE * abs(body.centre).max()
    if abs(first - second) > ALIKE * first or abs(body.products).max() > ALIKE * first or off_axis:
        return "is of a body that is not symmetric about body z"
    return ""


CONSERVED = (no_effects, undamped)
"""The energy and the momentum about the vertical are constant."""
LAGRANGE = (*CONSERVED, symmetric)
"""A symmetric top under gravity alone: it moves in an effective potential, and the exact solution
in theta functions is its motion."""


def broken(assumptions: Sequence[Assumption], table: Table) -> str:
    """Why the first of these assumptions that does not hold fails; empty if all hold."""
    return next(filter(None, (fails(table) for fails in assumptions)), "")
