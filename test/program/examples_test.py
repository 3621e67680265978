"""The example programs: each is compiled with the library, and its numbers are right.

Motions are compared with those that the program integrates, by another method where the example has
the closed form, quantities of a nutation with those of its sweeps, and the others with formulas.
"""

import itertools
import math
import re

import numpy as np
import pytest

from conftest import EXE, ROOT, output

pytestmark = pytest.mark.skipif(
    EXE.parent.name == "sanitized", reason="programs would need the sanitizers, too"
)
EXTRA = "--coverage" if EXE.parent.name == "coverage" else ""

VARIANTS = {"find_monodromy", "prepare_conditioning", "steady_rates_at_spin"}
"""Procedures of the library without an example: an example shows another form of each."""
CHECKS = {"body_status", "start_status", "status_meaning"}
"""Procedures that check the arguments of the others, or describe their status."""

INERTIA = (0.875, 0.875, 0.25)
HEIGHT = math.sqrt(0.75)
GRAVITY = 9.81
MGL = GRAVITY * HEIGHT
"""The symmetric top of the examples, of mass 1 kg."""
TOP = f"mass = 1  inertia = 0.875, 0.875, 0.25  length = {HEIGHT!r}"
SKEW = "mass = 1  inertia = 0.9, {}, 0.25  centre_of_mass = 0.05, 0, 0.8  damping = 3*{}"
"""Their body without symmetry."""


@pytest.fixture
def rows_at(spin):
    """The rows of a motion at so many times up to an end, integrated by the program."""

    def rows(body, start, t, *columns, samples=2):
        text = f"&top {body} /\n&initial {start} /\n&span t_end = {t}  samples = {samples} /\n"
        text += "&integration method = 'dop853'  relative_tolerance = 1e-13 /\n"
        return spin(text + output("t", *columns)).rows

    return rows


@pytest.fixture
def nutations(spin):
    """The largest inclinations and the periods of the top that is released at rest, by spins."""

    def nutation(theta, spins):
        axis = f"&sweep parameter = 'initial.omega3'  values(1,:) = {', '.join(map(repr, spins))} /"
        text = f"&study kind = 'sweep' /\n&top {TOP} /\n&initial theta = {theta} /\n{axis}\n"
        rows = spin(f"{text}&span t_end = 1 /\n{output('theta_max', 'nutation_period')}").rows
        return zip(rows.theta_max, rows.nutation_period, strict=True)

    return nutation


@pytest.fixture
def example(spin):
    def run(name):
        command = (
            f". '{ROOT}/scripts/setup' && gfortran -std=f2008 -Wall -fopenmp"
            f" -I'{EXE.parent}/include' -J. '{ROOT}/example/{name}.f90'"
            f" '{EXE.parent}/lib/libspintop.a' $(all_link_flags) $(libraries_of_manifest)"
            f" {EXTRA} -o {name}"
            f" && ./{name}"
        )
        return spin.call(command=("bash", "-c", command)).out

    return run


@pytest.fixture
def rows_of(example):
    """The numbers of each line of an example that has `count` lines."""
    number = r"(?<![\w.^])-?\d+(?:\.\d*)?(?:E[+-]\d+)?(?![\w/.])"

    def rows(name, count):
        lines = example(name).splitlines()
        assert len(lines) == count, lines
        return [[float(text) for text in re.findall(number, line)] for line in lines]

    return rows


def assert_close(found, expected, slack):
    assert abs(found - expected) <= slack * max(1, abs(expected)), (found, expected)


def test_every_example_has_a_test():
    names = {path.stem for path in (ROOT / "example").glob("*.f90")}
    of = "test_of_"
    tested = {name.removeprefix(of) for name in globals() if name.startswith(of)}
    assert names == tested
    page = (ROOT / "doc/library.md").read_text(encoding="utf-8")
    named = page.partition("## Examples")[2].partition("## ")[0]
    assert set(re.findall(r"`(\w+)`", named)) - {"example"} == names


def test_every_procedure_has_an_example():
    source = (ROOT / "src/spintop.f90").read_text(encoding="utf-8").replace("&\n", "")
    lists = re.findall(r"^ *use \w+, only: *(.*)$", source, re.MULTILINE)
    names = {name.strip() for text in lists for name in text.split(",")}
    procedures = {
        name
        for name in names - VARIANTS - CHECKS
        if not re.search(r"_t$|^status_(?!name$)|^(dp|max_states|block_size)$", name)
    }
    text = "\n".join(path.read_text("utf-8") for path in (ROOT / "example").glob("*.f90"))
    missing = {name for name in procedures if not re.search(rf"\b{name}\(", text)}
    assert missing == set()


def test_of_exact_motion(rows_of, rows_at):
    for t, *angles in rows_of("exact_motion", 3):
        row = rows_at(TOP, "theta = 0.2  psi_rate = 1", t, "phi", "theta", "psi").iloc[1]
        assert list(np.cos(row[1:] - angles)) == pytest.approx([1] * 3, abs=1e-14)


