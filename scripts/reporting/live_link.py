"""The scene of a table as a link to the live top, which `scene.js` of the page reads."""

import math

import numpy as np

from spintop_figures.moving.assumptions import LAGRANGE, broken
from spintop_figures.moving.body import SHAPES, Body, read_body
from spintop_figures.moving.motion import ANGLES, attitude_at_start, find_omega
from spintop_figures.tables.table import Table, is_word

KEYS = {
    "spinning_wheel": ("radius", "thickness", "rod_length", "density"),
    "ring": ("radius", "inner_radius", "thickness", "rod_length", "density"),
    "sphere": ("radius", "rod_length", "density"),
    "cylinder": ("radius", "thickness", "density"),
    "cone": ("radius", "thickness", "density"),
}
"""The keys of `top` by which the page builds a shape."""

POLE = 1e-9
"""Closer to a pole, sin(theta) below this, phi' does not exist."""


def live_link(table: Table) -> str:
    """What the live top begins with; empty if the table is of no symmetric top under gravity alone.

    The symmetry axis is body z, with the centre of mass on it or at the pivot. The precession and
    spin angles at the start are zero there: the motion differs by a turn about the vertical.
    """
    body, omega = read_body(table), find_omega(table)
    if table.kind != "trajectory" or body is None or omega is None or not has_place(body):
        return ""
    if broken(LAGRANGE, table):
        return ""
    fields = body_fields(table, body) | start_fields(table, omega[0])
    times = table.rows["t"].to_numpy(float)
    fields |= {"gravity": table.number("top.gravity", 9.81), "t_end": times[-1] - times[0]}
    return "&".join(f"{name}={value}" for name, value in fields.items())


def has_place(body: Body) -> bool:
    """Whether the page can take the body: it has a mass, and does not hang below its pivot."""
    return body.centre[2] >= 0 and min(body.mass, *body.inertia) > 0


def body_fields(table: Table, body: Body) -> dict[str, object]:
    """The shape with its dimensions, if the input has them, else the mass properties."""
    shape = table.setting("top.shape")
    keys = KEYS.get(shape, ()) if shape in SHAPES else ()
    texts = {key: table.setting(f"top.{key}") for key in keys}
    if keys and not any(not text or is_word(text) for text in texts.values()):
        return {"shape": shape} | {key: float(text) for key, text in texts.items()}
    return {
        "shape": "inertia",
        "mass": body.mass,
        "inertia1": float(body.inertia[0]),
        "inertia3": float(body.inertia[2]),
        "length": float(body.centre[2]),
    }


def start_fields(table: Table, omega: np.ndarray) -> dict[str, float]:
    """Tilt (degrees) and rates of the first row, in radians per second."""
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
    return {
        "theta": float(f"{math.degrees(theta):.14g}"),
        "omega3": float(omega[2]),
        "phi_rate": across / sine if across else 0.0,
        "theta_rate": along,
    }
