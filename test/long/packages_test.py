"""Containers and Debian packages: their recipes on a bare Debian 12, and what they give there."""

import re
import unittest

from conftest import ROOT, execute

PACKAGING = ROOT / "packaging"
SAME = "spintop --quiet -o /tmp/o input/slow_top.nml && grep -q '^# status: ok' /tmp/o/slow_top.csv"
"""The program of the package answers the first example."""
TOOLS = "build-essential debhelper lintian man-db"
DEBIAN = (
    f"apt-get update -qq && apt-get install -qq -y --no-install-recommends {TOOLS}",
    "mkdir /tmp/p && cp -r packaging/debian /tmp/p && cd /tmp/p && apt-get build-dep -qq -y .",
    "packaging/make_deb",
    f"apt-get install -qq -y ./build/deb/*.deb && {SAME} && man -w spintop && spintop --version",
)
CONTAINER = (
    "packaging/container/install .",
    f"{SAME} && spintop --version && ! command -v gfortran g++",
    "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; mpirun --oversubscribe -np 2"
    " spintop-mpi -o /tmp/o input/spinning_wheel_sweep.nml",
)


class PackagesTest(unittest.TestCase):
    def try_commands(self, commands: tuple[str, ...]) -> None:
        done = execute(ROOT / "scripts/fresh_machine", "bookworm", *commands, code=None)
        if done.stdout.endswith("0 passed, 0 failed\n"):
            self.skipTest(done.stderr.strip())
        expected = f"{len(commands)} passed, 0 failed\n"
        self.assertTrue(done.stdout.endswith(expected), done.stdout[-4000:] + done.stderr[-4000:])

    def test_debian_packages(self) -> None:
        """They are made, lintian accepts them, and what they install runs."""
        self.try_commands(DEBIAN)

    def test_container(self) -> None:
        """The step of the image leaves the program, that for MPI, and no compiler."""
        self.try_commands(CONTAINER)

    def test_versions(self) -> None:
        """The package has the version of the project, and of the library its number."""
        manifest = (ROOT / "fpm.toml").read_text(encoding="utf-8")
        version = re.search(r'^version = "(.*)"', manifest, re.MULTILINE)[1]
        changes = (PACKAGING / "debian/changelog").read_text(encoding="utf-8")
        self.assertTrue(changes.startswith(f"spintop ({version})"), changes[:40])
        header = (ROOT / "include/spintop.h").read_text(encoding="utf-8")
        number = re.search(r"SPINTOP_INTERFACE (\d+)", header)[1]
        control = (PACKAGING / "debian/control").read_text(encoding="utf-8")
        self.assertIn(f"Package: libspintop{number}\n", control)
