"""The example programs: each is compiled with the library, and its numbers are those of mechanics.

The motions that they print are compared with a Runge-Kutta method that is written here, the
quantities of a nutation with the roots of its cubic and an arithmetic-geometric mean, and the
others with their formulas. Nothing is compared with earlier output.
"""

import itertools
import json
import math
import os
import re
import subprocess
import tempfile
import tomllib
import unittest
from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = Path(os.environ["SPINTOP_EXE"]).resolve()
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

Vector = tuple[float, ...]


class Body:
    """A rigid body of 1 kg with a fixed point, as Euler's equations for a quaternion and omega."""

    def __init__(self, inertia: Vector, arm: Vector, damping: float = 0.0) -> None:
        self.inertia, self.arm, self.damping = inertia, arm, damping

    def rate(self, y: Vector) -> Vector:
        """Derivative of the state (q, omega)."""
        q0, q1, q2, q3, w1, w2, w3 = y
        a, b, c = self.inertia
        x, y_, z = (GRAVITY * r for r in self.arm)
        up = vertical(y)
        d = self.damping
        return (
            (-q1 * w1 - q2 * w2 - q3 * w3) / 2,
            (q0 * w1 + q2 * w3 - q3 * w2) / 2,
            (q0 * w2 + q3 * w1 - q1 * w3) / 2,
            (q0 * w3 + q1 * w2 - q2 * w1) / 2,
            ((b - c) * w2 * w3 + up[1] * z - up[2] * y_ - d * w1) / a,
            ((c - a) * w3 * w1 + up[2] * x - up[0] * z - d * w2) / b,
            ((a - b) * w1 * w2 + up[0] * y_ - up[1] * x - d * w3) / c,
        )

    def carry(self, y: Vector, t: float, steps: int) -> Vector:
        """The state after t seconds, by the classical Runge-Kutta method."""
        h = t / steps
        for _ in range(steps):
            k1 = self.rate(y)
            k2 = self.rate(plus(y, h / 2, k1))
            k3 = self.rate(plus(y, h / 2, k2))
            k4 = self.rate(plus(y, h, k3))
            rise = (a + 2 * b + 2 * c + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True))
            y = plus(y, h / 6, rise)
        return y


def plus(y: Vector, h: float, k: Iterable[float]) -> Vector:
    """The sum y + h k."""
    return tuple(a + h * b for a, b in zip(y, k, strict=True))


def quaternion(phi: float, theta: float, psi: float) -> Vector:
    """The attitude with these Euler angles."""
    c, s = math.cos(theta / 2), math.sin(theta / 2)
    plus_, minus = (phi + psi) / 2, (phi - psi) / 2
    return (c * math.cos(plus_), s * math.cos(minus), s * math.sin(minus), c * math.sin(plus_))


def start(theta: float, theta_rate: float, psi_rate: float) -> Vector:
    """The state at phi = psi = phi' = 0."""
    return (*quaternion(0, theta, 0), theta_rate, 0.0, psi_rate)


def vertical(y: Vector) -> Vector:
    """The upward vertical in body axes."""
    q0, q1, q2, q3 = y[:4]
    return (2 * (q1 * q3 - q0 * q2), 2 * (q2 * q3 + q0 * q1), q0**2 - q1**2 - q2**2 + q3**2)


def inclination(y: Vector) -> float:
    """The angle theta of a state."""
    return 2 * math.atan2(math.hypot(y[1], y[2]), math.hypot(y[0], y[3]))


def height_rate(y: Vector) -> float:
    """The derivative of cos(theta)."""
    up = vertical(y)
    return up[0] * y[5] - up[1] * y[4]


class Nutation:
    """The nutation of the symmetric top that is released at rest, from the roots of its cubic.

    With u = cos(theta), a = I3 omega3/I1 and b = 2 m g l/I1 it is
    u'^2 = (u0 - u) (b (1 - u^2) - a^2 (u0 - u)), with the roots u1 < u0 < u3.
    """

    def __init__(self, theta: float, omega3: float) -> None:
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

    def upward_force(self, u: float) -> float:
        """The vertical force, m (g + l u''); u'' is half the derivative of u'^2 by u."""
        down, kept = self.u0 - u, self.b * (1 - u * u) - self.a**2 * (self.u0 - u)
        return GRAVITY + HEIGHT * (-kept + down * (self.a**2 - 2 * self.b * u)) / 2


