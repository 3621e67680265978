"""The registries of the program, by which tables are understood."""

import json
import os
import subprocess
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[3] / "build" / "release" / "spintop"
"""The program of a checkout, unless SPINTOP_EXE names another one."""


def listed(topic: str, copy: Path) -> list[dict]:
    """What `spintop list TOPIC --json` gives if there is a program that answers, else its copy."""
    program = os.environ.get("SPINTOP_EXE") or PROGRAM
    try:
        command = [program, "list", topic, "--json"]
        answer = subprocess.run(command, capture_output=True, check=True, timeout=10)
        return json.loads(answer.stdout)[topic]
    except (OSError, subprocess.SubprocessError, ValueError, KeyError):
        return json.loads(copy.read_text(encoding="utf-8"))[topic]
