"""Power cuts, disks that fail and calls that are interrupted, at every moment of a run.

A small library stands between the program and the system. It records what the program does to
files, in order, and can have any of these calls fail. From a record follows what a disk may hold
after a power cut: all that was synchronised, and of the rest anything.
"""

import os
import random
import shutil
import subprocess
import unittest
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from conftest import GOOD, ROOT
from program_case import PROGRAM, ProgramCase

pytestmark = pytest.mark.slow

SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 0.1 /
&integration formulation = 'lagrange', method = 'rk4', steps = 4 /
&output columns = 'theta_end', 'phi_end' /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 320 /
"""

# RECORD names the record. FAIL_AT: the number of the call that fails. INTERRUPT: every other call
# is interrupted, and writes fall short. TICK: nanoseconds that pass at each look at the clock, so
# that entries of the journal are due as often as in a long run.
RECORDER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;
static char followed[1024];
static int record = -2;
static long calls, fail_at, tick;
static int interrupts, odd;

static void begin(void) {
    const char *name = getenv("RECORD");
    const char *number = getenv("FAIL_AT"), *step = getenv("TICK");
    if (record != -2) return;
    record = -1;
    if (name)
        record = (int)syscall(SYS_openat, AT_FDCWD, name, O_WRONLY | O_CREAT | O_APPEND, 0666);
    fail_at = number ? atol(number) : 0;
    tick = step ? atol(step) : 0;
    interrupts = getenv("INTERRUPT") != NULL;
}

static void note(const char *data, size_t length, const char *format, ...) {
    char line[9000];
    int n;
    va_list arguments;
    if (record < 0) return;
    va_start(arguments, format);
    n = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    syscall(SYS_write, record, line, (size_t)n);
    if (length > 0) syscall(SYS_write, record, data, length);
}

static void note_write(int file, const void *data, off_t place, ssize_t count) {
    note(data, (size_t)count, "write\t%d\t%lld\t%zd\n", file, (long long)place, count);
}

// Whether this call has to fail.
static int fails(int reason) {
    ++calls;
    if (interrupts && (odd = !odd)) { errno = EINTR; return 1; }
    if (calls != fail_at) return 0;
    errno = reason;
    return 1;
}

#define REAL(type, name, arguments) \
    static type (*real) arguments; \
    begin(); \
    if (!real) real = (type (*) arguments)dlsym(RTLD_NEXT, name)
#define ENTER pthread_mutex_lock(&turn)
#define LEAVE(result) \
    do { int kept = errno; pthread_mutex_unlock(&turn); errno = kept; return result; } while (0)

static int is_ours(const char *path) {
    static const char *const others[] = {"/proc", "/sys", "/dev", "/etc", "/usr", "/lib"};
    for (size_t i = 0; i < sizeof others / sizeof *others; ++i)
        if (strncmp(path, others[i], strlen(others[i])) == 0) return 0;
    return 1;
}

static int open_it(const char *name, const char *path, int flags, mode_t mode) {
    int file;
    REAL(int, name, (const char *, int, ...));
    if (!is_ours(path)) return real(path, flags, mode);
    ENTER;
    if ((flags & O_CREAT) && fails(ENOSPC)) LEAVE(-1);
    file = real(path, flags, mode);
    if (file >= 0 && file < (int)sizeof followed) {
        followed[file] = flags & O_APPEND ? 2 : 1;
        note(NULL, 0, "open\t%d\t%d\t%s\n", file, (flags & O_TRUNC) != 0, path);
    }
    LEAVE(file);
}

int open(const char *path, int flags, ...) {
    va_list arguments;
    mode_t mode = 0;
    va_start(arguments, flags);
    if (flags & O_CREAT) mode = va_arg(arguments, mode_t);
    va_end(arguments);
    return open_it("open", path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    va_list arguments;
    mode_t mode = 0;
    va_start(arguments, flags);
    if (flags & O_CREAT) mode = va_arg(arguments, mode_t);
    va_end(arguments);
    return open_it("open", path, flags, mode);
}

int close(int file) {
    int result;
    REAL(int, "close", (int));
    ENTER;
    if (file >= 0 && file < (int)sizeof followed) followed[file] = 0;
    result = real(file);
    LEAVE(result);
}

static int is_followed(int file) {
    return file > 2 && file < (int)sizeof followed && followed[file];
}

ssize_t write(int file, const void *data, size_t count) {
    ssize_t written;
    struct stat info;
    off_t place;
    REAL(ssize_t, "write", (int, const void *, size_t));
    if (!is_followed(file)) return real(file, data, count);
    ENTER;
    if (fails(ENOSPC)) LEAVE(-1);
    place = lseek(file, 0, SEEK_CUR);
    if (followed[file] == 2 && fstat(file, &info) == 0) place = info.st_size;
    written = real(file, data, interrupts && count > 1 ? count / 2 : count);
    if (written > 0) note_write(file, data, place, written);
    LEAVE(written);
}

static ssize_t pwrite_it(int file, const void *data, size_t count, off_t place) {
    ssize_t written;
    REAL(ssize_t, "pwrite", (int, const void *, size_t, off_t));
    ENTER;
    if (fails(ENOSPC)) LEAVE(-1);
    written = real(file, data, count, place);
    if (written > 0) note_write(file, data, place, written);
    LEAVE(written);
}
ssize_t pwrite(int file, const void *data, size_t count, off_t place) {
    return pwrite_it(file, data, count, place);
}
ssize_t pwrite64(int file, const void *data, size_t count, off_t place) {
    return pwrite_it(file, data, count, place);
}

// Nothing is synchronised: this disk loses its power on paper only.
static int sync_it(int file) {
    begin();
    ENTER;
    if (fails(EIO)) LEAVE(-1);
    note(NULL, 0, "sync\t%d\n", file);
    LEAVE(0);
}
int fsync(int file) { return sync_it(file); }
int fdatasync(int file) { return sync_it(file); }

static int truncate_it(int file, off_t size) {
    int result;
    REAL(int, "ftruncate", (int, off_t));
    ENTER;
    if (fails(ENOSPC)) LEAVE(-1);
    result = real(file, size);
    if (result == 0) note(NULL, 0, "truncate\t%d\t%lld\n", file, (long long)size);
    LEAVE(result);
}
int ftruncate(int file, off_t size) { return truncate_it(file, size); }
int ftruncate64(int file, off_t size) { return truncate_it(file, size); }

int rename(const char *from, const char *to) {
    int result;
    REAL(int, "rename", (const char *, const char *));
    ENTER;
    if (!interrupts && fails(ENOSPC)) LEAVE(-1);
    result = real(from, to);
    if (result == 0) note(NULL, 0, "rename\t%s\t%s\n", from, to);
    LEAVE(result);
}

int unlink(const char *path) {
    int result;
    REAL(int, "unlink", (const char *));
    ENTER;
    result = real(path);
    if (result == 0) note(NULL, 0, "unlink\t%s\n", path);
    LEAVE(result);
}

int mkdir(const char *path, mode_t mode) {
    int result;
    REAL(int, "mkdir", (const char *, mode_t));
    ENTER;
    if (!interrupts && fails(ENOSPC)) LEAVE(-1);
    result = real(path, mode);
    if (result == 0) note(NULL, 0, "mkdir\t%s\n", path);
    LEAVE(result);
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    static long long looks;
    REAL(int, "clock_gettime", (clockid_t, struct timespec *));
    if (clock != CLOCK_MONOTONIC && clock != CLOCK_THREAD_CPUTIME_ID) return real(clock, now);
    if (tick == 0) return real(clock, now);
    ENTER;
    looks += tick;
    now->tv_sec = 1000 + looks / 1000000000;
    now->tv_nsec = looks % 1000000000;
    LEAVE(0);
}
"""


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
        """The present contents are safe."""
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
        """A change of names: ("put", name, node) or ("drop", name)."""
        self.recent.setdefault(os.path.dirname(change[1]) or ".", []).append(change)
        apply(self.names, change)

    def do(self, record: tuple) -> None:
        """The calls of the program."""
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
                self.change(
                    "move", self.name_of(new), self.names[self.name_of(old)], self.name_of(old)
                )
            case ("unlink", path):
                self.change("drop", self.name_of(path))
            case ("mkdir", path):
                self.change("put", self.name_of(path), None)

    def sync(self, what: Node | str) -> None:
        """A file or a folder is safe."""
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
    """Carry out a change of names."""
    if change[0] == "drop":
        names.pop(change[1], None)
        return
    names[change[1]] = change[2]
    if change[0] == "move" and names.get(change[3]) is change[2]:
        del names[change[3]]


