"""Tables of sweeps read back: each parameter has the value of its case."""

import csv
import itertools
import math
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]

from program_test import ProgramCase  # noqa: E402
from spintop_figures.tables.table import read_table  # noqa: E402

SEED = 20121
CASES = 41  # of a table: a few blocks of cases that are computed one by one
EPSILON = 2.0**-52

# Every numeric key of a body in general, and between what its values are drawn.
ANY_BODY = {
    "top.mass": (0.5, 2),
    "top.inertia(1)": (0.8, 1.2),
    "top.inertia(2)": (0.8, 1.2),
    "top.inertia(3)": (0.5, 1.2),
    "top.centre_of_mass(1)": (-0.1, 0.1),
    "top.centre_of_mass(2)": (-0.1, 0.1),
    "top.centre_of_mass(3)": (-0.5, 0.5),
    "top.gravity": (0, 20),
    "top.damping(1)": (0, 0.1),
    "top.damping(2)": (0, 0.1),
    "top.damping(3)": (0, 0.1),
    "initial.phi": (-9, 9),
    "initial.theta": (0.1, 3),
    "initial.psi": (-9, 9),
    "initial.phi_rate": (-2, 2),
    "initial.theta_rate": (-2, 2),
    "initial.omega3": (-5, 5),
    "span.t_end": (0.001, 0.02),
    "integration.relative_tolerance": (1e-9, 1e-6),
    "integration.absolute_tolerance": (1e-12, 1e-9),
}
# The same of a body with a tensor, whose names have a comma.
ANY_TENSOR = {
    **{name: ends for name, ends in ANY_BODY.items() if not name.startswith(("top.i", "top.d"))},
    **{f"top.inertia_tensor({i},{i})": (0.9, 1.2) for i in (1, 2, 3)},
    **{f"top.inertia_tensor({i},{j})": (-0.1, 0.1) for i, j in ((1, 2), (1, 3), (2, 3))},
}
# Those that leave a top whose motion is known in closed form.
LAGRANGE_TOP = [
    *("top.mass", "top.inertia(3)", "top.centre_of_mass(3)", "top.gravity", "span.t_end"),
    *(name for name in ANY_BODY if name.startswith("initial.")),
]
QUANTITIES = "'t_end', 'phi_end', 'theta_end', 'psi_end', 'theta_rate_end', 'evaluations'"
SCENE = f"""\
&study kind = 'sweep' /
&top mass = 1, inertia = 1, 1, 0.5, centre_of_mass = 0, 0, 0.5 /
&initial phi = 0, theta = 1, psi = 0, phi_rate = 0, theta_rate = 0, omega3 = 2 /
&span t_end = 0.01 /
&integration relative_tolerance = 1e-9, absolute_tolerance = 1e-12 /
&output columns = {QUANTITIES} /
&sweep table = 'cases.csv' /
"""
TENSOR = SCENE.replace(
    "inertia = 1, 1, 0.5",
    "inertia_tensor(1,:) = 1, 0, 0, inertia_tensor(2,2:3) = 1, 0, inertia_tensor(3,3) = 1",
)
# Parameters of axes: real ones and a whole one.
AXES = ("initial.theta", "top.mass", "initial.omega3", "integration.max_steps")


def spaced(first: float, last: float, count: int, logarithmic: bool) -> list[float]:
    """The values of an axis."""
    parts = [k / max(1, count - 1) for k in range(count)]
    if logarithmic:
        values = [first * (last / first) ** part for part in parts]
    else:
        values = [first + (last - first) * part for part in parts]
    return [*values[:-1], last] if count > 1 else values


