"""spintop: the closed-form solution, and Taylor series at several tolerances."""

import spintop
from spintop.library import library

METHODS = ("exact", "taylor")
SETTINGS = {"exact": (0.0,), "taylor": tuple(10.0**-k for k in range(2, 15))}
library()  # an ImportError says how to make it
COLUMNS = ["q0", "q1", "q2", "q3", "omega1", "omega2", "omega3"]


def prepare(motion: dict, method: str, tolerance: float) -> tuple:
    """All samples are computed in the first step, and here once to have all in place."""
    body = spintop.Body(mass=motion["mass"], inertia=motion["inertia_at_pivot"],
                        centre_of_mass=motion["arm"], gravity=motion["gravity"])  # fmt: skip
    top = spintop.Top(body, quaternion=motion["quaternion"], omega=motion["omega"])
    count, states = motion["samples"], []
    times = [motion["t_end"] * i / count for i in range(count + 1)]

    def compute() -> list:
        if method == "exact":
            result = top.exact(times, COLUMNS)
        else:
            result = top.integrate(times, COLUMNS, method=method, relative_tolerance=tolerance)
        return [result[name] for name in COLUMNS]

    def advance(_: int) -> None:
        states.extend([] if states else zip(*compute(), strict=True))
        states.pop(0)

    compute()
    return advance, lambda: states[0]
