"""Programs in C and C++: made when they are wanted, they read and write numbers."""

import array
import os
import subprocess
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from comparing.answer import Answer
from comparing.equations import EQUATIONS, c_header
from comparing.problem import Problem

HERE = Path(__file__).resolve().parent / "programs"
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fopenmp-simd")
FOLDER = tempfile.TemporaryDirectory(prefix="spintop-compare-")


def run(command: list[object], text: bytes = b"") -> bytes:
    """What a command prints, on one thread; an OSError says what it complains of."""
    environment = os.environ | {"LC_ALL": "C", "OMP_NUM_THREADS": "1"}
    result = subprocess.run(list(map(str, command)), input=text, capture_output=True, check=False,
                            env=environment)  # fmt: skip
    if result.returncode:
        reason = result.stderr.decode(errors="replace").strip()
        raise OSError(reason or f"{command[0]} ended with {result.returncode}")
    return result.stdout


def version_of(compiler: str) -> str:
    """The compiler and its flags."""
    return f"{run([compiler, '--version']).decode().splitlines()[0]} {' '.join(FLAGS)}"


def define(compiler: str, header: str, name: str) -> str:
    """The value of a macro; an OSError where there is no such header."""
    text = f"#include <{header}>\n{name}\n".encode()
    return run([compiler, "-E", "-P", "-xc", "-"], text).decode().split()[-1].strip('"')


def make(compiler: str, source: str, flags: Iterable[str] = ()) -> Path:
    """Compile a source in the folder of programs with the equations; once."""
    folder = Path(FOLDER.name)
    program = folder / Path(source).stem
    if not program.exists():
        (folder / "equations.h").write_text(c_header(), encoding="utf-8")
        run([compiler, *FLAGS, f"-I{folder}", f"-I{HERE}", HERE / source, "-o", program, *flags])
    return program


def ask(
    program: Path, problems: list[Problem], every: int, method: str, formulation: str,
    setting: float,
) -> Answer:  # fmt: skip
    """Have a program solve problems with the same end; every so many of the ends are wanted.

    It reads constants and states as doubles, and writes the states, the time and counts so.
    """
    form, numbers = EQUATIONS[formulation], array.array("d")
    for problem in problems:
        for part in form.start(problem):
            numbers.extend(part)
    words = [program, formulation, method, setting, problems[0].t_end, len(problems), every]
    *ends, time_s, steps, rejected, evaluations = array.array("d", run(words, numbers.tobytes()))
    states = zip(*[iter(ends)] * len(form.states), strict=True)
    ends = [form.attitude(*end) for end in zip(problems[::every], states, strict=True)]
    return Answer(ends, time_s, steps, rejected, evaluations)


def solver(program: Path) -> Callable[..., Answer]:
    """`solve` of a compiled program: one problem to a tolerance, absolute and relative."""
    return lambda problem, **question: ask(program, [problem], 1, **question)
