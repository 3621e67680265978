"""The environment of the run-time library of gfortran changes nothing that the program writes."""

import re
import subprocess
from pathlib import Path

import pytest

from conftest import GOOD

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
CALLS = {
    "trajectory": ("motion.nml",),
    "sweep": ("sweep.nml",),
    "check": ("sweep.nml", "--check"),
    "list": ("list", "methods", "--json"),
    "refusal": ("sweep.nml", "--set", "top.mass=-1"),
}


def variables():
    """The documented variables, and what else looks like one in the library of this compiler."""
    names = {f"GFORTRAN_{name}" for name in DOCUMENTED.split()}
    asked = ["gfortran", "-print-file-name=libgfortran.so"]
    library = Path(subprocess.run(asked, check=True, capture_output=True, text=True).stdout.strip())
    if library.is_file():  # there may be a static one alone
        found = re.findall(rb"\0(GFORTRAN_[A-Z_]+)(?=\0)", library.read_bytes())
        names |= {name.decode() for name in found}
    return sorted(names)


NAMES = variables()
SETTINGS = [{name: value} for name in NAMES for value in ("y", "6")]
SETTINGS += [dict.fromkeys(NAMES, "y"), dict.fromkeys(NAMES, "1")]


def outputs(spin, environment):
    """What the program writes with these variables: codes, streams and tables."""
    found = {}
    for call, words in CALLS.items():
        run = spin.call(*words, code=tuple(range(-20, 256)), environment=environment)
        found[call] = run.code, MEASURED.sub("", run.out + run.stderr)
    for path in sorted((spin.folder / "output").glob("*.csv")):
        found[path.name] = MEASURED.sub("", path.read_text(encoding="utf-8"))
        path.unlink()
    return found


@pytest.mark.parametrize("setting", SETTINGS, ids=lambda one: " ".join(map("=".join, one.items())))
def test_variables_of_the_library(spin, setting):
    """The same bytes with each of them, and with all."""
    spin.write(GOOD, "motion.nml")
    spin.write(SWEEP, "sweep.nml")
    expected = outputs(spin, {})
    assert [expected[call][0] for call in CALLS] == [0, 0, 0, 0, 2]
    assert {"motion.csv", "sweep.csv"} < set(expected)
    assert outputs(spin, setting) == expected
