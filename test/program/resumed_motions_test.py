"""Trajectories that are killed and resumed have the bytes of those that nothing stopped."""

import os
import random
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from program_test import IS_OPTIMISED, PROGRAM, ProgramCase

BODY = """\
&top mass = 1.0, inertia = 0.7, 0.875, 0.25, centre_of_mass = 0, 0, 0.5 /
&initial theta_deg = 20, psi_rate = 12, theta_rate = 0.3 /
"""
TOP = """\
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20, psi_rate = 12, theta_rate = 0.3 /
"""
DATE = "2026-01-01T00:00:00Z"
FRICTION = "&effects friction_torque = 0.00005, drag_moment = 3*0.00001 /\n"


def motion(body: str, span: str, integration: str, output: str = "") -> str:
    """An input of one to three seconds."""
    return (
        f"{body}&span {span} /\n&integration {integration}, max_steps = 100000000 /\n"
        f"&output {output} /\n"
    )


STEPPING = "formulation = 'rigid_body', method = "
TURNING = "events = 'turning_points', 'psi_deg = 10 every turn'"
MOTIONS = {
    "adaptive, with events": motion(
        BODY, "t_end = 4000, samples = 60001", "method = 'taylor'", TURNING
    ),
    "to an event, computed twice": motion(
        BODY,
        "t_end = 90000, samples = 40001, stop_at = 'turning_points', stop_after = 20000",
        "method = 'taylor'",
        "events = 'theta_deg = 30'",
    ),
    "exact, to an event": motion(
        TOP,
        "t_end = 400000, samples = 300001, stop_at = 'theta_deg = 20.5', stop_after = 30000",
        "method = 'exact'",
        "events = 'turning_points'",
    ),
    "friction, drag and their work": motion(
        BODY + FRICTION, "t_end = 5000, samples = 30001", "method = 'dop853'"
    ),
    "implicit": motion(BODY, "t_end = 300, samples = 3001", STEPPING + "'gauss_4', steps = 300000"),
    "splitting": motion(
        BODY, "t_end = 1000, samples = 30001", STEPPING + "'splitting_4', steps = 600000"
    ),
    "ode45": motion(BODY, "t_end = 800, samples = 30001", STEPPING + "'ode45'"),
    "ARKODE": motion(
        BODY, "t_end = 300, samples = 30001", STEPPING + "'arkode_erk', steps = 450000"
    ),
}
# One of them.
ONE = MOTIONS["adaptive, with events"]


