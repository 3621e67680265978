"""Tests of scripts/plot: points of the cases of sweeps that are no grid."""

import itertools
import math
import tracemalloc

import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plot_case import TableCase, a_cloud, a_map
from spintop_figures.registry import draw
from spintop_figures.style.look import ROLES, lightness
from spintop_figures.style.page import head
from spintop_figures.sweeps import scatter as cloud_module
from spintop_figures.sweeps.maps import mark_negative, object_to_grid
from spintop_figures.sweeps.quantities import has_log_axis, succeeded
from spintop_figures.sweeps.scatter import draw_scatter, telling
from spintop_figures.tables.names import unit_shown
from spintop_figures.tables.table import Table, read_table


def panels_of(table: Table) -> np.ndarray:
    """The panels of the figure, a row a quantity; the key and colour bars are left out."""
    field = draw_scatter(table).axes
    panels = [axes for axes in field if axes.collections and axes.get_label() != "<colorbar>"]
    return np.array(panels).reshape(len(telling(table)), -1)


def points_of(axes: Axes) -> np.ndarray:
    points = np.concatenate([np.asarray(cloud.get_offsets()) for cloud in axes.collections])
    return points[np.lexsort(points.T)]


def sorted_points(x: pd.Series, y: pd.Series) -> np.ndarray:
    points = np.column_stack([x, y])
    return points[np.lexsort(points.T)]


