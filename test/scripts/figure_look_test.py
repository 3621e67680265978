"""Tests of how figures look to a reader: of all kinds, at the widths of a column, a page, a slide.

No text leaves the page or lies over another, every axis has its numbers and nothing beside them, no
name is one of the program; and colours differ for all eyes.
"""

import itertools
import re
import unittest
import unittest.mock
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from conftest import listed
from figure_checks import problems_of, texts
from plot_case import (
    TRAJECTORY,
    TRIALS,
    TableCase,
    a_cloud,
    a_map,
    a_precision,
    a_sweep,
    a_table,
    a_trajectory,
    computed,
    some_events,
)
from spintop_figures import draw, read_table, save_as
from spintop_figures.files import draw_to
from spintop_figures.registry import FIGURES, FigureKind, choose_figures
from spintop_figures.style.axes import Powers, scale_for
from spintop_figures.style.look import CENTIMETRE, ROLES, WIDTHS, lightness, the_look
from spintop_figures.style.numbers import with_comma, write, write_fixed
from spintop_figures.sweeps.quantities import column_shown, known_quantities
from spintop_figures.tables.names import (
    axis_of,
    column_units,
    columns_of,
    name_of,
    sign_of,
    units_of_columns,
    with_unit,
)
from spintop_figures.tables.table import Table, TableError

FEW = ("gyrocompass", "kapitza", "damped_top", "slow_top_euler_ode45", "friction_to_rest")
RUNS = {
    **dict.fromkeys(FEW, ("span.samples=200",)),
    **{"separatrix": ("output.columns=all",), "slow_top_events": (), "fit": ()},
    **{"flip_period": ("sweep.count(1)=9",), "spin_tilt_statistics": ("sweep.cases=500",)},
    "nutation_indices": ("sweep.cases=700",),
}
"""Inputs with numbers that are tiny, huge or alike, and what makes them quick."""

WIDE = {"table1", "verdicts"}
"""Figures with as many cells as their tables have rows, which fit no column."""


def a_stability() -> str:
    rows = []
    for reference, i in itertools.product(("exact solution", "quadruple"), range(4)):
        for method, error in (("rk4", 1e-3), ("crank_nicolson_1", 1e-9)):
            verdict = "accurate" if error < 1e-6 else "drifts"
            numbers = [error * 4**i, 1e-15, 100 * 4**i]
            case = f"hard_case_{reference[0]}{i}"
            words = [case, method, "space_frame", verdict, *numbers, "ok", reference, ""]
            rows.append(words)
    return a_table("stability", TRIALS, rows)


def made_up() -> dict[str, str]:
    precision = a_precision({"slow_top": 1.0, "fast_top": 3.0}).split("\n")
    grid = itertools.product((1.0, 2.0, 4.0), (0.1, 0.2, 0.3))
    problems = {f"top.{i}/{x}/{y}": 0.5 + x * y / 30 for i, (x, y) in enumerate(grid)}
    return {
        "motion": a_trajectory([*TRAJECTORY, "energy_error"], energy_error=1e-9),
        "sweep": a_sweep(),
        "map": a_map(),
        "plane": a_cloud(2),
        "cloud": a_cloud(4, cases=2000),
        "stability": a_stability(),
        "precision": "\n".join(line for line in precision if ",heyoka," not in line),
        "tolerances": a_precision(problems, ("initial.spin_ratio", "initial.theta")),
        "events": some_events(400),
    }


