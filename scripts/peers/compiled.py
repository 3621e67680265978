"""Peers in C and C++: their program is made when it is wanted, and answers in one line."""

import array
import json
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

from peers.answer import Answer, BatchAnswer
from peers.bodies import CASES, problems
from peers.equations import EQUATIONS, RIGID_BODY, c_header
from peers.problem import Problem

HERE = Path(__file__).resolve().parent
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
MADE: dict[str, Path] = {}
FOLDER = tempfile.TemporaryDirectory(prefix="spintop-peers-")


def has_header(compiler: str, header: str) -> bool:
    """Whether the compiler finds a header."""
    command = [compiler, "-fsyntax-only", "-include", header, "-xc++" if "+" in compiler else "-xc"]
    try:
        check = subprocess.run([*command, "/dev/null"], capture_output=True, check=False)
    except FileNotFoundError:
        return False
    return check.returncode == 0


def version_of(compiler: str) -> str:
    """The compiler and its flags."""
    line = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True)
    return f"{line.stdout.splitlines()[0]} {' '.join(FLAGS)}"


def define(compiler: str, header: str, name: str) -> str:
    """The value of a macro."""
    text = f"#include <{header}>\n{name}\n"
    command = [compiler, "-E", "-P", "-xc", "-"]
    result = subprocess.run(command, input=text, capture_output=True, text=True, check=True)
    return result.stdout.strip().splitlines()[-1].strip('"')


def make(compiler: str, source: str, libraries: Iterable[str] = ()) -> Path:
    """Compile a source beside this file with the equations; once."""
    if source not in MADE:
        folder = Path(FOLDER.name)
        (folder / "equations.h").write_text(c_header(), encoding="utf-8")
        program = folder / Path(source).stem
        command = [compiler, *FLAGS, f"-I{folder}", f"-I{HERE}", HERE / source, "-o", program]
        result = subprocess.run(
            [*map(str, command), *libraries], capture_output=True, text=True, check=False
        )
        if result.returncode:
            raise OSError(f"{source} does not compile: {result.stderr}")
        MADE[source] = program
    return MADE[source]


def ask(program: Path, problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Run the program; its line has the final state, steps, rejected, evaluations and the time."""
    form = EQUATIONS[formulation]
    constants, start = form.start(problem)
    numbers = map(repr, (setting, problem.t_end, *constants, *start))
    found = json.loads(answer_of([program, formulation, method, *numbers]))
    q = form.attitude(problem, found.pop("state"))
    return Answer(q, **found)


def ask_batch(program: Path, t_end: float, every: int, method: str, setting: float) -> BatchAnswer:
    """Run a program for many bodies; its line has the states at the end of some, and the time."""
    numbers = array.array("d")
    for problem in problems(t_end):
        for part in RIGID_BODY.start(problem):
            numbers.extend(part)
    found = json.loads(
        answer_of([program, method, setting, t_end, CASES, every], numbers.tobytes())
    )
    ends = [RIGID_BODY.attitude(problem, state) for state in found.pop("ends")]
    return BatchAnswer(ends, **found)


def answer_of(command: list[object], numbers: bytes = b"") -> str:
    """The line that a program prints, on one thread."""
    result = subprocess.run(
        list(map(str, command)),
        input=numbers,
        capture_output=True,
        check=False,
        env=os.environ | {"LC_ALL": "C", "OMP_NUM_THREADS": "1"},
    )
    if result.returncode:
        reason = result.stderr.decode(errors="replace").strip()
        raise ArithmeticError(reason or f"ended with {result.returncode}")
    return result.stdout.decode()
