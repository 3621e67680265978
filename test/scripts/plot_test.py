"""Tests of scripts/plot: reading tables, choosing figures, drawing them, complaining."""

import math
from dataclasses import replace

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from plot_case import (
    HEAD,
    SCRIPTS,
    TRAJECTORY,
    TRIALS,
    TableCase,
    a_stability,
    a_sweep,
    a_table,
    a_trajectory,
    some_events,
)
from spintop_figures.style.provenance import describe_run
from spintop_figures.style.saving import lay_out
from spintop_figures.sweeps.table1 import (
    COLUMNS,
    RIGHT_EDGES,
    as_column,
    as_text,
    draw_table1,
    notes_on,
)
from spintop_figures.tables.table import TableError, read_table


class PlotTest(TableCase):
    def test_head(self) -> None:
        """Key lines, settings over several lines, quotes in quotes, units."""
        table = self.read(a_trajectory())
        assert table.title == "A top, trajectory: $5"
        assert table.header["revision"] == "0123456789ab-dirty"
        assert table.setting("study.title") == "It's a top, = trajectory"
        assert table.settings["sweep.values(1,:)"] == ["0.5", "1.0", "2.0"]
        assert table.units == {"t": "s", "force_x": "kg m/s^2"}
        assert table.meanings["force_x"] == "support force: x"
        assert table.status == "ok"
        assert table.rows["phi"][3] == 0.1 * 3
        assert describe_run(table) == "Lagrange, RK4, 992 steps"

    def test_numbers_keep_their_bits(self) -> None:
        """Numbers of 17 digits, huge ones and what is none are read as they were written."""
        for value in (0.1 + 0.2, 1e100, 5e-324, -0.0, math.inf, math.pi):
            table = self.read(a_trajectory(count=1, R1=value))
            assert table.rows["R1"][0].hex() == value.hex()
        table = self.read(a_trajectory(count=1, R1=math.nan))
        assert math.isnan(table.rows["R1"][0])

    def test_bad_tables(self) -> None:
        """An error has a message, with the line if there is one."""
        good = a_trajectory()
        bad = {
            "": "no table of spintop",
            "a,b\n1,2\n": "no table of spintop",
            "\0\1\2\n": "no table of spintop",
            HEAD.format(kind="trajectory")
            + "t\n# status: pole at t = 0\n": "no rows.*pole at t = 0",
            HEAD.format(kind="sweep"): "names no columns",
            good.removesuffix("# status: ok\n"): "the status, is missing",
            good[:-200] + "\n# status: ok\n": r"line [67]\d has \d+ cells in place of 18",
            good[:-100]: "its last line has no end",
            good.replace("9.0,", "9.0x,", 1): "line 3[345]: '9.0x' in psi is no number",
            good.replace("# format: 1", "# format: 7"): "a table of format 7, and figures are",
            good.replace("# format: 1\n", ""): r"a table of format 0 \(spintop 0.1.0\)",
        }
        for text, message in bad.items():
            with self.subTest(message), self.assertRaisesRegex(TableError, message):
                read_table(self.put("bad.csv", text))
        with self.assertRaisesRegex(TableError, "no such file"):
            read_table(self.folder / "missing.csv")
        with self.assertRaisesRegex(TableError, "is a directory"):
            read_table(self.folder)

    def test_trajectory(self) -> None:
        """Its columns, and numbers in them, bring the figures."""
        assert self.figures_of(a_trajectory()) == "angles forces trace path error residuals"
        assert self.figures_of(a_trajectory(TRAJECTORY[:7])) == "angles trace path"
        assert self.figures_of(a_trajectory(["t", "phi"])) == ""
        without = a_trajectory(orientation_error=math.nan, R1=math.nan)
        assert self.figures_of(without) == "angles forces trace path"
        assert "error" not in self.figures_of(a_trajectory(orientation_error=0.0))

    def test_sweep(self) -> None:
        """A page for the spin ratio, curves for any one parameter."""
        assert self.figures_of(a_sweep()) == "sweep table1"
        assert self.figures_of(a_sweep("top.inertia(2)")) == "sweep"
        assert self.figures_of(a_sweep(cases=61)) == "sweep"
        assert self.figures_of(a_sweep("top.mass,top.length").replace(",ok", ",1,ok")) == ""
        assert self.figures_of(a_sweep(cases=1, status="pole")) == "table1"
        assert self.figures_of(a_sweep().replace("1.5", "nan")) == "sweep table1"

    def test_numbers(self) -> None:
        """Five digits in one notation; powers of ten at the ends; a dash for what is not there."""
        values = {428.0976: "428.10", 1.0: "1.0000", 0.00272092: "0.0027209", 0.0: "0"}
        for value, text in values.items():
            assert as_text(value) == text
        assert as_text(math.nan) == "\N{EN DASH}"
        assert as_column(np.array([9.3984e-5, 340.11])) == ["0.000093984", "340.11"]
        powers = [
            "1.0000\N{MULTIPLICATION SIGN}10⁻⁹",
            "\N{MINUS SIGN}2.0000\N{MULTIPLICATION SIGN}10⁰",
        ]
        assert as_column(np.array([1e-9, -2.0])) == powers

    def test_decimal_points(self) -> None:
        """The decimal points of a column stand below each other."""
        table = self.read(a_sweep())
        rows = table.rows.assign(delta_u=[1234.5, 0.00012345, 9.5, 77.0])
        figure = draw_table1(replace(table, rows=rows))
        lay_out(figure)
        renderer = FigureCanvasAgg(figure).get_renderer()
        right = RIGHT_EDGES[next(c for c in COLUMNS if c.column == "delta_u")]
        cells = ("1234.5", "0.00012345", "9.5000", "77.000")
        points = []
        for text in figure.axes[0].texts:
            if text.get_text() in cells and right - 0.9 < text.get_position()[0] <= right:
                behind = text.get_text().partition(".")[2]
                width = figure.text(0, 0, f".{behind}").get_window_extent(renderer).width
                points.append(text.get_window_extent(renderer).x1 - width)
        assert len(points) == 4
        assert np.ptp(points) < 2  # pixels

    def test_title(self) -> None:
        """The title names the source of the inertia."""
        table = self.read(a_sweep())
        wheel = {"top.shape": ["spinning_wheel"]}
        authors = {"top.shape": ["inertia"], "top.mass": ["2.45"], "top.length": ["1"]}
        authors |= {"top.inertia": ["0.00614", "0.00614", "0.0122"], "top.inertia_about": ["pivot"]}
        titles = [
            draw_table1(replace(table, settings=table.settings | settings)).get_suptitle()
            for settings in (wheel, authors, authors | {"top.inertia": ["3"]})
        ]
        assert "of the wheel about the pivot" in titles[0]
        assert "of the paper's author (without m l²)" in titles[1]
        assert "of the input" in titles[2]

    def test_failures_are_marked(self) -> None:
        """A case that failed has a note with its status and the reason."""
        text = a_sweep(status="step_limit").replace("nan,\n", "nan,no more steps\n")
        table = self.read(text)
        assert notes_on(table.rows) == ["* \u03bb = 2: too many steps: no more steps"]

    def test_trajectory_beside_its_table(self) -> None:
        """All figures, in a locale with decimal commas, of a run that overflowed."""
        wild = a_trajectory(count=20).splitlines()
        wild[-2] = wild[-2].replace("1.0,1.0,1.0", "1e+300,-inf,1e+100")
        table = self.put(
            "two words.csv", "\n".join([*wild[:-1], "# status: non_finite at t = 1", ""])
        )
        result = self.plot(table, LC_ALL="de_DE.UTF-8")
        assert (result.returncode, result.stderr) == (0, "")
        names = ("residuals", "angles", "forces", "path", "error", "trace")
        self.check_pictures(self.folder, {f"two words_{name}" for name in names})
        assert len(result.stdout.splitlines()) == 12
        assert not list(SCRIPTS.rglob("__pycache__"))

    def test_sweep_in_folder_beside_bad_tables(self) -> None:
        """Figures that are possible are drawn; each other one has a line of text."""
        good = self.put("good.csv", a_sweep(status="step_limit"))
        empty = self.put("empty.csv", HEAD.format(kind="sweep") + "case\n")
        output = self.folder / "a new" / "folder"
        code, complaints = self.call("-o", output, self.folder / "missing.csv", empty, good)
        assert code == 2
        assert complaints.splitlines() == [
            f"scripts/plot: {self.folder / 'missing.csv'}: no such file or directory",
            f"scripts/plot: {empty}: has no rows",
        ]
        self.check_pictures(output, {"good_sweep", "good_table1"})

    def test_refusals(self) -> None:
        """A wrong name, a column without numbers, a clash and a folder that cannot be."""
        table = self.put("a.csv", a_trajectory(["t", "R1", "R2", "R3", "R4"], R2=math.nan))
        (self.folder / "b").mkdir()
        clash = self.put("b/a.csv", a_sweep())
        odd = self.put("odd.csv", a_stability().replace("wrong", "odd"))
        trial = ["a", "b", "c", "wrong", "1", "1", "1", "ok", "2", "3"]
        numbers = self.put("numbers.csv", a_table("stability", TRIALS, [trial]))
        none = self.put("none.csv", some_events(0))
        blocked = table / "folder"
        expected = {
            ("--figure", "pie", table): (2, "invalid choice: 'pie'"),
            ("--figure", "path", table): (2, "a.csv: has no column com_x, com_y, com_z: no path"),
            ("--figure", "verdicts", table): (2, "a.csv: is no table of the kind stability"),
            ("--figure", "maps", clash): (2, "a.csv: is no sweep over two parameters"),
            ("--figure", "verdicts", odd): (2, "odd.csv: has the unknown verdict 'odd'"),
            ("--figure", "verdicts", numbers): (
                2,
                "numbers.csv: has no word in column reference, reason",
            ),
            ("--figure", "events", none): (
                2,
                "none.csv: has no number in column t: no events figure",
            ),
            (none,): (0, "none.csv: no figure belongs to its columns"),
            (table,): (2, "a.csv: has no number in column R2: no residuals figure"),
            ("-o", self.folder / "c", table, clash): (2, "would replace those of"),
            ("-o", blocked, clash): (4, f"cannot write to {blocked}: "),
            (): (2, "required: TABLE"),
        }
        for arguments, (code, message) in expected.items():
            with self.subTest(arguments=arguments):
                result, complaint = self.call(*arguments)
                assert result == code
                assert message in complaint
        self.check_pictures(self.folder / "b", set())
