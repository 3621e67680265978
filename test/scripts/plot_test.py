"""Tests of scripts/plot: reading tables, choosing figures, drawing them, complaining."""

import dataclasses
import itertools
import math
import os
import re
from dataclasses import replace

import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

from plot_case import (
    HEAD,
    SCRIPTS,
    TRAJECTORY,
    TRIALS,
    TableCase,
    a_map,
    a_stability,
    a_sweep,
    a_table,
    a_trajectory,
    some_events,
)
from spintop_figures.methods.trials import NO_TRIAL, VERDICTS, digits_of, letters_of, trials
from spintop_figures.moving.motion import lines_of
from spintop_figures.style.page import describe_run, lay_out
from spintop_figures.sweeps import curves
from spintop_figures.sweeps.maps import COLOURS, KAPITZA, draw_maps, find_kapitza_limit, make_grid
from spintop_figures.sweeps.quantities import QUANTITIES, quantities_of
from spintop_figures.sweeps.statistics import is_even
from spintop_figures.tables.table import Table, TableError, read_table


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
            assert curves.as_text(value) == text
        assert curves.as_text(math.nan) == "\N{EN DASH}"
        assert curves.as_column(np.array([9.3984e-5, 340.11])) == ["0.000093984", "340.11"]
        times, minus = "\N{MULTIPLICATION SIGN}", "\N{MINUS SIGN}"
        powers = [f"1.0000{times}10⁻⁹", f"{minus}2.0000{times}10⁰"]
        assert curves.as_column(np.array([1e-9, -2.0])) == powers

    def test_decimal_points(self) -> None:
        table = self.read(a_sweep())
        rows = table.rows.assign(delta_u=[1234.5, 0.00012345, 9.5, 77.0])
        figure = curves.draw_table1(replace(table, rows=rows))
        lay_out(figure)
        renderer = FigureCanvasAgg(figure).get_renderer()
        right = curves.RIGHT_EDGES[next(c for c in curves.COLUMNS if c.column == "delta_u")]
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
        table = self.read(a_sweep())
        wheel = {"top.shape": ["spinning_wheel"]}
        authors = {"top.shape": ["inertia"], "top.mass": ["2.45"], "top.length": ["1"]}
        authors |= {"top.inertia": ["0.00614", "0.00614", "0.0122"], "top.inertia_about": ["pivot"]}
        others = (wheel, authors, authors | {"top.inertia": ["3"]})
        tables = (replace(table, settings=table.settings | settings) for settings in others)
        titles = [curves.draw_table1(each).get_suptitle() for each in tables]
        assert "of the wheel about the pivot" in titles[0]
        assert "of the paper's author (without m l²)" in titles[1]
        assert "of the input" in titles[2]

    def test_failures_are_marked(self) -> None:
        """A case that failed has a note with its status and the reason."""
        text = a_sweep(status="step_limit").replace("nan,\n", "nan,no more steps\n")
        table = self.read(text)
        assert curves.notes_on(table.rows) == ["* \u03bb = 2: too many steps: no more steps"]

    def test_trajectory_beside_its_table(self) -> None:
        """All figures, in a locale with decimal commas, of a run that overflowed."""
        wild = a_trajectory(count=20).splitlines()
        wild[-2] = wild[-2].replace("1.0,1.0,1.0", "1e+300,-inf,1e+100")
        text = "\n".join([*wild[:-1], "# status: non_finite at t = 1", ""])
        table = self.put("two words.csv", text)
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
        missing = self.folder / "missing.csv"
        first, second = self.call("-o", output, missing, empty, good, code=2).splitlines()
        assert first == f"scripts/plot: {missing}: no such file or directory"
        assert second == f"scripts/plot: {empty}: has no rows"
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
            ("--figure", "traces", table): (2, "all tables together: give --together traces"),
            ("--figure", "pie", table): (2, "there is no figure pie; there are angles, "),
            ("--figure", "angels", table): (2, "no figure angels; did you mean 'angles'?"),
            ("--figure", "angles", table): (
                2,
                "no angles figure; --y R1,R2,R3,R4 draws what it has",
            ),
            ("--figure", "path", table): (2, "a.csv: has no column com_x, com_y, com_z: no path"),
            ("--figure", "verdicts", table): (2, "a.csv: is no table of the kind stability"),
            ("--figure", "maps", clash): (2, "a.csv: is no sweep over two parameters"),
            ("--figure", "verdicts", odd): (2, "odd.csv: has the unknown verdict 'odd'"),
            ("--figure", "verdicts", numbers): (2, "has no word in column reference, reason"),
            ("--figure", "events", none): (2, "has no number in column t: no events figure"),
            (none,): (0, "none.csv: no figure belongs to its columns"),
            (table,): (2, "a.csv: has no number in column R2: no residuals figure"),
            ("-o", self.folder / "c", table, clash): (2, "would replace those of"),
            ("-o", blocked, clash): (4, f"cannot write to {blocked}: "),
            (): (2, "required: TABLE"),
        }
        for arguments, (code, message) in expected.items():
            with self.subTest(arguments=arguments):
                assert message in self.call(*arguments, code=code)
        self.check_pictures(self.folder / "b", set())

    def test_grid(self) -> None:
        """Two parameters bring maps if all their values are combined, else points; one, curves."""
        assert self.figures_of(a_map()) == "maps"
        assert self.figures_of(a_map(axes=1)) == "curves"
        lines = a_map().splitlines()
        assert self.figures_of("\n".join([*lines[:-1], ""])) == "scatter"
        assert self.figures_of("\n".join([*lines, lines[-1], ""])) == "scatter"
        assert self.figures_of(a_map(across=1)) == "scatter"
        assert self.figures_of(a_map().replace(",ok,", ",pole,")) == ""

    def test_stability_and_events(self) -> None:
        """Tables with verdicts or events are recognised by their columns."""
        assert self.figures_of(a_stability()) == "verdicts costs"
        assert self.figures_of(a_stability().replace("wrong", "odd")) == ""
        assert self.figures_of(some_events()) == "events sections"
        assert self.figures_of(some_events(19)) == "events"
        assert self.figures_of(some_events(swing=1e-9)) == "events"
        assert self.figures_of(some_events(0)) == ""

    def test_grey(self) -> None:
        """Verdicts darken in steps of at least a tenth; the text in them is readable."""
        whole = [verdict for verdict in VERDICTS.values() if verdict.name not in NO_TRIAL[1:]]
        faces = [lightness(verdict.face) for verdict in whole]
        order = sorted(faces, reverse=True)
        assert faces[:-1] == [grey for grey in order if grey in faces[:-1]]
        for lighter, darker in itertools.pairwise(order):
            assert lighter - darker > 0.1
        for verdict in VERDICTS.values():
            assert abs(lightness(verdict.face) - lightness(verdict.ink)) > 0.4
        for name in NO_TRIAL:  # without a trial: white, distinguished by their marks
            assert lightness(VERDICTS[name].face) == order[0]
        marks = {verdict.mark for verdict in VERDICTS.values()}
        assert len(marks) == len(VERDICTS)

    def test_classes(self) -> None:
        shades = [lightness(COLOURS(i / 9)) for i in range(10)]
        assert shades == sorted(shades)

    def test_entries(self) -> None:
        """A method has an entry; its other formulations have entries of their own."""
        rows = trials(self.read(a_stability()))
        expected = ["RK4", "RK4, Lagrange", "new"]
        assert list(rows["entry"]) == 2 * expected
        families = ["explicit Runge-Kutta", "explicit Runge-Kutta", "own methods"]
        assert list(rows["family"]) == 2 * families
        alone = self.read("\n".join(a_stability().splitlines()[:-3]) + "\n")
        expected = ["RK4, space frame", "RK4, Lagrange", "new"]
        assert list(trials(alone)["entry"]) == expected

    def test_digits(self) -> None:
        """Whole digits, none of a wrong attitude, sixteen at most."""
        expected = {3.1: 0, 0.02: 1, 1e-3: 3, 9e-8: 7, 1e-20: 16, 0.0: 16}
        for error, digits in expected.items():
            assert digits_of(error) == digits

    def test_letters(self) -> None:
        status = ["pole", "pole", "parted", "step_limit"]
        rows = pd.DataFrame({"verdict": "failed", "status": status})
        letters = letters_of(rows)
        assert (letters["pole"], letters["step_limit"]) == ("P", "S")
        assert letters["parted"] == "A"

    def test_grid_of_map(self) -> None:
        """Cells lie about their values, by ratios on a log axis; rows run through y first."""
        listed = "values(1,:) = 0.5, 1.0,"
        spaced = a_map().replace(listed, "spacing = 'linear', 'linear',")
        grid = make_grid(self.read(spaced))
        assert grid.logs == (False, False)
        assert grid.fill(np.arange(20.0))[:, 1].tolist() == [4, 5, 6, 7]
        assert grid.edges()[1].tolist() == [-5, 5, 15, 25, 35]
        for text in (a_map(), a_map().replace(listed, "spacing = 'log', 'linear',")):
            grid = make_grid(self.read(text))
            assert grid.logs == (True, False)
        np.testing.assert_allclose(grid.edges()[0], 10.0 ** np.arange(-0.5, 5))

    def test_words(self) -> None:
        """The type of a column follows from its cells."""
        table = self.read(a_map())
        words = [name for name in table.rows if not table.numeric(name)]
        assert words == ["status", "motion_class", "notes"]
        with self.assertRaisesRegex(TableError, "'wave' in theta_min is no number"):
            self.read(a_map().replace("wave,0.1", "wave,wave", 1))

    def test_scales(self) -> None:
        """Errors are compared by ratios; growth that is rounding is none."""
        known = {quantity.columns[0]: quantity for quantity in QUANTITIES}
        values = np.array([0.0, 1e-9, 2e-8])
        assert known["orientation_error"].has_log_scale(values)
        assert not known["theta_min"].has_log_scale(values)
        growth = np.array([2.0, 1e-2, -1e-15, 1e-9, math.nan])
        none = known["growth_rate"].is_none(growth).tolist()
        assert none == [False, False, True, True, False]

    def sweep(self, columns: dict[str, object], count: int = 80) -> Table:
        """A sweep over one parameter; columns are functions of the number of the case."""
        names = list(columns)
        rows = [[i + 1, 1.0 + i, "ok", *(columns[name](i) for name in names)] for i in range(count)]
        table = a_table("sweep", ["case", "initial.omega3", "status", *names], rows)
        return read_table(self.put("sweep.csv", table))

    def test_constants(self) -> None:
        """What is constant has no panel but its value in the title; costs come last."""
        columns = {"evaluations": lambda i: 100 + i, "lyapunov_exponent": lambda i: 0.25}
        table = self.sweep(columns | {"growth_rate": lambda i: 1.0 + i})
        shown = [quantity.columns[0] for quantity in quantities_of(table)]
        assert shown == ["growth_rate", "evaluations"]
        title = curves.draw_curves(table).get_suptitle().replace("\n", " ")
        assert "in all cases Lyapunov exponent: 0.25 1/s" in title
        free = self.sweep({"evaluations": lambda i: 0, "growth_rate": lambda i: 1.0 + i})
        assert len(curves.draw_curves(free).axes) == 1
        assert "evaluations" not in curves.draw_curves(free).get_suptitle()
        alone = self.sweep({"growth_rate": lambda i: 2.0})
        assert len(quantities_of(alone)) == 1

    def test_equal_panels(self) -> None:
        """Panels have one size; the lowest of each column, and no other, names the parameter."""
        names = ("growth_rate", "lyapunov_exponent", "evaluations")
        axes = curves.draw_curves(self.sweep({name: lambda i: 1.0 + i for name in names})).axes
        assert [bool(panel.get_xlabel()) for panel in axes] == [False, True, True]
        assert {len(panel.get_subplotspec().colspan) for panel in axes} == {1}

    def test_chaos(self) -> None:
        """Of many cases those that are far apart are dots, not joined by lines."""
        table = self.sweep({"growth_rate": lambda i: 1.0 + (i if i < 40 else 60 * (i % 2))})
        line, dots = curves.draw_curves(table).axes[0].lines[-2:]
        assert dots.get_linestyle() == "None"
        assert len(dots.get_xdata()) >= 38
        joined = np.isfinite(line.get_ydata()[:40])
        assert joined.all()

    def test_even(self) -> None:
        """Numbers of random cases in bins are noise; those of a trend are not."""
        random = np.random.default_rng(1)
        assert is_even(random.poisson(20, 500))
        assert not is_even(np.arange(40.0))

    def test_kapitza(self) -> None:
        """The limit is where the multipliers of the program begin to be 1, for fast vibrations."""
        settings = ["sweep.count=2,40", "sweep.from=200,0.012", "sweep.to=400,0.05"]
        table = self.compute("kapitza_map", *settings)
        limit = find_kapitza_limit(table)
        for rate, part in table.rows.groupby("effects.vibration_rate"):
            amplitudes = part["effects.vibration_amplitude(3)"].to_numpy()
            stable = np.abs(part["upright_multiplier"].to_numpy() - 1) < 1e-6
            self.assertAlmostEqual(amplitudes[stable].min() / limit(rate), 1, delta=0.04)
            assert not stable[amplitudes < 0.99 * limit(rate)].any()
        labels = [line.get_label() for axes in draw_maps(table).axes for line in axes.lines]
        assert KAPITZA in labels
        spun = dataclasses.replace(table, settings=table.settings | {"initial.omega3": ["2"]})
        assert find_kapitza_limit(spun) is None

    def test_studies(self) -> None:
        """Stability, maps, curves and events, without a warning of the layout."""
        tables = {
            "stability": (a_stability(), {"verdicts", "costs"}),
            "map": (a_map(), {"maps"}),
            "curve": (a_map(axes=1), {"curves"}),
            "all_well": (a_map(axes=1).rpartition("20,")[0], {"curves"}),
            "top.events": (some_events(), {"events", "sections"}),
        }
        self.check_drawn(tables)

    def draw(self, name: str = "a.csv", **environment: str) -> None:
        path = self.put(name, a_trajectory())
        done = self.plot("--figure", "angles", path, **environment)
        assert (done.returncode, done.stderr) == (0, "")
        names = [f"{path.with_suffix('')}_angles.{ending}" for ending in ("png", "svg")]
        assert os.fsencode(done.stdout).splitlines() == list(map(os.fsencode, names))

    def test_backend(self) -> None:
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
        path = self.put("a.csv", text)
        said = self.call("-o", self.folder, path, code=2)
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
                    again = read_table(self.put("again.csv", changed.encode()))
                    assert again.header == first.header
                    assert again.rows.equals(first.rows)
                    assert lines_of(again) == lines_of(first)

    def test_encodings(self) -> None:
        for kind, text in KINDS.items():
            for encoding in ("utf-16", "utf-16-be", "utf-32"):
                with self.subTest(kind, encoding=encoding):
                    mark = "\ufeff" if encoding.endswith("be") else ""
                    said = self.complaint((mark + text).encode(encoding))
                    assert "is no text in UTF-8" in said

    def test_separators(self) -> None:
        """Semicolons, also with decimal commas, and tabs."""
        other = str.maketrans(",.", ";,")
        for kind, text in KINDS.items():
            rows = re.sub(r"(?m)^[^#].*", lambda row: row[0].translate(other), text)
            for changed in (text.replace(",", ";"), rows, text.replace(",", "\t")):
                with self.subTest(kind):
                    assert "has a space or a separator in its name" in self.complaint(changed)

    def test_header(self) -> None:
        for kind, text in KINDS.items():
            with self.subTest(kind):
                quoted = re.sub(r"(?m)^#.*", r'"\g<0>";;', text)
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


def lightness(colour: object) -> float:
    """Lightness of a colour in print without colours, from 0 to 1 (ITU-R BT.601)."""
    return float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114)))


NO_BREAK = ("\N{NO-BREAK SPACE}", "\N{NARROW NO-BREAK SPACE}", "\N{FIGURE SPACE}")
KINDS = {"trajectory": a_trajectory(), "sweep": a_sweep()}
