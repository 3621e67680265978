"""Installing peers: those from PyPI into a virtual environment of their own, the others by apt."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from peers.crew import VENV

REQUIREMENTS = Path(__file__).resolve().parent / "requirements.txt"


def attempt(*command: object) -> None:
    """Run a command, and say so if it fails."""
    words = list(map(str, command))
    result = subprocess.run(words, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                            check=False)  # fmt: skip
    if result.returncode:
        reason = (result.stderr.strip() or result.stdout.strip()).splitlines()[-1:]
        print(f"scripts/compare_peers: {' '.join(words)} failed: {' '.join(reason)}",
              file=sys.stderr)  # fmt: skip


def install_from_pypi() -> None:
    """Install what requirements.txt names, unless that has been done."""
    done = VENV / "requirements.txt"
    if done.exists() and done.read_bytes() == REQUIREMENTS.read_bytes():
        return
    attempt(sys.executable, "-m", "venv", "--clear", VENV)
    python = VENV / "bin/python"
    pip = (python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    attempt(*pip, "--no-deps", "--require-hashes", "--requirement", REQUIREMENTS)
    if subprocess.run([python, "-c", "import numpy"], check=False).returncode == 0:
        shutil.copy(REQUIREMENTS, done)


def install_from_debian(packages: list[str]) -> None:
    """Install packages, as root or by sudo."""
    if not packages or not shutil.which("apt-get"):
        return
    as_root = [] if os.geteuid() == 0 else ["sudo"]
    attempt(*as_root, "apt-get", "update", "-qq")
    attempt(*as_root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "install", "-y",
            "--no-install-recommends", *packages)  # fmt: skip
