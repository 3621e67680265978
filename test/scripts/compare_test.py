"""scripts/compare: equations and motions that programs get, how they are run, tables, figures."""

import dataclasses
import math
import subprocess
import sys
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from comparing import ENGINES, SOLVERS, bodies, crew, table
from comparing.equations import EQUATIONS, python_rates
from comparing.problem import MOTIONS, Problem
from comparing.scene import pose, true_motion, with_truth
from conftest import ROOT, execute
from program import ProgramError
from referencing.extrapolation import extrapolated
from spintop_figures.registry import FIGURES
from spintop_figures.tables.table import read_table

pytestmark = pytest.mark.slow

SHORT = """\
&study kind = 'trajectory' title = 'A short motion' /
&top mass = 1 inertia = 0.875, 0.875, 0.25 length = 0.8660254037844387 {more} /
&initial theta = 0.5 omega3 = 3 /
&span t_end = 1 /
"""
PROGRAMS = {program.module: program for program in (*SOLVERS, *ENGINES)}


@pytest.mark.usefixtures("folder")
class CompareCase(unittest.TestCase):
    def put(self, more: str = "") -> Path:
        path = self.folder / "short.nml"
        path.write_text(SHORT.format(more=more))
        return path

    def pose(self, path: Path, *overrides: str) -> Problem:
        return pose(path.stem, path, list(overrides), self.folder)

    def compare(
        self, *arguments: object, code: int = 0, **environment: str
    ) -> subprocess.CompletedProcess:
        command = (sys.executable, ROOT / "scripts/compare", "-o", self.folder, *arguments)
        return execute(*command, code=code, environment=environment)


