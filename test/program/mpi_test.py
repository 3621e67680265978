"""Sweeps shared out among the ranks of MPI: the same bytes, and nothing that can be lost."""

import os
import re
import shlex
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

import pytest

from conftest import EXE, GOOD, KIND, MPI, MPI_EXE, ROOT, needs_mpi, under, wait_until

pytestmark = [pytest.mark.slow, needs_mpi]

# For other suites that have ranks.
MPI_PROGRAM, ENVIRONMENT = MPI_EXE, MPI

# Long enough to be interrupted at any moment; a launcher takes its time to end its ranks.
STEPS = "steps = 8000" if KIND == "release" else "steps = 2000"
STEPPING = f"formulation = 'lagrange', method = 'rk4', {STEPS}"
SLOW = f"""\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 2 /
&integration {STEPPING} /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 1000 /
"""
FAST = SLOW.replace(STEPPING, "method = 'exact'")  # the same in closed form


def ranked(spin, *words, ranks=3, code=0):
    """Run the program under ranks of one thread each."""
    return spin.call(*words, command=under(ranks), environment=MPI, code=code)


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The table of the slow sweep from a build without MPI."""
    folder = tmp_path_factory.mktemp("reference")
    (folder / "slow.nml").write_text(SLOW)
    subprocess.run([EXE, "slow.nml", "-o", "."], cwd=folder, check=True, capture_output=True)
    return (folder / "slow.csv").read_bytes()


@pytest.fixture
def slow(spin):
    """The slow sweep."""
    return spin.write(SLOW, "slow.nml")


def check_complete(spin, reference, name="output/slow.csv"):
    """The table is that of an uninterrupted run, and nothing else is left of it."""
    path = spin.folder / name
    assert path.read_bytes() == reference
    left = sorted(p.name for p in path.parent.glob(f"{path.stem}*"))
    assert left == [path.name, f"{path.stem}.log"]


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
    """The sweep with another number of cases."""
    return text.replace("count(1) = 1000", f"count(1) = {count}")


TILTS = "200, parameter(2) = 'initial.theta_deg', values(2,:) = 0, 20, 30, 40, 50"


@pytest.mark.parametrize(
    ("text", "cases", "code"),
    [
        # Blocks of many cases that cost little, and of few.
        (axis(40001, FAST), 40001, 0),
        (axis(20001).replace(STEPS, "steps = 10"), 20001, 0),
        # ARKODE is set up by each rank for itself, though SUNDIALS may have MPI in it.
        (axis(301).replace(STEPPING, "formulation = 'lagrange', method = 'arkode_erk'"), 301, 0),
        # Some ranks find nothing to do.
        (axis(3, FAST), 3, 0),
        # The exit code of failing cases is that of the run.
        (axis(TILTS).replace("theta_deg = 20", "").replace(STEPS, "steps = 10"), 1000, 3),
    ],
)
def test_same_bytes(spin, text, cases, code):
    """The tables of any ranks and threads are that of the program without MPI."""
    whole = spin(text, "--output=alone", code=code).path.read_bytes()
    assert whole.count(b"\n") > cases
    output = spin.folder / "output"
    for ranks, threads in ((1, 1), (2, 1), (4, 1), (3, 2)):
        words = ("scene.nml", "--verbose", "--threads", str(threads))
        run = ranked(spin, *words, ranks=ranks, code=code)
        assert run.path.read_bytes() == whole
        assert (output / "scene.log").read_text(encoding="utf-8") == run.out
        team = f"{ranks} ranks x {threads} threads" if ranks > 1 else f"{threads} threads"
        assert f" s on {team}, " in run.out
        assert sorted(path.name for path in output.iterdir()) == ["scene.csv", "scene.log"]


def test_several_inputs_and_parts(spin, slow, reference):
    """One sweep after the other; a part of one is shared out like a whole."""
    alone = spin(FAST, "--output=alone", name="fast").path.read_bytes()
    ranked(spin, "fast.nml", slow, "--threads", "1")
    check_complete(spin, reference)
    assert (spin.folder / "output/fast.csv").read_bytes() == alone
    for part in (1, 2):
        ranked(spin, slow, "--threads", "1", "--shard", f"{part}/2")
    merged = ranked(spin, "merge", "m.csv", *sorted(spin.folder.glob("output/*-of-2.csv")))
    assert merged.out == "2 parts, 1000 cases -> m.csv\n"
    assert (spin.folder / "m.csv").read_bytes() == reference


def test_under_slurm(spin, slow, reference):
    """The script, with stand-ins for sbatch and srun."""
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
    spin.call(slow, "mpi", "--ntasks=2", command=script, environment=environment)
    assert " s on 2 ranks x 1 threads, " in (spin.folder / "log").read_text()
    check_complete(spin, reference)


@pytest.mark.parametrize("kill_writer", [True, False])
def test_a_rank_is_killed(spin, slow, reference, kill_writer):
    """All end; what is journalled is taken over, with ranks or without, to the same bytes."""
    with spin.start(slow, "--threads", "1", command=under(3), environment=MPI) as run:
        wait_until(lambda: spin.journalled("output/slow.csv") >= 1)
        victims = sorted(pid for pid, writer in writers(spin).items() if writer is kill_writer)
        assert len(victims) == (1 if kill_writer else 2)
        os.kill(victims[0], signal.SIGKILL)
        assert run.wait(timeout=300) != 0
        wait_until(lambda: not writers(spin))
    rows = spin.journalled("output/slow.csv")
    assert rows > 0
    assert "output/slow.csv" not in spin.produced()
    words = (slow, "--threads", "1", "--resume", "--progress")
    run = ranked(spin, *words, ranks=2) if kill_writer else spin.call(*words)
    # In the progress, in the summary, and nowhere else.
    said = run.out + run.stderr
    assert said.count(f"resumes after {rows} rows of an interrupted run") == 2
    check_complete(spin, reference)


def test_the_launcher_is_stopped(spin, slow, reference):
    """SIGTERM to it ends all ranks, and nothing is lost; a complete table is left alone."""
    with spin.start(slow, "--threads", "1", command=under(3), environment=MPI) as run:
        wait_until(lambda: spin.journalled("output/slow.csv") >= 1)
        run.terminate()
        assert run.wait(timeout=300) != 0
        wait_until(lambda: not writers(spin))
    assert spin.journalled("output/slow.csv") > 0
    for said in (" rows of an interrupted run", "nothing was computed"):
        run = ranked(spin, slow, "--threads", "1", "--resume")
        assert said in run.out + run.stderr
        check_complete(spin, reference)


def test_a_disk_that_fills_up(spin, slow, reference):
    """All ranks end, with exit code 4 and one message; with more room it goes on."""
    disk = spin.folder / "disk"
    disk.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]
    if os.geteuid() or subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("takes root")
    try:
        run = ranked(spin, slow, "-o", disk, "--threads", "1", code=4)
        said = run.out + run.stderr
        assert said.count("No space left on device") == 1
        assert said.count("slow.csv are kept; --resume resumes the run") == 1
        assert writers(spin) == {}
        subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
        ranked(spin, slow, "-o", disk, "--threads", "1", "--resume")
        check_complete(spin, reference, "disk/slow.csv")
    finally:
        subprocess.run(["umount", disk], check=True)


@pytest.mark.parametrize(
    ("words", "said"),
    [(["bad.nml"], r"(?m)^1 error$"), (["slow.nml", "--thread", "1"], "unknown option")],
)
def test_wrong_input_and_usage(spin, slow, words, said):
    """An error has one message, with the same exit code as without MPI; nothing is computed."""
    spin.write(SLOW.replace("mass = 1.0", "mass = -1.0"), "bad.nml")
    run = ranked(spin, *words, code=2)
    assert len(re.findall(said, run.stderr)) == 1
    assert run.out == ""
    assert spin.produced() == set()


def test_a_file_where_the_folder_should_be(spin, slow):
    """The message comes once, too."""
    spin.write("", "output")
    assert ranked(spin, slow, code=4).stderr.count("cannot make folder output") == 1


@pytest.mark.parametrize("words", [["--help"], ["list", "methods"], ["--check", "scene.nml"]])
def test_what_one_process_does(spin, words):
    """Help, lists and checks come once."""
    spin.write(GOOD)
    assert ranked(spin, *words).out == spin.call(*words).out


@pytest.mark.parametrize(
    ("scene", "reason"), [("missing.nml", "missing.nml"), ("other.nml", "rank 1: mass = 2")]
)
def test_ranks_that_are_not_alike(spin, slow, scene, reason):
    """Another input at one rank, or none: the error of that rank is everybody's."""
    spin.write(SLOW.replace("mass = 1.0", "mass = 2.0"), "other.nml")
    # Not `mpirun A : B`, which some releases of Open MPI 5 cannot start.
    rank = "${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-$PMI_RANK}}"
    choose = f'#!/bin/sh\n[ "{rank}" = 0 ] || shift\nexec {shlex.quote(MPI_EXE)} "$1"\n'
    unlike = spin.folder / spin.write(choose, "unlike")
    unlike.chmod(0o755)
    command = ("mpirun", "-np", "2", unlike, slow)
    run = spin.call(scene, command=command, environment=MPI, code=2)
    assert run.stderr.count(reason) == 1
    assert not list(spin.folder.rglob("*.csv*"))
