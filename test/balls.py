"""Provides python-flint for the long tests."""

import importlib.util
import subprocess
import sys


def provide() -> None:
    """Install python-flint in this Python's environment unless it is there."""
    if importlib.util.find_spec("flint") is None:
        command = [sys.executable, "-m", "pip", "install", "--quiet", "python-flint==0.9.0"]
        subprocess.run(command, check=True)
        importlib.invalidate_caches()
