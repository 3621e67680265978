"""Tables of sweeps read back: each parameter has the value of its case."""

import csv
import itertools
import math
import random
from collections.abc import Sequence
from pathlib import Path

import pytest

from conftest import each, netcdf_is_missing, read, wait_until
from spintop_figures.tables.table import read_table

SEED = 20121
CASES = 41  # of a table: a few blocks of cases that are computed one by one
EPSILON = 2.0**-52

# Every numeric key of a body in general, and between what its values are drawn.
ANY_BODY = {
    "top.mass": (0.5, 2),
    **{f"top.inertia({i})": (low, 1.2) for i, low in ((1, 0.8), (2, 0.8), (3, 0.5))},
    **{f"top.centre_of_mass({i})": (-x, x) for i, x in ((1, 0.1), (2, 0.1), (3, 0.5))},
    "top.gravity": (0, 20),
    **{f"top.damping({i})": (0, 0.1) for i in (1, 2, 3)},
    "initial.phi": (-9, 9),
    "initial.theta": (0.1, 3),
    "initial.psi": (-9, 9),
    "initial.phi_rate": (-2, 2),
    "initial.theta_rate": (-2, 2),
    "initial.omega3": (-5, 5),
    "span.t_end": (0.001, 0.02),
    "integration.relative_tolerance": (1e-9, 1e-6),
    "integration.absolute_tolerance": (1e-12, 1e-9),
}
# The same of a body with a tensor, whose names have a comma.
ANY_TENSOR = {
    **{name: ends for name, ends in ANY_BODY.items() if not name.startswith(("top.i", "top.d"))},
    **{f"top.inertia_tensor({i},{i})": (0.9, 1.2) for i in (1, 2, 3)},
    **{f"top.inertia_tensor({i},{j})": (-0.1, 0.1) for i, j in ((1, 2), (1, 3), (2, 3))},
}
# Those that leave a top whose motion is known in closed form.
LAGRANGE_TOP = [
    *("top.mass", "top.inertia(3)", "top.centre_of_mass(3)", "top.gravity", "span.t_end"),
    *(name for name in ANY_BODY if name.startswith("initial.")),
]
QUANTITIES = "'t_end', 'phi_end', 'theta_end', 'psi_end', 'theta_rate_end', 'evaluations'"
SCENE = f"""\
&study kind = 'sweep' /
&top mass = 1, inertia = 1, 1, 0.5, centre_of_mass = 0, 0, 0.5 /
&initial phi = 0, theta = 1, psi = 0, phi_rate = 0, theta_rate = 0, omega3 = 2 /
&span t_end = 0.01 /
&integration relative_tolerance = 1e-9, absolute_tolerance = 1e-12 /
&output columns = {QUANTITIES} /
&sweep table = 'cases.csv' /
"""
TENSOR = SCENE.replace(
    "inertia = 1, 1, 0.5",
    "inertia_tensor(1,:) = 1, 0, 0, inertia_tensor(2,2:3) = 1, 0, inertia_tensor(3,3) = 1",
)
# Parameters of axes: real ones and a whole one.
AXES = ("initial.theta", "top.mass", "initial.omega3", "integration.max_steps")


def spaced(first: float, last: float, count: int, logarithmic: bool) -> list[float]:
    parts = [k / max(1, count - 1) for k in range(count)]
    if logarithmic:
        values = [first * (last / first) ** part for part in parts]
    else:
        values = [first + (last - first) * part for part in parts]
    return [*values[:-1], last] if count > 1 else values


@pytest.fixture
def formats(spin):
    """The formats that the build has; a table of cases and its scene are there."""
    rows_of(spin, ["initial.theta"], [[1.0]])
    spin.write(SCENE)
    return ["csv"] if netcdf_is_missing() else ["csv", "netcdf"]


@pytest.fixture
def draws():
    return random.Random(SEED)


def rows_of(spin, names: Sequence[str], rows: Sequence[Sequence[float]]) -> None:
    quoted = [f'"{name}"' if "," in name else name for name in names]
    lines = [",".join(quoted), *(",".join(map(repr, row)) for row in rows)]
    spin.write("\n".join(lines) + "\n", "cases.csv")


