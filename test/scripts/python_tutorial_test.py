"""The tutorial in Python and the example notebook: they run, and agree with inputs."""

import json
import unittest
import warnings

import matplotlib as mpl
import numpy as np

import python_library  # noqa: F401
import spintop
from conftest import ROOT
from manual.pages import blocks_of

BLOCKS = blocks_of(ROOT / "doc/python_tutorial.md")
NOTEBOOK = ROOT / "doc/examples/slow_top.ipynb"


def run_blocks() -> tuple[dict[str, object], list[dict[str, object]]]:
    """Run the programs of the page one after the other: all names, and those after each."""
    names: dict[str, object] = {"print": lambda *_: None}
    states = []
    for block in BLOCKS:
        if block.tags[0] == "python":
            exec(compile(block.text, str(block), "exec"), names)
            states.append(dict(names))
    return names, states


class PythonTutorialTest(unittest.TestCase):
    def test_inputs_are_those_of_the_programs(self) -> None:
        """An input has the bits of the Python that says the same."""
        mpl.use("agg")
        _, (one, _, methods, skew, many, tops) = run_blocks()
        (text,) = (block.text for block in BLOCKS if block.tags[0] == "nml")
        run = spintop.run(text)
        for name in ("phi", "theta", "psi"):
            assert run[name][1:].tolist() == one["motion"][name].tolist()
        settings = {"method": "dop853", "relative_tolerance": 1e-9}
        output = {"columns": ["t", "orientation_error"]}
        span = {"t_end": 5, "samples": 501}
        run = spintop.run(methods["top"].input(span=span, integration=settings, output=output))
        found = methods["top"].integrate(run["t"], ["orientation_error"], **settings)
        assert run["orientation_error"].tolist() == found.orientation_error.tolist()
        events = ["lower_turning_points", "upper_turning_points"]
        run = spintop.run(skew["skew"].input(span={"t_end": 8}, output={"events": events}))
        assert run.events.row_count > 4
        for name in ("t", "theta"):
            np.testing.assert_array_equal(run.events[name], skew["result"].events[name])
        sweep = {"parameter": ["initial.psi_rate"], "from": [1], "to": [30], "count": [1000]}
        scene = many["scene"] | {"study": {"kind": "sweep"}, "sweep": sweep}
        np.testing.assert_allclose(
            spintop.run(scene)["theta_max"], many["table"]["theta_max"], rtol=1e-13
        )
        assert tops["found"]["theta_max"].shape == (400,)

    def test_cells(self) -> None:
        """They run in order, without warnings and stored outputs, and the claims are true."""
        mpl.use("agg")
        notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
        assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
        names: dict[str, object] = {"print": lambda *_: None}
        for cell in notebook["cells"]:
            if cell["cell_type"] != "code":
                continue
            assert (cell["outputs"], cell["execution_count"]) == ([], None)
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                text = "".join(cell["source"]).replace("top.animate(t_end=5)", "")
                exec(compile(text, f"{NOTEBOOK.name} {cell['id']}", "exec"), names)
        rk4 = names["rk4"]
        assert abs(rk4.energy_error).max() < 1e-12
        assert np.degrees(rk4.orientation_error.max()) > 1
        assert (np.diff(names["lowest"]) < 0).all()
