"""NetCDF tables: the numbers of the CSV, bit for bit, by the conventions of CF."""

import re
import signal
import struct

import pytest

from conftest import GOOD, each, files_of, merge, needs_netcdf, netcdf_is_missing, wait_until
from slow_sweep import SLOW, Sweep
from spintop_figures.registry import FIGURES
from spintop_figures.tables.table import TableError, read_netcdf, read_table

pytestmark = needs_netcdf

NETCDF = "output.format=netcdf"
# Cases of every kind: a top, one with a pole on its way, one that is none; and words and notes.
GRID = """\
&study kind = 'sweep', title = 'A grid' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial psi_rate = 3 /
&span t_end = 0.5 /
&integration formulation = 'lagrange', method = 'rk4', steps = 40 /
&output columns = 'all' /
&sweep parameter(1) = 'initial.theta_deg', values(1,:) = 0, 10, 20.5, 90
       parameter(2) = 'top.inertia(3)', values(2,:) = 0.25, 0.5, 1.8
       parameter(3) = 'top.gravity', from(3) = 0, to(3) = 9.81, count(3) = 7 /
"""
# More rows than are gathered before they are written, in boxes that the gathering cuts.
LONG = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 2 /
&output columns = 'delta_u', 'phi_end' /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 331
       parameter(2) = 'top.gravity', from(2) = 1, to(2) = 10, count(2) = 421 /
"""
DRAWN = """\
&sweep combine = 'latin_hypercube', cases = 9
    parameter(1) = 'initial.theta_deg', from(1) = 10, to(1) = 80
    parameter(2) = 'top.gravity', values(2,:) = 1, 5 /
