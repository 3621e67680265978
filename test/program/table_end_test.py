"""The last line of a table: the number of its rows, and the checksum of its data."""

import random
import re
import resource
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from conftest import MISSING, Spin, each, merge, needs_netcdf
from safe_files_test import STUDIES, files_of_study, run_study
from spintop_figures.tables.table import TableError, read_table

END = re.compile(rb"# end: (\d+) rows, CRC-32 ([0-9A-F]{8})\n")
RESUMED = ("sweep", "statistics", "both", "trajectory")
"""Studies with --resume whose tables are text."""
STATES = [(".part", ".state1", ".state2"), (".state1",), (".state2",)]
"""Files of the state that an interrupted run of statistics may leave."""


def parts_of(table: bytes) -> tuple[list[bytes], list[bytes]]:
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


def check_end(path: Path) -> None:
    """The last line is that of the rows, by the CRC-32 of zlib."""
    head, rest = parts_of(path.read_bytes())
    match = END.fullmatch(rest[-1])
    assert match, rest[-1]
    assert int(match[1]) == sum(not line.startswith(b"#") for line in rest)
    assert int(match[2], 16) == zlib.crc32(b"".join([head[-1], *rest[:-1]]))


@each("kind", *[kind for kind in STUDIES if not kind.endswith("netcdf")])
def test_every_table(spin, kind):
    """Each table that a study makes has it, and what reads tables finds it right."""
    tables = [path for path in files_of_study(spin, kind) if path.suffix == ".csv"]
    assert tables
    for path in tables:
        check_end(path)
        if path.stem != "benchmark":  # the columns of which are no figure's
            assert read_table(path).note == ""


def each_damage(spin: Spin, kind: str) -> Iterator[tuple[Path, str, bytes, int | None]]:
    """Each table of a study, damaged in each way; it is whole again afterwards."""
    for path in files_of_study(spin, kind):
        if path.suffix == ".csv":
            table = path.read_bytes()
            assert len(parts_of(table)[1]) > 2, path
            for how, text, row in damages(table):
                path.write_bytes(text)
                yield path, how, text, row
            path.write_bytes(table)


@each("kind", *RESUMED)
def test_resume(spin, kind):
    """A table that was cut or changed is not complete; --restart makes it again."""
    for path, how, text, row in each_damage(spin, kind):
        said = run_study(spin, kind, "--resume", code=2).stderr
        for part in (path.name, "--restart", f"row {row} " if row else ""):
            assert part in said, how
        assert path.read_bytes() == text
    run_study(spin, kind, "--restart")
    run_study(spin, kind, "--resume")


@each("kind", *RESUMED)
def test_leftovers(spin, kind):
    """What interrupted runs have left beside a complete table goes when it is resumed."""
    files = files_of_study(spin, kind)
    tables = [path for path in files if path.name.split(".", 1)[1] in ("csv", "events.csv")]
    for path in tables or [path for path in files if path.name.endswith("statistics.csv")]:
        left = [(".part",), (".new",)]
        if "events" not in path.name:
            left += [(".journal",), (".journal.new",), (".part", ".new")]
            left += STATES * (kind in ("statistics", "both"))
        for endings in left:
            for ending in endings:
                Path(f"{path}{ending}").write_text("# nothing\n")
            run_study(spin, kind, "--resume")
            assert sorted((spin.folder / "output").iterdir()) == files, endings


@each("kind", "sweep", "stability")
def test_merge(spin, kind):
    names = "all.csv", *spin.parts(STUDIES[kind], 2, name=kind)
    path = spin.folder / names[-1]
    table = path.read_bytes()
    for how, text, row in damages(table):
        path.write_bytes(text)
        said = merge(spin, *names, code=2)
        assert path.name in said, how
        assert not row or f"row {row} " in said, how
        assert not list(spin.folder.glob("all*"))
    path.write_bytes(table)
    merge(spin, *names)
    check_end(spin.folder / "all.csv")


@each("kind", "sweep_netcdf", "sweep_packed_netcdf", "trajectory_netcdf")
def test_netcdf(spin, kind):
    """The attribute of a NetCDF table; one that was changed is refused by all that read it."""
    path = run_study(spin, kind).path.with_suffix(".nc")
    run_study(spin, kind, "--resume")
    if "packed" in kind:  # which takes a library to be read
        return
    assert read_table(path).note == ""
    changed = bytearray(path.read_bytes())
    changed[-3] ^= 1
    path.write_bytes(changed)
    with pytest.raises(TableError, match="was changed after it was written"):
        read_table(path)
    assert "was changed after it was written" in run_study(spin, kind, "--resume", code=2).stderr


@needs_netcdf
def test_netcdf_parts(spin):
    names = "all.nc", *spin.parts(STUDIES["sweep_netcdf"], 2, ending="nc")
    merge(spin, *names)
    assert read_table(spin.folder / "all.nc").note == ""
    path = spin.folder / names[-1]
    path.write_bytes(path.read_bytes()[:-8] + bytes(8))
    assert "was changed after it was written" in merge(spin, *names, code=2)


