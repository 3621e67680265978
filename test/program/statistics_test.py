"""Statistics of sweeps: their numbers, the same bytes however a run goes, hostile input."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

from mpi_test import ENVIRONMENT, MPI_PROGRAM, under
from program_test import PROGRAM, ProgramCase, Table
from spintop_figures.sweeps.statistics import distributions_of
from spintop_figures.tables.table import read_table

# Cases that fail (at a pole), cases without a period, two quantities that are binned.
MAP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial psi_rate = 3 /
&span t_end = 0.5 /
&integration formulation = 'lagrange', method = 'rk4', steps = 20 /
&sweep parameter(1) = 'initial.theta_deg', from(1) = 0, to(1) = 90, count(1) = 31
       parameter(2) = 'initial.phi_rate', values(2,:) = 1, -1, 0, 2
       parameter(3) = 'top.gravity', from(3) = 0, to(3) = 9.81, count(3) = 7 /
&output columns = 'theta_max', 'precession_period', 'motion_class', 'theta_end' /
&statistics columns = 'theta_max', 'precession_period', 'motion_class', 'status'
            over = 'initial.phi_rate', 'theta_end'  bins(2) = 3  from(2) = 0.1  to(2) = 1.5
            quantiles = 0, 0.1, 0.5, 1 quantiles_of = 'bins' /
"""
# A run of seconds, without rows.
SLOW = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 20 /
&span t_end = 2 /
&integration formulation = 'lagrange', method = 'rk4', steps = 2000 /
&sweep parameter(1) = 'initial.psi_rate', from(1) = 1, to(1) = 100, count(1) = 1000 /
&statistics columns = 'theta_max', 'theta_end', 'status'  over = 'initial.psi_rate'  bins = 20 /
&output rows = 'none' /
"""
ROWS = "rows = 'none'"
COLUMNS = MAP[MAP.index("columns = 'theta_max'") : MAP.index(" /\n&statistics")]
WITH_ROWS = "columns = 'theta_max', 'theta_end'"
RESULT = ("statistics.csv", "histogram.csv")


class StatisticsCase(ProgramCase):
    """Runs of sweeps with statistics."""

    def write_input(self, text: str, name: str = "map.nml") -> Path:
        """An input in the folder."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def run_well(self, *arguments: str | Path, codes: tuple[int, ...] = (0, 3)) -> str:
        """Run the program, and return all that it said."""
        result = self.run_program(*arguments)
        self.assertIn(result.returncode, codes, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def results(self, folder: str, name: str = "map") -> list[bytes]:
        """The tables of the statistics in a folder."""
        return [(self.folder / folder / f"{name}.{ending}").read_bytes() for ending in RESULT]


class NumbersTest(StatisticsCase):
    """The statistics are those of the rows."""

    def compare(self, table: Table, row: int, name: str, values: np.ndarray) -> None:
        """The cells of a column in a row against the values of its cases; NaN counts for none."""
        cell = {
            key: table.column(f"{name}_{key}")[row]
            for key in ("count", "mean", "deviation", "min", "max")
        }
        there = values[np.isfinite(values)]
        self.assertEqual(cell["count"], len(there))
        if not len(there):
            self.assertTrue(all(np.isnan(cell[key]) for key in ("mean", "deviation", "min", "max")))
            return
        self.assertAlmostEqual(cell["mean"] / np.mean(there), 1, delta=1e-14)
        self.assertEqual((cell["min"], cell["max"]), (there.min(), there.max()))
        for share in (0, 0.1, 0.5, 1):
            rank = max(int(np.ceil(share * len(there))), 1)
            expected = np.sort(there)[rank - 1]
            found = table.column(f"{name}_q{share}")[row]
            self.assertLessEqual(abs(found - expected), 2**-8 * abs(expected))
        if len(there) > 1:
            deviation = np.std(there, ddof=1)
            self.assertAlmostEqual(cell["deviation"], deviation, delta=1e-12 * np.mean(there))
        else:
            self.assertTrue(np.isnan(cell["deviation"]))

    def test_every_number(self) -> None:
        """Count, mean, deviation, extremes with cases, quantiles, words: of each bin and of all."""
        self.run_well(self.write_input(MAP))
        rows = Table(self.folder / "output/map.csv")
        found = Table(self.folder / "output/map.statistics.csv")
        case = np.array(rows.column("case"))
        good = np.array(rows.texts("status")) == "ok"
        self.assertTrue(good.any() and not good.all())
        ends = np.array(rows.column("theta_end"))
        rates = np.array(rows.column("initial.phi_rate"))
        values = {name: np.array(rows.column(name)) for name in ("theta_max", "precession_period")}
        self.assertTrue(np.isnan(values["precession_period"][good]).any())
        words = {name: np.array(rows.texts(name)) for name in ("motion_class", "status")}
        self.assertEqual(found.column("bin"), list(range(13)))
        for row in range(13):
            inside = np.ones(len(case), dtype=bool)
            if row:
                low, high = (found.column(f"theta_end_{end}")[row] for end in ("from", "to"))
                inside = (ends >= low) & ((ends < high) | ((high == 1.5) & (ends == high)))
                inside &= rates == found.column("initial.phi_rate")[row]
            self.assertEqual(found.column("cases")[row], inside.sum())
            self.assertEqual(found.column("failed")[row], (inside & ~good).sum())
            for name, column in values.items():
                counted = np.where(good, column, np.nan)
                self.compare(found, row, name, counted[inside])
                for key, extreme in (("min", np.nanmin), ("max", np.nanmax)):
                    number = found.column(f"{name}_{key}_case")[row]
                    if np.isfinite(counted[inside]).any():
                        first = case[inside][counted[inside] == extreme(counted[inside])][0]
                        self.assertEqual(number, first)
                    else:
                        self.assertEqual(number, 0)
            for name, column in words.items():
                for word in set(column):
                    self.assertEqual(
                        found.column(f"{name}_{word}")[row], (column[inside] == word).sum()
                    )

    def test_histograms(self) -> None:
        """The intervals reach from minimum to maximum, with the numbers of the rows in them."""
        self.run_well(self.write_input(MAP))
        rows = Table(self.folder / "output/map.csv")
        table = Table(self.folder / "output/map.histogram.csv")
        self.assertEqual(table.names, ["column", "from", "to", "cases"])
        good = np.array(rows.texts("status")) == "ok"
        for name in ("theta_max", "precession_period"):
            values = np.array(rows.column(name))
            values = values[np.isfinite(values) & good]
            mine = [
                (float(low), float(high), int(cases))
                for column, low, high, cases in table.rows
                if column == name
            ]
            self.assertEqual((mine[0][0], mine[-1][1]), (values.min(), values.max()))
            self.assertLessEqual(len(mine), 100)
            self.assertEqual(sum(cases for *_, cases in mine), len(values))
            for number, (low, high, cases) in enumerate(mine):
                last = number == len(mine) - 1
                inside = (values >= low) & ((values <= high) if last else (values < high))
                self.assertEqual(inside.sum(), cases)

    def test_bins_of_an_axis(self) -> None:
        """By default the bins are those of the axis: its values on a grid, or its interval."""
        text = MAP.replace(
            "'initial.phi_rate', 'theta_end'  bins(2) = 3  from(2) = 0.1  to(2) = 1.5",
            "'initial.theta_deg'",
        )
        self.run_well(self.write_input(text))
        found = Table(self.folder / "output/map.statistics.csv")
        np.testing.assert_allclose(found.column("initial.theta_deg")[1:], np.linspace(0, 90, 31))
        self.assertEqual(set(found.column("cases")[1:]), {28.0})
        drawn = text.replace("count(1) = 31", "").replace("count(3) = 7", "")
        drawn = drawn.replace("&sweep ", "&sweep combine = 'random', cases = 300 ")
        self.run_well(self.write_input(drawn))
        found = Table(self.folder / "output/map.statistics.csv")
        self.assertEqual(len(found.rows), 51)
        self.assertEqual(
            (found.column("initial.theta_deg_from")[1], found.column("initial.theta_deg_to")[50]),
            (0, 90),
        )
        self.assertEqual(sum(found.column("cases")[1:]), 300)

    def test_all_cases_without_bins(self) -> None:
        """One row where there is nothing to bin over."""
        text = MAP.replace(
            "over = 'initial.phi_rate', 'theta_end'  bins(2) = 3  from(2) = 0.1  to(2) = 1.5", ""
        )
        self.run_well(self.write_input(text.replace("quantiles_of = 'bins'", "")))
        found = Table(self.folder / "output/map.statistics.csv")
        self.assertEqual(found.column("cases"), [868])


class NetcdfTest(StatisticsCase):
    """The same numbers as NetCDF, with rows and without, as a whole and in parts."""

    def test_same_numbers(self) -> None:
        """Bit for bit those of the CSV."""
        path = self.write_input(MAP)
        bare = self.write_input(MAP.replace(COLUMNS, ROWS), "bare.nml")
        result = self.run_program(path, "--set", "output.format=netcdf")
        if "this build has no NetCDF" in result.stderr:
            self.skipTest("no NetCDF")
        self.run_well(path)
        self.run_well(bare, "--set", "output.format=netcdf")
        for part in ("1/2", "2/2"):
            self.run_well(bare, "--set", "output.format=netcdf", "--shard", part)
        states = [f"output/bare.{part}-of-2.statistics.state" for part in (1, 2)]
        self.run_well("merge", "output/merged.nc", *states)
        whole = (self.folder / "output/bare.statistics.nc").read_bytes()
        self.assertEqual((self.folder / "output/merged.nc").read_bytes(), whole)
        text = read_table(self.folder / "output/map.statistics.csv")
        histogram = read_table(self.folder / "output/map.histogram.csv").rows
        for name in ("map.statistics.nc", "bare.statistics.nc"):
            table = read_table(self.folder / "output" / name)
            self.assertEqual(table.kind, "statistics")
            self.assertEqual(set(table.rows), set(text.rows))
            for column in text.rows:
                found, expected = (each.rows[column].to_numpy(float) for each in (table, text))
                np.testing.assert_array_equal(found, expected, err_msg=column)
            for column, found in distributions_of(table).items():
                rows = histogram[histogram["column"] == column]
                np.testing.assert_array_equal(found.cases, rows["cases"])
                np.testing.assert_array_equal(found.low, rows["from"])
                np.testing.assert_array_equal(found.high, rows["to"])


class SameBytesTest(StatisticsCase):
    """However a sweep is divided."""

    def test_threads_rows_and_parts(self) -> None:
        """One and two threads, with rows and without, as a whole and in parts."""
        path = self.write_input(MAP)
        self.run_well(path, "--threads", "1", "-o", "one")
        self.run_well(path, "--threads", "2", "-o", "two")
        self.assertEqual(self.results("one"), self.results("two"))
        for part in ("1/3", "2/3", "3/3"):
            self.run_well(path, "--shard", part, "-o", "parts")
        tables = [f"parts/map.{part}-of-3.csv" for part in (2, 3, 1)]
        self.run_well("merge", "parts/map.csv", *tables)
        self.assertEqual(self.results("one"), self.results("parts"))
        (self.folder / "parts/map.2-of-3.statistics.state").unlink()
        result = self.run_program("merge", "parts/map.csv", *tables)
        self.assertEqual(result.returncode, 2)
        self.assertIn("map.2-of-3.statistics.state", result.stderr)

        bare = self.write_input(
            MAP.replace(COLUMNS, ROWS),
            "bare.nml",
        )
        self.run_well(bare, "-o", "one")
        numbers = [
            [line for line in text.splitlines() if not line.startswith(b"#")]
            for text in self.results("one")
        ]
        again = [
            [line for line in text.splitlines() if not line.startswith(b"#")]
            for text in self.results("one", "bare")
        ]
        self.assertEqual(numbers, again)
        self.assertFalse((self.folder / "one/bare.csv").exists())
        for part in ("2/2", "1/2"):
            self.run_well(bare, "--shard", part, "-o", "parts")
        states = ["parts/bare.1-of-2.statistics.state", "parts/bare.2-of-2.statistics.state"]
        said = self.run_well("merge", "parts/bare.statistics.csv", *states)
        self.assertIn("2 parts, 868 cases", said)
        self.assertEqual(self.results("one", "bare"), self.results("parts", "bare"))

    @unittest.skipUnless(shutil.which("mpirun") and Path(MPI_PROGRAM).is_file(), "no MPI")
    def test_ranks(self) -> None:
        """Three ranks, with rows and without."""
        path = self.write_input(MAP)
        bare = self.write_input(SLOW, "bare.nml")
        self.run_well(path, bare, "-o", "one")
        os.environ.update(ENVIRONMENT)
        self.command = under(3)
        self.run_well(path, bare, "--threads", "1", "-o", "ranks")
        self.assertEqual(self.results("one"), self.results("ranks"))
        self.assertEqual(self.results("one", "bare"), self.results("ranks", "bare"))

    def test_damaged_parts(self) -> None:
        """A part that is cut short, changed, twice there or missing is refused."""
        path = self.write_input(MAP.replace(COLUMNS, ROWS))
        for part in ("1/2", "2/2"):
            self.run_well(path, "--shard", part)
        states = [f"output/map.{part}-of-2.statistics.state" for part in (1, 2)]
        whole = (self.folder / states[1]).read_bytes()
        begin = whole.index(b"spintop statistics 2")
        damages = [whole[: begin + 30], whole[:-1], whole[:-40], whole[:begin]]
        for place in (
            begin + 25,
            begin + 60,
            begin + 200,
            len(whole) // 2 + begin // 2,
            len(whole) - 5,
        ):
            damages.append(whole[:place] + bytes([whole[place] ^ 64]) + whole[place + 1 :])
        for damage in damages:
            (self.folder / states[1]).write_bytes(damage)
            result = self.run_program("merge", "output/all.statistics.csv", *states)
            self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
            self.assertIn("map.2-of-2.statistics.state", result.stderr)
            self.assertFalse((self.folder / "output/all.statistics.csv").exists())
        (self.folder / states[1]).write_bytes(whole)
        for parts in ([states[0]], [states[0], states[0]]):
            self.assertEqual(
                self.run_program("merge", "output/all.statistics.csv", *parts).returncode, 2
            )
        self.run_well("merge", "output/all.statistics.csv", *states)


class KilledCase(StatisticsCase):
    """Runs that are killed."""

    def journalled(self, journal: Path) -> int:
        """Rows that a journal has; -1 if there is none."""
        try:
            lines = journal.read_text(encoding="ascii").splitlines()
        except FileNotFoundError:
            return -1
        return next(sum(map(int, line.split()[1:])) for line in lines if line.startswith("rows: "))

    def check_killed(self, text: str, table: str) -> None:
        """Kill a run at several points; resumed, it has the bytes of one that nothing stopped."""
        path = self.write_input(text)
        self.run_well(path, "-o", "whole")
        journal = self.folder / f"output/{table}.journal"
        kept, kills = 0, 0
        for _ in range(6):
            run = self.start_run(path)
            deadline = time.monotonic() + 120
            while run.poll() is None and self.journalled(journal) <= kept:
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.005)
            if run.poll() is None:
                run.send_signal(signal.SIGKILL)
                kills += 1
            run.wait()
            if (self.folder / "output/map.statistics.csv").exists():
                break
            before, kept = kept, max(self.journalled(journal), 0)
            self.assertGreaterEqual(kept, before)
        self.assertGreater(kills, 0)
        self.run_well(path, "--resume", "--threads", "1")
        self.assertEqual(self.results("output"), self.results("whole"))
        left = {p.name for p in (self.folder / "output").iterdir()}
        self.assertEqual(left, {p.name for p in (self.folder / "whole").iterdir()})

    def start_run(self, path: Path) -> subprocess.Popen:
        """Start a run that resumes, and do not wait for it."""
        run = subprocess.Popen(
            [PROGRAM, path, "--resume", "--threads", "1"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        return run


class ResumeTest(KilledCase):
    """Runs that are killed, and resumed to the same bytes."""

    def test_killed_without_rows(self) -> None:
        """The journal says what is done, though no row is written."""
        self.check_killed(SLOW, "map.statistics.csv")

    def test_killed_with_rows(self) -> None:
        """Rows and statistics end with the same case."""
        self.check_killed(SLOW.replace(ROWS, WITH_ROWS), "map.csv")

    def test_damaged_snapshot(self) -> None:
        """A run is not resumed from statistics that were changed, and says how to begin anew."""
        path = self.write_input(SLOW)
        run = self.start_run(path)
        journal = self.folder / "output/map.statistics.csv.journal"
        while self.journalled(journal) <= 0:
            self.assertIsNone(run.poll())
            time.sleep(0.005)
        run.kill()
        run.wait()
        states = list((self.folder / "output").glob("*.state?"))
        self.assertTrue(states)
        for state in states:
            content = bytearray(state.read_bytes())
            content[-30] ^= 1
            state.write_bytes(bytes(content))
        result = self.run_program(path, "--resume")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--restart discards it", result.stderr)
        result = self.run_program(path)
        self.assertEqual(result.returncode, 2)
        self.assertIn("an interrupted run of output/map.statistics.csv is there", result.stderr)
        self.run_well(path, "--restart")
        self.assertFalse(list((self.folder / "output").glob("*.state?")))

    def test_nothing_left_to_compute(self) -> None:
        """A complete run is not computed again."""
        path = self.write_input(MAP)
        self.run_well(path)
        self.assertIn("the table is already complete", self.run_well(path, "--resume"))
        bare = self.write_input(SLOW.replace("count(1) = 1000", "count(1) = 20"), "bare.nml")
        self.run_well(bare)
        self.assertIn("the table is already complete", self.run_well(bare, "--resume"))


class RefusalTest(StatisticsCase):
    """Hostile input: what is wrong, where, and what would be right."""

    def refuse(self, old: str, new: str, *words: str, text: str = MAP) -> None:
        """The input with this change is refused with these words."""
        self.assertIn(old, text)
        result = self.run_program(self.write_input(text.replace(old, new)))
        self.assertEqual(result.returncode, 2, new)
        self.assertRegex(result.stderr, r"^\S.*map\.nml:\d+:\d+: error: ", new)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse((self.folder / "output").exists())

    def test_columns(self) -> None:
        """Of which there are statistics."""
        columns = "columns = 'theta_max', 'precession_period', 'motion_class', 'status'"
        self.refuse(
            columns, "columns = 'theta_mx'", "there is no column 'theta_mx'", "'theta_max'?"
        )
        self.refuse(columns, "columns = 'theta_max', 'theta_max'", "named twice")
        self.refuse(
            columns, "columns = 'com_z_min'", "the table has no column", "add it to output.columns"
        )
        self.refuse(columns, "columns = 'top.mass'", "top.mass is not swept")
        self.refuse(columns, "columns = 'notes'", "has no statistics")
        self.refuse(columns, "", "there are no columns of which statistics are computed")

    def test_bins(self) -> None:
        """Their quantities and ranges."""
        over = "'initial.phi_rate', 'theta_end'"
        self.refuse(over, "'initial.phi_rate', 'motion_class'", "has words, and no numbers")
        self.refuse(over, "'initial.phi_rate', 'initial.phi'", "is not swept")
        self.refuse(
            over, "'theta_end', 'theta_end' from(1) = 0 to(1) = 1", "both quantities are the same"
        )
        self.refuse("from(2) = 0.1", "", "is not known before it is computed", "statistics.from(2)")
        self.refuse("to(2) = 1.5", "to(2) = 0.1", "not above 0.1", "give from < to")
        self.refuse(
            "from(2) = 0.1", "from(2) = -1 spacing(2) = 'log'", "needs positive ends, not -1"
        )
        self.refuse("bins(2) = 3", "bins(2) = 0", "must be >= 1")
        self.refuse("bins(2) = 3", "bins(2) = 2000000000", "more memory than this machine has")
        self.refuse(
            "bins(2) = 3",
            "bins(2) = 5000000 bins(1) = 1000",
            "more than this machine has",
            "use fewer bins",
        )
        self.refuse("from(2) = 0.1", "from(2) = 1.4999999999999998", "narrower than the spacing")
        self.refuse(
            "from(2) = 0.1  to(2) = 1.5", "from(2) = -1.7e308  to(2) = 1.7e308", "too far apart"
        )
        self.refuse(
            "over = 'initial.phi_rate', 'theta_end'", "", "described, but not what they are over"
        )

    def test_quantiles(self) -> None:
        """In [0, 1], increasing, and of bins only where there are some."""
        quantiles = "quantiles = 0, 0.1, 0.5, 1"
        self.refuse(quantiles, "quantiles = 0.5, 1.5", "must be in [0, 1]")
        self.refuse(quantiles, "quantiles = 0.5, 0.5", "do not increase")
        bins = "over = 'initial.phi_rate', 'theta_end'  bins(2) = 3  from(2) = 0.1  to(2) = 1.5"
        self.refuse(bins, "", "there are no bins")
        self.refuse("'bins' /", "'some' /", "all", "bins")

    def test_rows(self) -> None:
        """They are left out only where something else is written; only sweeps have statistics."""
        none = "&output rows = 'none' /"
        self.refuse(
            "&output columns", "&output rows = 'none' columns", "there are no rows to have columns"
        )
        self.refuse(SLOW[SLOW.index("&statistics") :], none, "nothing would be written", text=SLOW)
        self.refuse("rows = 'none'", "rows = 'some'", "all", "none", text=SLOW)
        start = SLOW.index("&sweep")
        single = SLOW.replace(SLOW[start : SLOW.index("&statistics")], "").replace(
            "'sweep'", "'trajectory'"
        )
        self.refuse(none, "", "a trajectory has no statistics", "study.kind = 'sweep'", text=single)
        self.refuse(
            single[single.index("&statistics") :],
            none,
            "a trajectory always has its rows",
            text=single,
        )

    def test_check(self) -> None:
        """--check tells bins and memory, and its namelist is complete."""
        path = self.write_input(MAP)
        said = self.run_well("--check", path)
        self.assertIn("statistics 12 bins, 4 columns, about ", said)
        self.assertIn("MB of memory", said)
        self.assertIn("initial.phi_rate: 4 bins from -1.5 to 2.5", said)
        self.assertIn("output/map.csv, its statistics -> output/map.statistics.csv", said)
        again = self.write_input(said[said.index("&study") :], "again.nml")
        self.assertEqual(self.run_program("--check", again).returncode, 0)


if __name__ == "__main__":
    unittest.main()


class ForecastTest(StatisticsCase):
    """What --check says of the tables of statistics."""

    def test_bytes_of_the_tables(self) -> None:
        """At most, and no more than some times what is then written: map, histograms, indices."""
        bare = MAP.replace(COLUMNS, ROWS).replace("quantiles_of = 'bins'", "")
        mapped = bare.replace("bins(2) = 3", "bins(2) = 60")
        for name, text in (("bare", bare), ("mapped", mapped)):
            path = self.write_input(text, f"{name}.nml")
            said = self.run_well("--check", path)
            self.assertNotIn("bytes per case", said)
            found = re.search(r"! +statistics +about (\S+) (k?M?)B at most\n", said)
            self.assertTrue(found, said)
            forecast = float(found[1]) * {"": 1, "k": 1e3, "M": 1e6}[found[2]]
            self.run_well(path)
            parts = self.folder.glob(f"output/{name}.*.csv")
            written = sum(part.stat().st_size for part in parts)
            self.assertLess(written, 1.5 * forecast)
            self.assertLess(forecast, 4 * written)
