"""Script and style of the page: the modules and what they use of three.js, in one piece."""

import os
import subprocess
from pathlib import Path

from reporting.packages import MODULES, PAGE, PackageError, esbuild_package, need

OLDEST_BROWSER = "es2022"
STYLES = ("page.css", "live.css")


def bundle(entry: Path = PAGE / "main.js") -> str:
    """A module and all that it imports, as one classic script without dependencies.

    It has the licence of three.js at its head. Raises a PackageError if what it takes is not there
    and cannot be fetched.
    """
    licence = (need("three") / "LICENSE").read_text(encoding="utf-8")
    program = need(esbuild_package()) / "bin" / "esbuild"
    command = [
        str(program),
        str(entry),
        "--bundle",
        "--minify",
        "--format=iife",
        "--charset=utf8",
        "--legal-comments=none",
        f"--target={OLDEST_BROWSER}",
        f"--banner:js=/*! with three.js\n{licence}*/",
        "--log-level=warning",
    ]
    environment = os.environ | {"NODE_PATH": str(MODULES)}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, encoding="utf-8", env=environment, check=False
        )
    except OSError as error:
        raise PackageError(f"cannot run {program}: {error.strerror}") from error
    if done.returncode or done.stderr:
        raise PackageError(f"esbuild refused {entry.name}:\n{done.stderr.strip()}")
    return done.stdout


def styles() -> str:
    """The style sheets of the page, one after the other."""
    return "\n".join((PAGE / name).read_text(encoding="utf-8") for name in STYLES)
