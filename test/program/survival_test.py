"""A sweep that nothing can lose: threads, parts, signals, full disks, damaged files."""

import os
import random
import re
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import ClassVar

import pytest

from conftest import GOOD, KIND, ROOT
from program_case import PROGRAM, ProgramCase, Table

# Long enough to be interrupted at any moment: a few seconds on one thread.
STEPS = "steps = 2000" if KIND == "release" else "steps = 600"
STEPPING = f"formulation = 'lagrange', method = 'rk4', {STEPS}"
SLOW = f"""\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 2 /
&integration {STEPPING} /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 1000 /
"""
# The same in closed form: over in no time.
FAST = SLOW.replace(STEPPING, "method = 'exact'")
LONG = "output/long.csv"  # the table of a sweep whose last cases would take hours
SHIM = """\
#include <signal.h>
static void nothing(int number) { (void)number; }
__attribute__((constructor)) static void begin(void) { signal(SIGHUP, nothing); }
"""
PATIENCE = 600
"""Seconds for what ends at once, on a machine that has much else to do."""


class SurvivalCase(ProgramCase):
    """Runs that end before their time."""

    text = SLOW
    references: ClassVar[dict[str, bytes]] = {}
    """The table of a text, from a run that nothing stopped."""

    def setUp(self) -> None:
        """The slow sweep and its table."""
        super().setUp()
        self.slow = self.write(self.text, "slow.nml")
        if self.text not in self.references:
            self.run_sweep("-o", "reference", "--threads", "1")
            self.references[self.text] = self.read("reference/slow.csv")
            shutil.rmtree(self.folder / "reference")
        self.reference = self.references[self.text]

    def run_sweep(self, *arguments: str | Path, code: int = 0, **options: object) -> str:
        """Run the slow sweep to its end; returns all that it said."""
        result = self.run_program(self.slow, *arguments, **options)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def start(self, *arguments: str | Path) -> subprocess.Popen:
        """Start the slow sweep on one thread, and do not wait for it."""
        run = subprocess.Popen(
            [*self.command, self.slow, "--threads", "1", *map(str, arguments)],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        return run

    def read(self, name: str) -> bytes:
        """A file in the folder."""
        return (self.folder / name).read_bytes()

    def journalled_rows(self, table: str = "output/slow.csv") -> int:
        """Rows that the journal of a table has; -1 if there is no journal."""
        try:
            lines = (self.folder / f"{table}.journal").read_text(encoding="ascii").splitlines()
        except FileNotFoundError:
            return -1
        (rows,) = (line for line in lines if line.startswith("rows: "))
        return sum(map(int, rows.split()[1:]))

    def wait_for_rows(
        self, run: subprocess.Popen, least: int, table: str = "output/slow.csv"
    ) -> None:
        """Wait until the journal has so many rows."""
        deadline = time.monotonic() + 300
        while self.journalled_rows(table) < least:
            self.assertIsNone(run.poll(), "the run ended too early")
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)

    def wait_until(self, run: subprocess.Popen, seen: Callable[[], bool]) -> None:
        """Wait until something is seen of a run, or it has ended."""
        deadline = time.monotonic() + 300
        while run.poll() is None and not seen():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.001)

    def interrupt(self, *arguments: str | Path, table: str = "output/slow.csv") -> None:
        """Start the slow sweep and kill it when some of it is done."""
        run = self.start(*arguments)
        self.wait_for_rows(run, 1, table)
        run.kill()
        run.wait()

    def check_complete(self, name: str = "output/slow.csv") -> None:
        """The table is that of an uninterrupted run, and nothing else is left of it."""
        self.assertEqual(self.read(name), self.reference)
        path = self.folder / name
        left = sorted(p.name for p in path.parent.glob(f"{path.stem}*"))
        self.assertEqual(left, [path.name, f"{path.stem}.log"])


def is_larger(path: Path, size: int) -> bool:
    """Whether a file, which may come and go, is larger."""
    try:
        return path.stat().st_size > size
    except FileNotFoundError:
        return False


def begin_patiently(number: signal.Signals) -> None:
    """Heed a signal, which a shell has its background jobs ignore, and let its sender go first."""
    signal.signal(number, signal.SIG_DFL)
    os.nice(19)


