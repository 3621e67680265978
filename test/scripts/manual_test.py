"""The manual agrees with the program: its commands, inputs, programs, tables and links."""

import os
import re
import shutil
import subprocess
import sys
import unittest
from collections import Counter
from itertools import pairwise, zip_longest
from pathlib import Path

import pytest

from conftest import EXE, KIND, MPI, MPI_EXE, ROOT, execute, read
from manual.pages import Block, anchors_of, blocks_of, links_of, manual_pages, prose_of
from manual.tables import registries, renewed

FOLDERS = "app|doc|input|packaging|python|scripts|src|test"
"""Folders of the project that pages name."""
PAGES = manual_pages()
BLOCKS = [block for page in PAGES for block in blocks_of(page)]

SHELL = ("sh", "console")
LANGUAGES = (*SHELL, "nml", "fortran", "toml", "python", "c", "text")
WAYS = ("long", "timed", "part", "file", "wrong", "messages", "output", "mpi", "netcdf", "flint")
WAYS += ("node", "library", "setup", "slurm", "xarray")
"""Words behind the language: how a block is tested, besides exit=N and the path of an input."""

NOT_RUN = WAYS[-3:]
"""Ways of blocks that are not run: they install, build, or need what few machines have."""

SKIPPED = {
    "c.md": 2,
    "README.md": 5,
    "cluster.md": 17,
    "developing.md": 10,
    "live.md": 6,
    "packaging.md": 7,
    "python.md": 3,
    "proof.md": 2,
    "report.md": 1,
    "sweep_netcdf.md": 3,
    "tutorial_cluster.md": 1,
    "tutorial_lecture.md": 3,
}
"""How many commands of each page are not run, so that a new one is noticed."""

WITHOUT_TABLE = {"statuses", "parameters uncertainty"}
"""Lists that need none: a summary says what its status means, and radii are those of other keys."""

SYSTEM_COMMANDS = ("mpirun", "head", "sed", "pip", "cc", "spintop", "docker")
SYSTEM_COMMANDS += ("python3", "source", "module", "export", "cmake", "gfortran", "node")
VARYING = re.compile(r"^!? {2,3}(ended|time|parts|memory|cost .* us for the set-up)\b")
"""Lines of summaries that differ from run to run: of these only the first word is compared."""

REFUSED = {
    "damped_top method=exact relative_tolerance=": "the exact solution exists only for",
    "damped_top formulation=lagrange": "formulation lagrange holds for",
    "damped_top formulation=space_frame": "formulation space_frame holds for",
    "slow_top_lagrange_ode45 method=taylor": "these have: rigid_body, space_frame",
    "slow_top_lagrange_ode45 method=taylor_quadruple": "these have: rigid_body, space_frame",
    "slow_top_lagrange_rk4 method=rkmk_4": "these have: rigid_body, space_frame",
    "slow_top_lagrange_rk4 method=splitting_6": "these have: rigid_body, space_frame",
    "damped_top method=dop853 relative_tolerance=9e-18": "cannot reach a tolerance below 1e-17",
    "damped_top relative_tolerance=9e-32": "taylor_quadruple cannot reach a tolerance below 1e-31",
    "damped_top project=invariants": "a damped body conserves neither energy nor momentum",
    "slow_top_scenario2_rk4 project=invariants": "conserves its invariants by construction",
    "slow_top_scenario2_rk4 method=euler_forward": "stays at the first turning point",
    "slow_top_scenario2_rk4 method=euler_backward": "stays at the first turning point",
    "slow_top_lagrange_rk4 project=unit": "has no quaternion",
    "damped_top max_steps=2147483647": "too large",
}
"""Inputs with settings of &integration that the manual calls refused, and why."""

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w])")
STUB = """\
set -euo pipefail
root=$(cd "$(dirname "${{BASH_SOURCE[0]}}")/.." && pwd -P) python={python}
say() {{ echo "spintop: $*" >&2; }}
as_path() {{ :; }}
build() {{ :; }}
"""
"""Stands for scripts/setup: all is installed and built."""


def commands_of(block: Block) -> list[str]:
    lines = block.text.splitlines()
    if block.tags[0] == "console":
        return [line[2:] for line in lines if line.startswith("$ ")]
    return [line for line in lines if line]


