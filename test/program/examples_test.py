"""The example programs: each is compiled with the library, and its numbers are those of mechanics.

The motions that they print are compared with a Runge-Kutta method that is written here, the
quantities of a nutation with the roots of its cubic and an arithmetic-geometric mean, and the
others with their formulas. Nothing is compared with earlier output.
"""

import itertools
import math
import re
import tomllib

import numpy as np
import pytest

from conftest import EXE, ROOT
from mechanics import runge_kutta

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
SKEW = (0.9, 0.7, 0.25)
SKEW_ARM = (0.05, 0.0, 0.8)
"""Their body without symmetry."""


class Body:
    """A rigid body of 1 kg with a fixed point, as Euler's equations for a quaternion and omega."""

    def __init__(self, inertia, arm, damping=0.0):
        self.inertia, self.arm, self.damping = inertia, arm, damping

    def rate(self, _, y):
        """Derivative of the state (q, omega)."""
        q0, q1, q2, q3, w1, w2, w3 = y = y.tolist()
        a, b, c = self.inertia
        x, y_, z = (GRAVITY * r for r in self.arm)
        up = vertical(y)
        d = self.damping
        return np.array(
            (
                (-q1 * w1 - q2 * w2 - q3 * w3) / 2,
                (q0 * w1 + q2 * w3 - q3 * w2) / 2,
                (q0 * w2 + q3 * w1 - q1 * w3) / 2,
                (q0 * w3 + q1 * w2 - q2 * w1) / 2,
                ((b - c) * w2 * w3 + up[1] * z - up[2] * y_ - d * w1) / a,
                ((c - a) * w3 * w1 + up[2] * x - up[0] * z - d * w2) / b,
                ((a - b) * w1 * w2 + up[0] * y_ - up[1] * x - d * w3) / c,
            )
        )

    def carry(self, y, t, steps):
        """The state after t seconds, by the classical Runge-Kutta method."""
        return runge_kutta(self.rate, y, t, steps)


def quaternion(phi, theta, psi):
    """The attitude with these Euler angles."""
    c, s = math.cos(theta / 2), math.sin(theta / 2)
    plus_, minus = (phi + psi) / 2, (phi - psi) / 2
    return (c * math.cos(plus_), s * math.cos(minus), s * math.sin(minus), c * math.sin(plus_))


def start(theta, theta_rate, psi_rate):
    """The state at phi = psi = phi' = 0."""
    return (*quaternion(0, theta, 0), theta_rate, 0.0, psi_rate)


def vertical(y):
    """The upward vertical in body axes."""
    q0, q1, q2, q3 = y[:4]
    return (2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), q0**2 - q1**2 - q2**2 + q3**2)


def inclination(y):
    """The angle theta of a state."""
    return 2 * math.atan2(math.hypot(y[1], y[2]), math.hypot(y[0], y[3]))


def height_rate(y):
    """The derivative of cos(theta)."""
    up = vertical(y)
    return up[0] * y[5] - up[1] * y[4]


class Nutation:
    """The nutation of the symmetric top that is released at rest, from the roots of its cubic.

    With u = cos(theta), a = I3 omega3/I1 and b = 2 m g l/I1 it is
    u'^2 = (u0 - u) (b (1 - u^2) - a^2 (u0 - u)), with the roots u1 < u0 < u3.
    """

    def __init__(self, theta, omega3):
        self.u0 = math.cos(theta)
        self.b = 2 * MGL / INERTIA[0]
        self.a = INERTIA[2] * omega3 / INERTIA[0]
        root = math.sqrt(self.a**4 - 4 * self.b * (self.a**2 * self.u0 - self.b))
        u3 = (self.a**2 + root) / (2 * self.b)
        self.u1 = (self.a**2 * self.u0 / self.b - 1) / u3  # the product of the two roots is known
        self.theta_max = math.acos(max(-1.0, self.u1))
        x, y = 1.0, math.sqrt((u3 - self.u0) / (u3 - self.u1))
        while abs(x - y) > 1e-15:
            x, y = (x + y) / 2, math.sqrt(x * y)
        self.period = 2 * math.pi / (x * math.sqrt(self.b * (u3 - self.u1)))

    def upward_force(self, u):
        """The vertical force, m (g + l u''); u'' is half the derivative of u'^2 by u."""
        down, kept = self.u0 - u, self.b * (1 - u * u) - self.a**2 * (self.u0 - u)
        return GRAVITY + HEIGHT * (-kept + down * (self.a**2 - 2 * self.b * u)) / 2


