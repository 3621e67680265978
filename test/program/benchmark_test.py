"""The study of published benchmarks: its table, and what it refuses."""

import csv
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]

TIPS = {
    "com_x": -0.15041682274564175981,
    "com_y": -0.72416559163689565075,
    "com_z": -0.67302226956044409605,
}
"""The tip of the heavy top at t = 2, with twenty digits (test/integrators/literature_test.pf)."""


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
        self.assertIn("1 published figure; largest error", result.stdout)

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
        """One of two published trajectories has eleven digits, the other six."""
        result, rows = self.run_program("--set=benchmark.cases=tumbling_brick")
        self.assertEqual(result.returncode, 0, result.stderr)
        errors = [float(row["published_error"]) for row in rows]
        self.assertTrue(all(1e-12 < error < 1e-11 for error in errors[:3]), errors)
        self.assertTrue(all(1e-7 < error < 1e-6 for error in errors[3:]), errors)
        self.assertIn("6 published figures; largest error", result.stdout)

    def test_refusals(self) -> None:
        """A benchmark that is not in the catalogue is refused, with the nearest name."""
        result, rows = self.run_program("--set=benchmark.cases=heavy_tops")
        self.assertEqual((result.returncode, rows), (2, []))
        self.assertIn("there is no benchmark 'heavy_tops'", result.stderr)
        self.assertIn("did you mean 'heavy_top'?", result.stderr)
