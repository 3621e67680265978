"""The study of published benchmarks: its table, and what it refuses."""

import csv
import math
import os
import subprocess
import tempfile
import unittest
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]

TIPS = {
    "com_x": -0.15041682274564175981,
    "com_y": -0.72416559163689565075,
    "com_z": -0.67302226956044409605,
}
"""The tip of the heavy top at t = 2, with twenty digits (test/integrators/literature_test.pf)."""


def product(a: Sequence[float], b: Sequence[float]) -> tuple[float, ...]:
    """The product of two quaternions."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    return (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )


def runge_kutta(
    slope: Callable[[float, list[float]], list[float]], start: list[float], end: float, steps: int
) -> list[float]:
    """The solution of y' = slope(t, y) at the end, by the classical method of order 4."""
    y, h = list(start), end / steps
    for n in range(steps):
        k1 = slope(n * h, y)
        k2 = slope((n + 0.5) * h, [a + h / 2 * b for a, b in zip(y, k1, strict=True)])
        k3 = slope((n + 0.5) * h, [a + h / 2 * b for a, b in zip(y, k2, strict=True)])
        k4 = slope((n + 1) * h, [a + h * b for a, b in zip(y, k3, strict=True)])
        stages = zip(y, k1, k2, k3, k4, strict=True)
        y = [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in stages]
    return y


