"""Tests of scripts/plot: the figures of stability studies, of sweeps over grids, of events."""

import dataclasses
import itertools
import os
import subprocess
import warnings

import numpy as np
from matplotlib.colors import to_rgb

from conftest import ROOT
from plot_case import TableCase, a_map, a_stability, a_table, some_events
from spintop_figures.methods.trials import NO_TRIAL, VERDICTS, trials
from spintop_figures.sweeps.curves import draw_curves
from spintop_figures.sweeps.maps import KAPITZA, draw_maps, find_kapitza_limit, make_grid
from spintop_figures.sweeps.quantities import quantities_of
from spintop_figures.tables.table import Table, TableError, read_table


def lightness(colour: object) -> float:
    """Lightness of a colour in print without colours, from 0 to 1 (ITU-R BT.601)."""
    return float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114)))


class ChoiceTest(TableCase):
    """The table decides which figures belong to it."""

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


class StabilityTest(TableCase):
    """Verdicts differ in print without colours; trials have names and digits."""

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

    def test_entries(self) -> None:
        """A method has an entry; its other formulations have entries of their own."""
        rows = trials(read_table(self.put("a.csv", a_stability())))
        expected = ["RK4", "RK4, Lagrange", "new"]
        assert list(rows["entry"]) == 2 * expected
        families = ["explicit Runge-Kutta", "explicit Runge-Kutta", "other programs"]
        assert list(rows["family"]) == 2 * families
        alone = read_table(self.put("b.csv", "\n".join(a_stability().splitlines()[:-3]) + "\n"))
        expected = ["RK4, space frame", "RK4, Lagrange", "new"]
        assert list(trials(alone)["entry"]) == expected


class MapTest(TableCase):
    """The grid and the scales of maps."""

    def test_grid(self) -> None:
        """Cells lie about their values, by ratios on a log axis; rows run through y first."""
        listed = "values(1,:) = 0.5, 1.0,"
        spaced = a_map().replace(listed, "spacing = 'linear', 'linear',")
        grid = make_grid(read_table(self.put("a.csv", spaced)))
        assert grid.logs == (False, False)
        assert grid.fill(np.arange(20.0))[:, 1].tolist() == [4, 5, 6, 7]
        assert grid.edges()[1].tolist() == [-5, 5, 15, 25, 35]
        for text in (a_map(), a_map().replace(listed, "spacing = 'log', 'linear',")):
            grid = make_grid(read_table(self.put("b.csv", text)))
            assert grid.logs == (True, False)
        np.testing.assert_allclose(grid.edges()[0], 10.0 ** np.arange(-0.5, 5))

    def test_words(self) -> None:
        """The type of a column follows from its cells."""
        table = read_table(self.put("a.csv", a_map()))
        words = [name for name in table.rows if not table.numeric(name)]
        assert words == ["status", "motion_class", "notes"]
        with self.assertRaisesRegex(TableError, "'wave' in theta_min is no number"):
            read_table(self.put("b.csv", a_map().replace("wave,0.1", "wave,wave", 1)))


class PanelsTest(TableCase):
    """Which panels there are, and what their curves join."""

    def sweep(self, columns: dict[str, object], count: int = 80) -> Table:
        """A sweep over one parameter; columns are functions of the number of the case."""
        names = list(columns)
        rows = [[i + 1, 1.0 + i, "ok", *(columns[name](i) for name in names)] for i in range(count)]
        table = a_table("sweep", ["case", "initial.omega3", "status", *names], rows)
        return read_table(self.put("sweep.csv", table))

    def test_constants(self) -> None:
        """What is constant has no panel but its value in the title; costs come last."""
        columns = {
            "evaluations": lambda i: 100 + i,
            "lyapunov_exponent": lambda i: 0.25,
            "growth_rate": lambda i: 1.0 + i,
        }
        table = self.sweep(columns)
        shown = [quantity.columns[0] for quantity in quantities_of(table)]
        assert shown == ["growth_rate", "evaluations"]
        title = draw_curves(table).get_suptitle().replace("\n", " ")
        assert "in all cases Lyapunov exponent: 0.25 1/s" in title
        free = self.sweep({"evaluations": lambda i: 0, "growth_rate": lambda i: 1.0 + i})
        assert len(draw_curves(free).axes) == 1
        assert "evaluations" not in draw_curves(free).get_suptitle()
        alone = self.sweep({"growth_rate": lambda i: 2.0})
        assert len(quantities_of(alone)) == 1

    def test_chaos(self) -> None:
        """Of many cases those that are far apart are dots, not joined by lines."""
        table = self.sweep({"growth_rate": lambda i: 1.0 + (i if i < 40 else 60 * (i % 2))})
        line, dots = draw_curves(table).axes[0].lines[-2:]
        assert dots.get_linestyle() == "None"
        assert len(dots.get_xdata()) >= 38
        joined = np.isfinite(line.get_ydata()[:40])
        assert joined.all()

    def test_kapitza(self) -> None:
        """The limit is where the multipliers of the program begin to be 1, for fast vibrations."""
        settings = ["sweep.count=2,40", "sweep.from=200,0.012", "sweep.to=400,0.05"]
        words = [word for setting in settings for word in ("--set", setting)]
        name = ROOT / "input" / "kapitza_map.nml"
        command = [os.environ["SPINTOP_EXE"], "--quiet", "-o", self.folder, *words, name]
        subprocess.run(command, check=True, capture_output=True)
        table = read_table(self.folder / "kapitza_map.csv")
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


class DrawTest(TableCase):
    """Runs the script."""

    def test_studies(self) -> None:
        """Stability, maps, curves and events, without a warning of the layout."""
        tables = {
            "stability": (a_stability(), {"verdicts", "costs"}),
            "map": (a_map(), {"maps"}),
            "curve": (a_map(axes=1), {"curves"}),
            "all_well": (a_map(axes=1).rpartition("20,")[0], {"curves"}),
            "top.events": (some_events(), {"events", "sections"}),
        }
        paths = [self.put(f"{name}.csv", text) for name, (text, _) in tables.items()]
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            assert self.call(*paths) == (0, "")
        expected = {f"{name}_{kind}" for name, (_, kinds) in tables.items() for kind in kinds}
        self.check_pictures(self.folder, expected)
