"""The level of this processor, by which the library is chosen among those of a wheel."""

import os
from pathlib import Path

VARIABLE = "SPINTOP_LEVEL"
"""The variable of the environment that chooses a lower level, as for the program."""
NEEDED = {
    "v2": "cx16 lahf_lm popcnt sse4_1 sse4_2 ssse3",
    "v3": "abm avx avx2 bmi1 bmi2 f16c fma movbe xsave",
    "v4": "avx512bw avx512cd avx512dq avx512f avx512vl",
}
"""What a level of x86-64 has in addition to the one before it, in the words of /proc/cpuinfo."""


def features(text: str) -> set[str]:
    """The features of a processor, from the text of /proc/cpuinfo."""
    lines = (line.partition(":") for line in text.splitlines())
    return next((set(words.split()) for name, _, words in lines if name.strip() == "flags"), set())


def levels_of(found: set[str]) -> list[str]:
    """The levels of a processor with these features, from the lowest."""
    levels = []
    for level, needed in NEEDED.items():
        if not found.issuperset(needed.split()):
            break
        levels.append(level)
    return levels


def chosen_folder(package: Path) -> Path:
    """The folder with the library: that of the highest level of the processor, or the package.

    An ImportError says that SPINTOP_LEVEL names no level of the processor, or that the processor
    is older than the oldest for which there is a library.
    """
    if not any((package / level).is_dir() for level in NEEDED):
        return package
    text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    levels = levels_of(features(text))
    if not levels:
        raise ImportError("this processor is older than x86-64-v2, for which spintop is built")
    level = os.environ.get(VARIABLE) or levels[-1]
    if level not in levels:
        known = ", ".join(levels)
        message = f"{VARIABLE} is '{level}', but the levels of this processor are: {known}"
        raise ImportError(message)
    return package / level