class FigureLookTest(TableCase):
    def tables(self) -> Iterator[Table]:
        for name, text in made_up().items():
            yield read_table(self.put(f"{name}.csv", text))
        for name, settings in RUNS.items():
            for path in sorted(computed(name, *settings).glob(f"{name}*.csv")):
                if "histogram" not in path.name:
                    yield read_table(path)

    @pytest.mark.slow
    def test_look(self) -> None:
        """No figure has a fault, on a page and in a column; nearly all kinds are there.

        Benchmarks are looked at where they are computed.
        """
        seen = set()
        warnings.simplefilter("ignore")
        for table in self.tables():
            for kind in choose_figures(table)[0]:
                seen.add(kind.name)
                for width in (None, "column") if kind.name not in WIDE else (None,):
                    with self.subTest(table=table.path.stem, kind=kind.name, width=width):
                        figure = draw(table, kind.name, width=width)
                        assert problems_of(figure) == []
        missing = {kind.name for kind in FIGURES} - seen
        assert missing <= {"peers", "choice", "benchmarks"}

    def test_look_of_methods(self) -> None:
        """Nor have those of all methods, whose names and axes are the longest."""
        cases = "slow_top,oblate,flat_disc,thin_rod,kovalevskaya,damped_body,fast_vibration"
        methods = "stability.methods=rk4,splitting_8,arkode_erk,dop853"
        stability = "stability", f"stability.cases={cases}", methods
        for (name, *settings), kind in (
            (["convergence"], "orders"), (stability, "costs"), (stability, "verdicts"),
        ):  # fmt: skip
            table = self.compute(name, *settings)
            for width in (None, "column") if kind not in WIDE else (None,):
                with self.subTest(kind=kind, width=width):
                    assert problems_of(draw(table, kind, width=width)) == []

    def test_faults_are_found(self) -> None:
        table = self.read(a_trajectory())

        def fault(change: object) -> str:
            figure = draw(table, y="phi")
            change(figure, figure.axes[0])
            return " ".join(problems_of(figure))

        assert "leaves the page" in fault(lambda f, axes: axes.text(-9, 0, "far away"))
        assert "lies over" in fault(lambda f, axes: [f.text(0.5, 0.5, "one") for _ in "12"])
        assert "'at_rest'" in fault(lambda f, axes: f.text(0.5, 0.5, "is at_rest"))
        assert "'top.mass'" in fault(lambda f, axes: axes.set_title("of top.mass"))
        assert "'1e-0" in fault(lambda f, axes: f.text(0.5, 0.5, "1e-09")) + "'1e-0"
        assert "points of" in fault(lambda f, axes: f.text(0.5, 0.5, "tiny", size=5))
        assert "no numbers" in fault(lambda f, axes: axes.yaxis.set_major_formatter(""))
        assert "equal" in fault(lambda f, axes: axes.yaxis.set_major_formatter("0"))

        def shift(_: Figure, axes: mpl.axes.Axes) -> None:
            axes.yaxis.set_major_formatter(mpl.ticker.ScalarFormatter(useOffset=1e3))

        assert "beside" in fault(shift)

    def motion(self, **other: object) -> Table:
        return self.read(a_trajectory(**other))

    def test_widths(self) -> None:
        """A figure is as wide as it should be, and its letters suit that."""
        table = self.motion()
        sizes = {}
        for width in (*WIDTHS, 12):
            figure = draw(table, "angles", width=width)
            inches = WIDTHS.get(width, width) * CENTIMETRE
            self.assertAlmostEqual(figure.get_size_inches()[0], inches)
            if width == "slide":
                assert figure.get_size_inches()[1] <= inches * 9 / 16
            sizes[width] = figure.axes[0].yaxis.label.get_fontsize()
        self.assertAlmostEqual(sizes["column"], 8)
        assert sizes["slide"] > 9
        lack = "does not fit on a slide with letters of 36 points.*: no angles figure"
        with self.assertRaisesRegex(TableError, lack):
            draw(table, "angles", width="slide", font_size=36)
        letters = draw(table, "angles", font_size=12).axes[0].yaxis.label.get_fontsize()
        self.assertAlmostEqual(letters, 12)
        page = self.read(a_sweep())
        with self.assertRaisesRegex(TableError, r"needs a width of \d+ cm: no table1 figure"):
            draw(page, "table1", width="column")

    def test_large_letters(self) -> None:
        """On a slide the usual figures have letters of 16 and 18 points, as they are asked for."""
        for table, kinds in (
            (self.motion(), ("angles", "forces", "trace")),
            (self.read(a_precision()), ("precision_time", "precision_work")),
            (self.compute("spinning_wheel_sweep"), ("curves",)),
        ):
            for kind, letters in itertools.product(kinds, (16, 18)):
                with self.subTest(kind=kind, letters=letters):
                    figure = draw(table, kind, width="slide", font_size=letters)
                    size = figure.get_size_inches() / CENTIMETRE
                    assert size == pytest.approx((25.4, min(size[1], 25.4 * 9 / 16)))
                    assert problems_of(figure) == []
                    assert figure.axes[0].yaxis.label.get_fontsize() == letters

    def test_wrong_options(self) -> None:
        table = self.motion()
        for options, reason in (
            ({"width": "wide"}, "a width is column, page, slide or centimetres, not 'wide'"),
            ({"width": 3}, "a width is 6 to 100 centimetres, not 3"),
            ({"font_size": 3}, "letters have 6.5 to 72 points, not 3"),
            ({"font_size": 60, "width": 8.5}, "letters of 60 points need a width of 37 cm"),
            ({"style": "nowhere"}, "there is no style sheet nowhere"),
            ({"log": "x"}, "name them by y"),
            ({"y": "theta", "log": "z"}, "log axes are x, y or xy"),
            ({"y": "theta", "range": {"x": (2, 1)}}, "has to end above its begin"),
        ):
            with self.assertRaisesRegex(ValueError, reason):
                draw(table, "" if "y" in options else "angles", **options)
        with self.assertRaisesRegex(TableError, "has no column nowhere: no columns figure"):
            draw(table, y="nowhere")
        with self.assertRaises(TypeError):
            draw(table, "angles", size=3)

    def test_titles(self) -> None:
        table = self.motion()
        table = replace(table, header=table.header | {"title": "A top"})
        own, mine = draw(table, "angles"), draw(table, "angles", title="Mine")
        assert own.get_supxlabel() == "A top"
        assert (mine.get_suptitle(), mine.get_supxlabel()) == ("Mine", "")
        for look in ("fontweight", "position", "horizontalalignment"):
            assert (
                getattr(mine._suptitle, f"get_{look}")() == getattr(own._suptitle, f"get_{look}")()
            )
        bare = draw(table, "angles", title="")
        assert (bare.get_suptitle(), bare.get_supxlabel()) == ("", "")

    def test_decimal_comma(self) -> None:
        figure = draw(self.motion(), "angles", decimal_comma=True)
        assert problems_of(figure) == []
        with the_look(figure.options):
            shown = [label.get_text() for label in figure.axes[3].yaxis.get_ticklabels()]
        assert "0,80" in shown
        assert not [text for text in shown if not re.fullmatch(r"\d(,\d+)?", text)]
        assert with_comma("12,345.5") == "12\N{NARROW NO-BREAK SPACE}345,5"

    def test_dark(self) -> None:
        """All letters and lines can be seen on the dark ground."""
        for options in ({"dark": True}, {"style": "dark_background"}):
            figure = draw(self.motion(), "forces", **options)
            assert lightness(figure.get_facecolor()) < 0.2
            for text in figure.findobj(Text):
                assert lightness(text.get_color()) > 0.45
            for line in figure.findobj(Line2D):
                assert len(line.get_xdata()) < 10 or lightness(line.get_color()) > 0.45

    def test_dark_maps(self) -> None:
        """A map and its legend have the colours that they have on white."""
        few = self.compute("kapitza_map", "sweep.count=4,4")
        looks = []
        for dark in (False, True):
            panels = draw(few, "maps", dark=dark).axes
            legends = [legend for axes in panels if (legend := axes.get_legend())]
            lines = [line.get_color() for legend in legends for line in legend.legend_handles]
            classes = draw(self.read(a_map()), "maps", dark=dark).axes[0].collections[0].cmap
            looks.append([*lines, *classes(np.linspace(0, 1, 3)).ravel()])
        assert len(legends) > 0
        assert looks[0] == looks[1]

    def test_style(self) -> None:
        cycle = self.put("my.mplstyle", "axes.prop_cycle: cycler('color', ['ff0000', '00ff00'])\n")
        lines = draw(self.motion(), "forces", style=cycle).axes[3].lines
        assert to_hex(lines[0].get_color()) == "#ff0000"

    def test_columns(self) -> None:
        """Columns of choice of two tables, each with a line and a name, in ranges, on log axes."""
        tables = [self.motion(), read_table(self.put("b.csv", a_trajectory(theta=0.7)))]
        figure = draw(tables, y=["theta", "phi"], range={"y": (0.1, None)})
        assert problems_of(figure) == []
        upper, lower = figure.axes
        assert [len(axes.lines) for axes in figure.axes] == [2, 2]
        assert upper.get_ylim()[0] == 0.1
        self.assertAlmostEqual(upper.lines[1].get_ydata()[0], 0.7)
        assert [t.get_text() for t in upper.get_legend().get_texts()] == ["a", "b"]
        assert "precession" in lower.get_ylabel()
        assert draw(tables[0], x="phi", y="R4", log="y").axes[0].get_yscale() == "log"
        with self.assertRaisesRegex(TableError, "nothing above zero in column R3"):
            draw(tables[0], y="R3", log="y")

    def test_files(self) -> None:
        figure = draw(self.motion(), "angles", width="column")
        endings = ("pdf", "png", "jpg")
        paths = save_as(figure, self.folder / "a", endings)
        heads = (b"%PDF", b"\x89PNG", b"\xff\xd8")
        for path, head in zip(paths, heads, strict=True):
            assert path.read_bytes().startswith(head)
        with Image.open(self.folder / "a.png") as picture:
            assert picture.width > 1000
        with self.assertRaisesRegex(ValueError, "not in 'doc'"):
            save_as(figure, self.folder / "a", ("doc",))

    def test_script(self) -> None:
        one, other = (self.put(f"{name}.csv", a_trajectory()) for name in "ab")
        looks = ("--width", "12", "--format", "pdf,png", "--no-title", "--font-size", "9")
        assert self.call("--figure", "angles", *looks, one) == ""
        assert (self.folder / "a_angles.pdf").exists()
        chosen = ("--y", "theta,phi", "--range", "x=0:3", "--log", "y", "--dark")
        assert self.call(*chosen, "--decimal-comma", one, other) == ""
        assert (self.folder / "columns.svg").exists()
        for wrong, reason in (
            (("--format", "doc"), "there is no 'doc'; there are"),
            (("--width", "x"), "a width is column"),
            (("--range", "x"), "'x' is not like x=0:5"),
        ):
            assert reason in self.call(*wrong, one, code=2)


