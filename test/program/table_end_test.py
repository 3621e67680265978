"""The last line of a table: the number of its rows, and the checksum of its data."""

import random
import re
import shutil
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS.parent / "python")]

from conftest import MISSING  # noqa: E402
from safe_files_test import STUDIES, StudyCase  # noqa: E402
from spintop_figures.tables.table import TableError, read_table  # noqa: E402

END = re.compile(rb"# end: (\d+) rows, CRC-32 ([0-9A-F]{8})\n")
RESUMED = ("sweep", "statistics", "both", "trajectory")
"""Studies with --resume whose tables are text."""


STATES = {
    "sweep": [],
    "statistics": [(".part", ".state1", ".state2"), (".state1",)],
    "both": [(".part", ".state1", ".state2"), (".state2",)],
    "trajectory": [],
}
"""Files of the state that an interrupted run of each may leave."""


def parts_of(table: bytes) -> tuple[list[bytes], list[bytes]]:
    """The lines to that of the names, and those after it."""
    lines = table.splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if not line.startswith(b"#"))
    return lines[: first + 1], lines[first + 1 :]


def damages(table: bytes) -> Iterator[tuple[str, bytes, int | None]]:
    """Ways in which a table is cut or changed, and the first wrong row where it can be known."""
    head, rest = parts_of(table)
    rows = [line for line in rest if not line.startswith(b"#")]
    last = rest[len(rows) :]
    middle = len(rows) // 2
    whole = b"".join(head)
    generator = random.Random(len(table))

    def joined(rows: list[bytes], ending: list[bytes] = last) -> bytes:
        return whole + b"".join(rows) + b"".join(ending)

    yield "without the last line", joined(rows, last[:-1]), None
    yield "without rows", joined([]), None
    yield "cut in a row", table[: len(whole) + sum(map(len, rows[:middle])) + 3], middle + 1
    yield "cut behind a row", joined(rows[:middle], []), None
    yield "the last row is missing", joined(rows[:-1]), None
    yield "a cell more", joined([*rows[:-1], b"1," + rows[-1]]), len(rows)
    yield "a row after the end", table + rows[-1], None
    yield "another number", table.replace(b"# end: ", b"# end: 1"), None
    if rows[0].split(b",")[0] in (b"1", b"0") and len(rows) > 2:
        swapped = [*rows[:middle], rows[middle + 1], rows[middle], *rows[middle + 2 :]]
        yield "exchanged rows", joined(swapped), middle + (2 if head[-1][:2] == b"t," else 1)
        yield "a row is missing", joined(rows[: middle - 1] + rows[middle:]), None
    for _ in range(8):
        row = generator.randrange(len(rows))
        place = generator.randrange(len(rows[row]) - 1)
        changed = bytearray(rows[row])
        changed[place] ^= 1 << generator.randrange(7)
        yield "a bit", joined([*rows[:row], bytes(changed), *rows[row + 1 :]]), None
    digit = re.search(rb"(?<=\.\d)\d", rows[middle])
    if digit:
        place = digit.start()
        other = b"%d" % ((rows[middle][place] - 47) % 10)
        changed = rows[middle][:place] + other + rows[middle][place + 1 :]
        yield "a digit", joined([*rows[:middle], changed, *rows[middle + 1 :]]), None


