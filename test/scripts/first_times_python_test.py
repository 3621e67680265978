"""Times of a top of which the first is above 0: the motion starts at 0, whatever is asked."""

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop

START = {"theta": 0.6, "phi": 0.3, "theta_rate": 0.3, "psi_rate": 6.0}
BODIES = {
    "symmetric": {"inertia": (0.875, 0.875, 0.25), "length": 0.6},
    "about x": {"inertia": (0.25, 0.875, 0.875), "centre_of_mass": (0.6, 0, 0)},
    "damped": {"inertia": (0.875, 0.875, 0.25), "length": 0.6, "damping": (0.05,) * 3},
    "asymmetric": {"inertia": (0.9, 0.7, 0.4), "centre_of_mass": (0.1, -0.05, 0.5)},
    "free": {"inertia": (0.6, 0.5, 0.4), "centre_of_mass": (0, 0, 0)},
}
EFFECTS = (
    {},
    {"drag_force": 0.2},
    {"earth_rate": 0.3, "latitude_deg": 60},
    {"rotor_momentum": (0, 0, 0.3)},
)
KINDS = [(body, effects) for body in BODIES for effects in EFFECTS]
ANGLES = ("phi", "theta", "psi")
COLUMNS = (*ANGLES, "omega1", "omega3", "force_z", "energy", "theta__initial.psi_rate")


def make(body: str, effects: dict) -> spintop.Top:
    """A top."""
    return spintop.Top(spintop.Body(mass=1.3, **BODIES[body]), effects=effects, **START)


@pytest.mark.parametrize(("body", "effects"), KINDS)
def test_tops(body: str, effects: dict) -> None:
    """Angles, forces, energies and derivatives at times are those among more times."""
    top = make(body, effects)
    t = np.linspace(0.0, 3.0, 13)
    ways = [lambda t: top.integrate(t, COLUMNS, relative_tolerance=1e-12)]
    ways += [lambda t: top.integrate(t, COLUMNS, method="rk4", steps=120 * round(t[-1] / 3))]
    if body in ("symmetric", "free") and not effects:
        ways += [lambda t: top.exact(t, COLUMNS), lambda t: top.exact(t, ANGLES)]
    for way in ways:
        all_times = way(t)
        for first in (0, 1, 5):
            some = way(t[first:])
            for name in some:
                if name.endswith("_error"):
                    continue
                scale = np.abs(all_times[name]).max()
                np.testing.assert_allclose(
                    some[name], all_times[name][first:], rtol=0, atol=1e-9 * scale
                )
