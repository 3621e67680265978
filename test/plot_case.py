"""Shared by the tests of scripts/plot: artificial tables, a folder, calls of the script."""

import atexit
import math
import runpy
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import warnings
import xml.etree.ElementTree
from functools import cache
from pathlib import Path

import pytest

from conftest import Spin, called, execute
from figure_checks import problems_of
from spintop_figures import draw
from spintop_figures.registry import FIGURES
from spintop_figures.tables.table import Table, read_table

SCRIPTS = Path(__file__).resolve().parent.parent / "scripts"

HEAD = """\
# title: A top, {kind}: $5
# program: spintop 0.1.0
# format: 1
# revision: 0123456789ab-dirty
# compiler: GCC version 12.2.0
# options: -O3
# input:
#     &study
#         kind = '{kind}'
#         title = 'It''s a top, = {kind}'
#     /
#     &integration
#         formulation = 'lagrange'
#         method = 'rk4'
#         steps = 992
#     /
#     &sweep
#         values(1,:) = 0.5, 1.0,
#                       2.0
#     /
# columns:
#     t [s]: time
#     force_x [kg m/s^2]: support force: x
"""

TRAJECTORY = [
    *("t", "phi", "theta", "psi", "com_x", "com_y", "com_z", "kinetic", "potential", "energy"),
    *("R1", "R2", "R3", "R4", "force_x", "force_y", "force_z", "orientation_error"),
]
SWEEP = [
    *("case", "initial.spin_ratio", "status", "delta_u", "delta_u_fast_top", "nutation_rate"),
    *("nutation_rate_fast_top", "precession_rate", "precession_rate_fast_top"),
    *("nutations_per_turn", "nutations_per_turn_fast_top", "azimuth_after_period_deg"),
    *("phi_rate_max", "fast_top_ratio", "notes"),
]


def a_trajectory(columns: list[str] = TRAJECTORY, count: int = 40, **other: object) -> str:
    """A steady precession as a table; `other` gives columns other values."""
    lines = [HEAD.format(kind="trajectory") + ",".join(columns)]
    for i in range(count):
        t = 0.1 * i
        known = {"t": t, "phi": t, "theta": 0.5, "psi": 9 * t, "R4": 1e-12 * t, "R3": 0.0}
        known |= {"com_x": 0.5 * math.sin(t), "com_y": -0.5 * math.cos(t), "com_z": 0.8}
        known |= {"orientation_error": 1e-9 * t} | other
        lines.append(",".join(repr(known.get(name, 1.0)) for name in columns))
    return "\n".join([*lines, "# status: ok", ""])


def a_sweep(parameter: str = "initial.spin_ratio", status: str = "ok", cases: int = 4) -> str:
    """A sweep as a table; the last case has the status."""
    names = [parameter if name == "initial.spin_ratio" else name for name in SWEEP]
    lines = [HEAD.format(kind="sweep") + ",".join(names)]
    for i in range(1, cases + 1):
        good = i < cases or status == "ok"
        numbers = [repr(0.5 * i if good else math.nan)] * (len(names) - 4)
        lines.append(",".join([str(i), repr(i / 2), "ok" if good else status, *numbers, ""]))
    return "\n".join([*lines, ""])


def a_table(kind: str, columns: list[str], rows: list[list[object]]) -> str:
    lines = [",".join(map(str, row)) for row in [columns, *rows]]
    return HEAD.format(kind=kind) + "\n".join([*lines, ""])


MAP = [
    *("case", "initial.spin_ratio", "initial.theta_deg", "status", "motion_class", "theta_min"),
    *("theta_max", "growth_rate", "orientation_error", "evaluations", "notes"),
]


def a_map(across: int = 5, down: int = 4, axes: int = 2) -> str:
    """A sweep over a grid, or over its first parameter; the last case failed."""
    rows = []
    for i in range(across * down):
        x, y = divmod(i, down)
        good = i + 1 < across * down
        growth = 3.0 - x if x < 3 else 1e-16
        numbers = [0.1, 0.1 + 0.1 * y, growth, 10.0 ** (x - 9), 100 * (x + 1)]
        words = ["ok", "loop" if x > y else "wave"] if good else ["step_limit", "none"]
        rows.append([i + 1, 10.0**x, 10.0 * y, *words, *(numbers if good else 5 * ["nan"]), ""])
    rows = rows if axes == 2 else [row[:2] + row[3:] for row in rows[::down] + rows[-1:]]
    columns = MAP if axes == 2 else MAP[:2] + MAP[3:]
    return a_table("sweep", columns, rows)


