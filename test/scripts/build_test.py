"""The build by scripts/setup: flags of files, what fpm sees, and what is shown of its words."""

import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import pytest

from conftest import ROOT, each, execute

ERROR = "src/x.f90:1:2:\n\n    1 | y = z\n      |     1\nError: Symbol 'z' has no IMPLICIT type"
SAID = [
    " + mkdir -p build/dependencies",
    *(f"[{done:3d}%] {'a_file.f90':>30}  done." for done in range(100) for _ in range(7)),
    "",
    ERROR,
    '<ERROR> Compilation failed for object "src_x.f90.o"',
]
"""Of an fpm that fails at the end."""


def call(folder: Path, commands: str, **environment: str) -> subprocess.CompletedProcess:
    """Commands of a shell with the functions of scripts/setup, in a checkout."""
    words = ("bash", "-c", f"source scripts/setup; {commands}")
    return execute(*words, code=None, cwd=folder, environment=environment)


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout without sources, whose fpm says what is to be said, and notes what it sees."""
    root = tmp_path / "check out"
    for name in ("src", "app", "example", "test"):
        (root / name).mkdir(parents=True)
    scripts = (f"scripts/{name}" for name in ("setup", "requirements.lock", "compiler/gfortran"))
    for name in (*scripts, "fpm.toml"):
        (root / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, root / name)
    (root / "said").write_text("\n".join(SAID) + "\n", encoding="utf-8")
    fpm = tmp_path / "fpm"
    fpm.write_text("#!/bin/sh\nls >../seen; cat fpm.toml >../manifest; cat ../../said; exit 1\n")
    fpm.chmod(0o755)
    return root


def test_of_what_fpm_says_errors_are_shown(checkout: Path) -> None:
    """Of its 700 lines of progress a handful; errors are whole; the log has all."""
    done = call(checkout, "run_fpm release new", SPINTOP_FPM=str(checkout.parent / "fpm"))
    assert done.returncode == 1
    assert ERROR in done.stderr
    assert SAID[-1] in done.stderr
    assert "%]" not in done.stderr
    assert len(done.stderr.splitlines()) <= len(ERROR.splitlines()) + 6
    assert (checkout / "build/release.log").read_text(encoding="utf-8").splitlines() == "\n".join(
        SAID
    ).splitlines()


def test_a_failed_build_names_the_log(checkout: Path) -> None:
    done = call(checkout, "forget_build release", SPINTOP_FPM="false")
    assert (done.returncode, done.stdout) == (1, "")
    assert "build/release.log" in done.stderr


def test_openblas_has_the_names_of_lapack_and_blas(checkout: Path) -> None:
    """Where a cluster's module has it alone; a LAPACK that is there stays."""
    libraries, programs = (checkout.parent / name for name in ("lib", "bin"))
    libraries.mkdir(), programs.mkdir()
    compiler = programs / "gfortran"
    find = 'ls "${LIBRARY_PATH%%:*}/${1#*=}" 2>/dev/null || echo "${1#*=}"'
    compiler.write_text(f"#!/bin/sh\n{find}\n", encoding="utf-8")
    compiler.chmod(0o755)
    library = libraries / "libopenblas.so"
    library.touch()
    there = {"PATH": f"{programs}:{os.environ['PATH']}", "LIBRARY_PATH": str(libraries)}
    show = 'has_library lapack; echo "$LIBRARY_PATH"'
    done = call(checkout, f"readlink build/openblas/*; {show}", **there)
    named = f"{checkout / 'build/openblas'}:{libraries}"
    assert done.stdout.splitlines() == [*[str(library)] * 2, named]
    shutil.rmtree(checkout / "build")
    (libraries / "liblapack.so").touch()
    assert call(checkout, show, **there).stdout.splitlines() == [str(libraries)]


def test_fpm_sees_no_examples(checkout: Path) -> None:
    """A user needs neither examples nor tests."""
    call(checkout, "run_fpm release new", SPINTOP_FPM=str(checkout.parent / "fpm"))
    seen = (checkout / "build/seen").read_text(encoding="utf-8").split()
    assert seen == ["app", "fpm.toml", "src"]
    manifest = (checkout / "build/manifest").read_text(encoding="utf-8")
    assert re.findall(r"^auto-\w+ = \w+", manifest, re.MULTILINE) == [
        f"auto-{name} = false" for name in ("executables", "examples", "tests")
    ]


