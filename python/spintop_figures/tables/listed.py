"""The registries of the program, by which tables are understood."""

import json
from pathlib import Path

COPIES = Path(__file__).parent
"""Where the copies are. scripts/manual_tables renews them, and a test compares them."""


def listed(topic: str) -> dict[str, list]:
    """What `spintop list TOPIC --json` gives, from its copy."""
    return json.loads((COPIES / f"{topic}.json").read_text(encoding="utf-8"))
