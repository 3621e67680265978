"""The flag of a good end in Python, C, figures, reports and films (`good_ends_test` has the rest).

A top that dry friction brings to rest goes through all, and one whose steps do not suffice.
"""

import re
from pathlib import Path

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop
from conftest import called, each
from filming import __main__ as film
from reporting.study import read_study
from spintop_figures.style.page import warning_of
from spintop_figures.sweeps.quantities import succeeded, tell_failed
from spintop_figures.tables import names as ends

BODY = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
TOP = spintop.Top(BODY, effects={"friction_torque": 9.0}, theta_deg=40, psi_rate=10)
TIMES = np.linspace(0, 2, 41)
T_STUCK = TOP.quantities("t_stuck", t_end=2)["t_stuck"]
FEW = {"max_steps": 40}
ENDS = [pytest.param({}, True, id="at_rest"), pytest.param(FEW, False, id="step_limit")]
SPAN = {"t_end": 2.0, "samples": 101}
MOVING = ["t", "phi", "theta", "psi"]
SPINS = np.array([5.0, 20.0, 10.0])  # the last top comes to rest in more than 40 steps


def a_sweep(keys: dict) -> dict:
    """The input of a sweep, without its axis."""
    output = {"columns": ["theta_end", "t_stuck"], "file": "many.csv"}
    groups = TOP.input(span={"t_end": 2.0}, integration=keys, output=output)
    return {"study": {"kind": "sweep"}, **groups}


@each("keys, good", *ENDS)
def test_top(keys: dict, good: bool) -> None:
    """The motion goes on at rest; a failure is an exception with its status."""
    columns = ["theta", "psi_rate"]
    if not good:
        with pytest.raises(spintop.MotionError) as caught:
            TOP.integrate(TIMES, columns, **keys)
        assert (caught.value.status, caught.value.code) == ("step_limit", 3)
        with pytest.raises(spintop.MotionError, match="step_limit"):
            TOP.quantities(["theta_end"], t_end=2, **keys)
        return
    motion = TOP.integrate(TIMES, columns)
    rests = TIMES > T_STUCK
    assert 0 < rests.sum() < TIMES.size - 1
    assert np.ptp(motion.theta[rests]) == 0
    assert not motion.psi_rate[rests].any()
    assert motion.psi_rate[~rests].all()
    found = TOP.quantities(["theta_end", "t_stuck"], t_end=2)
    assert found == pytest.approx({"theta_end": motion.theta[-1], "t_stuck": T_STUCK}, rel=1e-9)


def test_times_between_steps() -> None:
    """Of a top at rest, too, a method of fixed steps has the times of its steps only."""
    with pytest.raises(spintop.InputError, match="bad_samples"):
        TOP.integrate([0.0, 1.2345, 2.0], method="rk4", steps=1000)
    motion = TOP.integrate([0.0, 1.5, 2.0], method="rk4", steps=1000)
    assert motion.theta[1] == motion.theta[2]


@each("keys, good", *ENDS)
def test_events(keys: dict, good: bool) -> None:
    """The events of a motion that comes to rest are a good result, which says when that was."""
    found = TOP.events(["stuck"], 2.0, **keys)
    assert found.ok is good
    if good:
        assert found.summary.startswith("at_rest")
        assert float(re.search(r"t = *(\S+) s", found.summary)[1]) == found.events["t"][0]


@each("keys, good", *ENDS)
def test_run(keys: dict, good: bool) -> None:
    """A run in memory succeeds if the program does."""
    groups = TOP.input(span=SPAN, integration=keys, output={"columns": MOVING})
    result = spintop.run(groups)
    assert result.ok is good
    assert (result.rows.row_count == 101) is good


@each("keys, good", *ENDS)
def test_sweep(keys: dict, good: bool) -> None:
    """So does a sweep over arrays, and one with statistics."""
    found = spintop.sweep(a_sweep(keys), {"initial.psi_rate": SPINS})
    assert found.ok is good
    assert np.isfinite(found["t_stuck"]).tolist() == [True, True, good]
    axis = {"sweep": {"parameter": "initial.psi_rate", "values(1, :)": SPINS.tolist()}}
    statistics = {"statistics": {"columns": ["t_stuck"]}}
    result = spintop.run(a_sweep(keys) | axis | statistics)
    assert result.ok is good
    assert result.statistics["t_stuck_count"][0] == (3 if good else 2)


def test_fit() -> None:
    """A fit to a motion that comes to rest finds its friction."""
    motion = TOP.integrate(TIMES, MOVING)
    given = TOP.input(span={"t_end": 2.0}) | {"effects": {"friction_torque": 8.7}}
    data = {name: motion[name] for name in MOVING}
    result = spintop.fit(data, "effects.friction_torque", given)
    assert result.ok
    assert result["estimate"][0] == pytest.approx(9.0, rel=1e-6)


def test_flag() -> None:
    """Tables are judged by the flag, whatever follows the name of a status."""
    listed = spintop.registry("statuses")["statuses"]
    assert ends.good_ends() == {status["name"] for status in listed if status["good"]}
    assert ends.is_good_end("at_rest at t = 1.5")
    for status in ("step_limit at t = 1.5", "not_identifiable: the data", "okay", ""):
        assert not ends.is_good_end(status)


@each("keys, good", *ENDS)
def test_tables(folder: Path, keys: dict, good: bool) -> None:
    """Figures and the report take rest for a good end: no row is dropped, none is crossed."""
    trajectory = TOP.input(span=SPAN, integration=keys, output={"columns": MOVING})
    axis = {"sweep": {"parameter": "initial.psi_rate", "values(1, :)": SPINS.tolist()}}
    spintop.run(trajectory | {"study": {"title": "one"}}, folder=folder)
    spintop.run(a_sweep(keys) | axis, folder=folder)
    many = spintop.read(folder / "many.csv")
    assert len(succeeded(many)) == (3 if good else 2)
    assert tell_failed(many) == ("" if good else " (crossed: 1 too many steps)")
    sections, problems = read_study(folder)
    assert (len(sections), problems) == (2, [])
    for section in sections:
        assert section.failed is not good
        assert (warning_of(section.table) == "") is (good or section.table.status is None)


def test_film(folder: Path) -> None:
    """A film shows the motion up to its rest and on."""
    scene = folder / "scene.nml"
    scene.write_text(spintop.inputs.namelist(TOP.input(span=SPAN)), encoding="utf-8")
    quick = ("--seconds", "0.5", "--rate", "10", "--size", "160x90")
    told = called(film.main, "film", scene, "-o", folder / "film.gif", *quick)
    assert told == (0, told[1], "")
    assert (folder / "film.gif").stat().st_size > 0
