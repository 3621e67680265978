"""Fits from Python: what measurements determine, and what they do not."""

import unittest

import numpy as np

import python_library  # noqa: F401
import spintop

TRUTH = {"top.inertia(3)": 0.25, "initial.psi_rate": 14.0}
GIVEN = {
    "top": {"mass": 1, "inertia": (0.875, 0.875, 0.26), "length": 0.75**0.5},
    "initial": {"theta": 0.5, "psi_rate": 13.8},
}
NOISE = 1e-3


def measure(*columns: str) -> dict[str, np.ndarray]:
    """Columns of the true motion with noise, rad."""
    body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
    t = np.linspace(0.0, 5.0, 101)
    exact = spintop.Top(body, theta=0.5, psi_rate=14.0).exact(t, list(columns))
    noise = np.random.default_rng(1).normal(0, NOISE, (len(columns), t.size))
    return {"t": t, **{name: exact[name] + noise[i] for i, name in enumerate(columns)}}


class FitTest(unittest.TestCase):
    """Two numbers of a symmetric top."""

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
