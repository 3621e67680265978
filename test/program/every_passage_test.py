"""Every passage of a quantity is an event, and nothing else: events against the rows of the motion.

The rows are so close that a polynomial through seven of them shows the quantity between them. A
quantity has passed its level where it was on one side, and then is on the other, further from it
than `CLEAR` times the relative tolerance (of a method with fixed steps: `FIXED`) of its largest
distance. Left out are the quantities that touch a level within that, or never leave it: between
such an instant and the next passage. So are those that the rows do not resolve: next to a pole,
before the second row, and where friction or a table bends the quantity near its level.
"""

import math
import random
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pytest

from conftest import each

COLUMNS = (
    "omega1", "omega2", "theta_rate", "axis_z_rate", "phi_rate", "psi_rate", "force_x", "force_n",
    "com_x", "axis_y", "gamma1", "gamma2", "omega_x", "theta", "omega3",
)  # fmt: skip
BY_FORCE = ("force_x", "force_n")
NEAR_POLES = ("theta_rate", "phi_rate", "psi_rate", "force_n")
POLE = 0.02
METHODS = {
    "taylor": 1e-13, "dop853": 1e-11, "ode45": 1e-10, "taylor_quadruple": 1e-16,
    "rk4": 0, "gauss_8": 0, "exact": 1e-15,
}  # fmt: skip
"""Methods, and their tolerances."""
CLEAR, LEAST, FIXED = 1e3, 1e-15, 1e-8
T_END, ROWS, SCENES = 3.0, 1501, 24
EFFECTS = (
    "damping", "drag", "dry", "smooth", "vibration", "earth", "rotor", "space", "body", "table",
)  # fmt: skip
TABLE = "t,m1,m2,m3\n0,0.1,0,0.2\n1,-0.3,0.2,0\n2,0.2,0.1,-0.3\n5,0,0,0\n"

REACH = np.linspace(-1, 1, 41)

Span = tuple[float, float]


@dataclass
class Scene:
    text: str
    levels: dict[str, float]
    is_symmetric: bool
    effects: list[str]


def draw(seed):
    dice = random.Random(seed)

    def number(low, high):
        return f"{dice.uniform(low, high):.4g}"

    symmetric = dice.random() < 0.4
    one, three = dice.uniform(0.5, 1), dice.uniform(0.1, 0.9)
    two = one if symmetric else dice.uniform(abs(one - three) + 0.02, one + three - 0.02)
    centre = f"length = {dice.choice([0.3, 0.5, -0.3])}"
    if not symmetric and dice.random() < 0.5:
        centre = "centre_of_mass = " + ", ".join(number(-0.3, 0.3) for _ in range(3))
    top = f"mass = 1  inertia = {one:.4g}, {two:.4g}, {three:.4g}  {centre}"
    effects = []
    if dice.random() < 0.6:
        effects = dice.sample(EFFECTS, dice.choice([1, 1, 2]))
    start, theta, spin = draw_start(dice, effects)
    if "damping" in effects:
        top += "  damping = 3*" + number(0.005, 0.05)
    text = f"&top {top} /\n&initial {start} /\n"
    forces = [force(dice, effect) for effect in effects if effect != "damping"]
    if forces:
        text += f"&effects {'  '.join(forces)} /\n"
    levels = {"theta": theta + dice.uniform(-0.1, 0.1), "omega3": spin * dice.uniform(0.9, 1.1)}
    return Scene(text, levels, symmetric, effects)


def draw_start(dice, effects):
    kind = dice.choice(["fast", "fast", "rest", "hanging", "any"])
    theta, spin = dice.uniform(0.3, 2.8), dice.uniform(5, 20) * dice.choice([1, -1])
    if kind == "fast":
        angles = f"phi = {dice.uniform(0, 3):.3g}  psi = {dice.uniform(0, 3):.3g}  "
        angles = (angles if dice.random() < 0.5 else "") + f"theta = {theta:.3g}"
        return f"{angles}  omega3 = {spin:.4g}", theta, spin
    if kind == "rest":
        return f"theta = {theta:.3g}", theta, 1.0
    if kind == "hanging" and effects:
        return "theta_deg = 180", math.pi, 1.0
    omega = [dice.uniform(-5, 5) for _ in range(3)]
    return f"theta = {theta:.3g}  omega = " + ", ".join(f"{x:.4g}" for x in omega), theta, omega[2]


