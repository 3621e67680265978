"""Energy and norm over long runs of Taylor's method: errors as those of a random walk (Brouwer)."""

import math
import os
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "python")]

from spintop_figures.tables.table import read_table  # noqa: E402

EXE = os.environ["SPINTOP_EXE"]
TOPS, NUTATIONS, PERIOD, STEPS_A_NUTATION = 16, 20_000, 1.5, 8.4


def scene(k: int, formulation: str) -> str:
    """The k-th top: inclinations from 0.15 to 2.7 rad, loops, cusps and waves."""
    second = 0.7 if formulation == "rigid_body" and k % 2 else 0.875
    return f"""
&study kind = 'trajectory' /
&top mass = 1  inertia = {0.875 + 0.01 * k}, {second + 0.01 * k}, 0.25
     length = 0.8660254037844387 /
&initial theta = {0.15 + 2.55 * k / (TOPS - 1)}  phi_rate = {0.3 * (k % 3)}
         psi_rate = {1 + 4.5 * (7 * k % TOPS) / TOPS} /
&span t_end = {NUTATIONS * PERIOD}  samples = 201 /
&integration formulation = '{formulation}'  method = 'taylor'  relative_tolerance = 1e-17
             max_steps = 2000000 /
&output columns = 't', 'energy_error', 'norm_error' /
"""


class DriftTest(unittest.TestCase):
    """Root mean squares over an ensemble, in the first and in the last part of the span."""

    def sizes_of(self, formulation: str, column: str) -> tuple[float, float]:
        """The error about a tenth of the span, and at its end."""
        with tempfile.TemporaryDirectory() as folder:

            def run(k: int) -> list[float]:
                path = Path(folder) / f"{k}.nml"
                path.write_text(scene(k, formulation), encoding="utf-8")
                command = [EXE, "--quiet", "--threads", "1", "-o", folder, path]
                subprocess.run(command, check=True, timeout=600)
                return read_table(path.with_suffix(".csv")).rows[column].to_list()

            with ThreadPoolExecutor(os.cpu_count()) as pool:
                errors = list(pool.map(run, range(TOPS)))

        def size(first: int, last: int) -> float:
            some = [row[i] for row in errors for i in range(first, last)]
            return math.sqrt(sum(error**2 for error in some) / len(some))

        return size(10, 30), size(181, 201)

    def test_energy(self) -> None:
        """Of symmetric tops: the square root of time, within the rounding of the state."""
        early, late = self.sizes_of("space_frame", "energy_error")
        steps = NUTATIONS * STEPS_A_NUTATION
        self.assertLess(late, 1e-16 * math.sqrt(steps))
        self.assertLess(math.log(late / early) / math.log(9.5), 0.7)

    def test_norm(self) -> None:
        """Of the quaternion of any body."""
        _, late = self.sizes_of("rigid_body", "norm_error")
        self.assertLess(late, 2e-14)


if __name__ == "__main__":
    unittest.main()
