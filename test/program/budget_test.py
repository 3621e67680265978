"""One budget, `max_steps`, for all work of a case."""

import re
import unittest

from program_test import ProgramCase

STOPPED = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 11.25, psi_rate = 1.0 /
&span t_end = 20, samples = 11, stop_at = 'lower_turning_points', stop_after = 3 /
&integration method = 'dop853', formulation = 'space_frame', relative_tolerance = 1e-13 /
&output columns = 't', 'theta' /
"""


class BudgetTest(ProgramCase):
    """Work that is done twice counts twice."""

    def test_a_motion_computed_again(self) -> None:
        """The rows of a motion that ended at an event come from a second computation."""
        scene = self.write(STOPPED)
        run = self.run_program(scene)
        self.assertEqual(run.returncode, 0, run.stderr)
        steps, rejected = map(int, re.search(r"(\d+) steps, (\d+) rejected", run.stdout).groups())
        # Those of both computations; the looks for events in the first are fewer than half of them.
        both = steps + rejected
        run = self.run_program(scene, "--set", f"integration.max_steps={both}")
        self.assertEqual(run.returncode, 3, run.stdout + run.stderr)
        self.assertIn("step_limit at t = ", run.stdout)
        run = self.run_program(scene, "--set", f"integration.max_steps={both * 8}")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)


if __name__ == "__main__":
    unittest.main()