class WordsTest(unittest.TestCase):
    def test_numbers(self) -> None:
        """One notation: a true minus, raised powers, separators, no false zero."""
        times, minus = "\N{MULTIPLICATION SIGN}", "\N{MINUS SIGN}"
        expected = {
            0.25: "0.25",
            -3.0: f"{minus}3",
            12346.0: "12,350",
            1.182e-16: f"1.182{times}10⁻¹⁶",
            1e-9: "10⁻⁹",
            -2e7: f"{minus}2{times}10⁷",
            0.0: "0",
            9.9999e-4: "0.001",
        }
        for value, text in expected.items():
            assert write(value) == text
        assert write_fixed(1e-9, 2) == "10⁻⁹"
        assert write_fixed(-12345.678, 1) == f"{minus}12,345.7"

    def test_scales(self) -> None:
        """Tiny and huge numbers have a prefix, degrees turns, what differs little an origin."""
        assert scale_for(0, 3e-6, "m")[:2] == (1e6, "µm")
        assert scale_for(0, 5e4, "N")[:2] == (1e-3, "kN")
        assert scale_for(0, 5e4, "s").unit == "s"
        assert scale_for(0, 72000, "degrees").unit == "turns"
        assert scale_for(0, 1e-3, "degrees").unit == "µrad"
        assert scale_for(0, 90, "degrees") == (1.0, "degrees", 0.0)
        near = scale_for(-0.01 + 1e-10, -0.01 + 3e-10, "m")
        assert (near.unit, near.origin) == ("pm", -0.0099999998)

    def test_powers(self) -> None:
        """On log axes powers of ten are plain text; over less than two decades there are numbers,
        with powers only if they are unusual."""
        times = "\N{MULTIPLICATION SIGN}"
        for ends, expected in {
            (1e-12, 1e3): {"10⁻¹²", "10⁰", "10²"},
            (0.02, 0.06): {"0.03"},
            (2.0, 6.0): {"3"},
            (2e-6, 6e-6): {f"3{times}10⁻⁶"},
            (2e5, 6e5): {f"3{times}10⁵"},
        }.items():
            axes = Figure().subplots()
            axes.set(yscale="log", ylim=ends)
            for which in ("major", "minor"):
                getattr(axes.yaxis, f"set_{which}_formatter")(Powers())
            shown = {label.get_text() for label in axes.get_yticklabels(which="both")}
            assert expected <= shown
            assert not [text for text in shown if "$" in text]

    def test_names(self) -> None:
        """Methods, keys of the input, columns and statuses have names without underscores."""
        expected = {
            "rk4": "RK4",
            "crank_nicolson_1": "Crank-Nicolson 1",
            "arkode_dormand_prince_7_4_5": "Dormand-Prince 7-4-5",
            "initial.psi_rate": "initial spin rate",
            "initial.omega3": "initial spin",
            "initial.theta_deg": "initial inclination",
            "top.inertia(1)": "moment of inertia I₁",
            "initial.quaternion(1)": "initial quaternion q₀",
            "part(2).mass": "mass of part 2",
            "theta_end__top.mass": "change of inclination at the end with mass",
            "at_rest": "at rest",
            "work_friction": "work of friction",
            "work_precision": "work-precision study",
        }
        for key, name in expected.items():
            assert name_of(key) == name
        assert sign_of("theta") == "θ"
        assert axis_of("top.mass", "kg m^2") == "mass $m$ (kg m²)"

    def test_all_names(self) -> None:
        for topic in ("methods", "formulations", "columns", "statuses", "studies", "parameters"):
            for entry in listed(topic):
                self.assertNotRegex(name_of(entry["name"]), r"[_.]")

    def check(self, of_axis: float, of_quantity: float) -> None:
        """Draw all; look at those of the quantities and of the last parameter that are about 1."""
        for last in AXES:
            first = next(name for name in AXES if name != last)
            one, two = (a_study(axes, of_axis, of_quantity) for axes in ((last,), (first, last)))
            for kind, study in (("curves", one), ("means", one), ("maps", two), ("means", two)):
                with self.subTest(axes=study.axes(), kind=kind):
                    figure = draw(binned(study) if kind == "means" else study, kind)
                    if of_axis == 1:
                        name = "xy"[len(study.axes()) - 1]
                        assert axis_of(last, AXES[last]) in labels(figure, name)
                    if of_quantity == 1:
                        assert named(study, kind) <= {*headings(figure)}

    @pytest.mark.slow
    def test_units(self) -> None:
        """Neither its unit nor its prefix is that of the other one."""
        self.check(1e-5, 1.0)
        self.check(1.0, 1e-5)


