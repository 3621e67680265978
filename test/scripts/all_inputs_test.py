"""scripts/run on every supplied input: its exit code, its tables, its figures.

Studies of methods are computed with fewer settings, and the largest sweep with fewer cases.
"""

import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest

from conftest import ROOT, execute
from spintop_figures.registry import FIGURES
from spintop_figures.tables.names import words_of
from spintop_figures.tables.table import read_table
from supplied_inputs import COMPARISONS, FAILING, INPUTS, LARGEST, NEEDS_FLINT, check_tables

pytestmark = pytest.mark.slow

FOLDER = "deep/er/fold er"
WITHOUT_FIGURES = {
    "intermediate_axis": "its columns are those that one looks at beside the exact period",
    "long_drift": "its figure compares it with other methods",
}
"""Inputs to whose tables no figure belongs, and why."""
NO_FIGURE = ": no figure belongs to its columns"
FAILED, REFUSED = 3, 2


class Group(NamedTuple):
    inputs: list[Path]
    settings: tuple[str, ...] = ()
    code: int = 0

    def run(self, folder: Path) -> subprocess.CompletedProcess:
        settings = [f"--set={setting}" for setting in self.settings]
        words = (ROOT / "scripts/run", "--quiet", "-o", FOLDER, *settings, *self.inputs)
        return execute(*words, code=None, cwd=folder, timeout=1200)


def group_all() -> list[Group]:
    everything = sorted((ROOT / "input").glob("*.nml"))
    texts = {path: path.read_text(encoding="utf-8") for path in everything}
    studies = {kind: [path for path in everything if kind in texts[path]] for kind in COMPARISONS}
    few = "repeats=1", "tolerances=1e-4,1e-8", "steps=200,400"
    apart = {*FAILING, LARGEST, *NEEDS_FLINT}
    return [
        Group([path for path in INPUTS if path.stem not in apart]),
        Group(studies["kind = 'work_precision'"], tuple(f"work_precision.{one}" for one in few)),
        Group(studies["kind = 'benchmark'"]),
        Group(
            studies["kind = 'stability'"],
            ("stability.cases=slow_top,sleeping_above", "stability.methods=rk4,taylor,dop853"),
        ),
        Group([path for path in everything if path.stem == LARGEST], ("sweep.count=30000",)),
        Group([path for path in everything if path.stem in FAILING], code=FAILED),
        Group([path for path in everything if path.stem in NEEDS_FLINT]),
    ]


BESIDE = ("", ".events", ".residuals", ".statistics")


def test_all(folder):
    groups = group_all()
    inputs = [path for group in groups for path in group.inputs]
    assert sorted(inputs) == sorted((ROOT / "input").glob("*.nml"))
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda group: group.run(folder), groups))
    if "FLINT" in results[-1].stderr:  # which this build does not have
        assert results.pop().returncode == REFUSED
        groups.pop()
    place = folder / FOLDER
    drawn = {path.name for path in place.glob("*.png")}
    for group, result in zip(groups, results, strict=True):
        assert result.returncode == group.code, result.stderr
        told = [line for line in result.stderr.splitlines() if "scripts/plot: " in line]
        assert [line for line in told if not line.endswith(NO_FIGURE)] == []
        for path in group.inputs:
            tables = [f"{path.stem}{ending}" for ending in BESIDE]
            figures = {f"{table}_{kind.name}.png" for table in tables for kind in FIGURES} & drawn
            assert (not figures) == (path.stem in WITHOUT_FIGURES), path.stem
    for path in place.glob("*.png"):
        assert path.stat().st_size > 5000, path
        assert path.with_suffix(".svg").stat().st_size > 5000, path
    check_words(place, [path for group in groups[1:4] for path in group.inputs])
    known = {path.stem for path in INPUTS} | {*FAILING}
    for path in place.glob("*.csv"):
        if path.stem.split(".")[0] not in known:
            path.unlink()
    output = "".join(result.stdout for result in results)
    check_tables([path for path in inputs if path.stem in known], place, output)


def check_words(folder: Path, scenes: list[Path]) -> None:
    """Columns of words, as the registry has them, hold words; all others hold numbers."""
    seen: dict[str, bool] = {}
    for scene in scenes:
        table = read_table(folder / f"{scene.stem}.csv")
        words = words_of(table.kind)
        for name in table.rows:
            assert table.numeric(name) == (name not in words), f"{scene.stem}: {name}"
            if name in words:
                seen[name] = seen.get(name, False) or table.has_words(name)
    assert [name for name, is_word in seen.items() if not is_word] == []
