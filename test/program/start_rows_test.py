"""The first row of a trajectory is the motion at the start, whatever method computes the others."""

import numpy as np
import pytest

from conftest import each, largest, listed, output

TENSOR = """inertia_tensor(1,:) = 0.55, -0.3, 0
     inertia_tensor(2,2:3) = 0.55, 0  inertia_tensor(3,3) = 0.85"""
BODIES = {
    "about z": "inertia = 0.875, 0.875, 0.25  centre_of_mass = 0, 0, 0.5",
    "about -z": "inertia = 0.875, 0.875, 0.25  centre_of_mass = 0, 0, -0.5",
    "about x": "inertia = 0.25, 0.875, 0.875  centre_of_mass = 0.5, 0, 0",
    "about y": "inertia = 0.875, 0.25, 0.875  centre_of_mass = 0, 0.5, 0",
    "given by a tensor": f"{TENSOR}  centre_of_mass = 0.3, 0.3, 0",
    "free": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0",
    "free, about x": "inertia = 0.4, 0.6, 0.6  centre_of_mass = 0, 0, 0",
    "without gravity": "gravity = 0  inertia = 0.6, 0.5, 0.4  centre_of_mass = 0.1, 0.2, 0.3",
}
EFFECTS = ("", "earth_rate = 0.3  latitude_deg = 90", "rotor_momentum = 0, 0, 0.1")


def first_row(spin, text, code=0):
    run = spin(text + output("all"), code=code)
    if run.code == 2:
        assert "exact" in run.err
        return None
    return run.rows.iloc[0].dropna()


@each("effects", *EFFECTS)
@each("body", *BODIES)
def test_columns_at_the_start(spin, body, effects):
    """Those that both methods have are equal: angles, rates, forces, energies, residuals."""
    text = f"&top mass = 1.3  {BODIES[body]} /\n&span t_end = 2  samples = 3 /\n"
    text += "&initial theta = 0.7  phi = 1.1  psi = -2.3\n"
    text += "         phi_rate = 0.4  theta_rate = -1.2  psi_rate = 7 /\n"
    text += f"&effects {effects} /\n" if effects else ""
    exact = first_row(spin, text + "&integration method = 'exact' /\n", code=(0, 2))
    if exact is None:
        pytest.skip("no exact motion")
    stepped = first_row(spin, text + "&integration method = 'taylor' /\n")
    shared = exact.index.intersection(stepped.index)
    assert {"force_x", "omega1", "com_x"} < set(shared)
    np.testing.assert_allclose(exact[shared], stepped[shared], rtol=1e-11, atol=1e-11)


LEVELS = ("theta", "phi", "psi", "omega1", "omega2", "omega3", "gamma1", "gamma2", "gamma3")
LEVELS += ("com_x", "com_y", "com_z", "l3", "lz", "kinetic", "potential", "energy")
CONSTANT = ("omega3", "l3", "lz", "energy")
MOVING, AT_REST = "theta_deg = 90  theta_rate = 1  psi_rate = 3", "theta_deg = 60  omega3 = 20"
# A top that was at rest touches its inclination again, without a passage.
TOPS = [(name, MOVING) for name in LEVELS if name not in CONSTANT]
TOPS += [(name, AT_REST) for name in ("com_x", "com_y", "gamma1", "gamma2", "omega1", "omega2")]
BODY = """\
&top mass = 1.3  inertia = 0.6, 0.5, 0.4  centre_of_mass = 0.1, -0.2, 0.3  damping = 0.1, 0.1, 0.1 /
&initial theta_deg = 90  psi_deg = {}  theta_rate = 1  psi_rate = 3 /
&span t_end = 2  samples = 2 {} /
"""
SWEEP = "&study kind = 'sweep' /\n&sweep parameter(1) = 'top.mass'  values(1,:) = 1.3 /\n"


def levels_at(spin, scene, quantity):
    value = float(first_row(spin, scene)[quantity])
    return {f"{value!r}", f"{value:.15f}"}


