"""Random inputs of all kinds of study: each ends within its budget, with a status that is true."""

import itertools
import math
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

from conftest import EXE, Run, Spin
from random_inputs import PAPER, plausible_input

INPUTS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))
FIRST = int(os.environ.get("SPINTOP_FIRST_SEED", "1"))
KEPT = os.environ.get("SPINTOP_KEEP", "")
"""A folder for a list of what is wrong that grows as it is found."""
BATCH = 40
ANY = tuple(range(-64, 256))
PATIENCE = 900
"""Seconds after which a batch hangs; it takes one or two."""

ALLOWED = 100.0
"""So many times tolerance and conditioning a row that is `ok` may be off."""
EPSILON = 2.0**-53
CHANGES = 1e-7, 1e-11
"""Changes of a rate, rad/s, to show how errors grow: where a motion falls twice, small ones do."""
INSTANTS = 9
"""Instants of a motion at which one is changed."""
ATTITUDE = ("q0", "q1", "q2", "q3")
VELOCITY = ("omega1", "omega2", "omega3")
POLE = 1e-7
"""Closer to a pole than this, rad, angles and their rates need not exist."""
AT_POLE = re.compile(r"(phi|psi|theta)(_rate)?|R[12]|force_[rn]|axis_z_rate")
"""Columns that need not be numbers at a pole."""

TOLERANCES = {"ode45": (1e-3, 1e-6), "taylor_quadruple": (1e-26, 1e-29)}
"""Relative and absolute tolerances of methods whose defaults are their own."""


class Outcome:
    """A table that was written for an input."""

    def __init__(self, path: Path) -> None:
        run = Run(0, "", "", path)
        self.rows = run.texts.to_dict("records")
        self.head = "\n".join(f"# {line}" for line in run.comments)
        status = re.findall(r"^# status: (\w+)", self.head, re.M)
        self.status = status[-1] if status else ""

    def setting(self, name: str) -> str:
        match = re.search(rf"^#\s+{name} = (.*)$", self.head, re.M)
        return match[1].strip("' ") if match else ""


def tolerance_of(table: Outcome) -> float:
    """The tolerance of a table's computation; infinite where it has none."""
    method = re.search(r"^# method: (\w+)", table.head, re.M)
    name = method[1] if method else table.setting("method")
    if name == "exact":
        return EPSILON
    if table.setting("steps") or table.setting("step"):
        return math.inf
    relative, absolute = TOLERANCES.get(name, (1e-9, 1e-12))
    relative = float(table.setting("relative_tolerance") or relative)
    absolute = float(table.setting("absolute_tolerance") or absolute)
    if not re.search(r"relative tolerance", table.head) and name not in TOLERANCES:
        return math.inf
    return max(relative, absolute, EPSILON)


def closeness_of(table: Outcome) -> float:
    """How near the pole a motion comes whose angles are stepped; 1 for other formulations.

    An error of such an angle is the larger the nearer the axis is to the vertical.
    """
    model = re.search(r"^# model: (\w+)", table.head, re.M)
    if model is None or model[1] not in PAPER:
        return 1.0
    start = table.setting("theta")
    thetas = [*(row.get("theta") for row in table.rows), start]
    return max(min((abs(math.sin(float(text))) for text in thetas if text), default=1.0), 1e-16)


def run_exactly(folder: Path, text: str, settings: dict[str, str]) -> list[dict[str, float]]:
    """Quaternion and angular velocity of an exact motion, row by row; none where it is refused."""
    options = (f"{key}={value}" for key, value in settings.items())
    path = Spin(folder)(text, *options, "--output=.", name="changed", code=ANY).path
    if not path.exists():
        return []
    rows = [{key: float(cell) for key, cell in row.items()} for row in Outcome(path).rows]
    path.unlink()
    return rows


def turn_between(one: dict[str, float], other: dict[str, float]) -> float:
    """The rotation angle between two attitudes, rad."""
    a, b = ([row[name] for name in ATTITUDE] for row in (one, other))
    return 2 * min(math.dist(a, b), math.dist(a, [-q for q in b]))


def growth_of(folder: Path, name: str, case: dict[str, str] | None = None) -> float:
    """How far a change on the way turns a motion later, per part of the change, by exact motions.

    `inherent_error` is of changes of the start, and leaves a rate that is 0 as it is. The error of
    a step is made at any time; where a motion comes back to an unstable equilibrium those made
    between grow most. `case` are the parameters of a row of a sweep.
    """
    text = (folder / name).read_text(encoding="utf-8")
    for group in ("integration", "output", "statistics", "sweep", "study"):
        text = re.sub(rf"^&{group}\n.*?^/\n", "", text, flags=re.M | re.S)
    columns = ", ".join(f"'{column}'" for column in ("t", *ATTITUDE, *VELOCITY))
    text += "&study kind = 'trajectory' /\n&integration method = 'exact' /\n"
    text += f"&output columns = {columns} /\n"
    settings = {**(case or {}), "span.samples": str(INSTANTS)}
    motion = run_exactly(folder, text, settings)
    if not motion or any(map(math.isnan, motion[-1].values())):
        return 1.0
    # Parts of the motion, each as one of its own.
    parts = re.sub(r"^&(initial|span)\n.*?^/\n", "", text, flags=re.M | re.S)
    still = {key: value for key, value in settings.items() if key.startswith("top.")}
    growth = 0.0
    for begin, state in enumerate(motion[:-1]):
        span = f"&span t_end = {motion[-1]['t'] - state['t']!r} samples = {INSTANTS - begin} /\n"
        attitude = ", ".join(repr(state[key]) for key in ATTITUDE)
        unchanged: list[dict[str, float]] = []
        for change, axis in ((0.0, 0), *itertools.product(CHANGES, range(3))):
            omega = [state[key] for key in VELOCITY]
            omega[axis] += change
            rates = ", ".join(map(repr, omega))
            start = f"&initial quaternion = {attitude} omega = {rates} /\n"
            rows = run_exactly(folder, parts + start + span, still)
            unchanged = unchanged or rows
            for one, other in zip(unchanged, rows, strict=False):
                if change > 0:
                    growth = max(growth, turn_between(one, other) / change)
    return growth