def outputs_of(block: Block) -> list[list[str]]:
    outputs: list[list[str]] = []
    for line in block.text.splitlines():
        if line.startswith("$ "):
            outputs.append([])
        else:
            outputs[-1].append(line)
    return outputs


def agree(expected: str, found: str) -> bool:
    """Whether a line is as expected: its words, and its numbers to the sixth digit."""
    if expected == "...":
        return True
    if match := VARYING.match(expected):
        return found.removeprefix("!").split()[:1] == match[1].split()[:1]
    if NUMBER.sub("#", expected) != NUMBER.sub("#", found):
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(found), strict=True)
    return all(abs(float(a) - float(b)) <= 1e-6 * abs(float(a)) + 1e-12 for a, b in pairs)


def shortened(command: str) -> str:
    """A command of a long block, made quick."""
    words = command.split()
    quick = "--check" if words[0] == "spintop" or words[0].endswith("/run") else "--help"
    return f"{command} {quick}"


def with_groups(base: str, text: str) -> str:
    """An input in which the groups of a text take the place of its own."""
    base, text = (re.sub(r"(?m)!.*$", "", part) for part in (base, text))
    group = re.compile(r"&(\w+)(?:'[^']*'|\"[^\"]*\"|[^/'\"])*/")
    new = {match[1] for match in group.finditer(text)}
    kept = group.sub(lambda match: "" if match[1] in new else match[0], base)
    return kept + text


def parts_of_library_page() -> dict[tuple[str, ...], str]:
    return {block.tags: block.text for block in BLOCKS if block.page.name == "library.md"}


@pytest.mark.usefixtures("folder")
class ManualCase(unittest.TestCase):
    """A folder that looks like a checkout that is set up and built."""

    def setUp(self) -> None:
        """Copies of what commands may change, links to the rest."""
        shutil.copytree(ROOT / "input", self.folder / "input")
        for name in ("python", "reference"):
            (self.folder / name).symlink_to(ROOT / name)
        scripts = self.folder / "scripts"
        scripts.mkdir()
        for path in (ROOT / "scripts").iterdir():
            if path.name == "run":
                shutil.copy(path, scripts)
            elif path.name != "setup":
                (scripts / path.name).symlink_to(path)
        (scripts / "setup").write_text(STUB.format(python=sys.executable), encoding="utf-8")
        for kind, program in (("release", EXE), ("mpi", MPI_EXE)):
            if Path(program).is_file():
                (self.folder / "build" / kind).mkdir(parents=True)
                (self.folder / "build" / kind / "spintop").symlink_to(Path(program).resolve())

    def shell(self, command: str) -> subprocess.CompletedProcess:
        folders = [self.folder / "build/release", Path(sys.executable).parent]
        path = ":".join([*map(str, folders), os.environ["PATH"]])
        environment = MPI | {"PATH": path, "SPINTOP_EXE": str(EXE)}
        given = {"cwd": self.folder, "environment": environment, "stdin": subprocess.DEVNULL}
        return execute("bash", "-c", command, code=None, **given)

    def check_output(self, result: subprocess.CompletedProcess, expected: str) -> None:
        """A program has printed what the page says."""
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = zip_longest(expected.splitlines(), result.stdout.splitlines(), fillvalue="")
        for line, found in lines:
            self.assertTrue(agree(line, found), f"- {line}\n+ {found}")

    def check(self, text: str) -> subprocess.CompletedProcess:
        scene = self.folder / "scene.nml"
        scene.write_text(text, encoding="utf-8")
        return self.shell("spintop --check scene.nml")