def draw(draws, spin, names: Sequence[str], cases: int) -> list[list[float]]:
    ends = ANY_BODY | ANY_TENSOR
    rows = [[draws.uniform(*ends[name]) for name in names] for _ in range(cases)]
    rows_of(spin, names, rows)
    return rows


def sweep(spin, scene: str, *words: str, kind: str = "csv") -> Path:
    path = spin(scene, f"output.format={kind}", *words).path
    return path.with_suffix(f".{kind.replace('netcdf', 'nc')}")


def merged(spin, scene: str, parts: int, *words: str) -> bytes:
    tables = spin.parts(scene, parts, "output.format=csv", *words)
    path = spin.call("merge", "merged.csv", *tables, path="merged.csv").path
    table = path.read_bytes()
    path.unlink()
    return table


def parameters(path: Path, names: Sequence[str]) -> list[list[float]]:
    """The columns of parameters of a table, as rows; its cases are numbered in order."""
    rows = read_table(path).rows
    assert list(rows["case"]) == list(range(1, len(rows) + 1))
    assert list(rows.columns[1 : len(names) + 1]) == list(names)
    return [list(map(float, row)) for row in zip(*(rows[name] for name in names), strict=True)]


def body(path: Path, skip: int) -> list[str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.split(",", skip)[-1] for line in lines if not line.startswith("#")]


# Bodies of any kind; names with a comma, which stand in quotes; more cases than are computed at
# once in closed form.
TABLES = ((SCENE, list(ANY_BODY), CASES), (TENSOR, list(ANY_TENSOR), CASES))
TABLES += ((SCENE, LAGRANGE_TOP, 600),)


@each("text, known, cases", *TABLES, ids=("any", "tensor", "closed form"))
def test_each_column_is_that_of_the_table(spin, formats, draws, text, known, cases):
    """In both formats, of one column to as many as there are, in any order of the columns."""
    scene = spin.write(text)
    for width in range(1, len(known) + 1):
        names = draws.sample(known, width)
        rows = draw(draws, spin, names, cases)
        for kind in formats:
            path = sweep(spin, scene, "--threads=2", kind=kind)
            assert parameters(path, names) == rows, (width, kind)


def test_names_with_a_comma(spin, draws):
    """They stand in quotes, in tables of statistics, too, and in what is merged."""
    scene = spin.write(TENSOR, "tensor.nml")
    names = ["top.inertia_tensor(1,2)", "initial.psi"]
    rows = draw(draws, spin, names, CASES)
    settings = [f"statistics.over='{names[0]}'", "statistics.bins=2", "statistics.from=-0.1"]
    settings += ["statistics.to=0.1", f"statistics.columns='{names[0]}'"]
    whole = sweep(spin, scene, *settings)
    with whole.open(encoding="utf-8") as file:
        cells = list(csv.reader(line for line in file if not line.startswith("#")))
    assert cells[0][:4] == ["case", *names, "status"]
    assert [[float(cell) for cell in row[1:3]] for row in cells[1:]] == rows
    statistics = read(whole.with_suffix(".statistics.csv"))
    assert sum(statistics[f"{names[0]}_count"][1:]) == CASES
    assert set(read(whole.with_suffix(".histogram.csv")).column) == {names[0]}
    parts = merged(spin, scene, 2)
    assert sweep(spin, scene).read_bytes() == parts


def test_parts_threads_and_what_was_resumed(spin, formats, draws):
    """The same bytes, and those of the table, however the sweep is computed."""
    names = list(ANY_BODY)
    rows = draw(draws, spin, names, 300)
    whole = sweep(spin, "scene.nml", "--threads=1")
    assert parameters(whole, names) == rows
    expected = whole.read_bytes()
    for threads in (2, 3, 7):
        assert sweep(spin, "scene.nml", f"--threads={threads}").read_bytes() == expected
    assert merged(spin, "scene.nml", 3) == expected


def test_resumed(spin, formats, draws):
    names = list(ANY_BODY)
    spans = names.index("span.t_end")
    rows = draw(draws, spin, names, 2000)
    for row in rows:
        row[spans] *= 200
    rows_of(spin, names, rows)
    with spin.start("scene.nml", "--threads=1") as run:
        journal = spin.folder / "output/scene.csv.journal"
        wait_until(lambda: journal.exists() or run.poll() is not None, limit=30)
    path = sweep(spin, "scene.nml", "--threads=2", "--resume")
    assert parameters(path, names) == rows


