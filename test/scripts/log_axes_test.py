"""Tests of log axes: labels as plain text, minor ticks as marks where matplotlib has them."""

import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "python"))

from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from spintop_figures.style.log_axes import (  # noqa: E402
    PlainPowers,
    draw_minor_ticks,
    simplify_log_axes,
)


def log_figure(low: float, high: float) -> tuple[Figure, list]:
    """A figure of two panels with a log axis that they share."""
    figure = Figure()
    FigureCanvasAgg(figure)
    panels = list(figure.subplots(1, 2, sharey=True))
    for axes in panels:
        axes.plot([1, 2], [low, high])
        axes.set(yscale="log", ylim=(low, high))
    return figure, panels


class LogAxesTest(unittest.TestCase):
    """Axes of many decades, of one, and of less."""

    def test_labels(self) -> None:
        """Powers of ten and their multiples are plain text; nothing is left of the formulas."""
        figure, (axes, _) = log_figure(1e-12, 1e3)
        simplify_log_axes(figure)
        labels = PlainPowers()
        labels.set_axis(axes.yaxis)
        places = [1e-12, 1.0, 1000.0]
        self.assertEqual(labels.format_ticks(places), ["10⁻¹²", "10⁰", "10³"])

    def test_short_axes(self) -> None:
        """Labels over less than two decades are numbers, with powers only if they are unusual."""
        ends = {
            (0.02, 0.06): "0.03",
            (2.0, 6.0): "3",
            (2e-6, 6e-6): "3\N{MULTIPLICATION SIGN}10⁻⁶",
            (2e5, 6e5): "3\N{MULTIPLICATION SIGN}10⁵",
        }
        for (low, high), expected in ends.items():
            figure, (axes, _) = log_figure(low, high)
            simplify_log_axes(figure)
            shown = [label.get_text() for label in axes.get_yticklabels(which="minor")]
            self.assertIn(expected, shown)
            self.assertFalse([text for text in shown if "$" in text])

    def test_minor_ticks(self) -> None:
        """They are where matplotlib has them, once on each panel."""
        figure, panels = log_figure(0.5, 2e2)
        before = [set(axes.yaxis.get_minorticklocs()) for axes in panels]
        decades = {1.0, 10.0, 100.0}
        figure, panels = log_figure(0.5, 2e2)
        taken = simplify_log_axes(figure)
        self.assertEqual([ticks.axes for ticks in taken], panels)
        for axes, ticks, expected in zip(panels, taken, before, strict=True):
            self.assertEqual(len(axes.yaxis.get_minorticklocs()), 0)
            draw_minor_ticks(ticks)
            inside = {y for y in axes.lines[-1].get_ydata() if 0.5 <= y <= 2e2}
            self.assertLessEqual({y for y in expected if 0.5 <= y <= 2e2} - decades, inside)
            self.assertLessEqual(inside - decades, expected)

    def test_labelled_minor_ticks(self) -> None:
        """An axis of less than a decade keeps them."""
        figure, panels = log_figure(2, 9)
        self.assertEqual(simplify_log_axes(figure), [])
        self.assertGreater(len(panels[0].yaxis.get_minorticklocs()), 0)

    def test_no_ticks_wanted(self) -> None:
        """Where minor ticks are off, none are drawn."""
        figure, (axes, other) = log_figure(1, 1e4)
        axes.tick_params(axis="y", which="minor", left=False)
        self.assertEqual([ticks.axes for ticks in simplify_log_axes(figure)], [other])


if __name__ == "__main__":
    unittest.main()
