"""Fits that reach the truth from afar, by sensors as they are; and those that say they do not."""

import unittest

import numpy as np
import pandas as pd
import pytest

import python_library  # noqa: F401
import spintop
from conftest import each
from drawn_fits import draw, draw_tumbling

TOP = {"mass": 0.2, "inertia": (4e-4, 4e-4, 3e-4), "length": 0.03}
START = {"theta": 1.0, "omega3": 80.0}
UNKNOWN = ["initial.omega3", "initial.theta"]
BESIDE = {"top": TOP, "initial": {"theta": 1.01, "omega3": 81.0}}


def motion(t: np.ndarray, *columns: str) -> spintop.Motion:
    return spintop.Top(spintop.Body(**TOP), **START).exact(t, columns)


def noise(t: np.ndarray, deviation: float, seed: int = 0) -> np.ndarray:
    return np.random.default_rng([5, seed]).normal(0, deviation, t.size)


def estimates(result: spintop.Result) -> dict[str, tuple[float, float]]:
    rows = result.rows
    values = zip(rows["estimate"].tolist(), rows["standard_error"].tolist(), strict=True)
    return dict(zip(rows["parameter"].tolist(), values, strict=True))


def check(result: spintop.Result, **truth: float) -> None:
    """The fit is ok, and each number within 4 of its standard errors."""
    assert result.ok, result.summary
    found = estimates(result)
    for name, value in truth.items():
        estimate, error = found[name.replace("__", ".")]
        assert abs(estimate - value) < 4 * error, (name, estimate, value, error)
        assert np.isfinite(error)


@each("off", -0.016, -0.008, 0.003, 0.008, 0.016)
def test_a_long_motion_from_afar(off: float) -> None:
    """Over 500 nutations a start 0.2 % off is a whole one late at the end; windows lead there."""
    t = np.linspace(0, 30, 3001)
    data = {"t": t, "theta": motion(t, "theta").theta + noise(t, 0.01)}
    given = {"top": TOP, "initial": {"theta": 1.0, "omega3": 80.0 * (1 + off)}}
    result = spintop.fit(data, UNKNOWN, given, sigma=0.01)
    check(result, initial__omega3=80.0, initial__theta=1.0)
    assert "probability" in result.summary
    assert "windows" in result.summary
    without = {**given, "fit": {"windows": False, "searches": 1}}
    alone = spintop.fit(data, UNKNOWN, without, sigma=0.01)
    if abs(off) > 0.005:
        assert not alone.ok
        assert "poor_fit" in alone.summary or "not_converged" in alone.summary


def test_a_range_is_searched() -> None:
    """Where the value is far off, starts within a given range find it, and that is reported."""
    t = np.linspace(0, 4, 401)
    data = {"t": t, "theta": motion(t, "theta").theta + noise(t, 0.003)}
    given = {"top": TOP, "initial": {"theta": 1.0, "omega3": 140.0}}
    given["fit"] = {"from": [40.0], "to": [160.0], "searches": 40}
    result = spintop.fit(data, ["initial.omega3"], given)
    check(result, initial__omega3=80.0)
    for wrong in ({"from": [90.0], "to": [120.0]}, {"from": [90.0]}):
        with pytest.raises(spintop.InputError, match="range"):
            spintop.fit(data, ["initial.omega3"], {**given, "fit": wrong})


def test_a_camera() -> None:
    """The tip in pixels: scale, centre and the time of its clock are unknown."""
    t = np.linspace(0.1, 3, 291)
    axis = motion(t, "axis_x", "axis_y")
    data = {"t": t + 0.05, "axis_x": 320 + 200 * axis.axis_x + noise(t, 0.5)}
    data["axis_y"] = 240 - 200 * axis.axis_y + noise(t, 0.5, 1)
    sensors = [{"column": "axis_x", "offset": 310.0, "scale": 190.0}]
    sensors += [{"column": "axis_y", "offset": 250.0, "scale": -190.0}]
    given = {**BESIDE, "sensor": sensors, "fit": {"time_offset": -0.04}}
    of_sensors = ["offset.axis_x", "scale.axis_x", "offset.axis_y", "scale.axis_y", "offset.t"]
    result = spintop.fit(data, ["initial.omega3", "initial.theta", *of_sensors], given)
    truth = dict(zip(of_sensors, (320.0, 200.0, 240.0, -200.0, -0.05), strict=True))
    check(result, initial__omega3=80.0, initial__theta=1.0, **truth)