def test_of_any_body(rows_of, rows_at):
    for t, theta in rows_of("any_body", 5)[:4]:
        rows = rows_at(SKEW.format(0.7, 0.01), "theta = 0.2  psi_rate = 5", t, "theta")
        assert_close(theta, rows.theta[1], 1e-8)


def test_of_many_bodies(rows_of, rows_at):
    """The inclinations of some of them, and the energy of all."""
    (completed,), *some, (change,) = rows_of("many_bodies", 6)
    assert completed == 1000
    assert [row[0] for row in some] == [0.7, 0.8, 0.9, 1.0]
    for inertia, _, theta in some:
        rows = rows_at(SKEW.format(inertia, 0), "theta = 0.2  psi_rate = 5", 2, "theta")
        assert_close(theta, rows.theta[1], 2e-9)
    assert change < 1e-11


def test_of_events(spin, example):
    text = f"&top {SKEW.format(0.7, 0.01)} /\n&span t_end = 4 /\n&initial theta = 0.5"
    text += "  theta_rate = 0.5  psi_rate = 20 /\n&output events = 'turning_points'"
    run = spin(text + "  columns = 't', 'theta', 'phi' /\n", "integration.method=dop853")
    expected = run.table("events")[:6]
    *lines, ending = example("events").splitlines()
    assert len(lines) == 6
    for line, row in zip(lines, expected.itertuples(), strict=True):
        found = re.fullmatch(r"(\w+) +point at +([\d.]+) s: theta = *([\d.]+)", line)
        assert {"lowest": "lower", "highest": "upper"}[found[1]] == row.event.split("_")[0]
        assert_close(float(found[2]), row.t, 1e-4)
        assert_close(float(found[3]), row.theta, 1e-8)
    assert re.search(rf"ok, ended at +{row.t:.4f} s: phi = +[\d.]+ rad", ending)
    assert_close(math.cos(float(ending.split()[-2]) - row.phi), 1, 1e-8)


def test_of_accuracy(rows_of):
    """The orders of two methods; the error of the third is near that of the data."""
    rk4, finer_rk4, six, finer_six, taylor, inherent = rows_of("accuracy", 6)
    assert math.log2(rk4[-1] / finer_rk4[-1]) == pytest.approx(4, abs=0.5)
    assert math.log2(six[-1] / finer_six[-1]) == pytest.approx(6, abs=0.5)
    assert taylor[-1] < 1e-11
    assert 1e-16 < inherent[0] < 1e-13


def test_of_nutation(example, rows_of, nutations):
    rows = rows_of("nutation", 4)
    expected = nutations(0.5, [row[0] for row in rows])
    for (_, theta, *found), row in zip(rows, expected, strict=True):
        assert theta == 0.5
        assert found == pytest.approx(row, rel=1e-9)
    classes = [line.split()[-1] for line in example("nutation").splitlines()]
    assert classes == ["libration", "cusp", "cusp", "cusp"]


def test_of_many_tops(rows_of, nutations):
    (count,), *rows = rows_of("many_tops", 9)
    assert count == 400
    for row, expected in zip(rows, nutations(0.5, [row[0] for row in rows]), strict=True):
        assert row[1:] == pytest.approx(expected, rel=1e-9)


def test_of_fast_top_formulas(rows_of, nutations):
    """Their errors decrease with the square of the spin."""
    errors = []
    rows = rows_of("fast_top_formulas", 5)
    periods = [period for _, period in nutations(0.5, [row[0] for row in rows])]
    for period, (omega3, rate, rate_about, precession, precession_about) in zip(
        periods, rows, strict=True
    ):
        assert_close(rate, 2 * math.pi / period, 1e-7)
        assert_close(rate_about, INERTIA[2] * omega3 / INERTIA[0], 1e-7)
        assert_close(precession_about, MGL / (INERTIA[2] * omega3), 1e-7)
        errors.append((rate_about / rate - 1, 1 - precession_about / precession))
    for one, next_one in itertools.pairwise(errors[1:]):
        for error, smaller in zip(one, next_one, strict=True):
            assert math.log2(error / smaller) == pytest.approx(2, abs=0.25)


def test_of_steady_precession(rows_of):
    """The rates, and the force that carries the weight and turns the centre of mass."""
    rows = rows_of("steady_precession", 2)
    for rate, theta, upwards, sideways in rows:
        balance = INERTIA[0] * 0.5 * rate**2 - INERTIA[2] * 40 * rate + MGL
        assert_close(balance, 0, 1e-7)
        assert_close(theta, math.pi / 3, 1e-9)
        assert_close(upwards, GRAVITY, 1e-8)
        assert_close(sideways, HEIGHT * math.sin(theta) * rate**2, 1e-8)
    assert rows[0][0] < rows[1][0]


