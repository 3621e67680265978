"""The folders of the sources: imports go down only, tests mirror them, sizes keep bounds."""

import itertools
import re
import unittest
from collections.abc import Iterator
from pathlib import Path

from conftest import ROOT
from docstrings import Source, match_procedure, statements

SOURCES = sorted([*ROOT.glob("src/**/*.f90"), *ROOT.glob("app/*.f90")])
TEXTS = {path: path.read_text(encoding="utf-8") for path in SOURCES}

# A folder may import from itself and from those before it in its row.
MECHANICS = ("foundation", "system", "top kernels", "exact formulations proof", "integrators")
MECHANICS += ("stability", "input tables parallel", "statistics sampling estimation")
MECHANICS += ("scenes", "studies", "app c")
# Reading, writing and parallel work know nothing of mechanics.
PLAIN = ("foundation", "system", "input", "tables", "parallel statistics sampling estimation")

MODULE = re.compile(r"^\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*$", re.M | re.I)
USE = re.compile(r"^\s*use\s+(\w+)", re.M | re.I)
BOUND = re.compile(r"\bbind\(C, name='(\w+)'\)", re.I)
KERNEL = re.compile(r"^(?:PROCEDURE|FUNCTION)\((\w+),", re.M)
DEFINED = re.compile(r"^(?!static\b)\w[\w ]*[ *](\w+)\([^;]*?\)\s*\{", re.M)
END = re.compile(r"^\s*end\s+(?:subroutine|function|procedure)\b", re.I)
BODY = re.compile(r"^\s*module\s+procedure\s+(\w+)\s*$", re.I)
INTERFACE = re.compile(r"^\s*(end\s+|abstract\s+)?interface\b", re.I)
LONGEST_FILE = 700
LONGEST_PROCEDURE = 80
FULLEST_FOLDER = 20
# Comparisons with the words of good ends, and in Fortran with names of statuses or with `at_rest`.
WORDS_COMPARED = re.compile(
    r"""(==|!=|\bin\b|\bdrop\()\s*[\[({]*[^"'=]{0,40}["'](ok|at_rest)["']"""
)
NAMES_COMPARED = re.compile(r"\bstatus\S*\s*(==|/=)\s*'|\bstatus_at_rest\b|status_ok \+ 1", re.I)
COEFFICIENTS = re.compile(r"(arkode|dop853|implicit|splitting)_tables?")


def room_of(path: Path) -> str:
    """The folder of a source; `spintop.f90`, the interface of the library, has none."""
    parts = path.relative_to(ROOT).parts
    if parts[0] == "app":
        return "app"
    return parts[1] if len(parts) > 2 else ""


def floors(row: tuple[str, ...]) -> dict[str, int]:
    return {room: floor for floor, rooms in enumerate(row) for room in rooms.split()}


def scopes(path: Path) -> Iterator[tuple[re.Match[str], int, list[str]]]:
    """The procedures of a source: headers, numbers of lines, statements, of those inside, too."""
    begun: list[tuple[re.Match[str], int, list[str]]] = []
    in_interface = False
    for line, code, _ in statements(path.read_text(encoding="utf-8")):
        if border := INTERFACE.match(code):
            in_interface = not (border[1] or "").lower().startswith("end")
        elif in_interface:
            continue
        elif END.match(code):
            header, first, body = begun.pop()
            yield header, line - first + 1, body
            if begun:
                begun[-1][2].extend(body)
        elif header := BODY.match(code) or match_procedure(code):
            begun.append((header, line, []))
        elif begun:
            begun[-1][2].append(code)


def unused_arguments(path: Path) -> Iterator[tuple[str, str]]:
    """Arguments that their procedure names in its header and its declarations alone."""
    for header, _, body in scopes(path):
        text = " ".join(body).lower()
        if header.re is BODY or re.search(r"\bclass\s*\(", text) or "bind(C" in header.string:
            continue
        words = re.findall(r"\w+", text)
        for name in re.findall(r"\w+", (header[3] or "").lower()):
            if words.count(name) < 2:
                yield header[2], name


def unused_imports(path: Path) -> Iterator[str]:
    """Names that a module or program imports and does not use; kinds may be parts of numbers."""
    imports, body = [], re.findall(r"!\$omp.*", path.read_text(encoding="utf-8"))
    for _, code, _ in statements(path.read_text(encoding="utf-8")):
        (imports if USE.match(code) else body).append(code)
    code = re.sub(r"'[^']*'|\"[^\"]*\"", "", " ".join(body).lower())
    words = set(re.findall(r"\w+", code))
    words |= {word.partition("_")[2] for word in words if word[0].isdigit()}
    for names in re.findall(r"only:(.*)", "\n".join(imports)):
        for name in names.split(","):
            if (used := name.partition("=>")[0].strip().lower()) not in words and "(" not in used:
                yield used


