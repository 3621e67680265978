"""Names of files with characters that a terminal obeys: shown on one line, escaped."""

import unittest
from pathlib import Path

from program_test import GOOD, ProgramCase

NAME = "a\nb\tc\x1b[31m.nml"
SHOWN = "a\\nb\\tc\\x1b[31m"
SWEEP = GOOD.split("&output")[0] + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 3 /\n"
)


class FileNamesTest(ProgramCase):
    """Messages about files with arbitrary names."""

    def check(self, said: str) -> None:
        """The message contains the printable form of the name, and no control characters."""
        self.assertIn(SHOWN, said)
        self.assertNotIn("\x1b", said)
        for line in said.splitlines():
            self.assertFalse(line.startswith(("b ", "b\t", "b?")), said)

    def named(self, text: str) -> Path:
        """A file of that name."""
        path = self.folder / NAME
        path.write_text(text, encoding="utf-8")
        return path

    def test_every_kind_of_study(self) -> None:
        """Summaries, the explanation of --check, which is an input, and progress."""
        for text in (GOOD, SWEEP):
            scene = self.named(text)
            for options in ((), ("--check",), ("--progress",)):
                run = self.run_program(scene, *options)
                self.assertEqual(run.returncode, 0, run.stderr)
                self.check(run.stdout)
                if run.stderr:
                    self.check(run.stderr)
        run = self.run_program(self.named(GOOD), "--check")
        again = self.run_program(self.write(run.stdout, "again.nml"), "--check")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_messages(self) -> None:
        """Errors in a file, and two files of one table."""
        run = self.run_program(self.named(GOOD.replace("mass", "maas")))
        self.assertEqual(run.returncode, 2)
        self.check(run.stderr)
        scene = self.named(GOOD)
        run = self.run_program(scene, scene)
        self.assertEqual(run.returncode, 2)
        self.check(run.stderr)


if __name__ == "__main__":
    unittest.main()