DEUTERANOPE = (
    (0.367322, 0.860646, -0.227968),
    (0.280085, 0.672501, 0.047413),
    (-0.011820, 0.042940, 0.968881),
)
PROTANOPE = (
    (0.152286, 1.052583, -0.204868),
    (0.114503, 0.786281, 0.099216),
    (-0.003882, -0.048116, 1.051998),
)
"""G. M. Machado, M. M. Oliveira, L. A. F. Fernandes (2009), of linear light, at full severity."""


def to_linear(colour: object) -> np.ndarray:
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
WHITE = np.array([0.95047, 1.0, 1.08883])


def lab_of(colour: str, eye: object) -> np.ndarray:
    """CIELAB of a colour as an eye sees it."""
    light = np.clip(np.array(eye) @ to_linear(colour), 0, 1)
    ratio = TO_XYZ @ light / WHITE
    x, y, z = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


class ColourTest(unittest.TestCase):
    FAMILIES = tuple(ROLES[role] for role in ROLES if role.startswith(("family", "other")))
    LINES = tuple(ROLES[role] for role in ROLES if role.startswith("line"))

    def test_apart(self) -> None:
        """Those of families, and of lines, differ for all eyes; on dark ground those of lines."""
        light = [[pair[0] for pair in pairs] for pairs in (self.FAMILIES, self.LINES)]
        for eye in (np.eye(3), DEUTERANOPE, PROTANOPE):
            for colours in (*light, [pair[1] for pair in self.LINES]):
                for one, other in itertools.combinations(colours, 2):
                    apart = np.linalg.norm(lab_of(one, eye) - lab_of(other, eye))
                    assert apart > 8, (one, other)

    def test_contrast(self) -> None:
        """They are seen on their ground at a contrast of 3 to 1, as is what is written in grey."""
        for pair in (*self.FAMILIES, *self.LINES, ROLES["grey"], ROLES["fault"], ROLES["ink"]):
            for colour, ground in zip(pair, ROLES["ground"], strict=True):
                one, other = (TO_XYZ[1] @ to_linear(each) + 0.05 for each in (colour, ground))
                assert max(one / other, other / one) > 3, colour


