"""NetCDF tables: the numbers of the CSV, bit for bit, by the conventions of CF."""

import os
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]

from conftest import GOOD  # noqa: E402
from mpi_test import ENVIRONMENT  # noqa: E402
from program_case import PROGRAM, ProgramCase, Table  # noqa: E402
from spintop_figures.sweeps.scatter import object_to_scatter  # noqa: E402
from spintop_figures.tables.netcdf import read_netcdf  # noqa: E402
from spintop_figures.tables.table import TableError, read_table  # noqa: E402
from survival_test import SurvivalCase, is_larger  # noqa: E402

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


def bits(value: float) -> bytes:
    """The bytes of a number; every NaN has the same."""
    return b"nan" if value != value else struct.pack(">d", value)


class NetcdfCase(ProgramCase):
    """Sweeps in both formats."""

    def setUp(self) -> None:
        """A scene, and a program that can write it."""
        super().setUp()
        self.grid = self.write(GRID, "grid.nml")
        said = self.run_program("--check", self.grid, "--set", NETCDF).stderr
        if "this build has no NetCDF" in said:
            self.skipTest("this build has no NetCDF")

    def sweep(self, scene: Path, *arguments: str | Path, code: int = 0, **options: object) -> str:
        """Run a sweep to a NetCDF table; returns all that it said."""
        result = self.run_program(scene, "--set", NETCDF, *arguments, **options)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def netcdf(self, name: str) -> tuple[dict, Mapping]:
        """Read a NetCDF table."""
        return read_netcdf(self.folder / "output" / name)

    def check_same(self, name: str) -> Table:
        """The NetCDF table has every cell of the CSV table, and the input; returns the latter."""
        text = self.table(name)
        csv, netcdf = (read_table(self.folder / f"output/{name}{end}") for end in (".csv", ".nc"))
        settings = csv.settings | {"output.format": ["netcdf"]}
        self.assertEqual(netcdf.settings, settings)
        self.assertEqual(netcdf.meanings, csv.meanings)
        self.assertEqual(netcdf.units, csv.units)
        self.assertEqual(netcdf.header["model"], csv.header["model"])
        rows = netcdf.rows
        self.assertEqual(list(rows), text.names)
        self.assertEqual(len(rows), len(text.rows))
        for column in text.names:
            cells = text.texts(column)
            if column in ("status", "motion_class"):
                self.assertEqual(list(rows[column]), cells, column)
            elif column != "notes":
                self.assertEqual(
                    [bits(float(value)) for value in rows[column]],
                    [bits(float(cell)) for cell in cells],
                    column,
                )
        return text


