"""The figure of the account of energy: what it shows is what the program computes."""

import numpy as np

from plot_case import TableCase, a_trajectory
from spintop_figures.motion.trajectory import draw_account
from spintop_figures.registry import FIGURES, choose_figures


class AccountTest(TableCase):
    """A top from 200 rad/s to rest."""

    def test_motion(self) -> None:
        """It sleeps, wakes, sinks below the pivot and comes to rest, with a balanced account."""
        table = self.compute("friction_to_rest")
        rows = table.rows
        assert "account" in [kind.name for kind in choose_figures(table)[0]]
        assert rows["energy_error"].abs().max() < 1e-9
        early, late = rows[rows["t"] < 10], rows[rows["t"] > 120]
        assert early["theta"].max() < np.radians(5)
        assert rows["theta"].max() > np.radians(150)
        assert late["kinetic"].abs().max() == 0
        assert late["omega3"].abs().max() == 0
        spent = rows["energy"].iloc[0] - rows["energy"].iloc[-1]
        self.assertAlmostEqual(-rows["work"].iloc[-1] / spent, 1, 10)

    def test_lines(self) -> None:
        """The panels show the columns; energy and what was taken add up to that of the start."""
        table = self.compute(
            "friction_to_rest", "span.samples=601", "output.columns=all", "effects.drag_force=0"
        )
        figure = draw_account(table)
        theta, spin, energy, error = figure.axes
        words = [text.get_text() for text in energy.get_legend().get_texts()]
        for name in ("taken by friction", "taken by drag"):
            assert name in words
        assert "taken by vibration" not in words
        top = max(area.get_paths()[0].vertices[:, 1].max() for area in energy.collections)
        self.assertAlmostEqual(top, table.rows["energy"].iloc[0], 9)
        lowest = energy.collections[-1].get_paths()[0].vertices[:, 1].min()
        assert lowest > table.rows["energy"].iloc[-1]
        np.testing.assert_allclose(theta.lines[0].get_ydata(), np.degrees(table.rows["theta"]))
        np.testing.assert_array_equal(spin.lines[-1].get_ydata(), table.rows["omega3"])
        shown = {line.get_label(): line.get_ydata() for line in energy.lines}
        np.testing.assert_array_equal(shown["energy"], table.rows["energy"])
        np.testing.assert_array_equal(shown["potential energy"], table.rows["potential"])
        largest = max(np.nanmax(line.get_ydata()) for line in error.lines[:1])
        assert largest == table.rows["energy_error"].abs().max()

    def test_other_tables(self) -> None:
        """A table without works has no such figure."""
        kind = next(kind for kind in FIGURES if kind.name == "account")
        assert "has no column" in kind.refusal(self.read(a_trajectory()))
