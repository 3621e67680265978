"""Tables of runs as data sets of xarray and data frames of pandas."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "python"))

subprocess.run([ROOT / "scripts/install", "--library"], check=True, capture_output=True)

import spintop  # noqa: E402

SCENE = {
    "study": {"kind": "sweep"},
    "top": {"mass": 1, "inertia": (0.875, 0.875, 0.25), "length": 0.866},
    "initial": {"psi_rate": 5.0},
    "span": {"t_end": 1.0},
    "output": {"columns": ["theta_max", "motion_class", "theta_end"]},
}
THETA = np.linspace(0.1, 2.0, 7)


class TablesTest(unittest.TestCase):
    """A sweep over arrays, and a trajectory."""

    def test_sweep_to_xarray(self) -> None:
        """A variable per column over the cases, with units and meanings; words are texts."""
        table = spintop.sweep(SCENE, {"initial.theta": THETA}).rows
        found = table.to_xarray()
        self.assertIsInstance(found, xr.Dataset)
        self.assertEqual(dict(found.sizes), {"case": 7})
        self.assertEqual(found["case"].to_numpy().tolist(), list(range(1, 8)))
        self.assertEqual({"case", *found.data_vars}, set(table))
        self.assertEqual(found["initial.theta"].to_numpy().tolist(), THETA.tolist())
        for name in ("theta_max", "theta_end"):
            self.assertEqual(found[name].to_numpy().tolist(), table[name].tolist())
            self.assertEqual(found[name].attrs["units"], "rad")
            self.assertEqual(found[name].attrs["long_name"], table.meanings[name])
        self.assertEqual(set(found["status"].to_numpy()), {"ok"})
        highest = found.isel(case=found["theta_max"].argmax("case"))
        self.assertEqual(float(highest["theta_max"]), table["theta_max"].max())

    def test_sweep_over_a_grid(self) -> None:
        """Columns have the shape of the arrays; dimensions are the parameters, with values."""
        rates = np.array([1.0, 4.0, 20.0])
        given = {"initial.theta": THETA[:, None], "initial.psi_rate": rates}
        table = spintop.sweep({**SCENE, "study": {}}, given).rows
        self.assertEqual(table["theta_end"].shape, (7, 3))
        self.assertEqual(table["motion_class"].shape, (7, 3))
        for i, theta in enumerate(THETA):
            alone = spintop.sweep(SCENE, {**given, "initial.theta": theta}).rows
            self.assertEqual(table["theta_end"][i].tolist(), alone["theta_end"].tolist())
        found = table.to_xarray()
        self.assertEqual(dict(found.sizes), {"initial.theta": 7, "initial.psi_rate": 3})
        self.assertEqual(found["initial.theta"].to_numpy().tolist(), THETA.tolist())
        self.assertEqual(found["initial.psi_rate"].to_numpy().tolist(), rates.tolist())
        self.assertEqual(found["theta_end"].dims, ("initial.theta", "initial.psi_rate"))
        self.assertEqual(len(table.to_pandas()), 21)

    def test_a_grid_without_axes_of_its_own(self) -> None:
        """Arrays that vary along both dimensions name none."""
        both = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
        found = spintop.sweep(SCENE, {"initial.theta": both, "top.length": [[0.8], [0.9]]})
        data = found.rows.to_xarray()
        self.assertEqual(dict(data.sizes), {"top.length": 2, "axis2": 3})
        self.assertEqual(data["initial.theta"].to_numpy().tolist(), both.tolist())

    def test_motion(self) -> None:
        """The columns of a motion over its times, with units and meanings."""
        top = spintop.Top(spintop.Body(**SCENE["top"]), theta=0.3, psi_rate=5.0)
        times = np.linspace(0, 1, 5)
        motion = top.exact(times, ["theta", "omega3"])
        data = motion.to_xarray()
        self.assertEqual(dict(data.sizes), {"t": 5})
        self.assertEqual(data["t"].to_numpy().tolist(), times.tolist())
        self.assertEqual(data["theta"].to_numpy().tolist(), motion.theta.tolist())
        self.assertEqual(data["omega3"].attrs["units"], "rad/s")
        self.assertEqual(list(motion.to_pandas()), ["theta", "omega3"])
        plane = top.exact(times[:4].reshape(2, 2), "theta")
        self.assertEqual(dict(plane.to_xarray().sizes), {"axis1": 2, "axis2": 2})
        self.assertIn("<table", motion._repr_html_())

    def test_figures_in_a_notebook(self) -> None:
        """They are pictures there, and figures of matplotlib by name."""
        scene = {**SCENE, "study": {}, "output": {}}
        scene["initial"] = {"theta": 0.3, "psi_rate": 5.0}
        figures = spintop.run(scene).plot("angles")
        self.assertEqual(list(figures), ["angles"])
        self.assertEqual(figures._repr_html_().count("<img"), 1)

    def test_trajectory_to_xarray(self) -> None:
        """Rows are at times; the data set is stored and read again with all bits."""
        scene = {**SCENE, "study": {}, "output": {"columns": ["t", "theta", "energy"]}}
        scene["initial"] = {"theta": 0.3, "psi_rate": 5.0}
        found = spintop.run(scene).rows.to_xarray()
        self.assertEqual(dict(found.sizes), {"t": 1001})
        self.assertEqual(list(found.coords), ["t"])
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
        self.assertEqual(list(frame), list(table))
        for name in table:
            self.assertEqual(frame[name].tolist(), table[name].tolist())
        self.assertTrue(pd.api.types.is_float_dtype(frame["theta_max"]))
        means = frame.groupby("motion_class")["theta_max"].mean()
        self.assertEqual(set(means.index), set(table["motion_class"]))


if __name__ == "__main__":
    unittest.main()