class SweepFiguresTest(TableCase):
    def test_choice(self) -> None:
        """It belongs to several parameters that are no grid of two."""
        for parameters in (2, 3, 5):
            assert self.figures_of(a_cloud(parameters)) == "scatter"
        assert self.figures_of(a_cloud(1)) == "curves"
        assert self.figures_of(a_map()) == "maps"

    def test_refusals(self) -> None:
        same = a_cloud(2, cases=1) + "2,1.0,1.0,ok,loop,0.1,0.2,0,1e-9,9,\n"
        dull = a_cloud(2, cases=1) + "2,2.0,2.0,ok,wave,0.1,0.2,-2,1e-14,50,\n"
        for text, reason in (
            (a_cloud(1), "is no sweep over several parameters"),
            (a_map(), "is a sweep over a grid of two parameters, which has maps"),
            (same, "is a sweep in which no parameter varies"),
            (dull.replace("loop", "wave"), "has no quantity that varies"),
            (a_cloud(failing=1), "has no quantity that varies"),
        ):
            assert self.refusal("scatter", self.read(text)) == reason
        path = self.put("b.csv", a_map())
        said = self.call("--figure", "scatter", path, code=2)
        assert "which has maps: no scatter figure" in said

    def test_no_grid_is_cheap_to_tell(self) -> None:
        """The cells that all values of both parameters would have are never made."""
        cases = 3000
        table = self.read(a_cloud(2, cases))
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        assert object_to_grid(table) == "is a sweep over no grid"
        assert tracemalloc.get_traced_memory()[1] < cases**2

    def test_points(self) -> None:
        """Each case that succeeded, in each panel, at its values."""
        table = self.read(a_cloud())
        rows, panels = succeeded(table), panels_of(table)
        assert panels.shape == (5, 3)
        for line, quantity in zip(panels, telling(table), strict=True):
            values = quantity.values(rows)
            for axes, name in zip(line, table.axes(), strict=True):
                points = points_of(axes)
                if quantity.columns == ("motion_class",):
                    points[:, 1] = np.round(points[:, 1])
                    values = rows["motion_class"].map({"loop": 0, "wave": 1})
                expected = sorted_points(rows[name], values)
                points = points[np.lexsort(points.T)]
                np.testing.assert_array_equal(points, expected)

    def test_classes(self) -> None:
        """The points of a class have its colour and its place in the panel of classes."""
        table = self.read(a_cloud())
        rows, axes = succeeded(table), panels_of(table)[0, 0]
        names = [label.get_text() for label in axes.get_yticklabels()]
        assert names == ["loop", "wave"]
        seen = {}
        for cloud in axes.collections:
            (place,) = set(np.round(np.asarray(cloud.get_offsets())[:, 1]))
            seen.setdefault(tuple(cloud.get_facecolor()[0]), []).append((place, cloud))
        assert len(seen) == 2
        for alike in seen.values():
            (name,) = {names[int(place)] for place, _ in alike}
            count = sum(len(cloud.get_offsets()) for _, cloud in alike)
            assert count == (rows["motion_class"] == name).sum()

    def test_failed(self) -> None:
        """Cases that failed are ticks on the axis of every panel, and are in the key."""
        table = self.read(a_cloud())
        failed = table.rows[table.rows["status"] == "pole"]
        for line in panels_of(table):
            for axes, name in zip(line, table.axes(), strict=True):
                (ticks,) = (mark for mark in axes.lines if mark.get_marker() == "|")
                np.testing.assert_array_equal(ticks.get_xdata(), failed[name])
        key = next(axes for axes in draw_scatter(table).axes if axes.get_legend())
        entries = [text.get_text() for text in key.get_legend().get_texts()]
        counts = succeeded(table)["motion_class"].value_counts()
        expected = [f"{name} ({counts[name]})" for name in ("loop", "wave")]
        assert entries == [*expected, f"failed: at a pole ({len(failed)})"]

    def test_plane(self) -> None:
        """Two parameters span a plane: coloured by the quantity, failed cases crossed."""
        table = self.read(a_cloud(2))
        rows, panels = succeeded(table), panels_of(table)
        failed = table.rows.drop(rows.index)
        x, y = table.axes()
        assert panels.shape[1] == 3
        for axes, quantity in zip(panels[:, -1], telling(table), strict=True):
            np.testing.assert_array_equal(points_of(axes), sorted_points(rows[x], rows[y]))
            (crosses,) = axes.lines
            np.testing.assert_array_equal(crosses.get_xydata(), failed[[x, y]])
            if quantity.columns != ("motion_class",):
                drawn = np.concatenate([cloud.get_array() for cloud in axes.collections])
                np.testing.assert_array_equal(np.sort(drawn), np.sort(quantity.values(rows)))

    def test_colours_of_a_parameter(self) -> None:
        """Without several classes the first parameter gives the colours."""
        table = self.read(a_cloud().replace("wave", "loop"))
        rows = succeeded(table)
        for axes in panels_of(table).flat:
            drawn = np.concatenate([cloud.get_array() for cloud in axes.collections])
            np.testing.assert_array_equal(np.sort(drawn), np.sort(rows[table.axes()[0]]))

    def test_log_axes(self) -> None:
        """Where the parameter was drawn by ratios, or a table of cases has a wide range."""
        scales = [axes.get_xscale() for axes in panels_of(self.read(a_cloud()))[0]]
        assert scales == ["log", "linear", "linear"]
        table = self.read(a_cloud(spacing="linear"))
        assert {axes.get_xscale() for axes in panels_of(table).flat} == {"linear"}
        listed = "table = 'cases.csv'"
        even = a_cloud(cases=11, spacing="linear")
        table = self.read(even.replace("combine = 'random'", listed))
        assert [has_log_axis(table, name) for name in table.axes()] == [True, False, False]

    def test_most(self) -> None:
        """Five parameters on a page, of which a column has two, and the title says so."""
        table = self.read(a_cloud(5))
        assert panels_of(table).shape[1] == 5
        title = draw(table, "scatter", width="column").get_suptitle().replace("\n", " ")
        assert "2 of 5 parameters" in title

    def test_thinned(self) -> None:
        """The same points each time, with all rare ones; the title gives their number."""
        most, least, cases = cloud_module.MOST_CASES, cloud_module.LEAST_CASES, 30_000
        text = a_cloud(3, cases, failing=cases // 3)
        rare = text.replace("ok,loop", "ok,cusp", 5)
        table = self.read(rare)
        cloud = cloud_module.make_cloud(table, 1)
        counts = {layer.name: (len(layer.rows), layer.count) for layer in cloud.layers}
        assert counts["cusp"] == (5, 5)
        assert len(cloud.failed) == 3
        for name in ("loop", "wave"):
            drawn, count = counts[name]
            self.assertAlmostEqual(drawn, most * count / cases, delta=1)
        total = len(cloud.rows) + 3
        assert total <= most + 3 * least
        assert cloud.rows.equals(cloud_module.make_cloud(table, 1).rows)
        title = draw_scatter(table).get_suptitle().replace("\n", " ")
        assert f"{total:,} of {cases:,} random cases" in title

    def test_few(self) -> None:
        """All are drawn, and the title has nothing to say."""
        table = self.read(a_cloud())
        expected = "Cases over spin ratio, initial inclination, damping 3"
        assert draw_scatter(table).get_suptitle() == expected

    def test_grey(self) -> None:
        """The first classes differ in lightness, all of them in their markers."""
        greys = [lightness(ROLES[f"class{number}"][0]) for number in (1, 2, 3)]
        for one, other in itertools.combinations(greys, 2):
            assert abs(one - other) > 0.15
        assert len({*cloud_module.MARKERS}) == len(cloud_module.MARKERS)

    @pytest.mark.slow
    def test_script(self) -> None:
        clouds = (a_cloud(2), a_cloud(3), a_cloud(5, failing=10**9))
        clouds += (a_cloud().replace("wave", "loop"),)
        self.check_drawn({f"cloud_{i}": (text, {"scatter"}) for i, text in enumerate(clouds)})

    def statistics(self) -> Table:
        """A table with the histogram beside it, in which two intervals are a hair apart."""
        rows = [[0, *3 * ["nan"], 40, 0, 40, MEAN, 0.1, QUARTER, math.pi, 0.8, MEAN, 3.0]]
        for i in range(4):
            ends = [45 * i + 22.5, 45 * i, 45 * i + 45]
            numbers = [MEAN, 0.1, QUARTER, math.pi, *3 * ["nan"]]
            rows.append([i + 1, *ends, 10, 0, 10, *numbers])
        names = "\n".join(f"#     {name} {meaning or ': x'}" for name, meaning in COLUMNS)
        body = [[name for name, _ in COLUMNS], *rows]
        text = "\n".join(",".join(map(str, row)) for row in body)
        cells = f"column,from,to,cases\ntheta_max,{QUARTER},{math.pi / 2 - 1e-3},20\n"
        cells += f"theta_max,{math.pi / 2},{math.pi},20\n"
        self.put("tops.histogram.csv", f"{HEAD}#     column: x\n{cells}")
        text = f"{HEAD}{names.replace(' :', ':')}\n{text}\n"
        return read_table(self.put("tops.statistics.csv", text))

    def figure(self, name: str) -> Figure:
        return draw(self.statistics(), name)

    def test_distribution(self) -> None:
        """Bars, mean, quantiles and label are in degrees; the area of the bars is 1."""
        (axes,) = self.figure("distributions").axes
        assert axes.get_xlabel() == "maximum inclination (degrees)"
        assert axes.get_ylabel() == "density (per degree)"
        bars = [(bar.get_x(), bar.get_width(), bar.get_height()) for bar in axes.patches]
        self.assertAlmostEqual(bars[0][0], 45)
        self.assertAlmostEqual(bars[0][0] + bars[0][1], 90)
        self.assertAlmostEqual(bars[-1][0] + bars[-1][1], 180)
        self.assertAlmostEqual(sum(width * height for _, width, height in bars), 1, delta=1e-3)
        lines = sorted(float(line.get_xdata()[0]) for line in axes.lines)
        np.testing.assert_allclose(lines, np.degrees(sorted([0.8, MEAN, MEAN, 3.0])))

    def test_names_above(self) -> None:
        """The names of lines stand above the panel, from left to right, none on another."""
        (axes,) = self.figure("distributions").axes
        names = [text.get_text() for text in axes.texts]
        assert sorted(names) == ["5 %", "50 %", "95 %", "mean"]
        places = [text.xy for text in axes.texts]
        assert all(y > 1 for _, y in places)
        assert min(np.diff([x for x, _ in places])) > 0.01

    def test_means(self) -> None:
        """Means over the bins are in degrees, and named by what they are."""
        figure = self.figure("means")
        assert figure.get_suptitle() == "Means over initial inclination: 40 cases"
        panel = figure.axes[0]
        assert panel.get_title(loc="left") == "maximum inclination (degrees)"
        (line,) = panel.lines
        np.testing.assert_allclose(line.get_ydata(), np.degrees(MEAN))
        assert "(degrees)" in figure.axes[-1].get_xlabel()

    def test_long_headings(self) -> None:
        """A heading ends before the next panel begins."""
        words = "end of the span, or time of the event that ended the motion (s)"
        figure = Figure(figsize=(7.2, 4), layout="constrained")
        left, right = figure.subplots(1, 2)
        head(left, words)
        figure.draw_without_rendering()
        lines = left.get_title(loc="left").split("\n")
        assert " ".join(lines) == words
        place = dict(fontsize=9.5, transform=left.transAxes)
        ends = [left.text(0, 1, line, **place).get_window_extent().x1 for line in lines]
        assert max(ends) < right.get_window_extent().x0

    def test_signs_without_colours(self) -> None:
        """Each bin below zero has a minus, white where the bin is dark; others have none."""
        axes = Figure().subplots()
        values = np.ma.masked_invalid([[1.0, -0.1, 0.0, -0.9, np.nan, -0.2]])
        mark_negative(axes, np.arange(6.0), np.ones(1), values)
        marks = {line.get_color(): line.get_xdata().tolist() for line in axes.lines}
        assert marks == {"black": [1.0, 5.0], "white": [3.0]}

    def test_signs_of_many_cells(self) -> None:
        """Of a fine map about one cell in each twentieth of a side is marked."""
        axes, x = Figure().subplots(), np.arange(200.0)
        mark_negative(axes, x, x[:5], np.ma.masked_invalid(-np.ones((5, 200))))
        assert len(axes.lines[-1].get_xdata()) == 5 * 20

    def test_units(self) -> None:
        """Angles are in degrees; their errors stay as they are compared, and so do rates."""
        assert unit_shown("theta_max", "rad") == ("degrees", math.degrees(1))
        assert unit_shown("orientation_error", "rad") == ("rad", 1)
        assert unit_shown("precession_rate", "rad/s") == ("rad/s", 1)


HEAD = """\
# title: Many tops
# program: spintop 0.1.0
# format: 1
# revision: 0123456789ab
# input:
#     &study
#         kind = 'sweep'
#     /
# columns:
"""
COLUMNS = (
    ("bin", ""),
    ("initial.theta_deg", "[deg]: middle of the bin: inclination"),
    ("initial.theta_deg_from", "[deg]: lower end of the bin"),
    ("initial.theta_deg_to", "[deg]: upper end of the bin"),
    *(("cases", ""), ("failed", ""), ("theta_max_count", "")),
    ("theta_max_mean", "[rad]: mean: maximum nutation angle"),
    *((f"theta_max_{key}", "[rad]: x") for key in ("deviation", "min", "max")),
    *((f"theta_max_q{key}", "[rad]: quantile") for key in ("0.05", "0.5", "0.95")),
)
QUARTER, MEAN = 0.25 * math.pi, 0.3 * math.pi
"""Where theta_max begins, and its mean; it ends at half a turn."""
