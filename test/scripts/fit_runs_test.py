"""Fits of several runs of one body: what is common and what each run has, and what is refused."""

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop
from conftest import each
from drawn_fits import WHEEL, draw_runs
from spintop_figures.registry import choose_figures

EACH = ("initial.omega3", "offset.omega3")
TOP = {"mass": 0.2, "inertia": (2e-4, 2e-4, 3e-4), "length": 0.0, "damping": (0, 0, 2e-5)}
TRUE = 3e-5
SPINS, OFFSETS = (60.0, 150.0, 300.0), (0.4, -0.3, 0.1)


def spin_downs(noise: float = 0.05) -> list[dict[str, np.ndarray]]:
    """Three spin-downs by a tachometer, with times of their own."""
    source, runs = np.random.default_rng(7), []
    for spin, offset, t_end in zip(SPINS, OFFSETS, (40.0, 60.0, 50.0), strict=True):
        t = np.linspace(0, t_end, int(2 * t_end))
        readings = spin * np.exp(-TRUE / 3e-4 * t) + offset
        runs.append({"t": t, "omega3": readings + source.normal(0, noise, t.size)})
    return runs


def fit(data: list[dict], unknown="top.damping(3)", unknown_each=EACH, **options):
    given = {"top": TOP, "initial": {"theta": 0.5, "omega3": 120.0}} | options.pop("more", {})
    return spintop.fit(data, unknown, given, unknown_each=unknown_each, **options)


@each("number", *range(6))
def test_drawn_runs(number: int) -> None:
    """The truth is within 4.5 standard errors, and the intervals contain the estimates."""
    case = draw_runs(number, seed=2, runs=2 + number % 3)
    result = case.fit()
    assert result.ok, result.summary
    rows = result.rows
    assert list(rows["parameter"]) == list(case.truth)
    away = np.abs(rows["estimate"] - np.array(list(case.truth.values()))) / rows["standard_error"]
    assert away.max() < 4.5
    assert np.all((rows["lower"] < rows["estimate"]) & (rows["estimate"] < rows["upper"]))
    for run, data in enumerate(case.data, 1):
        left = result.tables[f"residuals{run if run > 1 else ''}"]
        assert np.array_equal(left["t"], data["t"])
        assert {f"{name}_residual" for name in data if name != "t"} <= {*left}


@each("sigma", None, 0.05)
def test_spins_that_differ(sigma: float | None) -> None:
    """Where readings tell the spins, they are found from one start; the damping by all runs."""
    result = fit(spin_downs(), sigma=sigma)
    assert result.ok, result.summary
    rows = result.rows
    names = [f"{name}[{run}]" for run in (1, 2, 3) for name in EACH]
    assert list(rows["parameter"]) == ["top.damping(3)", *names]
    truth = np.array([TRUE, *np.transpose([SPINS, OFFSETS]).ravel()])
    assert np.all(np.abs(rows["estimate"] - truth) < 4 * rows["standard_error"])
    alone = fit(spin_downs()[:1], sigma=sigma).rows
    assert list(alone["parameter"]) == ["top.damping(3)", *names[:2]]
    assert alone["standard_error"][0] > 2 * rows["standard_error"][0]
    # Runs that have nothing in common have the fits of their own.
    apart = fit(spin_downs(), (), ("initial.omega3",), sigma=0.05).rows
    for run, data in enumerate(spin_downs()):
        own = fit([data], (), ("initial.omega3",), sigma=0.05).rows
        for name in ("estimate", "standard_error", "lower", "upper"):
            assert own[name][0] == pytest.approx(apart[name][run], rel=1e-8)


def test_one_run_is_a_list_of_one() -> None:
    data = spin_downs()[0]
    unknown = ("top.damping(3)", *EACH)
    one, listed = (fit(each, unknown, ()).rows for each in (data, [data]))
    assert all(np.array_equal(one[name], listed[name]) for name in one)


