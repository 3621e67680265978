"""Tests of what figures say: their data, lines, labels and titles, not their pixels."""

import itertools
import math
import os
from dataclasses import replace
from unittest import mock

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from PIL import Image

import spintop_figures
from plot_case import TableCase, a_stability, a_sweep, a_table, a_trajectory
from spintop_figures.methods.trials import draw_costs, draw_verdicts, trials
from spintop_figures.motion.events import describe_event, draw_events
from spintop_figures.motion.residuals import draw_error, draw_residuals
from spintop_figures.motion.sphere import draw_path, draw_trace, draw_traces
from spintop_figures.motion.trajectory import (
    draw_angles,
    draw_forces,
    height_extremes,
    inclination_extremes,
    sparseness,
)
from spintop_figures.registry import FIGURES, choose_figures
from spintop_figures.style.axes import draw_sizes
from spintop_figures.style.look import lightness
from spintop_figures.style.page import lay_out, save, save_as, save_small
from spintop_figures.sweeps.curves import draw_sweep, sleeping_threshold
from spintop_figures.sweeps.maps import SIGNED, draw_maps
from spintop_figures.sweeps.scatter import draw_scatter
from spintop_figures.tables.table import TableError


def texts_of(axes: mpl.axes.Axes) -> list[str]:
    titles = (axes.get_title(loc=side) for side in ("left", "center", "right"))
    return [*(text.get_text() for text in axes.texts), *filter(None, titles)]