class NetcdfTest(NetcdfCase):
    """The contents of a table."""

    def test_same_numbers_as_the_csv(self) -> None:
        """In every cell of a grid with good and bad cases."""
        self.assertEqual(self.run_program(self.grid).returncode, 3)
        self.sweep(self.grid, code=3)
        text = self.check_same("grid")
        self.assertEqual(set(text.texts("status")), {"ok", "pole", "bad_input"})
        self.assertGreater(len(set(text.texts("motion_class"))), 1)
        self.assertIn("nan", text.texts("nutation_period"))

    def test_long_table(self) -> None:
        """Rows gathered and written in several goes; the same bytes for any number of threads."""
        scene = self.write(LONG, "long.nml")
        self.assertEqual(self.run_program(scene).returncode, 0)
        self.sweep(scene, "--threads", "1")
        first = (self.folder / "output/long.nc").read_bytes()
        self.check_same("long")
        for threads in ("2", "5"):
            self.sweep(scene, "--threads", threads)
            self.assertEqual((self.folder / "output/long.nc").read_bytes(), first)
        left = sorted(path.name for path in (self.folder / "output").iterdir())
        self.assertEqual(left, ["long.csv", "long.log", "long.nc"])

    def test_conventions(self) -> None:
        """The grid, the coordinates, the attributes that CF asks for, the origin."""
        self.sweep(self.grid, code=3)
        attributes, variables = self.netcdf("grid.nc")
        self.assertEqual(attributes["Conventions"], "CF-1.8")
        self.assertEqual(attributes["title"], "A grid")
        self.assertTrue(attributes["program"].startswith("spintop "))
        self.assertNotIn("date", attributes)
        axes = ("initial_theta_deg", "top_inertia_3", "top_gravity")
        for axis in axes:
            self.assertEqual(variables[axis].dims, (axis,))
        self.assertEqual(list(variables["top_inertia_3"].values), [0.25, 0.5, 1.8])
        self.assertEqual(variables["initial_theta_deg"].attrs["units"], "degree")
        self.assertEqual(variables["top_gravity"].attrs["column"], "top.gravity")
        for name, variable in variables.items():
            self.assertRegex(name, r"^[A-Za-z]\w*$")
            self.assertTrue(variable.attrs["long_name"], name)
            if name not in axes:
                self.assertEqual(variable.dims, axes)
            if variable.values.dtype.kind == "f":
                self.assertTrue(variable.attrs["units"], name)
        self.assertEqual(variables["case"].values.reshape(-1).tolist(), list(range(1, 85)))
        meanings = variables["status"].attrs["flag_meanings"].split()
        self.assertEqual(variables["status"].attrs["flag_values"].size, len(meanings))
        # The resolved input runs, and gives the same table.
        again = self.write(attributes["input"] + "\n", "again.nml")
        self.sweep(again, code=3)
        self.assertEqual(
            (self.folder / "output/again.nc").read_bytes(),
            (self.folder / "output/grid.nc").read_bytes(),
        )

    def test_axes_side_by_side(self) -> None:
        """Without a grid the dimension is the case, with the parameters of each."""
        text = GRID.split("&sweep", maxsplit=1)[0] + (
            "&sweep combine = 'latin_hypercube', cases = 9\n"
            "    parameter(1) = 'initial.theta_deg', from(1) = 10, to(1) = 80\n"
            "    parameter(2) = 'top.gravity', values(2,:) = 1, 5 /\n"
        )
        scene = self.write(text, "drawn.nml")
        self.assertEqual(self.run_program(scene).returncode, 0)
        self.sweep(scene)
        self.check_same("drawn")
        for name, variable in self.netcdf("drawn.nc")[1].items():
            self.assertEqual(variable.dims, ("case",), name)
            self.assertNotIn("coordinates", variable.attrs)
        for ending in ("csv", "nc"):
            table = read_table(self.folder / f"output/drawn.{ending}")
            self.assertEqual(object_to_scatter(table), "")

    def test_ranks(self) -> None:
        """Under MPI the bytes are the same."""
        program = os.environ.get("SPINTOP_MPI_EXE")
        if not program:
            self.skipTest("no MPI")
        for text, name, code in ((LONG, "long", 0), (GRID, "grid", 3)):
            scene = self.write(text, f"{name}.nml")
            self.sweep(scene, code=code)
            result = subprocess.run(
                ["mpirun", "-np", "3", program, scene, "--set", NETCDF, "-o", "ranks"],
                cwd=self.folder,
                env=os.environ | ENVIRONMENT,
                capture_output=True,
                text=True,
                check=False,
                timeout=1200,
            )
            self.assertEqual(result.returncode, code, result.stderr)
            tables = (self.folder / folder / f"{name}.nc" for folder in ("output", "ranks"))
            self.assertEqual(*(table.read_bytes() for table in tables))

    def test_notes(self) -> None:
        """A bit for each thing noted, where the CSV has it and its reason."""
        self.run_program(self.grid)
        self.sweep(self.grid, code=3)
        notes = self.netcdf("grid.nc")[1]["notes"]
        words = notes.attrs["flag_meanings"].split()
        masks = notes.attrs["flag_masks"].tolist()
        self.assertEqual(masks, [1 << i for i in range(len(words))])
        texts = self.table("grid").texts("notes")
        for flags, text in zip(notes.values.reshape(-1), texts, strict=True):
            told = {part.split(":")[0].replace(" ", "_") for part in text.split("; ")}
            noted = {word for mask, word in zip(masks, words, strict=True) if flags & mask}
            self.assertEqual(noted, told & set(words), text)
        self.assertGreater(len(set(notes.values.reshape(-1).tolist())), 1)