@each("psi", 0, 90)
@each("quantity", *LEVELS)
def test_the_start_is_no_event(spin, quantity, psi):
    """A level that the start has to rounding is passed later, in lanes as in a single motion."""
    for level in levels_at(spin, BODY.format(psi, ""), quantity):
        stop = BODY.format(psi, f"stop_at = '{quantity} = {level}'")
        expected = spin(stop + output("t")).rows.t.iloc[-1]
        assert expected > 1e-3
        (found,) = spin(SWEEP + stop.replace("samples = 2", "") + output("t_end")).rows.t_end
        assert found == pytest.approx(expected, rel=1e-6), level


@each("quantity, start", *TOPS)
def test_the_start_of_a_top_is_no_event(spin, quantity, start):
    """The same by the exact solution and by methods, also of a top that is released at rest."""
    scene = "&top mass = 1.3  inertia = 0.975, 0.975, 0.25  length = 0.8 /\n"
    scene += f"&initial {start} /\n&span t_end = 2  samples = 2 {{}} /\n"
    for level in levels_at(spin, scene.format(""), quantity):
        stop = scene.format(f"stop_at = '{quantity} = {level}'") + output("t")
        times = [
            spin(stop, f"integration.method={method}").rows.t.iloc[-1]
            for method in ("exact", "taylor", "dop853")
        ]
        assert times[0] > 1e-3
        assert times == pytest.approx([times[0]] * 3, rel=1e-5), level


# Rows whose first time is above 0: the motion starts at 0, whatever the first row is.

FITTED = {
    "symmetric": "inertia = 0.875, 0.875, 0.25  length = 0.6",
    "about x": "inertia = 0.25, 0.875, 0.875  centre_of_mass = 0.6, 0, 0",
    "damped": "inertia = 0.875, 0.875, 0.25  length = 0.6  damping = 3*0.05",
    "asymmetric": "inertia = 0.9, 0.7, 0.4  centre_of_mass = 0.1, -0.05, 0.5",
    "free": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0",
    "spun down": "inertia = 0.6, 0.5, 0.4  centre_of_mass = 0, 0, 0  damping = 3*0.3",
}
ALONE = ("friction_torque = 0.05", "drag_moment = 3*0.02", "drag_force = 0.2")
ALONE += ("vibration_amplitude = 0, 0, 0.02  vibration_rate = 25",)
ALONE += ("earth_rate = 0.3  latitude_deg = 60", "rotor_momentum = 0, 0, 0.3")
ALONE += ("torque_body = 0, 0, 0.1", "torque_space = 0.1, 0, 0")
METHODS = [m["name"] for m in listed("methods") if m["kind"] in ("both", "adaptive")]
"""Those that have values at any time."""
SCENES = [(body, "") for body in FITTED]
SCENES += [("damped", f"&effects {effect} /\n") for effect in ALONE]
SCENES += [
    ("damped", f"&integration method = '{name}'  relative_tolerance = 1e-9 /\n") for name in METHODS
]
FIT = "&study kind = 'fit' /\n&fit data = 'data.csv'  unknown = 'initial.psi_rate' /\n"
COLUMNS = ["phi", "theta", "psi", "omega3"]
SPIN = 6.0


@each("body, group", *SCENES)
def test_fits(spin, body, group):
    """Rows from a third of the span on give the true spin, and residuals of no size."""
    scene = f"&top mass = 1.3  {FITTED[body]} /\n{group}"
    scene += "&initial theta = 0.6  phi = 0.3  theta_rate = 0.3  psi_rate = {} /\n"
    span = "&span t_end = 3  samples = 31 /\n" + output("t", *COLUMNS)
    data = spin(scene.format(SPIN) + span).rows[10:].to_csv(index=False)
    (found,) = spin(scene.format(1.02 * SPIN) + FIT, data=data).rows.estimate
    assert found == pytest.approx(SPIN, rel=1e-6)
    residuals = spin(scene.format(SPIN) + FIT).table("residuals")
    assert largest(residuals[[f"{name}_residual" for name in COLUMNS]]) < 1e-6
