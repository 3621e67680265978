"""An effect, a method, a watch and columns are added as `doc/developing.md` says, in few lines.

A copy of the sources takes the patches in `test/additions`, and is built once. It has a second
effect, too, which only the loads know: everything else has to see that it does not know this one.
"""

import faulthandler
import math
import shutil
from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd
import pytest

from conftest import ROOT, Run, Spin, each, execute, output
from mechanics import rotation, runge_kutta

ADDITIONS = ("effect", "method", "watch")
"""A torque in body axes that decays; Heun's method of order 3; the largest height of the centre."""
COLUMNS_ADDED = ("sweep_column", "trajectory_column")
"""cos(theta) at the end of a span; the magnitude of the angular velocity."""
OF_LOADS = "effect_of_loads"
"""A torque in body axes that is divided by 1 + t."""
MOST_LINES, MOST_OF_COLUMN = 40, 5
PATIENCE = 3600  # s


def added(name: str) -> int:
    """Return the number of lines that an addition adds or changes: no empty ones, nor comments."""
    text = (ROOT / f"test/additions/{name}.patch").read_text(encoding="utf-8")
    lines = [line[1:].strip() for line in text.splitlines() if line.startswith("+")]
    return sum(line != "" and not line.startswith(("!", "++ b/")) for line in lines)


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Spin]:
    """A built copy of the sources with the additions."""
    root = tmp_path_factory.mktemp("additions")
    for name in ("app", "src", "include", "scripts"):
        shutil.copytree(ROOT / name, root / name, symlinks=True)
    shutil.copy(ROOT / "fpm.toml", root)
    (root / ".venv").symlink_to(ROOT / ".venv")
    for name in (*ADDITIONS, *COLUMNS_ADDED, OF_LOADS):
        execute("git", "apply", "-C1", ROOT / f"test/additions/{name}.patch", cwd=root)
    faulthandler.cancel_dump_traceback_later()  # a build may take longer than other tests
    build = ("bash", "-c", "source scripts/setup; build release")
    execute(*build, cwd=root, environment={"SPINTOP_FLAGS": "-O0"})
    yield Spin(root)
    shutil.rmtree(root)


pytestmark = [pytest.mark.slow, pytest.mark.timeout(PATIENCE)]

MASS, GRAVITY = 1.3, 9.81
CENTRE = np.array([0.02, -0.03, 0.5])
SMOOTH = np.diag([0.9, 1.0, 0.3])
SKEW = np.array([[0.9, 0.05, -0.02], [0.05, 1.0, 0.03], [-0.02, 0.03, 0.4]])
TORQUE, RATE = np.array([0.4, -0.7, 0.6]), 1.7
START = np.array([0.8, 0.1, -0.5, 0.3])
OMEGA = np.array([1.0, -0.5, 9.0])
T_END = 1.5

Moment = Callable[[float], np.ndarray]


def decaying(t: float) -> np.ndarray:
    return TORQUE * math.exp(-RATE * t)


def fading(t: float) -> np.ndarray:
    """Return the torque of the effect that only the loads know."""
    return TORQUE / (1 + t)


