"""Damaged files: a message with the place, no traceback, and no control bytes for a terminal."""

import os
import sys
import unittest
import unittest.mock
from pathlib import Path

from netCDF4 import Dataset

from conftest import EXE, execute
from plot_case import SCRIPTS, TableCase, a_stability, a_sweep, a_trajectory, some_events
from reporting.study import read_study
from spintop_figures.moving.body import read_body
from spintop_figures.tables.table import TableError, printable, read_table

RED = "\x1b[31m"
"""Turns a terminal red; it stands for all bytes that must not reach one."""

MOTION = """\
&study  kind = 'sweep' /
&top  mass = 1.0  inertia = 0.9, 0.9, 0.3  length = 0.5 /
&initial  theta = 0.5 /
&span  t_end = 0.1 /
&sweep  table = 'cases.csv' /
"""


class DamagedFilesTest(TableCase):
    def check_words(self, words: str) -> None:
        self.assertNotIn("Traceback", words)
        self.assertTrue(words.replace("\n", "").isprintable(), repr(words[:500]))

    def test_cells(self) -> None:
        """Cells that are no numbers, also where all of a column are none."""
        lines = a_trajectory(["t", "theta"], count=2).splitlines()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        for cell in ("", "x", "True", "1_0", "0x1p3", RED, "\u0663", "1e", "--1"):
            for rows in ((1,), (1, 2)):
                damaged = list(lines)
                for row in rows:
                    damaged[first + row] = damaged[first + row].split(",")[0] + f",{cell}"
                text = "\n".join(damaged) + "\n"
                with self.subTest(cell=cell, rows=rows), self.assertRaises(TableError) as caught:
                    read_table(self.put("a.csv", text))
                message = str(caught.exception)
                self.assertIn(f"line {first + 2}: ", message)
                self.assertIn("in theta is no number", message)
                self.check_words(message)

    def test_quotes(self) -> None:
        """A cell may have quotes around it, as spreadsheets write it, but around all of it."""
        lines = a_trajectory(["t", "theta"], count=2).splitlines()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        time = lines[first + 1].split(",")[0]
        for cell in ('"1"', '"1', '1"', '"1"2'):
            text = "\n".join([*lines[: first + 1], f"{time},{cell}", *lines[first + 2 :]]) + "\n"
            path = self.put("a.csv", text)
            with self.subTest(cell=cell):
                if cell == '"1"':
                    self.assertEqual(read_table(path).rows["theta"][0], 1)
                    continue
                with self.assertRaisesRegex(TableError, f"line {first + 2}"):
                    read_table(path)

    def test_comments_count(self) -> None:
        text = a_trajectory(["t", "theta"], count=3)
        lines = text.splitlines()
        lines[-2:-2] = ["# a remark", "", "0.5,bad"]
        with self.assertRaisesRegex(TableError, f"line {len(lines) - 2}: 'bad' in theta"):
            read_table(self.put("a.csv", "\n".join(lines) + "\n"))

    def test_names(self) -> None:
        good = a_trajectory(["t", "theta", "psi"], count=2)
        with self.assertRaisesRegex(TableError, r"line \d+: there are two columns theta"):
            read_table(self.put("a.csv", good.replace("theta,psi", "theta,theta")))
        with self.assertRaisesRegex(TableError, r"line \d+: column 2 has no name"):
            read_table(self.put("a.csv", good.replace("theta,psi", ",psi")))

    def test_numbers_of_any_length(self) -> None:
        """An integer that fits no machine word is a number."""
        text = a_trajectory(["t", "theta"], count=2, theta=10**30)
        self.assertEqual(read_table(self.put("a.csv", text)).rows["theta"][1], 1e30)

    def test_bytes(self) -> None:
        """A zero byte is reported with its line; other bytes are shown as printable text."""
        good = a_trajectory(["t", "theta"], count=2)
        with self.assertRaisesRegex(TableError, r"line \d+ has a byte of value 0"):
            read_table(self.put("a.csv", good.replace("theta\n", "the\0ta\n")))
        table = read_table(self.put("a.csv", good.replace("title: A top", f"title: {RED}A top")))
        self.assertTrue(table.title.isprintable())
        self.assertTrue(table.title.startswith(r"\x1b[31mA top"))
        table = read_table(self.put("a.csv", a_stability().replace("t: a pole", f"{RED}pole")))
        self.assertIn(r"\x1b[31mpole", list(table.rows["reason"]))

    def test_netcdf(self) -> None:
        """Files that are no NetCDF, or are cut anywhere."""
        start = b"CDF\x02" + bytes(4)
        for data in (b"", b"CDF", b"CDF\x01" + bytes(20), start, start + b"\xff" * 60, bytes(100)):
            with self.subTest(data), self.assertRaises(TableError) as caught:
                read_table(self.put("a.nc", data))
            self.check_words(str(caught.exception))
        with self.assertRaisesRegex(TableError, "no table of spintop"):
            read_table(self.put("a.nc", start + bytes(24)))

    def test_small_netcdf(self) -> None:
        """A file of any size is read; one that is cut anywhere is refused, or has no rows."""
        path = self.folder / "a.nc"
        for size in (1, 1000, 5000):
            with Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
                file.program, file.format, file.options = "spintop 0.1.0", "1", "x" * size
                file.createDimension("row", 2)
                column = file.createVariable("theta", "f8", ("row",))
                column.column = "theta"
                column[:] = [1, 2]
            with self.subTest(size=size):
                self.assertEqual(list(read_table(path).rows["theta"]), [1, 2])
                data = path.read_bytes()
                for end in range(0, len(data) - 16, 31):
                    with self.assertRaises(TableError) as caught:
                        read_table(self.put("cut.nc", data[:end]))
                    self.check_words(str(caught.exception))

    def test_every_cut(self) -> None:
        """A table that is cut anywhere is refused, or is a table still."""
        for text in (a_trajectory(count=2), a_sweep(cases=2), a_stability(), some_events(2)):
            data = text.encode()
            for end in range(0, len(data), 31):
                path = self.put("a.csv", data[:end] + b"\n")
                try:
                    read_table(path)
                except TableError as error:
                    self.check_words(str(error))

    def test_plot(self) -> None:
        """The contents of a table do not reach the terminal unchanged."""
        cases = {
            a_trajectory().replace("9.0,", f"{RED},", 1): "is no number",
            a_trajectory(phi=1e308): "has numbers beyond 1e+150 in column phi: no angles figure",
            a_trajectory().replace("# status: ok", f"# status: {RED}"): "",
            f"# program: {RED}": "no table of spintop",
        }
        for text, message in cases.items():
            with self.subTest(message):
                path = self.put(f"{RED}.csv", text)
                words = self.call("--figure", "angles", path, code=2 if message else 0)
                self.check_words(words)
                self.assertIn(message, words)

    def test_undrawable(self) -> None:
        path = self.put("a.csv", a_trajectory())
        fault = ValueError(f"{RED}no\nx")
        with unittest.mock.patch("spintop_figures.files.save_as", side_effect=fault):
            words = self.call("--figure", "angles", path, code=2)
        self.check_words(words)
        self.assertIn("a.csv: the angles figure cannot be drawn: ", words)

    def test_names_of_files(self) -> None:
        name = os.fsdecode(b"caf\xe9.csv")
        path = self.put(name, a_trajectory(["t", "R1", "R2", "R3", "R4"]))
        words = (sys.executable, SCRIPTS / "plot", path, self.folder / "no\udcff.csv")
        ascii_ = {"LC_ALL": "C", "PYTHONIOENCODING": "ascii"}
        told = {"encoding": "ascii", "errors": "surrogateescape"}
        run = execute(*words, code=2, environment=ascii_, **told)
        self.check_words(run.stderr)
        self.assertIn(r"no\xff.csv: no such file", run.stderr)
        made = {entry for entry in os.listdir(os.fsencode(self.folder)) if entry.endswith(b".svg")}
        self.assertEqual(made, {b"caf\xe9_residuals.svg"})

    def test_report(self) -> None:
        self.put(os.fsdecode(b"caf\xe9.csv"), a_sweep())
        self.put("huge.csv", a_trajectory(phi=1e308))
        self.put(f"{RED}.csv", "nothing")

        def no_pictures(_: object, problems: list[str]) -> list:
            problems.append("it cannot be drawn")
            return []

        with unittest.mock.patch("reporting.study.pictures_of", side_effect=no_pictures):
            sections, problems = read_study(self.folder)
        self.assertEqual([section.name for section in sections], [r"caf\xe9.csv", "huge.csv"])
        self.assertTrue(any("cannot be drawn" in problem for problem in problems), problems)
        for problem in problems:
            self.check_words(problem)

    def test_damaged_bodies(self) -> None:
        line = "# body: mass {} kg; inertia {} kg m^2 about the pivot; centre of mass 0, 0, 2 m\n"
        bad = [("1", "1, 1"), ("1", "1, inf, 1"), *((m, "1, 1, 1") for m in ("x", "nan", "1e308"))]
        for mass, inertia in bad:
            text = line.format(mass, inertia) + a_trajectory()
            self.assertIsNone(read_body(read_table(self.put("a.csv", text))))

    def test_printable(self) -> None:
        self.assertEqual(printable("a\x1b\x9b\u202eé\udcff\n"), r"a\x1b\x9b\u202eé\xff\n")

    def check_run(self, code: int, *arguments: str | Path) -> str:
        run = execute(EXE, *arguments, code=code, cwd=self.folder, errors="surrogateescape")
        self.check_words(run.stdout)
        self.check_words(run.stderr)
        return run.stderr

    def test_merge(self) -> None:
        """Heads of parts are quoted; a line of any length is not quoted whole."""
        for number, title in ((1, "a"), (2, RED + "b" * 100_000)):
            head = f"# part {number} of 2: cases {number} to {number} of 2\n# title: {title}\n"
            self.put(f"p{number}.csv", f"{head}case,status\n{number},ok\n")
        words = self.check_run(2, "merge", "all.csv", "p1.csv", "p2.csv")
        self.assertIn("p2.csv", words)
        self.assertLess(len(words), 1000)
        self.put("p3.csv", f"{RED}\n")
        self.check_run(2, "merge", "all.csv", "p3.csv")

    def test_names_of_program(self) -> None:
        self.check_run(2, f"{RED}.nml")
        self.check_run(2, f"--{RED}")
        self.check_run(2, "list", RED)
        path = self.put(f"{RED}.nml", f"&top {RED} = 1 /\n")
        self.assertIn(":1:6: error:", self.check_run(2, path.name))
        self.check_run(2, "--set", f"top.mass={RED}", path.name)

    def test_tables_of_cases(self) -> None:
        self.put("a.nml", MOTION)
        for text in (f"{RED}\n1", f"top.mass\n{RED}", "top.mass\n1\0", "\0", "top.mass\n\xff"):
            self.put("cases.csv", f"{text}\n")
            self.assertIn("cases.csv:", self.check_run(2, "a.nml"))