def force(dice, effect):
    x, y, z = (f"{dice.uniform(-1, 1):.3g}" for _ in range(3))
    return {
        "drag": "drag_force = 0.05  drag_moment = 3*0.01",
        "dry": f"friction_torque = {dice.uniform(0.01, 0.4):.3g}",
        "smooth": "friction_torque = 0.1  friction_smoothing = 0.1",
        "vibration": f"vibration_amplitude = {x}e-1, 0, {z}e-1  vibration_rate = 7",
        "earth": "earth_rate = 0.5  latitude_deg = 40",
        "rotor": f"rotor_momentum = {x}, {y}, {z}",
        "space": f"torque_space_amplitude = {x}, {y}, 0  torque_space_rate = 3"
        "  torque_space_phase_deg = -90, 0, 0",
        "body": f"torque_body = {x}, {y}, {z}",
        "table": "torque_table = 'torque.csv'",
    }[effect]


def columns_of(scene):
    """The columns to look at: forces jump where friction or a table does."""
    jumps = any(effect in ("dry", "table") for effect in scene.effects)
    return [name for name in COLUMNS if not (jumps and name in BY_FORCE)]


def input_of(scene, method):
    columns = columns_of(scene)
    events = ["turning_points"] + [f"{name} = {scene.levels.get(name, 0.0)!r}" for name in columns]
    keys = f"method = '{method}'"
    if METHODS[method] > 0 and method != "exact":
        keys += "  relative_tolerance = {0}  absolute_tolerance = {0}".format(METHODS[method])
    if METHODS[method] == 0:
        keys += f"  steps = {ROWS - 1}"
    quoted = ", ".join(f"'{name}'" for name in ["t", *columns])
    named = ", ".join(f"'{name}'" for name in events)
    span = f"&span t_end = {T_END}  samples = {ROWS} /\n"
    output = f"&output columns = {quoted}  events = {named} /\n"
    return f"{scene.text}{span}&integration {keys} /\n{output}"


def run(spin, scene, method):
    """The rows, and the times of the events by their columns; none if the method cannot."""
    done = spin(input_of(scene, method), code=tuple(range(256)), torque=TABLE)
    if done.code != 0:
        return np.zeros((0, 0)), {}
    return done.rows.to_numpy(dtype=float), times_by_columns(done.table("events"))


def times_by_columns(events):
    found = {}
    for event, t in zip(events.event, events.t, strict=True):
        name = event.split(" ")[0].split("=")[0]
        name = "turning_points" if name.endswith("turning_point") else name
        found.setdefault(name, []).append(t)
    return found


@dataclass
class Passages:
    """Where a quantity passes its level: from when to when; and where it may or may not."""

    sure: list[Span] = field(default_factory=list)
    doubtful: list[Span] = field(default_factory=list)


@cache
def weights(place, step):
    """What values at 0, STEP, ... 6 contribute to those around a place, by a polynomial."""
    at = np.arange(0, 7, step) - place
    return np.linalg.solve(np.vander(at.astype(float)).T, np.vander(REACH, len(at)).T).T


def denser(t, v, least, *, is_smooth):
    """More points where the distance from the level is least, and where the rows do not suffice."""
    size = np.abs(v)
    bend = np.abs(v[:-2] - 2 * v[1:-1] + v[2:])
    is_low = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & (size[1:-1] < 2 * bend)
    one_side = (v[:-2] * v[1:-1] > 0) & (v[1:-1] * v[2:] > 0)
    low = np.flatnonzero(is_low & one_side & (bend > least)) + 1
    at, more, unclear = [t], [v], [(t[0], t[1])]
    for i in low:
        first = min(max(i - 3, 0), len(t) - 7)
        near = slice(first, first + 7)
        fine = weights(i - first, 1) @ v[near]
        coarse = weights(i - first, 2) @ v[near][::2]
        if not is_smooth or np.max(np.abs(coarse - fine)) > 0.2 * np.max(np.abs(v[i - 1 : i + 2])):
            unclear.append((t[max(i - 4, 0)], t[min(i + 4, len(t) - 1)]))
            continue
        j = min(max(np.argmin(np.abs(fine)), 1), len(fine) - 2)
        slope, bend = (fine[j + 1] - fine[j - 1]) / 2, fine[j + 1] - 2 * fine[j] + fine[j - 1]
        way = min(max(-slope / bend, -1), 1) if bend != 0 else 0.0
        place = REACH[j] + way * (REACH[1] - REACH[0])
        at.append(t[i] + np.append(REACH, place) * (t[1] - t[0]))
        more.append(np.append(fine, fine[j] + way * (slope + way * bend / 2)))
    times, values = np.concatenate(at), np.concatenate(more)
    order = np.argsort(times, kind="stable")
    return times[order], values[order], unclear


