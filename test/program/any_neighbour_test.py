"""A row of a sweep has the same bytes beside any others: in any order, block, shard and thread."""

import itertools
import random

from conftest import each, listed, output

CASES = 97
BLOCKS = 5
VECTORS = ("drag_moment", "vibration_amplitude", "torque_space", "torque_body")
VECTORS += ("rotor_momentum", "rotor_torque")
SCALARS = {"drag_exponent": 1.0, "vibration_rate": 9.0, "drag_force": 0.0, "earth_rate": 0.0}
SCALARS |= {"friction_torque": 0.0}
EFFECTS = {f"effects.{name}({i})": 0.0 for name in VECTORS for i in (1, 2, 3)}
EFFECTS |= {f"effects.{name}": value for name, value in SCALARS.items()}
NEEDS_PLAIN = {"lyapunov_exponent", "largest_singular_value", "theta_rate_max"}
NEEDS_PLAIN |= {"force_max", "force_z_min", "force_z_max"}
"""Columns for which bodies with effects do not go in lanes."""
STOPS = ("", "stop_at = 'turning_points'  stop_after = 2", "stop_at = 'psi = 0.3'")
STOPS += ("stop_at = 'omega3 = 0.5'",)


def named(name, values):
    return {f"{name}({i})": value for i, value in enumerate(values, 1)}


def draw_body(rng):
    """A body: without symmetry, symmetric, a sphere, free; damped or not."""
    inertia = [rng.uniform(0.6, 1) for _ in range(3)]
    centre = [rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(0.2, 0.8)]
    kind = rng.randrange(6)
    if kind == 0:
        inertia[1], centre[:2] = inertia[0], [0, 0]
    elif kind == 1:
        inertia = [inertia[0]] * 3
    elif kind == 2:
        centre = [0, 0, 0]
    damping = [rng.choice([0, 0.02]) for _ in range(3)] if rng.random() < 0.4 else [0.0] * 3
    found = {"inertia": inertia, "centre_of_mass": centre, "damping": damping}
    return {
        name: x for key, values in found.items() for name, x in named(f"top.{key}", values).items()
    }


def draw_start(rng):
    """A start: fast, slow, at rest, next to a pole; of which some end soon, or fail soon."""
    theta = rng.uniform(0, 3.14)
    omega = [rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 8)]
    kind = rng.randrange(8)
    if kind == 0:
        theta = rng.choice([0, 1e-7, 1e-3, 3.141])
    elif kind == 1:
        omega = [0.0] * 3
    elif kind == 2:
        omega[2] = 0
    elif kind == 3:
        theta, omega = 1e-9, [0, 0, rng.uniform(0, 1)]
    fails = rng.random() < 0.1
    return named("initial.omega", omega) | {
        "initial.theta": theta,
        "span.t_end": rng.choice([0.1, 2, 5, 5, 20]),
        "integration.max_steps": rng.choice([3, 10, 30]) if fails else 100000,
    }


def draw_effects(rng):
    drag = [rng.choice([1e-3, 2e-2])] * 3
    if rng.random() < 0.5:
        drag = [rng.choice([0, 1e-3, 2e-3, 2e-2]) for _ in range(3)]
    choices = (
        named("effects.drag_moment", drag) | {"effects.drag_exponent": rng.choice([1, 1.5, 2, 3])},
        {"effects.drag_force": rng.choice([0.01, 0.1])},
        {"effects.earth_rate": 0.3},
        {"effects.vibration_amplitude(3)": 0.02},
        {"effects.vibration_amplitude(1)": 0.02},
        {"effects.torque_space(1)": 0.1},
        {"effects.torque_body(1)": rng.choice([0.1, -0.1])},
        {"effects.rotor_momentum(3)": 0.2},
        {"effects.rotor_torque(2)": 0.05},
        {"effects.friction_torque": rng.choice([0, 0.05])},
    )
    chosen = rng.sample(choices, rng.choice([0, 1, 1, 1, 2, 3]))
    return EFFECTS | {name: value for effect in chosen for name, value in effect.items()}


COLUMNS = [
    one["name"]
    for one in listed("columns")
    if one["study"] == "sweep" and one["group"] != "proof"  # which is of one case each
]


class Sweep:
    def __init__(self, spin, columns, span, effects):
        self.spin = spin
        self.text = (
            "&study kind = 'sweep' /\n&sweep table = 'cases.csv' /\n&top mass = 1 /\n"
            f"&initial psi = 0.1 /\n&span t_end = 1  {span} /\n&effects {effects} /\n"
            "&integration relative_tolerance = 1e-5 /\n" + output(*columns)
        )

    def rows(self, cases, threads=1):
        lines = [",".join(f'"{name}"' for name in cases[0])]
        lines += [",".join(repr(float(value)) for value in case.values()) for case in cases]
        table = "\n".join(lines) + "\n"
        run = self.spin(self.text, "--restart", f"--threads={threads}", code=(0, 3), cases=table)
        return rows_of(run.path)


def rows_of(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.split(",", 1)[1] for line in lines if not line.startswith("#")][1:]


@each("affected, span", *itertools.product((False, True), STOPS))
def test_any_neighbour(spin, affected, span):
    """All columns that a body in lanes can have, of bodies of all kinds."""
    rng = random.Random(6)
    cases = [
        draw_body(rng) | draw_start(rng) | (draw_effects(rng) if affected else {})
        for _ in range(CASES)
    ]
    columns = [name for name in COLUMNS if not (affected and name in NEEDS_PLAIN)]
    sweep = Sweep(spin, columns, span, "latitude = 0.5" if affected else "")
    known = sweep.rows(cases)
    assert len(known) == CASES
    assert sum(",ok," in row for row in known) > CASES / 2
    for threads in (2, 3):
        assert sweep.rows(cases, threads) == known
    parts = spin.parts(sweep.text, 3, "--restart", code=(0, 3))
    merged = spin.call("merge", "merged.csv", *parts, path="merged.csv", code=(0, 3))
    assert rows_of(merged.path) == known
    for size in [CASES, *(rng.randint(1, 64) for _ in range(BLOCKS))]:
        order = rng.sample(range(CASES), size)
        assert sweep.rows([cases[i] for i in order]) == [known[i] for i in order]