@unittest.skipIf(EXE.parent.name == "sanitized", "programs would need the sanitizers, too")
class ExamplesTest(unittest.TestCase):
    """Programs of example/."""

    folder: ClassVar[Path]
    command: ClassVar[str]

    @classmethod
    def setUpClass(cls) -> None:
        """Make a folder for the programs and their files."""
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        manifest = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))
        libraries = " ".join("-l" + library for library in manifest["build"]["link"])
        cls.command = (
            f". '{ROOT}/.venv/bin/activate' && gfortran -std=f2008 -Wall -fopenmp"
            f" -I'{EXE.parent}/include' -J. '{ROOT}/example/NAME.f90'"
            f" '{EXE.parent}/lib/libspintop.a' $FPM_LDFLAGS {libraries} {EXTRA} -o NAME && ./NAME"
        )

    def run_example(self, name: str) -> str:
        """Compile an example and run it."""
        result = subprocess.run(
            ["bash", "-c", self.command.replace("NAME", name)],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def rows_of(self, name: str, count: int) -> list[list[float]]:
        """The numbers of each line of an example that has `count` lines."""
        lines = self.run_example(name).splitlines()
        self.assertEqual(len(lines), count, lines)
        number = r"(?<![\w.^])-?\d+(?:\.\d*)?(?:E[+-]\d+)?(?![\w/.])"
        return [[float(text) for text in re.findall(number, line)] for line in lines]

    def assert_close(self, found: float, expected: float, slack: float) -> None:
        """Two numbers agree to `slack`, relative to 1 or to their magnitude."""
        error = abs(found - expected)
        self.assertLessEqual(error, slack * max(1, abs(expected)), (found, expected))

    def test_every_example_has_a_test(self) -> None:
        """Each example has a test and a line in the manual."""
        names = {path.stem for path in (ROOT / "example").glob("*.f90")}
        of = "test_of_"
        tested = {name.removeprefix(of) for name in dir(self) if name.startswith(of)}
        self.assertEqual(names, tested)
        page = (ROOT / "doc/library.md").read_text(encoding="utf-8")
        table = page.partition("## Examples")[2].partition("## ")[0]
        self.assertEqual(set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)), names)

    def test_every_procedure_has_an_example(self) -> None:
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
        self.assertEqual(missing, set())

    def test_of_exact_motion(self) -> None:
        """The attitude at three instants."""
        body, state, before = Body(INERTIA, (0, 0, HEIGHT)), start(0.2, 0, 1), 0.0
        for t, *angles in self.rows_of("exact_motion", 3):
            state, before = body.carry(state, t - before, 3000), t
            attitude = quaternion(*angles)  # or with all signs reversed
            error = min(
                math.dist(attitude, state[:4]), math.dist(attitude, [-q for q in state[:4]])
            )
            self.assertLess(error, 1e-8)

    def test_of_any_body(self) -> None:
        """The inclination of a damped body without symmetry."""
        body, state, before = Body(SKEW, SKEW_ARM, 0.01), start(0.2, 0, 5), 0.0
        for t, theta in self.rows_of("any_body", 5)[:4]:
            state, before = body.carry(state, t - before, 1000), t
            self.assert_close(theta, inclination(state), 1e-8)

    def test_of_many_bodies(self) -> None:
        """The inclinations of some of them, and the energy of all."""
        (completed,), *some, (change,) = self.rows_of("many_bodies", 6)
        self.assertEqual(completed, 1000)
        self.assertEqual([row[0] for row in some], [0.7, 0.8, 0.9, 1.0])
        for inertia, _, theta in some:
            state = Body((0.9, inertia, 0.25), SKEW_ARM).carry(start(0.2, 0, 5), 2, 4000)
            self.assert_close(theta, inclination(state), 2e-9)
        self.assertLess(change, 1e-11)

    def test_of_events(self) -> None:
        """The first six turning points of a damped body, and no other."""
        body, state, before, expected = Body(SKEW, SKEW_ARM, 0.01), start(0.5, 0.5, 20), 0.0, []
        steps, span = 4000, 4.0
        for i in range(steps):
            ahead = body.carry(state, span / steps, 1)
            if height_rate(state) * height_rate(ahead) < 0:
                kind = "lowest" if height_rate(ahead) > 0 else "highest"
                expected.append((i * span / steps, kind))
            state = ahead
        *lines, ending = self.run_example("events").splitlines()
        self.assertEqual(len(lines), 6)
        state = start(0.5, 0.5, 20)
        for line, (about, kind) in zip(lines, expected, strict=False):
            found = re.fullmatch(r"(\w+) +point at +([\d.]+) s: theta = *([\d.]+)", line)
            t, theta = float(found[2]), float(found[3])
            self.assertEqual(found[1], kind)
            self.assertTrue(about <= t <= about + span / steps, line)
            state, before = body.carry(state, t - before, 1500), t
            self.assert_close(height_rate(state), 0, 1e-8)
            self.assert_close(theta, inclination(state), 1e-9)
        self.assertRegex(ending, rf"ok, ended at +{before:.4f} s: phi = +[\d.]+ rad")
        phi = math.atan2(state[3], state[0]) + math.atan2(state[2], state[1])
        self.assert_close(math.cos(float(ending.split()[-2]) - phi), 1, 1e-8)

    def test_of_accuracy(self) -> None:
        """The orders of two methods; the error of the third is near that of the data."""
        rk4, finer_rk4, six, finer_six, taylor, inherent = self.rows_of("accuracy", 6)
        self.assertAlmostEqual(math.log2(rk4[-1] / finer_rk4[-1]), 4, delta=0.5)
        self.assertAlmostEqual(math.log2(six[-1] / finer_six[-1]), 6, delta=0.5)
        self.assertLess(taylor[-1], 1e-11)
        self.assertTrue(1e-16 < inherent[0] < 1e-13)

    def test_of_nutation(self) -> None:
        """Range and period of the nutation of a top released at rest."""
        for spin, theta, theta_max, period in self.rows_of("nutation", 4):
            expected = Nutation(0.5, spin)
            self.assertEqual(theta, 0.5)
            self.assert_close(theta_max, expected.theta_max, 1e-9)
            self.assert_close(period, expected.period, 1e-9)
        classes = [line.split()[-1] for line in self.run_example("nutation").splitlines()]
        self.assertEqual(classes, ["libration", "cusp", "cusp", "cusp"])

    def test_of_many_tops(self) -> None:
        """The same for many tops together."""
        (count,), *rows = self.rows_of("many_tops", 9)
        self.assertEqual(count, 400)
        for spin, theta_max, period in rows:
            expected = Nutation(0.5, spin)
            self.assert_close(theta_max, expected.theta_max, 1e-9)
            self.assert_close(period, expected.period, 1e-9)

    def test_of_fast_top_formulas(self) -> None:
        """Their errors decrease with the square of the spin."""
        errors = []
        rows = self.rows_of("fast_top_formulas", 5)
        for spin, rate, rate_about, precession, precession_about in rows:
            self.assert_close(rate, 2 * math.pi / Nutation(0.5, spin).period, 1e-7)
            self.assert_close(rate_about, INERTIA[2] * spin / INERTIA[0], 1e-7)
            self.assert_close(precession_about, MGL / (INERTIA[2] * spin), 1e-7)
            errors.append((rate_about / rate - 1, 1 - precession_about / precession))
        for one, next_one in itertools.pairwise(errors[1:]):
            for error, smaller in zip(one, next_one, strict=True):
                self.assertAlmostEqual(math.log2(error / smaller), 2, delta=0.25)

    def test_of_steady_precession(self) -> None:
        """The rates, and the force that carries the weight and turns the centre of mass."""
        rows = self.rows_of("steady_precession", 2)
        for rate, theta, upwards, sideways in rows:
            balance = INERTIA[0] * 0.5 * rate**2 - INERTIA[2] * 40 * rate + MGL
            self.assert_close(balance, 0, 1e-7)
            self.assert_close(theta, math.pi / 3, 1e-9)
            self.assert_close(upwards, GRAVITY, 1e-8)
            self.assert_close(sideways, HEIGHT * math.sin(theta) * rate**2, 1e-8)
        self.assertLess(rows[0][0], rows[1][0])

    def test_of_permanent_rotation(self) -> None:
        """The weight turns the momentum; nearly at rest upright it falls, hanging it stays."""
        rows = self.rows_of("permanent_rotation", 4)
        arm, moments = (0.1, 0.2, 0.5), (0.9, 0.7, 0.4)
        for x, y, z, rate, same_rate, growth in rows:
            up = (x, y, z)
            self.assert_close(math.hypot(*up), 1, 2e-6)
            self.assert_close(rate, same_rate, 1e-9)
            momentum = [rate**2 * inertia * part for inertia, part in zip(moments, up, strict=True)]
            rest = [one - GRAVITY * other for one, other in zip(momentum, arm, strict=True)]
            along = sum(one * part for one, part in zip(rest, up, strict=True))
            for one, part in zip(rest, up, strict=True):
                self.assert_close(one, along * part, 1e-4)
            self.assertGreater(growth, -1e-6)
        self.assertGreater(rows[0][-1], 1)
        self.assertLess(rows[-1][-1], 1e-6)

    def test_of_energy_and_force(self) -> None:
        """Both momenta, the energy, and the force at rest, at the bottom and between."""
        _, *rows, (lowest, highest) = self.rows_of("energy_and_force", 7)
        nutation = Nutation(0.2, 1)
        forces = []
        for i, (t, energy, about_vertical, about_axis, force, residual) in enumerate(rows):
            self.assertAlmostEqual(t, i * nutation.period / 4, delta=6e-4)
            self.assert_close(energy, 0.5 * INERTIA[2] + MGL * math.cos(0.2), 1e-9)
            self.assert_close(about_vertical, INERTIA[2] * math.cos(0.2), 1e-9)
            self.assert_close(about_axis, INERTIA[2], 1e-9)
            self.assertLess(residual, 1e-13)
            forces.append(force)
        at_rest, at_bottom = nutation.upward_force(nutation.u0), nutation.upward_force(nutation.u1)
        for force, expected in zip(forces[::2], (at_rest, at_bottom, at_rest), strict=True):
            self.assert_close(force, expected, 1e-9)
        self.assert_close(forces[1], forces[3], 1e-9)
        range_ = nutation.u0 - nutation.u1
        forces = [nutation.upward_force(nutation.u1 + range_ * i / 10**5) for i in range(10**5 + 1)]
        self.assert_close(highest, max(forces), 1e-7)
        self.assert_close(lowest, min(forces), 1e-7)

    def test_of_stability(self) -> None:
        """The threshold of the sleeping top, and the growth rate below it."""
        (threshold,), below, at, above = self.rows_of("stability", 4)
        self.assert_close(threshold, 2 * math.sqrt(MGL * INERTIA[0]) / INERTIA[2], 1e-9)
        half_rate = INERTIA[2] * 0.8 * threshold / (2 * INERTIA[0])
        self.assert_close(below[1], math.sqrt(MGL / INERTIA[0] - half_rate**2), 1e-8)
        self.assertLess(at[1], 1e-6)  # a double root: the square root of a rounding error
        self.assertEqual(above[1], 0)

    def test_of_floquet(self) -> None:
        """Rotation about the intermediate axis is unstable, with a rate from Euler's equations."""
        growth = [factor for _, factor in self.rows_of("floquet", 3)]
        self.assert_close(growth[0], 1, 1e-6)
        self.assert_close(growth[1], math.exp(2 * math.pi / math.sqrt(3)), 1e-9)
        self.assert_close(growth[2], 1, 1e-6)

    def test_of_lyapunov(self) -> None:
        """Only chaos grows without end."""
        chaotic, damped, regular = ([row[0], row[2]] for row in self.rows_of("lyapunov", 3))
        self.assertLess(damped[0], 0)
        self.assertGreater(chaotic[0], 2 * regular[0])
        self.assertAlmostEqual(math.log(chaotic[1]) / 200, chaotic[0], delta=0.2 * chaotic[0])
        self.assertLess(regular[1], 1e5)

    def test_of_sensitivity(self) -> None:
        """The derivative with respect to the spin, against differences of two kinds."""
        body, step, ends = Body(SKEW, SKEW_ARM), 1e-3, []
        for spin in (5 - step, 5 + step):
            end = body.carry(start(0.2, 0, spin), 2, 4000)
            momentum = [a * b for a, b in zip(SKEW, end[4:], strict=True)]
            ends.append((*vertical(end), *momentum))
        for row, less, more in zip(self.rows_of("sensitivity", 6), *ends, strict=True):
            _, derivative, quotient = row
            self.assert_close(derivative, quotient, 1e-6)
            self.assert_close(derivative, (more - less) / (2 * step), 2e-5)

    def test_of_methods(self) -> None:
        """The combinations are those that the program lists."""
        command = [EXE, "list", "methods", "--json"]
        listed = subprocess.run(command, capture_output=True, check=True)
        entries = json.loads(listed.stdout)["methods"]
        expected = {entry["name"]: entry["formulations"] for entry in entries}
        del expected["exact"]  # it has no steps
        lines = self.run_example("methods").splitlines()
        found = {name: names.split() for name, _, names in (line.partition(":") for line in lines)}
        self.assertEqual(found, expected)

    def test_of_sweep(self) -> None:
        """The largest inclination for each spin ratio."""
        unit = math.sqrt(4 * MGL / INERTIA[2])
        rows = self.rows_of("sweep", 4)
        self.assertEqual([ratio for ratio, _ in rows], [0.5, 1, 2, 4])
        for ratio, theta_max in rows:
            self.assert_close(theta_max, Nutation(math.pi / 6, ratio * unit).theta_max, 1e-7)


if __name__ == "__main__":
    unittest.main()
