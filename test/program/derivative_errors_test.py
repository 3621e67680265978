"""Errors of derivatives: what `COLUMN__KEY_error` claims, by all methods."""

import math
import random

from conftest import output

TOPS = 3
COLUMNS = ("theta_end", "phi_end", "theta_rate_end")
KEYS = ("top.mass", "initial.psi_rate")
NAMES = [f"{column}__{key}" for column in COLUMNS for key in KEYS]
ADAPTIVE = [f"relative_tolerance = {tolerance}" for tolerance in ("1e-5", "1e-8", "1e-12")]
FIXED = ["steps = 160", "steps = 640"]
AXES = {
    "top.mass": (0.5, 2),
    "top.length": (0.1, 0.6),
    "top.inertia(3)": (0.2, 0.9),
    "top.gravity": (8, 11),
    "initial.theta": (0.4, 2.4),
    "initial.phi_rate": (-0.6, 0.6),
    "initial.theta_rate": (-0.6, 0.6),
    "initial.psi_rate": (3, 12),
    "span.t_end": (1, 3),
}
SCENE = (
    "&top inertia = 0.8, 0.8, 0.3 /\n&study kind = 'sweep' /\n&sweep table = 'tops.csv' /\n"
    + output(*NAMES)
)


def tops():
    draw = random.Random(28071)
    rows = [[repr(draw.uniform(*ends)) for ends in AXES.values()] for _ in range(TOPS)]
    return "".join(",".join(row) + "\n" for row in [AXES, *rows])


def derivatives(spin, integration):
    rows = spin(f"{SCENE}&integration {integration} /\n").rows
    return [pair for name in NAMES for pair in rows[[name, f"{name}_error"]].to_numpy()]


def test_every_method(spin):
    """A claim is 0.5 to 100 times the error, nearly always, and never below a tenth."""
    spin.write(tops(), "tops.csv")
    true = derivatives(spin, "method = 'exact'")
    methods = [method for method in spin.listed("methods") if method["name"] != "exact"]
    assert len(methods) > 15
    judged, outside, missing = 0, [], 0
    for method in methods:
        settings = ADAPTIVE * (method["kind"] != "fixed") + FIXED * (method["kind"] != "adaptive")
        for setting in settings:
            found = derivatives(spin, f"method = '{method['name']}' {setting}")
            for (value, claim), (exact, exact_claim) in zip(found, true, strict=True):
                judged += 1
                if math.isnan(value):
                    missing += 1
                    continue
                error = abs(value - exact)
                case = f"{method['name']}, {setting}: claim {claim}, error {error}"
                assert claim + exact_claim >= 0.1 * error, case
                # The exact derivative is not known to less than its own claim.
                known = max(error, exact_claim)
                if claim + exact_claim < 0.5 * error or claim > 100 * known:
                    outside.append(case)
    assert len(outside) < 0.03 * judged, outside
    assert missing < 0.03 * judged
