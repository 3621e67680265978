"""Files that a run writes: nothing is changed through links, nothing waited for or shared."""

import os
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import ROOT
from program_case import PROGRAM, ProgramCase
from study_parts_test import BENCHMARK, PRECISION, STABILITY, TRAJECTORY
from survival_test import SLOW, SurvivalCase

SWEEP = SLOW.replace("count(1) = 1000", "count(1) = 20")
STATISTICS = """
&output rows = {} /
&statistics columns = 'theta_max', 'status' over = 'initial.psi_rate' bins = 4 /
"""
NETCDF = "&output format = 'netcdf' /\n"
STUDIES = {
    "sweep": SWEEP,
    "sweep_netcdf": SWEEP + NETCDF,
    "sweep_packed": SWEEP + NETCDF.replace("/", "compression = 4 /"),
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


class StudyCase(ProgramCase):
    """Runs of studies of all kinds."""

    def setUp(self) -> None:
        """With the data that an input names."""
        super().setUp()
        shutil.copy(ROOT / "input/fit.csv", self.folder)

    def run_study(
        self, kind: str, *options: str, code: int | None = 0
    ) -> subprocess.CompletedProcess:
        """Run a study; it must end soon."""
        result = subprocess.run(
            [PROGRAM, self.write(STUDIES[kind], f"{kind}.nml"), "--quiet", *options],
            cwd=self.folder, capture_output=True, text=True, check=False, timeout=300,
        )  # fmt: skip
        if code is not None:
            self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def studies(self) -> Iterator[tuple[str, list[Path]]]:
        """Each kind that this build has, and the files that it makes."""
        for kind in STUDIES:
            with self.subTest(kind):
                result = self.run_study(kind, code=None)
                if "built without NetCDF" in result.stderr or "no NetCDF" in result.stderr:
                    continue
                self.assertEqual(result.returncode, 0, result.stderr)
                yield kind, sorted((self.folder / "output").iterdir())
                shutil.rmtree(self.folder / "output")


class LinksTest(StudyCase):
    """Names under which a run writes, and that are there already as something else."""

    def plant(self, how: str, path: Path) -> None:
        """Make a file of another kind of a name."""
        path.unlink(missing_ok=True)
        match how:
            case "symbolic link":
                path.symlink_to(self.victim)
            case "hard link":
                path.hardlink_to(self.victim)
            case "FIFO":
                os.mkfifo(path)

    @pytest.mark.slow
    def test_every_file_that_is_written(self) -> None:
        """A link or a FIFO is refused at once with its name; what it leads to stays as it is."""
        all_kinds = ("symbolic link", "hard link", "FIFO")
        self.victim = self.folder / "victim"
        for kind, files in self.studies():
            self.victim.write_text("precious\n")
            again = () if kind in LISTS else ("--restart",)
            for path in files:
                refused = 0
                for ending in NEW:
                    name = Path(f"{path}{ending}")
                    for how in all_kinds if kind in ("sweep", "both") else all_kinds[:1]:
                        self.plant(how, name)
                        result = self.run_study(kind, *again, code=None)
                        self.assertEqual(self.victim.read_text(), "precious\n", (name, how))
                        if result.returncode:
                            self.assertEqual(result.returncode, 4, (name, how, result.stderr))
                            self.assertIn(name.name, result.stderr)
                            self.assertRegex(result.stderr, r"link|FIFO")
                            self.assertTrue(os.path.lexists(name), (name, how))
                            refused += 1
                        name.unlink(missing_ok=True)
                self.assertGreater(refused, 0, path)

    def test_targets(self) -> None:
        """A table does not take the place of a FIFO or of a device, nor does a merged one."""
        for part in ("1/2", "2/2"):
            self.run_study("sweep", "--shard", part)
        parts = [f"output/sweep.{i}-of-2.csv" for i in (1, 2)]
        os.mkfifo(self.folder / "fifo")
        targets = ["fifo"]
        if os.geteuid() == 0:
            targets.append("zero")
            subprocess.run(["mknod", self.folder / "zero", "c", "1", "5"], check=True)
        for name in targets:
            result = self.run_program("merge", name, *parts)
            self.assertEqual(result.returncode, 4, result.stderr)
            self.assertIn("not a file", result.stderr)
            self.assertFalse((self.folder / name).is_file())
        os.mkfifo(self.folder / "output/sweep.csv")
        self.assertIn("FIFO", self.run_study("sweep", code=4).stderr)

    def test_what_is_read(self) -> None:
        """A FIFO as a part, a journal or a part of a merge is refused, not waited for."""
        self.run_study("sweep")
        table = self.folder / "output/sweep.csv"
        for names in ((".part", ".journal"), (".journal",)):
            shutil.copy(table, f"{table}.part")
            for ending in names:
                path = self.folder / f"output/sweep.csv{ending}"
                path.unlink(missing_ok=True)
                os.mkfifo(path)
            result = self.run_study("sweep", "--resume", code=None)
            self.assertIn(result.returncode, (2, 4))
            self.assertIn("FIFO", result.stderr)
            for ending in names:
                (self.folder / f"output/sweep.csv{ending}").unlink()
        os.mkfifo(self.folder / "part.csv")
        result = self.run_program("merge", "all.csv", "part.csv", "part.csv")
        self.assertEqual(result.returncode, 2)
        self.assertIn("FIFO", result.stderr)


@unittest.skipUnless(shutil.which("gcc"), "no gcc")
class NoLocksTest(SurvivalCase):
    """Two runs on a file system without locks, and others that write to a part."""

    def setUp(self) -> None:
        """A library that stands for such a file system."""
        super().setUp()
        source, self.shim = self.folder / "locks.c", self.folder / "locks.so"
        source.write_text(NO_LOCKS)
        # The place has no space, at which the loader would divide it.
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.shim = Path(place.name) / "locks.so"
        subprocess.run(["gcc", "-shared", "-fPIC", "-o", self.shim, source], check=True)
        source.unlink()
        os.environ["LD_PRELOAD"] = str(self.shim)
        self.addCleanup(os.environ.pop, "LD_PRELOAD")

    def test_two_runs(self) -> None:
        """The second is refused; the first goes on, and leaves no other file."""
        first = self.start()
        self.wait_for_rows(first, 0)
        for arguments in ([], ["--resume"], ["--restart"]):
            said = self.run_sweep(*arguments, code=4)
            self.assertIn("another run is writing it", said)
            self.assertIn(".lock", said)
        self.assertEqual(first.wait(), 0)
        self.check_complete()

    def test_a_killed_run(self) -> None:
        """What it leaves is named, and does not hold up the next when it is removed."""
        self.interrupt()
        self.assertIn(".lock", self.run_sweep("--resume", code=4))
        (self.folder / "output/slow.csv.part.lock").unlink()
        self.run_sweep("--resume")
        self.check_complete()

    def test_a_signal(self) -> None:
        """A run that a signal ends removes its lock."""
        run = self.start()
        self.wait_for_rows(run, 1)
        run.send_signal(signal.SIGTERM)
        run.wait()
        self.assertFalse((self.folder / "output/slow.csv.part.lock").exists())

    def test_others_write_to_the_part(self) -> None:
        """A part that was changed, or is another file, never becomes a table."""
        part = self.folder / "output/slow.csv.part"

        def append() -> None:
            with part.open("a") as file:
                file.write("1,2,3\n")

        def replace() -> None:
            (self.folder / "mine").write_text("mine\n")
            (self.folder / "mine").rename(part)

        for change in (append, replace):
            with self.subTest(change.__name__):
                part.unlink(missing_ok=True)
                run = subprocess.Popen(
                    [PROGRAM, self.slow, "--threads", "1", "--restart"],
                    cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                )  # fmt: skip
                self.addCleanup(run.kill)
                deadline = time.monotonic() + 60
                while not part.exists() or part.stat().st_size < 2000:
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.01)
                change()
                said = run.communicate(timeout=300)[1]
                self.assertEqual(run.returncode, 4, said)
                self.assertIn("another program changed it", said)
                self.assertFalse((self.folder / "output/slow.csv").exists())
        self.assertEqual(part.read_text(), "mine\n")


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    unittest.main()