class ReadBackCase(ProgramCase):
    """Sweeps in both formats, read back."""

    def setUp(self) -> None:
        """A folder, a generator, and the formats that the build has."""
        super().setUp()
        self.random = random.Random(SEED)
        self.rows_of(["initial.theta"], [[1.0]])
        self.scene_path = self.write(SCENE)
        said = self.run_program("--check", self.scene_path, "--set", "output.format=netcdf").stderr
        self.formats = ["csv"] if "this build has no NetCDF" in said else ["csv", "netcdf"]

    def rows_of(self, names: Sequence[str], rows: Sequence[Sequence[float]]) -> None:
        """Write the table of cases."""
        quoted = [f'"{name}"' if "," in name else name for name in names]
        lines = [",".join(quoted), *(",".join(map(repr, row)) for row in rows)]
        (self.folder / "cases.csv").write_text("\n".join(lines) + "\n", encoding="ascii")

    def draw(self, names: Sequence[str], cases: int) -> list[list[float]]:
        """Values of parameters at random."""
        return [
            [self.random.uniform(*(ANY_BODY | ANY_TENSOR)[name]) for name in names]
            for _ in range(cases)
        ]

    def sweep(self, scene: Path, *arguments: str, kind: str = "csv") -> Path:
        """Run a sweep; every case must end well."""
        result = self.run_program(scene, "--set", f"output.format={kind}", *arguments)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return self.folder / "output" / f"{scene.stem}.{kind.replace('netcdf', 'nc')}"

    def parameters(self, path: Path, names: Sequence[str]) -> list[list[float]]:
        """The columns of parameters of a table, as rows; its cases are numbered in order."""
        rows = read_table(path).rows
        self.assertEqual(list(rows["case"]), list(range(1, len(rows) + 1)))
        self.assertEqual(list(rows.columns[1 : len(names) + 1]), list(names))
        return [list(map(float, row)) for row in zip(*(rows[name] for name in names), strict=True)]

    def body(self, path: Path, skip: int = 0) -> list[str]:
        """The lines of a CSV table without its header and its first columns."""
        lines = path.read_text(encoding="utf-8").splitlines()
        return [line.split(",", skip)[-1] for line in lines if not line.startswith("#")]