CLOUD = ("initial.spin_ratio", "initial.theta_deg", "top.damping(3)", "span.t_end", "top.mass")


def a_cloud(parameters: int = 3, cases: int = 60, failing: int = 7, spacing: str = "log") -> str:
    """A sweep whose cases fill no grid; every so many cases one failed."""
    rows = []
    for i in range(cases):
        swept = [10 ** (2 * i / cases), *(1.0 + i * step % cases for step in (7, 11, 13, 17))]
        good = (i + 1) % failing > 0
        word = "loop" if i % 3 else "wave"
        numbers = [0.1, 0.2 + 0.01 * i, i % 5 - 2.0, 10.0 ** (i % 9 - 14), 50 + 3 * i]
        words = ["ok", word] if good else ["pole", "none"]
        cells = numbers if good else 5 * ["nan"]
        rows.append([i + 1, *swept[:parameters], *words, *cells, ""])
    names = ["motion_class", "theta_min", "theta_max", "growth_rate", "orientation_error"]
    columns = ["case", *CLOUD[:parameters], "status", *names, "evaluations", "notes"]
    listed = "values(1,:) = 0.5, 1.0,\n#                       2.0"
    drawn = f"combine = 'random'\n#         spacing = '{spacing}', 'linear'"
    return a_table("sweep", columns, rows).replace(listed, drawn)


TRIALS = [
    *("case", "method", "formulation", "verdict", "orientation_error", "inherent_error"),
    *("evaluations", "status", "reference", "reason"),
]


def a_stability() -> str:
    """Two cases with two methods, one of them under two formulations."""
    rows = [
        ["fall", "rk4", "space_frame", "accurate", 1e-8, 1e-15, 400, "ok", "exact solution", ""],
        ["fall", "rk4", "lagrange", "failed", 0.0, 1e-15, 3, "pole", "exact solution", "t: a pole"],
        ["fall", "new", "space_frame", "drifts", 3e-3, 1e-15, 90, "ok", "exact solution", "off"],
        ["tumble", "rk4", "rigid_body", "wrong", 2.0, 1e-12, 800, "ok", "quadruple", "off"],
        ["tumble", "rk4", "lagrange", "unsuitable", 0.0, 0.0, 0, "unsuitable", "quadruple", "no"],
        ["tumble", "new", "rigid_body", "accurate", 0.0, 1e-12, 100, "ok", "quadruple", ""],
    ]
    return a_table("stability", TRIALS, rows)


PRECISION = [
    *("problem", "method", "formulation", "setting", "orientation_error", "tip_error", "error_max"),
    *("steps", "rejected", "evaluations", "time_s", "energy_error", "status", "inherent_error"),
    *("front",),
]

STAGES = {
    ("euler_forward", "lagrange"): (1, 1), ("rk2", "lagrange"): (2, 2),
    ("rk4", "lagrange"): (4, 4), ("rk4", "rigid_body"): (4, 4),
    ("gauss_4", "space_frame"): (4, 8), ("gauss_8", "space_frame"): (8, 20),
    ("splitting_4", "space_frame"): (4, 6), ("splitting_8", "space_frame"): (8, 17),
    ("dop853", "lagrange"): (8, 12), ("dop853", "space_frame"): (8, 12),
    ("ode45", "lagrange"): (5, 6),
    ("taylor", "rigid_body"): (20, 20), ("heyoka", "space_frame"): (20, 20),
}  # fmt: skip
"""Orders and stages of made-up methods."""


def a_precision(problems: dict[str, float] | None = None, axes: tuple[str, ...] = ()) -> str:
    """Work and precision of methods whose errors are as their orders say.

    `problems` makes each of them so many times harder; `axes` are swept parameters, the values of
    which the names of the problems end with, after slashes.
    """
    rows = []
    for problem, hardness in (problems or {"top": 1.0}).items():
        swept = problem.split("/")[1:]
        exact = [problem, "exact", "closed_form", "-", 2e-15, 2e-15, 3e-15, 0, 0, 0, 2e-6, 0.0]
        rows.append([*exact, "ok", 1e-15, "yes", *swept])
        for (method, formulation), (order, stages) in STAGES.items():
            for power in range(5, 12):
                steps = 2**power
                equal = method[:3] not in ("dop", "ode", "tay", "hey")
                error = max(0.1 * (40 * hardness / steps) ** order, 1e-14)
                setting = f"steps {steps}" if equal else f"tolerance {steps**-4.0:.3e}"
                work = stages * steps
                numbers = [error, error / 2, 1.5 * error, steps, 0, work, 4e-8 * work, error / 9]
                words = [problem, method, formulation, setting]
                rows.append([*words, *numbers, "ok", 1e-15, "no", *swept])
        lost = [problem, "galerkin", "lagrange", "steps 9", *(["nan"] * 8), "not_solved"]
        rows.append([*lost, 1e-15, "no", *swept])
    return a_table("work_precision", [*PRECISION, *axes], rows)


