"""Friction about the axis of the body by a table over its angular velocity."""

import csv
import math
from itertools import pairwise
from pathlib import Path

import pytest

from effects_test import FREE, SKEW, TIGHT, move, refused, run, scene

INERTIA = 0.3
BROKEN = [(0, 0), (4, 0.2), (10, 0.35), (20, 1.2), (40, 1.2), (60, 4.0)]
METHODS = {
    "taylor": (TIGHT, 1e-11),
    "taylor_quadruple": ("method = 'taylor_quadruple'  relative_tolerance = 1e-20", 1e-12),
    "dop853": ("method = 'dop853'  relative_tolerance = 1e-13", 1e-13),
    "arkode": ("method = 'arkode_erk'  relative_tolerance = 1e-11", 1e-11),
    "gauss": ("method = 'gauss_8'  steps = 5000", 1e-5),
}


def write(folder: Path, rows: list[tuple[float, float]]) -> str:
    """Write a table of friction, and the key that names it."""
    lines = ["omega3,friction_torque", *(f"{omega!r},{torque!r}" for omega, torque in rows)]
    (folder / "friction.csv").write_text("\n".join(lines) + "\n")
    return "friction_table = 'friction.csv'"


def spin_down(spin: float, t: float) -> float:
    """The spin that broken lines leave after a time: an exponential between two rows."""
    pieces = list(pairwise(BROKEN))
    for (low, at_low), (high, at_high) in reversed(pieces):
        if not low < spin <= high:
            continue
        slope = (at_high - at_low) / (high - low)
        torque = at_low + slope * (spin - low)
        if slope > 0:
            # The torque falls as exp(-slope t/I).
            until = math.inf if at_low == 0 else math.log(torque / at_low) * INERTIA / slope
        else:
            until = (spin - low) * INERTIA / torque
        if t <= until:
            if slope == 0:
                return spin - torque * t / INERTIA
            return low + (torque * math.exp(-slope * t / INERTIA) - at_low) / slope
        spin, t = low, t - until
    return spin


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("method", METHODS)
def test_spin_down(folder: Path, method: str, direction: int) -> None:
    """A body that spins about its axis alone has a closed form; it starts at a row."""
    integration, tolerance = METHODS[method]
    start = f"theta = 1  omega = 0, 0, {60 * direction}"
    span = "t_end = 20  samples = 41"
    motion = move(folder, scene(FREE, start, span, write(folder, BROKEN), integration))
    assert motion.status == "ok"
    for row in motion.rows:
        spin = spin_down(60, row["t"])
        assert row["omega3"] == pytest.approx(direction * spin, abs=60 * tolerance)
        assert row["work_friction"] == pytest.approx(0.15 * (spin**2 - 3600), abs=1000 * tolerance)
        assert abs(row["energy_error"]) < 10 * tolerance


def test_laws_of_keys(folder: Path) -> None:
    """Rows of a + b omega + c omega^2 through a spline are friction by three keys, up to rest."""
    a, b, c = 0.05, 0.02, 0.003
    rows = [(w, a + b * w + c * w * w) for w in (0, 1, 4, 9, 17, 31, 40)]
    start, span = "theta = 1  omega = 0, 0, 38", "t_end = 40  samples = 81"
    effects = write(folder, rows) + "  friction_interpolation = 'spline'"
    found = move(folder, scene(FREE, start, span, effects))
    keys = f"friction_torque = {a}  drag_moment = 0, 0, {c}"
    expected = move(folder, scene(f"{FREE}  damping = 0, 0, {b}", start, span, keys))
    assert found.status == expected.status == "at_rest"
    assert found.time == pytest.approx(expected.time, rel=1e-10)
    for one, other in zip(found.rows, expected.rows, strict=True):
        assert one["omega3"] == pytest.approx(other["omega3"], abs=1e-10)
        assert one["psi"] == pytest.approx(other["psi"], abs=1e-9)
        assert abs(one["energy_error"]) < 1e-12