class ManualTest(unittest.TestCase):
    def test_links_lead_somewhere(self) -> None:
        """To files of the project, and to headings that there are."""
        for page in PAGES:
            for line, target in links_of(page):
                with self.subTest(f"{page.name}:{line}", target=target):
                    if re.match(r"https?://", target):
                        continue
                    path, _, anchor = target.partition("#")
                    file = (page.parent / path).resolve() if path else page
                    self.assertTrue(file.exists())
                    self.assertTrue(file.is_relative_to(ROOT))
                    if anchor:
                        self.assertIn(anchor, anchors_of(file))

    def test_paths_that_are_named_are_there(self) -> None:
        """Files and folders of the project, named in code; a pattern stands for at least one."""
        seen = 0
        for page in PAGES:
            for number, line in enumerate(prose_of(page), 1):
                for path in re.findall(rf"`((?:{FOLDERS})/[^\s`]+)`", line):
                    seen += 1
                    with self.subTest(f"{page.name}:{number}", path=path):
                        self.assertTrue(any(ROOT.glob(path.rstrip("/"))))
        self.assertGreater(seen, 20)

    def test_every_page_is_in_the_contents(self) -> None:
        """The contents link to all pages but themselves."""
        contents = ROOT / "doc/index.md"
        linked = {(contents.parent / target).resolve() for _, target in links_of(contents)}
        self.assertLessEqual({page for page in PAGES if page != contents}, linked)

    def test_every_block_says_how_it_is_tested(self) -> None:
        """By its fence; and nothing is a block by mere indentation, which would escape."""
        for block in BLOCKS:
            with self.subTest(str(block)):
                self.assertIn((block.tags or ("",))[0], LANGUAGES)
                words = [word for word in block.tags[1:] if not re.match(r"exit=\d$", word)]
                known = [word for word in words if word in WAYS]
                base = [word for word in words if word not in WAYS]
                self.assertEqual(bool(base), "part" in known or "file" in known)
                self.assertTrue(all((ROOT / path).is_file() for path in base))
        for page in PAGES:
            lines = ["", *prose_of(page)]
            for number, (before, line) in enumerate(pairwise(lines), 1):
                with self.subTest(f"{page.name}:{number}"):
                    self.assertFalse(not before and line.startswith("    "), line)

    def test_tables_are_those_of_the_program(self) -> None:
        """Parameters, columns, methods and the like; scripts/manual_tables renews them."""
        for page in PAGES:
            with self.subTest(page.name):
                self.assertEqual(page.read_text(encoding="utf-8"), renewed(page, EXE))

    def test_everything_that_can_be_listed_is_described(self) -> None:
        """Each topic of `spintop list`, each group of the input, and columns that can be chosen."""
        text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
        known = registries(EXE)
        self.assertGreater(len(known), 10)
        parts = {"columns": "study", "parameters": "group"}
        fixed = {study["name"] for study in known["studies"] if not study["takes_columns"]}
        lists = {
            f"{topic} {entry[parts[topic]]}" if topic in parts else topic
            for topic, entries in known.items()
            if isinstance(entries, list) and topic != "column_units"  # of the topic columns
            for entry in entries
            if isinstance(entry, dict)  # other_words are words
            and (topic != "columns" or entry["study"] not in fixed)
        }
        for name in lists - WITHOUT_TABLE:
            self.assertIn(f"<!-- spintop list {name} -->", text)

    def test_what_is_not_run_is_known(self) -> None:
        """No command escapes by a word behind its fence."""
        found: Counter[str] = Counter()
        for block in BLOCKS:
            if set(block.tags) & set(NOT_RUN):
                is_shell = block.tags[0] in SHELL
                found[block.page.name] += len(commands_of(block)) if is_shell else 1
        self.assertEqual(found, SKIPPED)

    def test_numbers_and_words(self) -> None:
        """A number may differ from its seventh digit on, a word may not."""
        self.assertTrue(agree("period 2.3859004995 s", "period 2.3859004999 s"))
        self.assertFalse(agree("period 2.3859004995 s", "period 2.3860004995 s"))
        self.assertFalse(agree("period 2.38 s", "precession 2.38 s"))
        self.assertFalse(agree("20 ok: completed", ""))
        self.assertFalse(agree("20 ok: completed", "19 ok: completed"))
        self.assertTrue(agree("  time      0.1 s", "  time      0.2 s on 2 threads"))
        self.assertFalse(agree("  time      0.1 s", "  memory    0.2 MB"))
        self.assertFalse(agree("slow_top_1.csv", "slow_top_2.csv"))

    def test_groups(self) -> None:
        base = "&top mass = 1, title = 'a/b' / &span t_end = 1 / ! &top /\n"
        found = with_groups(base, "&top mass = 2 /").split("/")
        kept = [group.strip() for group in found]
        self.assertEqual(kept, ["&span t_end = 1", "&top mass = 2", ""])

    def test_references(self) -> None:
        """Each is cited, and each citation has one with an author, a title and a year."""
        entries = re.split(r"\n(?=@)", (FOLDER / "paper.bib").read_text(encoding="utf-8"))
        known = {re.match(r"@\w+\{(\w+),", entry)[1]: entry for entry in entries}
        body = TEXT.split("---", 2)[2]
        cited = set(re.findall(r"@([A-Z]\w+)", body))
        self.assertEqual(cited, set(known))
        for name, entry in known.items():
            for field in ("author", "title", "year"):
                self.assertIn(f"  {field} = {{", entry, name)
            if name[-4:].isdigit():
                self.assertIn(f"year = {{{name[-4:]}}}", entry)
            for doi in re.findall(r"doi = \{(.*?)\}", entry):
                self.assertRegex(doi, r"^10\.\d{4,9}/\S+$")

    def test_figures_and_commands(self) -> None:
        """Figures are files, and are referred to; commands name scripts and inputs."""
        figures = re.findall(r"!\[.*?\\label\{(.*?)\}\]\((.*?)\)", TEXT)
        self.assertEqual(len(figures), 2)
        for label, path in figures:
            self.assertTrue((FOLDER / path).is_file(), path)
            self.assertIn(f"\\autoref{{{label}}}", TEXT)
        for path in re.findall(r"\b(?:scripts|input)/[\w.]+", TEXT):
            self.assertTrue((ROOT / path).is_file(), path)

    def test_parts_and_length(self) -> None:
        for heading in ("Summary", "Statement of need", "References"):
            self.assertIn(f"\n# {heading}\n", TEXT)
        words = len(TEXT.split("---", 2)[2].split())
        self.assertLess(words, MOST_WORDS)
        self.assertGreater(words, FEWEST_WORDS)


