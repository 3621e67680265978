"""What columns and parameters are called in figures, where the program does not say it.

The registry of the program, and the header of a table, have a description and a unit for each
column (`words.py`). They have no symbols, and nothing short enough for an axis.
"""

import re

PARAMETERS = {
    "initial.spin_ratio": r"spin ratio $\lambda=\omega_3\,/\sqrt{4mgl/I_3}$",
    "initial.omega3": r"initial angular velocity $\omega_3$",
    "initial.theta": r"initial inclination $\theta_0$",
    "initial.theta_deg": r"initial inclination $\theta_0$",
    "initial.theta_rate": r"initial nutation rate $\dot\theta_0$",
    "initial.phi_rate": r"initial precession rate $\dot\phi_0$",
    "initial.psi_rate": r"initial spin rate $\dot\psi_0$",
    "effects.vibration_rate": r"rate of the vibration $W$",
    "effects.vibration_amplitude(3)": r"amplitude of the vibration $A_3$",
}
"""How parameters are written, in words and then a symbol; the others stand by their keys."""

AXES = {
    "phi": r"precession $\phi$",
    "theta": r"inclination $\theta$",
    "psi": r"spin $\psi$",
    "theta_rate": r"nutation rate $\dot\theta$",
    "omega3": r"spin $\omega_3$",
    "delta_u": r"range $\Delta u$ of $\cos\theta$",
    "nutation_rate": "nutation rate",
    "precession_rate": "mean precession rate",
    "nutations_per_turn": "nutations per turn",
}
"""Columns as the axes of their own figures have them, in words and then a symbol."""

SYMBOLS = {
    "phi": "φ",
    "theta": "θ",
    "psi": "ψ",
    "phi_rate": "precession rate",
    "theta_rate": "nutation rate",
    "psi_rate": "spin rate",
    "omega1": "ω₁",
    "omega2": "ω₂",
    "omega3": "ω₃",
    "com_x": "x of the centre of mass",
    "com_y": "y of the centre of mass",
    "com_z": "height of the centre of mass",
    "force_x": "horizontal force x",
    "force_y": "horizontal force y",
    "force_z": "vertical force",
    "work_torque": "work of torques",
    "t_end": "end of the motion",
}
"""Columns as they are written within a line of text; the others stand by their names."""

UNITS = {"degree": "deg", "standard_free_fall": "g0"}
"""Words of units that NetCDF tables name otherwise, as UDUNITS knows them."""
UNIT_WORDS = {"deg": "degrees"}
"""Units that figures write otherwise than tables."""


def unit_of_netcdf(text: str) -> str:
    """A unit of a NetCDF table as tables of texts have it."""
    if text == "1":
        return ""
    return re.sub(r"^[^ */^]+", lambda word: UNITS.get(word[0], word[0]), text)


def with_unit(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} ({UNIT_WORDS.get(unit, unit)})" if unit else name


def axis_of(column: str, unit: str, between: str = " ") -> str:
    """A column with its symbol and its unit, as the label of an axis."""
    return with_unit(AXES[column].replace(" $", f"{between}$", 1), unit)