class CompareTest(CompareCase):
    def check(self, problem: Problem, count: int, steps: int) -> None:
        """All equations that suit the problem end where spintop does."""
        suited = [form for form in EQUATIONS.values() if form.suits(problem)]
        self.assertEqual(len(suited), count)
        for form in suited:
            with self.subTest(form.name):
                constants, start = form.start(problem)
                rates, y = python_rates(form, constants), np.array(start)
                for _ in range(steps):
                    y, _ = extrapolated(
                        lambda t, y, rates=rates: np.array(rates(t, y)),
                        0.0, y, problem.t_end / steps, [1.0] * len(y), 8,
                    )  # fmt: skip
                found = problem.judge([form.attitude(problem, y)])
                self.assertLess(found["orientation_error"], 1e-12)

    def test_symmetric(self) -> None:
        problem = self.pose(self.put())
        self.assertEqual(problem.inertia, (0.875, 0.875, 0.25))
        self.assertEqual(problem.weight[:2], [0, 0])
        self.assertAlmostEqual(problem.weight[2], 9.81 * 0.8660254037844387, delta=2e-15)
        self.check(problem, 3, 16)

    def test_other_axis(self) -> None:
        """A top whose axis is body y, given about its centre of mass: its axes are renamed."""
        problem = self.pose(ROOT / "input/heavy_top_benchmark.nml", "span.t_end=0.1")
        self.assertEqual(problem.inertia, (15.234375, 15.234375, 0.46875))
        self.check(problem, 3, 16)

    def test_any_body(self) -> None:
        path = self.put("damping = 0.1, 0.2, 0.05")
        text = path.read_text().replace("0.875, 0.875", "0.9, 0.7")
        centre = "centre_of_mass = 0.1, 0.2, 0.5"
        path.write_text(text.replace("length = 0.8660254037844387", centre))
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
        with self.assertRaisesRegex(ProgramError, "sweep"):
            self.pose(ROOT / "input/map_spin_tilt.nml")

    def start(self, name: str) -> crew.Worker:
        worker = crew.Worker(PROGRAMS[name])
        self.addCleanup(worker.stop)
        if absence := worker.absence():
            self.skipTest(absence)
        return worker

    def solve(self, name: str, setting: float, limit: float) -> None:
        """A solver comes close to the motion with each method under all equations."""
        worker, problem = self.start(name), self.pose(self.put())
        for method in worker.about["METHODS"]:
            for form in worker.about["FORMULATIONS"]:
                with self.subTest(f"{method}/{form}"):
                    trial = crew.try_one(worker, problem, method, form, setting, 60)
                    self.assertEqual(trial.status, "ok", trial.remark)
                    error = problem.judge(trial.answer["states"])["orientation_error"]
                    self.assertLess(error, limit)
                    self.assertGreater(trial.answer["time_s"], 0)

    def step(self, name: str, rate: float, limit: float) -> None:
        """The best method of an engine comes close to a free body, and a top if it has tops."""
        worker = self.start(name)
        for problem in (MOTIONS[1], MOTIONS[4]):
            problem = with_truth(problem, true_motion(problem.groups(), self.folder))
            found = []
            for method in worker.about["STEPPERS"]:
                trial = crew.try_one(worker, problem, method, "-", rate, 60)
                self.assertIn(trial.status, ("ok", "refused"), trial.remark)
                if trial.answer:
                    found.append(problem.judge(trial.answer["states"]))
            best = min(found, key=lambda errors: errors["orientation_error"])
            for what in ("orientation_error", "energy", "momentum"):
                self.assertLess(best[what], limit, what)

    def test_solvers(self) -> None:
        """Each, where it is there: SUNDIALS from C always is."""
        for name, setting, limit in (
            ("sundials", 1e-10, 1e-5), ("odeint", 1e-10, 1e-6), ("scipy", 1e-10, 1e-6),
            ("heyoka", 1e-10, 1e-8), ("mujoco", 10000, 1e-2),
        ):  # fmt: skip
            with self.subTest(name):
                self.solve(name, setting, limit)

    def test_engines(self) -> None:
        for name, setting, limit in (
            ("spintop", 1e-12, 1e-10), ("scipy", 200, 1e-9), ("mujoco", 500, 1e-6),
            ("drake", 500, 1e-6), ("exudyn", 500, 1e-1),
        ):  # fmt: skip
            with self.subTest(name):
                self.step(name, setting, limit)

    def test_many_bodies(self) -> None:
        """The ends of a few bodies are those of spintop in quadruple precision."""
        right = bodies.run_reference(self.folder, 1.0, 2500)
        self.assertEqual(len(right), 4)
        scene = bodies.write_scene(self.folder, "few_bodies", 2500)
        found = {"lanes": bodies.run(scene, 1, 1.0, 1e-12)[0]}
        for name in ("odeint", "heyoka"):
            with self.subTest(name):
                worker = self.start(name)
                for method in worker.about["BATCHES"]:
                    question = {"t_end": 1.0, "every": 2500, "method": method, "setting": 1e-12}
                    answer = worker.ask(question, 300)
                    self.assertEqual(answer.get("remark", ""), "")
                    found[method] = answer["states"]
        for method, ends in found.items():
            errors = bodies.judge(ends, right)
            self.assertLess(errors["largest"], 1e-9, method)
            self.assertLessEqual(errors["median"], errors["most"])

    def fail_with(self, script: str) -> crew.Trial:
        """The trial of a peer whose process says that it is there, and then does this."""
        path = self.folder / "worker.py"
        head = "import os, sys, time\nfrom multiprocessing.connection import Connection\n"
        tell = "pipe = Connection(int(sys.argv[2]))\npipe.send({'versions': ''})\n"
        path.write_text(head + tell + script)
        problem = self.pose(self.put())
        with unittest.mock.patch.object(crew, "WORKER", path):
            worker = crew.Worker(PROGRAMS["scipy"])
            self.addCleanup(worker.stop)
            self.assertEqual(worker.absence(), "")
            return crew.try_one(worker, problem, "scipy_rk45", "space_frame", 1e-3, 1.0)

    def test_hanging_and_crashing(self) -> None:
        """A peer that hangs is stopped, one that dies is seen to, one that fails says why."""
        self.assertEqual(self.fail_with("time.sleep(60)").status, "out_of_time")
        crash = "pipe.recv_bytes()\nos.kill(os.getpid(), 11)"
        self.assertEqual(self.fail_with(crash).status, "crashed")
        self.assertEqual(self.fail_with("").status, "crashed")
        failure = {"status": "failed", "remark": "a pole"}
        trial = self.fail_with(f"pipe.recv_bytes()\npipe.send({failure})")
        self.assertEqual((trial.status, trial.remark, trial.answer), ("failed", "a pole", {}))

    def test_comparison(self) -> None:
        """The table has all rows, can be read and drawn, and has a summary."""
        result = self.compare("--quick", "--budget", 200, "--programs", "SUNDIALS", self.put())
        whole = read_table(self.folder / "peers.csv")
        self.assertEqual(whole.kind, "work_precision")
        rows = whole.rows
        self.assertEqual(set(rows["problem"]), {"short"})
        self.assertIn("SUNDIALS", whole.header["peer sundials"])
        for program in ("spintop", "SUNDIALS"):
            mine = rows[(rows["program"] == program) & (rows["status"] == "ok")]
            self.assertGreater(len(mine), 5)
            self.assertLess(mine["orientation_error"].min(), 1e-6)
            self.assertTrue((mine["time_s"] > 0).all())
        exact = rows[rows["method"] == "exact"].iloc[0]
        self.assertLess(exact["orientation_error"], 1e-14)
        (kind,) = (kind for kind in FIGURES if kind.name == "peers")
        self.assertEqual(kind.refusal(whole), "")
        self.assertGreater((self.folder / "peers_short.png").stat().st_size, 10_000)
        self.assertIn("| 1e-06 |", result.stdout)
        self.assertIn("| SUNDIALS, relative to that |", result.stdout)
        good = table.cheapest(rows[rows["program"] == "SUNDIALS"], 1e-3)
        self.assertLessEqual(good["orientation_error"], 1e-3)
        self.assertIsNone(table.cheapest(rows, 0.0))

    def test_nothing_is_there(self) -> None:
        """Without compilers their peers are left out, and spintop is measured."""
        names = "Boost.odeint,SUNDIALS"
        result = self.compare("--quick", "--programs", names, self.put(), PATH=str(self.folder))
        for name in names.split(","):
            self.assertIn(f"{name} is left out: ", result.stderr)
        rows = read_table(self.folder / "peers.csv").rows
        self.assertEqual(set(rows["program"]), {"spintop"})

    def test_complaints(self) -> None:
        for arguments, message in (
            (["--programs", "scipi"], "there is no program scipi; there are SciPy, heyoka"),
            (["--engines", "--programs", "Mujoco"], "no program Mujoco; there are spintop"),
            (["--set", "span.t_end=1"], "--set and --general need an input"),
            (["--bodies", self.put()], "--bodies takes no input"),
            ([ROOT / "input/map_spin_tilt.nml"], "has a sweep"),
            ([self.folder / "missing.nml"], "missing.nml"),
        ):
            with self.subTest(message):
                self.assertIn(message, self.compare("--quick", *arguments, code=2).stderr)
                self.assertFalse((self.folder / "peers.csv").exists())