AXES = {
    "initial.omega3": "rad/s",
    "initial.theta": "rad",
    "initial.theta_deg": "deg",
    "initial.spin_ratio": "",
    "top.mass": "kg",
    "top.length": "m",
    "span.t_end": "s",
}
"""Parameters of each unit."""
SIZE = 6
"""Values of a parameter."""


def quantities_by_unit() -> dict[str, str]:
    """A column of sweeps for each unit that they have."""
    columns = columns_of("sweep").values()
    return {each["unit"] or "": each["name"] for each in columns if not each["words"]}


def a_study(axes: tuple[str, ...], of_axis: float, of_quantity: float) -> Table:
    """A sweep over a grid, with a column of each unit; sizes of the last parameter and of these."""
    values = [np.linspace(1, 2, SIZE) * (of_axis if name == axes[-1] else 1) for name in axes]
    grid = np.array(list(itertools.product(*values)))
    found = of_quantity * (1 + np.arange(len(grid)) / len(grid))
    columns = quantities_by_unit()
    cells = {"case": np.arange(len(grid)) + 1}
    cells |= dict(zip(axes, grid.T, strict=True)) | {"status": "ok"}
    cells |= dict.fromkeys(columns.values(), found)
    units = {name: unit for unit, name in columns.items()} | {name: AXES[name] for name in axes}
    settings = {"study.kind": ["sweep"], "output.columns": list(columns.values())}
    rows = pd.DataFrame(cells)
    return Table(Path("sweep.csv"), {"program": "spintop"}, settings, units, {}, rows, None)


