"""Rows whose first time is above 0: the motion starts at 0, whatever the first row is."""

import pytest

from conftest import each, largest, listed, output

BODIES = {
    "symmetric": "inertia = 0.875, 0.875, 0.25  length = 0.6",
    "about x": "inertia = 0.25, 0.875, 0.875  centre_of_mass = 0.6, 0, 0",
    "damped": "inertia = 0.875, 0.875, 0.25  length = 0.6  damping = 3*0.05",
    "asymmetric": "inertia = 0.9, 0.7, 0.4  centre_of_mass = 0.1, -0.05, 0.5",
    "free": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0",
    "spun down": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0  damping = 3*0.3",
}
EFFECTS = ("friction_torque = 0.05", "drag_moment = 3*0.02", "drag_force = 0.2")
EFFECTS += ("vibration_amplitude = 0, 0, 0.02  vibration_rate = 25",)
EFFECTS += ("earth_rate = 0.3  latitude_deg = 60", "rotor_momentum = 0, 0, 0.3")
EFFECTS += ("torque_body = 0, 0, 0.1", "torque_space = 0.1, 0, 0")
METHODS = [m["name"] for m in listed("methods") if m["kind"] in ("both", "adaptive")]
"""Those that have values at any time."""
SCENES = [(body, "") for body in BODIES]
SCENES += [("damped", f"&effects {effect} /\n") for effect in EFFECTS]
SCENES += [
    ("damped", f"&integration method = '{name}'  relative_tolerance = 1e-9 /\n") for name in METHODS
]
FIT = "&study kind = 'fit' /\n&fit data = 'data.csv'  unknown = 'initial.psi_rate' /\n"
COLUMNS = ["phi", "theta", "psi", "omega3"]
SPIN = 6.0


@each("body, group", *SCENES)
def test_fits(spin, body, group):
    """Rows from a third of the span on give the true spin, and residuals of no size."""
    scene = f"&top mass = 1.3  {BODIES[body]} /\n{group}"
    scene += "&initial theta = 0.6  phi = 0.3  theta_rate = 0.3  psi_rate = {} /\n"
    span = "&span t_end = 3  samples = 31 /\n" + output("t", *COLUMNS)
    data = spin(scene.format(SPIN) + span).rows[10:].to_csv(index=False)
    (found,) = spin(scene.format(1.02 * SPIN) + FIT, data=data).rows.estimate
    assert found == pytest.approx(SPIN, rel=1e-6)
    residuals = spin(scene.format(SPIN) + FIT).table("residuals")
    assert largest(residuals[[f"{name}_residual" for name in COLUMNS]]) < 1e-6
