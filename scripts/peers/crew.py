"""Peers at work: each in a process of its own, which may crash or hang without harm to the rest."""

import importlib
import json
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from peers.equations import EQUATIONS
from peers.problem import Problem
from peers.program import ROOT

WORKER = Path(__file__).resolve().parent / "worker.py"
VENV = ROOT / "build/peers/venv"
START_UP = 600.0
"""Seconds that a peer may take to say what it is."""


PART, LEAST = 0.25, 1.0
"""A trial may take this part of the time that is left, or so many seconds."""


class LostError(Exception):
    """How a process was lost: `out_of_time` or `crashed`."""


class Worker:
    """A peer in its process, in an empty folder. It is started when it is asked."""

    def __init__(self, name: str) -> None:
        """Nothing is started yet."""
        self.name = name
        self.peer: ModuleType = importlib.import_module(f"peers.{name}_peer")
        self.process: subprocess.Popen | None = None
        self.folder = tempfile.TemporaryDirectory(prefix="spintop-peer-")
        self.about: dict[str, str] = {}

    def start(self) -> None:
        """Start the process, and have it say what it is."""
        python = VENV / "bin/python"
        self.process = subprocess.Popen(
            [str(python if python.exists() else sys.executable), str(WORKER), self.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=self.folder.name,
            env=os.environ | {"TMPDIR": self.folder.name, "OMP_NUM_THREADS": "1"},
            start_new_session=True,
        )
        self.about = self.hear(START_UP)

    def hear(self, seconds: float) -> dict:
        """The next answer, unless it takes longer than so many seconds."""
        end, line = time.monotonic() + seconds, b""
        while not line.endswith(b"\n"):
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.process.stdout], [], [], left)[0]:
                self.stop()
                raise LostError("out_of_time")
            part = os.read(self.process.stdout.fileno(), 65536)
            if not part:
                self.stop()
                raise LostError("crashed")
            line += part
        return json.loads(line)

    def ask(self, question: dict, seconds: float) -> dict:
        """The answer to a question."""
        if self.process is None:
            self.start()
        try:
            self.process.stdin.write(json.dumps(question).encode() + b"\n")
            self.process.stdin.flush()
        except BrokenPipeError as error:
            self.stop()
            raise LostError("crashed") from error
        return self.hear(seconds)

    def stop(self) -> None:
        """End the process and all that it started."""
        if self.process is not None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.communicate()
            self.process = None

    def absence(self) -> str:
        """Why the peer cannot be had; empty if it can."""
        try:
            if self.process is None:
                self.start()
        except LostError as error:
            return f"it could not be started: {error}"
        return self.about["absence"]


@dataclass(frozen=True)
class Trial:
    """A method of a peer with equations and a setting, what it found, and a remark on a failure."""

    program: str
    method: str
    formulation: str
    setting: str
    status: str
    answer: dict
    remark: str = ""


def try_all(worker: Worker, problem: Problem, budget: float, every: int) -> Iterator[Trial]:
    """All trials of a peer within a time, each method under each of the equations that suit.

    All have their cheap settings first, then the next, of which every so many are taken; those that
    hang or crash have no next one. No trial may take more than a part of the time that is left. The
    trial that is stopped then has status `out_of_time`.
    """
    peer = worker.peer
    forms = [name for name in peer.FORMULATIONS if EQUATIONS[name].suits(problem)]
    pairs = [(method, form) for form in forms for method in peer.METHODS]
    end = time.monotonic() + budget
    for setting in peer.SETTINGS[::every]:
        for pair in list(pairs):
            left = end - time.monotonic()
            if left <= 0:
                return
            trial = try_one(worker, problem, *pair, setting, max(left * PART, LEAST))
            yield trial
            if trial.status in ("out_of_time", "crashed"):
                pairs.remove(pair)


def try_one(
    worker: Worker, problem: Problem, method: str, form: str, setting: float, seconds: float
) -> Trial:
    """One trial."""
    question = {
        "problem": problem.as_dict(),
        "method": method,
        "formulation": form,
        "setting": setting,
    }
    status, remark, answer = "ok", "", {}
    try:
        answer = worker.ask(question, seconds)
    except LostError as error:
        status = str(error)
    if "failure" in answer:
        status, remark, answer = "failed", answer["failure"], {}
    value = f"{setting:.0e}" if setting < 1 else str(setting)
    text = f"{worker.peer.SETTING} {value}"
    return Trial(worker.peer.NAME, method, form, text, status, answer, remark)
