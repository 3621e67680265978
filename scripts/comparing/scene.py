"""Problems from inputs of spintop: what others need to know is asked of the program itself."""

import math
import re
from dataclasses import replace
from pathlib import Path

from comparing.problem import ALIKE, Problem, product
from program import SOME_FAILED, ProgramError, call
from spintop_figures.moving.body import read_body
from spintop_figures.tables.names import is_good_end
from spintop_figures.tables.table import Table, read_head, read_table

SMALL = 0.01
"""Mass times distance squared over the least moment of inertia, where only the weight is known."""
GROUP = re.compile(r"^&(\w+)\n.*?^/\n", re.MULTILINE | re.DOTALL)
TO_Z = ((0.5, 0.5, 0.5, 0.5), (0.5, -0.5, -0.5, -0.5), (1.0, 0.0, 0.0, 0.0))
"""Turns of the axes by which x, y and z come to bear the name z."""
COLUMNS = ["q0", "q1", "q2", "q3", "omega1", "omega2", "omega3", "t"]


def pose(
    name: str, path: Path, overrides: list[str], folder: Path, general: bool = False
) -> Problem:
    """An input as a problem, its axis of symmetry turned to body z.

    Whatever shape the input gives, the header of its motion has the body. The motion depends on
    m g r alone, so under unit gravity the mass may be as large, and the centre of mass as near to
    the fixed point, as one likes; a power of two is exact.
    """
    options = (part for text in overrides for part in ("--set", text))
    resolved = call("--check", *options, "--", path)
    groups = {match[1]: match[0] for match in GROUP.finditer(resolved)}
    settings = read_head([line.strip() for line in resolved.splitlines()])[1]
    if any(key.startswith(("sweep.parameter", "sweep.table")) for key in settings):
        raise ProgramError("has a sweep: leave that out, and --set what it is to be")
    if "top" not in groups:
        raise ProgramError("has no top of its own")
    damping, (gravity,) = (
        [float(text) for text in settings[key]] for key in ("top.damping", "top.gravity")
    )
    span = re.sub(r"(?m)^ *samples *=.*\n", "", groups["span"])
    table = true_motion([groups["top"], groups["initial"], span], folder)
    body, start = read_body(table), table.rows[COLUMNS].iloc[0].tolist()
    if body is None or body.products.any():
        raise ProgramError("the axes of its body are no principal ones")
    inertia = body.inertia.tolist()
    weight = [body.mass * gravity * part for part in body.centre.tolist()]
    order, turn = choose_axes(inertia, weight, damping)
    pull = math.hypot(*weight)
    mass = 2.0 ** math.ceil(math.log2(pull**2 / (SMALL * min(inertia)))) if pull else 1.0
    problem = Problem(
        name=name, mass=mass, gravity=1.0,
        arm=tuple(weight[i] / mass for i in order), inertia=tuple(inertia[i] for i in order),
        quaternion=tuple(product(start[:4], turn)), omega=tuple(start[4 + i] for i in order),
        t_end=0.0, damping=tuple(damping[i] for i in order), general=general,
    )  # fmt: skip
    found = with_truth(problem, table)
    return replace(found, truth=[product(q, turn) for q in found.truth])


def true_motion(groups: list[str], folder: Path) -> Table:
    """The motion of these groups in quadruple precision."""
    output = f"&output columns = {', '.join(map(repr, COLUMNS))} /"
    method = "&integration method = 'taylor_quadruple' /"
    table = compute("trajectory", [*groups, output, method], folder)
    if not is_good_end(table.status):
        raise ProgramError(f"its reference ends with status {table.status}")
    return table


def with_truth(problem: Problem, table: Table) -> Problem:
    """A problem with the attitudes at the last samples of its motion, and the exact end."""
    rows = table.rows[COLUMNS].to_numpy(float)[-problem.samples :].tolist()
    return replace(problem, truth=[row[:4] for row in rows], t_end=rows[-1][-1])


def compute(kind: str, groups: list[str], folder: Path) -> Table:
    """The table of a study of an input of these groups."""
    path = folder / "question.nml"
    path.write_text("\n".join([f"&study kind = '{kind}' /", *groups, ""]), encoding="utf-8")
    call("--quiet", "-o", folder, path, allowed=SOME_FAILED)
    return read_table(folder / "question.csv")


def choose_axes(
    inertia: list[float], weight: list[float], damping: list[float]
) -> tuple[tuple[int, int, int], tuple[float, ...]]:
    """Which body axes to call x, y and z, and the turn of the axes: z is that of symmetry."""

    def is_axis(k: int) -> bool:
        i, j = (k + 1) % 3, (k + 2) % 3
        alike = math.isclose(inertia[i], inertia[j], rel_tol=ALIKE)
        return alike and not any((weight[i], weight[j], *damping))

    k = next(filter(is_axis, (2, 0, 1)), 2)
    return ((k + 1) % 3, (k + 2) % 3, k), TO_Z[k]
