"""Fits: true parameters from synthetic measurements, intervals that cover, what is refused."""

import math
import re

import numpy as np
import pytest

from conftest import ROOT, each, largest, output
from spintop_figures.registry import choose_figures
from spintop_figures.tables.table import read_table

TOP = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial theta = 0.6, theta_rate = 0.3, psi_rate = 14 /
"""
SPAN = "&span t_end = 6, samples = 61 /\n"
ANGLES = ("phi", "theta", "psi")
FIT = """\
&study kind = 'fit' /
&fit data = 'data.csv', unknown = 'top.inertia(1)', 'top.inertia(3)', 'initial.psi_rate' /
"""
TRUTH = np.array([0.875, 0.25, 14.0])
NOISE = 0.002
FITS = 120
OTHERS = TOP.replace("0.875, 0.875, 0.25", "0.9, 0.9, 0.24").replace("= 14", "= 14.3")


def measure(spin, scene=TOP, columns=ANGLES):
    return spin(scene + SPAN + output("t", *columns)).rows


def noisy(motion, seed, noise=NOISE):
    source = np.random.default_rng(seed)
    data = motion.copy()
    data.iloc[:, 1:] += noise * source.normal(size=data.iloc[:, 1:].shape)
    return data.to_csv(index=False)


def test_exact_measurements_give_the_parameters(spin):
    """Without noise the true values are found from others, and the residuals vanish."""
    run = spin(OTHERS + FIT, data=noisy(measure(spin), 0, 0))
    rows = run.rows
    assert list(rows.estimate / TRUTH) == pytest.approx([1] * 3, abs=1e-8)
    assert ((rows.lower <= rows.estimate) & (rows.estimate <= rows.upper)).all()
    assert (rows.upper - rows.lower < 1e-12 * TRUTH).all()
    residuals = run.table("residuals")
    assert len(residuals) == 61
    assert largest(residuals[[f"{name}_residual" for name in ANGLES]]) < 1e-7
    assert run.status == "ok"


@each("method", "dop853", "taylor", "ode45' formulation = 'space_frame")
@each("start", TOP, OTHERS)
def test_exact_measurements_of_an_integrated_motion(spin, method, start):
    """The same with methods whose tolerance bounds the residuals, from true values and others.

    Equations of symmetric tops keep the body symmetric where I1 alone is sought.
    """
    control = f"&integration method = '{method}' relative_tolerance = 1e-9 /\n"
    run = spin(start + control + FIT, data=noisy(measure(spin), 0, 0))
    rows = run.rows
    assert run.status == "ok"
    assert list(rows.estimate / TRUTH) == pytest.approx([1] * 3, abs=1e-6)
    assert ((rows.lower < rows.estimate) & (rows.estimate < rows.upper)).all()
    assert (rows.upper - rows.lower < 1e-5 * TRUTH).all()


def test_small_estimates_keep_their_digits(spin):
    """The summary has so many digits that the ends of an interval are others than the estimate."""
    scene = TOP.replace("length", "damping = 3*3e-7, length")
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'top.damping(3)' /\n"
    said = spin(scene + fit, data=noisy(measure(spin, scene, ["omega3"]), 0, 1e-9)).out
    numbers = re.search(r"damping\(3\) += (\S+) .*: (\S+) to (\S+)", said).groups()
    estimate, lower, upper = map(float, numbers)
    assert lower < estimate < upper


def test_intervals_cover(spin):
    """The true values lie in the 95 % intervals as often as they should: a binomial count."""
    motion, covered = measure(spin), 0
    for seed in range(FITS):
        rows = spin(TOP + FIT, data=noisy(motion, seed)).rows
        assert (rows.lower < rows.upper).all()
        covered = covered + ((rows.lower <= TRUTH) & (rows.upper >= TRUTH))
    assert (abs(covered - 0.95 * FITS) < 4 * math.sqrt(FITS * 0.95 * 0.05)).all()


def test_covariance_and_errors_belong_together(spin):
    """The variances are the squares of the errors; known deviations scale them."""
    data, known = noisy(measure(spin), 1), []
    for factor in (1, 5):
        text = (TOP + FIT).replace("'data.csv',", f"'data.csv', sigma = {factor * NOISE},")
        rows = spin(text, data=data).rows
        errors = rows.standard_error.to_numpy()
        covariance = rows[[f"covariance__{key}" for key in rows.parameter]].to_numpy()
        scaled = covariance / np.outer(errors, errors)
        assert list(np.diag(scaled)) == pytest.approx([1] * 3, abs=1e-12)
        assert largest(scaled) < 1 + 1e-12
        known.append(errors[0])
    assert known[1] / known[0] == pytest.approx(5, abs=1e-6)


def test_gyroscope_of_an_asymmetric_body(spin):
    """Readings of three rates of a damped body, which is integrated."""
    scene = (
        "&top mass = 1, inertia = 0.9, 0.7, 0.3, length = 0.5, damping = 3*0.02 /\n"
        "&initial theta = 0.6, omega = 0.5, 0.3, 4.0 /\n"
        "&integration relative_tolerance = 1e-13 /\n"
    )
    data = noisy(measure(spin, scene, ("omega1", "omega2", "omega3")), 3, 1e-4)
    fit = FIT.replace("'initial.psi_rate'", "'top.inertia(2)', 'top.damping(3)'")
    rows = spin(scene.replace("0.9, 0.7, 0.3", "0.88, 0.71, 0.31") + fit, data=data).rows
    truth = np.array([0.9, 0.3, 0.7, 0.02])
    assert (abs(rows.estimate - truth) < 5 * rows.standard_error).all()
    assert (rows.standard_error < 0.02 * truth).all()


def test_accelerometer(spin):
    """Its readings alone give the length and the spin, without noise exactly."""
    motion = measure(spin, columns=[f"accelerometer{i}" for i in (1, 2, 3)])
    start = TOP.replace("= 0.85", "= 0.83").replace("= 14", "= 14.2")
    fit = FIT.replace("'top.inertia(1)', 'top.inertia(3)'", "'top.length'")
    found = spin(start + fit, data=noisy(motion, 0, 0)).rows.estimate
    assert list(found / [0.85, 14.0]) == pytest.approx([1, 1], abs=1e-8)


def test_accelerometer_of_a_body_in_air(spin):
    """With drag and a moving pivot it reads the acceleration of the centre of mass, and g."""
    step, amplitude, rate = 1e-3, 0.01, 30.0
    places = ["com_x", "com_y", "com_z"]
    readings, up = ([f"{name}{i}" for i in (1, 2, 3)] for name in ("accelerometer", "gamma"))
    rows = spin(
        "&top mass = 1.3, inertia_tensor(1,:) = 0.9, 0.1, 0.05\n"
        "     inertia_tensor(2,2:3) = 0.8, -0.02, inertia_tensor(3,3) = 0.6\n"
        "     centre_of_mass = 0.1, -0.05, 0.5 /\n"
        "&initial theta = 0.6, omega = 0.5, 0.3, 4.0 /\n"
        "&effects drag_force = 0.4\n"
        f"    vibration_amplitude = 0, 0, {amplitude}, vibration_rate = {rate} /\n"
        "&integration relative_tolerance = 1e-14 /\n"
        f"&span t_end = {4 * step}, samples = 5 /\n" + output("t", *places, *readings, *up)
    ).rows
    found = np.array([-1, 16, -30, 16, -1]) @ rows[places].to_numpy() / (12 * step**2)
    found[2] += 9.81 - amplitude * rate**2 * math.cos(2 * rate * step)
    read = rows.loc[2, readings].to_numpy()
    assert np.linalg.norm(read) == pytest.approx(np.linalg.norm(found), abs=1e-6)
    assert read @ rows.loc[2, up].to_numpy() == pytest.approx(found[2], abs=1e-6)


@each(
    "effects",
    "",
    "&effects drag_force = 0.4, vibration_amplitude = 0, 0, 0.01, vibration_rate = 30 /\n",
)
def test_accelerometer_beside_the_centre_of_mass(spin, effects):
    """Its place is found: readings differ by the acceleration of the body there."""
    step, arm = 1e-3, np.array([0.02, -0.01, 0.03])
    scene = (
        "&top mass = 1.3, inertia = 0.9, 0.8, 0.6, length = 0.3 /\n"
        "&initial theta = 0.6, omega = 0.5, 0.3, 9 /\n"
        "&integration relative_tolerance = 1e-14 /\n" + effects
    )
    rates, readings = ([f"{name}{i}" for i in (1, 2, 3)] for name in ("omega", "accelerometer"))
    span = "&span t_end = 2, samples = 2001 /\n"
    rows = spin(scene + span + output("t", *rates, *readings)).rows
    omega = rows[rates].to_numpy()
    rate = (omega[:-4] - 8 * omega[1:-3] + 8 * omega[3:-1] - omega[4:]) / (12 * step)
    omega = omega[2:-2]
    rows = rows[2:-2].copy()
    rows[readings] += np.cross(rate, arm) + np.cross(omega, np.cross(omega, arm))
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv', lever_arm = '15 mm', 0, 0\n"
    fit += "    unknown = 'lever_arm(1)', 'lever_arm(2)', 'lever_arm(3)', profile = .false. /\n"
    found = spin(scene + fit, data=rows[::20].to_csv(index=False), code=(0, 3)).rows
    assert list(found.estimate) == pytest.approx(arm, abs=1e-7)
    assert list(found.unit) == ["m"] * 3


def test_law_of_a_spin_down(spin):
    """The example: dry friction, damping, drag and the start, within 3 standard errors."""
    rows = spin("spin_down").rows
    known = np.array([2e-4, 4e-5, 4e-6, 10])
    assert (abs(rows.estimate - known) < 3 * rows.standard_error).all()
    assert (rows.standard_error < 0.1 * rows.estimate).all()


RUNS = """\
&study kind = 'fit' /
&fit data = 'slow.csv', 'fast.csv', unknown = 'top.inertia(1)', 'top.inertia(3)'
     unknown_each = 'initial.psi_rate', start_each(1,:) = 10.1, 17.8 /
