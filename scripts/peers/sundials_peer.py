"""SUNDIALS from C: CVODE by Adams and BDF formulas, ARKODE's ERKStep with several tables."""

from pathlib import Path

from peers import compiled
from peers.answer import DECADES, Answer
from peers.problem import Problem

NAME = "SUNDIALS"
METHODS = (
    "cvode_adams",
    "cvode_bdf",
    "erkstep_cash_karp",
    "erkstep_dormand_prince",
    "erkstep_verner",
    "erkstep_fehlberg",
)
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
DEBIAN = ("gcc", "libsundials-dev")
SETTING = "tolerance"
SETTINGS = DECADES[::2]
LIBRARIES = ("arkode", "cvode", "sunnonlinsolfixedpoint", "nvecserial")
HEADER = "sundials/sundials_context.h"


def compiler() -> str:
    """The compiler that finds the headers: it is MPI's where they include mpi.h."""
    return next((name for name in ("gcc", "mpicc") if compiled.has_header(name, HEADER)), "")


def absence() -> str:
    """Why it cannot be had."""
    if compiler():
        return ""
    return f"neither gcc nor mpicc finds {HEADER} (Debian's libsundials-dev)"


def program() -> Path:
    """Its program."""
    major = int(compiled.define(compiler(), "sundials/sundials_config.h", "SUNDIALS_VERSION_MAJOR"))
    names = (*LIBRARIES, "generic" if major < 7 else "core")
    return compiled.make(
        compiler(), "sundials.c", [*(f"-lsundials_{name}" for name in names), "-lm"]
    )


def versions() -> str:
    """What is used; it is compiled here, so that no trial has to wait for that."""
    program()
    number = compiled.define(compiler(), "sundials/sundials_config.h", "SUNDIALS_VERSION")
    return f"SUNDIALS {number}, {compiled.version_of(compiler())}"


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance, absolute and relative."""
    return compiled.ask(program(), problem, method, formulation, setting)
