"""scripts/run draws the tables of its own run, which the program names (`--written`)."""

import os
import time
from pathlib import Path

from conftest import EXE, ROOT, execute

INPUTS = ROOT / "input"
FEW = ("--quiet", "--set", "span.samples=50")


def written(folder: Path, *arguments: str | Path, code: int = 0) -> list[str]:
    names = folder / "names"
    execute(EXE, "--written", names, "-o", folder, *arguments, code=code)
    paths = names.read_bytes().split(b"\0") if names.exists() else [b""]
    assert paths.pop() == b""
    names.unlink(missing_ok=True)
    return [Path(os.fsdecode(path)).name for path in paths]


def test_names(folder: Path) -> None:
    """Those of all runs that ended, each once a run; none of a run that could not be."""
    both = INPUTS / "slow_top_events.nml", INPUTS / "fit.nml"
    own = ["slow_top_events.csv", "slow_top_events.events.csv", "fit.csv", "fit.residuals.csv"]
    assert written(folder, *FEW, *both) == own
    failing = INPUTS / "slow_top_scenario1.nml"
    assert written(folder, *FEW, failing, code=3) == ["slow_top_scenario1.csv"]
    assert written(folder, "--set", "output.columns=nothing", both[0], code=2) == []
    assert written(folder, "--check", both[0]) == []
    part = written(folder, "--shard", "1/2", "--set", "sweep.cases=8", INPUTS / "random_tops.nml")
    assert part == ["random_tops.1-of-2.csv"]
    execute(EXE, "--written", folder / "no" / "names", "-o", folder, *FEW, both[0], code=4)


def test_tables_of_others(folder: Path) -> None:
    """A table that another run is writing, or has just written, is none of this one."""
    whole = folder / "whole.csv"
    execute(EXE, *FEW, "-o", folder, "--set", "output.file=whole", INPUTS / "slow_top.nml")
    (folder / "cut.csv").write_bytes(whole.read_bytes()[:3000])
    later = time.time() + 3600
    for path in folder.glob("*.csv"):
        os.utime(path, (later, later))
    execute(ROOT / "scripts/run", *FEW, "-o", folder, INPUTS / "tip_loop.nml")
    drawn = {path.stem for path in folder.glob("*.png")}
    assert "tip_loop_angles" in drawn
    assert not any(name.startswith(("cut", "whole")) for name in drawn)


def test_option(folder: Path) -> None:
    """--no-plots stands anywhere; behind -- there are inputs."""
    (folder / "--no-plots").write_bytes((INPUTS / "tip_loop.nml").read_bytes())
    run = ROOT / "scripts/run"
    execute(run, *FEW, "-o", folder, INPUTS / "tip_loop.nml", "--no-plots")
    assert not [*folder.glob("*.png")]
    execute(run, *FEW, "-o", folder, "--", "--no-plots", cwd=folder)
    assert [*folder.glob("*.png")]
