"""The environment of the run-time library of gfortran changes nothing that the program writes."""

import re
import subprocess
import unittest
from pathlib import Path

from program_test import GOOD, ProgramCase

SWEEP = GOOD.split("&output")[0] + (
    "&study kind = 'sweep' /\n"
    "&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 2, count(1) = 9 /\n"
)
MEASURED = re.compile(
    r"^(!? +(cost|time|ended|parts|memory|columns +with) |# date:).*\n", re.MULTILINE
)
"""Lines of a summary and of a header that differ from run to run."""


DOCUMENTED = (
    "STDIN_UNIT STDOUT_UNIT STDERR_UNIT UNBUFFERED_ALL UNBUFFERED_PRECONNECTED SHOW_LOCUS"
    " OPTIONAL_PLUS LIST_SEPARATOR CONVERT_UNIT ERROR_BACKTRACE FORMATTED_BUFFER_SIZE"
    " UNFORMATTED_BUFFER_SIZE"
)
"""The variables of the manual of gfortran, without their prefix."""


def variables() -> list[str]:
    """The documented variables, and what else looks like one in the library of this compiler."""
    names = {f"GFORTRAN_{name}" for name in DOCUMENTED.split()}
    asked = ["gfortran", "-print-file-name=libgfortran.so"]
    library = Path(subprocess.run(asked, check=True, capture_output=True, text=True).stdout.strip())
    if library.is_file():  # there may be a static one alone
        found = re.findall(rb"\0(GFORTRAN_[A-Z_]+)(?=\0)", library.read_bytes())
        names |= {name.decode() for name in found}
    return sorted(names)


class EnvironmentTest(ProgramCase):
    """Each variable of the library, switched on."""

    def outputs(self, **environment: str) -> dict[str, str | int]:
        """What the program writes with these variables: tables, streams and codes."""
        found: dict[str, str | int] = {}
        folder = f"output {len(list(self.folder.iterdir()))}"
        calls = {
            "trajectory": (self.scene, "-o", folder),
            "sweep": (self.sweep, "-o", folder),
            "check": (self.sweep, "--check"),
            "list": ("list", "methods", "--json"),
            "refusal": (self.sweep, "--set", "top.mass=-1"),
        }
        for call, arguments in calls.items():
            result = self.run_program(*arguments, environment=environment)
            text = MEASURED.sub("", result.stdout + result.stderr)
            found[call] = f"{result.returncode}\n{text.replace(folder, 'output')}"
        for path in sorted((self.folder / folder).glob("*.csv")):
            found[path.name] = MEASURED.sub("", path.read_text(encoding="utf-8"))
        return found

    def setUp(self) -> None:
        """A trajectory and a sweep."""
        super().setUp()
        self.scene = self.write(GOOD, "motion.nml")
        self.sweep = self.write(SWEEP, "sweep.nml")

    def test_variables_of_the_library(self) -> None:
        """The same bytes with each of them, and with all."""
        expected = self.outputs()
        self.assertEqual({text.split("\n")[0] for text in expected.values()} & {"5", "-11"}, set())
        self.assertIn("sweep.csv", expected)
        names = variables()
        settings = [{name: value} for name in names for value in ("y", "6")]
        for setting in [*settings, dict.fromkeys(names, "y"), dict.fromkeys(names, "1")]:
            with self.subTest(setting):
                self.assertEqual(self.outputs(**setting), expected)


if __name__ == "__main__":
    unittest.main()
