"""Constants of motions over thousands of nutations, as exact as the arithmetic allows."""

import math

from program_test import ProgramCase

NUTATIONS, STEPS_A_NUTATION = 2000, 11
SCENE = """\
&study kind = 'trajectory' /
&top mass = 1  inertia = {first}, {first}, 0.25  length = 0.8660254037844387 /
&initial theta = {theta}  psi_rate = {spin} /
&span t_end = {end}  samples = 2 /
&integration formulation = '{formulation}'  method = 'taylor'  max_steps = 10000000 /
&output columns = 't', 'energy_error', 'lz', 'norm_error' /
"""
TOPS, I3 = 24, 0.25
CHI_SQUARE = 91.0
"""So large is the sum of squares of 24 standard normal numbers in one case of 10^9."""
SIZES = {"energy": 0.8, "momentum": 2.0, "norm": 0.25}
"""The standard deviation after n steps in 1e-16 sqrt(n): of the walk, not of one drawing of it."""


def top_of(k: int) -> tuple[float, float, float]:
    """I1, theta and spin of the k-th top. Its momentum about the axis is the same in each step."""
    share = k / (TOPS - 1)
    return 0.895 + 0.04 * share, 0.49 + 0.68 * share, 4.94 - 1.13 * share


class LongRunsTest(ProgramCase):
    """Bounds of what a random walk of rounding errors makes."""

    def scene_of(self, formulation: str, top: tuple[float, ...], nutations: int) -> str:
        """The input of a top."""
        first, theta, spin = top
        return SCENE.format(
            first=first, theta=theta, spin=spin, formulation=formulation, end=1.5 * nutations
        )

    def test_constants(self) -> None:
        """Energy, momentum about the vertical and norm wander by the root of steps.

        Errors of independent walks of n steps are normal with a variance of n, so that the sum of
        their squares scatters as chi-square.
        """
        unit = 1e-16 * math.sqrt(NUTATIONS * STEPS_A_NUTATION)
        for formulation in ("space_frame", "rigid_body"):
            sums = dict.fromkeys(SIZES, 0.0)
            for top in map(top_of, range(TOPS)):
                scene = self.write(self.scene_of(formulation, top, NUTATIONS))
                table = self.compute(scene, "integration.relative_tolerance=0")
                momenta = table.column("lz")
                ends = {
                    "energy": table.column("energy_error")[-1],
                    "momentum": (momenta[-1] - momenta[0]) / (I3 * top[2]),
                    "norm": table.column("norm_error")[-1],
                }
                for name, error in ends.items():
                    sums[name] += (error / (SIZES[name] * unit)) ** 2
            for name, total in sums.items():
                with self.subTest(formulation=formulation, constant=name):
                    self.assertLess(total, CHI_SQUARE)

    def test_zero(self) -> None:
        """Zero is the finest tolerance of the method, and a tolerance below it is refused."""
        tables = []
        for tolerance in ("0", "1e-20"):
            scene = self.write(self.scene_of("rigid_body", top_of(0), 10))
            tables.append(self.compute(scene, f"integration.relative_tolerance={tolerance}"))
        self.assertEqual(tables[0].texts("lz"), tables[1].texts("lz"))
        # Sweeps in lanes reach it as well.
        sweep = ("study.kind=sweep", "sweep.parameter=initial.theta", "sweep.values(1,:)=0.3,0.9")
        table = self.compute(
            scene, "integration.relative_tolerance=0", *sweep, "output.columns=energy_error_max"
        )
        self.assertLess(max(table.column("energy_error_max")), 1e-14)
        error = self.refuse(scene, "--set", "integration.relative_tolerance=1e-21")
        self.assertIn("cannot reach a tolerance below 1e-20", error)
