"""The trials of a stability study, and what their verdicts look like."""

from typing import NamedTuple

import pandas as pd

from spintop_figures.methods.known import family_of
from spintop_figures.style.look import FAULT
from spintop_figures.tables.names import name_of
from spintop_figures.tables.table import Table


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
        Verdict("failed", "#1c1c1c", "white", "{why}"),
        Verdict("unsuitable", "white", "0.55", "\N{EN DASH}"),
        Verdict("no_reference", "white", "0.55", "?"),
    )
}
"""From best to worst. They darken step by step, for print without colours."""

NO_TRIAL = ("unsuitable", "no_reference")
"""The verdicts without a trial."""


def trials(table: Table) -> pd.DataFrame:
    """The rows with the columns `entry`, which names method and formulation, and `family`.

    A method that is tried once a case takes the formulation that suits the body, which its entry
    leaves out; of one that is tried several times the entries name what distinguishes them.
    """
    rows = table.rows.copy()
    place = rows.groupby(["case", "method"]).cumcount()
    key = [rows["method"], place]
    suited = rows["formulation"].where(~rows["verdict"].isin(NO_TRIAL))
    forms = suited.groupby(key).transform(lambda names: ", ".join(names.dropna().unique()))
    forms = forms.where(forms != "", rows["formulation"])
    several = place.groupby(rows["method"]).transform("max") > 0
    named = several & ~forms.str.contains(",")
    names, forms = rows["method"].map(name_of), forms.map(name_of)
    rows["entry"] = names.where(~named, names + ", " + forms)
    rows["family"] = rows["method"].map(family_of)
    return rows


def cases_by_reference(rows: pd.DataFrame) -> dict[str, list[str]]:
    """The cases by what they are compared with, else in the order of the table."""
    return {
        str(reference): list(part["case"].unique())
        for reference, part in rows.groupby("reference", sort=False)
    }


def object_to_trials(table: Table) -> str:
    """A verdict has to be known, and a trial to be there once."""
    if unknown := [name for name in table.rows["verdict"].unique() if name not in VERDICTS]:
        return f"has the unknown verdict {unknown[0]!r}"
    rows = trials(table)
    if rows.duplicated(["case", "entry"]).any():
        twice = rows[rows.duplicated(["case", "entry"])].iloc[0]
        return f"tries {twice['entry']} twice on {twice['case']}"
    return ""
