"""Every script with values that another program could read as options, expressions or patterns.

The scripts run in a copy of the checkout, in which each program that they call first writes down
its arguments. Programs that would install, build or measure do nothing more than that.
"""

import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import ClassVar, NamedTuple

from conftest import EXE, ROOT

COPIED = (
    *("scripts", ".ci", "python", "include", "input", "doc", "packaging", "fpm.toml", "README.md"),
    *("CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "src/tables/provenance.f90"),
)

DASHED = "-dashed"
MARK = "odd"
ODD = f"""{MARK} 'a" * [b] ? ! ; = %s \\n\n$(touch evil) `touch evil`"""
"""Begins with a word that it cannot be without, if it is passed on as one word."""
VALUES = (DASHED, ODD)
BOTH = f"{DASHED} {ODD}"
"""For scripts in Python, whose start takes long."""

INPUT = """&study kind = 'trajectory' /
&top mass = 1.0 inertia = 0.875, 0.875, 0.25 length = 0.8 /
&initial theta_deg = 10.0 psi_rate = 1.0 /
&span t_end = 0.1 samples = 9 /
"""
CANARY = "precious.csv"

HARMLESS = """awk basename bash cat chmod cmp comm cp cut date dirname echo env false find flock
grep gzip head id install ln ls mkdir mktemp mv nproc printf python3 readlink realpath rm rmdir sed
seq sh sha256sum sort stat tail tee touch tr true tsort uname wc xargs"""
HARMLESS = set(re.findall(r"\S+", HARMLESS))
"""Programs that are carried out; all others succeed without doing anything."""
FAILS = {"mountpoint"}
"""Programs that fail: so that a script goes on."""

SHIM = """#!/bin/bash
printf '%s\\0' "${{0##*/}}" "$#" "$@" >"$SPINTOP_TEST_LOG/$EPOCHREALTIME.$$"
{action}
"""
PYTHON = """case "$*" in
*'-m fpm install'*)
    while [ "$1" != --prefix ]; do shift; done
    mkdir -p "$2/bin" "$2/lib" && touch "$2/lib/libspintop.a" && cp {program} "$2/bin/spintop" ;;
"-c import ensurepip"*|-m\\ fpm*|-m\\ pip*|-m\\ venv*|-m\\ ruff*|-m\\ fortitude*|-m\\ gcovr*) ;;
*) exec {python} "$@" ;;
esac"""

OWN_OPTIONS = ("-o", "--output", "--set", "--threads", "--shard", "--written")
"""Options of the program, each of which takes the next argument whatever it is."""
WRONG = re.compile(
    r"Traceback|(invalid|unrecognized|illegal|unknown) (option|predicate)|missing operand"
    r"|unbound variable|integer expression|operator expected|too many arguments|ambiguous redirect"
)
"""Complaints of a program about its arguments, or of a script that broke."""
VARIABLE = re.compile(r"\$\{?([A-Z][A-Z0-9_]{3,})|environ\.get\(\"([A-Z_]+)\"")
USUAL = {"INPUT.nml": "a.nml", "PARTS": "3", "COMMAND": "true", "PROGRAM": EXE, "OUTPUT": "results"}
"""What stands for the words of a usage that are not those under test."""

HAND_ON = {Path("scripts/test"), Path("scripts/compiler/gfortran")}
"""Their words are those of pytest and of the compiler."""
OTHERS = re.compile("BASH_SOURCE|PATH|CMAKE_.*|PACKAGE_.*|SPINTOP_FLAGS")
"""Variables that are none of the environment, and one that holds options by its purpose."""


SCRIPTS = [
    path.relative_to(ROOT)
    for path in sorted([*(ROOT / "scripts").rglob("*"), ROOT / ".ci/run"])
    if path.is_file() and os.access(path, os.X_OK) and "node_modules" not in path.parts
]


def quote(text: object) -> str:
    return "'" + str(text).replace("'", "'\\''") + "'"


def write_shim(path: Path, action: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(SHIM.format(action=action), encoding="utf-8")
    path.chmod(0o755)


class Call(NamedTuple):
    program: str
    words: tuple[str, ...]

    def faults(self, value: str) -> Iterator[str]:
        """What is wrong with it."""
        for place, word in enumerate(self.words):
            if MARK in word and value not in word:
                yield f"part of a value as a word: {word!r}"
            if not word.startswith(DASHED):
                continue
            before = self.words[:place]
            is_own = self.program == "spintop" or any(
                word.endswith(("scripts/run", "/spintop")) for word in before
            )
            if is_own and before and before[-1] in OWN_OPTIONS:
                continue
            if "--" not in before or self.program == "find":
                yield f"a value in the place of an option: {word!r}"


class Checkout:
    """A copy of the checkout with recording programs."""

    def __init__(self, folder: Path) -> None:
        self.root, self.shims = folder / "checkout", folder / "programs"
        for name in COPIED:
            source, target = ROOT / name, self.root / name
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                skip = shutil.ignore_patterns("node_modules", "__pycache__", "figures")
                shutil.copytree(source, target, symlinks=True, ignore=skip)
            else:
                shutil.copy(source, target)
        for name in ("src/kernels", "src/proof", "app"):
            (self.root / name).mkdir(parents=True, exist_ok=True)
        for name in ("funit", "support", "long", "program", "scripts"):
            (self.root / "test" / name).mkdir(parents=True, exist_ok=True)
        self.make_shims()
        venv = self.root / ".venv"
        for group in ("base", "netcdf", "test"):
            shutil.copy(ROOT / "scripts/requirements.lock", venv / f"{group}.txt")
        (venv / "bin/activate").write_text("# for bash\n", encoding="utf-8")
        built, _ = self.call(["bash", "-c", "source scripts/setup; build release"], self.root)
        assert built.returncode == 0, built.stderr

    def make_shims(self) -> None:
        """Programs that write down their arguments, for all that there are, and .venv's Python."""
        folders = [
            Path(name)
            for name in os.environ["PATH"].split(":")
            if os.access(name, os.R_OK | os.X_OK) and Path(name).is_dir()
        ]
        for path in itertools.chain.from_iterable(map(Path.iterdir, folders)):
            shim = self.shims / path.name
            if path.name in HARMLESS and not shim.exists():
                write_shim(shim, f'exec {quote(path)} "$@"')
        write_shim(self.shims / "gfortran", "echo /dev/null")  # which is where a library is
        for name in ("debootstrap", "sbatch", "srun", "scontrol", "gcc", "g++", "apt-get",
                     "git", "mount", "umount", "mountpoint", "chroot", "tar", "ldd", "ffmpeg",
                     "sudo", "nf-config", "flang"):  # fmt: skip
            write_shim(self.shims / name, "exit 1" if name in FAILS else "exit 0")
        program = self.shims / "spintop"
        write_shim(program, f'exec {quote(EXE)} "$@"')
        python = PYTHON.format(program=quote(program), python=quote(sys.executable))
        idle = python.replace("*) exec", "*/scripts/plot*) ;;\n*) exec")
        write_shim(self.root / ".venv/bin/python", idle)
        write_shim(self.shims / "python3", python)

    def call(
        self, command: list[str], folder: Path, **environment: str
    ) -> tuple[subprocess.CompletedProcess, list[Call]]:
        """Run a command; what it did, and which programs it called."""
        with tempfile.TemporaryDirectory() as log:
            known = {
                name: os.environ[name] for name in ("LANG", "SPINTOP_NETCDF") if name in os.environ
            }
            environment = known | {
                "HOME": str(folder), "PATH": str(self.shims), "SPINTOP_TEST_LOG": log,
                "SLURM_ARRAY_TASK_ID": "1", "SLURM_JOB_ID": "1",
                "SPINTOP_TEST_JOBS": "1",
                "SPINTOP_FLINT": "0", "SPINTOP_NETCDF": "0",
                "SPINTOP_SUNDIALS_INCLUDE": str(self.shims),
            } | environment  # fmt: skip
            done = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True,
                errors="replace", stdin=subprocess.DEVNULL, timeout=120, check=False,
            )  # fmt: skip
            return done, [call for path in sorted(Path(log).iterdir()) for call in read_log(path)]


def read_log(path: Path) -> list[Call]:
    """The calls that a process has written down; those at once have files of their own."""
    words = path.read_text("utf-8", "surrogateescape").split("\0")
    calls, place = [], 0
    while place + 1 < len(words):
        end = place + 2 + int(words[place + 1])
        calls.append(Call(words[place], tuple(words[place + 2 : end])))
        place = end
    return calls


def options_of_program() -> list[str]:
    text = subprocess.run([EXE, "--help"], capture_output=True, text=True, check=True).stdout
    return [word for line in re.findall(r"^  (-.*? [A-Z]\S+)  ", text, re.MULTILINE)
            for word in re.findall(r"--?\w+", line)]  # fmt: skip


def usages_of(script: Path, text: str) -> Iterator[list[str]]:
    """The lines of a usage as words, one of each choice."""
    name = rf"(?:scripts/)?{re.escape(str(script.relative_to(script.parts[0])))}"
    for line in re.findall(
        rf"^#?(?: ?usage:)? +{name}((?: +\S+)*?)(?:   .*)?$", text, re.MULTILINE
    ):
        words = re.sub(r"\[-[^]]*\]|[][]|\.\.\.|SBATCH OPTION", "", line).split()
        yield from map(list, itertools.product(*(word.split("|") for word in words)))


def in_python(script: Path) -> bool:
    """Whether a script reads its arguments in Python."""
    text = (ROOT / script).read_text(encoding="utf-8")
    return "import argparse" in text or bool(re.search(r'^PYTHONPATH.* -m \w+ "\$@"$', text, re.M))


def arguments_of(script: Path, value: str) -> list[list[str]]:
    """Arguments with a value in each of the places that the usage of a script has."""
    text = (ROOT / script).read_text(encoding="utf-8")
    file = f"{value}.nml"
    if in_python(script):
        return [[f"--output={value}", "--", file]]
    found = []
    for words in usages_of(script, text):
        for place, word in enumerate(words):
            if word != "PROGRAM" and (word.isupper() or word in USUAL):
                known = [USUAL.get(other, other) for other in words]
                known[place] = file if "." in word else value
                found.append(known)
    if not found and '"$program" "${arguments[@]}"' in text:
        found = [[option, value, "a.nml"] for option in options_of_program()]
        found += [["--", file], ["--", "--no-plots", file], [f"--output={value}", "a.nml"]]
    return found or [[value]]


def variables_of(script: Path) -> list[str]:
    """The variables of the environment that a script reads."""
    text = (ROOT / script).read_text(encoding="utf-8")
    found = {a or b for a, b in VARIABLE.findall(text)}
    found |= {"TMPDIR"} if "mktemp" in text else set()
    return sorted(name for name in found if not OTHERS.fullmatch(name))


class ValuesTest(unittest.TestCase):
    """No value is read as anything else by any script."""

    checkout: ClassVar[Checkout]

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory(prefix="spintop-values-")
        cls.addClassCleanup(folder.cleanup)
        cls.checkout = Checkout(Path(folder.name))

    def faults(self, script: Path, value: str, words: list[str], variable: str = "") -> list[str]:
        """What went wrong in a call of a script with a value, in a folder with a precious file."""
        with tempfile.TemporaryDirectory(prefix="values ") as name:
            folder = Path(name)
            for known in (CANARY, "a.nml", f"{value}.nml"):
                (folder / known).write_text(INPUT, encoding="utf-8")
            (folder / value).mkdir()
            (folder / value / CANARY).write_text(INPUT, encoding="utf-8")
            environment = {variable: value} if variable else {}
            done, calls = self.checkout.call(
                [str(self.checkout.root / script), *words], folder, **environment
            )
            found = [
                f"{call.program}: {fault}" for call in calls[1:] for fault in call.faults(value)
            ]
            if complaint := WRONG.search(done.stdout + done.stderr):
                found.append(f"complaint: {complaint[0]}: {done.stderr[-300:]}")
            if not 0 <= done.returncode <= 5:
                found.append(f"exit code {done.returncode}")
            if not all((folder / path).exists() for path in (CANARY, Path(value) / CANARY)):
                found.append("a file is gone")
            if list(folder.rglob("evil")) or (self.checkout.root / "evil").exists():
                found.append("a part of the value was carried out")
        return found

    def check(self, jobs: list[tuple]) -> None:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = pool.map(lambda job: self.faults(*job), jobs)
            for job, found in zip(jobs, results, strict=True):
                with self.subTest(str(job[0]), arguments=job[2:]):
                    assert found == []

    def test_arguments(self) -> None:
        jobs = [
            (script, value, words)
            for script in sorted(set(SCRIPTS) - HAND_ON)
            for value in ((BOTH,) if in_python(script) else VALUES)
            for words in arguments_of(script, value)
        ]
        self.check(jobs)

    def test_folder_that_is_an_expression(self) -> None:
        """The tables in a folder with the name of an expression of find are found and drawn."""
        for value in ("-delete", "!", "(", DASHED, ODD):
            with self.subTest(value), tempfile.TemporaryDirectory(prefix="values ") as name:
                folder = Path(name)
                for known in (CANARY, "a.nml"):
                    (folder / known).write_text(INPUT, encoding="utf-8")
                command = [str(self.checkout.root / "scripts/run"), "-o", value, "--", "a.nml"]
                done, calls = self.checkout.call(command, folder)
                assert (done.returncode, done.stderr) == (0, "")
                assert (folder / CANARY).exists()
                (drawn,) = [call.words for call in calls if "scripts/plot" in " ".join(call.words)]
                assert len(drawn) == 2
                assert os.path.samefile(folder / drawn[1], folder / value / "a.csv")

    def test_environment(self) -> None:
        jobs = [
            (script, value, arguments_of(script, "plain")[0], variable)
            for script in SCRIPTS
            if not in_python(script)
            for variable in variables_of(script)
            for value in VALUES
        ]
        self.check(jobs)
