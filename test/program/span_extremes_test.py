"""Extremes of sweeps are those over the span, however short: of a tenth of a nutation, or of many.

They are compared with those of many rows of the trajectory, for the exact motion and by several
methods: in vector lanes, and one case after another.
"""

import math
from pathlib import Path

import pytest

from nutation_axes_test import rows_of

HEAVY = """\
&top mass = 1  inertia = 0.9, 0.7, 0.3  centre_of_mass = 0.02, -0.03, 0.4  damping = 3*0.02 /
&initial theta = 0.9  phi_rate = 0.4  theta_rate = -0.7  psi_rate = 9 /
"""
FREE = """\
&top mass = 1  inertia = 0.9, 0.7, 0.3  length = 0 /
&initial theta = 0.9  phi_rate = 0.4  theta_rate = -0.7  psi_rate = 9 /
"""
TENSOR = """\
&top mass = 2  inertia_tensor(1,:) = 0.7, 0.12, -0.1  inertia_tensor(2,2:3) = 0.9, 0.15
     inertia_tensor(3,3) = 0.6  centre_of_mass = 0.1, -0.15, 0.3 /
&initial theta = 1  psi = 0.3  phi_rate = 1  psi_rate = 5 /
"""
LANES = "method = 'taylor'"
ALONE = "method = 'taylor'  project = 'unit'"
STEPS = 8400
SHARES = 0.1, 0.5, 0.9, 2.1
"""Spans in units of about a nutation."""
RATES = "phi_rate_max", "theta_rate_max", "com_z_min"
RANGE = "theta_min", "theta_max", "delta_u"
FORCES = "force_max", "force_z_min", "force_z_max"


def sample(folder: Path, body: str, t_end: float) -> list[dict[str, float]]:
    """Many rows of the trajectory."""
    columns = "t", "theta", "theta_rate", "phi_rate", "com_z", "force_x", "force_y", "force_z"
    precise = "&integration relative_tolerance = 1e-12 /\n" if "length = 0 " not in body else ""
    span = f"&span t_end = {t_end!r}  samples = {STEPS + 1} /\n"
    rows = rows_of(folder, body + precise + span, columns)
    return [{name: float(row[name]) for name in columns} for row in rows]


def extremes(rows: list[dict[str, float]]) -> dict[str, float]:
    """The quantities of a sweep from rows."""
    theta = [row["theta"] for row in rows]
    vertical = [row["force_z"] for row in rows]
    force = [math.hypot(row["force_x"], row["force_y"], row["force_z"]) for row in rows]
    return {
        "theta_min": min(theta),
        "theta_max": max(theta),
        "delta_u": math.cos(min(theta)) - math.cos(max(theta)),
        "phi_rate_max": max((row["phi_rate"] for row in rows), key=abs),
        "theta_rate_max": max(abs(row["theta_rate"]) for row in rows),
        "com_z_min": min(row["com_z"] for row in rows),
        "force_max": max(force),
        "force_z_min": min(vertical),
        "force_z_max": max(vertical),
    }


@pytest.mark.parametrize(
    ("body", "nutation", "method", "columns"),
    [
        (HEAVY, 2.1, LANES, RANGE + RATES + FORCES),
        (HEAVY, 2.1, ALONE, RANGE + RATES + FORCES),
        (HEAVY, 2.1, "method = 'dop853'", RANGE + RATES + FORCES),
        (TENSOR, 1.6, LANES, RANGE + RATES + FORCES),
        (FREE, 1.7, "method = 'exact'", RATES),
        (FREE, 1.7, LANES, RATES),
        (FREE, 1.7, "method = 'dop853'", RATES),
    ],
)
def test_extremes(
    tmp_path: Path, body: str, nutation: float, method: str, columns: tuple[str, ...]
) -> None:
    """In each span, all together and each alone; what needs a whole nutation says so."""
    spans = [share * nutation for share in SHARES]
    accurate = "" if "exact" in method else "  relative_tolerance = 1e-11"
    sweep = body + f"&integration {method}{accurate} /\n&study kind = 'sweep' /\n"
    values = ", ".join(map(repr, spans))
    sweep += f"&sweep parameter(1) = 'span.t_end'  values(1,:) = {values} /\n"
    found = rows_of(tmp_path, sweep, (*columns, "nutation_period"))
    alone = {name: rows_of(tmp_path, sweep, (name,)) for name in columns}
    rows = sample(tmp_path, body, spans[-1])
    for i, span in enumerate(spans):
        known = extremes(rows[: round(STEPS * span / spans[-1]) + 1])
        for name in columns:
            value = float(found[i][name])
            assert value == pytest.approx(known[name], rel=1e-5, abs=1e-7), (span, name)
            assert float(alone[name][i][name]) == pytest.approx(value, rel=1e-9), (span, name)
            assert not alone[name][i]["notes"], (span, name)
        has_period = found[i]["nutation_period"] != "nan"
        assert ("no full nutation" in found[i]["notes"]) != has_period, span
    assert found[0]["nutation_period"] == "nan"
    assert found[-1]["nutation_period"] != "nan"


