"""Sweeps shared out among the ranks of MPI: the same bytes, and nothing that can be lost."""

import contextlib
import os
import random
import shlex
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

import pytest

from program_test import GOOD, IS_OPTIMISED, PROGRAM, ROOT
from survival_test import FAST, SLOW, STEPPING, STEPS, SurvivalCase

pytestmark = pytest.mark.slow

MPI_PROGRAM = os.environ.get("SPINTOP_MPI_EXE", str(ROOT / "build/mpi/spintop"))

# By default Open MPI starts nothing as root, and no more ranks than cores.
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


def setUpModule() -> None:
    """These take a launcher and a program that was built for it."""
    if not shutil.which("mpirun") or not Path(MPI_PROGRAM).is_file():
        raise unittest.SkipTest("no MPI: scripts/setup --mpi installs and builds what it takes")
    os.environ.update(ENVIRONMENT)


def under(ranks: int) -> tuple[str, ...]:
    """The command that starts so many ranks."""
    return ("mpirun", "-np", str(ranks), MPI_PROGRAM)


class RanksCase(SurvivalCase):
    """The slow sweep, its table from a build without MPI, and ranks of one thread each."""

    # Three ranks are faster, and a launcher takes its time to end them.
    text = SLOW.replace(STEPS, "steps = 8000" if IS_OPTIMISED else "steps = 2000")

    def setUp(self) -> None:
        """From here on runs have three ranks."""
        self.command = (PROGRAM,)
        super().setUp()
        self.command = under(3)

    def ranks(self) -> dict[int, bool]:
        """The ranks that run in the folder: by process number, whether it is the writer."""
        found = {}
        for process in Path("/proc").iterdir():
            if process.name.isdigit():
                try:
                    here = (process / "cwd").readlink() == self.folder.resolve()
                    if here and (process / "exe").readlink() == Path(MPI_PROGRAM).resolve():
                        found[int(process.name)] = self.writes(process)
                except (FileNotFoundError, PermissionError, ProcessLookupError):
                    continue
        return found

    @staticmethod
    def writes(process: Path) -> bool:
        """Whether a process has the table open, while it opens and closes others."""
        for file in (process / "fd").iterdir():
            with contextlib.suppress(FileNotFoundError):
                if str(file.readlink()).endswith(".csv.part"):
                    return True
        return False

    def wait_for_all_to_end(self) -> None:
        """A launcher may end before its ranks."""
        deadline = time.monotonic() + 300
        while self.ranks():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)