class FailureTest(NetcdfCase):
    """Impossible requests, and places where nothing can be written."""

    def test_refusals(self) -> None:
        """An impossible NetCDF table is an input error with a hint."""
        stability = "&study kind = 'stability' /\n&stability cases = 'sleeping_above' /\n"
        said = self.refuse(self.write(stability, "stability.nml"), "--set", NETCDF)
        self.assertIn("the table of a stability study cannot be NetCDF", said)
        self.assertIn("set output.format = 'csv'", said)
        for setting, reason in (
            ("output.format=csv", "only a NetCDF table can be compressed"),
            ("output.rows=none", "there are no rows to compress"),
        ):
            settings = ["--set", NETCDF, "--set", setting, "--set", "output.compression=4"]
            if "rows" in setting:
                settings += ["--set", "statistics.columns=theta_min"]
            else:
                settings = settings[2:]
            self.assertIn(reason, self.refuse(self.grid, *settings))
        said = self.refuse(self.grid, "--set", NETCDF, "--set", "output.compression=10")
        self.assertIn("must be in [0, 9]", said)

    def test_disk_that_fills_up(self) -> None:
        """Exit code 4; what was written is kept, and a run with more room goes on with it."""
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk]
        if (
            os.geteuid() != 0
            or subprocess.run(command, capture_output=True, check=False).returncode
        ):
            self.skipTest("takes root")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        said = self.sweep(self.write(LONG, "long.nml"), "-o", disk, code=4)
        self.assertIn("No space left on device", said)
        self.assertIn("--resume resumes the run", said)
        left = sorted(path.name for path in disk.iterdir())
        self.assertEqual(left, ["long.nc.journal", "long.nc.part"])
        subprocess.run(["mount", "-o", "remount,size=16m", disk], check=True)
        self.sweep(self.folder / "long.nml", "-o", disk, "--resume")
        self.sweep(self.folder / "long.nml")
        tables = (folder / "long.nc" for folder in (disk, self.folder / "output"))
        self.assertEqual(*(table.read_bytes() for table in tables))

    def test_file_that_may_not_grow(self) -> None:
        """The system stops the run in the midst of a write: no table of that name."""

        def limit() -> None:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

        scene = self.write(LONG, "long.nml")
        result = self.run_program(scene, "--set", NETCDF, preexec_fn=limit)
        self.assertIn(result.returncode, (4, -signal.SIGXFSZ))
        self.assertFalse((self.folder / "output/long.nc").exists())

    def test_folders_that_cannot_be_written(self) -> None:
        """Exit code 4, and an older table stays."""
        self.sweep(self.grid, "-o", "/proc/spintop", code=4)
        (self.folder / "output/grid.nc.part").mkdir(parents=True)
        self.assertIn("grid.nc.part", self.sweep(self.grid, code=4))


class PartsTest(NetcdfCase):
    """Parts of a sweep, merged to what one run would have written."""

    def parts(self, name: str, count: int, *arguments: str, code: int = 0) -> list[str]:
        """Compute all parts; returns their tables."""
        scene = self.folder / f"{name}.nml"
        for number in range(1, count + 1):
            result = self.run_program(
                scene, "--set", NETCDF, "--shard", f"{number}/{count}", *arguments
            )
            self.assertIn(result.returncode, (0, code), result.stderr)
        return [f"output/{name}.{i}-of-{count}.nc" for i in range(1, count + 1)]

    def test_merged_parts_are_the_whole(self) -> None:
        """Byte for byte, in any order of the parts, also if there are more parts than cases."""
        self.write(LONG, "long.nml")
        self.write(GRID.replace("count(3) = 7", "count(3) = 1"), "small.nml")
        for name, count, code in (("grid", 3, 3), ("long", 2, 0), ("small", 13, 3)):
            with self.subTest(name):
                parts = self.parts(name, count, code=code)
                random.shuffle(parts)
                said = self.run_program("merge", "output/merged.nc", *parts)
                self.assertEqual(said.returncode, 0, said.stderr)
                self.sweep(self.folder / f"{name}.nml", code=code)
                whole = (self.folder / f"output/{name}.nc").read_bytes()
                self.assertEqual((self.folder / "output/merged.nc").read_bytes(), whole)
                self.assertFalse(list((self.folder / "output").glob("*.part")))
                self.assertFalse(list((self.folder / "output").glob("*.journal")))

    def test_a_part_is_a_table_of_its_cases(self) -> None:
        """One dimension, the case; the rows are those of the CSV part."""
        parts = self.parts("grid", 3, code=3)
        self.run_program(self.grid, "--shard", "2/3")
        attributes, variables = self.netcdf(Path(parts[1]).name)
        self.assertEqual(attributes["part"], "part 2 of 3: cases 29 to 56 of 84")
        self.assertEqual({each.dims for each in variables.values()}, {("case",)})
        self.assertEqual(variables["case"].values.tolist(), list(range(29, 57)))
        texts = self.table("grid.2-of-3")
        for name in ("top.gravity", "theta_min", "com_z_min"):
            column = variables[name.replace(".", "_")]
            expected = [bits(float(cell)) for cell in texts.texts(name)]
            self.assertEqual([bits(float(value)) for value in column.values], expected)

    def test_foreign_parts_are_refused(self) -> None:
        """A part of another sweep, of another format, one that is missing, or twice there."""
        parts = self.parts("grid", 2, code=3)
        self.write(GRID.replace("psi_rate = 3", "psi_rate = 4"), "other.nml")
        others = self.parts("other", 2, code=3)
        self.run_program(self.grid, "--shard", "2/2")
        self.sweep(self.grid, code=3)
        for tables, reason in (
            ([parts[0], others[1]], "it is a part of another study than"),
            ([parts[0], "output/grid.2-of-2.csv"], "it is a part of another study than"),
            ([parts[0]], "missing of 2 parts: 2"),
            ([parts[0], parts[0]], "it is part 1, as is"),
            (["output/grid.nc"], "it is not a part of a study"),
        ):
            with self.subTest(reason):
                result = self.run_program("merge", "output/merged.nc", *tables)
                self.assertEqual(result.returncode, 2)
                self.assertIn(reason, result.stderr)
                self.assertFalse((self.folder / "output/merged.nc").exists())

    def test_statistics_beside_the_parts(self) -> None:
        """Both are merged."""
        text = LONG + "&statistics columns = 'delta_u', over = 'initial.psi_rate', bins = 5 /\n"
        self.write(text, "gathered.nml")
        parts = self.parts("gathered", 2)
        result = self.run_program("merge", "output/merged.nc", *parts)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.sweep(self.folder / "gathered.nml")
        for ending in (".nc", ".statistics.nc"):
            whole = (self.folder / f"output/gathered{ending}").read_bytes()
            self.assertEqual((self.folder / f"output/merged{ending}").read_bytes(), whole)


