"""scripts/install: the shared library, and programs that find it by pkg-config and by CMake."""

import os
import re
import shutil
import tempfile
import unittest
from pathlib import Path
from typing import ClassVar

import pytest

from conftest import ROOT, execute
from manual.pages import blocks_of

HEADER = ROOT / "include/spintop.h"
BLOCKS = [block for block in blocks_of(ROOT / "doc/c.md") if block.tags[:1] == ("c",)]
CMAKE = """\
cmake_minimum_required(VERSION 3.16)
project(example C)
find_package(spintop {version} REQUIRED)
add_executable(example example.c)
target_link_libraries(example PRIVATE spintop::spintop)
"""
FORTRAN = """\
cmake_minimum_required(VERSION 3.16)
project(example Fortran C CXX)
find_package(spintop 0.1 REQUIRED)
foreach(name exact_motion own_method)
    add_executable(${name} ${name}.f90)
    target_link_libraries(${name} PRIVATE spintop::fortran)
endforeach()
add_executable(example example.c)
target_link_libraries(example PRIVATE spintop::spintop)
"""


class InstallTest(unittest.TestCase):
    """A prefix whose name has a space."""

    folder: ClassVar[Path]
    prefix: ClassVar[Path]
    source: ClassVar[Path]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="spintop install "))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = cls.folder / "pre fix"
        execute(ROOT / "scripts/install", cls.prefix)
        cls.source = cls.folder / "example.c"
        cls.source.write_text(BLOCKS[0].text, encoding="utf-8")

    def call(self, *command: str | Path, **environment: str) -> str:
        return execute(*command, cwd=self.folder, environment=environment).stdout

    def check_example(self, program: Path) -> None:
        """The motion that it prints is that of the program."""
        scene = self.folder / "scene.nml"
        text = re.sub(r"(?s).*?(&top.*?)\\n\".*", r"\1", BLOCKS[0].text)
        rest = "&initial theta_deg = 11.25 psi_rate = 1 / &span t_end = 2 samples = 3 /"
        scene.write_text(f"{text}\n{rest} &output columns = 'theta', 'phi' /", encoding="utf-8")
        self.call(self.prefix / "bin/spintop", "--quiet", "-o", self.folder, scene)
        table = (self.folder / "scene.csv").read_text(encoding="utf-8").splitlines()
        rows = [line.split(",") for line in table if line[0] != "#"][1:]
        lines = self.call(program).splitlines()
        self.assertEqual(len(lines), 3)
        for line, (theta, phi) in zip(lines, rows, strict=True):
            expected = f"theta = {float(theta):.15g}, phi = {float(phi):.15g}"
            self.assertTrue(line.endswith(expected), line)

    def test_manual_page(self) -> None:
        """It has the text of --help, and troff finds no mistake in it."""
        page = self.prefix / "share/man/man1/spintop.1"
        text = page.read_text(encoding="utf-8").replace("\\-", "-")
        help_text = self.call(self.prefix / "bin/spintop", "--help")
        for words in re.findall(r"\S+", help_text.partition("usage:")[2]):
            if words not in {"exit", "codes", "topics:", "options"}:
                self.assertIn(words, text)
        if not shutil.which("groff"):
            self.skipTest("no groff")
        done = execute("groff", "-man", "-Tutf8", "-P-cbou", "-ww", page)
        self.assertEqual(done.stderr, "")
        headings = ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES")
        for heading in (*headings, "FILES", "ENVIRONMENT", "SEE ALSO"):
            self.assertIn(heading, done.stdout)

    def test_example_of_the_manual_page(self) -> None:
        """The program takes the input, and its options are those of the page."""
        page = (ROOT / "scripts/manual/spintop.1").read_text(encoding="utf-8").replace("\\", "")
        scene = self.folder / "top.nml"
        scene.write_text("".join(re.findall(r"(?m)^&.*/\n", page.replace("&'", "'"))), "utf-8")
        program = self.prefix / "bin/spintop"
        self.assertIn("method    exact", self.call(program, "--check", scene))
        help_text = self.call(program, "--help")
        options = re.findall(r" (--[a-z]+)", "".join(re.findall(r"(?m)^spintop.*", page)))
        self.assertEqual(len(options), 4)
        for option in options:
            self.assertIn(option, help_text)

    def test_destination(self) -> None:
        """Below DESTDIR everything stands as below the prefix, and only that is named."""
        staged = self.folder / "staged"
        self.call(ROOT / "scripts/install", "/opt/top", DESTDIR=str(staged))

        def files(folder: Path) -> list[Path]:
            return sorted(path.relative_to(folder) for path in folder.rglob("*"))

        self.assertEqual(files(staged / "opt/top"), files(self.prefix))
        text = (staged / "opt/top/lib/pkgconfig/spintop.pc").read_text(encoding="utf-8")
        self.assertIn("prefix=/opt/top\n", text)

    def test_what_is_exported(self) -> None:
        """The functions of the header, and nothing else; the stack is not executable."""
        library = self.prefix / "lib/libspintop.so"
        self.assertEqual(os.readlink(library), "libspintop.so.1")
        listed = self.call("nm", "-D", "--defined-only", library).split()
        exported = {name.split("@")[0] for name in listed if name.startswith("spintop_")}
        text = re.sub(r"/\*.*?\*/", "", HEADER.read_text(encoding="utf-8"), flags=re.DOTALL)
        self.assertEqual(exported, set(re.findall(r"\b(spintop_\w+)\(", text)))
        names = {name for name in listed if not re.fullmatch(r"[0-9a-f]{16}|[A-Z]", name)}
        self.assertEqual({name.split("@")[0] for name in names}, exported | {"SPINTOP_1"})
        stack = re.search(r"GNU_STACK.*", self.call("readelf", "-lW", library))[0]
        self.assertNotIn("RWE", stack)

    def test_pkg_config(self) -> None:
        if not shutil.which("pkg-config"):
            self.skipTest("no pkg-config")
        path = str(self.prefix / "lib/pkgconfig")
        found = self.call("pkg-config", "--modversion", "spintop", PKG_CONFIG_PATH=path).strip()
        self.assertEqual(found, self.call(self.prefix / "bin/spintop", "--version").split()[1])
        command = "eval cc -Wall -Werror example.c $(pkg-config --cflags --libs spintop)"
        command += """ '-Wl,-rpath,"$RPATH"' -o by_pkg_config"""
        self.call("bash", "-c", command, PKG_CONFIG_PATH=path, RPATH=str(self.prefix / "lib"))
        self.check_example(self.folder / "by_pkg_config")

    @pytest.mark.slow
    def test_cmake(self) -> None:
        """A project finds the package; one that asks for a newer version does not."""
        if not shutil.which("cmake") or not (shutil.which("make") or shutil.which("ninja")):
            self.skipTest("no cmake, or no make that it could use")
        prefix = f"-DCMAKE_PREFIX_PATH={self.prefix}"
        for version in ("", "0.1"):
            (self.folder / "CMakeLists.txt").write_text(CMAKE.format(version=version), "utf-8")
            build = self.folder / f"build{version}"
            self.call("cmake", "-S", ".", "-B", build, prefix)
            self.call("cmake", "--build", build)
            self.check_example(build / "example")
        (self.folder / "CMakeLists.txt").write_text(CMAKE.format(version="9.0"), "utf-8")
        done = execute("cmake", "-S", ".", "-B", "build9", prefix, cwd=self.folder, code=1)
        self.assertIn("9.0", done.stderr)

    def test_cmake_of_fortran(self) -> None:
        """A project has a program with the module and one in C."""
        if not shutil.which("cmake") or not (shutil.which("make") or shutil.which("ninja")):
            self.skipTest("no cmake, or no make that it could use")
        project = self.folder / "fortran"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(FORTRAN, "utf-8")
        shutil.copy(self.source, project)
        for name in ("exact_motion", "own_method"):
            shutil.copy(ROOT / f"example/{name}.f90", project)
        build = project / "build"
        self.call("cmake", "-S", project, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.call("cmake", "--build", build)
        self.check_example(build / "example")
        lines = self.call(build / "exact_motion").splitlines()
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.assertRegex(line, r"^t = +\d\.\d s: phi, theta, psi =( +\d\.\d{8}){3}$")
        self.assertRegex(self.call(build / "own_method"), r"(\w+, steps \d+: +\S+ rad\n){6}")

    def test_usage(self) -> None:
        for arguments in ((), ("--wrong",), ("a", "b")):
            done = execute(ROOT / "scripts/install", *arguments, code=2)
            self.assertIn("usage: scripts/install PREFIX", done.stderr)