def read_record(path: Path) -> Iterator[tuple]:
    """The contents of a record, call by call."""
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


class DiskCase(ProgramCase):
    """Runs whose calls to the system are recorded."""

    recorder: Path | None = None

    @classmethod
    def setUpClass(cls) -> None:
        """Compile the recorder."""
        compiler = shutil.which("gcc") or shutil.which("cc")
        if compiler is None:
            raise unittest.SkipTest("no C compiler is found")
        folder = ROOT / "build/scratch/recorder"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "recorder.c").write_text(RECORDER, encoding="utf-8")
        DiskCase.recorder = folder / "recorder.so"
        subprocess.run(
            [
                compiler,
                "-O1",
                "-shared",
                "-fPIC",
                "-o",
                cls.recorder,
                folder / "recorder.c",
                "-ldl",
            ],
            check=True,
        )

    def setUp(self) -> None:
        """A sweep, and the bytes of its table."""
        super().setUp()
        self.sweep = self.write(SWEEP, "sweep.nml")
        self.folder.joinpath("run").mkdir()
        result = self.run_program(self.sweep, "-o", "reference")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.reference = (self.folder / "reference/sweep.csv").read_bytes()

    def run_in(
        self, folder: Path, *arguments: str | Path, **environment: str
    ) -> subprocess.CompletedProcess:
        """Run the program in a folder on one thread, under the recorder if there are settings."""
        if environment:
            environment["LD_PRELOAD"] = str(self.recorder)
        return subprocess.run(
            [PROGRAM, "--threads", "1", *map(str, arguments)],
            cwd=folder,
            env=os.environ | environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )

    def record(self, folder: Path, *arguments: str | Path) -> list[tuple]:
        """Run the program and return what it did to files."""
        path = self.folder / "record"
        path.unlink(missing_ok=True)
        result = self.run_in(folder, *arguments, RECORD=str(path), TICK="10000000")
        self.assertEqual(result.returncode, 0, result.stderr)
        return list(read_record(path))

    def check_order(self, disk: Disk, records: list[tuple]) -> int:
        """Data safe from a power failure, by call; returns the number of journal entries."""
        entries = 0
        for record in records:
            starts_entry = record[0] == "open" and record[3].endswith(".journal.new")
            if starts_entry or (record[0] == "rename" and record[1].endswith(".part")):
                moved = [change for change in disk.recent.get("output", []) if change[0] == "move"]
                self.assertEqual(moved, [], "the last entry is not safe")
            if record[0] == "rename":
                old, new = map(disk.name_of, record[1:])
                node = disk.names[old]
                self.assertEqual(node.recent, [], f"{old} takes its name before it is safe")
                if new.endswith(".journal"):
                    entries += 1
                    part = new.removesuffix(".journal") + ".part"
                    length = int(node.safe.split()[4])
                    self.assertGreaterEqual(len(disk.names[part].safe), length, "rows are not safe")
            if record[0] == "unlink" and disk.name_of(record[1]).endswith(".journal"):
                table = disk.name_of(record[1]).removesuffix(".journal")
                if table + ".part" not in disk.names:
                    self.assertIn(table, disk.safe_names, "the table has not yet its name")
            disk.do(record)
            if record[0] == "sync" and disk.open[record[1]] == "output":
                names = disk.safe_names
                for name in names:
                    if name.endswith(".journal") and name.removesuffix(".journal") not in names:
                        self.assertIn(name.removesuffix(".journal") + ".part", names)
        self.assertEqual(disk.safe_names, disk.names, "names are not safe at the end")
        for name, node in disk.names.items():
            self.assertEqual(node.recent if node else [], [], f"{name} is not safe at the end")
        return entries


