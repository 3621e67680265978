"""Tests of scripts/plot under settings of others, and on tables that another program has saved.

Whatever is wrong is told in a line that names the cause; nothing ends in a traceback.
"""

import os

from plot_case import TableCase, a_sweep, a_trajectory
from spintop_figures.moving.data import lines_of
from spintop_figures.tables.table import TableError, read_table

NO_BREAK = ("\N{NO-BREAK SPACE}", "\N{NARROW NO-BREAK SPACE}", "\N{FIGURE SPACE}")
KINDS = {"trajectory": a_trajectory(), "sweep": a_sweep()}


class PlotConditionsTest(TableCase):
    def draw(self, name: str = "a.csv", **environment: str) -> None:
        """A figure is drawn, and its files are named."""
        path = self.put(name, a_trajectory())
        done = self.plot("--figure", "angles", path, **environment)
        assert (done.returncode, done.stderr) == (0, "")
        names = [f"{path.with_suffix('')}_angles.{ending}" for ending in ("png", "svg")]
        assert os.fsencode(done.stdout).splitlines() == list(map(os.fsencode, names))

    def test_backend(self) -> None:
        """The backend of a notebook, or one that does not exist."""
        self.draw(MPLBACKEND="module://matplotlib_inline.backend_inline")
        self.draw(MPLBACKEND="nothing")

    def test_latex(self) -> None:
        """LaTeX is asked for, and is not there, or fails."""
        (self.folder / "matplotlibrc").write_text("text.usetex: True\n", encoding="utf-8")
        programs = self.folder / "programs"
        programs.mkdir()
        settings = {"MATPLOTLIBRC": str(self.folder), "PATH": str(programs)}
        self.draw(**settings)
        for name in ("latex", "dvipng"):
            (programs / name).write_text("#!/bin/sh\necho wrong; exit 1\n", encoding="utf-8")
            (programs / name).chmod(0o755)
        path = self.put("b.csv", a_trajectory())
        cache = {"MPLCONFIGDIR": str(self.folder / "cache"), "PATH": f"{programs}:/usr/bin:/bin"}
        done = self.plot("--figure", "angles", path, **(settings | cache))
        assert done.returncode == 2
        self.assertRegex(done.stderr, r"angles figure cannot be drawn: latex was not able")
        assert "Traceback" not in done.stderr

    def test_broken_settings(self) -> None:
        """Settings that cannot be read."""
        (self.folder / "matplotlibrc").write_bytes(b"font.size: \xff\xfe\n")
        path = self.put("a.csv", a_trajectory())
        done = self.plot(path, MATPLOTLIBRC=str(self.folder))
        assert (done.returncode, done.stdout) == (1, "")
        assert "scripts/plot: matplotlib cannot be loaded" in done.stderr
        assert "Traceback" not in done.stderr

    def test_encoding(self) -> None:
        """Names that the encoding of the output does not have."""
        for encoding in ("ascii", "ascii:strict", "latin-1:strict"):
            self.draw("Kreisel für Łódź.csv", PYTHONIOENCODING=encoding)

    def complaint(self, text: str | bytes) -> str:
        """What is said of a table."""
        path = self.folder / "a.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        code, said = self.call("-o", self.folder, path)
        assert code == 2
        assert said.count("\n") == 1, said
        with self.assertRaises(TableError):
            read_table(path)
        return said

    def test_taken(self) -> None:
        """A mark of UTF-8 and other ends of lines change nothing."""
        for kind, text in KINDS.items():
            first = read_table(self.put("first.csv", text))
            ends = {end: text.replace("\n", end) for end in ("\r\n", "\r", "\n")}
            for name, changed in {**ends, "mark": f"\ufeff{text}"}.items():
                with self.subTest(kind, change=name):
                    path = self.folder / "again.csv"
                    path.write_bytes(changed.encode())
                    again = read_table(path)
                    assert again.header == first.header
                    assert again.rows.equals(first.rows)
                    assert lines_of(again) == lines_of(first)

    def test_encodings(self) -> None:
        """Other encodings are named."""
        for kind, text in KINDS.items():
            for encoding in ("utf-16", "utf-16-be", "utf-32"):
                with self.subTest(kind, encoding=encoding):
                    mark = "\ufeff" if encoding.endswith("be") else ""
                    said = self.complaint((mark + text).encode(encoding))
                    assert "is no text in UTF-8" in said

    def test_separators(self) -> None:
        """Semicolons, also with decimal commas, and tabs."""
        for kind, text in KINDS.items():
            lines = text.split("\n")
            rows = "\n".join(
                line if line.startswith("#") else line.replace(",", ";").replace(".", ",")
                for line in lines
            )
            for changed in (text.replace(",", ";"), rows, text.replace(",", "\t")):
                with self.subTest(kind):
                    assert "has a space or a separator in its name" in self.complaint(changed)

    def test_header(self) -> None:
        """Quotes around its lines, and lines before it."""
        for kind, text in KINDS.items():
            with self.subTest(kind):
                quoted = "\n".join(
                    f'"{line}";;' if line.startswith("#") else line for line in text.split("\n")
                )
                assert "its header names no program" in self.complaint(quoted)
                assert self.read(f"\n{text}").rows.size

    def test_spaces(self) -> None:
        """No-break spaces in the header, in a name and in a number; spaces around names."""
        for kind, text in KINDS.items():
            name = {"trajectory": ",theta,", "sweep": ",delta_u,"}[kind]
            for space in NO_BREAK:
                with self.subTest(kind, space=space):
                    said = self.complaint(text.replace("# ", f"#{space}"))
                    assert "its header names no program" in said
                    said = self.complaint(text.replace(name, f",{name[1:-1]}{space},"))
                    self.assertRegex(said, r"column \d+ has a space or a separator in its name")
                    said = self.complaint(text.replace(",0.5,", f",0{space}.5,"))
                    self.assertRegex(said, r"line \d+: .* is no number")
            said = self.complaint(text.replace(name, f", {name[1:]}"))
            self.assertRegex(said, r"column \d+ has a space or a separator in its name")
