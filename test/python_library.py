"""The library of the Python package, which importing this makes if it is missing or out of date."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

if "SPINTOP_LIBRARY" not in os.environ:
    subprocess.run([ROOT / "scripts/install", "--library"], check=True, capture_output=True)
