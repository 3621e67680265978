"""A row of a sweep has the same bytes beside any others: in any order, block, shard and thread."""

import itertools
import json
import os
import random
import subprocess
from pathlib import Path

import pytest

PROGRAM = os.environ.get("SPINTOP_EXE", "build/release/spintop")
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


def named(name: str, values: list[float]) -> dict[str, float]:
    """The components of a vector."""
    return {f"{name}({i})": value for i, value in enumerate(values, 1)}


def draw_body(rng: random.Random) -> dict[str, float]:
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
    return (
        named("top.inertia", inertia)
        | named("top.centre_of_mass", centre)
        | named("top.damping", damping)
    )


def draw_start(rng: random.Random) -> dict[str, float]:
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


def draw_effects(rng: random.Random) -> dict[str, float]:
    """Up to three effects."""
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


def sweep_columns() -> list[str]:
    """All columns of a sweep but proofs, which are of one case each."""
    done = subprocess.run([PROGRAM, "list", "columns", "--json"], capture_output=True, check=True)
    columns = [one for one in json.loads(done.stdout)["columns"] if one["study"] == "sweep"]
    return [one["name"] for one in columns if one["group"] != "proof"]


class Sweep:
    """Sweeps over tables of cases."""

    def __init__(self, folder: Path, columns: list[str], span: str, effects: str) -> None:
        """The same columns, span and further effects of all."""
        self.folder = folder
        names = ", ".join(f"'{name}'" for name in columns)
        self.text = (
            "&study kind = 'sweep' /\n&sweep table = 'cases.csv' /\n&top mass = 1 /\n"
            f"&initial psi = 0.1 /\n&span t_end = 1  {span} /\n&effects {effects} /\n"
            f"&integration relative_tolerance = 1e-5 /\n&output columns = {names} /\n"
        )

    def run(self, *arguments: str) -> None:
        """Run the program."""
        command = [PROGRAM, *arguments]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode in (0, 3), done.stderr

    def rows(self, cases: list[dict], *options: str) -> list[str]:
        """The rows of cases, without their numbers."""
        lines = [",".join(f'"{name}"' for name in cases[0])]
        lines += [",".join(repr(float(value)) for value in case.values()) for case in cases]
        (self.folder / "cases.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (self.folder / "a.nml").write_text(self.text, encoding="utf-8")
        self.run("--quiet", "--restart", "-o", "out", *options, "a.nml")
        return self.read("a.csv")

    def shards(self, parts: int) -> list[str]:
        """The rows of the cases of the last run in as many shards."""
        for i in range(parts):
            self.run("--quiet", "--restart", "-o", "out", "--shard", f"{i + 1}/{parts}", "a.nml")
        names = [str(path) for path in sorted((self.folder / "out").glob(f"a.*of*{parts}*.csv"))]
        assert len(names) == parts, sorted((self.folder / "out").iterdir())
        self.run("merge", "out/merged.csv", *names)
        return self.read("merged.csv")

    def read(self, name: str) -> list[str]:
        """The rows of a table."""
        lines = (self.folder / "out" / name).read_text(encoding="utf-8").splitlines()
        table = [line for line in lines if not line.startswith("#")]
        self.head = table[0]
        return [line.split(",", 1)[1] for line in table[1:]]


@pytest.mark.parametrize(("affected", "span"), list(itertools.product((False, True), STOPS)))
def test_any_neighbour(tmp_path: Path, affected: bool, span: str) -> None:
    """All columns that a body in lanes can have, of bodies of all kinds."""
    rng = random.Random(6)
    cases = [
        draw_body(rng) | draw_start(rng) | (draw_effects(rng) if affected else {})
        for _ in range(CASES)
    ]
    columns = [name for name in sweep_columns() if not (affected and name in NEEDS_PLAIN)]
    sweep = Sweep(tmp_path, columns, span, "latitude = 0.5" if affected else "")
    known = sweep.rows(cases, "--threads", "1")
    assert len(known) == CASES
    assert sum(",ok," in row for row in known) > CASES / 2
    for threads in ("2", "3"):
        assert sweep.rows(cases, "--threads", threads) == known
    assert sweep.shards(3) == known
    for size in [CASES, *(rng.randint(1, 64) for _ in range(BLOCKS))]:
        order = rng.sample(range(CASES), size)
        rows = sweep.rows([cases[i] for i in order], "--threads", "1")
        assert rows == [known[i] for i in order], sweep.head
