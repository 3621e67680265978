"""Which runs are those of the paper: its examples, figures and Table 1."""

import math
import re
from collections.abc import Iterable

from spintop_figures.moving.assumptions import CONSERVED, broken
from spintop_figures.moving.body import Body, read_body
from spintop_figures.registry import FigureKind
from spintop_figures.tables.table import Table, is_word

SAME = 1e-9
"""Numbers that differ by less than this part are the same."""

THETA = math.pi / 16
GRAVITY = 9.81
SLOW_TOP = Body(1.0, (0.875, 0.875, 0.25), (0.0, 0.0, math.sqrt(3) / 2))
SLOW_TOP_SPIN, SLOW_TOP_END = 1.0, 7.157701498479978
"""Example 1: omega3, and the end of three nutations, s."""

WHEEL_MASS, WHEEL_LENGTH = 2.450442269800039, 1.0
WHEEL_AS_COMPUTED = (0.006146526026748430, 0.006146526026748430, 0.012252211349000193)
WHEEL = (*(x + WHEEL_MASS for x in WHEEL_AS_COMPUTED[:2]), WHEEL_AS_COMPUTED[2])
FIGURE_11 = (2.0, 1.0)
"""Example 2: the wheel without and with m l^2; the spin ratio and the periods T_p of Figure 11."""

RESIDUALS = {
    ("euler", "ode45"): 2,
    ("lagrange", "ode45"): 3,
    ("lagrange", "rk4"): 4,
    ("lagrange", "crank_nicolson_1"): 5,
    ("lagrange", "crank_nicolson_2"): 6,
    ("lagrange_energy", "rk4"): 7,
}
"""The figure of the paper that has the residuals of a formulation under a method, for Example 1."""

NUMBERED = re.compile(r"\b(Example|Figure|Eq|Table)s? (\d+\w?)(?:(?: to |-)(\d+))?")
NAMED = re.compile(r" \((?:Figures?|Table) [^)]*\)$")
"""What a description of a figure says of the paper."""


def same(found: Iterable[float], expected: Iterable[float]) -> bool:
    """Whether numbers are those, but for rounding."""
    pairs = zip(found, expected, strict=True)
    return all(math.isclose(a, b, rel_tol=SAME, abs_tol=SAME) for a, b in pairs)


def angle(table: Table, name: str) -> float:
    """An angle or a rate of the start, rad, from either of its keys; 0 where it is not given."""
    return table.number(f"initial.{name}", math.radians(table.number(f"initial.{name}_deg", 0)))


def body_of(table: Table) -> Body | None:
    """The body in the header, else that of the resolved input."""
    if body := read_body(table):
        return body
    inertia = [float(x) for x in table.settings.get("top.inertia", []) if not is_word(x)]
    if table.setting("top.shape") == "spinning_wheel":
        dimensions = [table.number(f"top.{key}") for key in ("radius", "thickness", "rod_length")]
        is_that = same(dimensions, (0.1, 0.01, WHEEL_LENGTH))
        return Body(WHEEL_MASS, WHEEL, (0, 0, WHEEL_LENGTH)) if is_that else None
    if len(inertia) != len(SLOW_TOP.inertia):
        return None
    return Body(table.number("top.mass"), inertia, (0.0, 0.0, table.number("top.length")))


def starts_at_rest(table: Table) -> bool:
    """Whether the top is released as in the paper: at pi/16, with nothing but its spin."""
    rates = (angle(table, "phi_rate"), angle(table, "theta_rate"))
    is_plain = table.setting("initial.steady_precession") in ("", "none")
    return (
        is_plain
        and not broken(CONSERVED, table)
        and "initial.quaternion" not in table.settings
        and same((angle(table, "theta"), *rates), (THETA, 0, 0))
        and same((table.number("top.gravity", GRAVITY),), (GRAVITY,))
    )


def spin_ratio(table: Table, body: Body) -> float:
    """omega3 over sqrt(4 m g l/I3), by whichever key it is given."""
    unit = math.sqrt(4 * body.mass * GRAVITY * body.centre[2] / body.inertia[2])
    if not math.isnan(ratio := table.number("initial.spin_ratio")):
        return ratio
    return table.number("initial.omega3", angle(table, "psi_rate")) / unit


def is_wheel(body: Body) -> bool:
    """Whether a body is the wheel of Example 2, with the inertia of the author or its own."""
    return same((body.mass, *body.centre), (WHEEL_MASS, 0, 0, WHEEL_LENGTH)) and (
        same(body.inertia, WHEEL) or same(body.inertia, WHEEL_AS_COMPUTED)
    )


def runs_of(table: Table) -> set[str]:
    """The examples, figures and table of the paper that a table is a run of; most are of none."""
    body = body_of(table)
    if body is None or not starts_at_rest(table) or not body.centre[2] > 0:
        return set()
    swept = table.axes()
    if is_wheel(body):
        if swept == ["initial.spin_ratio"]:
            return {"Example 2", "Table 1"}
        return set() if swept else {"Example 2"} | wheel_figures(table, body)
    top = (body.mass, *body.inertia, *body.centre)
    if swept or not same(top, (SLOW_TOP.mass, *SLOW_TOP.inertia, *SLOW_TOP.centre)):
        return set()
    unit = math.sqrt(4 * body.mass * GRAVITY * body.centre[2] / body.inertia[2])
    if not same((spin_ratio(table, body) * unit,), (SLOW_TOP_SPIN,)):
        return set()
    return {"Example 1"} | slow_top_figures(table)


def wheel_figures(table: Table, body: Body) -> set[str]:
    """The figure of Example 2: lambda = 2 over a period T_p, with the inertia of the author."""
    facts = (spin_ratio(table, body), table.number("span.precessions"))
    is_that = same(body.inertia, WHEEL_AS_COMPUTED) and same(facts, FIGURE_11)
    return {"Figure 11"} if table.kind == "trajectory" and is_that else set()


def slow_top_figures(table: Table) -> set[str]:
    """The figures of Example 1, which show three nutations."""
    if table.kind != "trajectory" or "t" not in table.rows:
        return set()
    end = float(table.rows["t"].iloc[-1])
    if not math.isclose(end, SLOW_TOP_END, rel_tol=1e-6):
        return set()
    residuals = RESIDUALS.get(table.model_and_method)
    return {"Figure 8", "Figure 9"} | ({f"Figure {residuals}"} if residuals else set())


def caption_of(kind: FigureKind, runs: set[str]) -> str:
    """What a figure shows, with the figure of the paper where the run is that of the paper."""
    plain = NAMED.sub("", kind.what)
    if plain == kind.what:
        return plain
    named = numbers_named(kind.what) & runs
    return f"{plain} ({sorted(named)[0]} of the paper)" if named else plain


def numbers_named(text: str) -> set[str]:
    """`Figure 2`, `Figure 3`, ... of a text that names `Figures 2 to 3`; so of equations."""
    found = set()
    for kind, first, last in NUMBERED.findall(text):
        found |= (
            {f"{kind} {i}" for i in range(int(first), int(last) + 1)}
            if last
            else {f"{kind} {first}"}
        )
    return found
