"""Constants of long motions by Taylor series: errors as those of a random walk (Brouwer)."""

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
TOPS, PERIOD, STEPS_A_NUTATION = 32, 1.5, 11
USUAL = 30_000
NUTATIONS = int(os.environ.get("SPINTOP_NUTATIONS", USUAL))
SIZES = {"energy": 1.0, "Lz": 3.0, "norm": 1.0}
"""Largest errors in 1e-16 times the root of the number of steps."""
POWERS = {"energy": 0.7, "Lz": 0.75, "norm": 0.7}
"""Largest powers of time."""
LARGEST_NORM = 2e-14
"""Of the error of the norm, over the usual span."""
ROTOR = "&effects rotor_momentum = 0, 0, 0.3 /"


def scene(k: int, formulation: str, more: str, symmetric: bool) -> str:
    """The k-th top: inclinations from 0.15 to 2.7 rad, loops, cusps and waves."""
    first = 0.875 + 0.005 * k
    second = first if symmetric or k % 2 == 0 else first - 0.175
    return f"""
&study kind = 'trajectory' /
&top mass = 1  inertia = {first}, {second}, 0.25  length = 0.8660254037844387 /
&initial theta = {0.15 + 2.55 * k / (TOPS - 1)}  phi_rate = {0.3 * (k % 3)}
         psi_rate = {1 + 4.5 * (7 * k % TOPS) / TOPS} /
{more}
&span t_end = {NUTATIONS * PERIOD}  samples = 201 /
&integration formulation = '{formulation}'  method = 'taylor'  relative_tolerance = 0
             max_steps = 200000000 /
&output columns = 't', 'energy_error', 'lz', 'norm_error' /
"""


class DriftTest(unittest.TestCase):
    """Root mean squares over an ensemble, in the first and in the last part of the span."""

    def sizes_of(self, *kind: object) -> dict[str, tuple[float, float]]:
        """The errors about a tenth of the span, and at its end, of each constant."""
        with tempfile.TemporaryDirectory() as folder:

            def run(k: int) -> dict[str, list[float]]:
                path = Path(folder) / f"{k}.nml"
                path.write_text(scene(k, *kind), encoding="utf-8")
                command = [EXE, "--quiet", "--threads", "1", "-o", folder, path]
                subprocess.run(command, check=True, timeout=3000)
                rows = read_table(path.with_suffix(".csv")).rows
                lz = rows["lz"].to_numpy()
                return {
                    "energy": rows["energy_error"].to_list(),
                    "Lz": ((lz - lz[0]) / max(abs(lz[0]), 0.5)).tolist(),
                    "norm": rows["norm_error"].to_list(),
                }

            with ThreadPoolExecutor(os.cpu_count()) as pool:
                errors = list(pool.map(run, range(TOPS)))

        def size(name: str, first: int, last: int) -> float:
            some = [row[name][i] for row in errors for i in range(first, last)]
            return math.sqrt(sum(error**2 for error in some) / len(some))

        if "SPINTOP_LIST" in os.environ:
            for name in errors[0]:
                print(name, *(f"{row[name][-1]:.1e}" for row in errors))
        return {name: (size(name, 10, 30), size(name, 181, 201)) for name in errors[0]}

    def check(self, *kind: object) -> None:
        """The errors grow with the root of time, and remain within the rounding of the state."""
        steps = NUTATIONS * STEPS_A_NUTATION
        for name, (early, late) in self.sizes_of(*kind).items():
            power = math.log(late / early) / math.log(9.5)
            print(f"{kind} {name:6} {early:.1e} {late:.1e} {power:.2f}", file=sys.stderr)
            with self.subTest(kind=kind, constant=name):
                self.assertLess(late, SIZES[name] * 1e-16 * math.sqrt(steps))
                self.assertLess(power, POWERS[name])
                if name == "norm" and NUTATIONS <= USUAL:
                    self.assertLess(late, LARGEST_NORM)

    def test_space_frame(self) -> None:
        """Symmetric tops.

        Over 1e5 nutations one of the 32 tops still drifts: energy and Lz grow with powers of 0.79
        and 0.84, within the bound of their size.
        """
        self.check("space_frame", "", True)

    def test_rigid_body(self) -> None:
        """Symmetric tops and others."""
        self.check("rigid_body", "", False)

    def test_effects(self) -> None:
        """With a rotor on the axis; over 1e5 nutations Lz is a tenth above the bound."""
        self.check("rigid_body", ROTOR, False)


if __name__ == "__main__":
    unittest.main()
