"""Tests of the figures of work-precision studies, and of the styles of methods."""

import dataclasses
import itertools
import subprocess
import unittest
import unittest.mock

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from conftest import listed
from plot_case import STAGES, TableCase, a_precision
from spintop_figures.methods import known, precision
from spintop_figures.registry import FIGURES
from spintop_figures.style.look import lightness

AXES = ("initial.spin_ratio", "initial.theta")


def listed_methods() -> dict[str, dict]:
    return {entry["name"]: entry for entry in listed("methods")}


def a_map_of_problems() -> str:
    """A study over three by four values."""
    grid = itertools.product((1.0, 3.0, 10.0), (0.1, 0.5, 1.0, 2.0))
    return a_precision(
        {f"top.{i}/{x}/{y}": 0.5 + x * y / 30 for i, (x, y) in enumerate(grid)}, AXES
    )


class StyleTest(unittest.TestCase):
    """A method is drawn alike in every figure, and unlike others."""

    def test_methods(self) -> None:
        """Family and order are those of the program; each method has a style of its own."""
        methods = listed_methods()
        assert len(methods) > 20
        styles = set()
        for name, entry in methods.items():
            assert known.known(name).family == entry["family"]
            assert known.known(name).order == entry["order"]
            style = known.style_of(name)
            styles.add((style["marker"], str(style["linestyle"])))
            for table in entry["tables"] or ():
                assert known.known(table).family == entry["family"]
        assert len(styles) == len(methods)
        assert len({*known.MARKERS, known.look_of(known.OTHER).marker}) == len(known.MARKERS) + 1
        assert len(known.MARKERS) > len({entry["family"] for entry in methods.values()})
        assert known.known("heyoka").family == known.OTHER

    def test_no_program(self) -> None:
        """No program is asked, which may be another one or slow."""
        self.addCleanup(known.known_methods.cache_clear)
        known.known_methods.cache_clear()
        with unittest.mock.patch.object(subprocess, "run", side_effect=AssertionError):
            assert known.known("rkmk_4").order == 4

    def test_new_method(self) -> None:
        """A method that the program gets is drawn with its family and its order."""
        entry = {"name": "new_6", "family": "Lie group", "order": 6, "kind": "fixed"}
        self.addCleanup(known.known_methods.cache_clear)
        known.known_methods.cache_clear()
        registry = [*listed_methods().values(), entry | {"tables": None}]
        with unittest.mock.patch.object(known, "listed", return_value={"methods": registry}):
            assert (known.known("new_6").family, known.known("new_6").order) == ("Lie group", 6)
            assert known.style_of("new_6")["marker"] == known.style_of("rkmk_4")["marker"]

    def test_own_methods(self) -> None:
        """Methods of a user's own differ in colour, marker and dashes, also in grey print."""
        one, other, third = (known.style_of(f"table:{name}") for name in ("one", "other", "third"))
        for pair in itertools.combinations((one, other, third), 2):
            for key in ("color", "marker", "linestyle"):
                assert pair[0][key] != pair[1][key]
            assert abs(lightness(pair[0]["color"]) - lightness(pair[1]["color"])) > 0.05

    def test_formulations(self) -> None:
        """A formulation fills the marker, and changes nothing else."""
        one, other = (known.style_of("dop853", name) for name in ("lagrange", "rigid_body"))
        assert {key for key in one if one[key] != other[key]} == {"fillstyle"}


