"""Fits: true parameters from synthetic measurements, intervals that cover, what is refused."""

import itertools
import math
import random
import sys
import unittest

import numpy as np

from program_test import ROOT, ProgramCase

sys.path.insert(0, str(ROOT / "python"))

from spintop_figures.registry import choose_figures
from spintop_figures.tables.table import read_table

TOP = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial theta = 0.6, theta_rate = 0.3, psi_rate = 14 /
"""
SPAN = "&span t_end = 6, samples = 61 /\n"
ANGLES = "'phi', 'theta', 'psi'"
FIT = """\
&study kind = 'fit' /
&fit data = 'data.csv', unknown = 'top.inertia(1)', 'top.inertia(3)', 'initial.psi_rate' /
"""
TRUTH = (0.875, 0.25, 14.0)
NOISE = 0.002
FITS = 120


class FitCase(ProgramCase):
    """Fits of one synthetic motion."""

    def measure(self, scene: str = TOP, columns: str = ANGLES) -> None:
        """Compute the motion to be measured."""
        table = self.compute(
            self.write(scene + SPAN + f"&output columns = 't', {columns} /\n", "truth.nml")
        )
        self.names = table.names
        self.truth = [[float(cell) for cell in row] for row in table.rows]

    def add_noise(self, seed: int, noise: float = NOISE) -> None:
        """Write measurements with errors."""
        source = random.Random(seed)
        rows = [[row[0], *(x + source.gauss(0, noise) for x in row[1:])] for row in self.truth]
        lines = [",".join(self.names), *(",".join(map(repr, row)) for row in rows)]
        (self.folder / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def count_covered(self, fits: int) -> list[int]:
        """How many intervals contain the true value, for each parameter."""
        self.measure()
        scene = self.write(TOP + FIT)
        covered = [0] * len(TRUTH)
        for seed in range(fits):
            self.add_noise(seed)
            table = self.compute(scene)
            ends = zip(table.column("lower"), table.column("upper"), TRUTH, strict=True)
            for i, (lower, upper, true) in enumerate(ends):
                self.assertLess(lower, upper)
                covered[i] += lower <= true <= upper
        return covered


class SyntheticTest(FitCase):
    """Measurements of known motions."""

    def test_exact_measurements_give_the_parameters(self) -> None:
        """Without noise the true values are found from others, and the residuals vanish."""
        self.measure()
        self.add_noise(0, 0)
        start = TOP.replace("0.875, 0.875, 0.25", "0.9, 0.9, 0.24").replace("= 14", "= 14.3")
        table = self.compute(self.write(start + FIT))
        for found, true in zip(table.column("estimate"), TRUTH, strict=True):
            self.assertAlmostEqual(found / true, 1, delta=1e-8)
        for place, true in enumerate(TRUTH):
            lower, upper = (table.column(name)[place] for name in ("lower", "upper"))
            self.assertTrue(lower <= table.column("estimate")[place] <= upper)
            self.assertLess(upper - lower, 1e-12 * true)
        residuals = self.table("scene.residuals")
        self.assertEqual(len(residuals.rows), 61)
        for name in ("phi", "theta", "psi"):
            self.assertLess(max(map(abs, residuals.column(f"{name}_residual"))), 1e-7)
            self.assertEqual(residuals.column(name), [float(r) for r in residuals.column(name)])
        self.assertEqual(table.last_line, "# status: ok")

    def test_exact_measurements_of_an_integrated_motion(self) -> None:
        """The same with methods whose tolerance bounds the residuals, from true values and others.

        Equations of symmetric tops keep the body symmetric where I1 alone is sought.
        """
        self.measure()
        self.add_noise(0, 0)
        others = TOP.replace("0.875, 0.875, 0.25", "0.9, 0.9, 0.24").replace("= 14", "= 14.3")
        methods = "dop853", "taylor", "ode45' formulation = 'space_frame"
        for method, start in itertools.product(methods, (TOP, others)):
            control = f"&integration method = '{method}' relative_tolerance = 1e-9 /\n"
            table = self.compute(self.write(start + control + FIT))
            self.assertEqual(table.last_line, "# status: ok", (method, start))
            columns = zip(*map(table.column, ("estimate", "lower", "upper")), TRUTH, strict=True)
            for found, lower, upper, true in columns:
                self.assertAlmostEqual(found / true, 1, delta=1e-6)
                self.assertTrue(lower < found < upper, (method, lower, upper))
                self.assertLess(upper - lower, 1e-5 * true)

    def test_intervals_cover(self) -> None:
        """The true values lie in the 95 % intervals as often as they should: a binomial count."""
        for count in self.count_covered(FITS):
            self.assertLess(abs(count - 0.95 * FITS), 4 * math.sqrt(FITS * 0.95 * 0.05))

    def test_covariance_and_errors_belong_together(self) -> None:
        """The variances are the squares of the errors; known deviations scale them."""
        self.measure()
        self.add_noise(1)
        known: list[float] = []
        for factor in (1, 5):
            text = (TOP + FIT).replace("'data.csv',", f"'data.csv', sigma = {factor * NOISE},")
            table = self.compute(self.write(text))
            errors = table.column("standard_error")
            keys = table.texts("parameter")
            for i, key in enumerate(keys):
                column = table.column(f"covariance__{key}")
                self.assertAlmostEqual(column[i] / errors[i] ** 2, 1, delta=1e-12)
                for k in range(3):
                    self.assertLess(abs(column[k]), errors[i] * errors[k] * (1 + 1e-12))
            known.append(errors[0])
        self.assertAlmostEqual(known[1] / known[0], 5, delta=1e-6)

    def test_gyroscope_of_an_asymmetric_body(self) -> None:
        """Readings of three rates of a damped body, which is integrated."""
        scene = (
            "&top mass = 1, inertia = 0.9, 0.7, 0.3, length = 0.5, damping = 3*0.02 /\n"
            "&initial theta = 0.6, omega = 0.5, 0.3, 4.0 /\n"
            "&integration relative_tolerance = 1e-13 /\n"
        )
        self.measure(scene, "'omega1', 'omega2', 'omega3'")
        self.add_noise(3, 1e-4)
        fit = FIT.replace("'initial.psi_rate'", "'top.inertia(2)', 'top.damping(3)'")
        table = self.compute(self.write(scene.replace("0.9, 0.7, 0.3", "0.88, 0.71, 0.31") + fit))
        truth = (0.9, 0.3, 0.7, 0.02)
        errors = table.column("standard_error")
        for found, true, error in zip(table.column("estimate"), truth, errors, strict=True):
            self.assertLess(abs(found - true), 5 * error)
            self.assertLess(error, 0.02 * true)

    def test_accelerometer(self) -> None:
        """Its readings alone give the length and the spin, without noise exactly."""
        self.measure(columns="'accelerometer1', 'accelerometer2', 'accelerometer3'")
        self.add_noise(0, 0)
        start = TOP.replace("= 0.85", "= 0.83").replace("= 14", "= 14.2")
        fit = FIT.replace("'top.inertia(1)', 'top.inertia(3)'", "'top.length'")
        table = self.compute(self.write(start + fit))
        for found, true in zip(table.column("estimate"), (0.85, 14.0), strict=True):
            self.assertAlmostEqual(found / true, 1, delta=1e-8)

    def test_accelerometer_of_a_body_in_air(self) -> None:
        """With drag and a moving pivot it reads the acceleration of the centre of mass, and g."""
        step, amplitude, rate = 1e-3, 0.01, 30.0
        scene = (
            "&top mass = 1.3, inertia_tensor(1,:) = 0.9, 0.1, 0.05\n"
            "     inertia_tensor(2,2:3) = 0.8, -0.02, inertia_tensor(3,3) = 0.6\n"
            "     centre_of_mass = 0.1, -0.05, 0.5 /\n"
            "&initial theta = 0.6, omega = 0.5, 0.3, 4.0 /\n"
            "&effects drag_force = 0.4\n"
            f"    vibration_amplitude = 0, 0, {amplitude}, vibration_rate = {rate} /\n"
            "&integration relative_tolerance = 1e-14 /\n"
            f"&span t_end = {4 * step}, samples = 5 /\n"
            "&output columns = 't', 'com_x', 'com_y', 'com_z', 'gamma1', 'gamma2', 'gamma3',\n"
            "    'accelerometer1', 'accelerometer2', 'accelerometer3' /\n"
        )
        table = self.compute(self.write(scene))
        weights = (-1, 16, -30, 16, -1)
        places = [table.column(f"com_{axis}") for axis in "xyz"]
        found = [
            sum(w * x for w, x in zip(weights, place, strict=True)) / (12 * step**2)
            for place in places
        ]
        found[2] += 9.81 - amplitude * rate**2 * math.cos(2 * rate * step)
        readings = [table.column(f"accelerometer{i}")[2] for i in (1, 2, 3)]
        vertical = [table.column(f"gamma{i}")[2] for i in (1, 2, 3)]
        self.assertAlmostEqual(math.hypot(*readings), math.hypot(*found), delta=1e-6)
        along = sum(a * b for a, b in zip(readings, vertical, strict=True))
        self.assertAlmostEqual(along, found[2], delta=1e-6)

    def test_law_of_a_spin_down(self) -> None:
        """The example: dry friction, damping, drag and the start, within 3 standard errors."""
        table = self.compute(ROOT / "input/spin_down.nml")
        known = (2e-4, 4e-5, 4e-6, 10)
        found = zip(known, table.column("estimate"), table.column("standard_error"), strict=True)
        for true, value, error in found:
            self.assertLess(abs(value - true), 3 * error)
            self.assertLess(error, 0.1 * value)

    def test_what_is_not_identifiable(self) -> None:
        """Angles tell ratios of mass and inertia only."""
        self.measure()
        self.add_noise(2)
        fit = FIT.replace("'initial.psi_rate'", "'top.mass'")
        table = self.compute(self.write(TOP + fit), code=3)
        self.assertIn("not_identifiable", table.last_line)
        values = table.column("singular_value")
        self.assertLess(values[2], 1e-8 * values[0])

    def test_a_parameter_that_does_not_enter(self) -> None:
        """The angles at the start say nothing of the body."""
        self.measure()
        self.truth = self.truth[:1]
        self.add_noise(3)
        fit = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'top.inertia(3)' /\n"
        table = self.compute(self.write(TOP + fit), code=3)
        self.assertIn("not_identifiable", table.last_line)


class RefusalTest(FitCase):
    """What is no fit."""

    def test_refusals(self) -> None:
        """Each with its place and what is wrong."""
        self.measure()
        self.add_noise(0)
        for old, new, message in [
            ("data = 'data.csv',", "", "there are no measurements"),
            ("data.csv", "none.csv", "none.csv"),
            (
                ", unknown = 'top.inertia(1)', 'top.inertia(3)', 'initial.psi_rate'",
                "",
                "nothing is",
            ),
            ("'initial.psi_rate'", "'top.shape'", "is not a number"),
            ("'initial.psi_rate'", "'top.inertia(3)'", "named twice"),
            ("'initial.psi_rate'", "'top.density'", "has no value"),
            ("'data.csv',", "'data.csv', columns = 'tip_error',", "errors, bounds"),
            ("'data.csv',", "'data.csv', averaged = 1e-3,", "first average begins before"),
            ("'data.csv',", "'data.csv', averaged = 9,", "intervals of averages overlap"),
            ("'data.csv',", "'data.csv', columns = 'omega1',", "omega1"),
            ("'data.csv',", "'data.csv', sigma = 1, 2,", "standard deviations"),
            ("&fit ", "&span nutations = 2 /\n&fit ", "span of a fit"),
            ("&fit ", "&span t_end = 2 /\n&fit ", "the last measurement"),
            ("&fit ", "&integration method = 'rk4', steps = 9 /\n&fit ", "fixed step"),
        ]:
            text = (TOP + FIT).replace(old, new)
            self.assertNotEqual(text, TOP + FIT)
            result = self.run_program(self.write(text))
            self.assertEqual(result.returncode, 2, new)
            self.assertIn("scene.nml", result.stderr)
            self.assertIn(message, result.stderr)

    def test_bad_measurements(self) -> None:
        """Times that do not increase, cells without numbers, too few rows."""
        for data, message in [
            ("t,theta\n0,1\n2,1\n1,1\n3,1\n4,1\n", "do not increase"),
            ("t,theta\n-1,1\n2,1\n3,1\n4,1\n", "before the start"),
            ("t,theta\n0,1\n2,one\n3,1\n4,1\n", "theta"),
            ("t,theta\n0,1\n2,inf\n3,1\n4,1\n", "theta has an infinite reading"),
            ("t,theta\n0,\n2,nan\n3,\n4,\n", "theta has no reading"),
            ("t,theta\n0,1\n2,nan\n3,1\n4,1\n", "3 measurements do not determine"),
            ("t,theta,theta_sigma\n0,1,\n2,1,\n3,1,nan\n4,1,\n", "no reading with a standard"),
            ("t,theta,theta_sigma\n0,1,1\n2,1,0\n3,1,1\n4,1,1\n", "not above 0"),
            ("t,thetta\n0,1\n2,1\n", "thetta"),
            ("t\n0\n2\n", "no column"),
            ("theta\n0\n2\n", "t"),
            ("t,theta\n", "t"),
            ("t,theta\n0,1\n2,1\n", "do not determine"),
        ]:
            (self.folder / "data.csv").write_text(data, encoding="utf-8")
            result = self.run_program(self.write(TOP + FIT))
            self.assertEqual(result.returncode, 2, data)
            self.assertIn(message, result.stderr)


class FigureTest(FitCase):
    """The residuals as a figure."""

    def test_residuals(self) -> None:
        """Two panels a measured column, with what the table says; parameters have no figure."""
        self.measure()
        self.add_noise(1)
        self.compute(self.write(TOP + FIT))
        self.assertEqual(choose_figures(read_table(self.folder / "output/scene.csv"))[0], [])
        table = read_table(self.folder / "output/scene.residuals.csv")
        (kind,) = choose_figures(table)[0]
        self.assertEqual(kind.name, "fit")
        *panels, _ = kind.draw(table).axes
        titles = [axes.get_title("left") for axes in panels[::2]]
        self.assertEqual(titles, ["φ (degrees)", "θ (degrees)", "ψ (degrees)"])
        for axes, name in zip(panels[1::2], self.names[1:], strict=True):
            shown = np.radians(axes.lines[-1].get_ydata())
            residuals = table.rows[name] - table.rows[f"{name}_fit"]
            np.testing.assert_allclose(shown, residuals, rtol=1e-12)


if __name__ == "__main__":
    unittest.main()
