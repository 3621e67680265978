"""Sensitivities: identities of mechanics that they satisfy, their errors, what is refused."""

import itertools
import math
import random

import pytest

from conftest import each, output

TOP = """\
&top mass = 1.3, inertia = 0.875, 0.875, 0.25, length = 0.85, gravity = 9.7 /
&initial phi = 0.3, theta = 0.6, psi = 0.1, phi_rate = 0.4, theta_rate = 0.2, psi_rate = 14 /
&span t_end = 6.5 /
"""
# No symmetry, damping: integrated.
BODY = """\
&top mass = 1.3, inertia = 0.9, 0.7, 0.3, centre_of_mass = 0.1, 0.05, 0.4, damping = 3*0.02 /
&initial phi = 0.3, theta = 0.6, psi = 0.1, omega = 0.5, 0.3, 4.0 /
&span t_end = 2.5 /
&integration relative_tolerance = 1e-15 /
"""
SWEEP = (
    "&study kind = 'sweep' /\n&sweep parameter = 'integration.max_steps', values(1,:) = 1000000 /\n"
)
ENDS = ("theta_end", "phi_end", "psi_end", "theta_rate_end")
DATA = {
    "top.mass": 1.3,
    **{f"top.inertia({i})": moment for i, moment in ((1, 0.9), (2, 0.7), (3, 0.3))},
    "top.gravity": 9.81,
    **{f"top.damping({i})": 0.02 for i in (1, 2, 3)},
    **{f"initial.omega({i})": rate for i, rate in ((1, 0.5), (2, 0.3), (3, 4.0))},
    "span.t_end": 2.5,
}


SPIN = "precession_period__initial.psi_rate"
PER_SPIN = 2 * math.pi * 0.25 / (1.3 * 9.7 * 0.85)


def derivatives(spin, text, columns, keys):
    """The last row of a table with derivatives, and each of these with its error."""
    names = [f"{column}__{key}" for column in columns for key in keys]
    row = spin(text + output(*columns, *names)).rows.iloc[-1]
    pairs = itertools.product(columns, keys)
    found = {(c, k): (row[f"{c}__{k}"], row[f"{c}__{k}_error"]) for c, k in pairs}
    return row, found


def agree(first, second, error):
    assert math.isfinite(first)
    assert error < 1e-6 * max(1, abs(second))
    assert first == pytest.approx(second, abs=error)


def test_the_end_of_a_symmetric_top(spin):
    """Turns of the start about the vertical and the axis; the time; formulas."""
    columns = [*ENDS, "precession_period"]
    keys = ["initial.phi", "initial.psi", "span.t_end", "top.mass", "initial.psi_rate"]
    row, found = derivatives(spin, SWEEP + TOP, columns, keys)
    for column, key, expected in [
        ("phi_end", "initial.phi", 1),
        ("theta_end", "initial.phi", 0),
        ("psi_end", "initial.psi", 1),
        ("theta_end", "initial.psi", 0),
        ("theta_end", "span.t_end", row.theta_rate_end),
        ("precession_period", "top.mass", -row.precession_period / 1.3),
        ("precession_period", "initial.psi_rate", PER_SPIN),
    ]:
        value, error = found[column, key]
        agree(value, expected, error)


def test_scales_of_mass_and_time(spin):
    """The angles of a body do not depend on the units of mass and of time (Euler's theorem)."""
    _, found = derivatives(spin, SWEEP + BODY, ENDS[:3], list(DATA))
    mass = {key: 1 for key in DATA if key.startswith(("top.mass", "top.i", "top.d"))}
    time = {"top.gravity": -2, "span.t_end": 1}
    time |= {key: -1 for key in DATA if key.startswith(("initial.omega", "top.damping"))}
    for powers, column in itertools.product((mass, time), ENDS[:3]):
        terms = [power * DATA[key] * found[column, key][0] for key, power in powers.items()]
        error = sum(abs(DATA[key]) * found[column, key][1] for key in powers)
        assert max(map(abs, terms)) > 0.1
        agree(sum(terms), 0, error)


def test_each_row_of_a_trajectory(spin):
    """The start does not depend on the body, and the time only on the span."""
    names = ["theta__top.mass", "phi__initial.phi", "t__span.t_end", "theta__span.t_end"]
    text = TOP.replace("t_end = 6.5", "t_end = 6.5, samples = 14")
    rows = spin(text + output("t", "theta_rate", *names)).rows
    assert len(rows) == 14
    assert rows[names[0]][0] == 0
    for i, row in rows.iterrows():
        expected = 1, i / 13, i / 13 * row.theta_rate
        for name, value in zip(names[1:], expected, strict=True):
            agree(row[name], value, row[name + "_error"])


@each("key", "top.length", "initial.theta_rate")
def test_trajectories_and_sweeps_agree(spin, key):
    (swept,) = derivatives(spin, SWEEP + TOP, ["theta_end"], [key])[1].values()
    (moved,) = derivatives(spin, TOP, ["theta"], [key])[1].values()
    agree(swept[0], moved[0], swept[1] + moved[1])


