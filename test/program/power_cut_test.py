"""Power cuts at every moment of a run, and calls that are interrupted.

The library of faults_test, where calls fail, records what the program does to files, in order. From
a record follows what a disk may hold after a power cut: all that was synchronised, and of the rest
anything.
"""

import os
import random
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import pytest

from conftest import EXE, GOOD, netcdf_is_missing, output
from faults_test import FAULTS
from slow_sweep import SLOW, STEPS

pytestmark = pytest.mark.slow

SWEEP = SLOW.replace("= 2 /", "= 0.1 /").replace(STEPS, "steps = 4").replace("= 1000", "= 320")
SWEEP += output("theta_end", "phi_end")


@dataclass
class Node:
    """A file of a disk: what of it is safe, and what was done to it since."""

    safe: bytes = b""
    recent: list[tuple[int, bytes] | int] = field(default_factory=list)  # writes; sizes to cut to

    def content(self, draw: random.Random | None = None) -> bytes:
        """The contents for a reader; after a power failure, if one is drawn."""
        data = bytearray(self.safe)
        for change in self.recent:
            fate = draw.choice(("kept", "kept", "lost", "torn", "zeros")) if draw else "kept"
            if fate == "lost":
                continue
            if isinstance(change, int):
                data = data[:change] + bytes(max(change - len(data), 0))
                continue
            place, text = change
            if fate == "torn":
                text = text[: draw.randrange(len(text) + 1)]
            elif fate == "zeros":
                text = bytes(len(text))
            data += bytes(max(place - len(data), 0))
            data[place : place + len(text)] = text
        return bytes(data)