def test_a_mounted_sensor() -> None:
    """A gyroscope and an accelerometer whose axes are turned by an unknown rotation."""
    t = np.linspace(0, 3, 301)
    vector = np.array([0.1, -0.05, 0.2])
    angle = np.linalg.norm(vector)
    k = np.cross(np.eye(3), vector / angle)
    turned = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    names = [[f"{what}{i}" for i in (1, 2, 3)] for what in ("omega", "accelerometer")]
    found = motion(t, *names[0], *names[1])
    data = {"t": t}
    for j, vectors in enumerate(names):
        readings = turned.T @ np.array([found[name] for name in vectors])
        for i in (0, 1):
            data[vectors[i]] = readings[i] + noise(t, 0.1, 3 * j + i)
    unknown = ["initial.omega3", "mounting(1)", "mounting(2)", "mounting(3)"]
    given = {**BESIDE, "initial": {"theta": 1.0, "omega3": 81.0}}
    result = spintop.fit(data, unknown, given, sigma=0.1)
    check(result, **dict(zip(unknown, (80.0, *vector), strict=True)))


def test_wrapped_angles_and_missing_readings() -> None:
    """psi modulo a turn, and cells without a reading that leave the others of their row."""
    t = np.linspace(0, 3, 301)
    found = motion(t, "psi", "theta")
    theta = found.theta + noise(t, 0.01)
    theta[::7] = np.nan
    data = {"t": t, "psi": np.mod(found.psi + noise(t, 0.01, 1), 2 * np.pi), "theta": theta}
    result = spintop.fit(data, UNKNOWN, {**BESIDE, "fit": {"wrapped": ["psi"]}})
    check(result, initial__omega3=80.0, initial__theta=1.0)
    residuals = result.tables["residuals"]
    assert np.isnan(residuals["theta_residual"][::7]).all()
    assert np.nanmax(np.abs(residuals["psi_residual"])) < 0.1
    with pytest.raises(spintop.InputError, match=r"fit\.wrapped = 'psi'"):
        spintop.fit(data, UNKNOWN, BESIDE)


@each(
    "column, scale, offset",
    ("psi", 4096 / (2 * np.pi), 0.0),
    ("psi", -1000 / (2 * np.pi), 7.0),
    ("psi_deg", 1.0, 0.0),
    ("psi_deg", 100 / 360, -50.0),
    ("psi_turn", 4096.0, 0.0),
)
def test_wrapped_columns_of_any_unit_and_scale(column: str, scale: float, offset: float) -> None:
    """Counts of an encoder give the fit of radians: they repeat after a turn of the scale."""
    t = np.linspace(0, 2, 501)
    psi = motion(t, "psi").psi + noise(t, 0.002)
    given = {"top": TOP, "initial": {"theta": 1.0, "omega3": 80.1}, "fit": {"wrapped": ["psi"]}}
    radians = spintop.fit({"t": t, "psi": np.mod(psi, 2 * np.pi)}, UNKNOWN, given)
    check(radians, initial__omega3=80.0)
    turn = {"psi": 2 * np.pi, "psi_deg": 360.0, "psi_turn": 1.0}[column]
    counts = {"t": t, column: offset + scale * turn * np.mod(psi / (2 * np.pi), 1)}
    given["sensor"] = [{"column": column, "scale": scale, "offset": offset}]
    result = spintop.fit(counts, UNKNOWN, given)
    check(result, initial__omega3=80.0)
    for name in ("estimate", "standard_error"):
        np.testing.assert_allclose(result.rows[name], radians.rows[name], rtol=1e-6)
    with pytest.raises(spintop.InputError, match=rf"turns of {column} are not known"):
        spintop.fit(counts, [*UNKNOWN, f"scale.{column}"], given)
    with pytest.raises(spintop.InputError, match=rf"{column} jumps by almost a turn"):
        spintop.fit(counts, UNKNOWN, {**given, "fit": {}})