class MotionCase(ProgramCase):
    """Runs of trajectories that may be killed."""

    def compute(self, scene: Path, *arguments: str | Path, code: int = 0) -> str:
        """Run a scene to its end; returns all that was said."""
        result = self.run_program(scene, *arguments)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def interrupt(self, scene: Path, table: str, changes: int, *arguments: str | Path) -> bool:
        """Kill a run when its journal changed so often; whether it has not ended before that."""
        journal = self.folder / f"{table}.journal"
        before = content(journal)
        run = subprocess.Popen(
            [PROGRAM, scene, "--resume", *map(str, arguments)],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        deadline = time.monotonic() + 300
        while run.poll() is None and time.monotonic() < deadline:
            now = content(journal)
            changes -= now not in (before, b"")
            if changes == 0:
                break
            before = now or before
            time.sleep(0.005)
        run.kill()
        return run.wait() != 0

    def interrupt_any(self, text: str, table: str, changes: int, *arguments: str | Path) -> Path:
        """Kill a run of a motion, made so much longer that the machine does not end it before."""
        for longer in (1, 4, 16, 64, 256):
            shutil.rmtree(self.folder / "output", ignore_errors=True)
            scene = self.write(prolonged(text, longer), "slow.nml")
            if self.interrupt(scene, table, changes, *arguments):
                return scene
        return self.fail("no motion takes long enough to be interrupted")

    def contents(self, folder: str) -> dict[str, bytes]:
        """The files of a folder, without the line of the date."""
        files = sorted((self.folder / folder).iterdir())
        return {path.name: undated(path.read_bytes()) for path in files}

    def check_same(self, folder: str) -> None:
        """A folder has the files of that of the uninterrupted run, and nothing else."""
        found, wanted = self.contents(folder), self.contents("whole")
        self.assertEqual(sorted(found), sorted(wanted))
        for name, content in found.items():
            self.assertTrue(content == wanted[name], f"{name} differs")


def content(path: Path) -> bytes:
    """The bytes of a file, none if it is not there."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""


def prolonged(text: str, factor: int) -> str:
    """An input with a longer span, and as many more steps."""
    return re.sub(r"\b(t_end|steps) = (\d+)", lambda m: f"{m[1]} = {int(m[2]) * factor}", text)


def undated(content: bytes) -> bytes:
    """A table without the line of its date."""
    return b"".join(
        line for line in content.splitlines(keepends=True) if not line.startswith(b"# date: ")
    )


class ResumedMotionTest(MotionCase):
    """Killed at several entries of the journal."""

    @pytest.mark.slow
    def test_every_method(self) -> None:
        """Events, work and energies: all tables are the same, and nothing else is left."""
        entries = random.Random(1)
        for name, text in MOTIONS.items() if IS_OPTIMISED else ():
            with self.subTest(name):
                scene = self.interrupt_any(text, "output/slow.csv", entries.randint(1, 3))
                self.interrupt(scene, "output/slow.csv", entries.randint(1, 3))
                self.compute(scene, "--resume")
                shutil.rmtree(self.folder / "whole", ignore_errors=True)
                self.compute(scene, "-o", "whole")
                self.check_same("output")

    def test_netcdf(self) -> None:
        """With compression and without, where the build has NetCDF."""
        text = ONE.replace(TURNING, "format = 'netcdf'")
        scene = self.write(text, "slow.nml")
        if "no NetCDF" in self.run_program("--check", scene).stderr:
            self.skipTest("this build has no NetCDF")
        for setting in ("output.file=slow", "output.compression=5"):
            if "no format NetCDF-4" in self.run_program("--check", scene, "--set", setting).stderr:
                continue
            scene = self.interrupt_any(text, "output/slow.nc", 1, "--set", setting)
            said = self.compute(scene, "--resume", "--set", setting)
            self.assertRegex(said, r"resumes after \d+ rows of an interrupted run")
            self.compute(scene, "--set", setting, "-o", "whole")
            table = self.folder / "output/slow.nc"
            resumed, whole = table.read_bytes(), (self.folder / "whole/slow.nc").read_bytes()
            self.assertEqual(len(resumed), len(whole))
            differing = [i for i in range(len(whole)) if whole[i] != resumed[i]]
            # Only the date may differ, and in NetCDF-4 the checksum of its block.
            self.assertLessEqual(len(differing), len(DATE) + 8)
            table.unlink()


class RefusalTest(MotionCase):
    """Nothing is discarded unasked, nothing continued that is not the same."""

    def setUp(self) -> None:
        """A run that was killed."""
        super().setUp()
        self.slow = self.interrupt_any(ONE, "output/slow.csv", 1)

    def test_damage_and_strangers(self) -> None:
        """A part, a state or a table of events that was changed; another input."""
        said = self.compute(self.slow, code=2)
        self.assertIn("an interrupted run of output/slow.csv is there", said)
        said = self.compute(self.slow, "--resume", "--set", "top.mass=2", code=2)
        self.assertIn("was made by another program, build or input", said)
        output = self.folder / "output"
        journal = (output / "slow.csv.journal").read_text(encoding="ascii")
        (state,) = (line for line in journal.splitlines() if line.startswith("state: "))
        for name in (f"slow.csv.state{state.split()[1]}", "slow.csv.part", "slow.events.csv.part"):
            kept = (output / name).read_bytes()
            middle = len(kept) // 4
            (output / name).write_bytes(
                kept[:middle] + bytes([kept[middle] ^ 1]) + kept[middle + 1 :]
            )
            said = self.compute(self.slow, "--resume", code=2)
            self.assertRegex(said, f"cannot resume output/slow.*{name} was changed after it was")
            self.assertIn("--restart discards it and computes all from the beginning", said)
            (output / name).write_bytes(kept)
        (output / f"slow.csv.state{state.split()[1]}").unlink()
        self.assertIn("cannot resume output/slow.csv", self.compute(self.slow, "--resume", code=2))

    def test_complete_and_restarted(self) -> None:
        """A complete table stays; an interrupted run is discarded on request only."""
        said = self.compute(self.slow, "--restart")
        self.assertIn("discards an interrupted run", said)
        kept = self.contents("output")
        self.assertEqual(sorted(kept), ["slow.csv", "slow.events.csv"])
        said = self.compute(self.slow, "--resume")
        self.assertIn("nothing was computed: the table is already complete", said)
        self.assertEqual(self.contents("output"), kept)

    def test_a_run_without_a_journal(self) -> None:
        """A short motion has none, and starts from the beginning."""
        for path in (self.folder / "output").iterdir():
            path.unlink()
        said = self.compute(self.slow, "--resume", "--set", "span.t_end=1")
        self.assertIn("nothing to resume: the run starts from the beginning", said)


class FullDiskTest(MotionCase):
    """A disk on which there is no more room."""

    def test_a_disk_that_fills_up(self) -> None:
        """Exit code 4; with more room the motion is resumed."""
        scene = self.write(ONE.replace("t_end = 4000", "t_end = 8000"), "slow.nml")
        self.compute(scene, "-o", "whole")
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=16m", "none", disk]
        if (
            os.geteuid() != 0
            or subprocess.run(command, capture_output=True, check=False).returncode
        ):
            self.skipTest("takes root")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        said = self.compute(scene, "-o", disk, code=4)
        self.assertIn("No space left on device", said)
        self.assertFalse((disk / "slow.csv").exists())
        subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
        self.compute(scene, "-o", disk, "--resume")
        self.check_same("disk")
