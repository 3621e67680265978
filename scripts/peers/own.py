"""spintop on the same problems: its own work-precision study."""

from pathlib import Path

from peers.scene import Scene, compute
from spintop_figures.tables.table import Table

METHODS = ("exact", "taylor", "taylor/rigid_body", "dop853", "splitting_8", "ode45")
"""Of these a study leaves out what a body has not."""
GENERAL = tuple(f"{name}/rigid_body" for name in ("taylor", "dop853", "splitting_8", "ode45"))
"""Where a symmetric top is computed as any other body."""
TOLERANCES = tuple(f"1e-{digits}" for digits in range(3, 17))
STEPS = tuple(str(100 * 2**i) for i in range(11))


def measure(scene: Scene, every: int, folder: Path) -> Table:
    """The study with every so many of the settings, against a motion in quadruple precision."""
    group = "\n".join(
        (
            "&work_precision reference = 'quadruple'",
            f"    methods = {', '.join(map(repr, GENERAL if scene.general else METHODS))}",
            f"    tolerances = {', '.join(TOLERANCES[::every])}",
            f"    steps = {', '.join(STEPS[::every])}",
            "/",
        )
    )
    return compute("work_precision", [*scene.groups, group], folder)
