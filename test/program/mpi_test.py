"""Sweeps shared out among the ranks of MPI: the same bytes, and nothing that can be lost."""

import os
import re
import shlex
import signal
from contextlib import suppress
from pathlib import Path

import pytest

from conftest import GOOD, MPI, MPI_EXE, ROOT, each, needs_mpi, needs_netcdf, under, wait_until
from indices_test import FAILING
from netcdf_test import GRID, LONG
from slow_sweep import FAST, SLOW, STEPPING, STEPS, Sweep, undisturbed
from statistics_test import BARE, MAP

pytestmark = [pytest.mark.slow, needs_mpi]

MANY = f"steps = {4 * int(STEPS.split()[-1])}"
SLOWER = SLOW.replace(STEPS, MANY)


def ranked(spin, *words, ranks=3, code=0):
    return spin.call(*words, command=under(ranks), environment=MPI, code=code)


def by_ranks(spin, text):
    """A sweep under three ranks, whose table is that of the program without MPI."""
    sweep = Sweep(spin, text)
    sweep.options = {"command": under(3), "environment": MPI}
    return sweep


@pytest.fixture
def slow(spin):
    return by_ranks(spin, SLOW)


@pytest.fixture
def slower(spin):
    """One that is not over when the launcher has ended its ranks."""
    return by_ranks(spin, SLOWER)


def writers(spin):
    """The ranks that run in the folder: by process number, whether it is the writer."""
    found = {}
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                here = (process / "cwd").readlink() == spin.folder.resolve()
                if here and (process / "exe").readlink() == Path(MPI_EXE).resolve():
                    found[int(process.name)] = writes(process)
            except (FileNotFoundError, PermissionError, ProcessLookupError):
                continue
    return found


def writes(process):
    """Whether a process has the table open, while it opens and closes others."""
    for file in (process / "fd").iterdir():
        with suppress(FileNotFoundError):
            if str(file.readlink()).endswith(".csv.part"):
                return True
    return False


def axis(count, text=SLOW):
    return text.replace("count(1) = 1000", f"count(1) = {count}")


def as_netcdf(text):
    return text.replace("&output", "&output format = 'netcdf', ")


TILTS = "200, parameter(2) = 'initial.theta_deg', values(2,:) = 0, 20, 30, 40, 50"


@each(
    "text, cases, code",
    # Blocks of many cases that cost little, and of few.
    (axis(40001, FAST), 40001, 0),
    (axis(20001).replace(STEPS, "steps = 10"), 20001, 0),
    # ARKODE is set up by each rank for itself, though SUNDIALS may have MPI in it.
    (axis(301).replace(STEPPING, "formulation = 'lagrange', method = 'arkode_erk'"), 301, 0),
    # Some ranks find nothing to do.
    (axis(3, FAST), 3, 0),
    # The exit code of failing cases is that of the run.
    (axis(TILTS).replace("theta_deg = 20", "").replace(STEPS, "steps = 10"), 1000, 3),
    # Statistics, with rows and without, and indices; NetCDF.
    (MAP, 800, (0, 3)),
    (BARE, 0, (0, 3)),
    (FAILING, 400, (0, 3)),
    pytest.param(as_netcdf(GRID), 0, 3, marks=needs_netcdf),
    pytest.param(as_netcdf(LONG), 0, 0, marks=needs_netcdf),
)
def test_same_bytes(spin, text, cases, code):
    """The tables of any ranks and threads are that of the program without MPI."""
    alone, output = spin(text, "--output=alone", code=code).path.parent, spin.folder / "output"
    whole = {path.name: path.read_bytes() for path in alone.iterdir() if path.suffix != ".log"}
    assert max(content.count(b"\n") for content in whole.values()) > cases
    for ranks, threads in ((1, 1), (2, 1), (4, 1), (3, 2)):
        words = ("scene.nml", "--verbose", "--threads", str(threads))
        run = ranked(spin, *words, ranks=ranks, code=code)
        for name, content in whole.items():
            assert (output / name).read_bytes() == content, name
        assert (output / "scene.log").read_text(encoding="utf-8") == run.out
        team = f"{ranks} ranks x {threads} threads" if ranks > 1 else f"{threads} threads"
        assert f" s on {team}, " in run.out
        assert {path.name for path in output.iterdir()} == {*whole, "scene.log"}


def test_several_inputs_and_parts(spin, slow):
    """One sweep after the other; a part of one is shared out like a whole."""
    alone = spin(FAST, "--output=alone", name="fast").path.read_bytes()
    ranked(spin, "fast.nml", slow.name, "--threads", "1")
    whole = undisturbed(SLOW)["slow.csv"]
    assert slow.read(slow.table) == whole
    assert slow.read("output/fast.csv") == alone
    for part in (1, 2):
        slow("--threads", "1", "--shard", f"{part}/2")
    merged = ranked(spin, "merge", "m.csv", *sorted(spin.folder.glob("output/*-of-2.csv")))
    assert merged.out == "2 parts, 1000 cases -> m.csv\n"
    assert slow.read("m.csv") == whole