@pytest.fixture
def example(spin):
    """Compiles an example, and runs it: what it prints."""
    manifest = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))
    libraries = " ".join("-l" + library for library in manifest["build"]["link"])

    def run(name):
        command = (
            f". '{ROOT}/.venv/bin/activate' && gfortran -std=f2008 -Wall -fopenmp"
            f" -I'{EXE.parent}/include' -J. '{ROOT}/example/{name}.f90'"
            f" '{EXE.parent}/lib/libspintop.a' $FPM_LDFLAGS {libraries} {EXTRA} -o {name}"
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
    """Two numbers agree to `slack`, relative to 1 or to their magnitude."""
    assert abs(found - expected) <= slack * max(1, abs(expected)), (found, expected)


def test_every_example_has_a_test():
    """Each example has a test, and the manual names it."""
    names = {path.stem for path in (ROOT / "example").glob("*.f90")}
    of = "test_of_"
    tested = {name.removeprefix(of) for name in globals() if name.startswith(of)}
    assert names == tested
    page = (ROOT / "doc/library.md").read_text(encoding="utf-8")
    named = page.partition("## Examples")[2].partition("## ")[0]
    assert set(re.findall(r"`(\w+)`", named)) - {"example"} == names


def test_every_procedure_has_an_example():
    """Procedures that `use spintop` gives."""
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


def test_of_exact_motion(rows_of):
    """The attitude at three instants."""
    body, state, before = Body(INERTIA, (0, 0, HEIGHT)), start(0.2, 0, 1), 0.0
    for t, *angles in rows_of("exact_motion", 3):
        state, before = body.carry(state, t - before, 3000), t
        attitude = quaternion(*angles)  # or with all signs reversed
        error = min(math.dist(attitude, state[:4]), math.dist(attitude, [-q for q in state[:4]]))
        assert error < 1e-8


def test_of_any_body(rows_of):
    """The inclination of a damped body without symmetry."""
    body, state, before = Body(SKEW, SKEW_ARM, 0.01), start(0.2, 0, 5), 0.0
    for t, theta in rows_of("any_body", 5)[:4]:
        state, before = body.carry(state, t - before, 1000), t
        assert_close(theta, inclination(state), 1e-8)


def test_of_many_bodies(rows_of):
    """The inclinations of some of them, and the energy of all."""
    (completed,), *some, (change,) = rows_of("many_bodies", 6)
    assert completed == 1000
    assert [row[0] for row in some] == [0.7, 0.8, 0.9, 1.0]
    for inertia, _, theta in some:
        state = Body((0.9, inertia, 0.25), SKEW_ARM).carry(start(0.2, 0, 5), 2, 4000)
        assert_close(theta, inclination(state), 2e-9)
    assert change < 1e-11


def test_of_events(example):
    """The first six turning points of a damped body, and no other."""
    body, state, before, expected = Body(SKEW, SKEW_ARM, 0.01), start(0.5, 0.5, 20), 0.0, []
    steps, span = 4000, 4.0
    for i in range(steps):
        ahead = body.carry(state, span / steps, 1)
        if height_rate(state) * height_rate(ahead) < 0:
            kind = "lowest" if height_rate(ahead) > 0 else "highest"
            expected.append((i * span / steps, kind))
        state = ahead
    *lines, ending = example("events").splitlines()
    assert len(lines) == 6
    state = start(0.5, 0.5, 20)
    for line, (about, kind) in zip(lines, expected, strict=False):
        found = re.fullmatch(r"(\w+) +point at +([\d.]+) s: theta = *([\d.]+)", line)
        t, theta = float(found[2]), float(found[3])
        assert found[1] == kind
        assert about <= t <= about + span / steps, line
        state, before = body.carry(state, t - before, 1500), t
        assert_close(height_rate(state), 0, 1e-8)
        assert_close(theta, inclination(state), 1e-9)
    assert re.search(rf"ok, ended at +{before:.4f} s: phi = +[\d.]+ rad", ending)
    phi = math.atan2(state[3], state[0]) + math.atan2(state[2], state[1])
    assert_close(math.cos(float(ending.split()[-2]) - phi), 1, 1e-8)


def test_of_accuracy(rows_of):
    """The orders of two methods; the error of the third is near that of the data."""
    rk4, finer_rk4, six, finer_six, taylor, inherent = rows_of("accuracy", 6)
    assert math.log2(rk4[-1] / finer_rk4[-1]) == pytest.approx(4, abs=0.5)
    assert math.log2(six[-1] / finer_six[-1]) == pytest.approx(6, abs=0.5)
    assert taylor[-1] < 1e-11
    assert 1e-16 < inherent[0] < 1e-13


def test_of_nutation(example, rows_of):
    """Range and period of the nutation of a top released at rest."""
    for omega3, theta, theta_max, period in rows_of("nutation", 4):
        expected = Nutation(0.5, omega3)
        assert theta == 0.5
        assert_close(theta_max, expected.theta_max, 1e-9)
        assert_close(period, expected.period, 1e-9)
    classes = [line.split()[-1] for line in example("nutation").splitlines()]
    assert classes == ["libration", "cusp", "cusp", "cusp"]


def test_of_many_tops(rows_of):
    """The same for many tops together."""
    (count,), *rows = rows_of("many_tops", 9)
    assert count == 400
    for omega3, theta_max, period in rows:
        expected = Nutation(0.5, omega3)
        assert_close(theta_max, expected.theta_max, 1e-9)
        assert_close(period, expected.period, 1e-9)


def test_of_fast_top_formulas(rows_of):
    """Their errors decrease with the square of the spin."""
    errors = []
    rows = rows_of("fast_top_formulas", 5)
    for omega3, rate, rate_about, precession, precession_about in rows:
        assert_close(rate, 2 * math.pi / Nutation(0.5, omega3).period, 1e-7)
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


def test_of_energy_and_force(rows_of):
    """Both momenta, the energy, and the force at rest, at the bottom and between."""
    _, *rows, (lowest, highest) = rows_of("energy_and_force", 7)
    nutation = Nutation(0.2, 1)
    forces = []
    for i, (t, energy, about_vertical, about_axis, force, residual) in enumerate(rows):
        assert t == pytest.approx(i * nutation.period / 4, abs=6e-4)
        assert_close(energy, 0.5 * INERTIA[2] + MGL * math.cos(0.2), 1e-9)
        assert_close(about_vertical, INERTIA[2] * math.cos(0.2), 1e-9)
        assert_close(about_axis, INERTIA[2], 1e-9)
        assert residual < 1e-13
        forces.append(force)
    at_rest, at_bottom = nutation.upward_force(nutation.u0), nutation.upward_force(nutation.u1)
    for force, expected in zip(forces[::2], (at_rest, at_bottom, at_rest), strict=True):
        assert_close(force, expected, 1e-9)
    assert_close(forces[1], forces[3], 1e-9)
    range_ = nutation.u0 - nutation.u1
    forces = [nutation.upward_force(nutation.u1 + range_ * i / 10**5) for i in range(10**5 + 1)]
    assert_close(highest, max(forces), 1e-7)
    assert_close(lowest, min(forces), 1e-7)


def test_of_stability(rows_of):
    """The threshold of the sleeping top, and the growth rate below it."""
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


def test_of_sensitivity(rows_of):
    """The derivative with respect to the spin, against differences of two kinds."""
    body, step, ends = Body(SKEW, SKEW_ARM), 1e-3, []
    for omega3 in (5 - step, 5 + step):
        end = body.carry(start(0.2, 0, omega3), 2, 4000)
        momentum = [a * b for a, b in zip(SKEW, end[4:], strict=True)]
        ends.append((*vertical(end), *momentum))
    for row, less, more in zip(rows_of("sensitivity", 6), *ends, strict=True):
        _, derivative, quotient = row
        assert_close(derivative, quotient, 1e-6)
        assert_close(derivative, (more - less) / (2 * step), 2e-5)


def test_of_methods(spin, example):
    """The combinations are those that the program lists."""
    expected = {entry["name"]: entry["formulations"] for entry in spin.listed("methods")}
    del expected["exact"]  # it has no steps
    lines = example("methods").splitlines()
    found = {name: names.split() for name, _, names in (line.partition(":") for line in lines)}
    assert found == expected


def test_of_sweep(rows_of):
    """The largest inclination for each spin ratio."""
    unit = math.sqrt(4 * MGL / INERTIA[2])
    rows = rows_of("sweep", 4)
    assert [ratio for ratio, _ in rows] == [0.5, 1, 2, 4]
    for ratio, theta_max in rows:
        assert_close(theta_max, Nutation(math.pi / 6, ratio * unit).theta_max, 1e-7)
