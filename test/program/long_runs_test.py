"""Constants of motions over thousands of nutations, as exact as the arithmetic allows."""

import math

from program_test import ProgramCase

NUTATIONS, STEPS_A_NUTATION = 10_000, 11
SCENE = """\
&study kind = 'trajectory' /
&top mass = 1  inertia = {first}, {first}, 0.25  length = 0.8660254037844387 /
&initial theta = {theta}  psi_rate = {spin} /
&span t_end = {end}  samples = 101 /
&integration formulation = '{formulation}'  method = 'taylor'  max_steps = 10000000 /
&output columns = 't', 'energy_error', 'lz', 'norm_error' /
"""
TOPS = ((0.895, 0.49, 4.94), (0.915, 0.83, 4.38), (0.935, 1.17, 3.81))
"""Momenta about the axis that are the same in every step: I1, theta and spin."""


class LongRunsTest(ProgramCase):
    """Bounds of what a random walk of rounding errors makes."""

    def scene_of(self, formulation: str, top: tuple[float, ...], nutations: int) -> str:
        """The input of a top."""
        first, theta, spin = top
        return SCENE.format(
            first=first, theta=theta, spin=spin, formulation=formulation, end=1.5 * nutations
        )

    def test_constants(self) -> None:
        """Energy, momentum about the vertical and norm wander by the root of steps."""
        bound = 3e-16 * math.sqrt(NUTATIONS * STEPS_A_NUTATION)
        for formulation in ("space_frame", "rigid_body"):
            ends: dict[str, list[float]] = {"energy": [], "momentum": [], "norm": []}
            for top in TOPS:
                scene = self.write(self.scene_of(formulation, top, NUTATIONS))
                table = self.compute(scene, "integration.relative_tolerance=0")
                momenta = table.column("lz")
                ends["energy"].append(table.column("energy_error")[-1])
                ends["momentum"].append(momenta[-1] / momenta[0] - 1)
                ends["norm"].append(table.column("norm_error")[-1])
            for name, errors in ends.items():
                with self.subTest(formulation=formulation, constant=name):
                    self.assertLess(math.hypot(*errors) / math.sqrt(len(TOPS)), bound)

    def test_zero(self) -> None:
        """Zero is the finest tolerance of the method, and a tolerance below it is refused."""
        tables = []
        for tolerance in ("0", "1e-20"):
            scene = self.write(self.scene_of("rigid_body", TOPS[0], 10))
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