@pytest.mark.slow
class InterruptionTest(NetcdfCase, SurvivalCase):
    """Runs that are killed, and go on to the same bytes."""

    result = "output/slow.nc"

    def resume(self, *arguments: str) -> int:
        """Go on with the slow sweep, and kill it when the journal has some rows more; its rows."""
        run = self.start("--set", NETCDF, "--resume", *arguments)
        self.wait_for_rows(run, max(self.journalled_rows(self.result), 0) + 1, self.result)
        run.kill()
        run.wait()
        return self.journalled_rows(self.result)

    def test_killed_and_resumed(self) -> None:
        """With compression and without, with statistics, as a part: as if nothing had happened."""
        gathered = ["--set", "statistics.columns=theta_min"]
        for arguments in ([], ["--set", "output.compression=5"], gathered):
            with self.subTest(str(arguments)):
                whole = self.folder / "whole"
                self.sweep(self.slow, *arguments, "-o", whole)
                self.resume(*arguments)
                rows = self.resume(*arguments)
                said = self.sweep(self.slow, *arguments, "--resume")
                self.assertIn(f"resumes after {rows} rows of an interrupted run", said)
                for table in whole.glob("*.nc"):
                    again = self.folder / "output" / table.name
                    self.assertEqual(again.read_bytes(), table.read_bytes())
                left = sorted(path.name for path in (self.folder / "output").iterdir())
                self.assertEqual(left, sorted(path.name for path in whole.iterdir()))
                said = self.sweep(self.slow, *arguments, "--resume")
                self.assertIn("nothing was computed: the table is already complete", said)
                for path in (self.folder / "output").iterdir():
                    path.unlink()

    def test_killed_while_the_file_is_made(self) -> None:
        """The rows are there, and the next run makes the file of them, whatever is left of it."""
        self.write(LONG, "slow.nml")
        for arguments in ([], ["--set", "output.compression=9"]):
            whole = self.folder / "whole"
            self.sweep(self.slow, *arguments, "-o", whole)
            run = self.start("--set", NETCDF, *arguments)
            self.wait_until(run, lambda: is_larger(self.folder / f"{self.result}.new", 0))
            run.kill()
            if run.wait():
                self.assertFalse((self.folder / self.result).exists())
            self.sweep(self.slow, *arguments, "--resume")
            self.assertEqual(self.read(self.result), self.read("whole/slow.nc"))
            left = sorted(path.name for path in (self.folder / "output").iterdir())
            self.assertEqual(left, ["slow.log", "slow.nc"])
            shutil.rmtree(self.folder / "output")

    def test_strangers_and_damage_are_refused(self) -> None:
        """Nothing is discarded unasked, nothing continued that is not the same."""
        rows = self.resume()
        part = self.folder / f"{self.result}.part"
        kept = part.read_bytes()
        said = self.sweep(self.slow, code=2)
        self.assertIn(f"an interrupted run of output/slow.nc is there: {rows} rows are kept", said)
        said = self.sweep(self.slow, "--resume", "--set", "top.mass=2", code=2)
        self.assertIn("was made by another program, build or input", said)
        self.assertEqual(part.read_bytes(), kept)
        damaged = bytearray(kept)
        damaged[kept.index(struct.pack("=d", 1.0))] ^= 1  # the number of the first case
        for content, reason in (
            (bytes(damaged), "was changed after it was written"),
            (kept[: kept.index(struct.pack("=d", 1.0))], "is shorter than its journal records"),
            (kept[:100], "was made by another program, build or input"),
            (b"", "was made by another program, build or input"),
        ):
            part.write_bytes(content)
            self.assertIn(reason, self.sweep(self.slow, "--resume", code=2))
        part.write_bytes(kept)
        self.sweep(self.slow, "--resume")
        self.assertFalse(part.exists())

    def test_a_signal_keeps_what_is_there(self) -> None:
        """And says so."""
        run = subprocess.Popen(
            [PROGRAM, self.slow, "--set", NETCDF, "--threads", "1"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.wait_for_rows(run, 1, self.result)
        run.send_signal(signal.SIGTERM)
        said = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, -signal.SIGTERM)
        rows = self.journalled_rows(self.result)
        self.assertIn(f"interrupted: {rows} of 1000 rows of output/slow.nc are kept", said)


class CompressionTest(NetcdfCase):
    """The format NetCDF-4."""

    def setUp(self) -> None:
        """Leave out builds without the format."""
        super().setUp()
        self.level = ["--set", "output.compression=6"]
        said = self.run_program("--check", self.grid, "--set", NETCDF, *self.level).stderr
        if "has no format NetCDF-4" in said:
            self.skipTest("no NetCDF-4")

    def test_same_cells(self) -> None:
        """All numbers, words, attributes and coordinates of the classic file, in fewer bytes."""
        self.write(LONG, "long.nml")
        for name, code in (("grid", 3), ("long", 0)):
            scene = self.folder / f"{name}.nml"
            self.run_program(scene)
            self.sweep(scene, code=code)
            plain = (self.folder / f"output/{name}.nc").stat().st_size
            self.sweep(scene, *self.level, code=code)
            path = self.folder / f"output/{name}.nc"
            self.assertEqual(path.read_bytes()[:4], b"\x89HDF")
            text, table = self.table(name), read_table(path)
            self.assertEqual(table.settings["output.compression"], ["6"])
            self.assertEqual(list(table.rows), text.names)
            for column in text.names:
                cells = text.texts(column)
                if column in ("status", "motion_class"):
                    self.assertEqual(list(table.rows[column]), cells)
                elif column != "notes":
                    found = [bits(float(value)) for value in table.rows[column]]
                    self.assertEqual(found, [bits(float(cell)) for cell in cells], column)
        self.assertLess(path.stat().st_size, 0.8 * plain)

    def test_same_bytes(self) -> None:
        """For any number of threads, and merged from parts."""
        scene = self.write(LONG, "long.nml")
        self.sweep(scene, *self.level, "--threads", "1")
        first = (self.folder / "output/long.nc").read_bytes()
        self.sweep(scene, *self.level, "--threads", "3")
        self.assertEqual((self.folder / "output/long.nc").read_bytes(), first)
        for part in ("1/2", "2/2"):
            self.sweep(scene, *self.level, "--shard", part)
        parts = [f"output/long.{i}-of-2.nc" for i in (1, 2)]
        self.assertEqual(self.run_program("merge", "output/merged.nc", *parts).returncode, 0)
        self.assertEqual((self.folder / "output/merged.nc").read_bytes(), first)


class UnitsTest(NetcdfCase):
    """Columns in other units than their own."""

    def test_units(self) -> None:
        """The table is finished, and read in the same units as a CSV table."""
        columns = "theta_max_deg,precession_rate_deg,precession_rate_rev,phi_end_deg__top.gravity"
        few = LONG.replace("'delta_u', 'phi_end'", repr(columns.split(","))[1:-1])
        scene = self.write(few.replace("331", "3").replace("421", "2"))
        self.sweep(scene)
        self.assertEqual(self.run_program(scene).returncode, 0)
        csv, netcdf = (read_table(self.folder / f"output/scene{end}") for end in (".csv", ".nc"))
        self.assertEqual(netcdf.units, csv.units)
        self.assertEqual(csv.units["precession_rate_deg"], "deg/s")


class TrajectoryTest(NetcdfCase):
    """Trajectories in both formats."""

    def both(self, text: str, code: int = 0) -> tuple[Table, object]:
        """Run a trajectory in both formats, and compare all numbers."""
        scene = self.write(text, "scene.nml")
        self.assertEqual(self.run_program(scene).returncode, code)
        csv = read_table(self.folder / "output/scene.csv")
        for arguments in ([], ["--set", "output.compression=1"]):
            self.sweep(scene, *arguments, code=code)
            table = read_table(self.folder / "output/scene.nc")
            self.assertEqual(table.status, csv.status)
            self.assertEqual(table.units, csv.units)
            self.assertEqual(table.meanings, csv.meanings)
            self.assertEqual(list(table.rows), list(csv.rows))
            for name in csv.rows:
                pairs = zip(table.rows[name], csv.rows[name], strict=True)
                self.assertTrue(all(bits(float(a)) == bits(float(b)) for a, b in pairs), name)
        left = {path.name for path in (self.folder / "output").iterdir()}
        self.assertLessEqual(left, {"scene.csv", "scene.nc", "scene.events.csv"})
        return csv, table

    def test_same_numbers(self) -> None:
        """Of a complete motion; time is the coordinate."""
        self.both(GOOD)
        self.sweep(self.folder / "scene.nml")
        attributes, variables = self.netcdf("scene.nc")
        self.assertEqual(attributes["status"], "ok")
        self.assertIn("date", attributes)
        self.assertEqual({each.dims for each in variables.values()}, {("t",)})
        self.assertNotIn("_FillValue", variables["t"].attrs)

    def test_without_time(self) -> None:
        """The rows are the dimension."""
        scene = self.write(GOOD, "scene.nml")
        self.sweep(scene, "--set", "output.columns=theta,psi")
        _, variables = self.netcdf("scene.nc")
        self.assertEqual(variables["theta"].dims, ("row",))

    def test_motions_that_end_early(self) -> None:
        """At an event, or with a failure: the rows up to there, and why."""
        span = (
            "&span t_end = 50, samples = 3001, stop_at = 'upper_turning_points', stop_after = 2 /"
        )
        text = GRID.split("&study", maxsplit=1)[0] + (
            "&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /\n"
            "&initial theta_deg = 20, psi_rate = 3 /\n"
            f"{span}\n&integration formulation = 'rigid_body', method = 'dop853' /\n"
        )
        csv, _ = self.both(text)
        self.assertEqual((csv.status, len(csv.rows)), ("ok", 3001))
        text = text.replace(span, "&span t_end = 50, samples = 3001 /")
        csv, _ = self.both(text.replace("'dop853'", "'dop853', max_steps = 50"), code=3)
        self.assertRegex(csv.status, "^step_limit at t = ")
        self.assertLess(len(csv.rows), 3001)
        # A method with a fixed step size writes the steps up to the event.
        steps = text.replace("samples = 3001", "stop_at = 'theta = 1.0'")
        csv, _ = self.both(steps.replace("'dop853'", "'rk4', steps = 5000"))
        self.assertEqual(csv.status, "ok")
        self.assertLess(len(csv.rows), 5001)

    def test_a_killed_motion_leaves_no_table(self) -> None:
        """A file that was cut short is reported by those who read it."""
        long = GOOD.replace("steps = 10", "steps = 20000000, max_steps = 2000000000")
        scene = self.write(long, "scene.nml")
        run = subprocess.Popen([PROGRAM, scene, "--set", NETCDF], cwd=self.folder)
        part = self.folder / "output/scene.nc.part"
        while not part.exists() or part.stat().st_size < 100_000:
            self.assertIsNone(run.poll())
            time.sleep(0.01)
        run.kill()
        run.wait()
        self.assertFalse((self.folder / "output/scene.nc").exists())
        part.rename(self.folder / "cut.nc")
        with self.assertRaises(TableError):
            read_table(self.folder / "cut.nc")
        # The next run is not in the way of what is left.
        self.sweep(self.write(GOOD, "scene.nml"))
