"""The inputs that come with the program, and checks of their tables."""

import csv
import re
from pathlib import Path

from conftest import KIND, ROOT

COMPARISONS = "kind = 'stability'", "kind = 'work_precision'", "kind = 'benchmark'"
"""These take long: other tests run parts of them."""
NEEDS_FLINT = {"certified_top", "uncertain_top"}
"""Builds without FLINT refuse these: `proof_test` runs them."""

INPUTS = [
    path
    for path in sorted((ROOT / "input").glob("*.nml"))
    if path.stem not in NEEDS_FLINT and not any(kind in path.read_text() for kind in COMPARISONS)
]
# A build that is not optimised takes minutes for these: there they are computed with less.
LESS = {
    "long_drift": ("nutations = 1000000", "nutations = 1000"),
    "million_spins": ("count(1) = 1000000", "count(1) = 10000"),
    "spin_tilt_statistics": ("cases = 100000", "cases = 2000"),
}
LARGEST = "million_spins"  # a table of half a gigabyte, too much to be read here in any build
WITHOUT_ROWS = {"nutation_indices", "spin_tilt_statistics"}
FAILING = {"slow_top_scenario1"}  # ends at its turning point, with exit code 3


def with_less(scene: Path, folder: Path) -> Path:
    """The input, or a copy in a folder that is computed sooner."""
    if scene.stem not in LESS or (KIND == "release" and scene.stem != LARGEST):
        return scene
    text, copy = scene.read_text(encoding="utf-8"), folder / scene.name
    assert LESS[scene.stem][0] in text
    copy.write_text(text.replace(*LESS[scene.stem]), encoding="utf-8")
    return copy


def check_tables(inputs: list[Path], folder: Path, output: str) -> None:
    """Each input has its table, and each table is whole."""
    tables = [path.name for path in folder.glob("*.csv")]
    endings = (".events.csv", ".histogram.csv", ".indices.csv", ".residuals.csv")
    beside = [name for name in tables if name.endswith(endings)]
    fits = ("fit", "inclinometer", "mounted_sensor", "spin_down", "tip_camera")
    expected = [f"{fit}.residuals.csv" for fit in fits]
    expected += ["nutation_indices.histogram.csv", "nutation_indices.indices.csv"]
    expected += ["slow_top_events.events.csv", "spin_tilt_statistics.histogram.csv"]
    assert sorted(beside) == sorted(expected)
    assert len(tables) - len(beside) == len(inputs)
    for scene in inputs:
        assert f"{scene}: " in output
        check_table(folder, scene.stem)


def check_table(folder: Path, stem: str) -> None:
    """A table is whole, and its header describes its columns."""
    path = folder / f"{stem}{'.statistics' * (stem in WITHOUT_ROWS)}.csv"
    text = path.read_text(encoding="utf-8")
    assert text.endswith("\n"), stem
    lines = text.splitlines()
    if lines[-1].startswith("# end: "):  # table_end_test checks it
        lines.pop()
    names, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    header = [line[2:] for line in lines[:first]]
    has_date = any(line.startswith("date") for line in header)
    assert len(names) == len(set(names)), stem
    assert {len(row) for row in rows} <= {len(names)}, stem
    described = [line.split()[0].rstrip(":") for line in header[header.index("columns:") + 1 :]]
    assert described == names, stem
    if "status" in names:
        place, case = names.index("status"), names.index("case")
        assert {row[place] for row in rows} == {"ok"}, stem
        assert [float(row[case]) for row in rows] == list(range(1, len(rows) + 1)), stem
        assert not has_date, stem
    elif stem in WITHOUT_ROWS:
        place = names.index("bin")
        assert [float(row[place]) for row in rows] == list(range(len(rows))), stem
        assert not has_date, stem
    elif stem in FAILING:
        assert re.search(r"^# status: turning_point at t = 1\.1929502", lines[-1]), stem
    else:
        assert re.search(r"^# status: (ok|at_rest at t = [0-9.]+)$", lines[-1]), stem
        assert any(line.startswith("date: ") for line in header), stem
