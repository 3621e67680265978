"""Tests of the figures of work-precision studies, and of the styles of methods."""

import itertools
import os
import re
import subprocess
import sys
import unittest
import warnings
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts")]

from figures.methods import FAMILIES, ORDERS, family_of, style_of  # noqa: E402
from figures.orders import STEP, equal_steps, measured_order  # noqa: E402
from figures.precision import Curve, curves_of, draw_precision_time, object_to_precision  # noqa: E402
from figures.registry import FIGURES  # noqa: E402
from figures.table import read_table  # noqa: E402
from figures.tolerance_map import (  # noqa: E402
    TARGET,
    object_to_tolerance_map,
    table_of_problems,
    time_to,
)
from plot_case import STAGES, TableCase, a_precision  # noqa: E402

EXE = os.environ["SPINTOP_EXE"]
AXES = ("initial.spin_ratio", "initial.theta")


def listed_methods() -> dict[str, str]:
    """The methods that `spintop list methods` has, with the rest of their lines."""
    command = [EXE, "list", "methods"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^  (\w+) +(.*)$", text.partition("tables of")[0], re.MULTILINE)
    return {name: rest for name, rest in lines if name != "auto"}


def a_map_of_problems() -> str:
    """A study over three by four values."""
    grid = itertools.product((1.0, 3.0, 10.0), (0.1, 0.5, 1.0, 2.0))
    return a_precision(
        {f"top.{i}/{x}/{y}": 0.5 + x * y / 30 for i, (x, y) in enumerate(grid)}, AXES
    )


class StyleTest(unittest.TestCase):
    """A method is drawn alike in every figure, and unlike others."""

    def test_methods(self) -> None:
        """Each method of the program has a family, and a style of its own without colours."""
        methods = listed_methods()
        self.assertGreater(len(methods), 20)
        styles = set()
        for name in methods:
            self.assertNotIn(family_of(name).name, ("other methods", "other programs"))
            style = style_of(name)
            styles.add((style["marker"], str(style["linestyle"])))
        self.assertEqual(len(styles), len(methods))
        markers = [family.marker for family in FAMILIES]
        self.assertEqual(len(markers), len(set(markers)))

    def test_orders(self) -> None:
        """The orders are those that the program lists."""
        orders = {
            name: int(match[1])
            for name, rest in listed_methods().items()
            if (match := re.match(r"order (\d+) fixed ", rest))
        }
        self.assertEqual(ORDERS, orders)

    def test_formulations(self) -> None:
        """A formulation fills the marker, and changes nothing else."""
        one, other = (style_of("dop853", name) for name in ("lagrange", "rigid_body"))
        self.assertEqual({key for key in one if one[key] != other[key]}, {"fillstyle"})


class ChoiceTest(TableCase):
    """Which figures belong to a study."""

    def test_choice(self) -> None:
        """Curves of few problems; a map of many over two parameters."""
        curves = "precision_time precision_work orders"
        self.assertEqual(self.figures_of(a_precision()), curves)
        self.assertEqual(self.figures_of(a_precision({"one": 1.0, "two": 2.0})), curves)
        self.assertEqual(self.figures_of(a_map_of_problems()), "tolerance_map")

    def test_refusals(self) -> None:
        """The reason is told."""
        table = read_table(self.put("a.csv", a_map_of_problems()))
        self.assertEqual(object_to_precision(table), "has 12 problems, more than fit (6)")
        failed = a_precision().replace(",ok,", ",pole,")
        table = read_table(self.put("b.csv", failed))
        self.assertIn("no method that went well and takes steps", object_to_precision(table))
        self.assertEqual(object_to_tolerance_map(table), "is no study over two parameters")
        text = "\n".join(line for line in a_precision().split("\n") if ",steps " not in line)
        refusal = next(k for k in FIGURES if k.name == "orders").refusal
        table = read_table(self.put("c.csv", text))
        self.assertIn("with several fixed step sizes", refusal(table))


class CurveTest(TableCase):
    """The curves and what is found from them."""

    def curves(self) -> dict[str, Curve]:
        """The curves of a made-up study, by their labels."""
        rows = read_table(self.put("a.csv", a_precision())).rows
        return {curve.label: curve for curve in curves_of(rows[::-1], ("time_s", "error_max"))}

    def test_curves(self) -> None:
        """From coarse to fine; formulations where there are several; without what failed."""
        curves = self.curves()
        self.assertEqual(len(curves), len(STAGES) + 1)
        self.assertIn("rk4, lagrange", curves)
        self.assertIn("ode45", curves)
        self.assertNotIn("galerkin", curves)
        for curve in curves.values():
            self.assertTrue((np.diff(curve.rows["time_s"]) > 0).all())

    def test_drawn(self) -> None:
        """Lines have the times and errors of the table, and the exact solution is there."""
        table = read_table(self.put("a.csv", a_precision()))
        axes = draw_precision_time(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        rows = self.curves()["splitting_8"].rows
        for data, name in zip(
            lines["splitting_8"].get_data(), ("time_s", "error_max"), strict=True
        ):
            np.testing.assert_array_equal(data, rows[name])
        self.assertEqual([text.get_text() for text in axes.texts], ["exact solution"])
        self.assertEqual(axes.texts[0].xy, (2e-6, 3e-15))

    def test_measured_orders(self) -> None:
        """The methods of the program have their orders; rounding has none."""
        command = [EXE, "--quiet", "-o", self.folder, TESTS.parent / "input" / "convergence.nml"]
        subprocess.run(command, check=True, capture_output=True)
        rows = equal_steps(read_table(self.folder / "convergence.csv"))
        curves = curves_of(rows, (STEP, "error_max"))
        self.assertEqual({curve.method for curve in curves}, set(ORDERS))
        for curve in curves:
            self.assertAlmostEqual(measured_order(curve.rows), ORDERS[curve.method], delta=0.3)
        flat = rows.head(5).assign(error_max=[1e-15, 2e-15, 1e-15, 1e-15, 2e-15])
        self.assertTrue(np.isnan(measured_order(flat)))

    def test_time_to(self) -> None:
        """Between two settings times are as the power that joins them says."""
        curve = self.curves()["gauss_8"]
        rows = curve.rows[curve.rows["error_max"] > 1e-13]
        slope, height = np.polyfit(np.log(rows["error_max"]), np.log(rows["time_s"]), 1)
        expected = np.exp(height + slope * np.log(TARGET))
        self.assertAlmostEqual(time_to(curve._replace(rows=rows)) / expected, 1, 6)
        self.assertTrue(np.isnan(time_to(curve, 1e-30)))
        self.assertAlmostEqual(time_to(curve, 10.0) / curve.rows["time_s"].iloc[0], 1)


class MapTest(TableCase):
    """The map over two parameters."""

    def test_cheapest(self) -> None:
        """Each problem has the shortest time of its methods; the exact solution is left out."""
        table = read_table(self.put("a.csv", a_map_of_problems()))
        problems = table_of_problems(table)
        self.assertEqual(problems.axes(), list(AXES))
        self.assertEqual(len(problems.rows), 12)
        for problem, row in zip(
            table.rows["problem"].unique(), problems.rows.itertuples(), strict=True
        ):
            part = table.rows[table.rows["problem"] == problem]
            curves = [c for c in curves_of(part, ("time_s", "error_max")) if c.method != "exact"]
            times = sorted(time for c in curves if np.isfinite(time := time_to(c)))
            self.assertEqual(row.time_s, times[0])
            self.assertAlmostEqual(row.ratio, times[1] / times[0])
        self.assertEqual(set(problems.rows["method"]) & {"exact"}, set())

    def test_unreached(self) -> None:
        """A problem that no method solves well enough has no time."""
        lines = a_map_of_problems().split("\n")
        text = "\n".join(line for line in lines if "top.0" not in line or ",rk2," in line)
        rows = table_of_problems(read_table(self.put("a.csv", text))).rows
        self.assertEqual(list(rows["status"]), ["not reached", *["ok"] * 11])
        self.assertEqual(rows["method"][0], "none")


class DrawTest(TableCase):
    """Runs the script."""

    def test_studies(self) -> None:
        """All figures, without a warning of the layout."""
        curves = {"precision_time", "precision_work", "orders"}
        tables = {
            "one": (a_precision(), curves),
            "two": (a_precision({"slow": 1.0, "wheel": 2.0}), curves),
            "grid": (a_map_of_problems(), {"tolerance_map"}),
        }
        paths = [self.put(f"{name}.csv", text) for name, (text, _) in tables.items()]
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            self.assertEqual(self.call(*paths), (0, ""))
        expected = {f"{name}_{kind}" for name, (_, kinds) in tables.items() for kind in kinds}
        self.check_pictures(self.folder, expected)


if __name__ == "__main__":
    unittest.main()
