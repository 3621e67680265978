"""What everything is called in figures, reports and films: the one list of names.

The registry of the program and the headers of tables have a description and a unit for each column
(`words.py`). Here are names short enough for an axis, a title or a legend, with their symbols; what
has none of its own is named by its parts. `name_of` and `axis_of` find them.
"""

import math
import re
from typing import NamedTuple


class Name(NamedTuple):
    """How something is called: words, a formula for an axis, and a sign within a line of text."""

    words: str
    formula: str = ""
    sign: str = ""


WORDS = {
    "exact": "exact solution",
    "euler_forward": "Euler forward",
    "rk2": "RK2",
    "rk4": "RK4",
    "crank_nicolson_1": "Crank-Nicolson 1",
    "crank_nicolson_2": "Crank-Nicolson 2",
    "galerkin": "Galerkin",
    "euler_backward": "Euler backward",
    "gauss_4": "Gauss 4",
    "gauss_6": "Gauss 6",
    "gauss_8": "Gauss 8",
    "rkmk_4": "RKMK 4",
    "commutator_free_4": "commutator-free 4",
    "ode45": "ODE45",
    "dop853": "DOP853",
    "taylor": "Taylor",
    "taylor_quadruple": "Taylor, quadruple",
    "arkode_erk": "ARKODE, explicit",
    "arkode_dirk": "ARKODE, implicit",
    "auto": "chosen by spintop",
    "euler": "Euler",
    "lagrange": "Lagrange",
    "lagrange_energy": "Lagrange + energy",
    "stability": "stability study",
    "work_precision": "work-precision study",
    "benchmark": "benchmark study",
    "events": "table of events",
    "statistics": "table of statistics",
    "histogram": "table of histograms",
    "indices": "table of Sobol' indices",
    "ok": "completed",
    "pole": "at a pole",
    "non_finite": "overflow",
    "step_limit": "too many steps",
    "turning_point": "at a turning point",
    "outside": "outside the equations",
}
"""Methods, formulations, kinds of studies and of the tables beside them, statuses and verdicts; as
everywhere, the others are their own words."""

