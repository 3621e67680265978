"""Builds the shared library into the package: `pip install ./python`."""

import os
import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent


class BuildWithLibrary(build_py):
    """Copies the modules, and the library beside them."""

    def run(self) -> None:
        """Copy everything: the files of scripts/wheel, or the library for this processor."""
        super().run()
        package = Path(self.build_lib) / "spintop"
        if prepared := os.environ.get("SPINTOP_PREPARED"):
            shutil.copytree(prepared, package, dirs_exist_ok=True)
            return
        subprocess.run([ROOT / "scripts" / "install", "--library"], check=True)
        for library in sorted((ROOT / "build" / "shared" / "lib").glob("libspintop.so.?")):
            shutil.copy2(library, package / library.name)
        # Without a network there is no viewer: `animate` says so.
        viewer = package / "viewer.html"
        subprocess.run([ROOT / "scripts" / "report", "--viewer", "-o", viewer], check=False)


class WheelForAnyPython(bdist_wheel):
    """A wheel for this platform and any Python: the library is loaded by ctypes."""

    def get_tag(self) -> tuple[str, str, str]:
        """The tags of the wheel."""
        return "py3", "none", super().get_tag()[2]


setup(
    cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": WheelForAnyPython},
    has_ext_modules=lambda: True,  # the library is one: the distribution is for this platform
)
