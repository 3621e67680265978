"""Sobol' indices of sweeps: known ones, the same bytes, hostile input, the figure."""

import re

import numpy as np

from conftest import each, needs_netcdf
from spintop_figures.registry import FIGURES
from spintop_figures.sweeps.statistics import rows_beside
from spintop_figures.tables.table import read_table

# Released at rest, so that maximum inclination and period of precession have formulas.
KNOWN = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&span t_end = 1 /
&sweep combine = 'saltelli'  cases = 10240  seed = 5
       parameter(1) = 'initial.theta_deg'  from(1) = 20  to(1) = 60
       parameter(2) = 'initial.psi_rate'  from(2) = 10  to(2) = 40
       parameter(3) = 'top.gravity'  from(3) = 5  to(3) = 15 /
&output columns = 'theta_max', 'precession_period' /
&statistics columns = 'theta_max', 'precession_period', 'initial.psi_rate', 'status'
            indices = 'sobol' /
"""
FACTORS = ("initial.theta_deg", "initial.psi_rate", "top.gravity")
# Cases that fail (at a pole), and cases without a period.
FAILING = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial psi_rate = 8 /
&span t_end = 0.5 /
&integration formulation = 'lagrange', method = 'rk4', steps = 20 /
&sweep combine = 'saltelli'  cases = 400
       parameter(1) = 'initial.phi_rate'  values(1,:) = 1, -1, 0, 2
       parameter(2) = 'initial.theta_deg'  values(2,:) = 0, 5, 10, 20, 30, 40
       parameter(3) = 'top.gravity'  values(3,:) = 0, 2, 5, 9.81 /
&output columns = 'theta_max', 'precession_period', 'theta_end', 'motion_class' /
&statistics columns = 'theta_max', 'precession_period', 'theta_end', 'motion_class'
            indices = 'sobol'  over = 'initial.phi_rate' /
"""
VECTOR = """\
&study kind = 'sweep' /
&top mass = 0.5, inertia = 1.5e-3, 1.5e-3, 5.0e-4, length = 0.04 /
&span t_end = 0.1 /
&sweep combine = 'saltelli'  cases = 64
       parameter(1) = 'initial.quaternion'  distribution(1) = 'sphere'
       parameter(2) = 'initial.omega3'  from(2) = 80  to(2) = 120 /
&output rows = 'none' /
&statistics columns = 'theta_end'  indices = 'sobol' /
"""
PARTS = 16
STUDENT = 2.131449545559323
RESULT = ("statistics.csv", "histogram.csv", "indices.csv")


def jansen(groups):
    """First-order and total index of each factor from rows of A, B and the others."""
    a, b, others = groups[:, :1], groups[:, 1:2], groups[:, 2:]
    variance = np.var(groups[:, :2])
    first = 1 - np.mean((b - others) ** 2, axis=0) / (2 * variance)
    return np.array([first, np.mean((a - others) ** 2, axis=0) / (2 * variance)])


def with_errors(groups):
    """The indices of groups that all have values, and half the widths of their intervals."""
    part = np.arange(len(groups)) // -(-len(groups) // PARTS)
    used = np.unique(part)
    without = np.array([jansen(groups[part != left]) for left in used])
    spread = ((without - without.mean(axis=0)) ** 2).sum(axis=0)
    return jansen(groups), STUDENT * np.sqrt(spread * (len(used) - 1) / len(used))