class Disk:
    """The files below a folder: what is safe from a power cut, and what is not."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.names: dict[str, Node | None] = {}  # what a reader finds; None is a folder
        for path in sorted(root.rglob("*")):
            self.names[self.name_of(path)] = None if path.is_dir() else Node(path.read_bytes())
        self.safe_names = dict(self.names)
        self.recent: dict[str, list[tuple]] = {}  # changes of names, by folder
        self.open: dict[int, Node | str] = {}

    def name_of(self, path: str | Path) -> str:
        """A path as seen from the root, which is `.` itself."""
        return os.path.relpath(self.root / path, self.root)

    def change(self, *change: str | Node | None) -> None:
        self.recent.setdefault(os.path.dirname(change[1]) or ".", []).append(change)
        apply(self.names, change)

    def do(self, record: tuple) -> None:
        match record:
            case ("open", file, cuts, path):
                name = self.name_of(path)
                if name == "." or (name in self.names and self.names[name] is None):
                    self.open[file] = name
                    return
                if name not in self.names and not name.startswith(".."):
                    self.change("put", name, Node())
                node = self.names.get(name, Node())
                if int(cuts):
                    node.recent.append(0)
                self.open[file] = node
            case ("write", file, place, data):
                self.open[file].recent.append((int(place), data))
            case ("truncate", file, size):
                self.open[file].recent.append(int(size))
            case ("sync", file):
                self.sync(self.open[file])
            case ("rename", old, new):
                old = self.name_of(old)
                self.change("move", self.name_of(new), self.names[old], old)
            case ("unlink", path):
                self.change("drop", self.name_of(path))
            case ("mkdir", path):
                self.change("put", self.name_of(path), None)

    def sync(self, what: Node | str) -> None:
        if isinstance(what, Node):
            what.safe, what.recent = what.content(), []
            return
        for change in self.recent.pop(what, []):
            apply(self.safe_names, change)

    def after_power_cut(self, draw: random.Random) -> dict[str, bytes | None]:
        """Possible contents: some of the changes that are not safe, in order, and torn writes."""
        names = dict(self.safe_names)
        for changes in self.recent.values():
            for change in changes:
                if draw.random() < 0.5:
                    apply(names, change)
        found: dict[str, bytes | None] = {}
        for name, node in sorted(names.items()):
            folder = os.path.dirname(name)
            if folder and folder not in found:
                continue  # lost with its folder
            found[name] = None if node is None else node.content(draw)
        return found


def apply(names: dict[str, Node | None], change: tuple) -> None:
    if change[0] == "drop":
        names.pop(change[1], None)
        return
    names[change[1]] = change[2]
    if change[0] == "move" and names.get(change[3]) is change[2]:
        del names[change[3]]


def read_record(path: Path) -> Iterator[tuple]:
    data, at = path.read_bytes(), 0
    while at < len(data):
        end = data.index(b"\n", at)
        call, *words = data[at:end].decode().split("\t")
        at = end + 1
        if call == "write":
            length = int(words.pop())
            yield (call, *words, data[at : at + length])
            at += length
        else:
            yield (call, *words)


@pytest.fixture
def record(spin, preload):
    """Runs the program on one thread in the folder `run` or another; what it did to files."""
    (spin.folder / "run").mkdir()

    def run(*words, folder="run"):
        spin.write("", "record")
        environment = preload(FAULTS) | {"FAULT_TICK": "10000000"}
        environment["FAULT_RECORD"] = str(spin.folder / "record")
        threads = () if words[0] == "merge" else ("--threads", "1")
        command = ("env", "-C", spin.folder / folder, EXE)
        spin.call(*words, *threads, command=command, environment=environment)
        return list(read_record(spin.folder / "record"))

    return run


@pytest.fixture
def sweep(spin):
    return spin.folder / spin.write(SWEEP, "sweep.nml")


@pytest.fixture
def reference(spin, sweep):
    return spin(sweep, "--output=reference").path.read_bytes()


def check_order(disk: Disk, records: list[tuple]) -> int:
    """Data are safe from a power failure, by call; the number of entries of the journal."""
    entries = 0
    for record in records:
        starts_entry = record[0] == "open" and record[3].endswith(".journal.new")
        if starts_entry or (record[0] == "rename" and record[1].endswith(".part")):
            moved = [change for change in disk.recent.get("output", []) if change[0] == "move"]
            assert moved == [], "the last entry is not safe"
        if record[0] == "rename":
            old, new = map(disk.name_of, record[1:])
            node = disk.names[old]
            assert node.recent == [], f"{old} takes its name before it is safe"
            if new.endswith(".journal"):
                entries += 1
                part = new.removesuffix(".journal") + ".part"
                length = int(node.safe.split()[4])
                assert len(disk.names[part].safe) >= length, "rows are not safe"
        if record[0] == "unlink" and disk.name_of(record[1]).endswith(".journal"):
            table = disk.name_of(record[1]).removesuffix(".journal")
            if table + ".part" not in disk.names:
                assert table in disk.safe_names, "the table has not yet its name"
        disk.do(record)
        if record[0] == "sync" and disk.open[record[1]] == "output":
            for name in disk.safe_names:
                table = name.removesuffix(".journal")
                assert table == name or {table, table + ".part"} & {*disk.safe_names}
    assert disk.safe_names == disk.names, "names are not safe at the end"
    for name, node in disk.names.items():
        assert not (node and node.recent), f"{name} is not safe at the end"
    return entries


def test_rows_then_entry_then_name(spin, record, sweep, reference):
    """Rows are on the disk before their journal entry, and a file before its final name."""
    disk = Disk(spin.folder / "run")
    assert check_order(disk, record(sweep)) >= 4
    assert sorted(disk.names) == ["output", "output/sweep.csv", "output/sweep.log"]
    assert disk.names["output/sweep.csv"].safe == reference


def test_every_table_is_safe_before_its_name(spin, record, sweep, reference):
    run = spin.folder / "run"
    scene = spin.write(GOOD.replace("columns =", "events = 'turning_points', columns ="))
    stability = "&study kind = 'stability' /\n"
    stability += "&stability cases = 'sleeping_above', methods = 'rk4' /\n"
    runs = [[spin.folder / scene], [spin.folder / spin.write(stability, "stability.nml")]]
    runs += [[sweep, "--shard", "1/2"], [sweep, "--shard", "2/2"]]
    parts = ["output/sweep.1-of-2.csv", "output/sweep.2-of-2.csv"]
    runs.append(["merge", "output/sweep.csv", *parts])
    if not netcdf_is_missing():
        runs.append([sweep, "--set", "output.format=netcdf"])
    for words in runs:
        disk = Disk(run)
        before = set(disk.names)
        check_order(disk, record(*words))
        assert set(disk.names) != before, words
        assert not [name for name in disk.names if name.endswith((".part", ".new"))], words
        for name, node in disk.names.items():
            assert node is None or node.safe == (run / name).read_bytes()
    assert (run / "output/sweep.csv").read_bytes() == reference


def test_no_fsync_can_be_left_out(spin, record, sweep):
    """The check itself: without any one of them it fails."""
    run = spin.folder / "run"
    empty = Disk(run)
    records = record(sweep)

    def disk() -> Disk:
        disk = Disk(run)
        disk.names, disk.safe_names = dict(empty.names), dict(empty.safe_names)
        return disk

    places = [i for i, record in enumerate(records) if record[0] == "sync"]
    assert len(places) >= 12
    for place in places:
        try:
            check_order(disk(), records[:place] + records[place + 1 :])
        except AssertionError:
            continue
        # Only where there was nothing to make safe, but that a journal is gone.
        there = disk()
        for record in records[:place]:
            there.do(record)
        what = there.open[records[place][1]]
        if isinstance(what, Node):
            assert what.recent == [], f"call {place}"
        else:
            assert {change[0] for change in there.recent.get(what, [])} <= {"drop"}, f"call {place}"


def lay_out(folder: Path, files: dict[str, bytes | None]) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, content in files.items():
        if content is None:
            (folder / name).mkdir()
        else:
            (folder / name).write_bytes(content)


def rows_of(journal: bytes | None) -> int:
    words = (journal or b"rows: end:").decode().split()
    return sum(map(int, words[words.index("rows:") + 1 : words.index("end:")]))


def check_resumed(spin, sweep, reference, files: dict[str, bytes | None], safe_rows: int) -> None:
    """The remaining part has the safe rows, and is resumed to the uninterrupted table."""
    table, rows = files.get("output/sweep.csv"), rows_of(files.get("output/sweep.csv.journal"))
    assert table in (None, reference), "half a table bears its name"
    assert table or rows >= safe_rows, "the journal has lost rows"
    lay_out(spin.folder / "after", files)
    output = spin.folder / "after/output"
    run = spin.call(sweep, "--threads", "1", "--resume", "-o", output)
    if rows > 0 and "output/sweep.csv.part" in files:
        assert f"resumes after {rows} rows" in run.out
    assert (output / "sweep.csv").read_bytes() == reference
    assert not list(output.glob("*.journal"))


def cut_everywhere(disk: Disk, records: list[tuple], seed: int, check) -> list[dict]:
    """Cut the power after each call, and look at what may be left, which is returned."""
    draw, seen, left = random.Random(seed), set(), []
    for record in records:
        disk.do(record)
        safe = disk.safe_names.get("output/sweep.csv.journal")
        files = disk.after_power_cut(draw)
        key = tuple(sorted(files.items()))
        if key not in seen:
            seen.add(key)
            left.append(files)
            check(files, rows_of(safe and safe.safe))
    return left


def test_cut_at_every_call(spin, record, sweep, reference):
    """No row that the journal has is lost, and no half table has a name; cut once and again."""
    check = partial(check_resumed, spin, sweep, reference)
    disk = Disk(spin.folder / "run")
    left = cut_everywhere(disk, record(sweep), 2012, check)
    assert len(left) > 20
    some = [f for f in left if "output/sweep.csv.journal" in f and "output/sweep.csv.part" in f]
    for files in some[len(some) // 2 :: len(some)]:
        lay_out(spin.folder / "again", files)
        disk = Disk(spin.folder / "again")
        cut_everywhere(disk, record(sweep, "--resume", folder="again"), 41, check)


def test_interrupted_calls_and_short_writes(spin, preload, sweep, reference):
    environment = preload(FAULTS) | {"FAULT_INTERRUPTS": "1", "FAULT_TICK": "10000000"}
    spin.call(sweep, "--threads", "1", environment=environment)
    assert (spin.folder / "output/sweep.csv").read_bytes() == reference