@pytest.mark.slow
class InterruptionTest(SurvivalCase):
    """Runs that are killed, and go on."""

    def test_any_number_of_threads_gives_the_same_bytes(self) -> None:
        """One (the reference), two, four threads; the log has what varies."""
        for threads in ("2", "4"):
            said = self.run_sweep("--threads", threads, "-o", threads)
            self.check_complete(f"{threads}/slow.csv")
            log = self.read(f"{threads}/slow.log").decode()
            self.assertEqual(log, said)
            self.assertIn(f" s on {threads} threads", log)
            self.assertRegex(log, r"\n  ended     20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ on \S+\n")
            self.assertIn("\n  status    1000 ok", log)

    def test_killed_at_many_moments(self) -> None:
        """SIGKILL and SIGTERM, as soon as a stage of the start or a size of the part is seen."""
        sizes = random.Random(1)
        part, journal = (self.folder / f"output/slow.csv.{name}" for name in ("part", "journal"))
        stages = (lambda: True, part.exists, journal.exists)
        taken_over = 0
        for trial in range(14):
            before = max(self.journalled_rows(), 0)
            size = sizes.randrange(len(self.reference))
            run = self.start("--resume")
            seen = stages[trial // 2 % 3] if trial % 2 else partial(is_larger, part, size)
            self.wait_until(run, seen)
            number = (signal.SIGKILL, signal.SIGTERM)[trial // 2 % 2]
            run.send_signal(number)
            code = run.wait()
            if (self.folder / "output/slow.csv").exists():
                self.assertIn(code, (0, -number))
                self.run_sweep("--resume")
                self.assertEqual(self.read("output/slow.csv"), self.reference)
                shutil.rmtree(self.folder / "output")
            else:
                self.assertEqual(code, -number)
                self.assertGreaterEqual(max(self.journalled_rows(), 0), before)
                taken_over = max(taken_over, self.journalled_rows())
        self.assertGreater(taken_over, 0)
        self.run_sweep("--resume")
        self.check_complete()

    def test_a_resumed_run_tells_what_it_took_over(self) -> None:
        """Its summary counts all cases, and says how many are of an earlier run."""
        self.interrupt()
        rows = self.journalled_rows()
        said = self.run_sweep("--resume", "--progress")
        self.assertEqual(said.count(f"resumes after {rows} rows of an interrupted run"), 2)
        self.assertIn("  status    1000 ok", said)
        self.check_complete()
        before = (self.folder / "output/slow.csv").stat()
        said = self.run_sweep("--resume")
        self.assertIn("nothing was computed: the table is already complete", said)
        self.assertEqual((self.folder / "output/slow.csv").stat(), before)

    def test_nothing_to_resume(self) -> None:
        """No part, or a part without a journal: the sweep starts anew, with a message."""
        said = self.run_sweep("--resume")
        self.assertIn("nothing to resume: the run starts from the beginning", said)
        (self.folder / "output/slow.csv").rename(self.folder / "output/slow.csv.part")
        said = self.run_sweep("--resume")
        self.assertIn("nothing to resume: the run starts from the beginning", said)
        self.check_complete()

    def test_failed_cases_of_an_earlier_run_count(self) -> None:
        """The exit code of a resumed run is that of the whole."""
        axis = "count(1) = 200, parameter(2) = 'initial.theta_deg', values(2,:) = 0, 20, 30, 40, 50"
        text = SLOW.replace("theta_deg = 20", "").replace("count(1) = 1000", axis)
        self.slow.write_text(text, encoding="utf-8")
        self.interrupt()
        said = self.run_sweep("--resume", code=3)
        self.assertIn("  status    800 ok", said)
        self.assertIn("  status    200 pole", said)

    def test_nothing_is_discarded_unasked(self) -> None:
        """An interrupted run is an error that names the rows and both options; nothing runs."""
        self.interrupt()
        rows = self.journalled_rows()
        part, journal = self.read("output/slow.csv.part"), self.read("output/slow.csv.journal")
        other = self.write()
        for arguments in ([], [other], ["--set", "top.mass=2"]):
            said = self.run_sweep(*arguments, code=2)
            self.assertIn(f"output/slow.csv is there: {rows} rows are kept", said)
            self.assertIn("--resume", said)
            self.assertIn("--restart", said)
            self.assertFalse((self.folder / "output/scene.csv").exists())
        # Nor by a table of another kind under the same name, or by merged parts.
        self.refuse(self.write(name="slow2.nml"), "--set", "output.file=slow.csv")
        said = self.run_sweep("--resume", "--restart", code=2)
        self.assertIn("--resume and --restart exclude each other", said)
        self.assertEqual(self.read("output/slow.csv.part"), part)
        self.assertEqual(self.read("output/slow.csv.journal"), journal)
        self.run_sweep("--check")
        said = self.run_sweep("--restart")
        self.assertIn(f"discards an interrupted run of {rows} rows", said)
        self.check_complete()

    def test_a_merge_does_not_discard_an_interrupted_run(self) -> None:
        """It is refused, and works when the run has been completed."""
        parts = []
        for shard in ("1/2", "2/2"):
            self.run_sweep("--shard", shard)
            parts.append(f"output/slow.{shard.replace('/', '-of-')}.csv")
        self.interrupt()
        part = self.read("output/slow.csv.part")
        result = self.run_program("merge", "output/slow.csv", *parts)
        self.assertEqual(result.returncode, 2)
        self.assertIn("rows are kept", result.stderr)
        self.assertEqual(self.read("output/slow.csv.part"), part)
        self.run_sweep("--resume")
        self.assertEqual(self.run_program("merge", "output/slow.csv", *parts).returncode, 0)
        self.assertEqual(self.read("output/slow.csv"), self.reference)

    def test_restart_takes_the_place_of_any_kind_of_run(self) -> None:
        """A trajectory under the name of an interrupted sweep leaves no journal behind."""
        self.interrupt()
        scene = self.write(GOOD, "scene.nml")
        result = self.run_program(scene, "--set", "output.file=slow.csv", "--restart")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.journalled_rows(), -1)
        self.run_sweep()
        self.check_complete()

    def test_a_signal_says_what_is_kept_and_how_to_resume(self) -> None:
        """Ctrl-C, and the signals of batch systems; the printed command completes the table."""
        rows = 0
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                before, said = self.signal_a_run(number, rows)
                rows = self.journalled_rows("it's here/slow.csv")
                first, second = said.splitlines()
                pattern = r"spintop: interrupted: (\d+) of 1000 rows of it's here/slow.csv are kept"
                self.assertRegex(first, pattern)
                kept = int(re.match(pattern, first)[1])
                # The last entry may be on the disk, and its rows not yet counted.
                self.assertLessEqual(before, kept)
                self.assertLessEqual(kept, rows)
                self.assertTrue(second.startswith("to resume: "), second)
        command = second.removeprefix("to resume: ")
        result = subprocess.run(
            command, shell=True, cwd=self.folder, capture_output=True, text=True, check=False
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"resumes after {rows} rows", result.stdout)
        self.check_complete("it's here/slow.csv")

    def signal_a_run(self, number: signal.Signals, before: int) -> tuple[int, str]:
        """Send a signal to a resumed run once its journal has more rows than before.

        Returns the number of rows that it resumed after, and what it said.
        """
        for _ in range(25):
            run = subprocess.Popen(
                [PROGRAM, "slow.nml", "--threads", "1", "-o", "it's here", "--resume"],
                cwd=self.folder,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                preexec_fn=lambda: begin_patiently(number),
            )
            self.wait_for_rows(run, before + 1, "it's here/slow.csv")
            run.send_signal(number)
            said = run.communicate(timeout=PATIENCE)[1]
            if run.returncode != 0:
                break
            # The disk took so long for the entry that the run was over: once more, from the start.
            shutil.rmtree(self.folder / "it's here")
            before = 0
        self.assertEqual(run.returncode, -number)
        return before, said

    def test_a_signal_in_the_midst_of_long_cases(self) -> None:
        """What was computed before is kept at once, although the next cases would take hours."""
        text = self.text.split("&sweep")[0].split("&integration")[0].split("&output")[0]
        quick, slow = ", ".join(map(str, range(10, 26))), ", ".join(["1000000000"] * 16)
        text += "&output columns = 'theta_end' /\n"
        text += "&integration method = 'rk4', max_steps = 2000000000 /\n"
        text += f"&sweep parameter = 'integration.steps', values(1,:) = {quick}, {slow} /\n"
        scene = self.write(text, "long.nml")
        for threads in ("1", "2"):
            # Without a signal the journal has them, too, after a while.
            said = self.interrupt_long_cases(
                scene, threads, signal.SIGTERM, lambda run: self.wait_for_rows(run, 16, LONG)
            )
            self.assertIn(f"interrupted: 16 of 32 rows of {LONG} are kept", said)
            for _ in range(25):
                said = self.interrupt_long_cases(
                    scene, threads, signal.SIGINT, lambda run: time.sleep(0.04)
                )
                if said:
                    break  # else it came before the run waited for signals
            rows = self.journalled_rows(LONG)
            expected = f"{rows} of 32 rows" if rows >= 0 else "nothing is kept"
            self.assertIn(f"interrupted: {expected}", said)

    def interrupt_long_cases(
        self,
        scene: Path,
        threads: str,
        number: signal.Signals,
        wait: Callable[[subprocess.Popen], None],
    ) -> str:
        """Start a run, wait once it has begun its table, send a signal; returns what it said."""
        shutil.rmtree(self.folder / "output", ignore_errors=True)
        run = subprocess.Popen(
            [PROGRAM, scene, "--threads", threads],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),
        )
        part = self.folder / f"{LONG}.part"
        while not part.exists() and run.poll() is None:
            time.sleep(0.01)
        wait(run)
        run.send_signal(number)
        said = run.communicate(timeout=PATIENCE)[1]
        self.assertEqual(run.returncode, -number)
        return said

    def begin(self, prepare: Callable[[], object], **environment: str) -> subprocess.Popen[str]:
        """Begin the slow sweep in a process that is prepared so; return when it has rows."""
        run = subprocess.Popen(
            [PROGRAM, self.slow, "--threads", "1"],
            cwd=self.folder,
            env={**os.environ, **environment},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=prepare,
        )
        self.wait_for_rows(run, 1)
        return run

    def library_with_a_handler(self) -> dict[str, str]:
        """Have a library loaded with the program that has a handler for SIGHUP, as UCX does."""
        compiler = shutil.which("gcc") or shutil.which("cc")
        if compiler is None:
            self.skipTest("no C compiler is found")
        source, library = self.write(SHIM, "shim.c"), self.folder / "shim.so"
        subprocess.run([compiler, "-shared", "-fPIC", source, "-o", library], check=True)
        return {"LD_PRELOAD": f"./{library.name}"}  # spaces would separate names

    def test_a_handler_of_a_library_does_not_keep_a_signal(self) -> None:
        """A hangup ends the run."""
        library = self.library_with_a_handler()
        run = self.begin(lambda: begin_patiently(signal.SIGHUP), **library)
        run.send_signal(signal.SIGHUP)
        said = run.communicate(timeout=PATIENCE)[1]
        self.assertEqual(run.returncode, -signal.SIGHUP, said)
        self.assertIn("spintop: interrupted: ", said)

    def test_a_signal_that_is_ignored_stays_so(self) -> None:
        """nohup has SIGHUP ignored, whatever handlers the libraries of the program have."""

        def ignore() -> None:
            signal.signal(signal.SIGHUP, signal.SIG_IGN)

        for environment in ({}, self.library_with_a_handler()):
            with self.subTest(environment):
                run = self.begin(ignore, **environment)
                run.send_signal(signal.SIGHUP)
                said = run.communicate(timeout=PATIENCE)[1]
                self.assertEqual(run.returncode, 0, said)
                self.check_complete()
                shutil.rmtree(self.folder / "output")

    def test_damage_and_strangers_are_refused(self) -> None:
        """With the reason, exit code 2, and all as it was."""
        self.interrupt()
        part, journal = self.read("output/slow.csv.part"), self.read("output/slow.csv.journal")
        bytes_there = int(journal.split(b"\n")[1].split()[1])
        middle = bytes_there - 100
        revision = part.index(b"# revision: ") + len(b"# revision: ")
        for new_part, new_journal, settings, reason in (
            (part[:middle], journal, [], "shorter than its journal records"),
            (part[:middle] + b"~" + part[middle + 1 :], journal, [], "changed after it was"),
            (part[:revision] + b"~" + part[revision + 1 :], journal, [], "revision: ~"),
            (part, journal.replace(b"bytes: ", b"bytes: 1"), [], "journal is damaged"),
            (part, journal[:-5], [], "journal is damaged"),
            (part, b"", [], "journal is damaged"),
            (part, journal, ["--set", "top.mass=2"], "here: mass = 2"),
        ):
            with self.subTest(reason):
                (self.folder / "output/slow.csv.part").write_bytes(new_part)
                (self.folder / "output/slow.csv.journal").write_bytes(new_journal)
                said = self.run_sweep("--resume", *settings, code=2)
                self.assertIn(reason, said)
                self.assertIn("--restart discards it", said)
                self.assertEqual(self.read("output/slow.csv.part"), new_part)
                self.assertEqual(self.read("output/slow.csv.journal"), new_journal)
        # What lies behind the journalled bytes may be anything: a power cut leaves zeros, say.
        (self.folder / "output/slow.csv.part").write_bytes(part[:bytes_there] + bytes(5000))
        (self.folder / "output/slow.csv.journal").write_bytes(journal)
        self.run_sweep("--resume")
        self.check_complete()
        said = self.run_sweep("--resume", "--set", "top.mass=2", code=2)
        self.assertIn("here: mass = 2", said)
        self.check_complete()

    def test_two_runs_at_once(self) -> None:
        """The second is refused, with --resume or without; the first goes on."""
        first = self.start()
        self.wait_for_rows(first, 0)
        for arguments in ([], ["--resume"]):
            self.assertIn("another run is writing it", self.run_sweep(*arguments, code=4))
        self.assertEqual(first.wait(), 0)
        self.check_complete()

    def test_resume_and_shard_are_not_for_all_studies(self) -> None:
        """A trajectory has no parts, a stability study no journal."""
        scene = self.write()
        self.assertIn("--shard is not for trajectories", self.refuse(scene, "--shard", "1/2"))
        said = self.refuse(scene, "--resume", "--set", "study.kind=stability")
        self.assertIn("--resume is for sweeps and trajectories", said)
        for shard in ("0/3", "4/3", "3", "1/2/3", "a/b", "1/2000000"):
            said = self.refuse(self.slow, "--shard", shard)
            self.assertIn("--shard takes I/N", said)
            self.assertIn("with N up to 1000000", said)