class BenchmarkTest(unittest.TestCase):
    """Runs of the program on the catalogue."""

    def run_program(self, *arguments: str) -> tuple[subprocess.CompletedProcess, list[dict]]:
        """Run the program, and read its table."""
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run(
                [EXE, str(ROOT / "input" / "benchmarks.nml"), "-o", folder, *arguments],
                capture_output=True,
                text=True,
                timeout=1200,
            )
            path = Path(folder) / "benchmarks.csv"
            rows = []
            if path.exists():
                lines = path.read_text().splitlines()
                rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        return result, rows

    def test_heavy_top(self) -> None:
        """The truth has its sixteen digits, and the published figures are off by 1e-7 to 1e-5."""
        result, rows = self.run_program("--set=benchmark.cases=heavy_top")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(rows), 7)
        for row in rows:
            truth, published = float(row["truth"]), float(row["published"])
            if row["quantity"] in TIPS:
                self.assertLess(abs(truth - TIPS[row["quantity"]]), 2e-15)
            self.assertLess(float(row["truth_error"]), 1e-14)
            error = float(row["published_error"])
            self.assertAlmostEqual(error, abs(truth - published), places=15)
            self.assertTrue(1e-8 < error < 1e-5, error)
            self.assertLessEqual(float(row["error"]), float(row["goal"]))
            self.assertLessEqual(abs(float(row["value"]) - truth), float(row["goal"]))
            self.assertAlmostEqual(float(row["goal"]), error / 100, delta=1e-3 * error)
        self.assertIn("7 published figures; largest error", result.stdout)

    def test_quantities_without_a_figure(self) -> None:
        """A quantity without a published figure has its true value, and a goal of its own."""
        result, rows = self.run_program("--set=benchmark.cases=steady_cone")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({row["published"] for row in rows}, {"nan"})
        self.assertEqual({row["goal"] for row in rows}, {"1e-10"})
        length = 3 * 0.1 / 4
        angle = 10 - math.pi / 2  # of the tip: phi - pi/2
        expected = {
            "com_x": length * math.sin(math.pi / 3) * math.cos(angle),
            "com_y": length * math.sin(math.pi / 3) * math.sin(angle),
            "com_z": length / 2,
        }
        for row in rows:
            self.assertAlmostEqual(float(row["truth"]), expected[row["quantity"]], places=15)
            self.assertLess(abs(float(row["value"]) - float(row["truth"])), 1e-10)

    def test_free_bodies(self) -> None:
        """The truth of the test set is that of Jacobi's functions; a free box keeps its energy."""
        cases = "--set=benchmark.cases=euler_equations,tumbling_box"
        result, rows = self.run_program(cases)
        self.assertEqual(result.returncode, 0, result.stderr)
        jacobi = (-0.93965707987292040, -0.34211777540007491, 0.74141265961999530)
        for row, value, factor in zip(rows[:3], jacobi, (9 / 5, 3 / 4, 5 / 2), strict=True):
            self.assertAlmostEqual(float(row["truth"]), value * factor, delta=5e-16)
            self.assertTrue(5e-16 < float(row["published_error"]) < 3e-15)
            self.assertEqual(row["method"], "")
        self.assertAlmostEqual(float(rows[3]["truth"]), 0.49 / 3, places=16)
        self.assertAlmostEqual(float(rows[3]["published_error"]), 0.09 * 0.49 / 3, places=15)
        self.assertAlmostEqual(float(rows[4]["published_error"]), 0.07 * 0.49 / 3, places=15)
        self.assertIn("2 published figures; largest error", result.stdout)

    def test_free_symmetric_body(self) -> None:
        """Its attitude is a turn about the momentum and one about the axis, with constant rates."""
        result, rows = self.run_program("--set=benchmark.cases=free_symmetric_body")
        self.assertEqual(result.returncode, 0, result.stderr)
        t, momentum = 5.0, (0.5, 0.5, 0.5)  # I = (1, 1, 0.5), omega = (0.5, 0.5, 1)
        size = math.hypot(*momentum)
        half = size * t / 2  # the rate about the momentum is |L|/I1
        about_momentum = (math.cos(half), *(math.sin(half) * part / size for part in momentum))
        half = (1 - 0.5 / 1) * t / 2  # the rate about the axis is omega3 - L3/I1
        c, s = math.cos(half), math.sin(half)
        p0, p1, p2, p3 = about_momentum
        expected = (p0 * c - p3 * s, p1 * c + p2 * s, p2 * c - p1 * s, p3 * c + p0 * s)
        for row, value in zip(rows, expected, strict=True):
            self.assertAlmostEqual(float(row["truth"]), value, places=15)
        errors = [float(row["published_error"]) for row in rows]
        self.assertTrue(all(1e-6 < error < 2e-3 for error in errors), errors)

    def test_tumbling_brick(self) -> None:
        """One of two published trajectories has eleven digits, the other six; their attitudes, too.

        The published angles are relative to axes that turn about north with the Earth and with
        the longitude; seen from these, the true attitude has the published angles.
        """
        result, rows = self.run_program("--set=benchmark.cases=tumbling_brick")
        self.assertEqual(result.returncode, 0, result.stderr)
        errors = [float(row["published_error"]) for row in rows]
        self.assertTrue(all(1e-12 < error < 1e-11 for error in errors[:3]), errors)
        self.assertTrue(all(1e-7 < error < 1e-6 for error in errors[3:6]), errors)
        self.assertTrue(all(5e-13 < error < 5e-11 for error in errors[6:10]), errors)
        self.assertTrue(all(1e-7 < error < 1e-6 for error in errors[10:]), errors)
        self.assertIn("14 published figures; largest error", result.stdout)
        half = -(7.292115e-5 * 30 + 1.0027827516629e-6) / 2
        truth = [float(row["truth"]) for row in rows[6:10]]
        q0, q1, q2, q3 = product((math.cos(half), math.sin(half), 0, 0), truth)
        roll = math.atan2(2 * (q0 * q1 + q2 * q3), 1 - 2 * (q1**2 + q2**2))
        pitch = math.asin(2 * (q0 * q2 - q3 * q1))
        yaw = math.atan2(2 * (q0 * q3 + q1 * q2), 1 - 2 * (q2**2 + q3**2))
        for angle, first, fifth in (
            (roll, -0.9800251968615921, -56.15127539),
            (pitch, -0.06666555465260421, -3.819633201),
            (yaw, -0.07486336822299243, -4.289288509),
        ):
            self.assertAlmostEqual(angle, first, delta=6e-11)
            self.assertAlmostEqual(angle, math.radians(fifth), delta=2e-6)

    def test_bodies_of_two_codes(self) -> None:
        """The true values are those of Runge-Kutta steps in the variables of the source."""
        result, rows = self.run_program("--set=benchmark.cases=free_body,torqued_body")
        self.assertEqual(result.returncode, 0, result.stderr)

        def free(t: float, y: list[float]) -> list[float]:
            q0, q1, q2, q3, a, b, c = y
            vector = (q0 * a + q2 * c - q3 * b, q0 * b - q1 * c + q3 * a, q0 * c + q1 * b - q2 * a)
            rates = (5 * b * c / 6, -3 * c * a / 8, -2 * a * b / 3)
            return [-(q1 * a + q2 * b + q3 * c) / 2, *(part / 2 for part in vector), *rates]

        q0, q1, q2, q3, *_ = runge_kutta(free, [1, 0, 0, 0, 10, 20, 20], 0.1, 400)
        expected = (
            *(2 * (q1 * q3 + q0 * q2), 2 * (q2 * q3 - q0 * q1), 1 - 2 * (q1**2 + q2**2)),
            *(2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1)),
        )
        for row, value in zip(rows[:10], expected * 2, strict=True):
            self.assertAlmostEqual(float(row["truth"]), value, delta=1e-9)
            self.assertTrue(1e-9 < float(row["published_error"]) < 1e-8)

        def torqued(t: float, y: list[float]) -> list[float]:
            torque = 0.25 * math.sin(t) ** 2
            return [-2 * y[1] * y[2], 1.25 * y[0] * y[2], -0.5 * y[0] * y[1] + torque]

        found = runge_kutta(torqued, [1, 0, 0.9], 10, 4000)
        for row, value, factor in zip(rows[10:], found, (1.25, 2, 2.5), strict=True):
            self.assertAlmostEqual(float(row["truth"]), factor * value, delta=1e-9)
            self.assertLess(float(row["truth_error"]), 1e-15)

    def test_refusals(self) -> None:
        """A benchmark that is not in the catalogue is refused, with the nearest name."""
        result, rows = self.run_program("--set=benchmark.cases=heavy_tops")
        self.assertEqual((result.returncode, rows), (2, []))
        self.assertIn("there is no benchmark 'heavy_tops'", result.stderr)
        self.assertIn("did you mean 'heavy_top'?", result.stderr)