class OrderTest(DiskCase):
    """The order in which data become safe."""

    def test_rows_then_entry_then_name(self) -> None:
        """Rows are on the disk before their journal entry, and a file before its final name."""
        run = self.folder / "run"
        disk = Disk(run)
        self.assertGreaterEqual(self.check_order(disk, self.record(run, self.sweep)), 4)
        self.assertEqual((run / "output/sweep.csv").read_bytes(), self.reference)
        self.assertEqual(sorted(disk.names), ["output", "output/sweep.csv", "output/sweep.log"])
        self.assertEqual(disk.names["output/sweep.csv"].safe, self.reference)

    def test_every_table_is_safe_before_its_name(self) -> None:
        """Trajectories, their events, parts, merged tables, other studies, NetCDF."""
        run = self.folder / "run"
        scene = self.write(GOOD.replace("columns =", "events = 'turning_points', columns ="))
        stability = self.write(
            "&study kind = 'stability' /\n&stability cases = 'sleeping_above', methods = 'rk4' /\n",
            "stability.nml",
        )
        runs = [
            [scene],
            [stability],
            [self.sweep, "--shard", "1/2"],
            [self.sweep, "--shard", "2/2"],
        ]
        parts = ["output/sweep.1-of-2.csv", "output/sweep.2-of-2.csv"]
        runs.append(["merge", "output/sweep.csv", *parts])
        if self.run_program(self.sweep, "--check", "--set", "output.format=netcdf").returncode == 0:
            runs.append([self.sweep, "--set", "output.format=netcdf"])
        for arguments in runs:
            with self.subTest(str(arguments)):
                disk = Disk(run)
                before = set(disk.names)
                if arguments[0] == "merge":
                    records = self.record_merge(run, *arguments)
                else:
                    records = self.record(run, *arguments)
                self.check_order(disk, records)
                self.assertNotEqual(set(disk.names), before)
                self.assertFalse([name for name in disk.names if name.endswith((".part", ".new"))])
                for name, node in disk.names.items():
                    if node:
                        self.assertEqual(node.safe, (run / name).read_bytes())
        self.assertEqual((run / "output/sweep.csv").read_bytes(), self.reference)

    def record_merge(self, folder: Path, *arguments: str) -> list[tuple]:
        """The file operations of a merge."""
        path = self.folder / "record"
        path.unlink(missing_ok=True)
        environment = {"LD_PRELOAD": str(self.recorder), "RECORD": str(path)}
        subprocess.run(
            [PROGRAM, *arguments],
            cwd=folder,
            env=os.environ | environment,
            check=True,
            capture_output=True,
        )
        return list(read_record(path))

    def test_no_fsync_can_be_left_out(self) -> None:
        """The check itself: without any one of them it fails."""
        run = self.folder / "run"
        empty = Disk(run)
        records = self.record(run, self.sweep)
        places = [i for i, record in enumerate(records) if record[0] == "sync"]
        self.assertGreaterEqual(len(places), 12)
        unnoticed = []
        for place in places:
            disk = Disk(run)
            disk.names, disk.safe_names = dict(empty.names), dict(empty.safe_names)
            try:
                self.check_order(disk, records[:place] + records[place + 1 :])
            except AssertionError:
                continue
            unnoticed.append(place)
        # Only where there was nothing to make safe, but that a journal is gone.
        for place in unnoticed:
            disk = Disk(run)
            disk.names, disk.safe_names = dict(empty.names), dict(empty.safe_names)
            for record in records[:place]:
                disk.do(record)
            what = disk.open[records[place][1]]
            if isinstance(what, Node):
                self.assertEqual(what.recent, [], f"call {place}")
            else:
                kinds = {change[0] for change in disk.recent.get(what, [])}
                self.assertLessEqual(kinds, {"drop"}, f"call {place}")


