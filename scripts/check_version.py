#!/usr/bin/env python3
"""Compare the version of fpm.toml, which is its source, with the other places that name it."""

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# File, and the pattern whose group is the version there.
PLACES = {
    "src/tables/provenance.f90": r"program_version = '([^']+)'",
    "python/pyproject.toml": r'^version = "([^"]+)"$',
    "CITATION.cff": r"^version: (\S+)$",
    "CHANGELOG.md": r"^## (\d\S*)",
    "packaging/conda/recipe/meta.yaml": r'set version = "([^"]+)"',
    "packaging/spack/package.py": r'^    version\("([^"]+)"',
}


def main() -> int:
    """Say where the version differs; 1 if it does anywhere."""
    wanted = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))["version"]
    status = 0
    for name, pattern in PLACES.items():
        found = re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE)
        version = found.group(1) if found else "none"
        if version != wanted:
            print(f"{name}: version {version}, but fpm.toml has {wanted}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