# Motions in which body z passes the lower pole at 1e-6 rad.
BESIDE_POLES = [
    """\
&top mass = 1  inertia = 0.6603094158617984, 0.7847621876864949, 0.2593160816891005
     centre_of_mass = -0.017175524321969594, -0.02, 0.78  damping = 0.01, 0.01, 0.005 /
&initial theta = 2.829913706186562  omega3 = 3.2394348014953644
         phi_rate = -0.8454998918643344  theta_rate = 2.9866871373352657 /
""",
    """\
&top mass = 1  inertia = 0.6804447361426638, 0.6937312351496909, 0.36662318784966325
     centre_of_mass = -0.016117333434512528, -0.02, 0.78  damping = 0.01, 0.01, 0.005 /
&initial theta = 2.9588587094695917  omega3 = 1.6702832838535508
         phi_rate = -1.2832155308899906  theta_rate = 2.849442748767455 /
""",
]


@pytest.mark.parametrize("body", BESIDE_POLES)
def test_rates_beside_poles(tmp_path: Path, body: str) -> None:
    """In lanes and alone the same; a large rate next to a pole makes no cusps of the others."""
    sweep = body + "&study kind = 'sweep' /\n&sweep parameter = 'span.t_end'  values(1,:) = 6 /\n"
    columns = "phi_rate_max", "theta_max", "motion_class"
    rates = []
    for method in (LANES, ALONE, "method = 'dop853'"):
        accurate = f"&integration {method}  relative_tolerance = 1e-12 /\n"
        (row,) = rows_of(tmp_path, sweep + accurate, columns)
        assert abs(float(row["theta_max"]) - math.pi) < 3e-6
        assert row["motion_class"] != "cusp"
        rates.append(float(row["phi_rate_max"]))
    assert abs(rates[0]) > 1e6
    assert rates == pytest.approx(3 * [rates[1]], rel=1e-5)


# Bodies that are all but symmetric, so that they are integrated: cusps for phi_rate = 0, loops and
# waves for others; and plane swings, below the pivot and over the poles.
CLASSES = {
    """\
&top mass = 1  inertia = 0.9, 0.9000000001, 0.3  centre_of_mass = 0, 0, 0.4 /
&initial theta = 0.9  theta_rate = 0  omega3 = 9 /
&sweep parameter = 'initial.phi_rate'  values(1,:) = -0.2, 0, 0.2, 0.6, 1.5 /
""": {"cusp", "loop", "wave"},
    """\
&top mass = 1  inertia = 0.9, 0.7, 0.3  centre_of_mass = 0, 0, 0.4 /
&initial theta = 2  omega = 0, 0, 0 /
&sweep parameter = 'initial.omega(1)'  values(1,:) = 0, 1, 9 /
""": {"libration", "circulation"},
}


@pytest.mark.parametrize("scene", CLASSES)
@pytest.mark.parametrize("method", [ALONE, "method = 'dop853'"])
def test_class_alone(tmp_path: Path, scene: str, method: str) -> None:
    """The class of a motion is the same without a search for its largest precession rate."""
    settings = f"&integration {method}  relative_tolerance = 1e-11 /\n&span t_end = 8 /\n"
    sweep = scene + settings + "&study kind = 'sweep' /\n"
    alone = [row["motion_class"] for row in rows_of(tmp_path, sweep, ("motion_class",))]
    both = rows_of(tmp_path, sweep, ("motion_class", "phi_rate_max"))
    assert alone == [row["motion_class"] for row in both]
    assert CLASSES[scene] <= set(alone)
