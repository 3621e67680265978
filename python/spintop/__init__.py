"""The motion of a heavy spinning top: the library of spintop from Python.

    import spintop

    body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
    top = spintop.Top(body, theta_deg=11.25, psi_rate=1.0)
    top.exact([0.0, 1.0, 2.0]).theta

All quantities are in SI units and radians, unless a name ends with a unit, as `_deg`. Calls
release the global interpreter lock, and any thread may call anything.
"""

from spintop.animation import Animation, animate
from spintop.exports import export
from spintop.library import (
    InputError,
    InputWarning,
    MotionError,
    OutputError,
    SpintopError,
    library,
)
from spintop.results import Result, Table
from spintop.runs import fit, plot, read, registry, run, sweep
from spintop.tops import Body, Motion, Top, tops

__all__ = ["Animation", "Body", "InputError", "InputWarning", "Motion", "MotionError"]
__all__ += ["OutputError", "Result", "SpintopError", "Table", "Top", "animate", "export", "fit"]
__all__ += ["plot", "read", "registry", "run", "sweep", "tops", "version"]


def version() -> str:
    """The version of the library that is loaded."""
    return library().spintop_version().decode()


def __getattr__(name: str) -> str:
    """The version as `__version__`, as other packages have it."""
    if name == "__version__":
        return version()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