QUANTITIES = {
    "t": Name("time", "$t$", "t"),
    "phi": Name("precession", r"$\phi$", "φ"),
    "theta": Name("inclination", r"$\theta$", "θ"),
    "psi": Name("spin", r"$\psi$", "ψ"),
    "phi_rate": Name("precession rate", r"$\dot\phi$"),
    "theta_rate": Name("nutation rate", r"$\dot\theta$"),
    "psi_rate": Name("spin rate", r"$\dot\psi$"),
    "omega1": Name("angular velocity", r"$\omega_1$", "ω₁"),
    "omega2": Name("angular velocity", r"$\omega_2$", "ω₂"),
    "omega3": Name("spin", r"$\omega_3$", "ω₃"),
    "omega_x": Name("angular velocity", r"$\omega_x$"),
    "omega_y": Name("angular velocity", r"$\omega_y$"),
    "omega_z": Name("angular velocity", r"$\omega_z$"),
    "com_x": Name("x of the centre of mass"),
    "com_y": Name("y of the centre of mass"),
    "com_z": Name("height of the centre of mass"),
    "kinetic": Name("kinetic energy"),
    "potential": Name("potential energy"),
    "energy": Name("energy"),
    "energy_error": Name("relative energy error"),
    "lz": Name("vertical momentum", "$L_z$"),
    "l3": Name("momentum about the axis", "$L_3$"),
    "force_x": Name("horizontal force", "$F_x$"),
    "force_y": Name("horizontal force", "$F_y$"),
    "force_z": Name("vertical force", "$F_z$"),
    "force_r": Name("outward force", "$F_r$"),
    "force_n": Name("force along the nodes", "$F_n$"),
    "orientation_error": Name("error of the attitude"),
    "tip_error": Name("error of the axis tip"),
    "error_max": Name("largest error of the attitude"),
    "inherent_error": Name("inherent error"),
    "norm_error": Name("norm error of the quaternion"),
    "work_torque": Name("work of torques"),
    "work": Name("work of all effects"),
    "t_end": Name("end of the motion"),
    "t_stuck": Name("time at which the body stuck"),
    "critical_omega3": Name("threshold of the sleeping top", r"$\omega_3$", "ω₃"),
    "sleeping_ratio": Name("spin over the threshold of sleep"),
    "theta_min": Name("minimum inclination"),
    "theta_max": Name("maximum inclination"),
    "theta_end": Name("inclination at the end"),
    "phi_end": Name("precession at the end"),
    "psi_end": Name("spin angle at the end"),
    "theta_rate_end": Name("nutation rate at the end"),
    "delta_u": Name("range", r"$\Delta u$ of $\cos\theta$"),
    "nutation_period": Name("nutation period"),
    "nutation_rate": Name("nutation rate"),
    "precession_rate": Name("mean precession rate"),
    "precession_period": Name("precession period", "$T_p$"),
    "precession_per_nutation": Name("precession per nutation"),
    "spin_per_nutation": Name("spin per nutation"),
    "nutations_per_turn": Name("nutations per turn"),
    "nutations_in_period": Name("nutations in a precession period"),
    "phi_rate_max": Name("largest precession rate"),
    "theta_rate_max": Name("largest nutation rate"),
    "omega_max": Name("largest angular velocity"),
    "force_max": Name("largest support force"),
    "force_z_min": Name("minimum vertical support force"),
    "force_z_max": Name("maximum vertical support force"),
    "energy_error_max": Name("largest energy error"),
    "motion_class": Name("class of the motion"),
    "growth_rate": Name("growth of deviations"),
    "lyapunov_exponent": Name("Lyapunov exponent"),
    "largest_singular_value": Name("largest growth of a deviation"),
    "momentum_period": Name("period of the momentum"),
    "momentum_turn": Name("turn about the momentum"),
    "momentum_turn_geometric": Name("geometric phase of the momentum"),
    "momentum_axis": Name("axis of the momentum"),
    "evaluations": Name("function evaluations"),
    "steps": Name("steps"),
    "time_s": Name("computing time"),
    "spin_ratio": Name("spin ratio", r"$\lambda=\omega_3\,/\sqrt{4mgl/I_3}$", "λ"),
    "mass": Name("mass", "$m$", "m"),
    "gravity": Name("gravity", "$g$", "g"),
    "length": Name("distance of the centre of mass", "$l$", "l"),
    "inertia": Name("moment of inertia", "$I$", "I"),
    "quaternion": Name("quaternion", "$q$", "q"),
    "omega": Name("angular velocity", r"$\omega$", "ω"),
    "rod_length": Name("length of the rod"),
    "vibration_rate": Name("rate of the vibration", r"$\Omega$", "Ω"),
    "vibration_amplitude": Name("amplitude of the vibration", "$A$", "A"),
    "earth_rate": Name("angular velocity of the Earth"),
}
"""Columns of tables and keys of the input, with what they are called by themselves."""

ANGLES = {"phi", "theta", "psi"}
INITIAL = {*ANGLES, *(f"{name}_rate" for name in ANGLES), "omega", "omega3", "quaternion"}
"""Keys of the group `initial` that are columns, too: as keys they are initial."""

KEY = re.compile(r"(?:(\w+)(?:\((\d+)\))?\.)?(\w+)(?:\((\d+)(?:,(\d+))?\))?")
"""A group, a key or a column, and which elements of an array."""

BUTCHER = re.compile(r"arkode_(\w+?)((?:_\d+)+)")
LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")

