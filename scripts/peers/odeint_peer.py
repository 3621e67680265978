"""Boost.odeint: controlled steppers on arrays of fixed size, the equations inlined."""

from pathlib import Path

from peers import compiled
from peers.answer import DECADES, Answer, BatchAnswer
from peers.problem import Problem

NAME = "Boost.odeint"
METHODS = ("odeint_dopri5", "odeint_fehlberg78", "odeint_bulirsch_stoer")
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
DEBIAN = ("g++", "libboost-dev")
SETTING = "tolerance"
SETTINGS = DECADES
BATCHES = ("odeint_fehlberg78_16",)
"""Sixteen bodies as one system."""


def absence() -> str:
    """Why it cannot be had."""
    if compiled.has_header("g++", "boost/numeric/odeint.hpp"):
        return ""
    return "g++ finds no boost/numeric/odeint.hpp (Debian's libboost-dev)"


def program() -> Path:
    """Its program."""
    return compiled.make("g++", "odeint.cpp", ["-std=c++17"])


def batch_program() -> Path:
    """Its program for many bodies."""
    return compiled.make("g++", "odeint_batch.cpp", ["-std=c++17", "-fopenmp-simd"])


def versions() -> str:
    """What is used; it is compiled here, so that no trial has to wait for that."""
    program()
    boost = compiled.define("g++", "boost/version.hpp", "BOOST_LIB_VERSION").replace("_", ".")
    return f"Boost {boost}, {compiled.version_of('g++')}"


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance, absolute and relative."""
    return compiled.ask(program(), problem, method, formulation, setting)


def solve_batch(t_end: float, every: int, method: str, setting: float) -> BatchAnswer:
    """Solve the many bodies to a tolerance, absolute and relative."""
    return compiled.ask_batch(batch_program(), t_end, every, method, setting)