def binned(study: Table) -> Table:
    """Its statistics, each case in a bin of its own."""
    names = list(quantities_by_unit().values())
    cells: dict[str, np.ndarray] = {"bin": np.arange(len(study.rows)) + 1}
    units = {}
    for name in study.axes():
        middles = study.rows[name].to_numpy()
        half = np.diff(np.unique(middles)).min() / 2
        cells |= {name: middles, f"{name}_from": middles - half, f"{name}_to": middles + half}
        units[name] = study.units[name]
    cells |= {"cases": 10.0 + np.arange(len(study.rows)) ** 2, "failed": 0 * middles}
    for name in names:
        numbers = study.rows[name].to_numpy()
        cells |= {f"{name}_{end}": numbers for end in ("mean", "min", "max")}
        cells |= {f"{name}_deviation": 0 * numbers, f"{name}_count": 0 * numbers + 1}
        units[f"{name}_mean"] = study.units[name]
    rows = pd.DataFrame(cells)
    rows = pd.concat([rows.iloc[:1].assign(bin=0), rows], ignore_index=True)
    return replace(study, rows=rows, units=units)


def headings(figure: Figure) -> list[str]:
    found = (axes.get_title(loc="left") for axes in figure.axes)
    return [" ".join(text.split()) for text in found if text]