class PowerCutTest(DiskCase):
    """The state after a power failure, and the resumed sweep."""

    def lay_out(self, files: dict[str, bytes | None]) -> Path:
        """A folder with what was left."""
        folder = self.folder / "after"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name, content in files.items():
            if content is None:
                (folder / name).mkdir()
            else:
                (folder / name).write_bytes(content)
        return folder

    def check_resumed(self, files: dict[str, bytes | None], safe_rows: int) -> None:
        """The remaining part has the safe rows, and is resumed to the uninterrupted table."""
        table = files.get("output/sweep.csv")
        if table is not None:
            self.assertEqual(table, self.reference, "half a table bears its name")
        journal = files.get("output/sweep.csv.journal")
        rows = 0
        if journal is not None:
            words = journal.decode().split()
            rows = sum(map(int, words[words.index("rows:") + 1 : words.index("end:")]))
        if table is None:
            self.assertGreaterEqual(rows, safe_rows, "the journal has lost rows")
        folder = self.lay_out(files)
        result = self.run_in(folder, self.sweep, "--resume")
        self.assertEqual(result.returncode, 0, result.stderr)
        if rows > 0 and "output/sweep.csv.part" in files:
            self.assertIn(f"resumes after {rows} rows", result.stdout)
        self.assertEqual((folder / "output/sweep.csv").read_bytes(), self.reference)
        left = sorted(path.name for path in (folder / "output").iterdir())
        self.assertEqual([name for name in left if name.endswith(".journal")], [])

    def cut_everywhere(self, disk: Disk, records: list[tuple], draws: int, seed: int) -> list[dict]:
        """Cut the power after each call, and look at what may be left; returns some of it."""
        draw = random.Random(seed)
        seen: set = set()
        left = []
        for record in records:
            disk.do(record)
            safe = disk.safe_names.get("output/sweep.csv.journal")
            safe_rows = 0
            if safe is not None:
                words = safe.safe.decode().split()
                safe_rows = sum(map(int, words[words.index("rows:") + 1 : words.index("end:")]))
            for _ in range(draws):
                files = disk.after_power_cut(draw)
                key = tuple(sorted(files.items(), key=lambda item: item[0]))
                if key in seen:
                    continue
                seen.add(key)
                left.append(files)
                with self.subTest(record=record[0], states=len(seen)):
                    self.check_resumed(files, safe_rows)
        return left

    def test_cut_at_every_call(self) -> None:
        """No row that the journal has is lost, and no half table has a name; cut once and again."""
        run = self.folder / "run"
        disk = Disk(run)
        left = self.cut_everywhere(disk, self.record(run, self.sweep), draws=1, seed=2012)
        self.assertGreater(len(left), 20)
        some = [f for f in left if "output/sweep.csv.journal" in f and "output/sweep.csv.part" in f]
        for files in some[len(some) // 2 :: len(some)]:
            folder = self.lay_out(files)
            disk = Disk(folder)
            self.cut_everywhere(disk, self.record(folder, self.sweep, "--resume"), draws=1, seed=41)


class FailingDiskTest(DiskCase):
    """A disk that is full, or fails, at the n-th call."""

    def count(self, *arguments: str | Path) -> int:
        """Calls of a run that may fail."""
        calls = ("write", "sync", "truncate", "rename", "mkdir", "open")
        records = self.record(self.folder / "run", *arguments)
        shutil.rmtree(self.folder / "run/output")
        return sum(record[0] in calls for record in records)

    def test_a_sweep_at_every_call(self) -> None:
        """Exit code 4, no half table, and --resume completes it."""
        run = self.folder / "run"
        failed = 0
        self.sweep.write_text(SWEEP.replace("count(1) = 320", "count(1) = 48"), encoding="utf-8")
        self.assertEqual(self.run_program(self.sweep, "-o", "reference").returncode, 0)
        self.reference = (self.folder / "reference/sweep.csv").read_bytes()
        most = self.count(self.sweep)
        for n in range(1, most + 1):
            with self.subTest(call=n):
                result = self.run_in(run, self.sweep, FAIL_AT=str(n), TICK="10000000")
                table = run / "output/sweep.csv"
                if table.exists():
                    self.assertEqual(table.read_bytes(), self.reference)
                if result.returncode != 0:
                    failed += 1
                    self.assertEqual(result.returncode, 4, result.stderr)
                    self.assertRegex(result.stderr, "No space left on device|Input/output error")
                    resumed = self.run_in(run, self.sweep, "--resume")
                    self.assertEqual(resumed.returncode, 0, resumed.stderr)
                self.assertEqual(table.read_bytes(), self.reference)
            shutil.rmtree(run / "output", ignore_errors=True)
        self.assertGreater(failed, most // 2)

    def test_a_trajectory_at_every_call(self) -> None:
        """Exit code 4, and neither half a table nor a part."""
        run = self.folder / "run"
        scene = self.write()
        for n in range(1, self.count(scene) + 1):
            with self.subTest(call=n):
                result = self.run_in(run, scene, FAIL_AT=str(n))
                left = sorted(path.name for path in run.rglob("*.csv*"))
                self.assertIn(result.returncode, (0, 4), result.stderr)
                # The last call makes sure of the name.
                self.assertIn(left, ([], ["scene.csv"]))
                if left:
                    *_, status, end = (run / "output/scene.csv").read_text().splitlines()
                    self.assertEqual(status, "# status: ok")
                    self.assertRegex(end, "^# end: ")
            shutil.rmtree(run / "output", ignore_errors=True)

    def test_interrupted_calls_and_short_writes(self) -> None:
        """They are no errors."""
        run = self.folder / "run"
        result = self.run_in(run, self.sweep, INTERRUPT="1", TICK="10000000")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((run / "output/sweep.csv").read_bytes(), self.reference)
