#!/usr/bin/env python3
"""Runs one program in this process: questions come through a pipe, an answer each goes back.

usage: worker.py MODULE NUMBER      of the file descriptor of the pipe
"""

import importlib
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path
from types import ModuleType

SCRIPTS = Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path[0] = str(SCRIPTS)
sys.path.append(str(SCRIPTS.parent / "python"))

from comparing.answer import Answer, step_through  # noqa: E402


def tell(program: ModuleType) -> dict:
    """What a program is, made ready, and what it can be asked for."""
    lists = ("METHODS", "FORMULATIONS", "SETTINGS", "STEPPERS", "BATCHES")
    about = {name: list(getattr(program, name, ())) for name in lists}
    return about | {
        "OWN_SETTINGS": getattr(program, "OWN_SETTINGS", {}),
        "versions": program.VERSIONS,
    }


def answer(program: ModuleType, question: dict) -> Answer:
    """What a program finds."""
    if "t_end" in question:
        return program.solve_batch(**question)
    if "formulation" in question:
        return program.solve(**question)
    problem = question["problem"]
    if hasattr(program, "step"):
        return program.step(problem, question["method"], question["setting"])
    steps = question["setting"] * problem.t_end
    return step_through(program.prepare, problem, question["method"], steps)


def main(name: str, place: str) -> None:
    """Tell what the program is, or why it cannot be had, then answer until the questions end."""
    pipe = Connection(int(place))
    try:
        program = importlib.import_module(f"comparing.programs.{name}")
        pipe.send(tell(program))
    except (ImportError, OSError) as error:
        pipe.send({"absence": str(error)})
    while True:
        try:
            question, begin = pipe.recv(), time.process_time()
            found = vars(answer(program, question)) | {"spent_s": time.process_time() - begin}
        except EOFError:
            return
        except NotImplementedError as error:
            found = {"status": "refused", "remark": str(error)}
        except Exception as error:
            found = {"status": "failed", "remark": f"{type(error).__name__}: {error}"}
        pipe.send(found)


if __name__ == "__main__":
    main(*sys.argv[1:])
