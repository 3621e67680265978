"""What fits say of themselves: what cannot be told, odd data, intervals, and the robust loss."""

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop
from conftest import each
from drawn_fits import REDUNDANT, draw_redundant

TOP = {"mass": 1.2, "inertia": (0.9, 0.9, 0.4), "length": 0.7}
RELEASED = {"theta": 0.7, "psi_rate": 11.0}
MOVING = {"theta": 0.7, "phi_rate": 0.5, "theta_rate": 0.3, "psi_rate": 11.0}
METHODS = ({}, {"method": "dop853"}, {"method": "dop853", "relative_tolerance": 1e-6})
METHODS += ({"method": "taylor", "relative_tolerance": 1e-13},)
METHODS += ({"method": "ode45", "relative_tolerance": 1e-5},)
WINDOWS = (0.02, 0.1, 0.6, 3.0, 20.0, 100.0)
ANGLES = ("phi", "theta", "psi")


def measure(
    columns: tuple[str, ...], t: np.ndarray, start: dict, noise: float, top: dict = TOP, **more
) -> dict[str, np.ndarray]:
    motion = spintop.Top(spintop.Body(**top), **start, **more).integrate(
        t, columns, relative_tolerance=1e-14
    )
    source = np.random.default_rng(3)
    return {"t": t, **{name: motion[name] + source.normal(0, noise, t.size) for name in columns}}


def fit(
    data: dict, unknown: list[str], start: dict, top: dict = TOP, factor: float = 1.001, **keys
):
    given = {"top": dict(top), "initial": dict(start)}
    given["integration"] = keys.pop("integration", {})
    given["fit"] = {key: keys.pop(key) for key in ("loss",) if key in keys}
    for name in unknown:
        group, key = name.split(".")
        name, _, index = key.partition("(")
        values = np.atleast_1d(np.array(given[group][name], dtype=float))
        axes = {"inertia(1)": [0, 1]}.get(key, [int(index[:1] or 1) - 1])
        values[axes] *= factor
        given[group][name] = values.tolist() if index else float(values[0])
    return spintop.fit(data, unknown, {k: v for k, v in given.items() if v}, **keys)


def late(result: spintop.Result) -> str:
    """The warnings of the run, without those of the input."""
    lines = result.warnings.splitlines()
    return "\n".join(line for line in lines if line.startswith("warning: "))


@each("window", *WINDOWS)
@each("integration", *METHODS, ids=str)
def test_products_are_not_identifiable(integration: dict, window: float) -> None:
    """Of a top that is released, phi and theta depend on I3 psi_rate, theta on the ratios too."""
    t = np.linspace(window / 40, window, 40)
    for noise in (0.0, 1e-3):
        data = measure(("phi", "theta"), t, RELEASED, noise)
        for unknown in (
            ["top.inertia(3)", "initial.psi_rate"],
            ["top.inertia(1)", "top.inertia(3)", "top.length"],
        ):
            result = fit(data, unknown, RELEASED, integration=integration)
            assert not result.ok
            assert "not_identifiable" in result.summary, (unknown, noise, result.summary)
            assert np.isnan(result.rows["standard_error"]).all()


def test_redundant_unknowns_are_never_ok() -> None:
    """Spin and bias, scale and offset, products: with any noise, and the unknowns are named."""
    for number in range(3 * len(REDUNDANT)):
        data, unknown, given = draw_redundant(number)
        result = spintop.fit(data, unknown, given)
        ending = result.summary.splitlines()[-1]
        assert "not_identifiable" in ending, (number, unknown, result.summary)
        assert sum(name in ending for name in unknown) >= 2, (number, ending)


def test_spin_and_bias_of_a_constant_rotation() -> None:
    """However far the search goes, rounding tells nothing."""
    t = np.linspace(0, 10, 201)
    given = {"top": TOP, "initial": {"theta": 1.0, "omega3": 80.0}}
    for seed in range(1, 4):
        data = {"t": t, "omega3": 82 + np.random.default_rng(seed).normal(0, 0.1, t.size)}
        result = spintop.fit(data, ["initial.omega3", "offset.omega3"], given)
        assert not result.ok
        assert "do not determine initial.omega3, offset.omega3" in result.summary
        assert np.isnan(result.rows["standard_error"]).all()


@each("integration", *METHODS[:4], ids=str)
def test_ill_conditioned_fits_succeed(integration: dict) -> None:
    """Where little, but something, tells the parameters apart, the truth is in wide intervals."""
    truth = {"top.inertia(1)": 0.9, "top.inertia(3)": 0.4, "initial.psi_rate": 11.0}
    for window, noise in ((0.05, 1e-7), (0.2, 1e-6), (1.0, 1e-5), (5.0, 1e-3)):
        t = np.linspace(window / 60, window, 60)
        result = fit(
            measure(ANGLES, t, MOVING, noise), list(truth), MOVING, integration=integration
        )
        assert result.ok, (window, result.summary)
        check_rows(result.rows)
        for value, estimate, error in zip(
            truth.values(), result.rows["estimate"], result.rows["standard_error"], strict=True
        ):
            assert abs(estimate - value) < 5 * error