def some_events(count: int = 25, swing: float = 0.1) -> str:
    """Events of two kinds, one of them often."""
    rows = [
        ["omega3=0 rising", i + 1, 0.1 * i, 0.5 + swing * math.cos(i), math.sin(i)]
        for i in range(count)
    ]
    rows += [["psi=0 rising", 1, 0.3, 0.5, 0.1]] if count else []
    columns = ["event", "number", "t", "theta", "theta_rate"]
    return a_table("trajectory", columns, rows) + "# status: ok\n"


@cache
def computed(name: str, *settings: str) -> Path:
    """A folder with the tables of an input, which is run once for all tests of a process."""
    folder = Path(tempfile.mkdtemp(prefix="spintop tables "))
    atexit.register(shutil.rmtree, folder)
    Spin(folder)(name, *settings, "--quiet", "--output=.", code=(0, 3))
    return folder


@pytest.mark.usefixtures("folder")
class TableCase(unittest.TestCase):
    """Works in a folder that goes away, whose name has a space."""

    def assert_good_look(self, table: Table, name: str, names: tuple[str, ...] = ()) -> None:
        """A reader of a figure has nothing to complain of, on a page and in a column.

        `names` are those of other programs, which look like keys.
        """
        for width in (None, "column"):
            with self.subTest(name=name, width=width), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = problems_of(draw(table, name, width=width))
                self.assertEqual([one for one in found if not one.startswith(names)], [])

    def put(self, name: str, text: str | bytes) -> Path:
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def read(self, text: str) -> Table:
        return read_table(self.put("a.csv", text))

    def compute(self, name: str, *settings: str) -> Table:
        shutil.copytree(computed(name, *settings), self.folder, dirs_exist_ok=True)
        return read_table(self.folder / f"{name}.csv")

    def refusal(self, name: str, table: Table) -> str:
        return next(kind for kind in FIGURES if kind.name == name).refusal(table)

    def plot(self, *arguments: str | Path, **environment: str) -> subprocess.CompletedProcess:
        words = (sys.executable, SCRIPTS / "plot", *arguments)
        return execute(*words, code=None, environment=environment)

    def call(self, *arguments: str | Path, code: int = 0) -> str:
        """Run its main procedure here, which is faster; give standard error."""
        script = str(SCRIPTS / "plot")
        with unittest.mock.patch("gc.disable"), unittest.mock.patch("atexit.register"):
            main = runpy.run_path(script)["main"]
        found, _, complaints = called(main, script, *arguments)
        assert found == code, complaints
        return complaints

    def figures_of(self, text: str) -> str:
        """Names of the figures that belong to a table."""
        table = read_table(self.put("table1_path.csv", text))
        return " ".join(kind.name for kind in FIGURES if not kind.refusal(table))

    def check_drawn(self, tables: dict[str, tuple[str, set[str]]]) -> None:
        """The script draws these figures of tables, without a warning of the layout."""
        paths = [self.put(f"{name}.csv", text) for name, (text, _) in tables.items()]
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            assert self.call(*paths) == ""
        expected = {f"{name}_{kind}" for name, (_, kinds) in tables.items() for kind in kinds}
        self.check_pictures(self.folder, expected)

    def check_pictures(self, folder: Path, expected: set[str]) -> None:
        """The folder holds these figures, as PNG and SVG with something on them."""
        names = {path.name for path in folder.iterdir() if path.suffix != ".csv"}
        self.assertEqual(names, {f"{name}.{end}" for name in expected for end in ("png", "svg")})
        for path in (folder / name for name in names):
            data = path.read_bytes()
            self.assertGreater(len(data), 10_000)
            if path.suffix == ".png":
                self.assertTrue(data.startswith(b"\x89PNG\r\n\x1a\n"))
            else:
                self.assertTrue(xml.etree.ElementTree.fromstring(data).tag.endswith("svg"))