@pytest.mark.parametrize("interpolation", ["linear", "monotone", "spline"])
def test_methods_agree(folder: Path, interpolation: str) -> None:
    """The spin of a body without symmetry rises and falls across rows; the law falls first."""
    rows = [(0, 0.02), (1, 0.012), (3, 0.02), (6, 0.05), (8, 0.06), (10, 0.1), (15, 0.3), (30, 0.5)]
    effects = write(folder, rows) + f"  friction_interpolation = '{interpolation}'"
    ends = {}
    for name in ("taylor", "taylor_quadruple", "dop853"):
        text = scene(SKEW, "theta = 1  psi_rate = 9", "t_end = 2", effects, METHODS[name][0])
        motion = move(folder, text)
        ends[name] = [motion.last[key] for key in ("q0", "q1", "q2", "q3", "lz", "work_friction")]
        assert abs(motion.last["energy_error"]) < 1e-9
        assert motion.last["work_friction"] < -0.1
    assert ends["taylor"] == pytest.approx(ends["taylor_quadruple"], abs=1e-10)
    assert ends["dop853"] == pytest.approx(ends["taylor_quadruple"], abs=1e-8)


def test_axis_of_a_tensor(folder: Path) -> None:
    """Friction is about body z of the input where that is no principal axis."""
    effects = write(folder, [(0, 0), (20, 0.8)])
    top = (
        "mass = 1  gravity = 0  inertia_tensor(1,:) = 0.9, 0, 0.1"
        "  inertia_tensor(2,:) = 0, 1, 0.05  inertia_tensor(3,:) = 0.1, 0.05, 0.4"
        "  centre_of_mass = 0, 0, 0"
    )
    motion = move(folder, scene(top, "theta = 1  omega = 2, -1, 9", "t_end = 1", effects))
    inertia = ((0.9, 0, 0.1), (0, 1, 0.05), (0.1, 0.05, 0.4))
    momentum = [sum(a * w for a, w in zip(row, (2, -1, 9), strict=True)) for row in inertia]
    assert momentum == pytest.approx([2.7, -0.55, 3.75])
    spin, steps = [2.0, -1.0, 9.0], 2000
    for _ in range(steps):
        spin = runge_kutta(inertia, spin, 1 / steps)
    for i in range(3):
        assert motion.last[f"omega{i + 1}"] == pytest.approx(spin[i], abs=1e-9)


def runge_kutta(inertia: tuple, omega: list[float], h: float) -> list[float]:
    """A step of RK4 for I omega' = I omega x omega - 0.04 omega3 e3."""

    def rate(w: list[float]) -> list[float]:
        p = [sum(a * b for a, b in zip(row, w, strict=True)) for row in inertia]
        m = [p[1] * w[2] - p[2] * w[1], p[2] * w[0] - p[0] * w[2], p[0] * w[1] - p[1] * w[0]]
        m[2] -= 0.04 * w[2]
        return solve(inertia, m)

    k1 = rate(omega)
    k2 = rate([w + h / 2 * k for w, k in zip(omega, k1, strict=True)])
    k3 = rate([w + h / 2 * k for w, k in zip(omega, k2, strict=True)])
    k4 = rate([w + h * k for w, k in zip(omega, k3, strict=True)])
    slopes = zip(omega, k1, k2, k3, k4, strict=True)
    return [w + h / 6 * (a + 2 * b + 2 * c + d) for w, a, b, c, d in slopes]


def solve(a: tuple, b: list[float]) -> list[float]:
    """The solution of three equations, by Cramer's rule."""

    def determinant(m: list[list[float]]) -> float:
        (p, q, r), (s, t, u), (v, w, x) = m
        return p * (t * x - u * w) + q * (u * v - s * x) + r * (s * w - t * v)

    whole = determinant([list(row) for row in a])
    return [
        determinant([[b[r] if c == k else a[r][c] for c in range(3)] for r in range(3)]) / whole
        for k in range(3)
    ]