def is_symmetric(table: Outcome) -> bool:
    inertia = table.setting("inertia").split(", ")
    return len(set(inertia[:2])) < 2 and not table.setting("damping")


def faults_of(table: Outcome, growth: Callable[[dict[str, str]], float]) -> list[str]:
    """Errors in the rows of a table with status ok."""
    faults = []
    tolerance = tolerance_of(table) / closeness_of(table)
    for number, row in enumerate(table.rows):
        if (row.get("status") or table.status or "ok") != "ok":
            continue
        theta = float(row.get("theta") or "nan")
        at_pole = min(abs(theta), abs(math.pi - theta)) < POLE
        for name, text in row.items():
            if text.lstrip("-") not in ("nan", "inf") or row.get("notes"):
                continue
            if text == "inf" and name.endswith("_bound"):  # nothing is claimed
                continue
            if name == "upright_growth" and not is_symmetric(table):
                continue
            if not (at_pole and AT_POLE.fullmatch(name)):
                faults.append(f"{name} is {text} in row {number}")
        error, floor = (row.get(name, "nan") for name in ("orientation_error", "inherent_error"))
        if row.get("reference") or "nan" in (error, floor):
            continue
        conditioning = float(floor) / EPSILON
        bound = ALLOWED * (tolerance * conditioning + 1e-15)
        if float(error) > bound and bound < 1:
            conditioning = max(float(floor) / EPSILON, growth(row))
            bound = ALLOWED * (tolerance * conditioning + 1e-15)
        if float(error) > bound and bound < 1:
            faults.append(f"orientation_error is {error} in row {number}, beyond {bound:.2g}")
    return list(dict.fromkeys(faults))[:3]


class Growth:
    """The growth of errors in a row of a table; the rows of a trajectory share it."""

    def __init__(self, folder: Path, name: str) -> None:
        self.folder, self.name = folder, name
        self.known: dict[tuple, float] = {}

    def __call__(self, row: dict[str, str]) -> float:
        case = {key: cell for key, cell in row.items() if "." in key}
        key = tuple(case.items())
        if key not in self.known:
            self.known[key] = growth_of(self.folder, self.name, case)
        return self.known[key]


def test_inputs(tmp_path: Path) -> None:
    """Inputs that are accepted come to a good end: codes, statuses, numbers, errors."""
    faults: list[str] = []
    accepted, seed = 0, FIRST
    while accepted < INPUTS:
        folder = tmp_path / str(seed)
        folder.mkdir()
        spin = Spin(folder)
        for number in range(seed, seed + BATCH):
            spin.write(plausible_input(EXE, number), f"{number}.nml")
        good, problems = run_batch(spin, range(seed, seed + BATCH))
        faults += problems
        if KEPT and problems:
            Path(KEPT).mkdir(parents=True, exist_ok=True)
            with (Path(KEPT) / "faults").open("a", encoding="utf-8") as file:
                file.writelines(f"{problem}\n" for problem in problems)
        accepted += good
        seed += BATCH
        shutil.rmtree(folder)
    assert not faults, f"{len(faults)} of {accepted} are wrong:\n" + "\n".join(faults[:200])


def run_batch(spin: Spin, numbers: range) -> tuple[int, list[str]]:
    """Run some inputs; give how many were accepted, and what is wrong."""
    wrong = refused(spin, [f"{number}.nml" for number in numbers])
    names = [f"{number}.nml" for number in numbers if f"{number}.nml" not in wrong]
    run = spin.call("--quiet", "-o", ".", *names, code=ANY, timeout=PATIENCE)
    faults = []
    if run.code not in (0, 3) or "rror:" in run.stderr:
        faults = [f"{names[0]} ... {names[-1]}: exit code {run.code}: {run.stderr[-600:]}"]
    for name in names:
        path = spin.folder / name.replace(".nml", ".csv")
        if not path.exists():
            faults.append(f"{name}: no table")
            continue
        table = Outcome(path)
        found = faults_of(table, Growth(spin.folder, name))
        faults += [f"{name}: {fault}" for fault in found]
    return len(names), faults


def refused(spin: Spin, names: list[str]) -> set[str]:
    found: set[str] = set()
    while True:
        rest = [name for name in names if name not in found]
        run = spin.call("--check", *rest, code=(0, 2), timeout=PATIENCE)
        if run.code == 0:
            return found
        more = set(re.findall(r"^(\d+\.nml)[:\d]*: error:", run.stderr, re.M))
        assert more, run.stderr
        found |= more
