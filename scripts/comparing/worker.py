#!/usr/bin/env python3
"""Runs one program in this process: questions come as lines of JSON, an answer each goes back.

usage: worker.py MODULE
"""

import importlib
import json
import os
import sys
import time
from dataclasses import asdict
from pathlib import Path
from types import ModuleType

SCRIPTS = Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path[0] = str(SCRIPTS)
sys.path.append(str(SCRIPTS.parent / "python"))

from comparing.answer import Answer, step_through  # noqa: E402
from comparing.problem import Problem  # noqa: E402


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
    problem = Problem(**question.pop("problem"))
    if "formulation" in question:
        return program.solve(problem, **question)
    if hasattr(program, "step"):
        return program.step(problem, question["method"], question["setting"])
    steps = question["setting"] * problem.t_end
    return step_through(program.prepare, problem, question["method"], steps)


def main(name: str) -> None:
    """Tell what the program is, or why it cannot be had, then answer until the questions end."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what the program itself prints is no answer
    try:
        program = importlib.import_module(f"comparing.programs.{name}")
        about = tell(program)
    except (ImportError, OSError) as error:
        about = {"absence": str(error)}
    print(json.dumps(about), file=answers, flush=True)
    for line in sys.stdin:
        try:
            begin = time.process_time()
            found = asdict(answer(program, json.loads(line)))
            found["spent_s"] = time.process_time() - begin
        except NotImplementedError as error:
            found = {"refusal": str(error)}
        except Exception as error:
            found = {"failure": f"{type(error).__name__}: {error}"}
        print(json.dumps(found), file=answers, flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
