"""Kapitza's limit: how fast a pivot has to vibrate to hold a body upright."""

from collections.abc import Callable

import numpy as np

from spintop_figures.moving.assumptions import acting
from spintop_figures.tables.table import Table

RATE, AMPLITUDE = "effects.vibration_rate", "effects.vibration_amplitude(3)"

KAPITZA = r"Kapitza: $A\,\Omega=\sqrt{2gI/(ml)}$"
"""What the limit is, as a legend has it."""

GRAVITY = 9.81
"""Where an input does not say it, m/s^2."""


def find_kapitza_limit(table: Table) -> Callable[[np.ndarray], np.ndarray] | None:
    """The second swept parameter at the limit, as a function of the first; None if there is none.

    A vertical vibration a cos(W t) of the pivot, averaged over its period, adds the potential
    (m l a W)^2 sin(theta)^2/(4 I) to m g l cos(theta), with I about the pivot. The body without
    spin is stable upright if the curvature of the sum is positive there: a W > sqrt(2 g I/(m l)).
    With I = m l^2 it is the pendulum's sqrt(2 g l). It holds for fast vibrations of small
    amplitude, a body given by its moments of inertia, and no other effect.
    """
    if sorted(table.axes()) != sorted((RATE, AMPLITUDE)):
        return None
    others = set(acting(table, "effects.")) - {"effects.vibration_amplitude"}
    spins = any(table.number(f"initial.{key}", 0.0) for key in ("omega3", "psi_rate"))
    if others or spins or acting(table, "top.damping") or table.setting("top.shape") != "inertia":
        return None
    mass, length, inertia = (table.number(f"top.{key}") for key in ("mass", "length", "inertia"))
    if table.setting("top.inertia_about") == "centre_of_mass":
        inertia += mass * length**2
    limit = np.sqrt(2 * table.number("top.gravity", GRAVITY) * inertia / (mass * length))
    return (lambda values: limit / values) if np.isfinite(limit) else None
