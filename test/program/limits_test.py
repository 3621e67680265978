"""Limits of the system: memory, stack, standard streams."""

import os
import platform
import re
import resource
import shutil
import subprocess
import unittest
from pathlib import Path

from program_test import GOOD, PROGRAM, ProgramCase

SWEEP = GOOD.split("&output")[0] + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 40 /\n"
)
LEAST_STACK = 448 * 1024  # that is accepted


def limited(kind: int, size: int) -> object:
    """A function that sets a limit in a child process."""
    return lambda: resource.setrlimit(kind, (size, size))


class StackTest(ProgramCase):
    """The smallest accepted stack, of the first thread and of the others."""

    def small(self, *arguments: str | Path, code: int = 0, size: int = LEAST_STACK) -> str:
        """Run with small stacks; returns what was said."""
        result = self.run_program(
            *arguments,
            "--threads",
            "2",
            preexec_fn=limited(resource.RLIMIT_STACK, size),
            environment={"OMP_STACKSIZE": f"{size // 1024}k"},
        )
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stderr}")
        return result.stdout + result.stderr

    def test_every_kind_of_study(self) -> None:
        """The inputs that come with the program, and what costs most."""
        names = ("slow_top", "slow_top_lagrange_cn2", "slow_top_lagrange_ode45", "slow_top_events")
        names += ("damped_top", "rigid_body_chaotic", "separatrix", "spinning_wheel_sweep")
        self.small(*map(self.scene, names))
        everything = ["--set", "output.columns=all"]
        sweep = self.write(SWEEP.replace("steps = 10", "steps = 100"), "sweep.nml")
        self.small(sweep, *everything)
        exact = self.write(SWEEP.split("&integration")[0] + "&study" + SWEEP.split("&study")[1])
        self.small(exact, *everything)
        self.small(exact, "--set", "span.stop_at=lower_turning_points", "--set", "span.t_end=9")
        self.small(self.scene("random_tops"), "--set", "sweep.cases=600")
        self.small(self.scene("damped_bodies"), "--set", "sweep.count=600")

    def test_comparisons(self) -> None:
        """A stability study and a work-precision study."""
        stability = self.write(
            "&study kind = 'stability' /\n&stability cases = 'sleeping_above' /\n"
        )
        self.small(stability)
        precision = self.write(
            GOOD.split("&integration")[0]
            + "&study kind = 'work_precision' /\n&work_precision methods = 'rk4', 'taylor',"
            " steps = 100, tolerances = 1e-6, repeats = 1 /\n",
            "precision.nml",
        )
        self.small(precision)
        self.small(precision, "--set", "work_precision.reference=quadruple")

    def test_lists_and_merge(self) -> None:
        """Commands that are not studies."""
        for topic in ("methods", "columns", "parameters", "cases"):
            result = self.run_program(
                "list", topic, preexec_fn=limited(resource.RLIMIT_STACK, LEAST_STACK)
            )
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_too_small_a_stack_is_refused(self) -> None:
        """Exit code 2 before anything is done, with what to do."""
        scene = self.write(SWEEP)
        said = self.small(scene, size=LEAST_STACK - 4096, code=2)
        self.assertIn("the stack limit is 444 kB", said)
        self.assertIn("ulimit -s", said)
        for text, kilobytes in (("100k", 100), ("100", 100), (" 65536 b ", 64), ("0M", 0)):
            for name in ("OMP_STACKSIZE", "GOMP_STACKSIZE"):
                result = self.run_program(scene, environment={name: text})
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(f"a stack of {kilobytes} kB", result.stderr)
                self.assertIn("OMP_STACKSIZE", result.stderr)
        self.assertEqual(self.produced(), [])
        for text in ("512K", "1 M", "2g", "nonsense"):
            result = self.run_program(scene, environment={"OMP_STACKSIZE": text})
            self.assertEqual(result.returncode, 0, f"{text}: {result.stderr}")

    @unittest.skipUnless(os.environ.get("SPINTOP_TEST_KIND") == "release", "frames of other builds")
    @unittest.skipUnless(platform.machine() == "x86_64", "instructions of another processor")
    @unittest.skipUnless(shutil.which("objdump"), "there is no objdump")
    def test_no_procedure_takes_much(self) -> None:
        """A third of the smallest stack at most, so that those that call each other fit into it."""
        command = ["objdump", "--disassemble", "--no-show-raw-insn", PROGRAM]
        code = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        frames: dict[str, int] = {}
        pattern = r"^[0-9a-f]+ <(?P<name>.*)>:$|\bsub +\$0x(?P<size>[0-9a-f]{1,8}),%rsp"
        name = ""
        for found in re.finditer(pattern, code, re.MULTILINE):
            if found["size"] is None:
                name = found["name"]
            else:
                frames[name] = max(frames.get(name, 0), int(found["size"], 16))
        self.assertGreater(len(frames), 1000)
        much = {name: size for name, size in frames.items() if size > LEAST_STACK / 3}
        self.assertEqual(much, {}, "bytes on the stack")