def test_under_slurm(spin, slow):
    (spin.folder / "bin").mkdir()
    for name, body in (
        ("sbatch", 'until [[ $1 = */slurm_sweep.sh ]]; do shift; done; "$@" >log 2>&1; echo 17'),
        ("srun", 'exec mpirun -np 2 "${@:2}"'),
    ):
        spin.write(f"#!/usr/bin/env bash\n{body}\n", f"bin/{name}")
        (spin.folder / "bin" / name).chmod(0o755)
    path = f"{spin.folder / 'bin'}:{os.environ['PATH']}"
    script = (ROOT / "scripts/slurm_sweep.sh",)
    environment = MPI | {"PATH": path, "SPINTOP_EXE": MPI_EXE}
    spin.call(slow.name, "mpi", "--ntasks=2", command=script, environment=environment)
    assert " s on 2 ranks x 1 threads, " in (spin.folder / "log").read_text()
    slow.check()


@each("kill_writer", True, False)
def test_a_rank_is_killed(spin, slower, kill_writer):
    """All end; what is journalled is taken over, with ranks or without, to the same bytes."""
    with slower.start() as run:
        slower.wait(run, 1)
        victims = sorted(pid for pid, writer in writers(spin).items() if writer is kill_writer)
        assert len(victims) == (1 if kill_writer else 2)
        os.kill(victims[0], signal.SIGKILL)
        assert run.wait(timeout=300) != 0
        wait_until(lambda: not writers(spin))
    rows = slower.rows
    assert rows > 0
    assert slower.table not in spin.produced()
    slower.options = {"command": under(2), "environment": MPI} if kill_writer else {}
    said = slower("--threads", "1", "--resume", "--progress")
    # In the progress, in the summary, and nowhere else.
    assert said.count(f"resumes after {rows} rows of an interrupted run") == 2
    slower.check()


def test_the_launcher_is_stopped(spin, slower):
    """SIGTERM to it ends all ranks, and nothing is lost; a complete table is left alone."""
    assert slower.interrupt(by=signal.SIGTERM)[0] != 0
    wait_until(lambda: not writers(spin))
    assert slower.rows > 0
    for said in (" rows of an interrupted run", "nothing was computed"):
        assert said in slower("--threads", "1", "--resume")
        slower.check()


def test_a_disk_that_fills_up(spin, slow, disk):
    """All ranks end, with exit code 4 and one message; with more room it goes on."""
    disk("256k")
    said = slow("-o", "disk", "--threads", "1", code=4)
    assert said.count("No space left on device") == 1
    assert said.count("slow.csv are kept; --resume resumes the run") == 1
    assert writers(spin) == {}
    disk("4m")
    slow("-o", "disk", "--threads", "1", "--resume")
    slow.check("disk")


@each(
    "words, said",
    (["bad.nml"], r"(?m)^1 error$"),
    (["slow.nml", "--thread", "1"], "unknown option"),
)
def test_wrong_input_and_usage(spin, slow, words, said):
    """An error has one message, with the same exit code as without MPI; nothing is computed."""
    spin.write(SLOW.replace("mass = 1.0", "mass = -1.0"), "bad.nml")
    run = ranked(spin, *words, code=2)
    assert len(re.findall(said, run.stderr)) == 1
    assert run.out == ""
    assert spin.produced() == set()


def test_a_file_where_the_folder_should_be(spin, slow):
    spin.write("", "output")
    assert slow(code=4).count("cannot make folder output") == 1


@each("words", ["--help"], ["list", "methods"], ["--check", "scene.nml"])
def test_what_one_process_does(spin, words):
    spin.write(GOOD)
    assert ranked(spin, *words).out == spin.call(*words).out


@each("scene, reason", ("missing.nml", "missing.nml"), ("other.nml", "rank 1: mass = 2"))
def test_ranks_that_are_not_alike(spin, slow, scene, reason):
    """Another input at one rank, or none: the error of that rank is everybody's."""
    spin.write(SLOW.replace("mass = 1.0", "mass = 2.0"), "other.nml")
    # Not `mpirun A : B`, which some releases of Open MPI 5 cannot start.
    rank = "${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-$PMI_RANK}}"
    choose = f'#!/bin/sh\n[ "{rank}" = 0 ] || shift\nexec {shlex.quote(MPI_EXE)} "$1"\n'
    unlike = spin.folder / spin.write(choose, "unlike")
    unlike.chmod(0o755)
    command = ("mpirun", "-np", "2", unlike, slow.name)
    run = spin.call(scene, command=command, environment=MPI, code=2)
    assert run.stderr.count(reason) == 1
    assert not list(spin.folder.rglob("*.csv*"))
