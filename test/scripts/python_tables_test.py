"""Tables of runs as data sets of xarray and data frames of pandas."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

import python_library  # noqa: F401
import spintop

SCENE = {"study": {"kind": "sweep"}, "initial": {"psi_rate": 5.0}, "span": {"t_end": 1.0}}
SCENE["top"] = {"mass": 1, "inertia": (0.875, 0.875, 0.25), "length": 0.866}
SCENE["output"] = {"columns": ["theta_max", "motion_class", "theta_end"]}
THETA = np.linspace(0.1, 2.0, 7)


class TablesTest(unittest.TestCase):
    def test_sweep_to_xarray(self) -> None:
        """A variable per column over the cases, with units and meanings; words are texts."""
        table = spintop.sweep(SCENE, {"initial.theta": THETA}).rows
        found = table.to_xarray()
        self.assertIsInstance(found, xr.Dataset)
        assert dict(found.sizes) == {"case": 7}
        assert found["case"].to_numpy().tolist() == list(range(1, 8))
        assert {"case", *found.data_vars} == set(table)
        assert found["initial.theta"].to_numpy().tolist() == THETA.tolist()
        for name in ("theta_max", "theta_end"):
            assert found[name].to_numpy().tolist() == table[name].tolist()
            assert found[name].attrs["units"] == "rad"
            assert found[name].attrs["long_name"] == table.meanings[name]
        assert set(found["status"].to_numpy()) == {"ok"}
        highest = found.isel(case=found["theta_max"].argmax("case"))
        assert float(highest["theta_max"]) == table["theta_max"].max()

    def test_sweep_over_a_grid(self) -> None:
        """Columns have the shape of the arrays; dimensions are the parameters, with values."""
        rates = np.array([1.0, 4.0, 20.0])
        given = {"initial.theta": THETA[:, None], "initial.psi_rate": rates}
        table = spintop.sweep({**SCENE, "study": {}}, given).rows
        assert table["theta_end"].shape == (7, 3)
        assert table["motion_class"].shape == (7, 3)
        for i, theta in enumerate(THETA):
            alone = spintop.sweep(SCENE, {**given, "initial.theta": theta}).rows
            assert table["theta_end"][i].tolist() == alone["theta_end"].tolist()
        found = table.to_xarray()
        assert dict(found.sizes) == {"initial.theta": 7, "initial.psi_rate": 3}
        assert found["initial.theta"].to_numpy().tolist() == THETA.tolist()
        assert found["initial.psi_rate"].to_numpy().tolist() == rates.tolist()
        assert found["theta_end"].dims == ("initial.theta", "initial.psi_rate")
        assert len(table.to_pandas()) == 21

    def test_a_grid_without_axes_of_its_own(self) -> None:
        """Arrays that vary along both dimensions name none."""
        both = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
        found = spintop.sweep(SCENE, {"initial.theta": both, "top.length": [[0.8], [0.9]]})
        data = found.rows.to_xarray()
        assert dict(data.sizes) == {"top.length": 2, "axis2": 3}
        assert data["initial.theta"].to_numpy().tolist() == both.tolist()

    def test_motion(self) -> None:
        top = spintop.Top(spintop.Body(**SCENE["top"]), theta=0.3, psi_rate=5.0)
        times = np.linspace(0, 1, 5)
        motion = top.exact(times, ["theta", "omega3"])
        data = motion.to_xarray()
        assert dict(data.sizes) == {"t": 5}
        assert data["t"].to_numpy().tolist() == times.tolist()
        assert data["theta"].to_numpy().tolist() == motion.theta.tolist()
        assert data["omega3"].attrs["units"] == "rad/s"
        assert list(motion.to_pandas()) == ["theta", "omega3"]
        plane = top.exact(times[:4].reshape(2, 2), "theta")
        assert dict(plane.to_xarray().sizes) == {"axis1": 2, "axis2": 2}
        assert "<table" in motion._repr_html_()

    def test_figures_in_a_notebook(self) -> None:
        """They are pictures there, and figures of matplotlib by name."""
        scene = {**SCENE, "study": {}, "output": {}}
        scene["initial"] = {"theta": 0.3, "psi_rate": 5.0}
        figures = spintop.run(scene).plot("angles")
        assert list(figures) == ["angles"]
        assert figures._repr_html_().count("<img") == 1

    def test_trajectory_to_xarray(self) -> None:
        """Rows are at times; the data set is stored and read again with all bits."""
        scene = {**SCENE, "study": {}, "output": {"columns": ["t", "theta", "energy"]}}
        scene["initial"] = {"theta": 0.3, "psi_rate": 5.0}
        found = spintop.run(scene).rows.to_xarray()
        assert dict(found.sizes) == {"t": 1001}
        assert list(found.coords) == ["t"]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "motion.nc"
            try:
                found.to_netcdf(path)
            except (ImportError, ValueError) as error:
                self.skipTest(f"xarray has no library for NetCDF: {error}")
            with xr.open_dataset(path) as again:
                xr.testing.assert_identical(again, found)

    def test_pandas(self) -> None:
        """The same columns in the same order, over a copy that may be changed."""
        table = spintop.sweep(SCENE, {"initial.theta": THETA}).rows
        frame = table.to_pandas()
        assert list(frame) == list(table)
        for name in table:
            assert frame[name].tolist() == table[name].tolist()
        assert pd.api.types.is_float_dtype(frame["theta_max"])
        means = frame.groupby("motion_class")["theta_max"].mean()
        assert set(means.index) == set(table["motion_class"])
