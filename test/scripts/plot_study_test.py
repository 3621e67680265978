"""Tests of scripts/plot: the figures of stability studies, of sweeps over grids, of events."""

import dataclasses
import itertools
import math
import warnings

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb

from plot_case import TableCase, a_map, a_stability, a_table, some_events
from spintop_figures.methods.trials import NO_TRIAL, VERDICTS, digits_of, letters_of, trials
from spintop_figures.sweeps.curves import draw_curves
from spintop_figures.sweeps.maps import COLOURS, KAPITZA, draw_maps, find_kapitza_limit, make_grid
from spintop_figures.sweeps.quantities import QUANTITIES, quantities_of
from spintop_figures.sweeps.statistics import is_even
from spintop_figures.tables.table import Table, TableError, read_table


def lightness(colour: object) -> float:
    """Lightness of a colour in print without colours, from 0 to 1 (ITU-R BT.601)."""
    return float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114)))


class PlotStudyTest(TableCase):
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
        """The colours of maps lighten from end to end."""
        shades = [lightness(COLOURS(i / 9)) for i in range(10)]
        assert shades == sorted(shades)

    def test_entries(self) -> None:
        """A method has an entry; its other formulations have entries of their own."""
        rows = trials(self.read(a_stability()))
        expected = ["RK4", "RK4, Lagrange", "new"]
        assert list(rows["entry"]) == 2 * expected
        families = ["explicit Runge-Kutta", "explicit Runge-Kutta", "other programs"]
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
        """Reasons to give up that begin alike have letters of their own."""
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

    def test_equal_panels(self) -> None:
        """Panels have one size; the lowest of each column, and no other, names the parameter."""
        names = ("growth_rate", "lyapunov_exponent", "evaluations")
        axes = draw_curves(self.sweep({name: lambda i: 1.0 + i for name in names})).axes
        assert [bool(panel.get_xlabel()) for panel in axes] == [False, True, True]
        assert {len(panel.get_subplotspec().colspan) for panel in axes} == {1}

    def test_chaos(self) -> None:
        """Of many cases those that are far apart are dots, not joined by lines."""
        table = self.sweep({"growth_rate": lambda i: 1.0 + (i if i < 40 else 60 * (i % 2))})
        line, dots = draw_curves(table).axes[0].lines[-2:]
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
        paths = [self.put(f"{name}.csv", text) for name, (text, _) in tables.items()]
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            assert self.call(*paths) == (0, "")
        expected = {f"{name}_{kind}" for name, (_, kinds) in tables.items() for kind in kinds}
        self.check_pictures(self.folder, expected)