@each("kind", "sweep", "trajectory")
def test_readers(spin, kind):
    """Python and the program refuse what was changed, and read what has no such line."""
    for path, how, text, _ in each_damage(spin, kind):
        if b"\n# end: " in text:
            with pytest.raises(TableError):
                pytest.fail(f"{how}: {read_table(path).note}")
    path = spin.folder / f"output/{kind}.csv"
    path.write_bytes(END.sub(b"", path.read_bytes()))
    assert "number and the checksum of its rows" in read_table(path).note
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_table(path).note


TOP = "&top mass = 1, inertia = 0.9, 0.9, 0.3, length = 0.5 /\n"
TOP += "&initial theta = 0.5, psi_rate = {} /\n"
KEYS = "data = 'output/motion.csv', unknown = 'initial.psi_rate'"


def test_lines_from_elsewhere(spin):
    """Tables with CR LF and a byte order mark are read as those with LF by all readers."""
    motion = f"{TOP.format(14)}&span t_end = 2, samples = 21 /\n"
    spin(motion, "output.columns=t,theta,psi", name="motion")
    parts = spin.parts(STUDIES["sweep"], 2)
    fit = spin.write(f"&study kind = 'fit' /\n{TOP.format(13.9)}&fit {KEYS} /\n", "sought.nml")
    mark, found = b"\xef\xbb\xbf", []
    for begin, end in ((b"", b"\n"), (b"", b"\r\n"), (mark, b"\r\n"), (mark, b"\n")):
        for path in (spin.folder / name for name in ("output/motion.csv", *parts)):
            lines = path.read_bytes().removeprefix(mark).splitlines()
            path.write_bytes(begin + end.join([*lines, b""]))
        verified = spin.call("verify", "output/motion.csv", code=(0, 2))
        assert verified.code == 0 or MISSING in verified.stderr
        merge(spin, "all.csv", *parts)
        spin.call("--quiet", "--restart", fit)
        rows = (spin.folder / "output/sought.csv").read_bytes().splitlines()
        found.append((spin.folder / "all.csv").read_bytes())
        found[-1] += b"".join(line for line in rows if line[:1] != b"#")
        (spin.folder / "all.csv").unlink()
    assert found[1:] == found[:1] * 3


def test_tables_of_cases(spin):
    """The table of the axes of a sweep is checked, with the place of the error."""
    table = run_study(spin, "sweep").path.read_bytes()
    cases = spin.folder / "cases.csv"
    axes = re.sub("&sweep[^/]*/", "&sweep table = 'cases.csv' /", STUDIES["sweep"])
    head, rest = parts_of(table)
    # Only columns that are parameters: such a table is made by hand, and has no such line.
    rows = [line.split(b",")[1] + b"\n" for line in (head[-1], *rest[:-1])]
    line = b"# end: %d rows, CRC-32 %08X\n" % (len(rows) - 1, zlib.crc32(b"".join(rows)))
    for ending in ([], [line]):
        cases.write_bytes(b"".join(rows + ending))
        spin(axes, "--check")
    cases.write_bytes(b"".join([*rows[:-1], line]))
    said = spin(axes, "--check", code=2).stderr
    assert "it has 19 rows, and its last line says 20" in said


MANY = """\
&study kind = 'sweep' /
&top mass = 0.1, length = 0.05, inertia = 1e-3, 1e-3, 5e-4 /
&initial theta_deg = 20 /
&span nutations = 1 /
&output columns = 'theta_min', 'theta_max', 'nutation_period', 'delta_u' /
&sweep parameter(1) = 'initial.spin_ratio', from(1) = 1.5, to(1) = 4, count(1) = {} /
"""


def spent(call, *words, **options):
    """The time of the processor that a call takes, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    call(*words, **options)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def test_time_goes_with_the_comments(spin):
    """A part with lines of comments behind its rows is refused in a time that goes with these."""
    names = spin.parts(MANY.format(20), 2)
    times = []
    for lines in (40_000, 160_000):
        with (spin.folder / names[0]).open("a") as part:
            part.write("#\n" * lines)
        times.append(spent(merge, spin, "all.csv", *names, code=2))
    assert times[1] < 8 * times[0] + 0.1


def test_time_goes_with_the_rows(spin):
    """Whoever finds what is wrong with a table takes four times as long for four times the rows."""
    axes = re.sub("&sweep.*", "&sweep table = 'output/scene.1-of-2.csv' /", MANY)
    times = []
    for cases in (60_000, 240_000):
        names = spin.parts(MANY.format(cases), 2, "--restart")
        for name in names:
            path = spin.folder / name
            whole = path.read_bytes()
            path.write_bytes(whole[:-100] if name == names[1] else whole.replace(b",1.5", b",2", 1))
        times.append(
            [
                spent(merge, spin, "all.csv", *reversed(names), code=2),
                spent(spin, axes, "--check", code=2),
                spent(spin, MANY.format(cases), "--shard=2/2", "--resume", code=2),
            ]
        )
    for few, many in zip(*times, strict=True):
        assert many < 8 * few + 0.1
