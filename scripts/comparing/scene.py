"""Problems from inputs of spintop: what others need to know is asked of the program itself."""

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

from comparing.problem import ALIKE, Problem, as_list, product
from program import SOME_FAILED, ProgramError, call
from spintop_figures.tables.names import is_good_end
from spintop_figures.tables.table import Table, read_head, read_table

SMALL = 0.01
"""Mass times distance squared over the least moment of inertia, where only the weight is known."""
GROUP = re.compile(r"^&(\w+)\n.*?^/\n", re.MULTILINE | re.DOTALL)
UPRIGHT = ((0.5, -0.5, -0.5, -0.5), (0.5, 0.5, 0.5, 0.5), (1.0, 0.0, 0.0, 0.0))
"""Turns of a body by which body x, y and z come to stand upright."""
TO_Z = ((0.5, 0.5, 0.5, 0.5), (0.5, -0.5, -0.5, -0.5), (1.0, 0.0, 0.0, 0.0))
"""Turns of the axes by which x, y and z come to bear the name z."""
ATTITUDE = ("q0", "q1", "q2", "q3")
REFERENCE = "&integration method = 'taylor_quadruple' /"
ONE_STEP = "&integration formulation = 'rigid_body' method = 'rk4' steps = 1 /"
"""For what is known at the start."""


@dataclass(frozen=True)
class Scene:
    """The groups of an input that say what moves, how it starts, and for how long."""

    name: str
    groups: list[str]
    damping: list[float]
    general: bool = False
    """Whether a symmetric top is computed as any other body."""


def read_scene(name: str, path: Path, overrides: list[str], general: bool = False) -> Scene:
    """Read an input as spintop resolves it."""
    settings = (part for text in overrides for part in ("--set", text))
    resolved = call("--check", *settings, "--", path)
    groups = {match[1]: match[0] for match in GROUP.finditer(resolved)}
    settings = read_head([line.strip() for line in resolved.splitlines()])[1]
    if any(key.startswith(("sweep.parameter", "sweep.table")) for key in settings):
        raise ProgramError("has a sweep: leave that out, and --set what it is to be")
    if "top" not in groups:
        raise ProgramError("has no top of its own")
    damping = [float(text) for text in settings["top.damping"]]
    span = re.sub(r"(?m)^ *samples *=.*\n", "", groups["span"])
    return Scene(name, [groups["top"], groups["initial"], span], damping, general)


def pose(scene: Scene, folder: Path) -> Problem:
    """The scene as a problem, its axis of symmetry turned to body z.

    The body is known by its energies in three attitudes, whatever shape the input gives: with body
    axis i upright and one radian a second about it the kinetic energy is I_i/2, and the potential
    energy m g r_i; these turns are exact in binary. The motion depends on m g r alone, so under
    unit gravity the mass may be as large, and the centre of mass as near to the fixed point, as one
    likes; a power of two is exact.
    """
    top, initial, _ = scene.groups
    inertia, weight = [], []
    for i, upright in enumerate(UPRIGHT):
        omega = [float(i == j) for j in range(3)]
        start = f"&initial quaternion = {as_list(upright)} omega = {as_list(omega)} /"
        kinetic, potential = ask_start([top, start], ("kinetic", "potential"), folder)
        inertia.append(2 * kinetic)
        weight.append(potential)
    order, turn = choose_axes(inertia, weight, scene.damping)
    start = ask_start([top, initial], (*ATTITUDE, "omega1", "omega2", "omega3"), folder)
    pull = math.hypot(*weight)
    mass = 2.0 ** math.ceil(math.log2(pull**2 / (SMALL * min(inertia)))) if pull else 1.0
    problem = Problem(
        name=scene.name, mass=mass, gravity=1.0,
        arm=tuple(weight[i] / mass for i in order), inertia=tuple(inertia[i] for i in order),
        quaternion=tuple(product(start[:4], turn)), omega=tuple(start[4 + i] for i in order),
        t_end=0.0, damping=tuple(scene.damping[i] for i in order), general=scene.general,
    )  # fmt: skip
    found = with_truth(problem, scene.groups, folder)
    return replace(found, truth=[product(q, turn) for q in found.truth])


def with_truth(problem: Problem, groups: list[str], folder: Path) -> Problem:
    """A problem with its truth in quadruple precision of these groups, and the exact end."""
    table = compute("trajectory", [*groups, ask_for((*ATTITUDE, "t")), REFERENCE], folder)
    if not is_good_end(table.status):
        raise ProgramError(f"its reference ends with status {table.status}")
    rows = table.rows[[*ATTITUDE, "t"]].to_numpy(float)[-problem.samples :].tolist()
    return replace(problem, truth=[row[:4] for row in rows], t_end=rows[-1][4])


def compute(kind: str, groups: list[str], folder: Path) -> Table:
    """The table of a study of an input of these groups."""
    path = folder / "question.nml"
    path.write_text("\n".join([f"&study kind = '{kind}' /", *groups, ""]), encoding="utf-8")
    call("--quiet", "-o", folder, path, allowed=SOME_FAILED)
    return read_table(folder / "question.csv")


def ask_start(groups: list[str], columns: tuple[str, ...], folder: Path) -> list[float]:
    """These columns at the start, as the equations of a rigid body have them."""
    groups = [*groups, "&span t_end = 1 /", ask_for(columns), ONE_STEP]
    return compute("trajectory", groups, folder).rows[list(columns)].iloc[0].tolist()


def ask_for(columns: tuple[str, ...]) -> str:
    """The group that asks for columns of a trajectory."""
    return f"&output columns = {', '.join(map(repr, columns))} /"


def choose_axes(
    inertia: list[float], weight: list[float], damping: list[float]
) -> tuple[tuple[int, int, int], tuple[float, ...]]:
    """Which body axes to call x, y and z, and the turn of the axes: z is that of symmetry."""
    for k in (2, 0, 1):
        i, j = (k + 1) % 3, (k + 2) % 3
        alike = math.isclose(inertia[i], inertia[j], rel_tol=ALIKE)
        if alike and not any((weight[i], weight[j], *damping)):
            return (i, j, k), TO_Z[k]
    return (0, 1, 2), TO_Z[2]
