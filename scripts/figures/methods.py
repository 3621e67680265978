"""The methods by family, with their styles; the trials of a stability study, and its verdicts."""

from typing import NamedTuple

import pandas as pd
from matplotlib.colors import to_rgb

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
        Verdict("failed", "#1c1c1c", "white", "{why}"),
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
    Family("explicit, fixed step size", ("rk4", "rk2", "euler_forward"), "s", "#d1641b"),
    Family(
        "implicit, fixed step size",
        ("crank_nicolson_2", "crank_nicolson_1", "galerkin", "euler_backward"),
        "v",
        "#8a6fae",
    ),
    Family(
        "Gauss-Legendre, fixed step size",
        ("gauss_8", "gauss_6", "gauss_4", "gauss_"),
        "^",
        "#7a2048",
    ),
    Family("Lie group, fixed step size", ("rkmk_", "commutator_free_"), "P", "#5aa9a3"),
    Family(
        "splitting, fixed step size",
        ("splitting_8", "splitting_6", "splitting_4", "splitting_2", "splitting_"),
        "X",
        "#b08b00",
    ),
    Family(
        "Runge-Kutta, adaptive",
        ("dop853", "ode45", "arkode_erk", "arkode_dirk", "arkode_"),
        "o",
        "#12355b",
    ),
    Family("Taylor series, adaptive", ("taylor", "taylor_quadruple"), "*", "#2f7d32"),
    Family("closed form", ("exact",), "p", "black"),
    Family("other programs", ("heyoka", "odeint", "scipy", "sundials", "octave"), "D", "0.5"),
    Family("other methods", ("",), "d", "0.35"),
)
"""A method belongs to the first of them that has a beginning of its name; which of the beginnings
it has decides on dashes and tone."""

DASHES = ("-", (0, (5, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (1.2, 1.2)), (0, (3, 3)))
"""Of the variations within a family, the first of which has the family's own colour."""

PALER = 0.17
"""How much of the way to white the colour of a variation is from the one before it."""

FILLS = {
    "space_frame": "full",
    "rigid_body": "none",
    "lagrange": "left",
    "cayley_klein": "top",
    "euler": "bottom",
    "lagrange_energy": "right",
}
"""Which part of a marker is filled, by the formulation; of others all of it."""

ORDERS = {
    "euler_forward": 1,
    "rk2": 2,
    "rk4": 4,
    "crank_nicolson_1": 2,
    "crank_nicolson_2": 2,
    "galerkin": 1,
    "euler_backward": 1,
    "gauss_4": 4,
    "gauss_6": 6,
    "gauss_8": 8,
    "rkmk_4": 4,
    "commutator_free_4": 4,
    "splitting_2": 2,
    "splitting_4": 4,
    "splitting_6": 6,
    "splitting_8": 8,
}
"""Orders of the methods with a fixed step size, as `spintop list methods` has them."""


def family_of(method: str) -> Family:
    """The family of a method."""
    return next(family for family in FAMILIES if method.startswith(family.beginnings))


def variation_of(method: str) -> int:
    """The place of a method in its family: that of the longest beginning that it has."""
    beginnings = family_of(method).beginnings
    return beginnings.index(max(filter(method.startswith, beginnings), key=len))


def rank_of(method: str) -> tuple[int, int]:
    """Where a method stands in a list: by its family, then by its place in it."""
    return FAMILIES.index(family_of(method)), variation_of(method)


def style_of(method: str, formulation: str = "") -> dict[str, object]:
    """How the curve of a method under a formulation is drawn, in every figure alike."""
    family, variation = family_of(method), variation_of(method)
    red, green, blue = to_rgb(family.colour)
    share = min(PALER * variation, 0.6)
    colour = tuple(part + share * (1 - part) for part in (red, green, blue))
    return {
        "color": colour,
        "linestyle": DASHES[variation % len(DASHES)],
        "marker": family.marker,
        "markersize": 8 if family.marker == "*" else 5.5,
        "fillstyle": FILLS.get(formulation, "full"),
        "markerfacecoloralt": "white",
        "markeredgewidth": 0.9,
    }


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