def passages(t, v, share, *, is_smooth):
    found = Passages()
    least = share * np.max(np.abs(v[np.isfinite(v)]), initial=1)
    jump = np.flatnonzero(~np.isfinite(v))
    v = np.where(np.isfinite(v), v, 0.0)
    t, v, unclear = denser(t, v, least, is_smooth=is_smooth)
    found.doubtful = unclear + [(t[max(i - 3, 0)], t[min(i + 3, len(t) - 1)]) for i in jump]
    clear = np.flatnonzero(np.abs(v) > least)
    i, j = clear[:-1], clear[1:]
    changes = (v[i] > 0) != (v[j] > 0)
    gaps = (j > i + 1) & ~changes
    found.sure = list(zip(t[i[changes]], t[j[changes]], strict=True))
    found.doubtful += list(zip(t[i[gaps]], t[j[gaps]], strict=True))
    ends = clear[[0, -1]] if len(clear) > 0 else [len(t) - 1, 0]
    found.doubtful += [(t[0], t[ends[0]]), (t[ends[1]], t[-1])]
    return found


def compare(t, v, events, share, *, is_smooth):
    """Passages without an event, events without a passage, and the number of sure passages."""
    truth = passages(t, v, share, is_smooth=is_smooth)
    slack = 0.02 * (t[1] - t[0])  # of the polynomials
    left = list(events)
    missed, looked = [], 0
    for first, last in truth.sure:
        if any(a <= last and b >= first for a, b in truth.doubtful):
            truth.doubtful.append((first, last))
            continue
        looked += 1
        here = [time for time in left if first - slack <= time <= last + slack]
        if not here:
            missed.append((first, last))
        else:
            left.remove(here[0])
    invented = [
        time for time in left if not any(a - slack <= time <= b + slack for a, b in truth.doubtful)
    ]
    return missed, invented, looked


def faults(spin, seed, method):
    """What is wrong with the events of a scene: texts; how many missed, invented, and right."""
    scene = draw(seed)
    table, found = run(spin, scene, method)
    if table.size == 0:
        return [], 0, 0, 0
    share = CLEAR * max(METHODS[method], LEAST) if METHODS[method] > 0 else FIXED
    is_smooth = not any(effect in ("dry", "table") for effect in scene.effects)
    told, missed, invented, total = [], 0, 0, 0
    columns = columns_of(scene)
    for name in ["turning_points", *columns]:
        column = "axis_z_rate" if name == "turning_points" else name
        v = table[:, 1 + columns.index(column)] - scene.levels.get(name, 0.0)
        if column in NEAR_POLES:
            v[np.sin(table[:, 1 + columns.index("theta")]) < POLE] = np.nan
        without, extra, looked = compare(
            table[:, 0], v, found.get(name, []), share, is_smooth=is_smooth
        )
        total += looked
        missed += len(without)
        invented += len(extra)
        if without or extra:
            told.append(f"{seed} {method} {name}: missed {without}, invented {extra}")
    return told, missed, invented, total


@each("method", *METHODS)
def test_every_passage_is_an_event(spin, method):
    drawn = enumerate(map(draw, range(SCENES)))
    exact = {seed for seed, scene in drawn if scene.is_symmetric and not scene.effects}
    scenes = sorted(exact) if method == "exact" else range(SCENES)
    results = [faults(spin, seed, method) for seed in scenes]
    assert [text for told, *_ in results for text in told] == []
    assert sum(total for *_, total in results) > 40 * len(scenes)


def times_of(spin, text, event):
    text += f"\n&output columns = 't'  events = '{event}' /\n"
    return list(spin(text, torque=TABLE).table("events").t)