"""


def test_runs_in_files(spin):
    """Runs with other spins, units and columns; each has its residuals, and a poor one its name."""
    slow, fast = (measure(spin, TOP.replace("= 14", f"= {spin_rate}")) for spin_rate in (10, 18))
    fast = fast[["t", "phi", "theta"]].rename(columns={"t": "t_ms"}).assign(t_ms=1e3 * fast.t)
    files = {"slow": noisy(slow, 1), "fast": noisy(fast[::2], 2)}
    run = spin(OTHERS + RUNS, **files)
    rows = run.rows
    own = ["initial.psi_rate[1]", "initial.psi_rate[2]"]
    assert list(rows.parameter) == ["top.inertia(1)", "top.inertia(3)", *own]
    assert (abs(rows.estimate - [0.875, 0.25, 10, 18]) < 4 * rows.standard_error).all()
    assert list(rows.start[2:]) == [10.1, 17.8]
    assert f"covariance__{own[1]}" in rows
    assert len(run.table("residuals")) == 61
    assert list(run.table("residuals2"))[:4] == ["t_ms", "phi", "phi_fit", "phi_residual"]
    files["fast"] = noisy(fast.assign(phi=fast.phi + 0.1 * np.sin(fast.t_ms / 500)), 2)
    poor = spin(OTHERS + RUNS, code=3, **files)
    assert "poor_fit: " in poor.status
    assert "run 2, fast.csv: " in poor.status
    assert "slow.csv" not in poor.status
    error = spin.refuse(OTHERS + RUNS.replace("fast.csv", "none.csv"), **files)
    assert "run 2, none.csv: cannot read" in error
    assert "1 error" in error
    error = spin.refuse(OTHERS + RUNS.replace("fast.csv", "slow.csv"), **files)
    assert "run 2, slow.csv: the table is named twice" in error
    error = spin.refuse(OTHERS + RUNS.replace("'slow.csv'", "32*'slow.csv'"), **files)
    assert "too many values for data" in error
    for wrong in ("start_each(2,:) = 1, 2", "from(3) = 1"):
        error = spin.refuse(OTHERS + RUNS.replace("17.8", f"17.8, {wrong}"), **files)
        assert "there is no fit.unknown" in error


def test_laws_are_compared(spin):
    """The criterion prefers the law that is true, and strong correlations are named."""
    law = "'effects.friction_torque', 'top.damping(3)', 'effects.drag_moment(3)', 'initial.omega3'"
    told = {}
    for unknown in (law, law.replace("'effects.friction_torque', ", "")):
        text = (ROOT / "input/spin_down.nml").read_text(encoding="utf-8").replace(law, unknown)
        if unknown != law:
            text = text.replace("friction_torque = 1e-4", "friction_torque = 0")
        spin.write((ROOT / "input/spin_down.csv").read_text(encoding="utf-8"), "spin_down.csv")
        run = spin(text, code=(0, 3))
        (line,) = (line for line in run.out.splitlines() if line.startswith("  AIC"))
        told[unknown] = float(line.split()[1])
        assert f"# AIC: {line.split()[1]}\n" in run.path.read_text(encoding="utf-8")
        assert "top.damping(3) and effects.drag_moment(3) -0.9" in run.out
    assert told[law] < min(told.values()) + 1e-9
    assert max(told.values()) - told[law] > 10


def test_what_is_not_identifiable(spin):
    """Angles tell ratios of mass and inertia only."""
    fit = FIT.replace("'initial.psi_rate'", "'top.mass'")
    run = spin(TOP + fit, code=3, data=noisy(measure(spin), 2))
    assert "not_identifiable" in run.status
    assert run.rows.singular_value[2] < 1e-8 * run.rows.singular_value[0]


def test_a_parameter_that_does_not_enter(spin):
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'top.inertia(3)' /\n"
    run = spin(TOP + fit, code=3, data=noisy(measure(spin)[:1], 3))
    assert "not_identifiable" in run.status


UNKNOWN = ", unknown = 'top.inertia(1)', 'top.inertia(3)', 'initial.psi_rate'"


@each(
    "old, new, message",
    ("data = 'data.csv',", "", "there are no measurements"),
    ("data.csv", "none.csv", "none.csv"),
    (UNKNOWN, "", "nothing is"),
    ("'initial.psi_rate'", "'top.shape'", "is not a number"),
    ("'initial.psi_rate'", "'top.inertia(3)'", "named twice"),
    ("'initial.psi_rate'", "'monting(1)'", "did you mean 'mounting'?"),
    ("'initial.psi_rate'", "'offset.thta'", "did you mean 'theta'?"),
    ("'initial.psi_rate'", "'top.density'", "has no value"),
    ("'data.csv',", "'data.csv', columns = 'tip_error',", "errors, bounds"),
    ("'data.csv',", "'data.csv', averaged = 1e-3,", "first average begins before"),
    ("'data.csv',", "'data.csv', averaged = 9,", "intervals of averages overlap"),
    ("'data.csv',", "'data.csv', columns = 'omega1',", "omega1"),
    ("'data.csv',", "'data.csv', sigma = 1, 2,", "standard deviations"),
    ("&fit ", "&span nutations = 2 /\n&fit ", "span of a fit"),
    ("&fit ", "&span t_end = 2 /\n&fit ", "the last measurement"),
    ("&fit ", "&integration method = 'rk4', steps = 9 /\n&fit ", "fixed step"),
)
def test_refusals(spin, old, new, message):
    text = (TOP + FIT).replace(old, new)
    assert text != TOP + FIT
    error = spin.refuse(text, data=noisy(measure(spin), 0))
    assert "scene.nml" in error
    assert message in error


@each(
    "data, message",
    ("t,theta\n0,1\n2,1\n1,1\n3,1\n4,1\n", "do not increase"),
    ("t,theta\n-1,1\n2,1\n3,1\n4,1\n", "before the start"),
    ("t,theta\n0,1\n2,one\n3,1\n4,1\n", "theta"),
    ("t,theta\n0,1\n2,inf\n3,1\n4,1\n", "theta has an infinite reading"),
    ("t,theta\n0,\n2,nan\n3,\n4,\n", "theta has no reading"),
    ("t,theta\n0,1\n2,nan\n3,1\n4,1\n", "3 measurements do not determine"),
    ("t,theta,theta_sigma\n0,1,\n2,1,\n3,1,nan\n4,1,\n", "no reading with a standard"),
    ("t,theta,theta_sigma\n0,1,1\n2,1,0\n3,1,1\n4,1,1\n", "not above 0"),
    ("t,thetta\n0,1\n2,1\n", "thetta"),
    ("t\n0\n2\n", "no column"),
    ("theta\n0\n2\n", "t"),
    ("t,theta\n", "t"),
    ("t,theta\n0,1\n2,1\n", "do not determine"),
)
def test_bad_measurements(spin, data, message):
    assert message in spin.refuse(TOP + FIT, data=data)
    # What is sought of a sensor is no second error.
    with_sensor = FIT.replace("unknown =", "unknown = 'offset.theta',")
    assert spin.refuse(TOP + with_sensor, data=data).count("error:") == 1


CLOCK = 123.456


def test_the_sign_of_a_clock(spin):
    """The times of a clock with the offset that should be taken from them."""
    data = measure(spin)
    data.t += CLOCK
    said = spin.refuse(TOP + FIT, f"fit.time_offset={CLOCK}", data=noisy(data, 0))
    assert "the first row is then at 246.9 s of the motion" in said
    assert f"give -{CLOCK} where" in said
    assert spin(TOP + FIT, f"fit.time_offset=-{CLOCK}", data=noisy(data, 0)).status == "ok"


def test_an_offset_in_another_unit(spin):
    """The offset of a column has the name of that column."""
    data = noisy(measure(spin, columns=("theta", "omega1_deg")), 0)
    said = spin.refuse(TOP + FIT.replace("initial.psi_rate", "offset.omega1"), data=data)
    assert "write offset.omega1_deg" in said


FAST = """\
&top mass = 0.1 inertia = 2e-4, 2e-4, 5e-5 length = 0.03 damping = 3*1.2e-7 /
&initial theta_deg = 20 omega3 = 200 /
"""


def test_damping_across_the_axis_of_a_symmetric_body(spin):
    """The damping about x is also that about y."""
    motion = FAST + "&span t_end = 20, samples = 401 /\n"
    data = noisy(spin(motion + output("t", "theta", "omega3")).rows, 5, 1e-5)
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv' unknown = 'top.damping(1)', '{}' /\n"
    start = FAST.replace("1.2e-7", "1e-7")
    rows = spin(start + fit.format("top.damping(3)"), data=data).rows
    assert (abs(rows.estimate - 1.2e-7) < 4 * rows.standard_error).all()


def test_figure(spin):
    """Residuals are two panels a measured column, with what the table says; parameters none."""
    run = spin(TOP + FIT, data=noisy(measure(spin), 1))
    assert choose_figures(read_table(run.path))[0] == []
    table = read_table(run.path.with_name("scene.residuals.csv"))
    (kind,) = choose_figures(table)[0]
    assert kind.name == "fit"
    *panels, _ = kind.draw(table).axes
    titles = [axes.get_title("left") for axes in panels[::2]]
    assert titles == ["φ (degrees)", "θ (degrees)", "ψ (degrees)"]
    for axes, name in zip(panels[1::2], ANGLES, strict=True):
        shown = np.radians(axes.lines[-1].get_ydata())
        residuals = table.rows[name] - table.rows[f"{name}_fit"]
        np.testing.assert_allclose(shown, residuals, rtol=1e-12)
