"""What figures and the live top assume of a scene: they are left out where it does not hold."""

import math
from pathlib import Path

from conftest import ROOT, Spin, each, listed
from plot_case import a_trajectory
from reporting.live_link import live_link
from spintop_figures.motion.reduced import find_reduced
from spintop_figures.motion.trajectory import draw_forces, inclination_extremes
from spintop_figures.moving.assumptions import AUXILIARY, broken, no_effects, symmetric, undamped
from spintop_figures.moving.body import read_body
from spintop_figures.moving.motion import find_omega, scene_of
from spintop_figures.registry import COMPARISONS, FIGURES
from spintop_figures.tables.table import Table, read_table

BESIDE = {
    "friction_coefficient": ["friction_radius=1e-3"],
    "vibration_amplitude": ["vibration_rate=60"],
    "torque_body_amplitude": ["torque_body_rate=60"],
    "torque_space_amplitude": ["torque_space_rate=60"],
    "earth_rate": ["latitude_deg=50"],
}
"""What else a key of &effects needs."""
TABLES = {
    "friction_table": "omega3,friction_torque\n0,0.01\n100,0.02\n",
    "torque_table": "t,m1,m2,m3\n0,0.1,0,0\n100,0.1,0,0\n",
}
"""Keys whose value is a file, with its contents."""
STRONG = {"earth_rate": 1e-4}
"""Values of keys in place of 0.02, which would be too large."""


EFFECTS = [entry for entry in listed("parameters") if entry["group"] == "effects"]
SIZES = {
    entry["key"]: 3 if entry["full_name"].endswith("(3)") else 1
    for entry in EFFECTS
    if not AUXILIARY.fullmatch(f"effects.{entry['key']}")
}
"""How many numbers each key has that gives an effect its strength."""
TOP = """&study kind = 'trajectory' /
&top mass = 1.0 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 /
&initial theta_deg = 11.25 psi_rate = 1.0 /
&span t_end = 3 samples = 301 /
"""
NEAR = 0.02
"""Radians by which coarse steps of the methods of the paper exceed the turning points."""
LEFT_OUT = ("long_drift", "certified_top", "uncertain_top")
"""Inputs that take long, or that builds without FLINT refuse."""
CONDITIONAL = [kind for kind in (*FIGURES, *COMPARISONS) if kind.assumes]


def compute(folder: Path, name: str, *settings: str) -> Table:
    run = Spin(folder)(name, *settings, "--quiet", "--output=.", name="top", code=(0, 3))
    return read_table(run.path)


def offered(table: Table) -> set[str]:
    return {kind.name for kind in CONDITIONAL if not kind.refusal(table)}


def test_figures_with_assumptions() -> None:
    """Those of the reduced motion, of first integrals, and of formulas for a symmetric top."""
    names = {kind.name for kind in CONDITIONAL}
    reduced = {"potential", "portrait", "bifurcation"}
    assert names == reduced | {"residuals", "drift", "sweep", "table1"}


@each("key", *SIZES)
def test_effects(folder: Path, key: str) -> None:
    """Each effect breaks the assumptions of figures and of the live top."""
    value = ",".join([f"{STRONG.get(key, 0.02)}"] * SIZES[key])
    if key in TABLES:
        path = folder / "effect.csv"
        path.write_text(TABLES[key], encoding="utf-8")
        value = f"'{path}'"
    beside = [f"effects.{setting}" for setting in BESIDE.get(key, [])]
    table = compute(folder, TOP, f"effects.{key}={value}", *beside)
    assert key in no_effects(table)
    assert offered(table) == set()
    assert bool(live_link(table)) == (key == "friction_torque")
    assert all(end.of_rows for end in inclination_extremes(table))
    plain = compute(folder, TOP)
    assert offered(plain) >= {"potential", "portrait"}
    assert live_link(plain)
    scenes = {scene_of(each, read_body(each), find_omega(each)) for each in (table, plain)}
    assert len(scenes) == 2