def check_rows(rows: spintop.results.Table) -> None:
    """Intervals around estimates, finite, and as wide as the standard errors say."""
    for estimate, error, lower, upper in zip(
        *(rows[name] for name in ("estimate", "standard_error", "lower", "upper")), strict=True
    ):
        assert 0.5 * error < estimate - lower < 10 * error
        assert 0.5 * error < upper - estimate < 10 * error


@each("noise", 1e-4, 1e-2)
def test_intervals_end_with_the_range(noise: float) -> None:
    """A damping that is 0: the interval begins at 0, where the range does, and has an end."""
    t = np.linspace(0.1, 4.0, 40)
    data = measure(("theta", "omega3"), t, MOVING, noise)
    top = {**TOP, "damping": (0.0, 0.0, 1e-4)}
    rows = fit(data, ["top.damping(3)"], MOVING, top).rows
    assert rows["lower"][0] == 0
    assert 0 <= rows["estimate"][0] < rows["upper"][0] < 1
    # Nearly without data about the inertia: it stays above 0, whatever the linear model says.
    data = measure(ANGLES, t[:6] / 5, MOVING, 0.05)
    rows = fit(data, ["top.inertia(1)", "top.inertia(3)"], MOVING).rows
    for lower, estimate, upper in zip(rows["lower"], rows["estimate"], rows["upper"], strict=True):
        assert np.isnan(lower) or 0 <= lower <= estimate <= upper


def test_no_warnings_of_noise() -> None:
    """Gaussian errors, and none at all: no warning."""
    t = np.linspace(0.1, 6.0, 80)
    for noise in (0.0, 1e-6, 1e-3, 0.1):
        for integration in METHODS[:3]:
            data = measure(ANGLES, t, MOVING, noise)
            result = fit(data, ["initial.psi_rate"], MOVING, integration=integration)
            assert result.ok
            assert result.warnings == ""


def wrapped(angle: np.ndarray) -> np.ndarray:
    """An angle from -pi to pi."""
    return np.angle(np.exp(1j * angle))


def test_wrapped_angles() -> None:
    """Each angle with turns, in both ranges, with many and with few rows per turn."""
    for rows in (20, 60, 400):
        t = np.linspace(0.05, 6.0, rows)
        for name in ("phi", "psi"):
            data = measure(ANGLES, t, MOVING, 1e-3)
            assert fit(data, ["initial.psi_rate"], MOVING).ok
            for angle in (wrapped(data[name]), wrapped(data[name] - np.pi) + np.pi):
                if np.ptp(data[name]) < 2 * np.pi or np.abs(np.diff(angle)).max() < 1:
                    continue
                with pytest.raises(spintop.InputError, match=f"{name} jumps by almost a turn"):
                    fit({**data, name: angle}, ["initial.psi_rate"], MOVING)
    # A single turn that was missed when the angle was unwrapped.
    data["psi"] = data["psi"] + 2 * np.pi * (t > 3)
    with pytest.raises(spintop.InputError, match="psi jumps"):
        fit(data, ["initial.psi_rate"], MOVING)


def test_times_in_another_unit() -> None:
    """Milliseconds and microseconds end before the search, hours and few rows are doubted."""
    t = np.linspace(0.1, 6.0, 60)
    data = measure(("theta",), t, MOVING, 1e-3)
    assert fit(data, ["top.length"], MOVING).warnings == ""
    for factor in (1e3, 1e6):
        with pytest.raises(spintop.InputError, match=r"periods of the motion.*turns of theta"):
            fit({**data, "t": factor * t}, ["top.length"], MOVING)
    hours = fit({**data, "t": t / 3600}, ["top.length"], MOVING, profile=False)
    assert "hardly begins" in hours.warnings
    # What does not turn may be read seldom, and so may what the start predicts.
    seldom = np.linspace(0.1, 400.0, 60)
    for column in ("omega3", "theta"):
        result = fit(
            measure((column,), seldom, MOVING, 1e-3), ["initial.psi_rate"], MOVING, factor=1
        )
        assert result.ok
        assert result.warnings == ""
    # Rows so far apart are doubted, as no turns tell.
    data = measure(("omega3",), seldom, MOVING, 1e-3) | {"t": 20 * seldom}
    assert "periods of the motion" in fit(data, ["initial.psi_rate"], MOVING, factor=1).warnings