class TableOfAnyWidthTest(ReadBackCase):
    """Tables of 1 to 20 columns."""

    def test_each_column_is_that_of_the_table(self) -> None:
        """In both formats, for bodies of any kind, in any order of the columns."""
        for width in range(1, len(ANY_BODY) + 1):
            names = self.random.sample(list(ANY_BODY), width)
            rows = self.draw(names, CASES)
            self.rows_of(names, rows)
            for kind in self.formats:
                with self.subTest(width=width, kind=kind):
                    path = self.sweep(self.scene_path, "--threads", "2", kind=kind)
                    self.assertEqual(self.parameters(path, names), rows)

    def test_names_with_a_comma(self) -> None:
        """They stand in quotes, in tables of statistics, too, and in what is merged."""
        scene = self.write(TENSOR, "tensor.nml")
        for width in range(1, len(ANY_TENSOR) + 1):
            names = self.random.sample(list(ANY_TENSOR), width)
            rows = self.draw(names, CASES)
            self.rows_of(names, rows)
            for kind in self.formats:
                with self.subTest(width=width, kind=kind):
                    path = self.sweep(scene, "--threads", "2", kind=kind)
                    self.assertEqual(self.parameters(path, names), rows)
        names = ["top.inertia_tensor(1,2)", "initial.psi"]
        self.rows_of(names, rows := self.draw(names, CASES))
        settings = ["--set", f"statistics.over='{names[0]}'", "--set", "statistics.bins=2"]
        settings += ["--set", "statistics.from=-0.1", "--set", "statistics.to=0.1"]
        settings += ["--set", f"statistics.columns='{names[0]}'"]
        whole = self.sweep(scene, *settings)
        with whole.open(encoding="utf-8") as file:
            cells = list(csv.reader(line for line in file if not line.startswith("#")))
        self.assertEqual(cells[0][:4], ["case", *names, "status"])
        self.assertEqual([[float(cell) for cell in row[1:3]] for row in cells[1:]], rows)
        statistics = read_table(whole.with_suffix(".statistics.csv")).rows
        self.assertEqual(sum(statistics[f"{names[0]}_count"][1:]), CASES)
        histogram = read_table(whole.with_suffix(".histogram.csv")).rows
        self.assertEqual(set(histogram["column"]), {names[0]})
        parts = []
        for i in (1, 2):
            table = self.sweep(scene, "--shard", f"{i}/2")
            parts.append(table.with_name(f"tensor.{i}-of-2.csv"))
        self.sweep(scene)
        self.assertEqual(self.run_program("merge", "merged.csv", *parts).returncode, 0)
        self.assertEqual((self.folder / "merged.csv").read_bytes(), whole.read_bytes())

    def test_each_column_is_that_of_the_table_in_closed_form(self) -> None:
        """More cases than are computed at once; up to as many columns as there are."""
        for width in range(1, len(LAGRANGE_TOP) + 1):
            names = self.random.sample(LAGRANGE_TOP, width)
            rows = self.draw(names, 600)
            self.rows_of(names, rows)
            for kind in self.formats:
                with self.subTest(width=width, kind=kind):
                    path = self.sweep(self.scene_path, "--threads", "2", kind=kind)
                    self.assertEqual(self.parameters(path, names), rows)

    def test_parts_threads_and_what_was_resumed(self) -> None:
        """The same bytes, and those of the table, however the sweep is computed."""
        names = list(ANY_BODY)
        rows = self.draw(names, 300)
        self.rows_of(names, rows)
        whole = self.sweep(self.scene_path, "--threads", "1")
        self.assertEqual(self.parameters(whole, names), rows)
        expected = whole.read_bytes()
        for threads in ("2", "3", "7"):
            self.assertEqual(
                self.sweep(self.scene_path, "--threads", threads).read_bytes(), expected
            )
        parts = []
        for i in (1, 2, 3):
            self.sweep(self.scene_path, "--shard", f"{i}/3")
            parts.append(self.folder / "output" / f"scene.{i}-of-3.csv")
        result = self.run_program("merge", "merged.csv", *parts)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((self.folder / "merged.csv").read_bytes(), expected)

    def test_resumed(self) -> None:
        """A long sweep that was killed on its way."""
        names = list(ANY_BODY)
        spans = names.index("span.t_end")
        rows = self.draw(names, 2000)
        for row in rows:
            row[spans] *= 200
        self.rows_of(names, rows)
        run = subprocess.Popen(
            [*self.command, self.scene_path, "--threads", "1"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        journal = self.folder / "output" / "scene.csv.journal"
        deadline = time.monotonic() + 30
        while not journal.exists() and run.poll() is None:
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        run.kill()
        run.wait()
        path = self.sweep(self.scene_path, "--threads", "2", "--resume")
        self.assertEqual(self.parameters(path, names), rows)


class AxesTest(ReadBackCase):
    """Axes of every kind, in every combination."""

    def values_of(self, name: str, kind: str, count: int) -> tuple[list[float], str]:
        """The values of an axis, and what the input says of it with `#` for its number."""
        whole = name == "integration.max_steps"
        if kind == "values":
            low, high = (500, 900) if whole else (0.5, 2.5)
            draw = self.random.randint if whole else self.random.uniform
            values = [draw(low, high) for _ in range(count)]
            return values, "values(#,:) = " + ", ".join(map(repr, values))
        logarithmic = kind == "log"
        if whole:
            # Whole numbers, as they must be.
            first, last = (1000, 1000 * 2 ** (count - 1)) if logarithmic else (500, 498 + 2 * count)
        else:
            first, last = self.random.uniform(0.5, 1), self.random.uniform(1.5, 2.5)
        text = f"from(#) = {first!r}, to(#) = {last!r}, count(#) = {count}"
        spacing = ", spacing(#) = 'log'" if logarithmic else ""
        return spaced(first, last, count, logarithmic), text + spacing

    def scene_of(self, combine: str, axes: Sequence[tuple[str, str]]) -> Path:
        """A scene with axes."""
        text = SCENE.replace("table = 'cases.csv' /", combine)
        for name, _ in axes:
            key = name.split(".")[1]
            if key == "max_steps":
                text = text.replace("&integration", "&integration max_steps = 1000,")
        for i, (name, said) in enumerate(axes, 1):
            text += f"    parameter({i}) = '{name}', {said.replace('#', str(i))}\n"
        return self.write(text + "/\n", "axes.nml")

    def check(self, scene: Path, names: Sequence[str], expected: list[list[float]] | None) -> None:
        """All formats, threads and parts give the cases expected, and their rows as a table do."""
        tables = {kind: self.sweep(scene, "--threads", "2", kind=kind) for kind in self.formats}
        rows = self.parameters(tables["csv"], names)
        if expected is not None:
            self.assertEqual(len(rows), len(expected))
            for row, values in zip(rows, expected, strict=True):
                for value, wanted in zip(row, values, strict=True):
                    # The library's powers may round otherwise.
                    self.assertLessEqual(abs(value - wanted), 2 * EPSILON * abs(wanted))
        for path in tables.values():
            self.assertEqual(self.parameters(path, names), rows)
        self.rows_of(names, rows)
        again = self.write(SCENE.replace("&integration", "&integration max_steps = 1000,"))
        quantities = self.body(tables["csv"], len(names) + 1)
        self.assertEqual(self.body(self.sweep(again), len(names) + 1), quantities)
        parts = []
        for i in (1, 2):
            self.sweep(scene, "--threads", "1", "--shard", f"{i}/2")
            parts.append(self.folder / "output" / f"axes.{i}-of-2.csv")
        result = self.run_program("merge", "merged.csv", *parts)
        self.assertEqual(result.returncode, 0, result.stderr)
        merged = self.folder / "merged.csv"
        self.assertEqual(merged.read_bytes(), tables["csv"].read_bytes())
        merged.unlink()

    def test_grids_and_zips(self) -> None:
        """Each number of axes with each way to give their values."""
        kinds = ("values", "linear", "log")
        for combine, axes in itertools.product(("grid", "zip"), (1, 2, 3, 4)):
            for turn in range(len(kinds)):
                given = []
                for i, name in enumerate(self.random.sample(AXES, axes)):
                    count = 5 if combine == "zip" else self.random.randint(1, 4)
                    kind = kinds[(turn + i) % len(kinds)]
                    given.append((name, *self.values_of(name, kind, count)))
                values = [axis for _, axis, _ in given]
                cases = (
                    zip(*values, strict=True) if combine == "zip" else itertools.product(*values)
                )
                with self.subTest(combine=combine, axes=given):
                    scene = self.scene_of(f"combine = '{combine}'", [(n, s) for n, _, s in given])
                    self.check(scene, [n for n, _, _ in given], [list(case) for case in cases])

    def test_drawn_cases(self) -> None:
        """Between their ends, each value as the quantities of its case have it."""
        for combine, axes in itertools.product(("random", "latin_hypercube"), (1, 2, 3, 4)):
            names = self.random.sample(AXES, axes)
            given = []
            for i, name in enumerate(names):
                low, high = (700, 900) if name == "integration.max_steps" else (0.5, 2.5)
                spacing = ", spacing(#) = 'log'" if i % 2 else ""
                given.append((name, f"from(#) = {low}, to(#) = {high}{spacing}"))
            with self.subTest(combine=combine, axes=given):
                scene = self.scene_of(f"combine = '{combine}', cases = 53, seed = 7", given)
                self.check(scene, names, None)
                for row in self.parameters(self.folder / "output" / "axes.csv", names):
                    for name, value in zip(names, row, strict=True):
                        low, high = (700, 900) if name == "integration.max_steps" else (0.5, 2.5)
                        self.assertTrue(low <= value <= high)
                        self.assertTrue(math.isfinite(value))


if __name__ == "__main__":
    import unittest

    unittest.main()
