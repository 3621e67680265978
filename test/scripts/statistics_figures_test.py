"""Tests of the figures of statistics: words instead of names, angles in degrees."""

import math

import numpy as np
from matplotlib.figure import Figure

from plot_case import TableCase
from spintop_figures.registry import draw
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


class StatisticsTest(TableCase):
    """Statistics of a column in radians over bins of the inclination."""

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

    def test_means(self) -> None:
        """Means over the bins are in degrees, and named by what they are."""
        figure = self.figure("means")
        assert figure.get_suptitle() == "Means over initial inclination: 40 cases"
        panel = figure.axes[0]
        assert panel.get_title(loc="left") == "maximum inclination (degrees)"
        (line,) = panel.lines
        np.testing.assert_allclose(line.get_ydata(), np.degrees(MEAN))
        assert "(degrees)" in figure.axes[-1].get_xlabel()
