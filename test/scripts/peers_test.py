"""scripts/compare_peers: the equations that peers get, how they are run, table and figures."""

import dataclasses
import os
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from collections.abc import Callable
from pathlib import Path

import pytest

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "python")]

import pandas as pd  # noqa: E402

from peers import PEERS, batch, bodies, crew  # noqa: E402
from peers.equations import EQUATIONS, python_rates  # noqa: E402
from peers.problem import Problem  # noqa: E402
from peers.scene import SceneError, pose, read_scene  # noqa: E402
from peers.summary import as_time, cheapest, summarise  # noqa: E402
from spintop_figures.registry import FIGURES  # noqa: E402
from spintop_figures.tables.table import read_table  # noqa: E402

pytestmark = pytest.mark.slow

SHORT = """\
&study kind = 'trajectory' title = 'A short motion' /
&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 {more} /
&initial theta = 0.5 omega3 = 3 /
&span t_end = 1 /
"""
SEQUENCE = tuple(range(2, 18, 2))
"""Numbers of midpoint steps that are extrapolated, to order 16."""


def extrapolate(rates: Callable, y: list[float], t_end: float, steps: int) -> list[float]:
    """Integrate by Gragg's extrapolated midpoint rule, with a fixed step size."""
    size = t_end / steps
    for _ in range(steps):
        table: list[list[float]] = []
        for k, count in enumerate(SEQUENCE):
            row = midpoint(rates, y, size, count)
            for j in range(k):
                factor = (count / SEQUENCE[k - 1 - j]) ** 2 - 1
                older, table[j] = table[j], row
                row = [a + (a - b) / factor for a, b in zip(row, older, strict=True)]
            table.append(row)
        y = table[-1]
    return y


def midpoint(rates: Callable, y: list[float], size: float, count: int) -> list[float]:
    """Midpoint steps with Gragg's start."""
    h = size / count
    old, new = y, [a + h * f for a, f in zip(y, rates(0.0, y), strict=True)]
    for _ in range(count - 1):
        old, new = new, [a + 2 * h * f for a, f in zip(old, rates(0.0, new), strict=True)]
    return new


class PeersCase(unittest.TestCase):
    """Works in a folder that goes away."""

    def setUp(self) -> None:
        """Make the folder."""
        folder = tempfile.TemporaryDirectory(prefix="peers test ")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def put(self, more: str = "") -> Path:
        """An input of a short motion."""
        path = self.folder / "short.nml"
        path.write_text(SHORT.format(more=more))
        return path

    def pose(self, path: Path, *overrides: str) -> Problem:
        """The problem of an input."""
        return pose(read_scene(path.stem, path, list(overrides)), self.folder)

    def compare(self, *arguments: object, **environment: str) -> subprocess.CompletedProcess:
        """Run the script."""
        command = [sys.executable, ROOT / "scripts/compare_peers", "-o", self.folder, *arguments]
        return subprocess.run(
            list(map(str, command)),
            capture_output=True,
            text=True,
            timeout=1200,
            check=False,
            env=os.environ | environment,
        )


class EquationsTest(PeersCase):
    """The peers solve the motion of spintop."""

    def check(self, problem: Problem, count: int, steps: int) -> None:
        """All equations that suit the problem end where spintop does."""
        suited = [form for form in EQUATIONS.values() if form.suits(problem)]
        self.assertEqual(len(suited), count)
        for form in suited:
            with self.subTest(form.name):
                constants, start = form.start(problem)
                y = extrapolate(python_rates(form, constants), start, problem.t_end, steps)
                self.assertLess(problem.orientation_error(form.attitude(problem, y)), 1e-12)
                self.assertLess(problem.tip_error(form.attitude(problem, y)), 1e-12)

    def test_symmetric(self) -> None:
        """A symmetric top, whose body spintop gives."""
        problem = self.pose(self.put())
        self.assertEqual(problem.inertia, (0.875, 0.875, 0.25))
        self.assertEqual(problem.weight[:2], (0, 0))
        self.assertAlmostEqual(problem.weight[2], 9.81 * 0.8660254037844387, delta=2e-15)
        self.check(problem, 3, 16)

    def test_other_axis(self) -> None:
        """A top whose axis is body y, given about its centre of mass: its axes are renamed."""
        problem = self.pose(ROOT / "input/heavy_top_benchmark.nml", "span.t_end=0.1")
        self.assertEqual(problem.inertia, (15.234375, 15.234375, 0.46875))
        self.check(problem, 3, 16)

    def test_any_body(self) -> None:
        """A damped body without symmetry, its centre of mass off the axes."""
        more = "damping = 0.1, 0.2, 0.05"
        path = self.put(more)
        path.write_text(
            path.read_text()
            .replace("0.875, 0.875", "0.9, 0.7")
            .replace("length = 0.8660254037844387", "centre_of_mass = 0.1, 0.2, 0.5")
        )
        problem = self.pose(path)
        self.assertFalse(problem.is_symmetric)
        self.check(problem, 1, 16)

    def test_symmetry_is_not_used(self) -> None:
        """A symmetric top as any other body has one form of equations, with the same end."""
        problem = self.pose(self.put())
        general = dataclasses.replace(problem, general=True)
        self.assertFalse(general.is_symmetric)
        self.check(general, 1, 16)

    def test_sweep(self) -> None:
        """A sweep is no problem."""
        with self.assertRaisesRegex(SceneError, "sweep"):
            self.pose(ROOT / "input/map_spin_tilt.nml")


