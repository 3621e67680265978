"""SUNDIALS from C: CVODE by Adams and BDF formulas. Tables of ARKODE are methods of spintop."""

from comparing.answer import DECADES
from comparing.compiled import define, make, solver, version_of

METHODS = ("cvode_adams", "cvode_bdf")
FORMULATIONS = ("space_frame", "cayley_klein", "rigid_body")
SETTINGS = DECADES[::2]
LIBRARIES = ("cvode", "sunnonlinsolfixedpoint", "nvecserial")
HEADER = "sundials/sundials_context.h"


def find() -> tuple[str, str]:
    """The version, and the compiler that finds the headers: MPI's where they include mpi.h."""
    try:
        return define("gcc", HEADER, "SUNDIALS_VERSION"), "gcc"
    except OSError:
        return define("mpicc", HEADER, "SUNDIALS_VERSION"), "mpicc"


NUMBER, COMPILER = find()
FLAGS = [f"-lsundials_{name}" for name in LIBRARIES]
FLAGS.append("-lsundials_generic" if NUMBER.startswith("6.") else "-lsundials_core")
PROGRAM = make(COMPILER, "sundials.c", [*FLAGS, "-lm"])
VERSIONS = f"SUNDIALS {NUMBER}, {version_of(COMPILER)}"
solve = solver(PROGRAM)