def test_a_clock_that_does_not_begin_at_the_start() -> None:
    """From one span on the time of the start has to be given, with which the fit succeeds."""
    t = np.linspace(0.0, 6.0, 60)
    data = measure(("theta", "phi"), t, MOVING, 1e-3)
    data["t"] = t + 7.0
    with pytest.raises(spintop.InputError, match=r"starts at 0\n.*fit\.time_offset: -7"):
        fit(data, ["top.length"], MOVING)
    given = {"top": TOP, "initial": MOVING, "fit": {"time_offset": -7.0}}
    assert spintop.fit(data, ["top.length"], given).ok


def test_residuals_that_are_no_noise() -> None:
    """A drag that the model does not know."""
    t = np.linspace(0.05, 6.0, 120)
    data = measure(("theta", "omega3"), t, MOVING, 1e-4, effects={"drag_moment": (0, 0, 0.01)})
    found = fit(data, ["top.length", "initial.psi_rate"], MOVING)
    assert not found.ok
    assert "poor_fit: the residuals of" in found.summary
    assert "the residuals of omega3 are no noise" in found.summary


@each("sigma", None, 1e-3)
def test_rows_that_stand_out(sigma: float | None) -> None:
    """They are named, the worst with its row; with Huber's loss they move nothing."""
    truth = {"top.inertia(3)": 0.4, "initial.psi_rate": 11.0}
    t = np.linspace(0.05, 6.0, 200)
    clean = measure(ANGLES, t, MOVING, 1e-3)
    data = {name: np.array(values) for name, values in clean.items()}
    data["theta"][16] = 100.0
    data["psi"][::25] += 0.3
    squares = fit(data, list(truth), MOVING, sigma=sigma)
    assert not squares.ok
    assert "theta in row 17, t = 0.528" in squares.summary
    robust = fit(data, list(truth), MOVING, loss="huber", sigma=sigma)
    assert robust.ok, robust.summary
    assert "9 of 600" in robust.summary or int(robust.summary.split("huber: ")[1].split()[0]) > 9
    assert "theta in row 17" in late(robust)
    assert "psi in row" in late(robust)
    best = fit(clean, list(truth), MOVING, sigma=sigma).rows
    huber = fit(clean, list(truth), MOVING, loss="huber", sigma=sigma).rows
    for i, value in enumerate(truth.values()):
        error = best["standard_error"][i]
        assert abs(robust.rows["estimate"][i] - value) < 4 * error
        assert error * 0.9 < robust.rows["standard_error"][i] < 1.3 * error
        assert abs(huber["estimate"][i] - best["estimate"][i]) < error
        assert huber["standard_error"][i] == pytest.approx(error, rel=0.15)
        assert abs(squares.rows["estimate"][i] - value) > 2 * error or sigma is None
    check_rows(robust.rows)


def test_coverage_of_the_robust_loss() -> None:
    """Its intervals cover the truth in 95 % of fits to noise of which a twentieth is tenfold."""
    truth, fits = {"top.inertia(3)": 0.4, "initial.psi_rate": 11.0}, 120
    t = np.linspace(0.1, 6.0, 60)
    clean = measure(ANGLES, t, MOVING, 0.0)
    source, covered = np.random.default_rng(8), np.zeros(2)
    for _ in range(fits):
        deviations = 1e-3 * np.where(source.random((3, t.size)) < 0.05, 10, 1)
        noise = source.normal(0, 1, (3, t.size)) * deviations
        data = {"t": t, **{name: clean[name] + noise[i] for i, name in enumerate(ANGLES)}}
        rows = fit(data, list(truth), MOVING, loss="huber").rows
        true = np.array(list(truth.values()))
        covered += (rows["lower"] <= true) & (true <= rows["upper"])
    assert np.all(np.abs(covered - 0.95 * fits) < 4 * (fits * 0.95 * 0.05) ** 0.5)


def test_an_outlier_among_many_rows() -> None:
    """One reading of 1000 rad/s, no deviations: the robust loss ignores it."""
    t = np.linspace(0.01, 10.0, 1000)
    top = {**TOP, "damping": (0.0, 0.0, 0.02)}
    data = measure(("theta", "omega3"), t, MOVING, 1e-3, top)
    data["omega3"][400] = 1000.0
    unknown = ["top.inertia(3)", "top.damping(3)"]
    result = fit(data, unknown, MOVING, top, loss="huber")
    assert result.ok
    for row, value in enumerate((0.4, 0.02)):
        lower, upper = result.rows["lower"][row], result.rows["upper"][row]
        error = result.rows["standard_error"][row]
        assert abs(result.rows["estimate"][row] - value) < 4 * error < 0.01 * value
        assert 0 < lower < value + 3 * error and value - 3 * error < upper < 2 * value
    assert "omega3 in row 401" in late(result)
    squares = fit(data, unknown, MOVING, top)
    for lower, estimate, upper in zip(
        *(squares.rows[name] for name in ("lower", "estimate", "upper")), strict=True
    ):
        assert np.isnan(lower) or 0 <= lower <= estimate <= upper
        assert upper < np.inf or not squares.ok
