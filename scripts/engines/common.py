"""Runs one engine on all motions in this process: a question in JSON comes, lines of JSON go back.

usage: common.py SCRIPT < QUESTION
"""

import importlib
import json
import math
import os
import sys
import time
from collections.abc import Iterator
from importlib.metadata import version
from itertools import product
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parent.parent.parent
LEAST, MOST_ROUNDS = 0.1, 5
"""A run is repeated for so many seconds, or so many times; the fastest counts."""


def run(engine: ModuleType, motion: dict, method: str, step: float, stride: int) -> tuple:
    """The states at the samples, and the processor time of all steps, s."""
    advance, state = engine.prepare(motion, method, step)
    states, seconds = [], 0.0
    for _ in range(motion["samples"]):
        start = time.process_time()
        advance(stride)
        seconds += time.process_time() - start
        states.append([float(x) for x in state()])
    return states, seconds


def repeat(engine: ModuleType, motion: dict, method: str, rate: float, most: float) -> dict:
    """A setting, with the least of the times of some runs; a run that fails has no states."""
    fixed = isinstance(rate, int)
    stride = round(rate * motion["t_end"] / motion["samples"]) if fixed else 1
    best, states, begun, rounds = math.inf, [], time.process_time(), 0
    while rounds < 2 or (rounds < MOST_ROUNDS and time.process_time() - begun < LEAST):
        begin = time.process_time()
        try:
            states, seconds = run(engine, motion, method, 1 / rate if fixed else rate, stride)
        except (RuntimeError, ValueError, ArithmeticError) as error:
            if isinstance(error, NotImplementedError):
                raise
            break
        best, rounds = min(best, seconds), rounds + 1
        if time.process_time() - begin > most:
            break
    return {"method": method, "rate": rate, "seconds": best, "states": states}


def measure(
    engine: ModuleType, motion: dict, method: str, rates: list, budget: float
) -> Iterator[dict]:
    """One method with smaller and smaller steps, until the time is up; first all is compiled."""
    settings = getattr(engine, "SETTINGS", {}).get(method, rates)
    first = 1 / settings[0] if isinstance(settings[0], int) else settings[0]
    try:
        engine.prepare(motion, method, first)[0](1)
        end, last = time.process_time() + budget, 0.0
        for rate in settings:
            if time.process_time() + 2.5 * last > end:
                break
            begin = time.process_time()
            yield repeat(engine, motion, method, rate, budget / 4)
            last = (time.process_time() - begin) / 2
    except NotImplementedError as error:
        yield {"method": method, "refusal": str(error)}


def main(name: str) -> None:
    """Answer the question: first which versions there are, or what is lacking."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what the engine itself prints is no answer
    question = json.load(sys.stdin)
    try:
        engine = importlib.import_module(f"engines.{name}")
        versions = " and ".join(map(version, question["packages"]))
    except ImportError as error:
        print(json.dumps({"absence": str(error)}), file=answers, flush=True)
        return
    print(json.dumps({"versions": versions}), file=answers, flush=True)
    for motion, method in product(question["motions"], engine.METHODS):
        for answer in measure(engine, motion, method, question["rates"], question["budget"]):
            answer["motion"] = motion["name"]
            print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.path[0] = str(ROOT / "scripts")
    sys.path.append(str(ROOT / "python"))
    main(Path(sys.argv[1]).stem)