class TableTest(unittest.TestCase):
    def test_errors(self) -> None:
        motion = MOTIONS[0]
        problem = dataclasses.replace(motion, truth=[[1.0, 0.0, 0.0, 0.0]] * motion.samples)
        still = [2.0, 0.0, 0.0, 0.0, *motion.omega]
        last = [2 * math.cos(0.05), 0.0, 0.0, 2 * math.sin(0.05), *motion.omega]
        states = [still] * (motion.samples - 1) + [last]
        found = problem.judge(states)
        self.assertAlmostEqual(found["orientation_error"], 0.1, delta=1e-14)
        self.assertLess(found["energy"], 1e-15)
        self.assertGreater(found["momentum"], 0.01)
        for lost in (states[1:], [*states[1:], [math.nan] * 7]):
            self.assertEqual(problem.judge(lost), {"orientation_error": math.inf})

    def test_inertia(self) -> None:
        self.assertEqual(MOTIONS[5].inertia, (15.234375, 0.46875, 15.234375))
        self.assertEqual(MOTIONS[5].central, np.diag([0.234375, 0.46875, 0.234375]).tolist())

    def test_engines(self) -> None:
        """The order of made errors, and the page of the manual has all engines."""
        rows = pd.DataFrame(
            {"problem": name, "program": engine.name, "method": "m", "status": "ok", "rate": rate,
             "orientation_error": 100 / rate**2, "energy": 0.0, "momentum": 0.0,
             "time_s": rate * 5e-6}
            for engine in ENGINES for name in table.NAMES for rate in (100.0, 1000.0, 10000.0)
        )  # fmt: skip
        text = table.tell_engines(rows)
        self.assertIn("| MuJoCo | m | 2.0 | 0.0e+00 | 0.0e+00 | 1 | 1.0e-03 |", text)
        page = (ROOT / "doc/engines.md").read_text(encoding="utf-8")
        first = page[page.index("| engine | method |") :].split("\n\n")[0].splitlines()[2:]
        told = dict.fromkeys(line.strip("| ").split(" | ")[0] for line in first)
        names = [engine.name for engine in ENGINES]
        self.assertEqual([name for name in told if name in names], names)

    def test_bodies(self) -> None:
        """At an error a program has the rate of its fastest setting that is good enough."""
        names = ["problem", "program", "method", "setting", "median", "most", "largest", "time_s"]
        rows = pd.DataFrame(
            [
                ["bodies to 7 s", "spintop", "lanes", 1e-11, 1e-12, 9e-9, 1e-7, 0.1],
                ["bodies to 7 s", "spintop", "lanes", 1e-12, 1e-13, 9e-11, 1e-8, 0.2],
                ["bodies to 7 s", "heyoka", "heyoka_8", 1e-11, 1e-12, 8e-11, 1e-8, 0.25],
                ["bodies to 4 s", "heyoka", "heyoka_8", 1e-11, 1e-12, 1e-9, 1e-8, 0.25],
            ],
            columns=names,
        )
        lines = table.tell_bodies(rows).split("\n\n")[1].splitlines()[2:]
        none = table.NONE
        expected = [["100,000", "40,000", "2.50 |"], ["50,000", "40,000", "1.25 |"]]
        expected += [[none, none, f"{none} |"]]
        self.assertEqual([line.split(" | ")[1:] for line in lines], expected)

    def test_times_in_words(self) -> None:
        texts = {2.5e-7: "0.250 us", 9.996e-4: "1.00 ms", 0.0123: "12.3 ms", 123.4: "123 s"}
        for seconds, text in texts.items():
            self.assertEqual(table.as_time(seconds), text)