class SameBytesTest(RanksCase):
    """For every distribution of the cases."""

    def compare(self, text: str, cases: int, code: int = 0) -> None:
        """The tables of any ranks and threads are that of the program without MPI."""
        self.slow.write_text(text, encoding="utf-8")
        self.command = (PROGRAM,)
        self.run_sweep("-o", "alone", code=code)
        whole = self.read("alone/slow.csv")
        self.assertGreater(whole.count(b"\n"), cases)
        for ranks, threads in ((1, 1), (2, 1), (4, 1), (3, 2)):
            with self.subTest(f"{ranks} ranks x {threads} threads"):
                self.command = under(ranks)
                said = self.run_program(self.slow, "--threads", threads)
                self.assertEqual(said.returncode, code, said.stderr)
                self.assertEqual(self.read("output/slow.csv"), whole)
                self.assertEqual(self.read("output/slow.log").decode(), said.stdout)
                team = f"{ranks} ranks x {threads} threads" if ranks > 1 else f"{threads} threads"
                self.assertIn(f" s on {team}, ", said.stdout)
                left = sorted(path.name for path in (self.folder / "output").iterdir())
                self.assertEqual(left, ["slow.csv", "slow.log"])

    def test_closed_form(self) -> None:
        """Blocks of many cases that cost little."""
        self.compare(FAST.replace("count(1) = 1000", "count(1) = 40001"), 40001)

    def test_steps(self) -> None:
        """Blocks of few cases."""
        text = SLOW.replace("count(1) = 1000", "count(1) = 20001")
        self.compare(text.replace(STEPS, "steps = 10"), 20001)

    def test_arkode(self) -> None:
        """ARKODE is set up by each rank for itself, though SUNDIALS may have MPI in it."""
        text = SLOW.replace("count(1) = 1000", "count(1) = 301")
        self.compare(text.replace(STEPPING, "formulation = 'lagrange', method = 'arkode_erk'"), 301)

    def test_more_ranks_than_blocks(self) -> None:
        """Some ranks find nothing to do."""
        self.compare(FAST.replace("count(1) = 1000", "count(1) = 3"), 3)

    def test_failing_cases(self) -> None:
        """Their exit code is that of the run."""
        axis = "count(1) = 200, parameter(2) = 'initial.theta_deg', values(2,:) = 0, 20, 30, 40, 50"
        text = SLOW.replace("theta_deg = 20", "").replace("count(1) = 1000", axis)
        self.compare(text.replace(STEPS, "steps = 10"), 1000, code=3)

    def test_several_inputs_and_parts(self) -> None:
        """One sweep after the other; a part of one is shared out like a whole."""
        fast = self.write(FAST, "fast.nml")
        self.command = (PROGRAM,)
        self.assertEqual(self.run_program(fast, "-o", "alone").returncode, 0)
        self.command = under(3)
        result = self.run_program(fast, self.slow, "--threads", "1")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.check_complete()
        self.assertEqual(self.read("output/fast.csv"), self.read("alone/fast.csv"))
        for part in (1, 2):
            self.run_sweep("--threads", "1", "--shard", f"{part}/2")
        merged = self.run_program("merge", "m.csv", *sorted(self.folder.glob("output/*-of-2.csv")))
        self.assertEqual(merged.stdout, "2 parts, 1000 cases -> m.csv\n")
        self.assertEqual(self.read("m.csv"), self.reference)

    def test_under_slurm(self) -> None:
        """The script, with stand-ins for sbatch and srun."""
        for name, body in (
            (
                "sbatch",
                'until [[ $1 = */slurm_sweep.sh ]]; do shift; done; "$@" >log 2>&1; echo 17',
            ),
            ("srun", 'exec mpirun -np 2 "${@:2}"'),
        ):
            script = self.folder / "bin" / name
            script.parent.mkdir(exist_ok=True)
            script.write_text(f"#!/usr/bin/env bash\n{body}\n", encoding="utf-8")
            script.chmod(0o755)
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        result = subprocess.run(
            [ROOT / "scripts/slurm_sweep.sh", self.slow, "mpi", "--ntasks=2"],
            cwd=self.folder,
            env=os.environ | {"PATH": path, "SPINTOP_EXE": MPI_PROGRAM},
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(" s on 2 ranks x 1 threads, ", self.read("log").decode())
        self.check_complete()


class LossTest(RanksCase):
    """Ranks that end before their time."""

    def test_a_rank_is_killed(self) -> None:
        """All end; what is journalled is taken over, with ranks or without, to the same bytes."""
        choices = random.Random(1)
        for kill_writer in (True, False):
            with self.subTest("the writer" if kill_writer else "another"):
                self.command = under(3)
                run = self.start()
                self.wait_for_rows(run, 1)
                victims = [pid for pid, writes in self.ranks().items() if writes is kill_writer]
                self.assertEqual(len(victims), 1 if kill_writer else 2)
                os.kill(choices.choice(victims), signal.SIGKILL)
                self.assertNotEqual(run.wait(timeout=300), 0)
                self.wait_for_all_to_end()
                rows = self.journalled_rows()
                self.assertGreater(rows, 0)
                self.assertFalse((self.folder / "output/slow.csv").exists())
                self.command = under(2) if kill_writer else (PROGRAM,)
                said = self.run_sweep("--threads", "1", "--resume", "--progress")
                # In the progress, in the summary, and nowhere else.
                taken_over = f"resumes after {rows} rows of an interrupted run"
                self.assertEqual(said.count(taken_over), 2)
                self.check_complete()
                shutil.rmtree(self.folder / "output")

    def test_the_launcher_is_stopped(self) -> None:
        """SIGTERM to it ends all ranks, and nothing is lost; a complete table is left alone."""
        run = self.start()
        self.wait_for_rows(run, 1)
        run.terminate()
        self.assertNotEqual(run.wait(timeout=300), 0)
        self.wait_for_all_to_end()
        self.assertGreater(self.journalled_rows(), 0)
        self.assertIn(" rows of an interrupted run", self.run_sweep("--threads", "1", "--resume"))
        self.check_complete()
        self.assertIn("nothing was computed", self.run_sweep("--threads", "1", "--resume"))
        self.check_complete()

    def test_a_disk_that_fills_up(self) -> None:
        """All ranks end, with exit code 4 and one message; with more room it goes on."""
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]
        if os.geteuid() or subprocess.run(command, capture_output=True, check=False).returncode:
            self.skipTest("takes root")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        said = self.run_sweep("-o", disk, "--threads", "1", code=4)
        self.assertEqual(said.count("No space left on device"), 1)
        self.assertEqual(said.count("slow.csv are kept; --resume resumes the run"), 1)
        self.assertEqual(self.ranks(), {})
        subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
        self.run_sweep("-o", disk, "--threads", "1", "--resume")
        self.check_complete("disk/slow.csv")


class ErrorTest(RanksCase):
    """An error has one message, with the same exit code as without MPI."""

    def test_wrong_input_and_usage(self) -> None:
        """Nothing is computed."""
        bad = self.write(SLOW.replace("mass = 1.0", "mass = -1.0"), "bad.nml")
        self.assertEqual(self.refuse(bad).count("1 error\n"), 1)
        self.assertEqual(self.refuse(self.slow, "--thread", "1").count("unknown option"), 1)
        self.slow.rename(self.folder / "output")
        said = self.run_program(self.write(SLOW))
        self.assertEqual(said.returncode, 4)
        self.assertEqual(said.stderr.count("cannot make folder output"), 1)

    def test_what_one_process_does(self) -> None:
        """Help, lists and checks come once."""
        scene = self.write(GOOD)
        for arguments in (["--help"], ["list", "methods"], ["--check", scene]):
            shared = self.run_program(*arguments).stdout
            self.command = (PROGRAM,)
            self.assertEqual(shared, self.run_program(*arguments).stdout)
            self.command = under(3)

    def test_ranks_that_are_not_alike(self) -> None:
        """Another input at one rank, or none: the error of that rank is everybody's."""
        other = self.write(SLOW.replace("mass = 1.0", "mass = 2.0"), "other.nml")
        # Not `mpirun A : B`, which some releases of Open MPI 5 cannot start.
        unlike = self.folder / "unlike"
        rank = "${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-$PMI_RANK}}"
        choose = f'#!/bin/sh\n[ "{rank}" = 0 ] || shift\nexec {shlex.quote(MPI_PROGRAM)} "$1"\n'
        unlike.write_text(choose, encoding="utf-8")
        unlike.chmod(0o755)
        self.command = ("mpirun", "-np", "2", unlike, self.slow)
        for scene, reason in (("missing.nml", "missing.nml"), (other, "rank 1: mass = 2")):
            result = self.run_program(scene)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr.count(reason), 1, result.stderr)
            self.assertEqual(list(self.folder.rglob("*.csv*")), [])