class DiskTest(SurvivalCase):
    """Places where nothing more can be written."""

    def test_a_disk_that_fills_up(self) -> None:
        """Exit code 4; with more room it goes on."""
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]
        if (
            os.geteuid() != 0
            or subprocess.run(command, capture_output=True, check=False).returncode
        ):
            self.skipTest("takes root")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        said = self.run_sweep("-o", disk, code=4)
        self.assertIn("No space left on device", said)
        self.assertIn("slow.csv are kept; --resume resumes the run", said)
        self.assertFalse((disk / "slow.csv").exists())
        self.run_sweep("-o", disk, "--resume", code=4)
        subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
        self.assertIn("rows of an interrupted run", self.run_sweep("-o", disk, "--resume"))
        self.check_complete("disk/slow.csv")

    def test_a_file_that_may_not_grow(self) -> None:
        """Exit code 4 and a message; without the limit it goes on."""

        def limit() -> None:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

        result = self.run_program(self.slow, preexec_fn=limit)
        self.assertEqual(result.returncode, 4)
        self.assertIn("slow.csv.part: File too large", result.stderr)
        self.assertEqual((self.folder / "output/slow.csv.part").stat().st_size, 200_000)
        self.assertGreater(self.journalled_rows(), -1)
        self.run_sweep("--resume")
        self.check_complete()

    def test_a_folder_removed_meanwhile(self) -> None:
        """Exit code 4, and a name."""
        run = subprocess.Popen(
            [PROGRAM, self.slow, "--threads", "1"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.wait_for_rows(run, 0)
        shutil.rmtree(self.folder / "output")
        said = run.communicate(timeout=PATIENCE)[1]
        self.assertEqual(run.returncode, 4, said)
        self.assertIn("output/slow.csv", said)
        self.assertNotIn("is kept", said)

    def test_folders_that_cannot_be_written(self) -> None:
        """Exit code 4 before anything is computed, on any way there."""
        self.run_sweep("-o", "/proc/spintop", code=4)
        (self.folder / "output/slow.csv.journal.new").mkdir(parents=True)
        said = self.run_sweep(code=4)
        # No case was computed: there is no part that a later run could resume.
        self.assertNotIn("are kept", said)
        self.assertIn("slow.csv.journal.new", said)
        self.assertEqual(self.produced(), ["output", "output/slow.csv.journal.new"])
        if os.geteuid() != 0:
            locked = self.folder / "locked"
            locked.mkdir(mode=0o500)
            self.run_sweep("-o", locked, code=4)


class ShardTest(SurvivalCase):
    """A sweep in parts."""

    def merge(self, *names: str, code: int = 0) -> str:
        """Merge tables in the output folder; returns all that was said."""
        result = self.run_program("merge", *(f"output/{name}" for name in names))
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def test_three_parts_make_the_whole(self) -> None:
        """The same bytes, though one part was killed; in any order."""
        self.run_sweep("--shard", "1/3")
        self.interrupt("--shard", "2/3", table="output/slow.2-of-3.csv")
        self.merge("slow.csv", "slow.1-of-3.csv", "slow.2-of-3.csv", "slow.3-of-3.csv", code=2)
        self.run_sweep("--resume", "--shard", "2/3")
        said = self.run_sweep("--resume", "--shard", "3/3", "--threads", "1")
        self.assertIn("part 3 of 3: cases 668 to 1000 of 1000", said)
        said = self.merge("slow.csv", "slow.3-of-3.csv", "slow.1-of-3.csv", "slow.2-of-3.csv")
        self.assertEqual(said, "3 parts, 1000 cases -> output/slow.csv\n")
        self.assertEqual(self.read("output/slow.csv"), self.reference)
        self.assertFalse((self.folder / "output/slow.csv.part").exists())
        part = Table(self.folder / "output/slow.2-of-3.csv")
        self.assertEqual(part.header[0], "part 2 of 3: cases 335 to 667 of 1000")
        self.assertEqual((part.texts("case")[0], part.texts("case")[-1]), ("335", "667"))

    def test_closed_forms_in_parts(self) -> None:
        """Where a block of cases is computed at once, it does not matter which."""
        scene = self.write(FAST, "fast.nml")
        self.run_program(scene)
        names = []
        for number in range(1, 8):
            result = self.run_program(scene, "--shard", f"{number}/7")
            self.assertEqual(result.returncode, 0, result.stderr)
            names.append(f"fast.{number}-of-7.csv")
        self.merge("merged.csv", *names)
        self.assertEqual(self.read("output/merged.csv"), self.read("output/fast.csv"))

    def test_parts_that_do_not_fit(self) -> None:
        """A missing, repeated, foreign or cut part is refused by its name; nothing is written."""
        scene = self.write(FAST, "fast.nml")
        for shard in ("1/2", "2/2", "2/3"):
            self.run_program(scene, "--shard", shard)
        one, two, third = "fast.1-of-2.csv", "fast.2-of-2.csv", "fast.2-of-3.csv"
        self.assertIn("missing of 2 parts: 2", self.merge("fast.csv", one, code=2))
        self.assertIn(f"{one}: it is part 1", self.merge("fast.csv", one, two, one, code=2))
        self.assertIn(f"{third}: it is a part of ", self.merge("fast.csv", one, third, code=2))
        self.assertIn("also one of the parts", self.merge(one, one, two, code=2))
        whole = self.read(f"output/{two}")
        (self.folder / "output" / two).write_bytes(whole[:-200])
        self.assertIn(f"{two}: it has 49", self.merge("fast.csv", one, two, code=2))
        (self.folder / "output" / two).write_bytes(whole)
        (self.folder / "output/fast.csv.part").write_bytes(b"of an interrupted merge")
        self.merge("fast.csv", one, two)
        merged = self.read("output/fast.csv")
        self.run_program(scene)
        self.assertEqual(self.read("output/fast.csv"), merged)
        self.run_program(scene, "--shard", "2/2", "--set", "top.mass=2")
        said = self.merge("fast.csv", one, two, code=2)
        self.assertIn(f"output/{two}: mass = 2\n", said)
        self.assertEqual(self.read("output/fast.csv"), merged)
        for arguments in ([], ["output/fast.csv"]):
            self.assertEqual(self.run_program("merge", *arguments).returncode, 2)

    def test_a_job_array(self) -> None:
        """The script for Slurm, where jobs get no environment, as a job array and under MPI."""
        scene = self.write(FAST.replace("/\n", "/\n&output file = 'named.csv' /\n", 1), "fast.nml")
        self.assertEqual(self.run_program(scene, "-o", "whole").returncode, 0)
        whole = self.read("whole/named.csv")
        for parts, jobs in (("4", 2), ("mpi", 1)):
            with self.subTest(parts):
                self.fake_slurm()
                result = subprocess.run(
                    [ROOT / "scripts/slurm_sweep.sh", "fast.nml", parts, "--time=1"],
                    cwd=self.folder,
                    env=os.environ
                    | {"PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
                    | {"SPINTOP_EXE": PROGRAM, "OUTPUT": "o u t"},
                    capture_output=True,
                    text=True,
                    check=False,
                )
                said = self.read("log").decode()
                self.assertEqual(result.returncode, 0, result.stderr + said)
                self.assertEqual(self.read("calls").count(b"sbatch"), jobs, said)
                self.assertEqual(self.read("o u t/named.csv"), whole)
                shutil.rmtree(self.folder / "o u t")

    def test_a_job_array_of_statistics(self) -> None:
        """Its parts are merged as well, beside those of the rows or without any."""
        text = FAST + "&statistics columns = 'theta_max', over = 'initial.psi_rate', bins = 7 /\n"
        for rows, names in (
            ("all", ["fast.csv", "fast.statistics.csv"]),
            ("none", ["fast.statistics.csv"]),
        ):
            with self.subTest(rows):
                scene = self.write(text + f"&output rows = '{rows}' /\n", "fast.nml")
                self.assertEqual(self.run_program(scene, "-o", "whole").returncode, 0)
                self.fake_slurm()
                result = subprocess.run(
                    [ROOT / "scripts/slurm_sweep.sh", "fast.nml", "3"],
                    cwd=self.folder,
                    env=os.environ
                    | {"PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
                    | {"SPINTOP_EXE": PROGRAM, "OUTPUT": "o u t"},
                    capture_output=True,
                    text=True,
                    check=False,
                )
                said = self.read("log").decode()
                self.assertEqual(result.returncode, 0, result.stderr + said)
                for name in names:
                    self.assertEqual(self.read(f"o u t/{name}"), self.read(f"whole/{name}"), said)
                shutil.rmtree(self.folder / "o u t")
                shutil.rmtree(self.folder / "whole")

    @pytest.mark.slow
    def test_a_job_out_of_time_is_queued_again(self) -> None:
        """The warning ends each task with its rows kept; it requeues itself, and goes on."""
        whole = self.reference
        for parts, jobs in (("2", 2), ("mpi", 1)):
            with self.subTest(parts):
                self.fake_slurm()
                (self.folder / "bin/warn").touch()
                result = subprocess.run(
                    [ROOT / "scripts/slurm_sweep.sh", "slow.nml", parts],
                    cwd=self.folder,
                    env=os.environ
                    | {"PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
                    | {"SPINTOP_EXE": PROGRAM, "OUTPUT": "o u t"},
                    capture_output=True,
                    text=True,
                    check=False,
                )
                said = self.read("log").decode()
                self.assertEqual(result.returncode, 0, result.stderr + said)
                calls = self.read("calls").decode().splitlines()
                self.assertEqual(calls.count("sbatch"), jobs, said)
                self.assertEqual(calls.count("requeue 17" + "_1" * (parts == "2")), 1, said)
                self.assertIn("out of time; queued again", said)
                self.assertRegex(said, r"resumes after \d+ rows")
                self.assertEqual(self.read("o u t/slow.csv"), whole)
                shutil.rmtree(self.folder / "o u t")

    def fake_slurm(self) -> None:
        """An `sbatch` that runs a copy of the script, each task in turn, and an `srun`.

        Both clear the environment, as sites do that have `--export=NONE`. If there is a file
        `warn`, the first task gets the signal that it asked for once it has rows, and runs again if
        it is requeued.
        """
        folder = self.folder / "bin"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        clear = f"env -i PATH='{folder}':/usr/bin:/bin SLURM_CPUS_PER_TASK=1"
        head = f"#!/usr/bin/env bash\ncalls='{self.folder}/calls'\n"
        (self.folder / "calls").write_bytes(b"")
        (self.folder / "log").write_bytes(b"")
        scripts = {
            "sbatch": f"""\
echo sbatch >>"$calls"
[ "$(wc -l <"$calls")" -lt 9 ] || exit 1 # jobs that submit jobs without end
for a; do
    case $a in --array=1-*) tasks=${{a#--array=1-}} ;; */slurm_sweep.sh) break ;; esac
    case $a in --signal=*) signal=${{a#--signal=}} ;; esac
    shift
done
cp "$1" '{folder}/slurm_script' && shift
for ((i = 1; i <= ${{tasks:-1}}; ++i)); do
    job="SLURM_JOB_ID=17"
    if [ -n "${{tasks:-}}" ]; then job+=" SLURM_ARRAY_JOB_ID=17 SLURM_ARRAY_TASK_ID=$i"; fi
    {clear} $job bash '{folder}/slurm_script' "$@" >>'{self.folder}/log' 2>&1 &
    if [ -e '{folder}/warn' ] && [[ $signal = B:USR1@* ]]; then
        rm '{folder}/warn'
        until grep -qs '^rows: [1-9]' '{self.folder}/o u t/'*.journal; do sleep 0.01; done
        kill -USR1 $!
        wait $!
        grep -q requeue "$calls" || exit 1
        {clear} $job bash '{folder}/slurm_script' "$@" >>'{self.folder}/log' 2>&1 &
    fi
    wait $!
done
echo 17
""",
            "scontrol": """\
echo "$@" >>"$calls"
""",
            "srun": f"""\
while [[ $1 = --* ]]; do shift; done
exec {clear} "$@"
""",
        }
        for name, text in scripts.items():
            (folder / name).write_text(head + text, encoding="utf-8")
            (folder / name).chmod(0o755)


class FailingCasesTest(SurvivalCase):
    """Bad cases among good ones."""

    def test_bad_cases_do_not_touch_the_others(self) -> None:
        """About one case in a hundred is no top or starts at a pole; each is named."""
        thetas = [10 + 0.1 * i for i in range(200)]
        inertias = [0.2 + 0.005 * i for i in range(200)]
        text = (SLOW.replace("theta_deg = 20", "psi_rate = 3").replace(STEPS, "steps = 4")).split(
            "&sweep"
        )[0]

        def sweep(first: list[float], second: list[float], code: int) -> Table:
            axes = ((1, "top.inertia(3)", first), (2, "initial.theta_deg", second))
            lines = [
                f"parameter({i}) = '{name}', values({i},:) = " + ",\n ".join(map(repr, values))
                for i, name, values in axes
            ]
            scene = self.write(text + "&sweep " + "\n".join(lines) + " /\n", "bad.nml")
            result = self.run_program(scene)
            self.assertEqual(result.returncode, code, result.stderr)
            for line in result.stdout.splitlines():
                self.assertNotIn("internal", line)
            return self.table("bad")

        good = sweep(inertias, thetas, 0)
        bad = sweep([*inertias[:77], 1.8, *inertias[77:]], [*thetas[:123], 0, *thetas[123:]], 3)
        self.assertEqual(len(bad.rows), 201 * 201)
        status, notes = bad.names.index("status"), bad.names.index("notes")
        expected = {(1.8, theta): "bad_input" for theta in [*thetas, 0]}
        expected |= {(inertia, 0.0): "pole" for inertia in inertias}
        left = []
        for row in bad.rows:
            case = (float(row[1]), float(row[2]))
            if row[status] == "ok":
                left.append(row[1:])
                continue
            self.assertEqual(row[status], expected.pop(case))
            self.assertNotEqual(row[notes], "")
        self.assertEqual(expected, {})
        self.assertEqual(left, [row[1:] for row in good.rows])