def test_counts_of_an_inclination() -> None:
    """The range of theta is that of the angle, not of the readings of its sensor."""
    t = np.linspace(0, 2, 201)
    data = {"t": t, "theta": 100 + 650 * (motion(t, "theta").theta + noise(t, 0.002))}
    given = {**BESIDE, "sensor": [{"column": "theta", "scale": 650.0, "offset": 100.0}]}
    check(spintop.fit(data, UNKNOWN, given), initial__omega3=80.0)
    data["theta"] = np.degrees(data["theta"])
    with pytest.raises(spintop.InputError, match=r"outside of \[0, pi\]"):
        spintop.fit(data, ["initial.omega3"], given)


def test_the_end_is_not_worse_than_the_start() -> None:
    """Nor far from the truth and ok, where the search begins at it or close by."""
    for number in range(12):
        data, unknown, given, sigma = draw_tumbling(number)
        columns = [name for name in data if name != "t"]
        top, start = spintop.Body(**given["top"]), given["initial"]
        at_start = spintop.Top(top, **start).integrate(data["t"], columns, relative_tolerance=1e-12)
        result = spintop.fit(data, unknown, given, sigma=sigma)
        before = sum(np.sum((data[name] - at_start[name]) ** 2) for name in columns)
        rest = result.tables["residuals"]
        after = sum(np.sum(rest[f"{name}_residual"] ** 2) for name in columns)
        assert after <= before * (1 + 1e-9), (number, before, after)
        if number % 2 == 0 and result.ok:
            found = result["estimate"][0], result["standard_error"][0]
            assert abs(found[0] - start["omega3"]) < 6 * found[1], (number, result.summary)


@each("start", 8.79, 8.80)
def test_a_start_at_the_truth_is_kept(start: float) -> None:
    """Windows of rows lead this motion away from where all rows lead at once."""
    top = {"mass": 1.0, "inertia": (5.25, 4.17, 1.34), "length": 0.2736, "damping": (0.0288,) * 3}
    initial = {"theta": 1.17, "psi": 0.8, "phi_rate": 0.185, "theta_rate": -0.394}
    t = np.linspace(0, 220, 150)
    names = ("omega1", "omega2", "omega3")
    moving = spintop.Top(spintop.Body(**top), **initial, omega3=8.79)
    true = moving.integrate(t, names, relative_tolerance=1e-13)
    for seed in range(4):
        source = np.random.default_rng(seed)
        data = {"t": t} | {name: true[name] + source.normal(0, 0.05, t.size) for name in names}
        given = {"top": top, "initial": {**initial, "omega3": start}}
        check(spintop.fit(data, ["initial.omega3"], given, sigma=0.05), initial__omega3=8.79)


@each("side", 1, -1)
def test_a_start_beyond_the_pole(side: int) -> None:
    """A pendulum close to hanging: the search goes on where theta ends, and says so."""
    t = np.linspace(0, 4, 401)
    top = {"mass": 1.55, "inertia": (0.2325, 0.2325, 0.1), "length": 0.296}
    start = {"theta": np.pi - 0.003, "theta_rate": 0.66}
    true = spintop.Top(spintop.Body(**top), **start).exact(t, ["omega1"])
    data = {"t": t, "omega1": true.omega1 + noise(t, 0.002)}
    given = {"top": {**top, "inertia": (0.22, 0.22, 0.1)}}
    given["initial"] = {"theta": 3.13, "theta_rate": side * 0.66, "psi": np.pi * (side < 0)}
    unknown = ["top.inertia(1)", "initial.theta", "initial.theta_rate"]
    result = spintop.fit(data, unknown, given)
    check(result, initial__theta=np.pi - 0.003, initial__theta_rate=0.66)
    assert abs(result.rows["estimate"][0] - 0.2325) < 4 * result.rows["standard_error"][0]
    assert ("beyond the pole" in result.warnings) == (side < 0)


def test_averaged_readings() -> None:
    """Each is the mean over the time between rows; as values at an instant they do not fit."""
    t, width = np.arange(0.02, 3, 0.02), 0.02
    fine = width * ((np.arange(40) + 0.5) / 40 - 0.5)
    theta = motion(np.ravel(t[:, None] + fine), "theta").theta.reshape(-1, 40).mean(axis=1)
    data = {"t": t, "theta": theta + noise(t, 2e-4)}
    unknown = ["initial.omega3", "initial.theta", "top.inertia(1)"]
    averaged = spintop.fit(data, unknown, {**BESIDE, "fit": {"averaged": width}})
    check(averaged, initial__omega3=80.0, initial__theta=1.0)


