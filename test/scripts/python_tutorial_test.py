"""The tutorial in Python and the example notebook: they run, and their three languages agree."""

import json
import unittest
import warnings
from pathlib import Path

import matplotlib as mpl
import numpy as np

import python_library  # noqa: F401
import spintop
from manual.pages import blocks_of

ROOT = Path(__file__).resolve().parent.parent.parent

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


class TutorialTest(unittest.TestCase):
    """The page."""

    def test_inputs_are_those_of_the_programs(self) -> None:
        """Each input has the bits of the Python above it."""
        mpl.use("agg")
        _, (one, _, methods, skew, many, tops) = run_blocks()
        runs = [spintop.run(block.text) for block in BLOCKS if block.tags[0] == "nml"]
        for name in ("phi", "theta", "psi"):
            assert runs[0][name][1:].tolist() == one["motion"][name].tolist()
        settings = {"method": "dop853", "relative_tolerance": 1e-9}
        found = methods["top"].integrate(runs[1]["t"], ["orientation_error"], **settings)
        error = runs[1]["orientation_error"]
        assert error.tolist() == found.orientation_error.tolist()
        assert runs[2].events.row_count > 4
        for name in ("t", "theta"):
            np.testing.assert_array_equal(runs[2].events[name], skew["result"].events[name])
        assert runs[3].rows.row_count == 1000
        np.testing.assert_allclose(runs[3]["theta_max"], many["table"]["theta_max"], rtol=1e-13)
        assert tops["found"]["theta_max"].shape == (400,)

    def test_fortran_is_that_of_the_examples(self) -> None:
        """Every line stands in an example, which a test runs."""
        examples = {line.strip() for path in ROOT.glob("example/*.f90") for line in path.open("r")}
        lines = [
            line.strip()
            for block in BLOCKS
            if block.tags == ("text",)
            for line in block.text.splitlines()
        ]
        assert len(lines) > 10
        assert [line for line in lines if line not in examples] == []


class NotebookTest(unittest.TestCase):
    """The notebook."""

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