class TableEndTest(StudyCase):
    """Tables of all studies."""

    def check_end(self, path: Path) -> None:
        """The last line is that of the rows, by the CRC-32 of zlib."""
        table = path.read_bytes()
        head, rest = parts_of(table)
        match = END.fullmatch(rest[-1])
        self.assertIsNotNone(match, rest[-1])
        self.assertEqual(int(match[1]), sum(not line.startswith(b"#") for line in rest))
        self.assertEqual(int(match[2], 16), zlib.crc32(b"".join([head[-1], *rest[:-1]])))

    def test_every_table(self) -> None:
        """Each table that a study makes has it, and what reads tables finds it right."""
        found = 0
        for _, files in self.studies():
            for path in files:
                if path.suffix == ".csv":
                    with self.subTest(path.name):
                        self.check_end(path)
                        if path.stem != "benchmark":  # the columns of which are no figure's
                            self.assertEqual(read_table(path).note, "")
                        found += 1
        self.assertGreater(found, 11)

    def each_damage(self, kind: str) -> Iterator[tuple[Path, str, bytes, int | None]]:
        """Each table of a study, damaged in each way; it is whole again afterwards."""
        self.run_study(kind)
        for path in sorted((self.folder / "output").glob("*.csv")):
            table = path.read_bytes()
            self.assertGreater(len(parts_of(table)[1]), 2, path)
            for how, text, row in damages(table):
                path.write_bytes(text)
                with self.subTest(path.name, how=how):
                    yield path, how, text, row
            path.write_bytes(table)

    def test_resume(self) -> None:
        """A table that was cut or changed is not complete; --restart makes it again."""
        for kind in RESUMED:
            for path, _, text, row in self.each_damage(kind):
                said = self.run_study(kind, "--resume", code=2).stderr
                self.assertIn(path.name, said)
                self.assertIn("--restart", said)
                if row:
                    self.assertIn(f"row {row} ", said)
                self.assertEqual(path.read_bytes(), text)
            self.run_study(kind, "--restart")
            self.run_study(kind, "--resume")
            shutil.rmtree(self.folder / "output")

    def test_leftovers(self) -> None:
        """What interrupted runs have left beside a complete table goes when it is resumed."""
        for kind in RESUMED:
            self.run_study(kind)
            files = sorted((self.folder / "output").iterdir())
            tables = [path for path in files if path.name.split(".", 1)[1] in ("csv", "events.csv")]
            for path in tables or [path for path in files if path.name.endswith("statistics.csv")]:
                left = [(".part",), (".new",)]
                if "events" not in path.name:
                    left += [(".journal",), (".journal.new",), (".part", ".new")]
                    left += STATES[kind]
                for endings in left:
                    for ending in endings:
                        Path(f"{path}{ending}").write_text("# nothing\n")
                    with self.subTest(path.name, endings=endings):
                        self.run_study(kind, "--resume")
                        self.assertEqual(sorted((self.folder / "output").iterdir()), files)
            shutil.rmtree(self.folder / "output")

    def test_merge(self) -> None:
        """A part that was cut or changed is refused by its name."""
        for kind in ("sweep", "stability"):
            for part in ("1/2", "2/2"):
                self.run_study(kind, "--shard", part)
            names = [f"output/{kind}.{i}-of-2.csv" for i in (1, 2)]
            path = self.folder / names[1]
            table = path.read_bytes()
            for how, text, row in damages(table):
                path.write_bytes(text)
                with self.subTest(kind, how=how):
                    result = self.run_program("merge", "all.csv", *names)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn(path.name, result.stderr)
                    self.assertEqual(list(self.folder.glob("all*")), [])
                    if row:
                        self.assertIn(f"row {row} ", result.stderr)
            path.write_bytes(table)
            self.assertEqual(self.run_program("merge", "all.csv", *names).returncode, 0)
            self.check_end(self.folder / "all.csv")
            (self.folder / "all.csv").unlink()

    def test_netcdf(self) -> None:
        """The attribute of a NetCDF table; one that was changed is refused by all that read it."""
        for kind in ("sweep_netcdf", "sweep_packed", "trajectory_netcdf"):
            if self.run_study(kind, code=None).returncode:
                self.skipTest("no NetCDF")
            path = self.folder / f"output/{kind}.nc"
            self.run_study(kind, "--resume")
            if kind == "sweep_packed":  # which takes a library to be read
                continue
            self.assertEqual(read_table(path).note, "")
            changed = bytearray(path.read_bytes())
            changed[-3] ^= 1
            path.write_bytes(changed)
            with self.assertRaisesRegex(TableError, "was changed after it was written"):
                read_table(path)
            said = self.run_study(kind, "--resume", code=2).stderr
            self.assertIn("was changed after it was written", said)
        for part in ("1/2", "2/2"):
            self.run_study("sweep_netcdf", "--shard", part)
        names = [f"output/sweep_netcdf.{i}-of-2.nc" for i in (1, 2)]
        self.assertEqual(self.run_program("merge", "all.nc", *names).returncode, 0)
        self.assertEqual(read_table(self.folder / "all.nc").note, "")
        path = self.folder / names[1]
        path.write_bytes(path.read_bytes()[:-8] + bytes(8))
        result = self.run_program("merge", "all.nc", *names)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("was changed after it was written", result.stderr)

    def test_readers(self) -> None:
        """Python and the program refuse what was changed, and read what has no such line."""
        for kind in ("sweep", "trajectory"):
            for path, how, text, _ in self.each_damage(kind):
                if b"\n# end: " not in text:
                    continue
                with self.subTest(how), self.assertRaises(TableError):
                    read_table(path)
            path = self.folder / f"output/{kind}.csv"
            path.write_bytes(END.sub(b"", path.read_bytes()))
            self.assertIn("number and the checksum of its rows", read_table(path).note)
            path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
            self.assertTrue(read_table(path).note)
            shutil.rmtree(self.folder / "output")

    def test_lines_from_elsewhere(self) -> None:
        """Tables with CR LF and a byte order mark are read as those with LF by all readers."""
        top = "&top mass = 1, inertia = 0.9, 0.9, 0.3, length = 0.5 /\n"
        top += "&initial theta = 0.5, psi_rate"
        motion = self.write(f"{top} = 14 /\n&span t_end = 2, samples = 21 /\n", "motion.nml")
        keys = "data = 'output/motion.csv', unknown = 'initial.psi_rate'"
        fit = f"&study kind = 'fit' /\n{top} = 13.9 /\n&fit {keys} /\n"
        parts = [f"output/sweep.{i}-of-2.csv" for i in (1, 2)]
        self.run_program(motion, "--set", "output.columns=t,theta,psi")
        for part in ("1/2", "2/2"):
            self.run_study("sweep", "--shard", part)
        calls = (
            ("verify", "output/motion.csv"),
            ("merge", "all.csv", *parts),
            ("--quiet", "--restart", self.write(fit, "sought.nml")),
        )
        mark, found = b"\xef\xbb\xbf", []
        for begin, end in ((b"", b"\n"), (b"", b"\r\n"), (mark, b"\r\n"), (mark, b"\n")):
            for path in (self.folder / name for name in ("output/motion.csv", *parts)):
                lines = path.read_bytes().removeprefix(mark).splitlines()
                path.write_bytes(begin + end.join([*lines, b""]))
            for call in calls:
                result = self.run_program(*call)
                if MISSING not in result.stderr:
                    self.assertEqual(result.returncode, 0, result.stderr)
            rows = (self.folder / "output/sought.csv").read_bytes().splitlines()
            found.append((self.folder / "all.csv").read_bytes())
            found[-1] += b"".join(line for line in rows if line[:1] != b"#")
            (self.folder / "all.csv").unlink()
        self.assertEqual(found[1:], found[:1] * 3)

    def test_tables_of_cases(self) -> None:
        """The table of the axes of a sweep is checked, with the place of the error."""
        self.run_study("sweep")
        table = (self.folder / "output/sweep.csv").read_bytes()
        cases = self.folder / "cases.csv"
        axes = re.sub(rb"&sweep[^/]*/", b"&sweep table = 'cases.csv' /", STUDIES["sweep"].encode())
        scene = self.write(axes.decode(), "again.nml")
        head, rest = parts_of(table)
        # Only columns that are parameters: such a table is made by hand, and has no such line.
        rows = [line.split(b",")[1] + b"\n" for line in (head[-1], *rest[:-1])]
        cases.write_bytes(b"".join(rows))
        self.assertEqual(self.run_program("--check", scene).returncode, 0)
        line = b"# end: %d rows, CRC-32 %08X\n" % (len(rows) - 1, zlib.crc32(b"".join(rows)))
        cases.write_bytes(b"".join(rows) + line)
        self.assertEqual(self.run_program("--check", scene).returncode, 0)
        cases.write_bytes(b"".join(rows[:-1]) + line)
        result = self.run_program("--check", scene)
        self.assertEqual(result.returncode, 2)
        self.assertIn("it has 19 rows, and its last line says 20", result.stderr)
