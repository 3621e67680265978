"""Programs at work: each in a process of its own, which may crash or hang without harm."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import Pipe
from pathlib import Path

from comparing import Program
from comparing.equations import EQUATIONS
from comparing.problem import Problem
from program import ROOT

WORKER = Path(__file__).resolve().parent / "worker.py"
VENV = ROOT / "build/compare/venv"
START_UP = 600.0
"""Seconds that a program may take to say what it is."""
PART, LEAST = 0.25, 1.0
"""A trial may take this part of the time that is left, or so many seconds."""
RATES = [j * 10**i for i in range(2, 6) for j in (1, 2, 5)]
"""Steps per second of the engines."""
SLOWEST = 300.0
"""Seconds that a trial of an engine may take."""
ENDS = ("out_of_time", "crashed", "refused")
"""After these a method is not tried any more."""


class LostError(Exception):
    """How a process was lost: `out_of_time` or `crashed`."""


class Worker:
    """A program in its process, in an empty folder. It is started when it is asked."""

    def __init__(self, program: Program) -> None:
        """Nothing is started yet."""
        self.program = program
        self.process: subprocess.Popen | None = None
        self.folder = tempfile.TemporaryDirectory(prefix="spintop-compare-")
        self.about: dict = {}

    def start(self) -> None:
        """Start the process, and have it say what it is."""
        python = VENV / "bin/python"
        self.pipe, theirs = Pipe()
        end = theirs.fileno()
        self.process = subprocess.Popen(
            [python if python.exists() else sys.executable, WORKER, self.program.module, str(end)],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env=os.environ | {"TMPDIR": self.folder.name, "OMP_NUM_THREADS": "1"},
            cwd=self.folder.name, pass_fds=[end], start_new_session=True,
        )  # fmt: skip
        theirs.close()
        self.about = self.hear(START_UP)

    def hear(self, seconds: float) -> dict:
        """The next answer, unless it takes longer than so many seconds."""
        how = "out_of_time"
        try:
            if self.pipe.poll(seconds):
                return self.pipe.recv()
        except (EOFError, OSError):
            how = "crashed"
        self.stop()
        raise LostError(how)

    def ask(self, question: dict, seconds: float) -> dict:
        """The answer to a question."""
        if self.process is None:
            self.start()
        with contextlib.suppress(OSError):  # it crashed, which is heard
            self.pipe.send(question)
        return self.hear(seconds)

    def stop(self) -> None:
        """End the process and all that it started."""
        if self.process is not None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            self.pipe.close()
            self.process = None

    def absence(self) -> str:
        """Why the program cannot be had; empty if it can."""
        try:
            if self.process is None:
                self.start()
        except LostError as error:
            return f"it could not be started: {error}"
        return self.about.get("absence", "")


@dataclass(frozen=True)
class Trial:
    """A method of a program with equations and a setting, what it found, and a remark."""

    program: str
    method: str
    formulation: str
    setting: float
    status: str
    answer: dict
    remark: str


def solve_all(worker: Worker, problem: Problem, budget: float, every: int) -> Iterator[Trial]:
    """All trials of a solver within a time, each method under each of the equations that suit.

    All have their cheap settings first, then the next, of which every so many are taken; those that
    hang or crash have no next one. No trial may take more than a part of the time that is left. The
    trial that is stopped then has status `out_of_time`.
    """
    about, end = worker.about, time.monotonic() + budget
    forms = [name for name in about["FORMULATIONS"] if EQUATIONS[name].suits(problem)]
    pairs = [(method, form) for form in forms for method in about["METHODS"]]
    for setting in about["SETTINGS"][::every]:
        for pair in list(pairs):
            left = end - time.monotonic()
            if left <= 0:
                return
            trial = try_one(worker, problem, *pair, setting, max(left * PART, LEAST))
            yield trial
            if trial.status in ENDS:
                pairs.remove(pair)


def step_all(worker: Worker, problem: Problem, budget: float) -> Iterator[Trial]:
    """All trials of an engine, with smaller steps, each method within processor time."""
    for method in worker.about["STEPPERS"]:
        left = budget
        for setting in worker.about["OWN_SETTINGS"].get(method, RATES):
            trial = try_one(worker, problem, method, "-", setting, SLOWEST)
            yield trial
            left -= trial.answer.get("spent_s", budget / len(RATES))
            if left <= 0 or trial.status in ENDS:
                break


def try_one(
    worker: Worker, problem: Problem, method: str, form: str, setting: float, seconds: float
) -> Trial:
    """One trial."""
    question = {"problem": problem, "method": method, "setting": setting}
    if form != "-":
        question["formulation"] = form
    try:
        answer = {"status": "ok", "remark": ""} | worker.ask(question, seconds)
    except LostError as error:
        answer = {"status": str(error), "remark": ""}
    status, remark = answer.pop("status"), answer.pop("remark")
    return Trial(worker.program.name, method, form, setting, status, answer, remark)


def install(programs: Sequence[Program]) -> None:
    """Install programs, each by itself: from PyPI into VENV, from Debian as root or by sudo."""
    if not VENV.exists():
        subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
    apt = [] if os.geteuid() == 0 else ["sudo"]
    apt += ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "install", "-qq", "-y"]
    commands = [[VENV / "bin/python", "-m", "pip", "install", "--quiet", *program.pip]
                for program in programs if program.pip]  # fmt: skip
    if shutil.which("apt-get"):
        commands += [[*apt, *program.debian] for program in programs if program.debian]
    for command in commands:
        if subprocess.run(command, stdout=sys.stderr, check=False).returncode:
            print(f"scripts/compare: {' '.join(map(str, command))} failed", file=sys.stderr)
