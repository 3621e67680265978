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
LIBRARIES = ("arkode", "cvode", "sunnonlinsolfixedpoint", "nvecserial", "generic")


def absence() -> str:
    """Why it cannot be had."""
    if compiled.has_header("gcc", "sundials/sundials_context.h"):
        return ""
    return "gcc finds no sundials/sundials_context.h (Debian's libsundials-dev)"


def program() -> Path:
    """Its program."""
    return compiled.make(
        "gcc", "sundials.c", [*(f"-lsundials_{name}" for name in LIBRARIES), "-lm"]
    )


def versions() -> str:
    """What is used; it is compiled here, so that no trial has to wait for that."""
    program()
    number = compiled.define("gcc", "sundials/sundials_config.h", "SUNDIALS_VERSION")
    return f"SUNDIALS {number}, {compiled.version_of('gcc')}"


def solve(problem: Problem, method: str, formulation: str, setting: float) -> Answer:
    """Solve to a tolerance, absolute and relative."""
    return compiled.ask(program(), problem, method, formulation, setting)