def values_of(draws, name: str, kind: str, count: int) -> tuple[list[float], str]:
    """The values of an axis, and what the input says of it with `#` for its number."""
    whole = name == "integration.max_steps"
    if kind == "values":
        low, high = (500, 900) if whole else (0.5, 2.5)
        draw = draws.randint if whole else draws.uniform
        values = [draw(low, high) for _ in range(count)]
        return values, "values(#,:) = " + ", ".join(map(repr, values))
    logarithmic = kind == "log"
    if whole:
        # Whole numbers, as they must be.
        first, last = (1000, 1000 * 2 ** (count - 1)) if logarithmic else (500, 498 + 2 * count)
    else:
        first, last = draws.uniform(0.5, 1), draws.uniform(1.5, 2.5)
    text = f"from(#) = {first!r}, to(#) = {last!r}, count(#) = {count}"
    spacing = ", spacing(#) = 'log'" if logarithmic else ""
    return spaced(first, last, count, logarithmic), text + spacing


def scene_of(spin, combine: str, axes: Sequence[tuple[str, str]]) -> str:
    text = SCENE.replace("table = 'cases.csv' /", combine)
    for name, _ in axes:
        key = name.split(".")[1]
        if key == "max_steps":
            text = text.replace("&integration", "&integration max_steps = 1000,")
    for i, (name, said) in enumerate(axes, 1):
        text += f"    parameter({i}) = '{name}', {said.replace('#', str(i))}\n"
    return spin.write(text + "/\n", "axes.nml")


def check(
    spin, formats, scene: str, names: Sequence[str], expected: list[list[float]] | None
) -> None:
    """All formats, threads and parts give the cases expected, and their rows as a table do."""
    tables = {kind: sweep(spin, scene, "--threads=2", kind=kind) for kind in formats}
    rows = parameters(tables["csv"], names)
    if expected is not None:
        assert len(rows) == len(expected)
        for row, values in zip(rows, expected, strict=True):
            for value, wanted in zip(row, values, strict=True):
                # The library's powers may round otherwise.
                assert abs(value - wanted) <= 2 * EPSILON * abs(wanted)
    for path in tables.values():
        assert parameters(path, names) == rows
    rows_of(spin, names, rows)
    again = spin.write(SCENE.replace("&integration", "&integration max_steps = 1000,"))
    quantities = body(tables["csv"], len(names) + 1)
    assert body(sweep(spin, again), len(names) + 1) == quantities
    assert merged(spin, scene, 2, "--threads=1") == tables["csv"].read_bytes()


@each("axes", 1, 2, 3, 4)
@each("combine", "grid", "zip")
def test_grids_and_zips(spin, formats, draws, combine, axes):
    kinds = ("values", "linear", "log")
    for turn in range(len(kinds)):
        given = []
        for i, name in enumerate(draws.sample(AXES, axes)):
            count = 5 if combine == "zip" else draws.randint(1, 4)
            given.append((name, *values_of(draws, name, kinds[(turn + i) % len(kinds)], count)))
        values = [axis for _, axis, _ in given]
        cases = zip(*values, strict=True) if combine == "zip" else itertools.product(*values)
        scene = scene_of(spin, f"combine = '{combine}'", [(name, said) for name, _, said in given])
        names = [name for name, _, _ in given]
        check(spin, formats, scene, names, [list(case) for case in cases])


@each("axes", 1, 2, 3, 4)
@each("combine", "random", "latin_hypercube")
def test_drawn_cases(spin, formats, draws, combine, axes):
    """Between their ends, each value as the quantities of its case have it."""
    names = draws.sample(AXES, axes)
    ends = [(700, 900) if name == "integration.max_steps" else (0.5, 2.5) for name in names]
    given = []
    for i, (low, high) in enumerate(ends):
        spacing = ", spacing(#) = 'log'" if i % 2 else ""
        given.append((names[i], f"from(#) = {low}, to(#) = {high}{spacing}"))
    scene = scene_of(spin, f"combine = '{combine}', cases = 53, seed = 7", given)
    check(spin, formats, scene, names, None)
    for row in parameters(spin.folder / "output/axes.csv", names):
        for (low, high), value in zip(ends, row, strict=True):
            assert low <= value <= high
            assert math.isfinite(value)
