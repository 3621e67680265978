"""Files that a run writes: nothing is changed through links, nothing waited for or shared."""

import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT, each, merge, netcdf_is_missing, wait_until
from slow_sweep import SLOW, Sweep
from sweep_parts_test import BENCHMARK, PRECISION, STABILITY, TRAJECTORY

SWEEP = SLOW.replace("count(1) = 1000", "count(1) = 20")
STATISTICS = """
&output rows = {} /
&statistics columns = 'theta_max', 'status' over = 'initial.psi_rate' bins = 4 /
"""
NETCDF = "&output format = 'netcdf' /\n"
STUDIES = {
    "sweep": SWEEP,
    "sweep_netcdf": SWEEP + NETCDF,
    "sweep_packed_netcdf": SWEEP + NETCDF.replace("/", "compression = 4 /"),
    "statistics": SWEEP + STATISTICS.format("'none'"),
    "both": SWEEP + STATISTICS.format("'all'"),
    "both_netcdf": SWEEP + STATISTICS.format("'all' format = 'netcdf'"),
    "trajectory": TRAJECTORY + "&output events = 'theta_rate = 0', 'theta = 0.9' /\n",
    "trajectory_netcdf": TRAJECTORY + NETCDF,
    "work_precision": PRECISION,
    "stability": STABILITY,
    "benchmark": BENCHMARK,
    "fit": (ROOT / "input/fit.nml").read_text(encoding="utf-8"),
}
"""An input of every kind of study, and of every kind of table."""
LISTS = ("work_precision", "stability", "benchmark", "fit")
"""Those that are not resumed."""
NEW = (".part", ".journal.new", ".new")
"""Endings of the names under which files are written before they are complete."""
NO_LOCKS = """\
#include <errno.h>
int flock(int file, int operation) { (void)file; (void)operation; errno = ENOLCK; return -1; }
"""


def run_study(spin, kind, *options, code=0):
    if kind.endswith("netcdf") and (reason := netcdf_is_missing()):
        pytest.skip(reason)
    shutil.copy(ROOT / "input/fit.csv", spin.folder)
    return spin(STUDIES[kind], "--quiet", *options, name=kind, code=code)


def files_of_study(spin, kind):
    run_study(spin, kind)
    return sorted((spin.folder / "output").iterdir())


def plant(how, victim, path):
    path.unlink(missing_ok=True)
    match how:
        case "symbolic link":
            path.symlink_to(victim)
        case "hard link":
            path.hardlink_to(victim)
        case "FIFO":
            os.mkfifo(path)


@pytest.mark.slow
@each("kind", *STUDIES)
def test_every_file_that_is_written(spin, kind):
    """A link or a FIFO is refused at once with its name; what it leads to stays as it is."""
    ways = ("symbolic link", "hard link", "FIFO")[: 3 if kind in ("sweep", "both") else 1]
    files = files_of_study(spin, kind)
    shutil.rmtree(spin.folder / "output")
    (spin.folder / "output").mkdir()
    victim = spin.folder / "victim"
    victim.write_text("precious\n")
    again = () if kind in LISTS else ("--restart",)
    for path in files:
        refused = 0
        for name in (Path(f"{path}{ending}") for ending in NEW):
            for how in ways:
                plant(how, victim, name)
                run = run_study(spin, kind, *again, code=(0, 4))
                assert victim.read_text() == "precious\n", (name, how)
                if run.code:
                    assert name.name in run.stderr
                    assert re.search("link|FIFO", run.stderr)
                    assert os.path.lexists(name), (name, how)
                    refused += 1
                name.unlink(missing_ok=True)
        assert refused > 0, path


def test_targets(spin):
    """A table does not take the place of a FIFO or of a device, nor does a merged one."""
    parts = spin.parts(STUDIES["sweep"], 2)
    os.mkfifo(spin.folder / "fifo")
    if os.geteuid() == 0:
        subprocess.run(["mknod", spin.folder / "zero", "c", "1", "5"], check=True)
    for name in ("fifo", "zero")[: 2 if os.geteuid() == 0 else 1]:
        assert "not a file" in merge(spin, name, *parts, code=4)
        assert not (spin.folder / name).is_file()
    os.mkfifo(spin.folder / "output/sweep.csv")
    assert "FIFO" in run_study(spin, "sweep", code=4).stderr


def test_what_is_read(spin):
    """A FIFO as a part, a journal or a part of a merge is refused, not waited for."""
    table = run_study(spin, "sweep").path
    for endings in ((".part", ".journal"), (".journal",)):
        shutil.copy(table, f"{table}.part")
        paths = [Path(f"{table}{ending}") for ending in endings]
        for path in paths:
            path.unlink(missing_ok=True)
            os.mkfifo(path)
        assert "FIFO" in run_study(spin, "sweep", "--resume", code=(2, 4)).stderr
        for path in paths:
            path.unlink()
    os.mkfifo(spin.folder / "part.csv")
    assert "FIFO" in merge(spin, "all.csv", "part.csv", "part.csv", code=2)


@pytest.fixture
def slow(spin, preload):
    """A slow sweep on a file system without locks."""
    slow = Sweep(spin)
    slow.options = {"environment": preload(NO_LOCKS)}
    return slow


@pytest.mark.slow
def test_two_runs(slow):
    with slow.start() as first:
        slow.wait(first, 0)
        for words in ([], ["--resume"], ["--restart"]):
            said = slow(*words, code=4)
            assert "another run is writing it" in said
            assert ".lock" in said
        assert first.wait() == 0
    slow.check()


@pytest.mark.slow
def test_a_killed_run(slow):
    """What it leaves is named, and does not hold up the next when it is removed."""
    slow.interrupt()
    assert ".lock" in slow("--resume", code=4)
    (slow.spin.folder / "output/slow.csv.part.lock").unlink()
    slow("--resume")
    slow.check()


def test_a_signal(slow):
    slow.interrupt(by=signal.SIGTERM)
    assert "output/slow.csv.part.lock" not in slow.spin.produced()


@each("is_another", False, True)
def test_others_write_to_the_part(slow, is_another):
    """A part that was changed, or is another file, never becomes a table."""
    part = slow.spin.folder / "output/slow.csv.part"
    with slow.start() as run:
        wait_until(lambda: part.exists() and part.stat().st_size >= 2000)
        if is_another:
            (slow.spin.folder / slow.spin.write("mine\n", "mine")).rename(part)
        else:
            with part.open("a") as file:
                file.write("1,2,3\n")
        said = run.communicate(timeout=300)[1]
    assert run.returncode == 4, said
    assert "another program changed it" in said
    assert "output/slow.csv" not in slow.spin.produced()
    assert not is_another or part.read_text() == "mine\n"