def test_of_permanent_rotation(rows_of):
    """The weight turns the momentum; nearly at rest upright it falls, hanging it stays."""
    rows = rows_of("permanent_rotation", 4)
    arm, moments = (0.1, 0.2, 0.5), (0.9, 0.7, 0.4)
    for x, y, z, rate, same_rate, growth in rows:
        up = (x, y, z)
        assert_close(math.hypot(*up), 1, 2e-6)
        assert_close(rate, same_rate, 1e-9)
        momentum = [rate**2 * inertia * part for inertia, part in zip(moments, up, strict=True)]
        rest = [one - GRAVITY * other for one, other in zip(momentum, arm, strict=True)]
        along = sum(one * part for one, part in zip(rest, up, strict=True))
        for one, part in zip(rest, up, strict=True):
            assert_close(one, along * part, 1e-4)
        assert growth > -1e-6
    assert rows[0][-1] > 1
    assert rows[-1][-1] < 1e-6


def test_of_energy_and_force(rows_of, rows_at, nutations):
    """Both momenta, the energy, and the force at rest, at the bottom and between."""
    _, *rows, (lowest, highest) = rows_of("energy_and_force", 7)
    ((_, period),) = nutations(0.2, [1.0])
    columns = ("energy", "lz", "l3", "force_z")
    start = "theta = 0.2  psi_rate = 1"
    expected = rows_at(TOP, start, period, *columns, samples=5).to_numpy()
    for (t, *found, residual), row in zip(rows, expected, strict=True):
        assert t == pytest.approx(row[0], abs=6e-4)
        assert found == pytest.approx(row[1:], rel=1e-9)
        assert residual < 1e-13
    force = rows_at(TOP, start, period, "force_z", samples=100001).force_z
    assert [lowest, highest] == pytest.approx([force.min(), force.max()], rel=1e-7)


def test_of_stability(rows_of):
    (threshold,), below, at, above = rows_of("stability", 4)
    assert_close(threshold, 2 * math.sqrt(MGL * INERTIA[0]) / INERTIA[2], 1e-9)
    half_rate = INERTIA[2] * 0.8 * threshold / (2 * INERTIA[0])
    assert_close(below[1], math.sqrt(MGL / INERTIA[0] - half_rate**2), 1e-8)
    assert at[1] < 1e-6
    assert above[1] == 0


def test_of_floquet(rows_of):
    """Rotation about the intermediate axis is unstable, with a rate from Euler's equations."""
    growth = [factor for _, factor in rows_of("floquet", 3)]
    assert_close(growth[0], 1, 1e-6)
    assert_close(growth[1], math.exp(2 * math.pi / math.sqrt(3)), 1e-9)
    assert_close(growth[2], 1, 1e-6)


def test_of_lyapunov(rows_of):
    """Only chaos grows without end."""
    chaotic, damped, regular = ([row[0], row[2]] for row in rows_of("lyapunov", 3))
    assert damped[0] < 0
    assert chaotic[0] > 2 * regular[0]
    assert math.log(chaotic[1]) / 200 == pytest.approx(chaotic[0], abs=0.2 * chaotic[0])
    assert regular[1] < 1e5


def test_of_sensitivity(rows_of, rows_at):
    """The derivative with respect to the spin, against differences of two kinds."""
    step, ends = 1e-3, []
    for omega3 in (5 - step, 5 + step):
        columns = [f"{name}{i}" for name in ("gamma", "omega") for i in (1, 2, 3)]
        rows = rows_at(SKEW.format(0.7, 0), f"theta = 0.2  psi_rate = {omega3!r}", 2, *columns)
        ends.append(rows.iloc[1, 1:].to_numpy() * [1, 1, 1, 0.9, 0.7, 0.25])
    for row, less, more in zip(rows_of("sensitivity", 6), *ends, strict=True):
        _, derivative, quotient = row
        assert_close(derivative, quotient, 1e-6)
        assert_close(derivative, (more - less) / (2 * step), 2e-5)


def test_of_methods(spin, example):
    expected = {entry["name"]: entry["formulations"] for entry in spin.listed("methods")}
    del expected["exact"]  # it has no steps
    lines = example("methods").splitlines()
    found = {name: names.split() for name, _, names in (line.partition(":") for line in lines)}
    assert found == expected


def test_of_own_method(example):
    """Each converges with its order."""
    found = re.findall(r"(\w+), steps (\d+): +(\S+) rad", example("own_method"))
    errors = {(name, steps): float(error) for name, steps, error in found}
    for name, order in (("heun", 2), ("heun_3", 3), ("ralston", 2)):
        slope = math.log2(errors[name, "400"] / errors[name, "800"])
        assert slope == pytest.approx(order, abs=0.1), name


def test_of_sweep(rows_of, nutations):
    unit = math.sqrt(4 * MGL / INERTIA[2])
    rows = rows_of("sweep", 4)
    assert [ratio for ratio, _ in rows] == [0.5, 1, 2, 4]
    expected = nutations(math.pi / 6, [ratio * unit for ratio, _ in rows])
    for (_, theta_max), (known, _) in zip(rows, expected, strict=True):
        assert_close(theta_max, known, 1e-7)
