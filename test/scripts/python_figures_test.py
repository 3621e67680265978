"""Figures and pages of results in Python: of what a result holds, without another run."""

import re
import shutil
import tempfile
import unittest
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
import xarray as xr

import python_library  # noqa: F401
import spintop
from conftest import MISSING, ROOT, each
from figure_checks import texts
from spintop import animation
from spintop.library import library
from spintop_figures.tables.table import TableError, read_table

mpl.use("agg")
INPUTS = ROOT / "input"
STUDIES = {
    "slow_top_events": {"samples = 20001": "samples = 201"},
    "certified_top": {},
    "fit": {},
    "random_tops": {},
    "map_spin_tilt": {"count(1) = 100": "count(1) = 5", "count(2) = 100": "count(2) = 5"},
    "spin_tilt_statistics": {"cases = 100000": "cases = 500"},
    "nutation_indices": {"cases = 28672": "cases = 700"},
}
"""Inputs of all kinds but those with times, and what makes them quick."""
TOP = {"mass": 1, "inertia": (0.875, 0.875, 0.25), "length": 0.8}
WORK = """\
&study kind = 'work_precision' /
&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.866 /
&initial theta_deg = 20 omega3 = 20 /
&span t_end = 2 /
&work_precision methods = 'rk2', 'rk4' steps = 1000, 2000, 4000 /
"""


@pytest.fixture
def calls() -> Iterator[list[str]]:
    made: list[str] = []
    loaded = library()

    def counted(name: str) -> object:
        function = getattr(loaded, name)

        def call(*arguments: object) -> object:
            made.append(name)
            return function(*arguments)

        return mock.patch.object(loaded, name, call)

    with counted("spintop_run"), counted("spintop_sweep"):
        yield made


def changed(name: str, folder: Path) -> Path:
    text = (INPUTS / f"{name}.nml").read_text(encoding="utf-8")
    for old, new in STUDIES[name].items():
        assert old in text
        text = text.replace(old, new)
    path = folder / f"{name}.nml"
    path.write_text(text, encoding="utf-8")
    if name == "fit":
        shutil.copy(INPUTS / "fit.csv", folder)
    return path


def run_as_files(path: Path, folder: Path) -> spintop.Result:
    """Run an input, also as files in a folder beside it; a build without FLINT skips the test."""
    try:
        return spintop.run(path, folder=folder / "files")
    except spintop.InputError as error:
        if MISSING in str(error):
            pytest.skip(MISSING)
        raise


@each("name", *STUDIES)
def test_as_files(name: str, folder: Path) -> None:
    """The figures of a result are those of the files of the same run."""
    path = changed(name, folder)
    run_as_files(path, folder)
    result = spintop.run(path)
    for file in folder.glob("*"):  # the result needs none
        if file.name != "files":
            file.unlink()
    drawn = result.plot()
    files = sorted((folder / "files").glob("*.csv"))
    wanted = {key: figure for file in files for key, figure in spintop.plot(file).items()}
    assert drawn.keys() == wanted.keys() and drawn
    for key, figure in wanted.items():
        assert texts(drawn[key]) == texts(figure), key
        (again,) = result.plot(key).values()
        assert texts(again) == texts(figure), key


@each("name", *STUDIES)
def test_tables(name: str, folder: Path) -> None:
    """A result has all tables that the run writes, each with the lines that are no rows."""
    path = changed(name, folder)
    kept = run_as_files(path, folder)
    written = (folder / "files").glob("*.csv")
    files = {file.stem.partition(".")[2] or "rows": file for file in written}
    assert set(kept.tables) == set(files)
    for key, table in kept.tables.items():
        file = files[key]
        lines = file.read_text(encoding="utf-8").splitlines()
        first = next(i for i, line in enumerate(lines) if line[0] != "#")
        assert table.frame.splitlines() == [
            line for i, line in enumerate(lines) if i <= first or line[0] == "#"
        ]
        rows = read_table(file).rows
        assert list(rows) == list(table)
        for column in rows:
            if rows[column].dtype != object:
                np.testing.assert_array_equal(rows[column], np.ravel(table[column]), column)


def test_one_run(calls: list[str], folder: Path) -> None:
    """Figures and the page of a motion need no other call."""
    start, span = {"theta": 0.4, "omega3": 20}, {"t_end": 2, "samples": 41}
    result = spintop.run({"top": TOP, "initial": start, "span": span})
    assert "angles" in result.plot() and list(result.plot("trace")) == ["trace"]
    page = "@TITLE@ @FACTS@ @ANCHOR@ @NAME@ @ROWS@ @DATA@"
    with mock.patch.object(animation, "viewer", return_value=page):
        assert "all 41 rows" in result.animate().page
    assert calls == ["spintop_run"]


def test_times(calls: list[str]) -> None:
    result = spintop.run(WORK)
    axes = result.plot("precision_time")["precision_time"].axes[0]
    drawn = {time for line in axes.lines if line.get_label()[0] != "_" for time in line.get_xdata()}
    assert drawn == set(result["time_s"]) and calls == ["spintop_run"]


def test_sweep_over_arrays(calls: list[str]) -> None:
    """Its figures, too, over the parameters of the call."""
    given = {"top": TOP, "initial": {"theta": 0.4}, "span": {"t_end": 2}}
    given["output"] = {"columns": ["nutation_period", "force_max"]}
    theta, spin = np.linspace(0.2, 1, 6)[:, None], np.linspace(10, 30, 5)
    result = spintop.sweep(given, {"initial.theta": theta, "initial.omega3": spin})
    assert "maps" in result.plot() and calls == ["spintop_sweep"]
    with pytest.raises(TypeError, match="the table is no trajectory"):
        result.animate()


def test_what_has_no_figure() -> None:
    top = spintop.Top(spintop.Body(mass=1, inertia=(0.9, 0.9, 0.3), length=0.5), theta=0.4)
    with pytest.raises(TypeError, match="events of a top have no figures"):
        top.events("theta = 0.5", 1.0).plot()
    result = spintop.run(WORK)
    for name, reason in (("pie", "there is no figure pie"), ("maps", "kind sweep: no maps figure")):
        with pytest.raises(TableError, match=re.escape(reason)):
            result.plot(name)


# Tables of runs as data sets of xarray and data frames of pandas.

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