class MemoryTest(ProgramCase):
    """Memory that cannot be had: exit code 5, and a message."""

    def short(self, *arguments: str | Path, megabytes: int) -> str:
        """Run with little memory; it must not do. Returns what was said."""
        result = self.run_program(
            *arguments, preexec_fn=limited(resource.RLIMIT_AS, megabytes * 2**20)
        )
        self.assertEqual(result.returncode, 5, result.stdout + result.stderr)
        return result.stderr

    def test_too_many_rows(self) -> None:
        """Nothing is begun."""
        scene = self.write(
            GOOD.replace("method = 'rk4'", "method = 'ode45'").replace("steps = 10", "")
        )
        said = self.short(scene, "--set", "span.samples=2000000000", megabytes=1000)
        self.assertIn("not enough memory for the times of 2000000000 rows", said)
        self.assertIn("span.samples", said)
        self.assertEqual(self.produced(), ["output"])

    def test_too_many_threads(self) -> None:
        """Resources that the run-time library cannot get."""
        scene = self.write(SWEEP)
        said = self.short(scene, "--threads", "500", megabytes=200)
        self.assertIn("there is no more memory", said)
        self.assertFalse((self.folder / "output/scene.csv").exists())


class StreamTest(ProgramCase):
    """Standard streams that are full, closed, or no longer read."""

    def call(self, redirection: str, *arguments: str | Path) -> subprocess.CompletedProcess:
        """Call the program from a shell with a redirection."""
        return subprocess.run(
            ["bash", "-c", f'exec "$@" {redirection}', "bash", PROGRAM, *map(str, arguments)],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )

    def test_output_that_takes_nothing(self) -> None:
        """Exit code 4 and a message, for every command."""
        scene, sweep = self.write(), self.write(SWEEP, "sweep.nml")
        parts = []
        for number in (1, 2):
            self.run_program(sweep, "--shard", f"{number}/2")
            parts.append(f"output/sweep.{number}-of-2.csv")
        calls = (
            ["--help"],
            ["--version"],
            ["list", "columns"],
            ["--check", scene],
            [scene],
            [sweep],
            ["merge", "output/merged.csv", *parts],
        )
        for redirection, reason in (
            (">/dev/full", "No space left on device"),
            (">&-", "Bad file descriptor"),
        ):
            for arguments in calls:
                with self.subTest(redirection, arguments=arguments):
                    result = self.call(redirection, *arguments)
                    self.assertEqual(result.returncode, 4, result.stderr)
                    self.assertEqual(result.stderr, f"cannot write to standard output: {reason}\n")
        # The tables are complete.
        self.assertEqual(self.table("scene").last_line, "# status: ok")
        self.assertEqual(len(self.table("sweep").rows), 40)
        self.assertEqual(self.table("merged").rows, self.table("sweep").rows)

    def test_other_inputs_run_all_the_same(self) -> None:
        """That a summary is lost does not keep the next table from being written."""
        one, two = self.write(), self.write(name="two.nml")
        self.assertEqual(self.call(">/dev/full", one, two).returncode, 4)
        self.assertEqual(self.table("two").rows, self.table("scene").rows)

    def test_closed_streams_do_not_leak_into_files(self) -> None:
        """A file does not get the number of a closed stream, and with it what is said there."""
        sweep = self.write(SWEEP, "sweep.nml")
        self.assertEqual(self.run_program(sweep, "-o", "open").returncode, 0)
        expected = (self.folder / "open/sweep.csv").read_bytes()
        for redirection, code in (("<&-", 0), ("2>&-", 0), (">&- 2>&-", 4), ("<&- >&- 2>&-", 4)):
            with self.subTest(redirection):
                result = self.call(redirection, sweep, "--progress")
                self.assertEqual(result.returncode, code)
                self.assertEqual((self.folder / "output/sweep.csv").read_bytes(), expected)

    def test_errors_that_nobody_reads(self) -> None:
        """A full standard error changes neither the table nor the exit code."""
        sweep = self.write(SWEEP, "sweep.nml")
        result = self.call("2>/dev/full", sweep, "--progress")
        self.assertEqual(result.returncode, 0)
        self.assertEqual(len(self.table("sweep").rows), 40)
        self.assertEqual(self.call("2>/dev/full", "--bad").returncode, 2)

    def test_a_reader_that_has_gone(self) -> None:
        """SIGPIPE, as of any program: 128 and its number in a shell."""
        result = subprocess.run(
            ["bash", "-c", '("$0" list columns; echo $? >&2) | true', PROGRAM],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertIn(result.stderr, ("141\n", "0\n"))


class PlaceTest(ProgramCase):
    """Places where tables cannot be."""

    def test_a_folder_under_the_name_of_the_table(self) -> None:
        """Exit code 4, and nothing else is left."""
        for scene in (self.write(), self.write(SWEEP, "sweep.nml")):
            (self.folder / f"output/{scene.stem}.csv").mkdir(parents=True)
            result = self.run_program(scene)
            self.assertEqual(result.returncode, 4)
            self.assertIn(f"output/{scene.stem}.csv: it is a folder", result.stderr)
            left = [path.name for path in (self.folder / "output").iterdir()]
            self.assertNotIn(f"{scene.stem}.csv.part", left)

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_a_folder_that_may_not_be_written(self) -> None:
        """Exit code 4."""
        (self.folder / "output").mkdir(mode=0o500)
        self.assertEqual(self.run_program(self.write()).returncode, 4)
