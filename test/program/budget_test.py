"""One budget, `max_steps`, for all work of a case."""

import re

STOPPED = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 11.25, psi_rate = 1.0 /
&span t_end = 20, samples = 11, stop_at = 'lower_turning_points', stop_after = 3 /
&integration method = 'dop853', formulation = 'space_frame', relative_tolerance = 1e-13 /
&output columns = 't', 'theta' /
"""


def test_a_motion_computed_again(spin):
    """The rows of a motion that ended at an event come from a second computation: it counts too."""
    said = spin(STOPPED, "--verbose").out
    steps, rejected = re.search(r"(\d+) steps, (\d+) rejected", said).groups()
    # Those of both computations; the looks for events in the first are fewer than half of them.
    both = int(steps) + int(rejected)
    run = spin(STOPPED, f"integration.max_steps={both}", code=3)
    assert "step_limit at t = " in run.out
    spin(STOPPED, f"integration.max_steps={both * 8}")