def test_sigma_per_row_and_column() -> None:
    """By names, a number or an array; columns of other noise count less."""
    t = np.linspace(0, 3, 301)
    found = motion(t, "psi", "theta")
    sigma = np.where(t < 1, 0.002, 0.05)
    theta = found.theta + noise(t, 1.0, 1) * sigma
    data = {"t": t, "psi": found.psi + noise(t, 0.02), "theta": theta}
    result = spintop.fit(data, UNKNOWN, BESIDE, sigma={"psi": 0.02, "theta": sigma})
    check(result, initial__omega3=80.0, initial__theta=1.0)
    for wrong in ({"psi": 0.02}, {"psi": 0.02, "theta": 1.0, "phi": 1.0}):
        with pytest.raises(spintop.InputError, match="sigma"):
            spintop.fit(data, UNKNOWN, BESIDE, sigma=wrong)


def test_columns_of_other_units() -> None:
    """Without sigma each column has its own deviation: rad and rad/s are not mixed."""
    t = np.linspace(0, 3, 301)
    found = motion(t, "theta", "omega1")
    data = {"t": t, "theta": found.theta + noise(t, 0.001)}
    alone = estimates(spintop.fit(data, UNKNOWN, BESIDE))
    both = {**data, "omega1": found.omega1 + noise(t, 1.0, 1)}
    both = estimates(spintop.fit(both, UNKNOWN, BESIDE))
    for name in UNKNOWN:
        assert both[name][1] < 1.05 * alone[name][1]


@each("loss", "squares", "huber", "tukey")
def test_one_wrong_row(loss: str) -> None:
    """Of 10,000: least squares say that they are spoiled, robust losses reach the truth."""
    t = np.linspace(0, 20, 10_000)
    theta = motion(t, "theta").theta + noise(t, 0.003)
    theta[1234] += 1e3
    result = spintop.fit({"t": t, "theta": theta}, UNKNOWN, {**BESIDE, "fit": {"loss": loss}})
    if loss == "squares":
        assert not result.ok
        assert "poor_fit" in result.summary
        assert "row 1235" in result.summary
    else:
        check(result, initial__omega3=80.0, initial__theta=1.0)


def test_a_motion_that_does_not_explain() -> None:
    """Friction that the model has not: residuals that repeat, or a drift, are named."""
    t = np.linspace(0, 10, 1001)
    body = spintop.Body(**TOP, damping=(0, 0, 2e-6))
    theta = spintop.Top(body, **START).integrate(t, "theta").theta + noise(t, 0.002)
    result = spintop.fit({"t": t, "theta": theta}, UNKNOWN, BESIDE)
    assert not result.ok
    assert "poor_fit: the residuals of theta are no noise" in result.summary


def test_no_profile() -> None:
    """Standard errors and the ends of the linear model, and nothing that is no number."""
    t = np.linspace(0, 3, 301)
    data = {"t": t, "theta": motion(t, "theta").theta + noise(t, 0.003)}
    result = spintop.fit(data, ["initial.omega3"], BESIDE, profile=False)
    assert "nan" not in result.summary.lower()
    assert np.isfinite([result.rows["lower"], result.rows["upper"]]).all()


@each(
    "change, message",
    (lambda data: data.update(theta=np.degrees(data["theta"])), "outside of \\[0, pi\\]"),
    (lambda data: data.update(t=data["t"] + 1.7e9), "the motion starts at 0"),
    (lambda data: data.update(theta=data["theta"][:-1]), "theta has the shape"),
    (lambda data: data.update(t=data["t"].astype("datetime64[s]")), "do not increase"),
    (lambda data: data.update(theta=data["theta"] * np.nan), "theta has no reading"),
    (lambda data: data.pop("t"), "no times"),
)
def test_mistakes_are_named(change, message: str) -> None:
    """What is no measurement of a motion is refused by name, without a file of the package."""
    t = np.linspace(0, 3, 301)
    data = {"t": t, "theta": motion(t, "theta").theta}
    change(data)
    with pytest.raises(spintop.InputError, match=message) as caught:
        spintop.fit(data, ["initial.omega3"], BESIDE)
    assert "/tmp" not in str(caught.value)


