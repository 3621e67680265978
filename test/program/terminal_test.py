"""Tests of what a terminal shows: widths, colours, the plan of --check, the topics of list."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios
import unittest
from pathlib import Path

from program_test import PROGRAM, ROOT, ProgramCase

COLUMNS = 60
ESCAPE = "\x1b["


class TerminalTest(ProgramCase):
    """The program on a terminal of 60 columns."""

    def show(self, *arguments: str | Path, columns: int = COLUMNS, **environment: str) -> str:
        """Run the program on a terminal; what it shows."""
        try:
            ours, its = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminal can be opened: {error}")
        fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        known = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
        process = subprocess.Popen(
            [PROGRAM, *arguments],
            cwd=self.folder,
            env=known | {"TERM": "xterm"} | environment,
            stdout=its,
            stderr=its,
            close_fds=True,
        )
        os.close(its)
        shown = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            shown += piece
        os.close(ours)
        process.wait()
        return shown.decode().replace("\r\n", "\n")

    def test_plan_comes_last(self) -> None:
        """After the input, as comments, as wide as the terminal; together they can be run."""
        scene = ROOT / "input/slow_top.nml"
        shown = self.show("--check", scene)
        lines = shown.splitlines()
        comments = [line for line in lines if line.startswith("!")]
        self.assertEqual(lines[-len(comments) :], comments)
        self.assertEqual(lines[0], "&study")
        self.assertGreater(len(comments), 12)
        words = [line for line in comments if " " in line.strip("! ")]
        self.assertLessEqual(max(map(len, words)), COLUMNS)
        self.assertIn(
            "!   fast top  (I3 omega3)^2/(2 I1 m g l) = 0.0042038027\n!             (much", shown
        )
        again = self.run_program(self.write(shown, "again.nml"), "--check")
        self.assertEqual(again.returncode, 0, again.stderr)
        wide = self.run_program("--check", scene).stdout
        fast = next(line for line in wide.splitlines() if line.startswith("!   fast"))
        self.assertTrue(fast.endswith("0.0073566548)"))

    def test_groups_that_matter(self) -> None:
        """Those of the study, given or not, and those that the input gives."""

        def groups(name: str, *options: str) -> list[str]:
            text = self.run_program("--check", ROOT / "input" / f"{name}.nml", *options).stdout
            return re.findall(r"^&(\w+)", text, re.MULTILINE)

        case = ["study", "top", "initial", "span", "integration", "output"]
        self.assertEqual(groups("slow_top"), case)
        self.assertEqual(groups("spinning_wheel_sweep"), [*case, "sweep"])
        self.assertNotIn("sweep", groups("work_precision_slow_top"))
        self.assertIn("sweep", groups("slow_top", "--set", "sweep.seed=3"))
        self.assertNotIn("initial", groups("stability"))

    def test_colours(self) -> None:
        """Errors and marks have colours on a terminal, unless NO_COLOR is set or it is dumb."""
        wrong = self.write("&study kind = 'trajectoryy' /\n")
        shown = self.show(wrong)
        self.assertIn(f": {ESCAPE}1;31merror:{ESCAPE}0m ", shown)
        self.assertIn(f"{ESCAPE}1;32m^", shown)
        plain = re.sub(r"\x1b\[[0-9;]*m", "", shown)
        for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
            self.assertEqual(self.show(wrong, **environment), plain)
        self.assertNotIn(ESCAPE, self.run_program(wrong).stderr)

    def test_topics(self) -> None:
        """`list` alone lists the topics, each of which can be listed."""
        alone = self.run_program("list")
        self.assertEqual((alone.returncode, alone.stderr), (0, ""))
        topics = re.findall(r"^  (\w+) {2,}\w", alone.stdout, re.MULTILINE)
        self.assertEqual(len(topics), 12)
        for topic in topics:
            self.assertEqual(self.run_program("list", topic).returncode, 0, topic)
        self.assertLessEqual(max(map(len, self.show("list").splitlines())), COLUMNS)

    def test_summary(self) -> None:
        """The summary of a run is as wide as the terminal."""
        shown = self.show("--quiet", ROOT / "input/slow_top.nml", "--set", "span.samples=11")
        words = [line for line in shown.splitlines() if line.startswith("  ")]
        self.assertLessEqual(max(map(len, words)), COLUMNS)
        self.assertIn("status    ok at t", shown)

    def test_progress(self) -> None:
        """A bar that is overwritten, in a line that has room."""
        options = ("--set", "sweep.count(1)=60", "--set", "sweep.count(2)=50", "--threads", "1")
        columns = ("--set", "output.columns=theta_max,orientation_error,evaluations")
        method = ("--set", "integration.method=rk4", "--set", "integration.steps=2000")
        for width in (100, COLUMNS):
            arguments = (ROOT / "input/map_spin_tilt.nml", *options, *columns, *method)
            shown = self.show(*arguments, columns=width)
            lines = [line for line in shown.split("\r") if line.startswith("map_spin_tilt:")]
            self.assertTrue(lines)
            for line in lines:
                bar = r"\[#*\.*\] " if width > COLUMNS else ""
                self.assertRegex(line, rf"map_spin_tilt: {bar}\d+ %, \d+ of 3000 ca")
                self.assertLess(len(line.partition(ESCAPE)[0]), width)


if __name__ == "__main__":
    unittest.main()
