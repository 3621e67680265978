"""The trials of a stability study: its verdicts, and the methods by family."""

from typing import NamedTuple

import pandas as pd

from figures.style import FAULT
from figures.table import Table


class Verdict(NamedTuple):
    """A verdict: the colour of its cells, the colour and the form of what stands in them."""

    name: str
    face: str
    ink: str
    mark: str
    """What stands in a cell; `{digits}` are those reached, `{why}` the letter of the status."""


VERDICTS = {
    verdict.name: verdict
    for verdict in (
        Verdict("accurate", "#d3e8f0", "black", "{digits}"),
        Verdict("drifts", "#e39b35", "black", "~{digits}"),
        Verdict("wrong", FAULT, "white", "\N{MULTIPLICATION SIGN}"),
        Verdict("gave_up", "#1c1c1c", "white", "{why}"),
        Verdict("unsuitable", "white", "0.55", "\N{EN DASH}"),
    )
}
"""From best to worst. They darken step by step, for print without colours."""

NO_TRIAL = "unsuitable"
"""The verdict without a trial."""


class Family(NamedTuple):
    """Methods that are alike, by the beginnings of their names, and how they are drawn."""

    name: str
    beginnings: tuple[str, ...]
    marker: str
    colour: str


FAMILIES = (
    Family("explicit, equal steps", ("euler_forward", "rk2", "rk4"), "s", "#d1641b"),
    Family(
        "implicit, equal steps",
        ("crank_nicolson", "galerkin", "euler_backward"),
        "v",
        "#8a6fae",
    ),
    Family("Gauss, equal steps", ("gauss_",), "^", "#7a2048"),
    Family("on the rotation group, equal steps", ("rkmk_", "commutator_free_"), "P", "#5aa9a3"),
    Family("splitting, equal steps", ("splitting_",), "X", "#b08b00"),
    Family("Runge-Kutta, step control", ("ode45", "dop853", "arkode_"), "o", "#12355b"),
    Family("Taylor series, step control", ("taylor",), "*", "#2f7d32"),
    Family("other methods", ("",), "D", "0.35"),
)
"""A method belongs to the first of them that has the beginning of its name."""


def family_of(method: str) -> Family:
    """The family of a method."""
    return next(family for family in FAMILIES if method.startswith(family.beginnings))


def trials(table: Table) -> pd.DataFrame:
    """The rows with the columns `entry`, which names method and formulation, and `family`.

    A method that is tried once a case takes the formulation that suits the body, which its entry
    leaves out; of one that is tried several times the entries name what distinguishes them.
    """
    rows = table.rows.copy()
    place = rows.groupby(["case", "method"]).cumcount()
    key = [rows["method"], place]
    suited = rows["formulation"].where(rows["verdict"] != NO_TRIAL)
    forms = suited.groupby(key).transform(lambda names: ", ".join(names.dropna().unique()))
    forms = forms.where(forms != "", rows["formulation"])
    several = place.groupby(rows["method"]).transform("max") > 0
    named = several & ~forms.str.contains(",")
    rows["entry"] = rows["method"].where(~named, rows["method"] + ", " + forms)
    rows["family"] = [family_of(method).name for method in rows["method"]]
    return rows


def object_to_trials(table: Table) -> str:
    """A verdict has to be known, and a trial to be there once."""
    if unknown := [name for name in table.rows["verdict"].unique() if name not in VERDICTS]:
        return f"has the unknown verdict {unknown[0]!r}"
    rows = trials(table)
    if rows.duplicated(["case", "entry"]).any():
        twice = rows[rows.duplicated(["case", "entry"])].iloc[0]
        return f"tries {twice['entry']} twice on {twice['case']}"
    return ""