class FiguresTest(TableCase):
    def test_public(self) -> None:
        """A table is read, drawn and saved by the public names; wrong names are refused by name."""
        table = spintop_figures.read_table(self.put("a.csv", a_trajectory()))
        figure = spintop_figures.draw(table, "angles")
        spintop_figures.save_as(figure, self.folder / "b")
        assert (self.folder / "b.svg").exists()
        with self.assertRaisesRegex(TableError, "there is no figure pie"):
            spintop_figures.draw(table, "pie")
        with self.assertRaisesRegex(TableError, "is no table of the kind sweep: no maps figure"):
            spintop_figures.draw(table, "maps")
        for name in spintop_figures.__all__:
            assert hasattr(spintop_figures, name)

    def test_settings(self) -> None:
        before = dict(mpl.rcParams)
        figure = spintop_figures.draw(self.read(a_trajectory()), "angles")
        spintop_figures.save_as(figure, self.folder / "b")
        assert before == dict(mpl.rcParams)
        assert not figure.axes[0].spines["top"].get_visible()

    def test_few_colours(self) -> None:
        """A picture of few colours has those of small marks, too."""
        figure = spintop_figures.draw(self.read(a_trajectory()), "trace")
        save_small(figure, small := self.folder / "c.png")
        (png,) = save_as(figure, self.folder / "b", ("png",))
        with Image.open(png) as one, Image.open(small) as other:
            pixels = [np.asarray(picture.convert("RGB")).astype(int) for picture in (one, other)]
        assert np.abs(pixels[0] - pixels[1]).max() < 20

    def test_at_once(self) -> None:
        """Another process draws the same figure while it is being written: both succeed."""
        figure = spintop_figures.draw(self.read(a_trajectory()), "trace")
        target = self.folder / "b.png"

        def draw_elsewhere(*arguments: object, **settings: object) -> None:
            write_png(*arguments, **settings)
            if not (child := os.fork()):
                FigureCanvasAgg.print_png = write_png
                save(figure, target)
                os._exit(0)
            assert os.waitpid(child, 0)[1] == 0

        write_png = FigureCanvasAgg.print_png
        with mock.patch.object(FigureCanvasAgg, "print_png", draw_elsewhere):
            save(figure, target)
        assert list(self.folder.glob("*.part")) == []
        assert target.stat().st_size > 5000

    def test_provenance(self) -> None:
        """One line below a picture; the run and the program are in the metadata of the files."""
        table = replace(self.read(a_trajectory()), status="pole at t = 1.25000000001")
        figure = spintop_figures.draw(table, "angles")
        caption = figure.get_supxlabel()
        assert caption == "A top, trajectory: $5; ended early: at a pole at t = 1.25 s"
        png, svg = save_as(figure, self.folder / "b")
        save_small(figure, small := self.folder / "c.png")
        for path in (png, small):
            with Image.open(path) as picture:
                known = picture.text
            assert known["Software"] == "spintop 0.1.0, revision 0123456789ab-dirty"
            assert "Lagrange, RK4, 992 steps" in known["Description"]
            assert known["Source"] == "a.csv"
        assert "RK4, 992 steps" in svg.read_text(encoding="utf-8")
        long = replace(table, header=table.header | {"title": "word " * 99})
        caption = spintop_figures.draw(long, "angles").get_supxlabel()
        assert len(caption) < 109
        assert caption.endswith("s") and "\N{HORIZONTAL ELLIPSIS}; ended" in caption

    def test_nothing_is_hidden(self) -> None:
        """A panel in space has no ground that covers the labels of the one beside it."""
        table = self.compute("regular_precession", "output.columns=all")
        for name in ("cones", "path"):
            for axes in spintop_figures.draw(table, name).axes:
                assert (axes.name == "3d") != axes.patch.get_visible()

    def test_nothing_is_cut_off(self) -> None:
        """All texts lie in the picture: of long titles, in space, beside panels."""
        cones = self.compute("regular_precession")
        titles = ("Loops: released with precession", "Waves: these were released with precession")
        titled = [replace(cones, header=cones.header | {"title": title}) for title in titles]
        figures = [spintop_figures.draw(cones, "cones"), draw_traces(titled + titled[:1])]
        for figure in figures:
            lay_out(figure)
            renderer = figure.canvas.get_renderer()
            labels = [figure._suptitle, *itertools.chain(*(axes.texts for axes in figure.axes))]
            for axes in figure.axes:
                labels.append(axes.title)
                labels += [getattr(axes, f"{which}axis").label for which in axes._axis_names]
            for axes in figure.axes:
                axes.draw(renderer)  # labels of axes in space are placed as they are drawn
            for label in filter(lambda label: label.get_text() and label.get_visible(), labels):
                box = label.get_window_extent(renderer)
                inside = box.x0 >= 0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0
                assert inside, label.get_text()

    def test_zero(self) -> None:
        """The line of zero is not drawn along a jump; signed data have a neutral zero."""
        settings = ["sweep.count=40,30", "sweep.combine=grid"]
        table = self.compute("map_spin_tilt", *settings)
        figure = draw_maps(table)
        by_title = {axes.get_title(loc="left"): axes for axes in figure.axes}
        name = next(title for title in by_title if title.startswith("precession per nutation"))
        self.assertRegex(name, r"with jumps by about 3\d\d")
        precession = by_title[name]
        force = next(by_title[name] for name in by_title if name.startswith("minimum vertical"))
        for axes, has_line in ((precession, False), (force, True)):
            sets = [c for c in axes.collections if isinstance(c, mpl.contour.ContourSet)]
            lines = [path for c in sets for path in c.get_paths() if len(path)]
            assert bool(lines) == has_line
            assert {line.get_marker() for line in axes.lines if len(line.get_xdata())} == {"_"}
        for axes in (precession, force):
            image = axes.collections[0]
            assert image.cmap.name == SIGNED.name
            assert image.norm.vmin == -image.norm.vmax
        shade = np.array(SIGNED(0.5)[:3])
        assert shade.min() > 0.9
        assert np.ptp(shade) < 0.05

    def test_classes_in_place(self) -> None:
        """Each class has a colour, beside which its name stands."""
        table = self.compute("map_spin_tilt", "sweep.count=40,30")
        figure = draw_maps(table)
        figure.draw_without_rendering()
        axes, bar = figure.axes[0], figure.axes[4]
        assert [text.get_text() for text in bar.get_yticklabels()] == ["loop", "wave"]
        (image,) = axes.collections
        cells = {"loop": 0.0, "wave": 1.0}
        spin, tilt = (np.unique(table.rows[name]) for name in table.axes())
        drawn = image.get_array().reshape(tilt.size, spin.size)
        expected = table.rows["motion_class"].map(cells).to_numpy().reshape(spin.size, tilt.size)
        np.testing.assert_array_equal(drawn, expected.T)
        assert np.ptp([lightness(image.cmap(image.norm(code))) for code in (0, 1)]) > 0.5

    def test_exact_solution(self) -> None:
        """It has no figure of residuals; other runs have it as the last one."""
        exact = self.compute("slow_top", "output.columns=all")
        names = [kind.name for kind in choose_figures(exact)[0]]
        assert "residuals" not in names
        refusal = next(kind for kind in FIGURES if kind.name == "residuals").refusal(exact)
        assert "of the exact solution, which has no residuals" in refusal
        kinds, _ = choose_figures(self.compute("slow_top_lagrange_rk4"))
        assert kinds[-1].name == "residuals"

    def test_scales(self) -> None:
        """Residuals are named; R1 and R2 have one scale, the others say that they have not."""
        panels = draw_residuals(self.compute("slow_top_lagrange_rk4")).axes
        for number, axes in enumerate(panels, 1):
            assert axes.get_title(loc="left").startswith(f"R{number}: ")
            scale = "scale of R1 and R2" if number < 3 else f"scale of R{number} alone"
            assert any(scale in text and "largest" in text for text in texts_of(axes))
        assert panels[0].get_ylim() == panels[1].get_ylim()

    def test_zeros(self) -> None:
        """Zeros are gaps with ticks on a log axis, and no line passes them by."""
        figure = mpl.figure.Figure()
        axes = figure.subplots()
        y = np.array([1e-15, 0.0, 1e-15, 2e-15, 0.0, 0.0, -3e-15])
        draw_sizes(axes, np.arange(7.0), y)
        line, alone, zeros = axes.lines
        np.testing.assert_array_equal(np.isnan(line.get_ydata()), y == 0)
        assert list(alone.get_xdata()) == [0, 6]
        assert list(zeros.get_xdata()) == [1, 4, 5]
        assert "exactly zero (3 rows)" in axes.get_legend().get_texts()[0].get_text()

    def test_largest_error(self) -> None:
        table = self.compute("slow_top_scenario2_rk4")
        error = table.rows["orientation_error"]
        axes = draw_error(table).axes[0]
        marked = [line for line in axes.lines if len(line.get_xdata()) == 1 and line.get_marker()]
        places = [tuple(line.get_xydata()[0]) for line in marked]
        assert (table.rows["t"][error.idxmax()], error.max()) in places
        words = " ".join(texts_of(axes))
        assert f"{error.max():.2g} rad" in words
        assert f"{math.degrees(error.max()):.2g}°" in words

    def test_vertical_force(self) -> None:
        """The sign changes of Figure 9 are drawn; horizontal forces share a scale."""
        table = self.compute("slow_top_lagrange_ode45")
        panels = draw_forces(table).axes
        assert r"zero at $\theta$ = 56.6° and 83.9°" in texts_of(panels[2])
        dots = next(line for line in panels[2].lines if line.get_marker() == "o").get_xdata()
        force = np.interp(dots, table.rows["t"], table.rows["force_z"])
        np.testing.assert_allclose(force, 0, atol=1e-10)
        assert panels[0].get_ylim() == panels[1].get_ylim()

    def test_sparse(self) -> None:
        """Turning points between few rows are those of the same motion with many."""
        many = self.compute("slow_top", "span.samples=4001")
        few = self.compute("slow_top", "span.samples=38")
        degrees = np.degrees(many.rows["theta"])
        assert abs(np.degrees(few.rows["theta"].max()) - degrees.max()) > 0.01
        for one, end in zip(inclination_extremes(few), (degrees.min(), degrees.max()), strict=True):
            self.assertAlmostEqual(math.degrees(one.value), end, 3)
            assert not one.of_rows
        low, high = (end.value for end in height_extremes(few))
        self.assertAlmostEqual(low, many.rows["com_z"].min(), 5)
        self.assertAlmostEqual(high, many.rows["com_z"].max(), 5)
        panels = draw_angles(few).axes
        assert f"{degrees.max():.2f}°" in texts_of(panels[1])

    def test_of_the_rows(self) -> None:
        """Extremes of a body without turning points, or that a run does not reach, say it."""
        body = self.compute("rigid_body_chaotic", "output.columns=all")
        assert all(end.of_rows for end in inclination_extremes(body))
        assert any("largest row: " in text for text in texts_of(draw_angles(body).axes[1]))
        rising = self.compute("separatrix")
        least, largest = inclination_extremes(rising)
        assert (least.of_rows, largest.of_rows) == (True, False)
        drifting = self.compute("slow_top_lagrange_ode45")  # with the tolerances of the paper
        assert inclination_extremes(drifting)[0].of_rows

    def test_paths(self) -> None:
        """Rows that are far apart are points: no chords, no arcs."""
        few = self.compute("slow_top", "span.samples=21")
        many = self.compute("slow_top")
        for table, is_sparse in ((few, True), (many, False)):
            com = (table.rows[f"com_{name}"].to_numpy() for name in "xyz")
            words = sparseness(*com)
            assert words.startswith("points only: rows are up to") == is_sparse
            trace, path = draw_trace(table), draw_path(table)
            lines = [*trace.axes[0].lines, *path.axes[0].lines, *path.axes[1].lines]
            whole = [line for line in lines if len(line.get_xdata()) == len(table.rows)]
            assert len(whole) >= 4
            for line in whole:
                assert (line.get_linestyle() == "None") == is_sparse
            told = [path.get_suptitle(), *texts_of(trace.axes[0])]
            assert sum(words in text for text in told if words) == 2 * is_sparse

    def test_halves(self) -> None:
        """The far half has a paler tint of the colour of the near one; a legend says so."""
        figure = draw_trace(self.compute("tip_wave"))
        rows = len(self.compute("tip_wave").rows)
        lines = [line for line in figure.axes[0].lines if len(line.get_xdata()) == rows]
        lines.sort(key=lambda line: line.get_zorder())
        back, front = (np.array(to_rgb(line.get_color())) for line in lines)
        toward = (back - front) / (1 - front)  # the same share of the way to white
        assert np.ptp(toward) < 0.2
        assert toward.min() > 0.4
        legends = [axes.get_legend() for axes in figure.axes if axes.get_legend()]
        words = [text.get_text() for legend in legends for text in legend.get_texts()]
        assert "on the far side" in words

    def test_from_above(self) -> None:
        """Seen from above, the path below the pivot is paler than that above it."""
        table = self.compute("slow_top")
        axes = draw_path(table).axes[1]
        parts = [line for line in axes.lines if len(line.get_xdata()) == len(table.rows)]
        below, above = sorted(parts, key=lambda line: line.get_zorder())
        for line, sign in ((below, -1), (above, 1)):
            shown = np.isfinite(line.get_xdata())
            z = sign * table.rows["com_z"].to_numpy()
            assert shown[z > 0].all()
            assert shown[z < 0].sum() < 10
        assert sum(to_rgb(below.get_color())) > sum(to_rgb(above.get_color()))

    def test_azimuth(self) -> None:
        """The line of the full turn does not strike the legend."""
        figure = draw_sweep(self.compute("spinning_wheel_sweep"))
        lay_out(figure)
        axes = figure.axes[4]
        legend = axes.get_legend().get_window_extent(figure.canvas.get_renderer())
        for line in axes.lines:
            heights = axes.transData.transform(line.get_xydata())[:, 1]
            assert heights.max() < legend.y0

    def test_without_formulas(self) -> None:
        """Bodies that the paper's formulas do not hold for have no such figure, and no error."""
        table = self.read(a_sweep("initial.omega3"))
        assert "sweep" in [kind.name for kind in choose_figures(table)[0]]
        formulas = {name: math.nan for name in table.rows if name.endswith("_fast_top")}
        table = replace(table, rows=table.rows.assign(**formulas))
        good, wrong = choose_figures(table)
        assert "sweep" not in [kind.name for kind in good]
        assert wrong == []
        refusal = "no formula for a fast top: no sweep figure"
        self.assertRegex(choose_figures(table, ["sweep"])[1][0], refusal)

    def test_columns_without_numbers(self) -> None:
        """Figures that may lack numbers are drawn whichever of their columns has none."""
        table = self.compute("spinning_wheel_sweep")
        kinds = [kind for kind in FIGURES if kind.sparse and not kind.refusal(table)]
        assert [kind.name for kind in kinds] == ["sweep", "table1"]
        for kind in kinds:
            for column in kind.columns:
                with self.subTest(f"{kind.name} without {column}"):
                    poorer = replace(table, rows=table.rows.assign(**{column: math.nan}))
                    assert kind.refusal(poorer) or kind.draw(poorer).axes
        azimuth = {"azimuth_after_period_deg": math.nan}
        axes = draw_sweep(replace(table, rows=table.rows.assign(**azimuth))).axes[4]
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        assert labels == ["paper's Eq 32: a full turn", "not computed: no row at $T_p$"]

    def test_signs(self) -> None:
        """Errors of a formula have no line through a change of their sign, like a dip."""
        table = self.compute("spinning_wheel_sweep")
        lines = {line.get_label(): line for line in draw_sweep(table).axes[5].lines}
        for equation, column in (("Eq 29", "delta_u"), ("Eq 32", "precession_rate")):
            deviation = table.rows[f"{column}_fast_top"] / table.rows[column] - 1
            for words, sign in (("too large", 1), ("too small", -1)):
                shown = lines[f"{equation} {words}"].get_ydata()
                np.testing.assert_array_equal(np.isfinite(shown), sign * deviation > 0)

    def test_names(self) -> None:
        names = {
            "theta_deg=90 rising": "θ = 90°, rising",
            "psi=0 every turn rising": "ψ = 0, every turn, rising",
            "omega3_rpm=-60 falling": "ω₃ = \N{MINUS SIGN}60 rpm, falling",
            "t_ms=250": "t = 250 ms",
            "force_z_max=2": "maximum vertical support force = 2",
            "lower_turning_point": "lower turning point",
            "force_z=-1.5": "vertical force = \N{MINUS SIGN}1.5",
        }
        assert {name: describe_event(name) for name in names} == names

    def test_density(self) -> None:
        """Hundreds of events are counted per interval, few are drawn one by one."""
        rows = [["omega3=0 rising", i, 0.01 * i, 0.5, 1.0] for i in range(400)]
        rows += [["psi=0 rising", i, 1.0 * i, 0.5, 1.0] for i in range(4)]
        columns = ["event", "number", "t", "theta", "theta_rate"]
        text = a_table("trajectory", columns, rows) + "# status: ok\n"
        axes = draw_events(self.read(text)).axes[0]
        assert [len(line.get_xdata()) for line in axes.lines] == [4]
        (bars,) = axes.containers
        assert len(bars) > 30
        label = axes.get_yticklabels()[0].get_text()
        assert "(400)" in label
        self.assertRegex(label, r"per 0\.0\d+ s: up to [78]")

    def test_density_of_cloud(self) -> None:
        """Thousands of cases are counted in cells; each case is in one."""
        table = self.compute("random_tops")
        figure = draw_scatter(table)
        panels = [axes for axes in figure.axes if axes.collections and axes.get_ylabel() != ""]
        found = itertools.chain.from_iterable(axes.collections for axes in panels)
        cells = [each for each in found if type(each).__name__ == "PolyCollection"]
        assert cells
        for part in cells:
            assert part.get_array().sum() == 4000

    def test_noise(self) -> None:
        """Errors at rounding are not drawn as data, and the title says so."""
        figure = draw_scatter(self.compute("random_tops"))
        labels = " ".join(axes.get_ylabel().replace("\n", " ") for axes in figure.axes)
        assert "energy error" not in labels
        assert "largest energy error at rounding" in figure.get_suptitle().replace("\n", " ")

    def test_order_of_cases(self) -> None:
        """Verdicts have the cases in the order of references."""
        lines = a_stability().split("\n")
        first = next(i for i, line in enumerate(lines) if line.startswith("fall,"))
        lines.insert(first + 1, lines[first].replace("fall", "flip").replace("exact", "other"))
        tumble = next(line for line in lines if line.startswith("tumble,"))
        lines.insert(-1, tumble.replace("tumble", "sway").replace("quadruple", "exact solution"))
        table = self.read("\n".join(lines))
        assert list(trials(table)["case"].unique()) == ["fall", "flip", "tumble", "sway"]
        shown = [label.get_text() for label in draw_verdicts(table).axes[0].get_xticklabels()]
        assert shown == ["fall", "sway", "flip", "tumble"]

    def test_costs(self) -> None:
        """A line a method; costs are over that of the cheapest accurate method of the case."""
        table = self.read(a_stability())
        cost, error = draw_costs(table).axes[:2]
        names = [label.get_text() for label in cost.get_yticklabels()]
        assert names == ["RK4", "new"]
        dots = [line for axes in (cost, error) for line in axes.lines if line.get_marker() in "sD"]
        found = sorted(x for line in dots[: len(dots) // 2] for x in line.get_xdata())
        np.testing.assert_allclose(found, [90 / 400, 1, 1, 8])

    def test_threshold(self) -> None:
        """It is where the sleeping ratio is one; a rotor, which adds to the spins, leaves none."""
        rows = pd.DataFrame({"initial.omega3": [0.0, 10, -40], "sleeping_ratio": [0, 0.5, 2]})
        self.assertAlmostEqual(sleeping_threshold("initial.omega3", rows), 20)
        assert sleeping_threshold("initial.theta", rows) is None
        bent = rows.assign(sleeping_ratio=[0.5, 1, 2.5])
        assert sleeping_threshold("initial.omega3", bent) is None
        assert sleeping_threshold("initial.omega3", rows.drop(columns="sleeping_ratio")) is None