def named(study: Table, kind: str) -> set[str]:
    """The headings that the quantities of a study are to have, in plain units."""
    if kind == "means":
        known = [column_shown(study, name) for name in quantities_by_unit().values()]
    else:
        known = known_quantities(study)
    return {with_unit(each.label, each.unit) for each in known}


def labels(figure: Figure, name: str) -> set[str]:
    found = (getattr(axes, f"get_{name}label")() for axes in figure.axes if axes.get_subplotspec())
    return {" ".join(text.split()) for text in found} - {""}


class OtherUnitsTest(TableCase):
    """Tables whose columns have other units are drawn as those in their own."""

    def tables(self) -> list[Table]:
        found = [read_table(self.put("events.csv", some_events(400)))]
        sweep = read_table(self.put("sweep.csv", a_sweep()))
        units = {name: units_of_columns().get(name) for name in sweep.rows}
        found.append(replace(sweep, units=units))
        for name in ("separatrix", "slow_top_euler_ode45", "friction_to_rest", "fit"):
            settings = ["span.samples=60"] if name != "fit" else []
            settings += ["output.columns=all"] if name == "separatrix" else []
            self.compute(name, *settings)
            end = ".residuals.csv" if name == "fit" else ".csv"
            found.append(read_table(self.folder / f"{name}{end}"))
        return found

    def in_other_units(self, table: Table, names: list[str], number: int) -> Table:
        """The table with these columns in the other unit of this number."""
        rows, units, meanings = table.rows.copy(), dict(table.units), dict(table.meanings)
        for name in names:
            own = units_of_columns()[name]
            others = [each for (of, _), each in column_units().items() if of == own]
            if not others:
                continue
            other = others[number % len(others)]
            new = f"{name}_{other['suffix']}"
            rows = rows.assign(**{name: rows[name] / other["size"]}).rename(columns={name: new})
            units[new], meanings[new] = other["unit"], meanings.pop(name, "")
        return replace(table, rows=rows, units=units, meanings=meanings)

    @pytest.mark.slow
    def test_units(self) -> None:
        """Every figure of columns, which are in another unit each time, has the same texts."""
        most = max(sum(of == unit for of, _ in column_units()) for unit in ("s", "rad", "m", "N"))
        warnings.simplefilter("ignore")
        drawn: set[str] = set()
        for table in self.tables():
            for kind in choose_figures(table)[0]:
                names = [*(kind.columns if kind.name == "fit" else table.rows)]
                names = [
                    each for each in names if each in units_of_columns() and table.numeric(each)
                ]
                others = [self.in_other_units(table, names, number) for number in range(most)]
                with self.subTest(kind=kind.name):
                    assert {kind.refusal(other) for other in others} == {""}
                    self.compare(kind, table, others[len(drawn) % most])
                drawn.add(kind.name)
        wanted = {each.name for each in FIGURES if set(each.columns) & {"t", "theta", "com_z"}}
        assert wanted <= drawn

    def compare(self, kind: FigureKind, own: Table, other: Table) -> None:
        with unittest.mock.patch("spintop_figures.files.save_as") as save:
            for table in (other, own):
                draw_to(kind, table, self.folder / "a")
        one, two = (texts(call.args[0]) for call in save.call_args_list)
        assert one == two
