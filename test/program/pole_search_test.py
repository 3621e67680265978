"""Extremes of rates where what is searched is rounding: in a pole, and in a plane through it.

The bound is on the work: `max_steps` is a small part of what a search that divides rounding
errors would take.
"""

import itertools
import math
import unittest

from program_test import ProgramCase

BODY = "&top mass = 1  inertia = 1, 2, 3  length = {} /\n"
SWEEP = "&study kind = 'sweep' /\n&sweep parameter(1) = 'span.t_end'  values(1,:) = {} /\n"
WORK = 20000


class PoleSearchTest(ProgramCase):
    """The searches end with the right value."""

    def extreme(self, scene: str, span: str, column: str, control: str = "") -> float:
        """The extreme of a motion by a sweep of one case."""
        control = f"&integration max_steps = {WORK} {control} /\n"
        output = f"&output columns = '{column}' /\n"
        table = self.compute(self.write(scene + SWEEP.format(span) + control + output))
        self.assertEqual(table.texts("status"), ["ok"])
        return table.column(column)[0]

    def test_start_in_a_pole(self) -> None:
        """The precession rate near the start is that of rows, with friction and without."""
        heavy = BODY.format(1) + "&initial theta = 0  omega = 1, 0.3, 5 /\n"
        methods = "method = 'dop853'", "method = 'taylor' project = 'unit'", ""
        for effect in ("", "&effects friction_torque = 0.1 /\n"):
            span = "&span t_end = 3 samples = 60001 /\n&output columns = 't', 'phi_rate' /\n"
            control = "&integration relative_tolerance = 1e-12 /\n"
            rows = self.compute(self.write(heavy + effect + span + control)).column("phi_rate")
            known = max(rows[1:], key=abs)
            for method in methods:
                found = self.extreme(heavy + effect, "3", "phi_rate_max", method)
                self.assertAlmostEqual(found / known, 1, delta=1e-5, msg=(effect, method))

    def test_short_motions_from_a_pole(self) -> None:
        """Where the precession slows down, the largest rate is the limit in the pole."""
        methods = "method = 'dop853'", "method = 'taylor' project = 'unit'", "method = 'taylor'"
        effects = {
            0: ("",),
            0.3: (
                "",
                "&effects friction_torque = 0.1 /\n",
                "&effects earth_rate = 0.5 latitude = 0.7 /\n",
            ),
        }
        for pole, length in itertools.product((0, math.pi), effects):
            body = BODY.format(length)
            body += f"&initial theta = {pole!r}  psi = 0.4  omega = 1, 2.5, -4 /\n"
            for effect, share in itertools.product(effects[length], (0.01, 0.1, 0.4)):
                span = f"&span t_end = {share} samples = 2001 /\n"
                output = "&output columns = 't', 'phi_rate' /\n"
                rows = self.compute(self.write(body + effect + span + output)).column("phi_rate")
                known = max(rows[2:], key=abs)
                for method in (*methods, *([""] if length == 0 else [])):
                    found = self.extreme(body + effect, str(share), "phi_rate_max", method)
                    self.assertAlmostEqual(
                        found / known, 1, delta=2e-3, msg=(effect, method, share)
                    )

    def test_free_rotation_through_the_poles(self) -> None:
        """About a horizontal principal axis theta turns with omega."""
        axes = {"1.5, 0, 0": 0, "0, 1.5, 0": 90}
        methods = "", "method = 'taylor'", "method = 'dop853'"
        for omega, psi in axes.items():
            for method in methods:
                for theta in (0.5, 0.5 * math.pi, math.pi):
                    start = f"&initial theta = {theta!r}  psi_deg = {psi}  omega = {omega} /\n"
                    found = self.extreme(BODY.format(0) + start, "20", "theta_rate_max", method)
                    self.assertAlmostEqual(found, 1.5, delta=1e-8, msg=(omega, method, theta))


if __name__ == "__main__":
    unittest.main()
