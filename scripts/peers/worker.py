#!/usr/bin/env python3
"""Runs one peer in this process: questions come as lines of JSON, an answer each goes back.

usage: worker.py PEER
"""

import importlib
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path

sys.dont_write_bytecode = True
sys.path[0] = str(Path(__file__).resolve().parent.parent)

from peers.problem import Problem  # noqa: E402


def main(name: str) -> None:
    """Tell what the peer is, then answer until the questions end."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what the peer itself prints is no answer
    peer = importlib.import_module(f"peers.{name}_peer")
    absence = peer.absence()
    about = {"absence": absence, "versions": "" if absence else peer.versions()}
    print(json.dumps(about), file=answers, flush=True)
    for line in sys.stdin:
        question = json.loads(line)
        try:
            if "batch" in question:
                answer = asdict(peer.solve_batch(**question["batch"]))
            else:
                problem = Problem(**question.pop("problem"))
                answer = asdict(peer.solve(problem, **question))
        except Exception as error:
            answer = {"failure": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