RAISED = str.maketrans("-\N{MINUS SIGN}0123456789", "⁻⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits of a power of ten, or of a unit."""

UNITS = {"degree": "deg", "revolution": "rev", "standard_free_fall": "g0"}
"""Words of units that NetCDF tables name otherwise, as UDUNITS knows them."""
UNIT_WORDS = {"deg": "degrees"}
"""Units that figures write otherwise than tables."""


def unit_of_netcdf(text: str) -> str:
    """A unit of a NetCDF table as tables of texts have it."""
    if text == "1":
        return ""
    return re.sub(r"^[^ */^]+", lambda word: UNITS.get(word[0], word[0]), text)


def unit_shown(column: str, unit: str) -> tuple[str, float]:
    """The unit in which a column is drawn, and the factor to it.

    Angles are in degrees. Errors stay in radians, in which tolerances and verdicts are given.
    """
    if unit == "rad" and "error" not in column:
        return UNIT_WORDS["deg"], math.degrees(1)
    return unit, 1.0


def raised(unit: str) -> str:
    """A unit as in print: kg m², µs, degrees."""
    words = re.sub(r"\bus\b", "µs", UNIT_WORDS.get(unit, unit))
    return re.sub(r"\^(-?\d+)", lambda power: power[1].translate(RAISED), words)


def find_name(key: str) -> Name:
    """The name of a column, of a key of the input such as `top.inertia(1)`, or of a word."""
    if key in WORDS:
        return Name(WORDS[key])
    if key in QUANTITIES:
        return QUANTITIES[key]
    if key.startswith("uncertainty."):
        return Name(f"radius of the {name_of(key.partition('.')[2])}")
    column, derivative, other = key.partition("__")
    if derivative:
        return Name(f"change of {name_of(column)} with {name_of(other)}")
    if table := BUTCHER.fullmatch(key):
        parts = table[1].split("_")  # people, or the kind of the table
        words = (part.upper() if re.search(r"\d|rk$", part) else part.title() for part in parts)
        return Name(f"{'-'.join(words)} {table[2].strip('_').replace('_', '-')}")
    if not (parts := KEY.fullmatch(key)):
        return Name(key)
    group, part, name, *places = parts.groups()
    name = name.removesuffix("_deg")
    known = QUANTITIES.get(name) or Name(words_in(name))
    place = "".join(str(int(i) - (name == "quaternion")) for i in filter(None, places))
    if place:
        sign = known.sign and known.sign + place.translate(LOWERED)
        known = Name(f"{known.words} {sign or place}", sign=sign)
    if group == "initial" and name in INITIAL:
        known = Name(f"initial {known.words}", at_start(known.formula), at_start(known.sign))
    return known._replace(words=f"{known.words} of part {part or 1}") if group == "part" else known


def words_in(name: str) -> str:
    """What the parts of a key say."""
    endings = {"_fast_top": " of a fast top", "_bound": ", bound", "_max": ", largest"}
    for ending, words in (endings | {"_end": " at the end"}).items():
        if name.endswith(ending):
            return name_of(name.removesuffix(ending)) + words
    if name.startswith("work_"):
        return f"work of {name[5:].replace('_', ' ')}"
    return name.replace("_", " ")


def at_start(symbol: str) -> str:
    """A symbol with the zero of the start."""
    if symbol.endswith("_3$"):
        return symbol[:-3] + "_{30}$"
    return symbol[:-1] + "_0$" if symbol.endswith("$") else symbol and symbol + "₀"


def name_of(key: str) -> str:
    """What something is called in a title or a legend: words without formulas."""
    return find_name(key).words


def column_name(column: str, meaning: str = "") -> str:
    """What a column is called, by what its table says of it if it has no name of its own."""
    known = find_name(column).words
    return known if column in QUANTITIES or "__" in column or not meaning else meaning


def sign_of(key: str) -> str:
    """The shortest name: the sign within a line of text, else words."""
    name = find_name(key)
    return name.sign or name.words


def axis_of(key: str, unit: str = "", between: str = " ") -> str:
    """Words, formula and unit, as the label of an axis."""
    name = find_name(key)
    return with_unit(between.join(filter(None, (name.words, name.formula))), unit)


def with_unit(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} ({raised(unit)})" if unit else name