class CommandsTest(ManualCase):
    def run_block(self, block: Block) -> None:
        code = next((int(tag[-1]) for tag in block.tags if tag.startswith("exit=")), 0)
        outputs = outputs_of(block) if block.tags[0] == "console" else None
        for i, command in enumerate(commands_of(block)):
            result = self.shell(shortened(command) if "long" in block.tags else command)
            self.assertEqual(result.returncode, code, f"{command}\n{result.stdout}{result.stderr}")
            if outputs:
                found = result.stdout.splitlines()
                if "timed" in block.tags:
                    self.assertEqual(len(found), len(outputs[i]), result.stdout)
                    found, outputs[i] = found[:1], outputs[i][:1]
                for expected, line in zip_longest(outputs[i], found, fillvalue=""):
                    self.assertTrue(agree(expected, line), f"{command}\n- {expected}\n+ {line}")

    @unittest.skipUnless(KIND == "release", "the commands take long with run-time checks")
    @pytest.mark.slow
    def test_commands(self) -> None:
        """Page by page, for later blocks may use what earlier ones have made."""
        has_mpi = shutil.which("mpirun") and Path(MPI_EXE).is_file()
        netcdf = self.shell("spintop --check --set output.format=netcdf input/random_tops.nml")
        flint = self.shell("spintop --check --set output.certified=.true. input/slow_top.nml")
        for block in BLOCKS:
            if block.tags[0] == "python" and not set(block.tags) & {"file", "library", *NOT_RUN}:
                with self.subTest(str(block)):
                    words = (sys.executable, "-W", "error", "-c", block.text)
                    self.assertNotEqual(execute(*words, cwd=self.folder).stdout, "")
            if block.tags[0] not in SHELL:
                continue
            if (
                ("mpi" in block.tags and not has_mpi)
                or ("netcdf" in block.tags and netcdf.returncode)
                or ("flint" in block.tags and flint.returncode)
                or ("node" in block.tags and not shutil.which("node"))
            ):
                self.check_names(block)
            elif not set(block.tags) & set(NOT_RUN):
                with self.subTest(str(block)):
                    self.run_block(block)

    def check_names(self, block: Block) -> None:
        """Blocks that cannot be run: valid shell text, existing scripts and files."""
        for command in commands_of(block):
            with self.subTest(str(block), command=command):
                self.assertEqual(self.shell(f"bash -n -c {command!r}").returncode, 0)
                words = [word for word in command.split("#")[0].split() if "=" not in word]
                first = words[0]
                script = ROOT / first
                self.assertTrue(first in SYSTEM_COMMANDS or os.access(script, os.X_OK), first)
                for word in words[1:]:
                    if re.match(r"(input|scripts)/", word):
                        self.assertTrue((ROOT / word).is_file(), word)

    def test_what_is_not_run_is_there(self) -> None:
        """Scripts and files of commands that take more than a test may."""
        for block in BLOCKS:
            if block.tags[0] in SHELL and set(block.tags) & set(NOT_RUN):
                self.check_names(block)

    def test_inputs(self) -> None:
        """The program takes each of them, whole or with the rest of another."""
        for i, block in enumerate(BLOCKS):
            text = block.text
            if "file" in block.tags:
                with self.subTest(str(block)):
                    whole = (ROOT / block.tags[-1]).read_text(encoding="utf-8")
                    # What an input says of its figures in the gallery is not shown.
                    self.assertEqual(text, whole.partition("\n! gallery ")[0])
            if block.tags[0] != "nml":
                continue
            with self.subTest(str(block)):
                if "part" in block.tags:
                    text = with_groups((ROOT / block.tags[-1]).read_text(encoding="utf-8"), text)
                result = self.check(text)
                if "wrong" in block.tags:
                    self.assertEqual(result.returncode, 2)
                    self.assertEqual(BLOCKS[i + 1].tags, ("text", "messages"))
                    self.assertEqual(result.stderr.strip(), BLOCKS[i + 1].text.strip())
                else:
                    self.assertEqual(result.returncode, 0, result.stderr)

    def test_table_of_the_paper(self) -> None:
        """Table 1 has the numbers of its two inputs."""
        stems = ("spinning_wheel_paper", "spinning_wheel_sweep")
        columns = "azimuth_after_period_deg,delta_u,delta_u_fast_top,nutations_in_period"
        rows: list[list[str]] = [[] for _ in range(20)]
        for stem in stems:
            run = self.shell(f"spintop --set output.columns={columns} input/{stem}.nml")
            self.assertEqual(run.returncode, 0, run.stderr)
            found = read(self.folder / f"output/{stem}.csv")[columns.split(",")].to_numpy()
            for row, (azimuth, *ranges, nutations) in zip(rows, found, strict=True):
                row += [f"{azimuth:.3f}", *(f"{value:.4g}" for value in ranges)]
                row += [f"{nutations:.2f}"]
        page = (ROOT / "doc/paper_results.md").read_text(encoding="utf-8")
        for row in rows:
            self.assertIn(f" | {' | '.join(row)} |\n", page)

    def test_limits(self) -> None:
        for case, reason in REFUSED.items():
            name, *settings = case.split()
            text = (ROOT / f"input/{name}.nml").read_text(encoding="utf-8")
            for setting in settings:
                key, value = setting.split("=")
                text = re.sub(rf"(?m)^ *{key} *=.*$", "", text)
                if value:
                    value = f"'{value}'" if value.isidentifier() else value
                    text = text.replace("&integration", f"&integration\n{key} = {value}")
            with self.subTest(case):
                result = self.check(text)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, rf"{reason}(?!, \w)")

    @unittest.skipUnless(KIND == "release", "does not use the program under test")
    def test_the_library(self) -> None:
        parts = parts_of_library_page()
        source, program = self.folder / "main.f90", self.folder / "my_top"
        source.write_text(parts["fortran",], encoding="utf-8")
        modules = ROOT / "build/release/test/modules"
        link = ("-L", modules, "-ltested", f"-Wl,-rpath,{modules}", "-o", program)
        script = '. "$0"/scripts/setup; cd "$0"; compile_test release "$@"'
        execute("bash", "-c", script, ROOT, f"-J{self.folder}", source, *link)
        self.check_output(self.shell("./my_top"), parts["text", "output"])


# The paper: its references, figures and commands are there.

FOLDER = ROOT / "doc/paper"
TEXT = (FOLDER / "paper.md").read_text(encoding="utf-8")
MOST_WORDS, FEWEST_WORDS = 1000, 250