@pytest.mark.slow
def test_drawn_motions() -> None:
    """Most reach the truth within 4 standard errors, and what does not is not ok."""
    reached = 0
    for number in range(18):
        case = draw(number, seed=3)
        result = case.fit(knows_sigma=number % 2 == 0)
        away = [
            abs(estimate - case.truth[name]) / error
            for name, (estimate, error) in estimates(result).items()
        ]
        reached += result.ok and max(away) < 4
        assert not result.ok or max(away) < 5, (number, case.kind, away)
    assert reached >= 16


TRUTH = {"top.inertia(3)": 0.25, "initial.psi_rate": 14.0}
GIVEN = {"top": {"mass": 1, "inertia": (0.875, 0.875, 0.26), "length": 0.75**0.5}}
GIVEN["initial"] = {"theta": 0.5, "psi_rate": 13.8}
NOISE = 1e-3


def measure(*columns: str) -> dict[str, np.ndarray]:
    body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
    t = np.linspace(0.0, 5.0, 101)
    exact = spintop.Top(body, theta=0.5, psi_rate=14.0).exact(t, list(columns))
    noise = np.random.default_rng(1).normal(0, NOISE, (len(columns), t.size))
    return {"t": t, **{name: exact[name] + noise[i] for i, name in enumerate(columns)}}


class FitTest(unittest.TestCase):
    def test_covariance_is_that_of_the_derivatives(self) -> None:
        """The inverse of J'J, with the Jacobian J of the motion's own derivatives, to 1e-8."""
        columns = ["phi", "theta", "psi"]
        data = measure(*columns)
        rows = spintop.fit(data, list(TRUTH), GIVEN, sigma=NOISE, profile=False).rows
        inertia, rate = rows["estimate"]
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, inertia), length=0.75**0.5)
        top = spintop.Top(body, theta=0.5, psi_rate=rate)
        slopes = []
        for key in TRUTH:
            names = [f"{column}__{key}" for column in columns]
            motion = top.exact(data["t"], names)
            slopes.append(np.concatenate([motion[name] for name in names]))
        jacobian = np.array(slopes).T
        expected = NOISE**2 * np.linalg.inv(jacobian.T @ jacobian)
        found = np.array([rows[f"covariance__{key}"] for key in TRUTH])
        scales = np.sqrt(np.diag(expected))
        difference = np.abs(found - expected) / np.outer(scales, scales)
        assert difference.max() < 1e-8

    def test_an_estimate_is_a_minimum(self) -> None:
        """The residuals are orthogonal to the motion's own derivatives: the search has ended."""
        data = measure("phi", "theta", "psi")
        result = spintop.fit(data, list(TRUTH), GIVEN, sigma=NOISE)
        inertia, rate = result.rows["estimate"]
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, inertia), length=0.75**0.5)
        top = spintop.Top(body, theta=0.5, psi_rate=rate)
        residuals = result.tables["residuals"]
        for key in TRUTH:
            names = {column: f"{column}__{key}" for column in ("phi", "theta", "psi")}
            motion = top.exact(data["t"], list(names.values()))
            slopes = np.concatenate([motion[name] for name in names.values()])
            rest = np.concatenate([residuals[f"{column}_residual"] for column in names])
            cosine = slopes @ rest / np.linalg.norm(slopes) / np.linalg.norm(rest)
            assert abs(cosine) < 1e-6

    def test_one_moment_of_a_symmetric_top(self) -> None:
        """Sought alone it makes the body asymmetric: integrated, or refused with what to do."""
        data = measure("phi", "theta", "psi")
        given = {**GIVEN, "top": {**GIVEN["top"], "inertia": (0.875, 0.875, 0.25)}}
        given["initial"] = {"theta": 0.5, "psi_rate": 14.0}
        result = spintop.fit(data, ["top.inertia(2)"], given, sigma=NOISE)
        assert result.ok, result.summary
        (estimate,), (error,) = result.rows["estimate"], result.rows["standard_error"]
        assert abs(estimate - 0.875) < 5 * error
        for settings in ({"method": "exact"}, {"formulation": "space_frame"}):
            with self.assertRaisesRegex(spintop.InputError, r"seek top\.inertia\(1\)"):
                spintop.fit(data, ["top.inertia(2)"], {**given, "integration": settings})

    def test_residuals_are_drawn(self) -> None:
        """The figure of the residuals, after the file of the measurements is gone."""
        data = measure("phi", "theta", "psi")
        figures = spintop.fit(data, list(TRUTH), GIVEN, sigma=NOISE).plot()
        assert list(figures) == ["fit"]
        assert len(figures["fit"].axes) == 7

    def test_progress(self) -> None:
        """The share of a fit grows from start to start, and from interval to interval."""
        t = np.linspace(0, 20, 1_000)
        data = {"t": t, "theta": 0.5 + 0.1 * np.sin(3 * t**1.3)}
        shares: list[float] = []
        spintop.fit(data, ["initial.psi_rate", "initial.theta"], GIVEN, progress=shares.append)
        assert shares == sorted(shares)
        assert any(0 < share < 1 for share in shares), shares
        assert shares[-1] == 1

    def test_measurements_in_other_units(self) -> None:
        """The same estimates; residuals in the units of the measurements, drawn against time."""
        data = measure("phi", "theta", "psi")
        sigma = {"phi_deg": "", "theta_deg": "", "psi_turn": ""}
        sizes = dict(zip(sigma, (np.degrees(1), np.degrees(1), 0.5 / np.pi), strict=True))
        other = {"t_ms": data["t"] * 1e3}
        for name, size in sizes.items():
            other[name] = data[name.partition("_")[0]] * size
        deviations = {name: NOISE * size for name, size in sizes.items()}
        result = spintop.fit(other, list(TRUTH), GIVEN, sigma=deviations)
        known = spintop.fit(data, list(TRUTH), GIVEN, sigma=NOISE)
        for name in ("estimate", "standard_error"):
            np.testing.assert_allclose(result.rows[name], known.rows[name], rtol=1e-6)
        rest = result.tables["residuals"]
        assert rest.units["theta_deg_residual"] == "deg"
        np.testing.assert_array_equal(rest["t_ms"], other["t_ms"])
        (figure,) = result.plot().values()
        assert figure.axes[4].get_title("left") == "ψ (turn)"
        np.testing.assert_allclose(figure.axes[0].lines[-1].get_xdata(), data["t"], rtol=1e-14)


