"""Random symmetric tops of all classes, certified by the program: none outside its claim."""

import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest
from collections.abc import Iterator
from pathlib import Path

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))

from random_tops import CLASSES, Start, draw_top  # noqa: E402

PROGRAM = os.environ.get("SPINTOP_EXE", str(TESTS.parent / "build/release/spintop"))
TOPS = int(os.environ.get("SPINTOP_LONG_CASES", "100000"))
SEED = 20124
BATCH = 500
ALLOWED = 10.0
"""Of the inherent error, the printed attitude may be so many times off, and 1e-14."""
DECIDED = 1e-13
"""Relative size of b - a or b + a below which rounding decides how phi passes a pole."""
MISSING = "this build has no FLINT"

INPUT = """\
&study kind = 'trajectory' /
&top mass = {mass!r}, gravity = {gravity!r}, length = {length!r},
     inertia = {inertia1!r}, {inertia1!r}, {inertia3!r} /
&initial phi = {phi!r}, theta = {theta!r}, psi = {psi!r},
         phi_rate = {phi_rate!r}, theta_rate = {theta_rate!r}, {key} = {spin!r} /
&span t_end = {span!r}, samples = 3 /
&integration method = 'exact' /
&output columns = 't', 'theta', 'theta_bound', 'phi', 'phi_bound', 'psi', 'psi_bound',
                  'orientation_bound', 'inherent_error' /
"""


def is_decided(start: Start) -> bool:
    """Whether the data say on which side the axis passes each pole."""
    u, ratio = math.cos(start.theta), start.inertia3 / start.inertia1
    spin = start.spin if start.spin_is_omega3 else start.spin + start.phi_rate * u
    turn, a = start.phi_rate, ratio * spin
    size = abs(start.spin) * ratio + abs(turn)
    return min(abs((1 + u) * turn - a), abs((1 - u) * turn + a)) > DECIDED * size


def ratios(row: dict[str, float], decided: bool) -> Iterator[tuple[str, float]]:
    """Bounds of the numbers of a row over what is claimed."""
    claim = ALLOWED * row["inherent_error"] + 1e-14
    yield "attitude", row["orientation_bound"] / claim
    yield "theta", row["theta_bound"] / (claim + math.ulp(row["theta"]))
    least = min(math.sin(row["theta"] / 2), math.cos(row["theta"] / 2))
    if not decided or claim >= 0.1 * least:
        return
    for name in ("phi", "psi"):
        if math.isfinite(row[f"{name}_bound"]):
            yield name, row[f"{name}_bound"] / (2 * claim / least + math.ulp(row[name]))


class CertifiedTopsTest(unittest.TestCase):
    """Bounds of the errors of the exact solution."""

    def test_all_classes(self) -> None:
        """Three instants of each top; the worst of each class is listed."""
        worst: dict[tuple[str, str], tuple[float, int, float]] = {}
        for first in range(0, TOPS, BATCH):
            self.look_at(range(first, min(first + BATCH, TOPS)), worst)
        listed = [
            f"{kind:12s} {name:9s} {ratio:8.3f} of its claim, number {number} at t = {time!r}"
            for (kind, name), (ratio, number, time) in sorted(worst.items())
        ]
        print("\n".join(listed))
        self.assertEqual({kind for kind, _ in worst}, set(CLASSES))
        faults = [
            line for line, key in zip(listed, sorted(worst), strict=True) if worst[key][0] > 1
        ]
        self.assertEqual(
            faults, [], "numbers outside their claims, or unproved:\n" + "\n".join(faults)
        )

    def look_at(
        self, numbers: range, worst: dict[tuple[str, str], tuple[float, int, float]]
    ) -> None:
        """Compute some tops."""
        drawn = {number: draw_top(number, SEED) for number in numbers}
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for number, (_, start, span) in drawn.items():
                key = "omega3" if start.spin_is_omega3 else "psi_rate"
                text = INPUT.format(**vars(start), key=key, span=span)
                (folder / f"{number}.nml").write_text(text, encoding="utf-8")
            command = [PROGRAM, "--quiet", "-o", ".", *(f"{number}.nml" for number in drawn)]
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if MISSING in run.stderr:
                self.skipTest(MISSING)
            self.assertEqual(run.returncode, 0, run.stderr[:2000])
            for number, (kind, start, _) in drawn.items():
                lines = (folder / f"{number}.csv").read_text(encoding="utf-8").splitlines()
                texts = csv.DictReader(line for line in lines if not line.startswith("#"))
                for row in ({key: float(text) for key, text in row.items()} for row in texts):
                    for name, ratio in ratios(row, is_decided(start)):
                        if ratio > worst.get((kind, name), (-1.0,))[0]:
                            worst[kind, name] = ratio, number, row["t"]


if __name__ == "__main__":
    unittest.main()