class PrecisionFiguresTest(TableCase):
    def test_choice(self) -> None:
        """Curves of few problems; a map of many over two parameters."""
        curves = "precision_time precision_work orders"
        assert self.figures_of(a_precision()) == curves
        assert self.figures_of(a_precision({"one": 1.0, "two": 2.0})) == curves
        assert self.figures_of(a_map_of_problems()) == "tolerance_map"

    def test_refusals(self) -> None:
        table = self.read(a_map_of_problems())
        assert precision.object_to_precision(table) == "has 12 problems, more than fit (6)"
        failed = a_precision().replace(",ok,", ",pole,")
        table = self.read(failed)
        assert "no method that went well and takes steps" in precision.object_to_precision(table)
        assert precision.object_to_tolerance_map(table) == "is no study over two parameters"
        text = "\n".join(line for line in a_precision().split("\n") if ",steps " not in line)
        refusal = next(k for k in FIGURES if k.name == "orders").refusal
        table = self.read(text)
        assert "with several fixed step sizes" in refusal(table)

    def curves(self) -> dict[str, precision.Curve]:
        rows = self.read(a_precision()).rows[::-1]
        curves = precision.curves_of(rows, ("time_s", "error_max"))
        return {curve.label: curve for curve in curves}

    def test_curves(self) -> None:
        """From coarse to fine; formulations where there are several; without what failed."""
        curves = self.curves()
        assert len(curves) == len(STAGES) + 1
        assert "RK4, Lagrange" in curves
        assert "ODE45" in curves
        assert "Galerkin" not in curves
        for curve in curves.values():
            assert (np.diff(curve.rows["time_s"]) > 0).all()

    def test_drawn(self) -> None:
        """Lines have the times and errors of the table, and the exact solution is there."""
        table = self.read(a_precision())
        axes = precision.draw_precision_time(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        rows = self.curves()["splitting 8"].rows
        drawn = lines["splitting 8"].get_data()
        np.testing.assert_array_equal(drawn, (rows["time_s"], rows["error_max"]))
        texts = {text.get_text(): text for text in axes.texts}
        assert texts["exact solution"].xy == (2e-6, 3e-15)
        assert precision.FLOOR in {" ".join(text.split()) for text in texts}

    def test_best(self) -> None:
        """Of each family the method that is the cheapest at the target has its name and colour."""
        curves = [curve for curve in self.curves().values() if curve.method != "exact"]
        table = self.read(a_precision())
        best = precision.best_of_families(table.rows, "time_s")
        assert len({known.known(curve.method).family for curve in best}) == len(best)
        for curve in curves:
            family = known.known(curve.method).family
            mate = next(each for each in best if known.known(each.method).family == family)
            if np.isfinite(precision.time_to(curve)):
                assert precision.time_to(mate) <= precision.time_to(curve)
        draws = (precision.draw_precision_time, precision.draw_precision_work)
        for draw, cost in zip(draws, ("time_s", "evaluations"), strict=True):
            figure = draw(table)
            axes = figure.axes[0]
            named = {curve.label for curve in precision.best_of_families(table.rows, cost)}
            entries = {text.get_text() for text in figure.axes[-1].get_legend().get_texts()}
            assert entries == named
            labels = {curve.label for curve in curves}
            lines = {line.get_label(): line for line in axes.lines if line.get_label() in labels}
            strong = {label for label, line in lines.items() if line.get_linewidth() > 1}
            assert (set(lines), strong) == (labels, named)
        texts = {text.get_text() for text in axes.texts}
        assert {"order", "1", "2", "4", "8"} <= texts

    @pytest.mark.slow
    def test_every_set(self) -> None:
        """Two or three methods of one study, whose curves are short: the best have names."""
        table = self.read(a_precision())
        table = dataclasses.replace(table, rows=table.rows[table.rows["steps"].between(1e3, 4e3)])
        methods = dict.fromkeys(name for name, _ in STAGES)
        pairs, threes = ([*itertools.combinations(methods, count)] for count in (2, 3))
        draws = [(chosen, precision.draw_precision_work) for chosen in pairs]
        draws += [(chosen, precision.draw_precision_time) for chosen in pairs + threes]
        for chosen, draw in draws:
            rows = table.rows[table.rows["method"].isin(chosen)]
            with self.subTest(chosen, figure=draw.__name__):
                figure = draw(dataclasses.replace(table, rows=rows))
                cost = "time_s" if draw is precision.draw_precision_time else "evaluations"
                best = precision.best_of_families(rows, cost)
                entries = figure.axes[-1].get_legend().get_texts()
                assert {curve.label for curve in best} == {text.get_text() for text in entries}

    def test_slopes(self) -> None:
        """The lines of the fan fall by their orders."""
        table = self.read(a_precision())
        axes = precision.draw_precision_work(table).axes[0]
        fan = [line for line in axes.lines if len(line.get_xdata()) == 2]
        steps = [np.diff(np.log(line.get_data()))[:, 0] for line in fan]
        np.testing.assert_allclose([-up / along for along, up in steps], (1, 2, 4, 8))

    def test_measured_orders(self) -> None:
        """The methods of the program have their orders; rounding has none."""
        rows = precision.equal_steps(self.compute("convergence"))
        curves = precision.curves_of(rows, (precision.STEP, "error_max"))
        fixed = {name for name, entry in listed_methods().items() if entry["kind"] == "fixed"}
        assert {curve.method for curve in curves} == fixed
        for curve in curves:
            order = known.known(curve.method).order
            self.assertAlmostEqual(precision.measured_order(curve.rows), order, delta=0.3)
        flat = rows.head(5).assign(error_max=[1e-15, 2e-15, 1e-15, 1e-15, 2e-15])
        assert np.isnan(precision.measured_order(flat))

    def test_orders_are_named(self) -> None:
        """The legend has each curve with both orders, as they lie at the coarsest step."""
        table = self.read(a_precision())
        axes = precision.draw_orders(table).axes[0]
        curves = precision.curves_of(precision.equal_steps(table), (precision.STEP, "error_max"))
        curves.sort(key=lambda curve: -curve.rows["error_max"].iloc[0])
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert names == [precision.with_order(curve, table) for curve in curves]

    def test_ink(self) -> None:
        """The names of families can be read on white, and keep their hue."""
        for family in (*known.families(), known.OTHER):
            ink, colour = known.ink_of(known.look_of(family)), known.look_of(family).colour
            ink, colour = np.array(ink), np.array(to_rgb(colour))
            linear = np.where(ink <= 0.04045, ink / 12.92, ((ink + 0.055) / 1.055) ** 2.4)
            contrast = 1.05 / (linear @ (0.2126, 0.7152, 0.0722) + 0.05)
            assert contrast >= 4.4, family
            assert np.abs(np.cross(ink, colour)).max() < 1e-12

    def test_time_to(self) -> None:
        """Between two settings times are as the power that joins them says."""
        curve = self.curves()["Gauss 8"]
        rows = curve.rows[curve.rows["error_max"] > 1e-13]
        slope, height = np.polyfit(np.log(rows["error_max"]), np.log(rows["time_s"]), 1)
        expected = np.exp(height + slope * np.log(precision.TARGET))
        self.assertAlmostEqual(precision.time_to(curve._replace(rows=rows)) / expected, 1, 6)
        assert np.isnan(precision.time_to(curve, 1e-30))
        self.assertAlmostEqual(precision.time_to(curve, 10.0) / curve.rows["time_s"].iloc[0], 1)

    def test_cheapest(self) -> None:
        """Each problem has the shortest time of its methods; the exact solution is left out."""
        table = self.read(a_map_of_problems())
        problems = precision.table_of_problems(table)
        assert problems.axes() == list(AXES)
        assert len(problems.rows) == 12
        names, rows = table.rows["problem"].unique(), table.rows[table.rows["method"] != "exact"]
        for problem, row in zip(names, problems.rows.itertuples(), strict=True):
            part = rows[rows["problem"] == problem]
            curves = precision.curves_of(part, ("time_s", "error_max"))
            times = sorted(time for c in curves if np.isfinite(time := precision.time_to(c)))
            assert row.time_s == times[0]
            self.assertAlmostEqual(row.ratio, times[1] / times[0])
        assert set(problems.rows["method"]) & {"exact"} == set()

    def test_cells(self) -> None:
        """Each cell has its number; methods are told once, the unit of times in the heading."""
        table = self.read(a_map_of_problems())
        rows = precision.table_of_problems(table).rows
        figure = precision.draw_tolerance_map(table)
        figure.draw_without_rendering()
        unit, factor = precision.unit_of(rows["time_s"].to_numpy())
        assert figure.axes[0].get_title(loc="left").endswith(unit)
        numbers = (rows["time_s"] * factor, rows["ratio"])
        for place, (column, values) in enumerate(zip(("method", "next"), numbers, strict=True)):
            axes, bar = figure.axes[place], figure.axes[2 + place]
            assert [text.get_text() for text in axes.texts] == [*map(precision.tell, values)]
            told = [text.get_text() for text in bar.get_yticklabels()]
            assert sorted(told) == sorted(rows[column].unique())
        assert [precision.tell(value) for value in (9.96, 12.3, np.nan)] == ["10.0", "12", ""]

    def test_unreached(self) -> None:
        """A problem that no method solves well enough has no time."""
        lines = a_map_of_problems().split("\n")
        text = "\n".join(line for line in lines if "top.0" not in line or ",rk2," in line)
        rows = precision.table_of_problems(self.read(text)).rows
        assert list(rows["status"]) == ["not reached", *["ok"] * 11]
        assert rows["method"][0] == "none"

    def study(self, chosen: str) -> str:
        """Six problems in which a method is the automatic choice."""
        lines = a_precision({f"top.{i}": 1.0 + i / 9 for i in range(6)}).split("\n")
        first = next(i for i, line in enumerate(lines) if line.startswith("problem,"))
        lines[first] += ",auto"
        for i, line in enumerate(lines[first + 1 :], first + 1):
            if line and line[0] != "#":
                lines[i] += ",yes" if f",{chosen}," in line else ",no"
        return "\n".join(lines)

    def test_choice_of_choice_of_method(self) -> None:
        """Ratios are those of the least times of rows that are exact enough."""
        table = self.read(self.study("gauss_8,space_frame"))
        choices = precision.choices_of(table)
        rows = table.rows[(table.rows["problem"] == "top.0") & (table.rows["status"] == "ok")]
        good = rows[rows["orientation_error"] <= 1e-6]
        own = good[good["auto"] == "yes"]["time_s"].min()
        (found,) = (c for c in choices[:4] if c.target == 1e-6)
        self.assertAlmostEqual(found.ratio, own / good["time_s"].min())
        figure = precision.draw_choice(table)
        assert "in 0 of 24 comparisons" in figure.get_suptitle().replace("\n", " ")
        self.assert_good_look(table, "choice")
        best = self.read(self.study("exact,closed_form"))
        title = precision.draw_choice(best).get_suptitle().replace("\n", " ")
        assert title.endswith("takes at most 1.00 times as long as the cheapest method")

    def test_refusals_of_choice_of_method(self) -> None:
        none = self.read(self.study("nobody"))
        assert self.refusal("choice", none) == "has no row of the automatic choice"
        few = self.study("exact,closed_form").replace("top.5", "top.4").replace("top.3", "top.4")
        table = self.read(few)
        assert "fewer than 5 problems" in self.refusal("choice", table)

    def test_figure(self) -> None:
        """A line a publication, with the errors of its quantities and the time of the run."""
        table = self.compute("benchmarks")
        assert self.refusal("benchmarks", table) == ""
        self.assert_good_look(table, "benchmarks", ("'cvode_gyro'", "'engine_forward_test'"))
        axes = next(kind for kind in FIGURES if kind.name == "benchmarks").draw(table).axes[0]
        rows = table.rows[table.rows["published_error"].notna()]
        groups = rows.groupby(["benchmark", "published_method"], sort=False)
        assert len(axes.get_yticks()) == len(groups)
        drawn = [line for line in axes.lines if line.get_marker() == "D"]
        for line, (_, part) in zip(drawn, groups, strict=True):
            np.testing.assert_array_equal(line.get_xdata(), part["published_error"])

    def test_studies(self) -> None:
        """All figures, without a warning of the layout."""
        curves = {"precision_time", "precision_work", "orders"}
        tables = {
            "one": (a_precision(), curves),
            "two": (a_precision({"slow": 1.0, "wheel": 2.0}), curves),
            "grid": (a_map_of_problems(), {"tolerance_map"}),
        }
        self.check_drawn(tables)