START_OF_CLOCK = pd.Timestamp("2026-05-31T23:59:59")


@each(
    "times, columns",
    ({"time (ms)": lambda t: 1000 * t + 123456}, {"t": "time"}),
    ({"when": lambda t: (START_OF_CLOCK + pd.to_timedelta(t, "s")).to_numpy()}, {"t": "when"}),
    ({"index": lambda t: START_OF_CLOCK + pd.to_timedelta(t, "s")}, {}),
    ({"index": lambda t: START_OF_CLOCK.tz_localize("CET") + pd.to_timedelta(t, "s")}, {}),
    ({"index": lambda t: pd.to_timedelta(t, "s")}, {}),
)
def test_frames_as_they_come(times, columns) -> None:
    """Names of a frame are mapped, with deviations; its index may have the times."""
    t = np.linspace(0, 3, 301)
    exact = motion(t, "theta", "omega3")
    frame = pd.DataFrame({"tilt [deg]": np.degrees(exact.theta), "gz": np.degrees(exact.omega3)})
    frame["note"] = "a, b"
    for name, make in times.items():
        if name == "index":
            frame.index = make(t)
        else:
            frame[name] = make(t)
    columns = {**columns, "theta": "tilt", "omega3": "gz (dps)"}
    given = {"top": TOP, "initial": {"theta": 1.01, "omega3": 81.0}}
    sigma = {"theta": 1e-3, "omega3": 1e-2}
    result = spintop.fit(frame, UNKNOWN, given, columns=columns, sigma=sigma)
    assert estimates(result)["initial.omega3"][0] == pytest.approx(80, abs=1e-5)
    residuals = result.tables["residuals"]
    assert np.abs(residuals["theta"] - exact.theta).max() < 1e-12
    assert np.abs(residuals["t"] - t).max() < 1e-9
    assert "theta = tilt [deg]" in result.summary
    with pytest.raises(spintop.InputError, match="omega3 = gz"):
        spintop.fit(frame, UNKNOWN, given, columns={**columns, "omega3": "gz"})
