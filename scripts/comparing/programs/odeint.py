"""Boost.odeint: controlled steppers on arrays of fixed size, the equations inlined."""

from comparing.answer import DECADES, Answer
from comparing.bodies import problems
from comparing.compiled import ask, define, make, solver, version_of

METHODS = ("odeint_dopri5", "odeint_fehlberg78", "odeint_bulirsch_stoer")
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
SETTINGS = DECADES
BATCHES = ("odeint_fehlberg78_16",)
BOOST = define("g++", "boost/version.hpp", "BOOST_LIB_VERSION").replace("_", ".")
PROGRAM = make("g++", "odeint.cpp", ["-std=c++17"])
VERSIONS = f"Boost {BOOST}, {version_of('g++')}"
solve = solver(PROGRAM)


def solve_batch(t_end: float, every: int, method: str, setting: float) -> Answer:
    """Solve the many bodies to a tolerance, absolute and relative, sixteen as one system."""
    return ask(PROGRAM, list(problems(t_end)), every, method, "rigid_body", setting)
