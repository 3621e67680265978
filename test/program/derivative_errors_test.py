"""Errors of derivatives: what `COLUMN__KEY_error` claims, by all methods."""

import json
import math
import random
import unittest

from program_test import ProgramCase

TOPS = 3
COLUMNS = ("theta_end", "phi_end", "theta_rate_end")
KEYS = ("top.mass", "initial.psi_rate")
NAMES = [f"{column}__{key}" for column in COLUMNS for key in KEYS]
ADAPTIVE = [f"relative_tolerance = {tolerance}" for tolerance in ("1e-5", "1e-8", "1e-12")]
FIXED = ["steps = 160", "steps = 640"]


def tops() -> str:
    """Random tops, as the table of a sweep."""
    draw = random.Random(28071)
    axes = {
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
    rows = [
        ",".join(repr(draw.uniform(low, high)) for low, high in axes.values()) for _ in range(TOPS)
    ]
    return "\n".join([",".join(axes), *rows]) + "\n"


SCENE = (
    "&top inertia = 0.8, 0.8, 0.3 /\n&study kind = 'sweep' /\n&sweep table = 'tops.csv' /\n"
    "&output columns = " + ", ".join(f"'{name}'" for name in NAMES) + " /\n"
)


class DerivativeErrorsTest(ProgramCase):
    """Claims and errors."""

    def derivatives(self, integration: str) -> list[tuple[float, float]]:
        """All derivatives of all tops, with their claims."""
        table = self.compute(self.write(f"{SCENE}&integration {integration} /\n"))
        return [
            (value, claim)
            for name in NAMES
            for value, claim in zip(table.column(name), table.column(f"{name}_error"), strict=True)
        ]

    def test_every_method(self) -> None:
        """A claim is 0.5 to 100 times the error, nearly always, and never below a tenth."""
        (self.folder / "tops.csv").write_text(tops())
        true = self.derivatives("method = 'exact'")
        listed = self.run_program("list", "methods", "--json").stdout
        listed = json.loads(listed)["methods"]
        methods = [method for method in listed if method["name"] != "exact"]
        self.assertGreater(len(methods), 15)
        judged, outside, missing = 0, [], 0
        for method in methods:
            settings = ADAPTIVE if method["kind"] != "fixed" else []
            settings = settings + (FIXED if method["kind"] != "adaptive" else [])
            for setting in settings:
                found = self.derivatives(f"method = '{method['name']}' {setting}")
                for (value, claim), (exact, exact_claim) in zip(found, true, strict=True):
                    judged += 1
                    if math.isnan(value):
                        missing += 1
                        continue
                    error = abs(value - exact)
                    case = f"{method['name']}, {setting}: claim {claim}, error {error}"
                    self.assertGreaterEqual(claim + exact_claim, 0.1 * error, case)
                    # The exact derivative is not known to less than its own claim.
                    known = max(error, exact_claim)
                    if claim + exact_claim < 0.5 * error or claim > 100 * known:
                        outside.append(case)
        self.assertLess(len(outside), 0.03 * judged, outside)
        self.assertLess(missing, 0.03 * judged)


if __name__ == "__main__":
    unittest.main()