class ArchitectureTest(unittest.TestCase):
    def imports(self) -> list[tuple[Path, Path]]:
        """Each import of one source of ours by another: of a module, or of a function in C."""
        home = {name.lower(): path for path, text in TEXTS.items() for name in MODULE.findall(text)}
        for path in [*ROOT.glob("src/**/*.c"), *ROOT.glob("src/**/*.cpp")]:
            text = path.read_text(encoding="utf-8")
            home |= {name.lower(): path for name in DEFINED.findall(text)}
        kernels = ROOT / "src" / "kernels"
        listed = KERNEL.findall((kernels / "kernel_list.h").read_text(encoding="utf-8"))
        home |= {f"spintop_{name}": kernels / "kernels.c" for name in listed}
        return [
            (path, home[name.lower()])
            for path, text in TEXTS.items()
            for name in [*USE.findall(text), *BOUND.findall(text)]
            if name.lower() in home
        ]

    def test_imports_go_down(self) -> None:
        """No folder imports from one above it, and those without mechanics import no mechanics."""
        mechanics, plain = floors(MECHANICS), floors(PLAIN)
        imports = self.imports()
        self.assertGreater(len(imports), 500)
        self.assertGreater(sum(other.name == "kernels.c" for _, other in imports), 15)
        for path, other in imports:
            room, below = room_of(path), room_of(other)
            if not room:
                continue
            line = f"{path.relative_to(ROOT)} imports {other.relative_to(ROOT)}"
            self.assertIn(below, mechanics, line)
            beside = room in plain and below in plain
            if room != below and not beside:
                self.assertLess(mechanics[below], mechanics[room], line)
            if room in plain:
                self.assertIn(below, plain, line)
                self.assertLessEqual(plain[below], plain[room], line)

    def test_each_room_is_known(self) -> None:
        self.assertLessEqual({room_of(path) for path in SOURCES} - {""}, floors(MECHANICS).keys())

    def test_modules_bear_the_names_of_their_files(self) -> None:
        for path in ROOT.glob("src/**/*.f90"):
            text = path.read_text(encoding="utf-8")
            if re.search(r"^\s*submodule", text, re.MULTILINE):
                continue
            wanted = {"spintop" if path.stem == "spintop" else f"spintop_{path.stem}"}
            self.assertEqual(set(MODULE.findall(text)), wanted, str(path))

    def test_tests_mirror_the_sources(self) -> None:
        """The suite of a module has the same folder below test/ as the module below src/."""
        sources = ROOT / "src"
        folders = {path.stem: path.parent.relative_to(sources) for path in sources.rglob("*.f90")}
        for suite in ROOT.glob("test/**/*_test.pf"):
            module = suite.stem.removesuffix("_test")
            if module in folders and module != "spintop":
                folder = suite.parent.relative_to(ROOT / "test")
                self.assertEqual(folder, folders[module], suite.name)

    def test_suites_have_names_of_their_own(self) -> None:
        """Whatever their language: scripts/test knows a suite by its name."""
        suites = [*ROOT.glob("test/**/*_test.pf"), *ROOT.glob("test/**/*_test.py")]
        self.assertGreater(len(suites), 100)
        names = [suite.stem for suite in suites]
        self.assertEqual([name for name in set(names) if names.count(name) > 1], [])

    def test_no_warehouses(self) -> None:
        for path, text in TEXTS.items():
            self.assertLessEqual(len(text.splitlines()), LONGEST_FILE, str(path))
        for folder in {path.parent for path in SOURCES}:
            files = [path for path in folder.iterdir() if path.suffix in (".f90", ".c", ".cpp")]
            self.assertLessEqual(len(files), FULLEST_FOLDER, str(folder))

    def test_no_long_procedures(self) -> None:
        """Tables of coefficients are exempt."""
        found = [
            (f"{path.name} {header[1 if header.re is BODY else 2]}", lines)
            for path in SOURCES
            if not COEFFICIENTS.fullmatch(path.stem)
            for header, lines, _ in scopes(path)
        ]
        self.assertGreater(len(found), 1000)
        too_long = {name: lines for name, lines in found if lines > LONGEST_PROCEDURE}
        self.assertEqual(too_long, {})

    def test_good_ends_are_asked_for(self) -> None:
        """Whether a motion ended well is asked of `is_good_end` and of the flag `good` only.

        That compares with `status_at_rest`, as does what sets it; the interface exports it.
        """
        home = {"status.f90", "integration.f90", "spintop.f90"}
        others = [
            ROOT.glob(f"{folder}/**/*.{kind}")
            for folder in ("python", "scripts")
            for kind in ("py", "js")
        ]
        found = [
            f"{path.relative_to(ROOT)}: {line.strip()}"
            for pattern, paths in (
                (NAMES_COMPARED, [path for path in SOURCES if path.name not in home]),
                (WORDS_COMPARED, itertools.chain(*others)),
            )
            for path in paths
            for line in path.read_text(encoding="utf-8").splitlines()
            if pattern.search(line)
        ]
        self.assertEqual(found, [])
        for line in ('rows["status"] != "ok"', "if (status === 'ok')", 'x in ("ok", "at_rest")'):
            self.assertRegex(line, WORDS_COMPARED)
        self.assertRegex("status(row)%text == 'ok'", NAMES_COMPARED)

    def test_lists_of_texts_are_no_constructors(self) -> None:
        """gfortran does not free the texts of `[list, string_t(text)]`, as `append` does."""
        made = re.compile(r"\[[^][]*\bstring_t\(")
        found = [path.name for path, text in TEXTS.items() if made.search(text)]
        self.assertEqual(found, ["text.f90"])  # which says so

    def test_formats_do_not_depend_on_the_environment(self) -> None:
        """Numbers in a text have their sign by the format (SS), not by GFORTRAN_OPTIONAL_PLUS."""
        found = [
            f"{path.name}: {form}"
            for path, text in TEXTS.items()
            for form in re.findall(r"(?:\bwrite \(\w+, |\w+_format = )'(\([^']*)'", text)
            if not form.startswith(("(ss, ", "(z"))
        ]
        self.assertEqual(found, [])

    def test_public_items_are_documented(self) -> None:
        """Each module, and each public type, constant, variable and procedure has a docstring."""
        sources = [Source(path) for path in SOURCES]
        self.assertGreater(sum(len(list(source.items())) for source in sources), 1000)
        missing = [item for source in sources for item in source.undocumented_items()]
        self.assertEqual(missing, [])

    def test_components_are_documented(self) -> None:
        """Each component of a type that users of the library see has a docstring."""
        library = (ROOT / "src/spintop.f90").read_text(encoding="utf-8")
        types = set(re.findall(r"\w+_t\b", library))
        found = [
            (f"{path.name}: {name}", source.is_documented(index))
            for path in SOURCES
            for source in [Source(path)]
            for name, index in source.components(types)
        ]
        self.assertGreater(len(found), 100)
        self.assertEqual([name for name, is_documented in found if not is_documented], [])

    def test_examples_call_what_there_is(self) -> None:
        """A call in a docstring is that of a procedure that there is."""
        known = set()
        for code in TEXTS.values():
            known |= set(re.findall(r"(?im)^\s*procedure\b.*?::\s*(\w+)", code))
            known |= set(re.findall(r"(?im)^\s*procedure.*?,\s*(\w+)", code))
            known |= set(re.findall(r"(?i)\b(?:subroutine|function|generic ::)\s+(\w+)", code))
        called = {
            (path.name, name)
            for path, code in TEXTS.items()
            for name in re.findall(r"!>.*?call \w+(?:\(\w+\))?%(\w+)\((?![^()]*\)%)", code)
        }
        self.assertGreater(len(called), 50)
        self.assertEqual([(file, name) for file, name in sorted(called) if name not in known], [])

    def test_arguments_are_used(self) -> None:
        """An argument that nobody needs stands only where an interface asks for it: in a procedure
        that is bound to a type, called from C, or passed on."""
        texts = "\n".join(TEXTS.values())
        unused = [
            f"{path.relative_to(ROOT)}: {name} of {procedure}"
            for path in SOURCES
            for procedure, name in unused_arguments(path)
            if not re.search(rf"(nopass ::|=>?) ?{procedure}\b(?! *\()", texts)
        ]
        self.assertEqual(unused, [])

    def test_imports_are_used(self) -> None:
        """A name that a source imports stands in it once more, or all are passed on."""
        unused = [
            f"{path.relative_to(ROOT)}: {name}"
            for path, text in TEXTS.items()
            if re.search(r"^ *(?:private|program \w+)$", text, re.M)
            and not re.search(r"^ *include ", text, re.M)
            for name in unused_imports(path)
        ]
        self.assertEqual(unused, [])

    def test_dummy_arguments_are_documented(self) -> None:
        """Each dummy argument of an exported procedure, but for `self`, has a docstring."""
        library = (ROOT / "src/spintop.f90").read_text(encoding="utf-8")
        exported = dict(re.findall(r"use spintop_(\w+), only: ((?:[^\n]*&\n)*[^\n]*)", library))
        found = []
        for path in SOURCES:
            names = re.findall(r"\w+", exported.get(path.stem, ""))
            for argument, documented in Source(path).dummy_arguments():
                if argument.split(" of ")[1].split()[0] in names:
                    found.append((argument, documented))
        self.assertGreater(len(found), 100)
        self.assertEqual([argument for argument, documented in found if not documented], [])
