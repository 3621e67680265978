"""Sobol' indices of sweeps: known ones, the same bytes, hostile input, the figure."""

import itertools
import sys
import unittest
import unittest.mock
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

from mpi_test import ENVIRONMENT, MPI_PROGRAM, under
from program_test import Table
from spintop_figures.registry import FIGURES
from spintop_figures.sweeps.statistics import indices_of
from spintop_figures.tables.table import read_table
from statistics_test import SLOW, KilledCase, StatisticsCase

# Released at rest, so that maximum inclination and period of precession have formulas.
KNOWN = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&span t_end = 1 /
&sweep combine = 'saltelli'  cases = 10240  seed = 5
       parameter(1) = 'initial.theta_deg'  from(1) = 20  to(1) = 60
       parameter(2) = 'initial.psi_rate'  from(2) = 10  to(2) = 40
       parameter(3) = 'top.gravity'  from(3) = 5  to(3) = 15 /
&output columns = 'theta_max', 'precession_period' /
&statistics columns = 'theta_max', 'precession_period', 'initial.psi_rate', 'status'
            indices = 'sobol' /
"""
FACTORS = ("initial.theta_deg", "initial.psi_rate", "top.gravity")
# Cases that fail (at a pole), and cases without a period.
FAILING = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial psi_rate = 8 /
&span t_end = 0.5 /
&integration formulation = 'lagrange', method = 'rk4', steps = 20 /
&sweep combine = 'saltelli'  cases = 400
       parameter(1) = 'initial.phi_rate'  values(1,:) = 1, -1, 0, 2
       parameter(2) = 'initial.theta_deg'  values(2,:) = 0, 5, 10, 20, 30, 40
       parameter(3) = 'top.gravity'  values(3,:) = 0, 2, 5, 9.81 /
&output columns = 'theta_max', 'precession_period', 'theta_end', 'motion_class' /
&statistics columns = 'theta_max', 'precession_period', 'theta_end', 'motion_class'
            indices = 'sobol'  over = 'initial.phi_rate' /
"""
VECTOR = """\
&study kind = 'sweep' /
&top mass = 0.5, inertia = 1.5e-3, 1.5e-3, 5.0e-4, length = 0.04 /
&span t_end = 0.1 /
&sweep combine = 'saltelli'  cases = 64
       parameter(1) = 'initial.quaternion'  distribution(1) = 'sphere'
       parameter(2) = 'initial.omega3'  from(2) = 80  to(2) = 120 /
&output rows = 'none' /
&statistics columns = 'theta_end'  indices = 'sobol' /
"""
PARTS = 16
STUDENT = 2.131449545559323
RESULT = ("statistics.csv", "histogram.csv", "indices.csv")


def jansen(groups: np.ndarray) -> np.ndarray:
    """First-order and total index of each factor from rows of A, B and the others."""
    a, b, others = groups[:, :1], groups[:, 1:2], groups[:, 2:]
    variance = np.var(groups[:, :2])
    first = 1 - np.mean((b - others) ** 2, axis=0) / (2 * variance)
    return np.array([first, np.mean((a - others) ** 2, axis=0) / (2 * variance)])


