"""Tests of the figures of statistics: words instead of names, angles in degrees."""

import math

import numpy as np
from matplotlib.figure import Figure

from plot_case import TableCase
from spintop_figures.registry import draw
from spintop_figures.style.page import head
from spintop_figures.sweeps.statistics import mark_negative
from spintop_figures.tables.names import name_of, unit_shown
from spintop_figures.tables.table import Table, read_table

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


class StatisticsFiguresTest(TableCase):
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
        histogram = [
            ["column", "from", "to", "cases"],
            ["theta_max", QUARTER, math.pi / 2 - 1e-3, 20],
            ["theta_max", math.pi / 2, math.pi, 20],
        ]
        cells = "\n".join(",".join(map(str, row)) for row in histogram)
        self.put("tops.histogram.csv", f"{HEAD}#     column: x\n{cells}\n")
        return read_table(
            self.put("tops.statistics.csv", f"{HEAD}{names.replace(' :', ':')}\n{text}\n")
        )

    def figure(self, name: str) -> Figure:
        """A figure of these statistics."""
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
        values = np.array([1.0, -0.1, 0.0, -0.9, np.nan, -0.2])
        mark_negative(axes, np.arange(6.0), np.ones(6), values)
        marks = {line.get_color(): line.get_xdata().tolist() for line in axes.lines}
        assert marks == {"black": [1.0, 5.0], "white": [3.0]}

    def test_units(self) -> None:
        """Angles are in degrees; their errors stay as they are compared, and so do rates."""
        assert unit_shown("theta_max", "rad") == ("degrees", math.degrees(1))
        assert unit_shown("orientation_error", "rad") == ("rad", 1)
        assert unit_shown("precession_rate", "rad/s") == ("rad/s", 1)

    def test_words(self) -> None:
        """A parameter is named in words, without a formula; an element of an array by its sign."""
        assert name_of("initial.theta_deg") == "initial inclination"
        assert name_of("initial.omega3") == "initial spin"
        assert name_of("top.inertia(2)") == "moment of inertia I\u2082"