def test_one_side(spin):
    """A top without damping, with respect to damping: the energy changes by its power."""
    text = TOP.replace("gravity", "damping = 0, 0, 0, gravity").replace("= 6.5", "= 1e-3")
    text += "&integration relative_tolerance = 1e-14 /\n"
    ((value, error),) = derivatives(spin, text, ["energy"], ["top.damping(3)"])[1].values()
    square = (14 + 0.4 * math.cos(0.6)) ** 2
    assert value == pytest.approx(-square * 1e-3, abs=1e-3 * square * 1e-2 + error)


def test_swept_keys(spin):
    text = TOP.replace(", psi_rate = 14", "") + "&study kind = 'sweep' /\n"
    text += "&sweep parameter = 'initial.psi_rate', values(1,:) = 8, 14, 20 /\n"
    text += output(SPIN, "theta_end__top.mass")
    assert list(spin(text).rows[SPIN]) == pytest.approx([PER_SPIN] * 3, abs=1e-10)
    one, other = (spin(text, f"--threads={n}", f"--output={n}").path for n in (1, 3))
    assert one.read_bytes() == other.read_bytes()


def test_a_kink_has_a_note(spin):
    """A steady precession with a nutation rate of either sign."""
    text = "&top mass = 1, inertia = 0.8, 0.8, 0.25, length = 0.5, gravity = 8 /\n"
    text += "&initial theta_deg = 90, phi_rate = 1, theta_rate = 0, omega3 = 16 /\n"
    text += "&span t_end = 1 /\n"
    kink, smooth = "delta_u__initial.theta_rate", "phi_end__initial.omega3"
    row = spin(SWEEP + text + output(kink, smooth)).rows.iloc[0]
    assert row.status == "ok"
    assert math.isnan(row[kink])
    assert math.isnan(row[f"{kink}_error"])
    assert math.isfinite(row[smooth])
    assert "a derivative does not converge" in row.notes


@each(
    "name, message",
    ("'theta_ende__top.mass'", "there is no column 'theta_ende'"),
    ("'theta_end__top.mas'", "top.mas"),
    ("'theta_end__top.shape'", "is not a number"),
    ("'theta_end__span.samples'", "span.samples"),
    ("'theta_end__integration.step'", "integration.step is not a property of the motion"),
    ("'theta_end__top.density'", "top.density has no value"),
    ("'motion_class__top.mass'", "column 'motion_class' has no derivatives"),
    ("2*'theta_end__top.mass'", "named twice"),
)
def test_refusals(spin, name, message):
    error = spin.refuse(f"{SWEEP}{TOP}&output columns = {name} /\n")
    assert "scene.nml:" in error
    assert message in error


# Errors of derivatives: what `COLUMN__KEY_error` claims, by all methods.

TOPS = 3
COLUMNS = ("theta_end", "phi_end", "theta_rate_end")
KEYS = ("top.mass", "initial.psi_rate")
NAMES = [f"{column}__{key}" for column in COLUMNS for key in KEYS]
ADAPTIVE = [f"relative_tolerance = {tolerance}" for tolerance in ("1e-5", "1e-8", "1e-12")]
FIXED = ["steps = 160", "steps = 640"]
AXES = {
    "top.mass": (0.5, 2),
    "top.length": (0.1, 0.6),
    "top.inertia(3)": (0.2, 0.9),
    "top.gravity": (8, 11),
    "initial.theta": (0.4, 2.4),
    "initial.phi_rate": (-0.6, 0.6),
    "initial.theta_rate": (-0.6, 0.6),
    "initial.psi_rate": (3, 12),
    "span.t_end": (1, 3),
}
SCENE = (
    "&top inertia = 0.8, 0.8, 0.3 /\n&study kind = 'sweep' /\n&sweep table = 'tops.csv' /\n"
    + output(*NAMES)
)


def tops():
    draw = random.Random(28071)
    rows = [[repr(draw.uniform(*ends)) for ends in AXES.values()] for _ in range(TOPS)]
    return "".join(",".join(row) + "\n" for row in [AXES, *rows])


def claimed(spin, integration):
    rows = spin(f"{SCENE}&integration {integration} /\n").rows
    return [pair for name in NAMES for pair in rows[[name, f"{name}_error"]].to_numpy()]


@pytest.mark.slow
def test_every_method(spin):
    """A claim is 0.5 to 100 times the error, nearly always, and never below a tenth."""
    spin.write(tops(), "tops.csv")
    true = claimed(spin, "method = 'exact'")
    methods = [method for method in spin.listed("methods") if method["name"] != "exact"]
    assert len(methods) > 15
    judged, outside, missing = 0, [], 0
    for method in methods:
        settings = ADAPTIVE * (method["kind"] != "fixed") + FIXED * (method["kind"] != "adaptive")
        for setting in settings:
            found = claimed(spin, f"method = '{method['name']}' {setting}")
            for (value, claim), (exact, exact_claim) in zip(found, true, strict=True):
                judged += 1
                if math.isnan(value):
                    missing += 1
                    continue
                error = abs(value - exact)
                case = f"{method['name']}, {setting}: claim {claim}, error {error}"
                assert claim + exact_claim >= 0.1 * error, case
                # The exact derivative is not known to less than its own claim.
                known = max(error, exact_claim)
                if claim + exact_claim < 0.5 * error or claim > 100 * known:
                    outside.append(case)
    assert len(outside) < 0.03 * judged, outside
    assert missing < 0.03 * judged