@each(
    "source, level",
    ("././src/studies/job.f90", "-O1"),
    ("./src/studies/sweep/engines/deep.f90", "-O1"),
    ("src/studies/fit/fit_model.f90", "-O3"),
    ("././src/studies/trial.f90", "-O3"),
    ("././src/studies_of_mine/job.f90", "-O3"),
    ("././src/top/body.f90", "-O3"),
    ("././app/main.f90", "-O1"),
    ("-o build/program", "-O3"),
)
def test_levels(tmp_path: Path, source: str, level: str) -> None:
    """The last level that the compiler is given, for a file, and for a program that is linked."""
    compiler = tmp_path / "gfortran"
    compiler.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n', encoding="utf-8")
    compiler.chmod(0o755)
    light = "-DSPINTOP_LIGHT=app:src/studies"
    full = "-DSPINTOP_FULL=src/studies/fit:src/studies/trial.f90"
    words = ("-c", *source.split(), "-O3", light, full, "-I/src/studies/x y")
    path = {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    done = execute(ROOT / "scripts/compiler/gfortran", *words, environment=path)
    words = done.stdout.splitlines()
    assert [word for word in words if word.startswith("-O")][-1] == level
    assert "-I/src/studies/x y" in words


def test_places_of_levels_exist() -> None:
    done = call(ROOT, 'echo "${light//:/ } ${full//:/ }"')
    places = done.stdout.split()
    assert len(places) > 10
    assert [place for place in places if not (ROOT / place).exists()] == []


MACHINE = """
missing_packages() { [ -e apt ] || echo gfortran; }
has_venv() { [ -e venv ]; }
install_packages() {
    case $1 in
    python3-venv) touch venv ;;
    *)
        until [ -e begun ]; do sleep 0.01; done
        [ -z "$broken" ] && touch apt || give_up "no network"
        ;;
    esac
}
make_venv() {
    touch begun && [ -e venv ] && mkdir -p .venv/bin && echo "# bash" >.venv/bin/activate
}
"""
"""A machine without compiler and venv; apt-get goes on until pip has begun."""


@each("broken", "", "yes")
def test_pip_beside_apt(checkout: Path, broken: str) -> None:
    """pip runs while apt-get installs what it does not need; a failure of that ends the set-up."""
    command = f"broken={broken}; {MACHINE} install_missing; touch complete"
    done = call(checkout, command, SPINTOP_NETCDF="0")
    assert (checkout / "begun").exists(), done.stderr
    assert done.returncode == (2 if broken else 0), done.stderr
    assert ("no network" in done.stderr) == bool(broken)
    assert (checkout / "complete").exists() == (not broken)


def test_only_the_setup_installs_unasked(checkout: Path) -> None:
    command = "apt-get() { touch called; }; sudo() { touch called; }; install_packages gfortran"
    done = call(checkout, command, SPINTOP_NETCDF="0", SPINTOP_INSTALL="")
    assert "scripts/setup installs them" in done.stderr
    assert done.returncode == 2
    assert not (checkout / "called").exists()


def test_users_install_no_linters() -> None:
    """What pip installs at set-up, and what scripts/lint adds, have nothing in common."""
    packages, linters = (
        set(re.findall(r"^[\w-]+(?===)", call(ROOT, f"locked {group}").stdout, re.MULTILINE))
        for group in ("base", "lint")
    )
    assert {"fortitude-lint", "ruff", "clang-format"} <= linters
    assert not packages & linters


def test_every_package_is_locked() -> None:
    """All packages of the groups have a version and hashes in the lock, which has no others."""
    lock = (ROOT / "scripts/requirements.lock").read_text(encoding="utf-8")
    locked = re.findall(r"^([\w.-]+)==", lock, re.MULTILINE)
    assert lock.count("--hash=sha256:") >= len(locked)
    named = call(ROOT, 'printf "%s\\n" ${packages[@]}').stdout.split()
    assert set(named) == set(locked)


# The stand-in for pFUnit: scripts/pf2f90.py and the modules in test/funit.

HEAD = "module suite\nuse funit\nimplicit none\ncontains\n"
TAIL = "end module suite\n"


def a_test(name: str, *body: str) -> str:
    return "\n".join(["@test", f"subroutine {name}()", *body, f"end subroutine {name}", ""])


@pytest.mark.usefixtures("folder")
class StandInTest(unittest.TestCase):
    def convert(self, text: str, code: int = 0) -> str:
        source = self.folder / "suite.pf"
        source.write_text(text, encoding="utf-8")
        words = (sys.executable, ROOT / "scripts/pf2f90.py", source, self.folder / "suite.f90")
        return execute(*words, code=code).stderr

    def test_refusals_name_file_and_line(self) -> None:
        """What the stand-in lacks does not pass silently."""
        refused = {
            "@assertTrue(.true.) ! why": "on one line",
            "@assertEqual(1, &": "on one line",
            "@assertIsInfinite(1.0)": "@assertIsInfinite",
            "@disable": "@disable",
            "@test": "subroutine NAME()",
            "@mpiTest(npes=[1])": "@mpiTest",
        }
        for line, reason in refused.items():
            with self.subTest(line):
                said = self.convert(HEAD + a_test("passes") + line + "\n" + TAIL, code=1)
                self.assertRegex(said, r"suite\.pf:[89]: ")
                self.assertIn(reason, said)

    def test_failures_are_counted(self) -> None:
        """A failing assert fails its test, ends it, and gives the exit code 1."""
        matrix = "real(kind(1d0)) :: m(2, 2) = reshape([1d0, 2d0, 3d0, 4d0], [2, 2])"
        zero = "real(kind(1d0)) :: x = 0"
        tests = (
            a_test("passes", "@assertEqual('a, (b', ' a, (b')"),
            a_test("section", matrix, "@assertEqual(m(2, :), -[-2d0, -4d0])"),
            a_test("nan", zero, "@assertEqual(1d0, x / x, tolerance=9d9)"),
            a_test("shape", "@assertEqual([1, 2], [1])", "@assertFail('too late')"),
            a_test("types", "@assertEqual(1d0, 1)"),
            a_test("order", "@assertLessThan(1, [2, 1], message='a message')"),
            a_test("zero", "@assertRelativelyEqual(0d0, 0d0, tolerance=1d0)"),
        )
        self.assertEqual(self.convert("".join([HEAD, *tests, TAIL])), "")
        sources = [ROOT / "test/funit/boxes.f90", ROOT / "test/funit/funit.f90", "suite.f90"]
        execute("gfortran", "-cpp", "-w", *sources, "-o", "suite", cwd=self.folder)
        result = execute("./suite", cwd=self.folder, code=1)
        self.assertEqual(result.stdout.splitlines()[-1], "suite: 2 passed, 5 failed")
        self.assertIn("order (suite.pf:30): not 1 < 1 in element 2 | a message", result.stdout)
        self.assertNotIn("too late", result.stdout)
