#!/usr/bin/env python3
"""Print the line coverage of each folder, for scripts/coverage.

usage: coverage_report.py COUNTS.json LINES.txt LEAST

COUNTS.json is a report of gcovr. The script writes LINES.txt, the ranges of lines that were not
executed. The exit code is 1 if the total coverage is under LEAST per cent.
"""

import json
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LANGUAGES = ("*.f90", "*.c", "*.cpp")
SHOWN = 15  # files with the most lines that were not executed


@dataclass
class Count:
    """How many lines there are to run, and which of them never ran."""

    lines: int = 0
    missed: list[int] = field(default_factory=list)

    def add(self, other: "Count") -> None:
        """Add the lines of another file."""
        self.lines += other.lines
        self.missed += other.missed

    def share(self) -> float:
        """Per cent of the lines that ran."""
        return 100 * (1 - len(self.missed) / self.lines) if self.lines else 100.0

    def row(self, name: str) -> str:
        """A row of the table."""
        ran = self.lines - len(self.missed)
        return f"{name:<36}{self.lines:7}{ran:7}{self.share():8.1f} %"


def counts_of(report: dict) -> dict[str, Count]:
    """The counts of each source file of the project that has lines to run."""
    counts = {}
    for file in report["files"]:
        ran: dict[int, bool] = {}
        for line in file["lines"]:
            number = line["line_number"]
            ran[number] = ran.get(number, False) or line["count"] > 0
        if ran and (ROOT / file["file"]).is_file():  # an object may be left of a source that is not
            missed = sorted(number for number in ran if not ran[number])
            counts[file["file"]] = Count(len(ran), missed)
    return counts


def ranges_of(numbers: list[int]) -> list[str]:
    """Ranges of consecutive line numbers."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    return [str(first) if first == last else f"{first}-{last}" for first, last in ranges]


def source_files() -> set[str]:
    """All source files of the library and the program."""
    rooms = (ROOT / "src", ROOT / "app")
    paths = (path for room in rooms for end in LANGUAGES for path in room.rglob(end))
    return {str(path.relative_to(ROOT)) for path in paths}


def main(source: Path, lines: Path, least: float) -> int:
    """Print the tables; return 1 if too few lines ran."""
    counts = counts_of(json.loads(source.read_text(encoding="utf-8")))
    folders: dict[str, Count] = defaultdict(Count)
    total = Count()
    for name, count in sorted(counts.items()):
        folders[str(Path(name).parent)].add(count)
        total.add(count)
    print(f"{'folder':<36}{'lines':>7}{'ran':>7}{'share':>10}")
    for name, count in folders.items():
        print(count.row(name))
    print(total.row("all"))
    worst = sorted(counts, key=lambda name: -len(counts[name].missed))
    print("\nfiles with the most lines that never ran:")
    for name in worst[:SHOWN]:
        print(f"  {len(counts[name].missed):4} of {counts[name].lines:4}  {name}")
    absent = sorted(source_files() - set(counts))
    print("\nfiles without a line to run, in these builds:")
    for name in absent:
        print(f"  {name}")
    with lines.open("w", encoding="utf-8") as file:
        for name in worst:
            if missed := counts[name].missed:
                print(f"{name}: {', '.join(ranges_of(missed))}", file=file)
    return 1 if total.share() < least else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3])))
