"""The scene of a table as a link to the live top, which `scene.js` of the page reads."""

import math

import numpy as np

from spintop_figures.moving.assumptions import acting, symmetric
from spintop_figures.moving.body import SHAPES, Body, read_body
from spintop_figures.moving.motion import ANGLES, attitude_at_start, find_omega
from spintop_figures.tables.table import Table, is_word

WITH_ROD = ("spinning_wheel", "ring", "sphere")
KEYS = {
    name: (*keys.values(), *(["rod_length"] if name in WITH_ROD else []), "density")
    for name, (_, keys, _) in SHAPES.items()
}
"""The keys of `top` by which the page builds a shape."""

POLE = 1e-9
"""Closer to a pole, sin(theta) below this, phi' does not exist."""


PHASES = ("vibration_phase", "vibration_phase_deg")
OWN = {"effects.friction_torque", "effects.vibration_amplitude"}
"""The keys of effects that the page computes; others have no live top."""


def live_link(table: Table) -> str:
    """What the live top begins with; empty if the page cannot compute the motion of the table.

    It computes any body under gravity with viscous damping, and with constant dry friction or a
    pivot that vibrates along the vertical. The precession angle at the start is zero there: the
    motion differs by a turn about the vertical.
    """
    body, omega = read_body(table), find_omega(table)
    if table.kind != "trajectory" or body is None or omega is None:
        return ""
    effects = effect_fields(table)
    if min(body.mass, *body.inertia) <= 0 or effects is None:
        return ""
    fields = body_fields(table, body) | start_fields(table, omega[0]) | effects
    times = table.rows["t"].to_numpy(float)
    fields |= {"gravity": table.number("top.gravity", 9.81), "t_end": times[-1] - times[0]}
    return "&".join(f"{name}={value}" for name, value in fields.items())


def effect_fields(table: Table) -> dict[str, float] | None:
    """Dry friction and the vibration of the pivot; None if there are effects of other kinds."""
    found = set(acting(table, "effects."))
    none = [0, 0, 0]
    smoothing, amplitude, *phases = (
        [float(value) for value in table.settings.get(f"effects.{key}", none)]
        for key in ("friction_smoothing", "vibration_amplitude", *PHASES)
    )
    is_unknown = any(smoothing) or any(amplitude[:2]) or any(map(any, phases))
    if not found <= OWN or is_unknown or found == OWN:
        return None
    fields = {}
    if "effects.friction_torque" in found:
        fields["friction"] = table.number("effects.friction_torque", 0.0)
    if any(amplitude):
        fields["amplitude"] = amplitude[2]
        fields["vibration_rate"] = table.number("effects.vibration_rate", 0.0)
    return fields


def body_fields(table: Table, body: Body) -> dict[str, object]:
    """The shape with its dimensions, if the input has them, else the mass properties."""
    damping = [float(x) for x in table.settings.get("top.damping", [0, 0, 0])]
    damping += damping[:1] * (3 - len(damping))
    is_top = not symmetric(table) and body.centre[2] >= 0 and damping[0] == damping[1]
    losses = {"damping1": damping[0], "damping3": damping[2]}
    losses = {name: value for name, value in losses.items() if value}
    shape = table.setting("top.shape")
    keys = KEYS.get(shape, ()) if shape in SHAPES else ()
    texts = {key: table.setting(f"top.{key}") for key in keys}
    if is_top and keys and not any(not text or is_word(text) for text in texts.values()):
        return {"shape": shape} | {key: float(text) for key, text in texts.items()} | losses
    fields = {"mass": body.mass}
    fields |= {f"inertia{k}": float(value) for k, value in enumerate(body.inertia, 1)}
    if is_top:
        del fields["inertia2"]
        return {"shape": "inertia"} | fields | {"length": float(body.centre[2])} | losses
    centre = zip("xyz", body.centre, strict=True)
    fields |= {f"centre_{axis}": float(value) for axis, value in centre}
    fields |= {f"damping{k}": value for k, value in enumerate(damping, 1) if value}
    if not body.products.any():
        return {"shape": "body"} | fields
    products = zip((23, 31, 12), body.products, strict=True)
    return {"shape": "tensor"} | fields | {f"product{k}": float(value) for k, value in products}


def start_fields(table: Table, omega: np.ndarray) -> dict[str, float]:
    """Angles (degrees) and rates of the first row, in radians per second."""
    q0, q1, q2, q3 = attitude_at_start(table)
    theta = 2 * math.atan2(math.hypot(q1, q2), math.hypot(q0, q3))
    if not table.missing(ANGLES):
        theta = float(table.rows["theta"].iloc[0])
    psi = math.atan2(q3, q0) - math.atan2(q2, q1)
    along = omega[0] * math.cos(psi) - omega[1] * math.sin(psi)
    across = omega[0] * math.sin(psi) + omega[1] * math.cos(psi)
    sine = math.sin(theta)
    if abs(sine) < POLE:  # any direction will do
        along, across = math.hypot(along, across), 0.0
        psi = -math.atan2(omega[1], omega[0])
    return {
        "psi": math.degrees(psi),
        "theta": float(f"{math.degrees(theta):.14g}"),
        "omega3": float(omega[2]),
        "phi_rate": across / sine if across else 0.0,
        "theta_rate": along,
    }
