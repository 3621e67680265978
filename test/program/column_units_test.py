"""Columns, measurements and axes in other units: the same numbers, and what says so."""

import math

import numpy as np
import pytest

from conftest import each, output

TOP = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial theta = 0.6, theta_rate = 0.3, psi_rate = 14 /
"""
SPAN = "&span t_end = 3, samples = 31 /\n"
SIZES = {
    "t_ms": ("t", 1e-3, "ms"),
    "theta_deg": ("theta", math.pi / 180, "deg"),
    "psi_turns": ("psi", 2 * math.pi, "turns"),
    "omega3_rpm": ("omega3", 2 * math.pi / 60, "rpm"),
    "phi_rate_deg": ("phi_rate", math.pi / 180, "deg/s"),
    "com_z_mm": ("com_z", 1e-3, "mm"),
    "lz_mJ": ("lz", 1e-3, "mJ s"),
    "accelerometer1_g0": ("accelerometer1", 9.80665, "g0"),
}
SWEEP = "&study kind = 'sweep' /\n" + TOP.replace(", psi_rate = 14", "") + "&span t_end = 3 /\n"
AXIS = "&sweep parameter(1) = 'initial.psi_rate', from(1) = 10, to(1) = 20, count(1) = 5 /\n"
QUANTITIES = {
    "theta_max_deg": ("theta_max", math.pi / 180, "deg"),
    "nutation_period_ms": ("nutation_period", 1e-3, "ms"),
    "precession_rate_rpm": ("precession_rate", 2 * math.pi / 60, "rpm"),
    "azimuth_after_period_rad": ("azimuth_after_period_deg", 180 / math.pi, "rad"),
}


def check(run, sizes):
    rows = run.rows
    for name, (own, size, unit) in sizes.items():
        assert any(f" {name} [{unit}]: " in line for line in run.comments)
        np.testing.assert_array_equal(rows[name], rows[own] / size)


DERIVATIVES = [f"{name}__initial.psi_rate" for name in ("theta_deg", "theta")]


@each("more", [], DERIVATIVES)
@each("how", ["method=exact"], ["method=rk4", "steps=300"])
def test_trajectory(spin, more, how):
    names = [*SIZES, *(own for own, _, _ in SIZES.values()), *more]
    run = spin(TOP + SPAN + output(*names), *(f"integration.{setting}" for setting in how))
    check(run, SIZES)
    if more:
        degrees, radians = (run.rows[name] for name in more)
        errors = run.rows[f"{more[0]}_error"]
        assert (abs(degrees - np.degrees(radians)) <= 2 * errors + 1e-12).all()
        unit = next(line for line in run.comments if f"{more[0]} [" in line)
        assert "[deg/(rad/s)]" in unit


def test_events(spin):
    settings = "output.events=theta_deg = 36 rising", "span.stop_at=t_ms = 2500"
    run = spin(TOP + SPAN + output("t_ms", "t", "theta_deg"), *settings)
    assert run.rows.t_ms.iloc[-1] == 2500
    angles = list(run.table("events").theta_deg)
    assert len(angles) > 1
    assert angles == pytest.approx([36] * len(angles), abs=1e-9)


def test_sweep(spin):
    """Quantities, those of the list in degrees, derivatives."""
    names = [*QUANTITIES, *(own for own, _, _ in QUANTITIES.values())]
    check(spin(SWEEP + AXIS + output(*names)), QUANTITIES)
    names = [f"{name}__initial.theta" for name in ("theta_max_deg", "theta_max")]
    rows = spin(SWEEP + AXIS + output(*names)).rows
    np.testing.assert_allclose(rows[names[0]], np.degrees(rows[names[1]]), rtol=1e-8)


def test_statistics(spin):
    """With rows, without, and bins whose ends have units."""
    text = "&statistics columns = 'theta_max_deg', 'theta_max' over = 'nutation_period_ms'"
    text += " bins = 3 from = '0.1 s' to = 900 /\n"
    columns = output("theta_max", "theta_max_deg", "nutation_period_ms")
    found = []
    for rows in (columns, "&output rows = 'none' /\n"):
        table = spin(SWEEP + AXIS + rows + text, code=(0, 3)).table("statistics")
        assert list(table.nutation_period_ms_from[1:]) == [100, 1100 / 3, 1900 / 3]
        mean = table.theta_max_deg_mean[0]
        assert mean == pytest.approx(math.degrees(table.theta_max_mean[0]), abs=1e-12)
        found.append(table.filter(like="theta"))
    np.testing.assert_array_equal(*found)


def test_beside_all(spin):
    """Columns that `all` does not have may follow; what it has, or nobody, is refused."""
    names = ["all", "theta_deg", "theta__initial.psi_rate"]
    assert {"theta", *names[1:]} < set(spin(TOP + SPAN + output(*names)).rows)
    for name, problem in (("theta", "is named twice"), ("nonsense", "there is no column")):
        assert problem in spin.refuse(TOP + SPAN + output("all", name))


@each("column, settings", ("theta_bound_deg", []), ("theta_deg", ["output.certified=t"]))
def test_proved_numbers(spin, column, settings):
    """Bounds and certified numbers are proved in their own units only."""
    error = spin.refuse(TOP + SPAN + output("t", column), *settings)
    assert "is proved in the unit of the column only" in error


def test_axes(spin):
    """Ends and values with units are those without, wherever the parameter is named."""
    axes = "from(1) = '-60 rpm', to(1) = '600 rpm', count(1) = 12"
    axes += " parameter(1) = 'initial.psi_rate'"
    axes += " parameter(2) = 'initial.phi', values(2,:) = '10 deg', 0.5, '0.25 turn'"
    run = spin(f"{SWEEP}&sweep {axes} /\n")
    rates = np.linspace(-2 * math.pi, 20 * math.pi, 12)
    np.testing.assert_allclose(run.rows["initial.psi_rate"][::3], rates, rtol=1e-7, atol=1e-13)
    values = [math.radians(10), 0.5, math.pi / 2]
    np.testing.assert_allclose(run.rows["initial.phi"][:3], values, rtol=1e-15)
    assert f"from = {-2 * math.pi!r}" in run.head.replace("(1)", "")


@each("law", "from(1) = 30, to(1) = '2 rev/s', count(1) = 4", "values(1,:) = 30, 60, 90, 120")
def test_axes_named_with_units(spin, law):
    """The table is in the unit of the name, the motions are those of the key."""
    columns = output("theta_max", "theta_max__initial.psi_rate")
    axis = "&sweep parameter(1) = 'initial.psi_rate', values(1,:) = {} /\n"
    rates = [math.pi * turns for turns in (1, 2, 3, 4)]
    expected = spin(SWEEP + columns + axis.format(str(rates)[1:-1])).rows
    run = spin(SWEEP + columns + f"&sweep parameter(1) = 'initial.psi_rate_rpm', {law} /\n")
    np.testing.assert_allclose(run.rows["initial.psi_rate_rpm"], [30, 60, 90, 120], rtol=1e-14)
    assert " initial.psi_rate_rpm [rpm]: " in "".join(run.comments)
    for name in ("theta_max", "theta_max__initial.psi_rate"):
        np.testing.assert_allclose(run.rows[name], expected[name], rtol=1e-9)
    refused = run.head.replace("psi_rate_rpm'", "psi_rate_mm'")
    assert "unknown parameter 'initial.psi_rate_mm'" in spin.refuse(refused)


def test_table_of_cases(spin):
    text = "initial.psi_rate_rpm,initial.phi,top.length_cm\n60,0.1,85\n-30,0.2,90\n"
    scene = SWEEP + "&sweep table = 'cases.csv' /\n"
    rows = spin(scene, cases=text).rows
    own = f"initial.psi_rate,initial.phi,top.length\n{2 * math.pi},0.1,.85\n{-math.pi},0.2,.9\n"
    expected = spin(scene, cases=own).rows
    assert list(rows.columns)[1:4] == ["initial.psi_rate_rpm", "initial.phi", "top.length_cm"]
    assert rows.iloc[:, 1:4].to_numpy().tolist() == [[60, 0.1, 85], [-30, 0.2, 90]]
    np.testing.assert_allclose(rows["theta_max"], expected["theta_max"], rtol=1e-12)
    said = " ".join(spin.refuse(scene, cases=text.replace("cm", "deg")).split())
    assert "unknown parameter 'top.length_deg'" in said
    assert "top.length is in m; units are m, cm, mm" in said


@each("value", "12 rpm", "'12 rpm'", " 72 deg/s ", "12rpm", "1.2e1 rpm")
def test_overrides(spin, value):
    row = spin(TOP + SPAN, f"initial.psi_rate={value}").rows.iloc[0]
    assert row.psi_rate == pytest.approx(0.4 * math.pi, abs=1e-15)


def test_overrides_of_lists_and_axes(spin):
    """Each number may have a unit; a later number has no unit again."""
    run = spin(TOP + SPAN, "top.inertia=8750 kg cm^2, 0.875, '2500 kg cm^2'")
    assert "inertia = 0.875, 0.875, 0.25" in run.head
    rates = spin(SWEEP + AXIS, "sweep.from(1)=60 rpm", "sweep.to(1)=20").rows["initial.psi_rate"]
    assert rates[0] == pytest.approx(2 * math.pi, abs=1e-15)
    rates = spin(SWEEP + AXIS, "sweep.from(1)=60 rpm", "sweep.from(1)=6").rows["initial.psi_rate"]
    assert rates[0] == 6


FIT = (
    "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'top.inertia(1)', "
    "'initial.psi_rate', 'offset.{0}', from(2) = {1}, to(2) = 15, sigma = {2} /\n"
)
RATE = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'initial.psi_rate' /\n"


def measured(spin, names, noise=None):
    rows = spin(TOP + SPAN + output(*names)).rows
    source = np.random.default_rng(1)
    for name in names:
        rows[name] += (noise or {}).get(name, 0) * source.normal(size=len(rows))
    return rows


DEGREE, DEVIATIONS = math.degrees(1), "'1 mrad', '0.002 rad/s'"


def test_same_fit(spin):
    """Estimates and their errors do not depend on the units; residuals are in those."""
    found, offsets, residuals = [], [], []
    for names, size, turns, low, sigma in (
        (["t", "theta", "omega1"], 1, 1, "13", "0.001, 0.002"),
        (["t_ms", "theta_deg", "omega1_rpm"], DEGREE, 30 / math.pi, "'130 rpm'", DEVIATIONS),
    ):
        data = measured(spin, names, {names[1]: 1e-3 * size, names[2]: 2e-3 * turns})
        fit = FIT.format(names[1], low, sigma)
        if size > 1:
            fit = fit.replace(", sigma", f", columns = '{names[1]}', '{names[2]}', sigma")
        run = spin(TOP.replace("14", "14.1") + fit, data=data.to_csv(index=False))
        assert run.rows.unit[2] == ("rad" if size == 1 else "deg")
        numbers = run.rows[["estimate", "standard_error"]].to_numpy().T
        found.append(numbers[:, :2])
        offsets.append(numbers[:, 2] / size)
        rest = run.table("residuals")
        assert rest.columns[0] == names[0]
        residuals.append(rest[f"{names[1]}_residual"] / size)
        assert len(rest.columns) == 7
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)
    np.testing.assert_allclose(offsets[1], offsets[0], rtol=1e-4)
    np.testing.assert_allclose(residuals[1], residuals[0], rtol=1e-7, atol=1e-9)


def test_wrapped_and_deviations(spin):
    """Turns of 360 degrees, and a standard deviation in each row."""
    data = measured(spin, ["t", "psi_deg"])
    data.psi_deg %= 360
    data["psi_deg_sigma"] = 0.1
    text = data.to_csv(index=False)
    start = TOP.replace("14", "14.02") + RATE
    assert "fit.wrapped = 'psi_deg'" in spin.refuse(start, data=text)
    for name in ("psi", "psi_deg"):
        (found,) = spin(start.replace("unk", f"wrapped = '{name}', unk")).rows.estimate
        assert found == pytest.approx(14, abs=1e-8)
    said = spin.refuse(start, data=text.replace("psi_deg_s", "psi_s"))
    assert "the table has psi_sigma, but no column psi" in said


def test_mounting(spin):
    """The components of a rotated vector may have units of their own."""
    data = measured(spin, ["t", "omega1_deg", "omega2", "omega3_rpm"]).to_csv(index=False)
    fit = "&study kind = 'fit' /\n&fit data = 'data.csv', mounting = '1 deg', 0, 0\n"
    fit += "    unknown = 'mounting(1)', 'top.inertia(1)' /\n"
    rows = spin(TOP.replace("0.875, 0.875", "0.87, 0.87") + fit, data=data).rows
    np.testing.assert_allclose(rows.estimate, [0, 0.875], rtol=1e-7, atol=1e-8)


@each(
    "head, message",
    ("t,theta,theta_deg", "column 'theta_deg' is named twice"),
    ("t,t_ms,theta", "two columns of the table are the same"),
    ("t,theta_rpm,psi", "theta is in rad, and can have a suffix"),
    ("t_m,theta,psi", "no column of the table is the time"),
)
def test_refusals(spin, head, message):
    rows = "".join(f"{0.1 * i},{1 + 0.1 * i},1.0\n" for i in range(9))
    assert message in " ".join(spin.refuse(TOP + RATE, data=f"{head}\n{rows}").split())
