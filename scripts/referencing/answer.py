"""What the program says of an input: its data, its numbers and their bounds."""

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from program import ProgramError, call

SETTINGS = {
    "output.certified": ".true.",
    "integration.method": "taylor_quadruple",
    "integration.relative_tolerance": "1e-28",
}
"""Proved numbers are certified, all others in quadruple precision."""
OWN_GROUPS = [
    "&integration  method = 'taylor_quadruple'  relative_tolerance = 1e-28 /",
    "&output   columns = 't', 'q0', 'q1', 'q2', 'q3', 'omega1', 'omega2', 'omega3'",
    "          certified = .true. /",
]
"""The same as groups of the input in the header of a table."""
COLUMNS = ["t", "q0", "q1", "q2", "q3", "omega1", "omega2", "omega3"]
"""The columns that are compared as they are."""
COMPARED = ["kinetic", "com_z", "lz", "force_x", "force_y", "force_z"]
"""Columns that are compared with numbers of the second computation."""
BOUNDED = ("orientation", "omega1", "omega2", "omega3")
"""Numbers of which the set takes a bound, if this version of the program has it."""


@dataclass(frozen=True)
class Answer:
    """The table of an input."""

    title: str
    given: list[str]
    """The lines of the input, with the settings: other versions of the program resolve others."""
    data: dict[str, Any]
    """The body and the effects: numbers, lists and a matrix."""
    initial: dict[str, Any]
    """The start."""
    columns: dict[str, list[float]]

    def is_proved(self, name: str) -> bool:
        """Whether each row has a finite bound of a number."""
        bounds = self.columns.get(f"{name}_bound", [float("inf")])
        return max(bounds) < float("inf")


def answer_of(path: Path) -> Answer:
    """Compute an input with all bounds."""
    known = {line.split()[0] for line in call("list", "columns").splitlines() if line[:2] == "  "}
    bounds = [f"{name}_bound" for name in BOUNDED if f"{name}_bound" in known]
    settings = SETTINGS | {"output.columns": ",".join([*COLUMNS, *COMPARED, *bounds])}
    given = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    with tempfile.TemporaryDirectory() as folder:
        call("--output", folder, *given, str(path))
        text = (Path(folder) / f"{path.stem}.csv").read_text(encoding="utf-8")
    head = [line[2:] for line in text.splitlines() if line.startswith("# ")]
    rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    numbers = (list(map(float, column)) for column in zip(*rows[1:], strict=True))
    columns = dict(zip(rows[0], numbers, strict=True))
    resolved = [line[4:] for line in head[head.index("input:") + 1 : head.index("columns:")]]
    groups = groups_of(resolved)
    source = path.read_text(encoding="utf-8").splitlines()
    given = [line for line in source if not line.startswith("!")] + OWN_GROUPS
    return Answer(groups["study"]["title"], given, data_of(groups), groups["initial"], columns)


def groups_of(lines: Sequence[str]) -> dict[str, dict[str, Any]]:
    """The groups of a resolved input: keys with a number, a list or a text."""
    groups: dict[str, dict[str, Any]] = {}
    for name, inside in re.findall(r"(?ms)^&(\w+)\n(.*?)^/", "\n".join(lines) + "\n"):
        found = re.findall(r"(?ms)^ {4}(\w+(?:\([\d:,]*\))?) = (.*?)(?=^ {4}\w|\Z)", inside)
        groups[name] = {key: value_of(text) for key, text in found}
    return groups


def value_of(text: str) -> Any:
    """A value of a resolved input."""
    text = text.strip()
    if text[0] in "'\"":
        return text[1:-1].replace(text[0] * 2, text[0])
    if text[0] == ".":
        return text == ".true."
    numbers = [float(part) for part in text.split(",")]
    return numbers if len(numbers) > 1 else numbers[0]


def data_of(groups: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """The numbers of the body and of the effects; the inertia as a matrix."""
    top = groups["top"]
    if top["inertia_about"] != "pivot":
        raise ProgramError("the set takes moments of inertia about the pivot")
    if "inertia" in top:
        inertia = [[top["inertia"][i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    else:
        rows = [(1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)]
        tensor = {place: tensor_element(top, *place) for place in rows}
        inertia = [[tensor[min(i, j), max(i, j)] for j in (1, 2, 3)] for i in (1, 2, 3)]
    centre = top.get("centre_of_mass", [0.0, 0.0, top.get("length", 0.0)])
    body = {"mass": top["mass"], "gravity": top["gravity"], "inertia": inertia}
    effects = {key: value for key, value in groups.get("effects", {}).items()}
    return {**body, "centre_of_mass": centre, "damping": top["damping"], **effects}


def tensor_element(top: dict[str, Any], i: int, j: int) -> float:
    """An element of an inertia tensor, given alone or in a row."""
    single = top.get(f"inertia_tensor({i},{j})")
    return single if single is not None else top[f"inertia_tensor({i},:)"][j - 1]