class CrewTest(PeersCase):
    """Peers do their work, or are found out."""

    def work(self, name: str, setting: float, limit: float) -> None:
        """A peer comes close to the motion with each method under all equations."""
        worker = crew.Worker(name)
        self.addCleanup(worker.stop)
        if absence := worker.absence():
            self.skipTest(absence)
        problem = self.pose(self.put())
        for method in worker.peer.METHODS:
            for form in worker.peer.FORMULATIONS:
                with self.subTest(f"{method}/{form}"):
                    trial = crew.try_one(worker, problem, method, form, setting, 60)
                    self.assertEqual(trial.status, "ok", trial.remark)
                    error = problem.orientation_error(trial.answer["quaternion"])
                    self.assertLess(error, limit)
                    self.assertGreater(trial.answer["time_s"], 0)

    def test_sundials(self) -> None:
        """SUNDIALS, which is always there, from C."""
        self.work("sundials", 1e-10, 1e-5)

    def test_odeint(self) -> None:
        """Boost.odeint from C++, where it is there."""
        self.work("odeint", 1e-10, 1e-6)

    def test_scipy(self) -> None:
        """SciPy, where it is there."""
        self.work("scipy", 1e-10, 1e-6)

    def test_heyoka(self) -> None:
        """heyoka, where it is there."""
        self.work("heyoka", 1e-10, 1e-8)

    def test_octave(self) -> None:
        """GNU Octave, where it is there."""
        self.work("octave", 1e-8, 1e-5)

    def test_mujoco(self) -> None:
        """MuJoCo, where it is there, one of whose methods is of order one."""
        self.work("mujoco", 10000, 1e-2)

    def test_every_peer_is_tried(self) -> None:
        """Each peer has a test of its own above."""
        for name in PEERS:
            self.assertTrue(hasattr(self, f"test_{name}"), name)

    def fail_with(self, script: str) -> crew.Trial:
        """The trial of a peer whose process says that it is there, and then does this."""
        path = self.folder / "worker.py"
        path.write_text('print(\'{"absence": "", "versions": ""}\', flush=True)\n' + script)
        problem = self.pose(self.put())
        with unittest.mock.patch.object(crew, "WORKER", path):
            worker = crew.Worker("scipy")
            self.addCleanup(worker.stop)
            self.assertEqual(worker.absence(), "")
            return crew.try_one(worker, problem, "scipy_rk45", "space_frame", 1e-3, 1.0)

    def test_hanging_and_crashing(self) -> None:
        """A peer that hangs is stopped, one that dies is seen to, one that fails says why."""
        self.assertEqual(self.fail_with("import time\ntime.sleep(60)").status, "out_of_time")
        crash = "import os\ninput()\nos.kill(os.getpid(), 11)"
        self.assertEqual(self.fail_with(crash).status, "crashed")
        self.assertEqual(self.fail_with("").status, "crashed")
        trial = self.fail_with('input()\nprint(\'{"failure": "a pole"}\', flush=True)')
        self.assertEqual((trial.status, trial.remark, trial.answer), ("failed", "a pole", {}))