def test_effects_of_no_strength(folder: Path) -> None:
    """Effects that are zero, and keys that only say how one would act, break nothing."""
    zeros = {key: ",".join(["0"] * size) for key, size in SIZES.items() if key not in TABLES}
    settings = [f"{key}={value}" for key, value in zeros.items()]
    settings += [setting for more in BESIDE.values() for setting in more]
    table = compute(folder, TOP, *(f"effects.{setting}" for setting in settings))
    assert broken((no_effects,), table) == ""
    assert {"potential", "portrait"} <= offered(table)
    assert live_link(table)


def test_damping_and_bodies(folder: Path) -> None:
    damped = compute(folder, "damped_top")
    assert undamped(damped) and offered(damped) == set()
    assert "damping1=0.1&damping3=0.01" in live_link(damped)
    chaotic = compute(folder, "rigid_body_chaotic")
    assert symmetric(chaotic) and live_link(chaotic).startswith("shape=")
    assert "amplitude=0.15&vibration_rate=60" in live_link(compute(folder, "kapitza"))
    aside = ("effects.vibration_amplitude=0.1,0,0", "effects.vibration_rate=60")
    assert live_link(compute(folder, TOP, *aside)) == ""
    late = ("effects.vibration_amplitude=0,0,0.1", "effects.vibration_phase_deg=0,0,90", aside[1])
    assert live_link(compute(folder, TOP, *late)) == ""
    assert live_link(compute(folder, TOP, "effects.friction_torque=0.01", *late[::2])) == ""
    assert not offered(chaotic) & {"potential", "portrait"}


def test_all_inputs(folder: Path) -> None:
    """For every trajectory the turning points of the potential are those of the motion."""
    for path in sorted((ROOT / "input").glob("*.nml")):
        if "'trajectory'" in path.read_text(encoding="utf-8") and path.stem not in LEFT_OUT:
            table = compute(folder, path.stem)
            if "potential" in offered(table):
                reduced = find_reduced(table)
                if not isinstance(reduced, str):
                    least, largest = reduced.turning_points()
                    theta = table.rows["theta"].to_numpy(float)
                    assert least - NEAR < theta.min() and theta.max() < largest + NEAR


def test_swept_effects(folder: Path) -> None:
    axes = "&sweep parameter = 'effects.drag_force' from = 0 to = 0.1 count = 3 /\n"
    text = TOP.replace("'trajectory'", "'sweep'").replace("samples = 301", "")
    table = compute(folder, text + axes, "output.columns=theta_end")
    assert "effects.drag_force" in no_effects(table)


def zeros_in(table: Table) -> tuple[str, int]:
    """The title of the panel of the vertical force, and how many zeros are marked."""
    panel = draw_forces(table).axes[2]
    marks = [line for line in panel.lines if line.get_marker() == "o"]
    return panel.get_title("right"), sum(len(line.get_xdata()) for line in marks)


def test_zeros_of_the_force(folder: Path) -> None:
    """Zeros are marked where the inclination decides on them, and at few inclinations."""
    title, count = zeros_in(compute(folder, TOP))
    assert title.startswith("zero at") and count > 0
    assert zeros_in(compute(folder, "kapitza")) == ("", 0)
    path = folder / "noise.csv"
    for widest in (1.0, 0.01):
        text = a_trajectory(count=400)
        lines = text.splitlines()
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        names = lines[first].split(",")
        for i in range(400):
            cells = lines[first + 1 + i].split(",")
            cells[names.index("force_z")] = repr((-1) ** i * 1e-17)
            cells[names.index("theta")] = repr(0.5 + widest * math.sin(0.1 * i))
            lines[first + 1 + i] = ",".join(cells)
        path.write_text("\n".join([*lines, ""]), encoding="utf-8")
        assert zeros_in(read_table(path)) == ("", 0)