def by_quadrature(function, ends):
    """The indices of a smooth function of independent uniform factors, by Gauss' quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    points = [low + (high - low) * (nodes + 1) / 2 for low, high in ends]
    values = function(*np.meshgrid(*points, indexing="ij"))
    share = weights / 2

    def mean(cells, axes):
        for axis in sorted(axes, reverse=True):
            cells = np.tensordot(cells, share, axes=(axis, 0))
        return cells

    every = set(range(len(ends)))
    middle = mean(values, every)
    variance = mean((values - middle) ** 2, every)
    found = np.empty((2, len(ends)))
    for factor in every:
        others = every - {factor}
        found[0, factor] = share @ (mean(values, others) - middle) ** 2
        alone = mean(values, {factor})
        spread = mean(values**2, {factor}) - alone**2
        found[1, factor] = mean(spread, set(range(len(ends) - 1)))
    return found / variance


def theta_max(theta_deg, psi_rate, gravity):
    start = np.cos(np.radians(theta_deg))
    half = (0.25 * psi_rate) ** 2 / (4 * 0.875 * gravity * 0.85)
    return np.arccos(half - np.sqrt(half**2 - 2 * half * start + 1))


def precession_period(_, psi_rate, gravity):
    return 2 * np.pi * 0.25 * psi_rate / (gravity * 0.85)


def compute(spin, text, *options):
    return spin(text, *options, code=(0, 3))


def results(spin, folder, name="scene"):
    return [(spin.folder / folder / f"{name}.{ending}").read_bytes() for ending in RESULT]


def found(run, column):
    rows = run.table("indices")
    rows = rows[rows.iloc[:, 0] == column]
    return list(rows.iloc[:, 1]), rows.iloc[:, 2:].to_numpy(dtype=float)


def test_formulas(spin):
    """Those of quadrature lie in the intervals, or within a few thousandths."""
    run = compute(spin, KNOWN)
    for name, function in (("theta_max", theta_max), ("precession_period", precession_period)):
        expected = by_quadrature(function, [(20, 60), (10, 40), (5, 15)])
        factors, numbers = found(run, name)
        assert factors == list(FACTORS)
        for at, values in ((0, expected[0]), (3, expected[1])):
            np.testing.assert_allclose(numbers[:, at], values, rtol=1e-7, atol=0.01)
            assert (numbers[:, at + 1] <= values + 1e-9).all()
            assert (numbers[:, at + 2] >= values - 1e-9).all()
        assert (numbers[:, 2] - numbers[:, 1] < 0.15).all()
        assert (numbers[:, 6:8] == [2048, 0]).all()
    # A factor decides itself, and nothing else does.
    _, numbers = found(run, "initial.psi_rate")
    assert numbers[:, 3].tolist()[::2] == [0, 0]
    assert numbers[1, 0] == 1
    _, numbers = found(run, "precession_period")
    assert numbers[0, 3] == 0


def test_estimators_of_the_rows(spin):
    run = compute(spin, KNOWN)
    for name in ("theta_max", "precession_period"):
        expected, errors = with_errors(run.rows[name].to_numpy().reshape(-1, 5))
        _, numbers = found(run, name)
        for at, value, error in zip((0, 3), expected, errors, strict=True):
            for place, number in enumerate((value, value - error, value + error)):
                np.testing.assert_allclose(numbers[:, at + place], number, rtol=1e-7, atol=1e-12)


def test_groups_without_values(spin):
    """Those with a case that failed, or has no value, are counted apart and do not enter."""
    run = compute(spin, FAILING)
    rows, some = run.rows, set()
    for name in ("theta_max", "precession_period", "theta_end"):
        values = rows[name].where(rows.status == "ok").to_numpy().reshape(-1, 5)
        whole = np.isfinite(values).all(axis=1)
        _, numbers = found(run, name)
        assert (numbers[:, 6:8] == [whole.sum(), (~whole).sum()]).all()
        some.add(int((~whole).sum()))
        np.testing.assert_allclose(numbers[:, [0, 3]].T, jansen(values[whole]), atol=1e-12)
    assert len(some) > 1
    assert 0 < min(some) <= max(some) < 80


def test_vector(spin):
    factors, numbers = found(compute(spin, VECTOR), "theta_end")
    assert factors == ["initial.quaternion", "initial.omega3"]
    assert (numbers[:, 6] == 16).all()


def test_nothing_varies(spin):
    """A column that does not vary has no indices; a single group has no intervals."""
    text = VECTOR.replace("'theta_end'", "'evaluations', 'theta_end'")
    run = compute(spin, text.replace("cases = 64", "cases = 4"))
    assert np.isnan(found(run, "evaluations")[1][:, :6]).all()
    _, numbers = found(run, "theta_end")
    assert np.isfinite(numbers[:, [0, 3]]).all()
    assert np.isnan(numbers[:, [1, 2, 4, 5]]).all()


@needs_netcdf
def test_netcdf(spin):
    compute(spin, FAILING, "output.format=netcdf")
    path = compute(spin, FAILING).path
    one, other = (
        rows_beside(read_table(path.with_name(f"scene.statistics.{kind}")), "indices")
        for kind in ("nc", "csv")
    )
    assert list(one) == list(other)
    for name in one:
        assert one[name].tolist() == other[name].tolist(), name


AXIS = "parameter = 'initial.psi_rate', from = 1, to = 100, count = 1000"
ONE_AXIS = re.sub("&sweep[^/]*/", f"&initial theta_deg = 20 /\n&sweep {AXIS} /", KNOWN)
COLUMNS = "columns = 'theta_max', 'precession_period', 'initial.psi_rate', 'status'"
SALTELLI = "Sobol' indices need the cases of Saltelli's design", "sweep.combine = 'saltelli'"
SINGLE = KNOWN.replace(KNOWN[KNOWN.index("&sweep") : KNOWN.index("&output")], "")
SINGLE = SINGLE[: SINGLE.index("&output")].replace("'sweep'", "'trajectory'")


@each(
    "text, words",
    *(
        (KNOWN.replace("'saltelli'", f"'{other}'"), [*SALTELLI, "a multiple of 5"])
        for other in ("random", "sobol", "latin_hypercube")
    ),
    (ONE_AXIS, ["a multiple of 3"]),
    (KNOWN.replace("cases = 10240", "cases = 10241"), ["groups of 5 cases"]),
    (VECTOR.replace("'saltelli'", "'random'"), ["a multiple of 4"]),
    (KNOWN.replace(COLUMNS, "columns = 'status'"), ["no column of numbers"]),
    (KNOWN.replace(COLUMNS, ""), ["there are no columns of which statistics"]),
    (KNOWN.replace("indices = 'sobol'", "indices = 'morris'"), ["one of: sobol"]),
    (SINGLE + "&statistics indices = 'sobol' /\n", ["a trajectory has no statistics"]),
)
def test_refusals(spin, text, words):
    assert text not in (KNOWN, VECTOR)
    error = spin.refuse(text)
    assert re.search(r"(?m)^\S*scene\.nml:\d+:\d+: error: ", error)
    for word in words:
        assert word in error


def test_check(spin):
    said = spin(KNOWN, "--check").out
    assert "Sobol' indices of 3 factors from 2048 groups of 5 cases" in said
    resolved = said[said.index("&study") :]
    assert "indices = 'sobol'" in resolved
    spin(resolved, "--check")


FIGURE = next(kind for kind in FIGURES if kind.name == "indices")


def test_dots(spin):
    """A dot for each index, with its interval, and the groups that were left out."""
    path = compute(spin, FAILING).path
    table = read_table(path.with_name("scene.statistics.csv"))
    assert FIGURE.refusal(table) == ""
    panels = FIGURE.draw(table).axes
    assert len(panels) == 3
    expected = rows_beside(table, "indices")
    for column, axes in zip(expected["column"].unique(), panels, strict=True):
        rows = expected[expected["column"] == column]
        for label, index in (("first order", "first_order"), ("total", "total")):
            (dots,) = [line for line in axes.lines if line.get_label() == label]
            np.testing.assert_array_equal(dots.get_xdata(), rows[index])
        assert "groups left out" in axes.get_title(loc="right")
    path.with_name("scene.indices.csv").unlink()
    assert "has no scene.indices.csv beside it" in FIGURE.refusal(table)


def test_other_statistics(spin):
    """Statistics without indices have no such figure, though an older table is there."""
    compute(spin, FAILING)
    path = compute(spin, FAILING.replace("indices = 'sobol'", "")).path
    table = read_table(path.with_name("scene.statistics.csv"))
    assert "has no Sobol' indices" in FIGURE.refusal(table)