"""
DRAWN = GRID.split("&sweep", maxsplit=1)[0] + DRAWN
PACKED = "output.compression=6"
needs_packed = pytest.mark.skipif(netcdf_is_missing(PACKED) != "", reason="no NetCDF-4")


def bits(values):
    return [b"nan" if value != value else struct.pack(">d", value) for value in map(float, values)]


def sweep(spin, given, *words, **options):
    return spin(given, NETCDF, *words, **options).path.with_suffix(".nc")


def check_cells(csv, path):
    """A NetCDF table has every cell of a CSV table, of which this is the run; it is read."""
    netcdf, texts = read_table(path), csv.texts
    assert list(netcdf.rows) == list(texts)
    assert len(netcdf.rows) == len(texts)
    for column in texts:
        if column in ("status", "motion_class"):
            assert list(netcdf.rows[column]) == list(texts[column]), column
        elif column != "notes":
            assert bits(netcdf.rows[column]) == bits(texts[column]), column
    return netcdf


@each("text, code", (GRID, 3), (LONG, 0), (DRAWN, 0))
def test_same_numbers_as_the_csv(spin, text, code):
    """In every cell, of good and bad cases; head and units are the same, too."""
    run = spin(text, code=code)
    netcdf, csv = check_cells(run, sweep(spin, text, code=code)), read_table(run.path)
    assert netcdf.settings == csv.settings | {"output.format": ["netcdf"]}
    assert netcdf.meanings == csv.meanings
    assert netcdf.units == csv.units
    assert netcdf.header["model"] == csv.header["model"]
    if text == GRID:
        assert set(run.texts.status) == {"ok", "pole", "bad_input"}
        assert run.texts.motion_class.nunique() > 1
        assert "nan" in set(run.texts.nutation_period)
    elif text == DRAWN:
        # Without a grid the dimension is the case, with the parameters of each.
        for name, variable in read_netcdf(run.path.with_suffix(".nc"))[1].items():
            assert variable.dims == ("case",), name
            assert "coordinates" not in variable.attrs
        scatter = next(kind for kind in FIGURES if kind.name == "scatter")
        assert scatter.refusal(netcdf) == scatter.refusal(csv) == ""


@each("packed", [], pytest.param([PACKED], marks=needs_packed))
def test_long_table(spin, packed):
    """Rows gathered and written in several goes; the same bytes for any number of threads."""
    tables = {sweep(spin, LONG, *packed, f"--threads={n}").read_bytes() for n in (1, 2, 5)}
    assert len(tables) == 1
    merge(spin, "output/merged.nc", *spin.parts(LONG, 2, NETCDF, *packed, ending="nc"))
    assert {(spin.folder / "output/merged.nc").read_bytes()} == tables
    assert not [name for name in spin.produced() if re.search(r"\.(part|journal)$", name)]


def test_conventions(spin):
    path = sweep(spin, GRID, code=3)
    attributes, variables = read_netcdf(path)
    assert attributes["Conventions"] == "CF-1.8"
    assert attributes["title"] == "A grid"
    assert attributes["program"].startswith("spintop ")
    assert "date" not in attributes
    axes = ("initial_theta_deg", "top_inertia_3", "top_gravity")
    for axis in axes:
        assert variables[axis].dims == (axis,)
    assert list(variables["top_inertia_3"].values) == [0.25, 0.5, 1.8]
    assert variables["initial_theta_deg"].attrs["units"] == "degree"
    assert variables["top_gravity"].attrs["column"] == "top.gravity"
    for name, variable in variables.items():
        assert re.fullmatch(r"[A-Za-z]\w*", name)
        assert variable.attrs["long_name"], name
        assert name in axes or variable.dims == axes
        assert variable.values.dtype.kind != "f" or variable.attrs["units"], name
    assert variables["case"].values.reshape(-1).tolist() == list(range(1, 85))
    meanings = variables["status"].attrs["flag_meanings"].split()
    assert variables["status"].attrs["flag_values"].size == len(meanings)
    # The resolved input runs, and gives the same table.
    again = sweep(spin, attributes["input"] + "\n", name="again", code=3)
    assert again.read_bytes() == path.read_bytes()


def test_notes(spin):
    """A bit for each thing noted, where the CSV has it and its reason."""
    texts = spin(GRID, code=3).texts.notes
    notes = read_netcdf(sweep(spin, GRID, code=3))[1]["notes"]
    words, masks = notes.attrs["flag_meanings"].split(), notes.attrs["flag_masks"].tolist()
    assert masks == [1 << i for i in range(len(words))]
    for flags, text in zip(notes.values.reshape(-1), texts, strict=True):
        told = {part.split(":")[0].replace(" ", "_") for part in text.split("; ")}
        noted = {word for mask, word in zip(masks, words, strict=True) if flags & mask}
        assert noted == told & set(words), text
    assert len(set(notes.values.reshape(-1).tolist())) > 1


def test_refusals(spin):
    stability = "&study kind = 'stability' /\n&stability cases = 'sleeping_above' /\n"
    said = spin.refuse(stability, NETCDF)
    assert "the table of a stability study cannot be NetCDF" in said
    assert "set output.format = 'csv'" in said
    few = "output.compression=4"
    for settings, reason in (
        ([few], "only a NetCDF table can be compressed"),
        (["output.rows=none", "statistics.columns=theta_min", NETCDF, few], "no rows to compress"),
        ([NETCDF, "output.compression=10"], "must be in [0, 9]"),
    ):
        assert reason in spin.refuse(GRID, *settings)


def test_places_that_cannot_be_written(spin):
    """The system stops the run in the midst of a write: no table; else exit code 4."""
    words = (spin.write(LONG), "--set", NETCDF)
    spin.call(*words, preexec_fn=files_of(200_000), code=(4, -signal.SIGXFSZ))
    assert "output/scene.nc" not in spin.produced()
    sweep(spin, GRID, "--output=/proc/spintop", code=4)
    (spin.folder / "output/grid.nc.part").mkdir(parents=True)
    assert "grid.nc.part" in spin(GRID, NETCDF, name="grid", code=4).stderr


GATHERED = LONG + "&statistics columns = 'delta_u', over = 'initial.psi_rate', bins = 5 /\n"
SMALL = GRID.replace("count(3) = 7", "count(3) = 1")
OF_GRID = {"ending": "nc", "code": (0, 3), "name": "grid"}


@each("text, count", (GRID, 3), (SMALL, 13), (GATHERED, 2))
def test_merged_parts_are_the_whole(spin, text, count):
    """Byte for byte, in any order of the parts, also if there are more of them than cases."""
    parts = spin.parts(text, count, NETCDF, **OF_GRID)
    merge(spin, "output/merged.nc", *parts[1::2], *parts[::2])
    whole = sweep(spin, text, name="grid", code=(0, 3))
    for ending in (".nc", ".statistics.nc")[: 2 if text == GATHERED else 1]:
        merged = whole.with_name(f"merged{ending}").read_bytes()
        assert merged == whole.with_suffix(ending).read_bytes()
    assert not [name for name in spin.produced() if re.search(r"\.(part|journal)$", name)]


def test_a_part_is_a_table_of_its_cases(spin):
    """One dimension, the case; the rows are those of the CSV part."""
    table = sweep(spin, GRID, "--shard=2/3", code=3).with_name("scene.2-of-3.nc")
    run = spin(GRID, "--shard=2/3", code=3)
    attributes, variables = read_netcdf(table)
    assert attributes["part"] == "part 2 of 3: cases 29 to 56 of 84"
    assert {each.dims for each in variables.values()} == {("case",)}
    assert variables["case"].values.tolist() == list(range(29, 57))
    texts = run.table("2-of-3")
    for name in ("top.gravity", "theta_min", "com_z_min"):
        assert bits(variables[name.replace(".", "_")].values) == bits(texts[name]), name


def test_foreign_parts_are_refused(spin):
    """A part of another sweep, of another format, one that is missing, or twice there."""
    parts = spin.parts(GRID, 2, NETCDF, **OF_GRID)
    another = GRID.replace("psi_rate = 3", "psi_rate = 4")
    others = spin.parts(another, 2, NETCDF, **OF_GRID | {"name": "other"})
    spin(GRID, "--shard=2/2", code=3, name="grid")
    sweep(spin, GRID, code=3, name="grid")
    for tables, reason in (
        ([parts[0], others[1]], "it is a part of another study than"),
        ([parts[0], "output/grid.2-of-2.csv"], "it is a part of another study than"),
        ([parts[0]], "missing of 2 parts: 2"),
        ([parts[0], parts[0]], "it is part 1, as is"),
        (["output/grid.nc"], "it is not a part of a study"),
    ):
        assert reason in merge(spin, "output/merged.nc", *tables, code=2)
        assert "output/merged.nc" not in spin.produced()


@pytest.fixture
def slow(spin):
    """A slow sweep to a NetCDF table; survival_test kills it, too."""
    return Sweep(spin, SLOW, "--set", NETCDF, table="output/slow.nc")


@pytest.mark.slow
@each("packed", [], pytest.param([PACKED], marks=needs_packed))
def test_killed_while_the_file_is_made(spin, packed):
    """The rows are there, and the next run makes the file of them, whatever is left of it."""
    whole = sweep(spin, LONG, *packed, "--output=whole").read_bytes()
    words = ["scene.nml", *(f"--set={setting}" for setting in (NETCDF, *packed))]
    new = spin.folder / "output/scene.nc.new"
    with spin.start(*words) as run:
        wait_until(lambda: run.poll() is not None or (new.exists() and new.stat().st_size > 0))
        run.kill()
        assert run.wait() == 0 or "output/scene.nc" not in spin.produced()
    assert sweep(spin, LONG, *packed, "--resume").read_bytes() == whole
    left = sorted(path.name for path in (spin.folder / "output").iterdir())
    assert left == ["scene.log", "scene.nc"]


@pytest.mark.slow
def test_strangers_and_damage_are_refused(spin, slow):
    """Nothing is discarded unasked, nothing continued that is not the same."""
    slow.interrupt()
    rows, part = slow.rows, spin.folder / "output/slow.nc.part"
    kept = part.read_bytes()
    said = slow(code=2)
    assert f"an interrupted run of output/slow.nc is there: {rows} rows are kept" in said
    said = slow("--resume", "--set", "top.mass=2", code=2)
    assert "was made by another program, build or input" in said
    assert part.read_bytes() == kept
    first = kept.index(struct.pack("=d", 1.0))  # the number of the first case
    damaged = bytearray(kept)
    damaged[first] ^= 1
    for content, reason in (
        (bytes(damaged), "was changed after it was written"),
        (kept[:first], "is shorter than its journal records"),
        (kept[:100], "was made by another program, build or input"),
        (b"", "was made by another program, build or input"),
    ):
        part.write_bytes(content)
        assert reason in slow("--resume", code=2)
    part.write_bytes(kept)
    slow("--resume")
    assert not part.exists()


@pytest.mark.slow
def test_a_signal_keeps_what_is_there(slow):
    code, said = slow.interrupt(by=signal.SIGTERM)
    assert code == -signal.SIGTERM
    assert f"interrupted: {slow.rows} of 1000 rows of output/slow.nc are kept" in said


@needs_packed
def test_same_cells(spin):
    """All numbers, words, attributes and coordinates of the classic file, in fewer bytes."""
    for text, code in ((GRID, 3), (LONG, 0)):
        run = spin(text, code=code)
        plain = sweep(spin, text, code=code).stat().st_size
        path = sweep(spin, text, PACKED, code=code)
        assert path.read_bytes()[:4] == b"\x89HDF"
        assert check_cells(run, path).settings["output.compression"] == ["6"]
    assert path.stat().st_size < 0.8 * plain


def test_units(spin):
    columns = "'theta_max_deg', 'precession_rate_deg', 'precession_rate_rev'"
    few = LONG.replace("'delta_u', 'phi_end'", f"{columns}, 'phi_end_deg__top.gravity'")
    few = few.replace("331", "3").replace("421", "2")
    csv, netcdf = read_table(spin(few).path), read_table(sweep(spin, few))
    assert netcdf.units == csv.units
    assert csv.units["precession_rate_deg"] == "deg/s"


def both(spin, text, *words, code=0):
    run = spin(text, *words, code=code)
    csv = read_table(run.path)
    for packed in ([], *([] if netcdf_is_missing(PACKED) else [[PACKED]])):
        table = check_cells(run, sweep(spin, text, *words, *packed, code=code))
        for part in ("status", "units", "meanings"):
            assert getattr(table, part) == getattr(csv, part)
    left = {path.name for path in run.path.parent.iterdir()}
    assert left <= {"scene.csv", "scene.nc", "scene.events.csv"}
    return csv


def test_same_numbers_of_a_motion(spin):
    """Time is the coordinate; without it the rows are the dimension."""
    both(spin, GOOD)
    attributes, variables = read_netcdf(sweep(spin, GOOD))
    assert attributes["status"] == "ok"
    assert "date" in attributes
    assert {each.dims for each in variables.values()} == {("t",)}
    assert "_FillValue" not in variables["t"].attrs
    _, variables = read_netcdf(sweep(spin, GOOD, "output.columns=theta,psi"))
    assert variables["theta"].dims == ("row",)


def test_motions_that_end_early(spin):
    """At an event, or with a failure: the rows up to there, and why."""
    text = GOOD.replace("'lagrange'", "'rigid_body'").replace("'rk4'", "'dop853'")
    text = text.replace("    steps = 10\n", "").replace("t_end = 0.5", "t_end = 50, samples = 3001")
    event = ["span.stop_at=upper_turning_points", "span.stop_after=2"]
    csv = both(spin, text, *event)
    assert (csv.status, len(csv.rows)) == ("ok", 3001)
    csv = both(spin, text, "integration.max_steps=50", code=3)
    assert csv.status.startswith("step_limit at t = ")
    assert len(csv.rows) < 3001
    # A method with a fixed step size writes the steps up to the event.
    steps = text.replace(", samples = 3001", "").replace("'dop853'", "'rk4', steps = 5000")
    csv = both(spin, steps, "span.stop_at=theta = 1.0")
    assert csv.status == "ok"
    assert len(csv.rows) < 5001


def test_a_killed_motion_leaves_no_table(spin):
    long = GOOD.replace("steps = 10", "steps = 20000000, max_steps = 2000000000")
    part = spin.folder / "output/scene.nc.part"
    with spin.start(spin.write(long), f"--set={NETCDF}") as run:
        wait_until(lambda: part.exists() and part.stat().st_size >= 100_000)
        assert run.poll() is None
    assert "output/scene.nc" not in spin.produced()
    part.rename(spin.folder / "cut.nc")
    with pytest.raises(TableError):
        read_table(spin.folder / "cut.nc")
    # The next run is not in the way of what is left.
    sweep(spin, GOOD)