def with_errors(groups: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The indices of groups that all have values, and half the widths of their intervals."""
    part = np.arange(len(groups)) // -(-len(groups) // PARTS)
    used = np.unique(part)
    without = np.array([jansen(groups[part != left]) for left in used])
    spread = ((without - without.mean(axis=0)) ** 2).sum(axis=0)
    return jansen(groups), STUDENT * np.sqrt(spread * (len(used) - 1) / len(used))


def by_quadrature(function: Callable, ends: list[tuple[float, float]]) -> np.ndarray:
    """The indices of a smooth function of independent uniform factors, by Gauss' quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    points = [low + (high - low) * (nodes + 1) / 2 for low, high in ends]
    values = function(*np.meshgrid(*points, indexing="ij"))
    share = weights / 2

    def mean(cells: np.ndarray, axes: set[int]) -> np.ndarray:
        for axis in sorted(axes, reverse=True):
            cells = np.tensordot(cells, share, axes=(axis, 0))
        return cells

    every = set(range(len(ends)))
    middle = mean(values, every)
    variance = mean((values - middle) ** 2, every)
    found = np.empty((2, len(ends)))
    for factor in every:
        others = every - {factor}
        found[0, factor] = share @ (mean(values, others) - middle) ** 2
        alone = mean(values, {factor})
        spread = mean(values**2, {factor}) - alone**2
        found[1, factor] = mean(spread, set(range(len(ends) - 1)))
    return found / variance


def theta_max(theta_deg: np.ndarray, psi_rate: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """The maximum inclination of a top released at rest: a root of a quadratic."""
    start = np.cos(np.radians(theta_deg))
    half = (0.25 * psi_rate) ** 2 / (4 * 0.875 * gravity * 0.85)
    return np.arccos(half - np.sqrt(half**2 - 2 * half * start + 1))


def precession_period(_: np.ndarray, psi_rate: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """That of a fast top, which does not depend on the inclination."""
    return 2 * np.pi * 0.25 * psi_rate / (gravity * 0.85)


class IndicesCase(StatisticsCase):
    """Runs with Sobol' indices."""

    def results(self, folder: str, name: str = "map") -> list[bytes]:
        """The tables of the statistics in a folder."""
        return [(self.folder / folder / f"{name}.{ending}").read_bytes() for ending in RESULT]

    def found(self, column: str, name: str = "map") -> tuple[list[str], np.ndarray]:
        """The factors of a column, and its numbers by factor."""
        table = Table(self.folder / f"output/{name}.indices.csv")
        rows = [row for row in table.rows if row[0] == column]
        return [row[1] for row in rows], np.array([row[2:] for row in rows], dtype=float)


class KnownTest(IndicesCase):
    """Indices that are known otherwise."""

    def test_formulas(self) -> None:
        """Those of quadrature lie in the intervals, or within a few thousandths."""
        self.run_well(self.write_input(KNOWN))
        ends = [(20, 60), (10, 40), (5, 15)]
        for name, function in (("theta_max", theta_max), ("precession_period", precession_period)):
            expected = by_quadrature(function, ends)
            factors, found = self.found(name)
            self.assertEqual(factors, list(FACTORS))
            np.testing.assert_allclose(found[:, 0], expected[0], atol=0.01, err_msg=name)
            np.testing.assert_allclose(found[:, 3], expected[1], atol=0.01, err_msg=name)
            for at, index in ((0, 0), (3, 1)):
                self.assertTrue((found[:, at + 1] <= expected[index] + 1e-9).all(), name)
                self.assertTrue((found[:, at + 2] >= expected[index] - 1e-9).all(), name)
            self.assertTrue((found[:, 2] - found[:, 1] < 0.15).all())
            self.assertTrue((found[:, 6] == 2048).all() and (found[:, 7] == 0).all())
        # A factor decides itself, and nothing else does.
        _, found = self.found("initial.psi_rate")
        self.assertEqual(found[:, 3].tolist()[::2], [0, 0])
        self.assertEqual(found[1, 0], 1)
        _, found = self.found("precession_period")
        self.assertEqual(found[0, 3], 0)

    def test_estimators_of_the_rows(self) -> None:
        """Estimates and intervals are those that follow from the rows."""
        self.run_well(self.write_input(KNOWN))
        rows = Table(self.folder / "output/map.csv")
        for name in ("theta_max", "precession_period"):
            groups = np.array(rows.column(name)).reshape(-1, 5)
            expected, errors = with_errors(groups)
            _, found = self.found(name)
            for at, index in ((0, 0), (3, 1)):
                value, error = expected[index], errors[index]
                np.testing.assert_allclose(found[:, at], value, atol=1e-12)
                np.testing.assert_allclose(found[:, at + 1], value - error, atol=1e-12)
                np.testing.assert_allclose(found[:, at + 2], value + error, atol=1e-12)

    def test_groups_without_values(self) -> None:
        """Those with a case that failed, or has no value, are counted apart and do not enter."""
        self.run_well(self.write_input(FAILING))
        rows = Table(self.folder / "output/map.csv")
        good = np.array(rows.texts("status")) == "ok"
        some = set()
        for name in ("theta_max", "precession_period", "theta_end"):
            values = np.where(good, np.array(rows.column(name)), np.nan).reshape(-1, 5)
            whole = np.isfinite(values).all(axis=1)
            _, found = self.found(name)
            self.assertEqual(set(found[:, 6]), {whole.sum()})
            self.assertEqual(set(found[:, 7]), {(~whole).sum()})
            some.add(int((~whole).sum()))
            expected = jansen(values[whole])
            np.testing.assert_allclose(found[:, 0], expected[0], atol=1e-12)
            np.testing.assert_allclose(found[:, 3], expected[1], atol=1e-12)
        self.assertGreater(len(some), 1)
        self.assertGreater(min(some), 0)
        self.assertLess(max(some), 80)

    def test_vector(self) -> None:
        """The components of a vector are one factor."""
        self.run_well(self.write_input(VECTOR))
        factors, found = self.found("theta_end")
        self.assertEqual(factors, ["initial.quaternion", "initial.omega3"])
        self.assertTrue((found[:, 6] == 16).all())

    def test_nothing_varies(self) -> None:
        """A column that does not vary has no indices; a single group has no intervals."""
        text = VECTOR.replace("'theta_end'", "'evaluations', 'theta_end'")
        self.run_well(self.write_input(text.replace("cases = 64", "cases = 4")))
        self.assertTrue(np.isnan(self.found("evaluations")[1][:, :6]).all())
        _, found = self.found("theta_end")
        self.assertTrue(np.isfinite(found[:, [0, 3]]).all())
        self.assertTrue(np.isnan(found[:, [1, 2, 4, 5]]).all())


class SameIndicesTest(IndicesCase):
    """However a sweep is divided, also inside a group."""

    def test_threads_rows_and_parts(self) -> None:
        """One and two threads, with rows and without, parts that cut groups, in any order."""
        path = self.write_input(FAILING)
        self.run_well(path, "--threads", "1", "-o", "one")
        self.run_well(path, "--threads", "2", "-o", "two")
        self.assertEqual(self.results("one"), self.results("two"))
        for part in range(1, 8):
            self.run_well(path, "--shard", f"{part}/7", "-o", "parts")
        tables = [f"parts/map.{part}-of-7.csv" for part in (3, 7, 1, 2, 6, 4, 5)]
        self.run_well("merge", "parts/map.csv", *tables)
        self.assertEqual(self.results("one"), self.results("parts"))

    def test_parts_shorter_than_groups(self) -> None:
        """A group may lie in three parts, and a part may be empty."""
        path = self.write_input(VECTOR.replace("cases = 64", "cases = 12"))
        self.run_well(path, "-o", "one")
        for parts in (7, 13):
            for part in range(1, parts + 1):
                self.run_well(path, "--shard", f"{part}/{parts}", "-o", "parts")
            states = [f"parts/map.{k}-of-{parts}.statistics.state" for k in range(parts, 0, -1)]
            self.run_well("merge", "parts/map.statistics.csv", *states)
            self.assertEqual(self.results("one"), self.results("parts"))

    @unittest.skipUnless(Path(MPI_PROGRAM).is_file(), "no MPI")
    def test_ranks(self) -> None:
        """Three ranks."""
        path = self.write_input(FAILING)
        self.run_well(path, "-o", "one")
        with unittest.mock.patch.dict("os.environ", ENVIRONMENT):
            self.command = under(3)
            self.run_well(path, "--threads", "1", "-o", "ranks")
        self.assertEqual(self.results("one"), self.results("ranks"))

    def test_netcdf(self) -> None:
        """Bit for bit the numbers of the CSV."""
        path = self.write_input(
            FAILING.replace("&output columns", "&output format = 'netcdf' columns")
        )
        result = self.run_program(path)
        if "this build has no NetCDF" in result.stderr:
            self.skipTest("no NetCDF")
        self.run_well(self.write_input(FAILING))
        found = indices_of(read_table(self.folder / "output/map.statistics.nc"))
        expected = indices_of(read_table(self.folder / "output/map.statistics.csv"))
        self.assertEqual(list(found), list(expected))
        for name in found:
            self.assertEqual(found[name].tolist(), expected[name].tolist(), name)


class KilledTest(KilledCase):
    """A run that is killed inside a group is resumed to the same bytes."""

    start = SLOW.index("&sweep")
    text = (
        SLOW[:start]
        + """&sweep combine = 'saltelli'  cases = 1000
       parameter(1) = 'initial.psi_rate'  from(1) = 1  to(1) = 100
       parameter(2) = 'initial.phi_rate'  from(2) = 0  to(2) = 1
       parameter(3) = 'top.gravity'  from(3) = 9  to(3) = 10 /
&statistics columns = 'theta_max', 'theta_end'  indices = 'sobol' /
&output rows = 'none' /
"""
    )

    def results(self, folder: str, name: str = "map") -> list[bytes]:
        """The tables of the statistics in a folder."""
        return [(self.folder / folder / f"{name}.{ending}").read_bytes() for ending in RESULT]

    def test_killed_without_rows(self) -> None:
        self.check_killed(self.text, "map.statistics.csv")

    def test_killed_with_rows(self) -> None:
        rows = "columns = 'theta_max', 'theta_end'"
        self.check_killed(self.text.replace("rows = 'none'", rows), "map.csv")


class RefusedTest(IndicesCase):
    """Hostile input: what is wrong, and what would be right."""

    def refuse(self, text: str, *words: str) -> None:
        """The input is refused with these words."""
        result = self.run_program(self.write_input(text))
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertRegex(result.stderr, r"(?m)^\S.*map\.nml:\d+:\d+: error: ")
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse((self.folder / "output").exists())

    def test_design(self) -> None:
        """The message names the design and the number of cases that it needs."""
        for other in ("random", "sobol", "latin_hypercube"):
            self.refuse(
                KNOWN.replace("'saltelli'", f"'{other}'"),
                "Sobol' indices need the cases of Saltelli's design",
                "sweep.combine = 'saltelli'",
                "a multiple of 5",
            )
        self.refuse(SLOW.replace("bins = 20", "indices = 'sobol'"), "a multiple of 3")
        self.refuse(KNOWN.replace("cases = 10240", "cases = 10241"), "groups of 5 cases")
        self.refuse(VECTOR.replace("'saltelli'", "'random'"), "a multiple of 4")

    def test_words(self) -> None:
        """Words have no indices, and there is one kind of indices."""
        columns = "columns = 'theta_max', 'precession_period', 'initial.psi_rate', 'status'"
        self.assertIn(columns, KNOWN)
        self.refuse(KNOWN.replace(columns, "columns = 'status'"), "no column of numbers")
        self.refuse(KNOWN.replace(columns, ""), "there are no columns of which statistics")
        self.refuse(KNOWN.replace("indices = 'sobol'", "indices = 'morris'"), "one of: sobol")
        single = KNOWN.replace(KNOWN[KNOWN.index("&sweep") : KNOWN.index("&output")], "")
        single = single.replace("'sweep'", "'trajectory'")
        single = single[: single.index("&output")] + "&statistics indices = 'sobol' /\n"
        self.refuse(single, "a trajectory has no statistics")

    def test_check(self) -> None:
        """--check tells factors and groups, and its namelist is complete."""
        said = self.run_well("--check", self.write_input(KNOWN))
        self.assertIn("Sobol' indices of 3 factors from 2048 groups of 5 cases", said)
        self.assertIn("indices = 'sobol'", said[said.index("&study") :])
        again = self.write_input(said[said.index("&study") :], "again.nml")
        self.assertEqual(self.run_program("--check", again).returncode, 0)

    def test_damaged_parts(self) -> None:
        """A part of which the sums or an unfinished group were changed is refused."""
        path = self.write_input(VECTOR)
        for part in ("1/3", "2/3", "3/3"):
            self.run_well(path, "--shard", part)
        states = [f"output/map.{part}-of-3.statistics.state" for part in (1, 2, 3)]
        whole = (self.folder / states[1]).read_bytes()
        begin = whole.index(b"spintop statistics 2")
        for place in itertools.chain(range(begin, begin + 900, 97), range(-3000, -1, 331)):
            damage = bytearray(whole)
            damage[place] ^= 129
            (self.folder / states[1]).write_bytes(bytes(damage))
            result = self.run_program("merge", "output/all.statistics.csv", *states)
            self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
            self.assertFalse((self.folder / "output/all.indices.csv").exists())


class FigureTest(IndicesCase):
    """The dots of the indices."""

    kind = next(kind for kind in FIGURES if kind.name == "indices")

    def test_dots(self) -> None:
        """A dot for each index, with its interval, and the groups that were left out."""
        self.run_well(self.write_input(FAILING))
        table = read_table(self.folder / "output/map.statistics.csv")
        self.assertEqual(self.kind.refusal(table), "")
        figure = self.kind.draw(table)
        panels = figure.axes
        self.assertEqual(len(panels), 3)
        expected = indices_of(table)
        for column, axes in zip(expected["column"].unique(), panels, strict=True):
            rows = expected[expected["column"] == column]
            for label, index in (("first order", "first_order"), ("total", "total")):
                (dots,) = [line for line in axes.lines if line.get_label() == label]
                np.testing.assert_array_equal(dots.get_xdata(), rows[index])
            self.assertIn("groups left out", axes.get_title(loc="right"))
        (self.folder / "output/map.indices.csv").unlink()
        self.assertIn("has no map.indices.csv beside it", self.kind.refusal(table))

    def test_other_statistics(self) -> None:
        """Statistics without indices have no such figure, though an older table is there."""
        self.run_well(self.write_input(FAILING))
        self.run_well(self.write_input(FAILING.replace("indices = 'sobol'", "")))
        table = read_table(self.folder / "output/map.statistics.csv")
        self.assertIn("has no Sobol' indices", self.kind.refusal(table))


if __name__ == "__main__":
    unittest.main()
