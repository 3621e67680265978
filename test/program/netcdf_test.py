"""NetCDF tables of sweeps: the numbers of the CSV, bit for bit, by the conventions of CF."""

import os
import resource
import signal
import struct
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]

from mpi_test import ENVIRONMENT  # noqa: E402
from program_test import GOOD, ProgramCase, Table  # noqa: E402
from spintop_figures.sweeps.scatter import object_to_scatter  # noqa: E402
from spintop_figures.tables.netcdf import Attributes, Variable, read_netcdf  # noqa: E402
from spintop_figures.tables.table import read_table  # noqa: E402

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

    def netcdf(self, name: str) -> tuple[Attributes, dict[str, Variable]]:
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
            self.assertEqual(variables[axis].dimensions, (axis,))
        self.assertEqual(list(variables["top_inertia_3"].values), [0.25, 0.5, 1.8])
        self.assertEqual(variables["initial_theta_deg"].attributes["units"], "degree")
        self.assertEqual(variables["top_gravity"].attributes["column"], "top.gravity")
        for name, variable in variables.items():
            self.assertRegex(name, r"^[A-Za-z]\w*$")
            self.assertTrue(variable.attributes["long_name"], name)
            if name not in axes:
                self.assertEqual(variable.dimensions, axes)
            if variable.values.dtype.kind == "f":
                self.assertTrue(variable.attributes["units"], name)
        self.assertEqual(variables["case"].values.reshape(-1).tolist(), list(range(1, 85)))
        meanings = variables["status"].attributes["flag_meanings"].split()
        self.assertEqual(variables["status"].attributes["flag_values"].size, len(meanings))
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
            self.assertEqual(variable.dimensions, ("case",), name)
            self.assertNotIn("coordinates", variable.attributes)
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
        words = notes.attributes["flag_meanings"].split()
        masks = notes.attributes["flag_masks"].tolist()
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
        for scene, arguments, reason in (
            (self.write(GOOD, "good.nml"), [], "only the table of a sweep can be NetCDF"),
            (self.grid, ["--shard", "1/2"], "--shard and --resume are not possible"),
            (self.grid, ["--resume"], "--shard and --resume are not possible"),
        ):
            with self.subTest(reason):
                said = self.refuse(scene, "--set", NETCDF, *arguments)
                self.assertIn(reason, said)
                self.assertIn("set output.format = 'csv'", said)

    def test_disk_that_fills_up(self) -> None:
        """Exit code 4, and nothing is left."""
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
        self.assertIn("nothing is kept of", said)
        self.assertEqual(list(disk.iterdir()), [])

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