def test_turns_need_a_start_of_each_run() -> None:
    """Angles over many turns: the values of the runs lead to them, given in their units."""
    source, runs, spins = np.random.default_rng(3), [], (50.0, 90.0, 170.0)
    t, start = np.linspace(0, 3, 301), {"theta": 1.0, "omega3": 90.0}
    for spin in spins:
        top = spintop.Top(spintop.Body(**WHEEL), theta=1.0, omega3=spin)
        motion = top.exact(t, ["phi", "theta"])
        runs.append({"t": t})
        for name in ("phi", "theta"):
            runs[-1][name] = motion[name] + source.normal(0, 2e-3, t.size)
    given = {"top": WHEEL | {"inertia": (4.04e-4, 4.04e-4, 3e-4)}, "initial": start}
    starts = {"initial.omega3": [51.0, 89.0, 172.0]}
    result = spintop.fit(runs, "top.inertia(1)", given, unknown_each=starts)
    assert result.ok, result.summary
    found, error = result.rows["estimate"], result.rows["standard_error"]
    assert np.all(np.abs(found - [4e-4, *spins]) < 4 * error)
    assert list(result.rows["start"]) == [4.04e-4, *starts["initial.omega3"]]


@each("sigma", None, 0.05)
def test_one_poor_run_is_named(sigma: float | None) -> None:
    runs = spin_downs()
    runs[1]["omega3"] += 0.3 * np.sin(runs[1]["t"])
    result = fit(runs, sigma=sigma)
    assert not result.ok
    reason = result.summary.split("poor_fit: ")[1]
    assert "run 2, measured2.csv" in reason
    assert "run 1" not in reason and "run 3" not in reason


@each(
    "change, message",
    ({"unknown_each": "top.mass"}, "top.mass is one number for all runs"),
    ({"unknown_each": "scale.omega3"}, "scale.omega3 is one number for all runs"),
    ({"unknown_each": ("initial.omega3", "initial.omega3")}, "named twice"),
    ({"unknown": "initial.omega3"}, "named twice"),
    ({"unknown_each": {"initial.omega3": [60.0, 150.0]}}, "2 values of start_each for 3 runs"),
    ({"unknown_each": {"initial.theta": [0.5, 0.5, 4.0]}}, r"initial.theta must be in \[0, pi\]"),
    ({"unknown_each": "offset.omega1"}, "omega1 is not measured"),
    ({"sigma": [{"omega3": 1.0}]}, "1 for 3 runs"),
    ({"more": {"fit": {"start_each": [[1.0]]}}}, "start_each"),
    ({"unknown": (), "unknown_each": ()}, "nothing is sought"),
)
def test_refusals(change: dict, message: str) -> None:
    with pytest.raises(spintop.InputError, match=message):
        fit(spin_downs(), **change)


def test_tables_that_are_refused() -> None:
    """Each with the number of its run; more than 32 are too many."""
    runs = spin_downs()
    runs[2]["t"] = runs[2]["t"][::-1]
    with pytest.raises(spintop.InputError, match=r"run 3, measured3.csv: .*do not increase"):
        fit(runs)
    with pytest.raises(spintop.InputError, match="omega2 is not measured in run 1"):
        fit([spin_downs()[0], runs[1] | {"omega2": runs[1]["t"]}], (), "offset.omega2")
    with pytest.raises(spintop.InputError, match="32"):
        fit(spin_downs()[:1] * 33)
    for wrong in (5, "ab", [1, 2]):
        with pytest.raises(spintop.InputError, match="names with their values"):
            fit(wrong)


def test_figures_of_runs() -> None:
    """A figure for each run, with what is common and its own numbers."""
    result = fit(spin_downs())
    tables = [table for name, table in result._drawn.items() if name != "rows"]
    for run, table in enumerate(tables, 1):
        (kind,) = choose_figures(table)[0]
        figure = kind.draw(table)
        assert f"run {run}: " in figure.get_suptitle()
        told = [text.get_text() for text in figure.axes[-1].texts]
        assert sum("95 %" in line for line in told) == 3