def test_order_of_fixed_steps(folder: Path) -> None:
    """Steps of fixed size do not end at rows, which a warning says."""
    effects = write(folder, BROKEN)
    text = scene(
        FREE, "theta = 1  omega = 0, 0, 50", "t_end = 1", effects, "method = 'rk4'  steps = 99"
    )
    done = run(folder, text)
    assert done.returncode == 0
    assert "the order of the method is 2 at most" in " ".join(done.stderr.split())


def test_sweep(folder: Path) -> None:
    """Cases with a table are computed one after another; one that starts beyond it is refused."""
    text = "&study kind = 'sweep' /\n" + scene(
        FREE, "theta = 1  omega = 0, 0, 1", "t_end = 2", write(folder, BROKEN)
    )
    text += "&sweep parameter = 'initial.omega(3)'  values(1, :) = 5, 30, 60, 61 /\n"
    text += "&output columns = 'psi_end', 'energy_error_max' /\n"
    assert run(folder, text).returncode == 3
    lines = (folder / "scene.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [row["status"] for row in rows] == ["ok", "ok", "ok", "bad_input"]
    for row, spin in zip(rows, (5, 30, 60), strict=False):
        n = 20000
        turned = sum(spin_down(spin, 2 * (i + 0.5) / n) for i in range(n)) * 2 / n
        assert float(row["psi_end"]) == pytest.approx(turned, rel=1e-7)
        assert float(row["energy_error_max"]) < 1e-11


@pytest.mark.parametrize(
    ("rows", "effects", "words"),
    [
        ("0,0", "", "has 1 rows"),
        ("0,0\n1,2", "friction_interpolation = 'spline'", "has 2 rows"),
        ("1,0\n2,1", "", "friction.csv:2: the table begins at omega3 = 1"),
        ("-1,0\n0,1", "", "friction.csv:2: the table begins at omega3 = -1"),
        ("0,0\n3,1\n3,2", "", "friction.csv:4: omega3 = 3"),
        ("0,0\n3,1\n2,2", "", "friction.csv:4: omega3 = 2"),
        ("0,0\n# bearing\n3,-1", "", "friction.csv:4: friction_torque = -1 would drive the body"),
        ("0,nan\n3,1", "", "friction.csv:2: row 1 has a value that is not finite"),
        ("0,0\n3,x", "", "friction.csv:3: 'x' in column friction_torque is not a number"),
        (
            "0,1\n1,0\n2,0\n30,1",
            "friction_interpolation = 'spline'",
            "friction.csv:3: from this row to the next the spline is negative",
        ),
        ("0,0\n5,1", "", "the table ends at omega3 = 5, below that of the start, 8"),
        ("0,1\n50,0.5", "friction_smoothing = 0.1", "falls from its value at rest"),
        ("0,0\n50,0.5", "friction_law = 1", "friction_table"),
    ],
)
def test_bad_tables(folder: Path, rows: str, effects: str, words: str) -> None:
    """Each mistake is refused with its line; tables that would drive the body are."""
    (folder / "friction.csv").write_text("omega3,friction_torque\n" + rows + "\n")
    keys = f"friction_table = 'friction.csv'  {effects}"
    refused(folder, scene(FREE, "theta = 1  omega = 0, 0, -8", "t_end = 1", keys), words)


def test_table_without_its_columns(folder: Path) -> None:
    """The columns are named where they are missing; an interpolation needs a table."""
    (folder / "friction.csv").write_text("omega,torque\n0,0\n9,1\n")
    start = "theta = 1  omega = 0, 0, 8"
    text = scene(FREE, start, "t_end = 1", "friction_table = 'friction.csv'")
    refused(folder, text, "scene.nml:4", "omega3", "its columns are omega3, friction_torque")
    text = scene(FREE, start, "t_end = 1", "friction_interpolation = 'spline'")
    refused(folder, text, "scene.nml:4", "give friction_table too")