def path(inertia: np.ndarray, moment: Moment, parts: int = 1) -> np.ndarray:
    """Return the states (q, omega) of a motion at the ends of its parts."""
    inverse = np.linalg.inv(inertia)

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        q, w = y[:4], y[4:]
        turn = np.concatenate([[-q[1:] @ w], q[0] * w + np.cross(q[1:], w)]) / 2
        torque = MASS * GRAVITY * np.cross(rotation(q)[2], CENTRE) + moment(t)
        return np.concatenate([turn, inverse @ (np.cross(inertia @ w, w) + torque)])

    states, h = [np.concatenate([START / np.linalg.norm(START), OMEGA])], T_END / parts
    for i in range(parts):
        later = lambda t, y, i=i: slope(i * h + t, y)  # noqa: E731
        states.append(runge_kutta(later, states[-1], h, 3000 // parts))
    return np.array(states)


def listed(values: np.ndarray) -> str:
    return ", ".join(repr(float(x)) for x in values)


def scene(inertia: np.ndarray, effects: str, more: str) -> str:
    body = " ".join(f"inertia_tensor({i + 1},:) = {listed(inertia[i])}" for i in range(3))
    if inertia is SMOOTH:
        body = f"inertia = {listed(np.diag(inertia))}"
    return (
        f"&top mass = {MASS} gravity = {GRAVITY} {body} centre_of_mass = {listed(CENTRE)} /\n"
        f"&initial quaternion = {listed(START / np.linalg.norm(START))} omega = {listed(OMEGA)} /\n"
        f"&span t_end = {T_END} /\n&effects {effects} /\n{more}\n"
    )


DECAYS = f"decaying_torque = {listed(TORQUE)} decay_rate = {RATE}"
FADES = f"fading_torque = {listed(TORQUE)}"


def call(copy: Spin, *words: str, code: int | tuple[int, ...] = 0) -> Run:
    return copy.call(*words, command=(copy.folder / "build/release/spintop",), code=code)


def rows(copy: Spin, text: str, *options: str) -> pd.DataFrame:
    return call(copy, "--quiet", *options, copy.write(text)).rows


def refusal(copy: Spin, text: str) -> str:
    return call(copy, "--check", copy.write(text), code=(0, 2)).stderr


NAMES = [*(f"q{i}" for i in range(4)), *(f"omega{i}" for i in (1, 2, 3))]
COLUMNS = output("t", *NAMES, "energy_error")
ADAPTIVE = "relative_tolerance = 1e-13"


def check_end(copy: Spin, text: str, expected: np.ndarray, method: str) -> None:
    """The motion by a method ends where it should, and its account of energy is right."""
    end = rows(copy, f"{text}&integration method = {method} /\n{COLUMNS}").iloc[-1]
    assert distance(end[NAMES].to_numpy(dtype=float), expected) < 1e-9, method
    assert abs(end.energy_error) < 1e-10, method


def distance(a: np.ndarray, b: np.ndarray) -> float:
    sign = math.copysign(1, a[:4] @ b[:4])
    return float(np.linalg.norm(a - np.concatenate([sign * b[:4], b[4:]])))


def test_additions_are_short() -> None:
    """The effect, the method and the watch take fewer lines than a page has."""
    assert sum(map(added, ADDITIONS)) < MOST_LINES


@each("name", *COLUMNS_ADDED)
def test_column_is_a_line(name: str) -> None:
    """A line of the registry, its number, and where that is computed."""
    assert added(name) <= MOST_OF_COLUMN


def test_new_columns_have_values(copy: Spin) -> None:
    """Also in another unit, and as a derivative."""
    output = "&output columns = 't', 'omega1', 'omega2', 'omega3', 'speed', 'speed_rpm' /"
    row = rows(copy, scene(SMOOTH, "", output)).iloc[-1]
    omega = np.array([float(row[f"omega{i}"]) for i in (1, 2, 3)])
    assert abs(float(row["speed"]) - np.linalg.norm(omega)) < 1e-14 * np.linalg.norm(omega)
    assert abs(float(row["speed_rpm"]) * math.pi / 30 / float(row["speed"]) - 1) < 1e-14
    sweep = (
        "&study kind = 'sweep' /\n&sweep parameter = 'initial.omega(3)' values(1,:) = 9, 10 /\n"
        "&output columns = 'theta_end', 'gamma3_end', 'gamma3_end__initial.omega(3)' /"
    )
    for _, case in rows(copy, scene(SMOOTH, "", sweep)).iterrows():
        assert abs(float(case["gamma3_end"]) - math.cos(float(case["theta_end"]))) < 1e-15
        assert math.isfinite(float(case["gamma3_end__initial.omega(3)"]))


def test_lists_have_them(copy: Spin) -> None:
    parameters = call(copy, "list", "parameters").out
    assert "effects.decaying_torque" in parameters
    assert "effects.decay_rate" in parameters
    assert "heun_3" in call(copy, "list", "methods").out
    assert "com_z_max" in call(copy, "list", "columns").out


@each("inertia", SMOOTH, SKEW, ids=["principal", "tensor"])
def test_effect_changes_the_motion(copy: Spin, inertia: np.ndarray) -> None:
    """By slopes and by series, also in quadruple precision, as another integration says."""
    expected = path(inertia, decaying)[-1]
    assert distance(expected, path(inertia, lambda _: np.zeros(3))[-1]) > 0.1
    adaptive = [f"{name!r} {ADAPTIVE}" for name in ("dop853", "taylor", "auto")]
    for method in (*adaptive, "'taylor_quadruple'", "'rk4' steps = 6000"):
        check_end(copy, scene(inertia, DECAYS, ""), expected, method)


def test_effect_of_loads_alone(copy: Spin) -> None:
    """It is right with every method that takes it; series are refused, and not chosen."""
    text = scene(SMOOTH, FADES, "")
    for method in (f"'dop853' {ADAPTIVE}", f"'auto' {ADAPTIVE}", "'gauss_8' steps = 3000"):
        check_end(copy, text, path(SMOOTH, fading)[-1], method)
    for method in ("taylor", "taylor_quadruple"):
        error = refusal(copy, f"{text}&integration method = '{method}' /")
        assert "those with these effects have none" in error


@each("key, moment", ("decaying_torque", decaying), ("fading_torque", fading))
def test_sweep_takes_the_effect_one_by_one(copy: Spin, key: str, moment: Moment) -> None:
    """Lanes leave the cases that they do not know."""
    text = scene(
        SMOOTH,
        f"torque_body = 0.1, 0, 0 decay_rate = {RATE} {key} = 0, {TORQUE[1]}, {TORQUE[2]}",
        f"&study kind = 'sweep' /\n&sweep parameter = 'effects.{key}(1)' from = 0 "
        f"to = {TORQUE[0]} count = 3 /\n"
        "&output columns = 'theta_end', 'com_z_min', 'com_z_max', 'energy_error_max' /",
    )
    for i, row in rows(copy, text).iterrows():
        scaled = np.array([i / 2, 1, 1])

        def torque(t: float, scaled: np.ndarray = scaled) -> np.ndarray:
            return scaled * moment(t) + np.array([0.1, 0, 0])

        check_extremes(row, path(SMOOTH, torque, 1500), 1e-7)
        assert row.energy_error_max < 1e-6


def check_extremes(row: pd.Series, states: np.ndarray, tolerance: float) -> None:
    """Compare the end and the extremes of the height with those of a motion."""
    ups = np.array([rotation(y[:4])[2] for y in states])
    heights = ups @ CENTRE
    assert abs(row.theta_end - math.acos(ups[-1, 2])) < tolerance
    assert [row.com_z_min, row.com_z_max] == pytest.approx([heights.min(), heights.max()], abs=1e-6)
    assert heights.max() > heights.min() + 0.05


def test_watch_in_lanes_and_alone(copy: Spin) -> None:
    """The new column is the same in lanes, and one by one by a method that has none."""
    sweep = "&study kind = 'sweep' /\n&sweep parameter = 'initial.omega(3)' values(1,:) = 9 /\n"
    columns = "&output columns = 'theta_end', 'com_z_min', 'com_z_max' /"
    for method in ("taylor", "dop853"):
        text = scene(SMOOTH, "", f"{sweep}&integration method = '{method}' {ADAPTIVE} /\n{columns}")
        still = path(SMOOTH, lambda _: np.zeros(3), 1500)
        check_extremes(rows(copy, text).iloc[0], still, 1e-9)


def test_watch_of_closed_forms(copy: Spin) -> None:
    """The new column of a symmetric top is that of its closed form."""
    top = (
        "&study kind = 'sweep' /\n&top mass = 1 inertia = 0.9, 0.9, 0.3 length = 0.5 /\n"
        "&initial theta = 0.5 omega3 = 9 /\n&span nutations = 3 /\n"
        "&sweep parameter = 'initial.omega3' from = 8 to = 12 count = 3 /\n"
        "&output columns = 'theta_min', 'theta_max', 'com_z_min', 'com_z_max' /\n"
    )
    found = rows(copy, top)
    for height, angle in (("com_z_max", "theta_min"), ("com_z_min", "theta_max")):
        assert list(found[height]) == pytest.approx(list(0.5 * np.cos(found[angle])), abs=1e-14)


def test_proof_does_not_enclose_the_effect(copy: Spin) -> None:
    """Balls do not know it, so nothing is proved of it."""
    columns = "&output columns = 't', 'omega3', 'omega3_bound' /"
    text = scene(SMOOTH, DECAYS, f"&integration {ADAPTIVE} /\n{columns}")
    if "has no FLINT" in refusal(copy, text):
        pytest.skip("this build has no FLINT")
    assert np.isinf(rows(copy, text, "--set", "span.samples=3").omega3_bound).all()


def test_method_converges(copy: Spin) -> None:
    """With half the step, an eighth of the error."""
    expected = path(SMOOTH, decaying)[-1]
    errors = []
    for steps in (400, 800, 1600):
        text = scene(SMOOTH, DECAYS, f"&integration method = 'heun_3' steps = {steps} /\n{COLUMNS}")
        end = rows(copy, text).iloc[-1][NAMES].to_numpy(dtype=float)
        errors.append(distance(end, expected))
    assert 7.5 < errors[0] / errors[1] < 8.5
    assert 7.5 < errors[1] / errors[2] < 8.5