HANGING = "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5 /\n&initial theta_deg = 180 /\n"
SWUNG = (
    "torque_space_amplitude = 1, 0, 0  torque_space_rate = 3  torque_space_phase_deg = -90, 0, 0"
)
PUSHED = f"{HANGING}&effects torque_space = 1, 0, 0 /\n&span t_end = 5 /"
KNOWN = {
    "after a short time": (
        "&top mass = 1  inertia = 0.9, 0.75, 0.3  length = -0.3 /\n"
        "&initial theta = 1.5  omega3 = 12 /\n&span t_end = 4 /",
        "omega2 = 0",
        [0.32069, 0.64148, 0.96228, 1.28297, 1.28605, 1.60366, 1.92445, 2.24525, 2.56594, 2.57211,
         2.88663, 3.20742, 3.52822, 3.84891, 3.85816],
    ),
    "soon after the start": (
        "&top mass = 1  inertia = 0.9, 0.9, 0.3  length = 0.5  damping = 3*0.01 /\n"
        "&initial phi = 0.2  theta = 0.5  psi = 1.5  omega3 = 15 /\n&span t_end = 0.6 /",
        "omega1 = 0", [0.00566, 0.25800, 0.51227],
    ),
    "after a start at the level": (
        "&top mass = 1  inertia = 0.9, 0.9, 0.6  length = 0.5 /\n"
        "&initial phi = 0.1  theta = 2.7  psi = 1.9  omega3 = 60 /\n&span t_end = 0.2 /",
        "turning_points", [0.07806, 0.15612],
    ),
    "of the axis after hanging": (PUSHED, "axis_z_rate = 0", [1.36398, 2.72796, 4.09194]),
    "of turning after hanging": (PUSHED, "turning_points", [1.36398, 2.72796, 4.09194]),
    "after rest by friction": (
        f"{HANGING}&effects friction_torque = 0.4  {SWUNG} /\n&span t_end = 3 /",
        "axis_y = 0", [1.66085, 2.81241],
    ),
    "of theta after hanging": (
        f"{HANGING}&effects {SWUNG} /\n&span t_end = 2 /", "theta_rate = 0", [1.18025, 1.69730],
    ),
}  # fmt: skip
"""Inputs, an event, and its times from a matrix of rotation by DOP853 with tolerance 1e-13."""


@each("method", "taylor", "dop853", "ode45", "taylor_quadruple")
@each("name", *KNOWN)
def test_known_times(spin, name, method):
    """Pairs of passages, and those after a start at rest or at the level."""
    text, event, times = KNOWN[name]
    keys = f"method = '{method}'  relative_tolerance = 1e-11  absolute_tolerance = 1e-12"
    found = times_of(spin, f"{text}\n&integration {keys} /", event)
    assert found == pytest.approx(times, abs=2e-5)


@each("method", "taylor", "dop853", "ode45", "exact")
def test_a_cusp_touches_zero(spin, method):
    """Precession from rest stops in each cusp; by errors of the method it turns there and back."""
    for omega3 in 30, 60, 200, 1000:
        text = (
            "&top mass = 1  inertia = 0.9, 0.9, 0.6  length = 0.5 /\n"
            f"&initial phi = 0.1  theta = 2.3  psi = 1.9  omega3 = {omega3} /\n"
            f"&span t_end = {50 / omega3} /\n&integration method = '{method}' /"
        )
        times = times_of(spin, text, "phi_rate = 0")
        assert len(times) % 2 == 0, omega3
        pairs = zip(times[::2], times[1::2], strict=True)
        assert all(last - first < 1e-2 / omega3 for first, last in pairs), omega3
        assert times == [] or method != "exact", spin


SWEEP = (
    "&study kind = 'sweep' /\n&sweep parameter = 'top.mass'  values(1,:) = 1, 1.1 /\n"
    "&output columns = 't_end' /\n"
)


@each("method", "auto", "taylor", "dop853", "gauss_8")
@each("after", 1, 4)
def test_sweeps_end_there(spin, method, after):
    keys = f"method = '{method}'" + ("  steps = 3000" if method == "gauss_8" else "")
    ends, expected = [], []
    stops = "omega1 = 0", "turning_points", "com_x = 0"
    listing = f"&output columns = 't'  events = {str(stops)[1:-1]} /\n"
    for seed in range(8):
        text = f"{draw(seed).text}&integration {keys} /\n&span t_end = {T_END}"
        found = times_by_columns(spin(f"{text} /\n{listing}", torque=TABLE).table("events"))
        for event in stops:
            times = found.get(event.removesuffix(" = 0"), [])
            expected.append(times[after - 1] if len(times) >= after else T_END)
            stop = f"  stop_at = '{event}'  stop_after = {after} /\n"
            ends.append(spin(text + stop + SWEEP, torque=TABLE).rows.t_end[0])
    assert ends == pytest.approx(expected, abs=1e-6)
