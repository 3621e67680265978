"""Builds the shared library of the checkout into the package: `pip install ./python`."""

import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

ROOT = Path(__file__).resolve().parent.parent


class BuildWithLibrary(build_py):
    """Copies the modules, and the library beside them."""

    def run(self) -> None:
        """Make the library, if it is not up to date, and copy everything."""
        super().run()
        subprocess.run([ROOT / "scripts" / "install", "--library"], check=True)
        for library in sorted((ROOT / "build" / "shared" / "lib").glob("libspintop.so.?")):
            shutil.copy2(library, Path(self.build_lib) / "spintop" / library.name)


class WithLibrary(Distribution):
    """A distribution for this platform."""

    def has_ext_modules(self) -> bool:
        """The library is one."""
        return True


setup(cmdclass={"build_py": BuildWithLibrary}, distclass=WithLibrary)