class BatchTest(PeersCase):
    """Many bodies at once."""

    def work(self, name: str) -> None:
        """A peer's ends of a few bodies are those of spintop in quadruple precision."""
        worker = crew.Worker(name)
        self.addCleanup(worker.stop)
        if absence := worker.absence():
            self.skipTest(absence)
        right = bodies.run_reference(self.folder, "1", 2500)
        self.assertEqual(len(right), 4)
        for method in worker.peer.BATCHES:
            question = {"t_end": 1.0, "every": 2500, "method": method, "setting": 1e-12}
            answer = worker.ask({"batch": question}, 300)
            self.assertNotIn("failure", answer)
            self.assertLess(bodies.judge(answer["ends"], right).largest, 1e-9)
            self.assertGreater(answer["time_s"], 0)

    def test_odeint(self) -> None:
        """Boost.odeint, sixteen bodies as one system, where it is there."""
        self.work("odeint")

    def test_heyoka(self) -> None:
        """heyoka, a vector of bodies at once, where it is there."""
        self.work("heyoka")

    def test_own_lanes(self) -> None:
        """The lanes of spintop, judged in the same way."""
        right = bodies.run_reference(self.folder, "1", 2500)
        scene = bodies.write_scene(self.folder, "few_bodies", 2500)
        angles, seconds = bodies.run(scene, 1, "1", "1e-12")
        errors = bodies.judge(list(map(bodies.quaternion_of, angles)), right)
        self.assertLess(errors.largest, 1e-9)
        self.assertLessEqual(errors.median, errors.most)
        self.assertGreater(seconds, 0)

    def test_summary(self) -> None:
        """At an error a program has the rate of its fastest setting that is good enough."""
        columns = ["problem", "program", "method", "tolerance", "median", "most", "largest"]
        rows = pd.DataFrame(
            [
                ["bodies", "spintop", "lanes", 1e-11, 1e-12, 9e-9, 1e-7, 0.1, 1e5],
                ["bodies", "spintop", "lanes", 1e-12, 1e-13, 9e-11, 1e-8, 0.2, 5e4],
                ["bodies", "heyoka", "heyoka_8", 1e-11, 1e-12, 8e-11, 1e-8, 0.25, 4e4],
                ["bodies_short", "heyoka", "heyoka_8", 1e-11, 1e-12, 1e-9, 1e-8, 0.25, 4e4],
            ],
            columns=[*columns, "time_s", "cases_per_s"],
        )
        lines = batch.summarise_batches(rows).splitlines()[2:]
        none = batch.NONE
        expected = [["100,000", "40,000", "2.50 |"], ["50,000", "40,000", "1.25 |"]]
        expected += [[none, none, f"{none} |"]]
        self.assertEqual([line.split(" | ")[1:] for line in lines], expected)


class ScriptTest(PeersCase):
    """Runs the script."""

    def test_comparison(self) -> None:
        """The table has all rows, can be read and drawn, and has a summary."""
        result = self.compare("--quick", "--budget", 200, "--peers", "sundials,scipy", self.put())
        self.assertEqual(result.returncode, 0, result.stderr)
        table = read_table(self.folder / "peers.csv")
        self.assertEqual(table.kind, "work_precision")
        rows = table.rows
        self.assertEqual(set(rows["problem"]), {"short"})
        self.assertIn("SUNDIALS", table.header["peer sundials"])
        for program in ("spintop", "SUNDIALS"):
            mine = rows[(rows["program"] == program) & (rows["status"] == "ok")]
            self.assertGreater(len(mine), 5)
            self.assertLess(mine["orientation_error"].min(), 1e-6)
            self.assertTrue((mine["time_s"] > 0).all())
        exact = rows[rows["method"] == "exact"].iloc[0]
        self.assertLess(exact["orientation_error"], 1e-14)
        front = rows[(rows["front"] == "yes") & (rows["method"] != "exact")]
        self.assertTrue(front["orientation_error"].is_monotonic_decreasing)
        self.assertTrue(front["time_s"].is_monotonic_increasing)
        (kind,) = (kind for kind in FIGURES if kind.name == "peers")
        self.assertEqual(kind.refusal(table), "")
        self.assertGreater((self.folder / "peers_short.png").stat().st_size, 10_000)
        self.assertIn("| 1e-06 |", result.stdout)
        self.assertIn("| SUNDIALS |", result.stdout)
        self.assertEqual(summarise(rows).count("\n| 1e-"), 10)
        good = cheapest(rows[rows["program"] == "SUNDIALS"], 1e-3)
        self.assertLessEqual(good["orientation_error"], 1e-3)
        self.assertIsNone(cheapest(rows, 0.0))

    def test_nothing_is_there(self) -> None:
        """Without compilers and Octave their peers are left out, and spintop is measured."""
        names = "odeint,octave,sundials"
        result = self.compare("--quick", "--peers", names, self.put(), PATH=str(self.folder))
        self.assertEqual(result.returncode, 0, result.stderr)
        for name in ("Boost.odeint", "GNU Octave", "SUNDIALS"):
            self.assertIn(f"{name} is left out: ", result.stderr)
        rows = read_table(self.folder / "peers.csv").rows
        self.assertEqual(set(rows["program"]), {"spintop"})

    def test_complaints(self) -> None:
        """An error has a message of one line, and nothing is written."""
        for arguments, message in (
            (["--peers", "scipi"], "there is no peer scipi; there are scipy, heyoka"),
            (["--set", "span.t_end=1"], "--set and --general need an input"),
            (["--batch", self.put()], "--batch takes no input"),
            ([ROOT / "input/map_spin_tilt.nml"], "has a sweep"),
            ([self.folder / "missing.nml"], "missing.nml"),
        ):
            with self.subTest(message):
                result = self.compare("--quick", *arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(message, result.stderr)
                self.assertFalse((self.folder / "peers.csv").exists())

    def test_times_in_words(self) -> None:
        """Three digits and a unit."""
        texts = {2.5e-7: "0.250 us", 9.996e-4: "1.00 ms", 0.0123: "12.3 ms", 123.4: "123 s"}
        for seconds, text in texts.items():
            self.assertEqual(as_time(seconds), text)


if __name__ == "__main__":
    unittest.main()
