"""Symmetric tops of all classes, proved twice: by the closed form, and step by step."""

import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))

from random_tops import Start, draw_top  # noqa: E402

PROGRAM = os.environ.get("SPINTOP_EXE", str(TESTS.parent / "build/release/spintop"))
TOPS = int(os.environ.get("SPINTOP_LONG_CASES", "1000"))
SEED = 70412
MISSING = "this build has no FLINT"
TURNS = 20
"""A motion may turn so often: the number of its steps grows with it."""
NO_FORM = "&effects torque_body = 1e-300, 0, 0 /\n"
"""A torque that changes no digit, with which a top has no closed form."""

INPUT = """\
&study kind = 'trajectory' /
&top mass = {mass!r}, gravity = {gravity!r}, length = {length!r},
     inertia = {inertia1!r}, {inertia1!r}, {inertia3!r} /
&initial phi = {phi!r}, theta = {theta!r}, psi = {psi!r},
         phi_rate = {phi_rate!r}, theta_rate = {theta_rate!r}, {key} = {spin!r} /
&span t_end = {span!r}, samples = 3 /
&integration method = {method!r}, {steps} /
&output certified = .true.
        columns = 't', 'q0', 'q1', 'q2', 'q3', 'theta', 'phi', 'psi', 'proof' /
"""


class AnyBodyTest(unittest.TestCase):
    """Two proofs of one motion."""

    def test_tops(self) -> None:
        """Both are within 3/4 of a last place, so that they are at most two places apart."""
        outcomes: Counter[str] = Counter()
        for number in range(TOPS):
            _, start, span = draw_top(number, SEED)
            pull = abs(start.mass * start.gravity * start.length / start.inertia1)
            speed = abs(start.spin) + abs(start.phi_rate) + abs(start.theta_rate) + math.sqrt(pull)
            span = min(span, TURNS * math.tau / speed)
            closed = self.rows(start, span, "")
            stepped = self.rows(start, span, NO_FORM)
            for one, other in zip(closed, stepped, strict=True):
                outcomes[other["proof"]] += 1
                if "unproved" not in (one["proof"], other["proof"]):
                    self.compare(number, one, other)
        print(dict(outcomes))
        self.assertGreater(outcomes["proved"], 0.9 * sum(outcomes.values()))

    def compare(self, number: int, one: dict[str, str], other: dict[str, str]) -> None:
        """Compare two rows; phi and psi may differ by whole turns after a passage of a pole."""
        for name in ("q0", "q1", "q2", "q3", "theta", "phi", "psi"):
            a, b = float(one[name]), float(other[name])
            off = abs(a - b)
            if name in ("phi", "psi"):
                off = abs(math.remainder(off, math.tau))
            self.assertLessEqual(off, 2 * math.ulp(max(abs(a), abs(b), 1e-8)), (number, name, a, b))

    def rows(self, start: Start, span: float, effects: str) -> list[dict[str, str]]:
        """Return the certified rows of a top."""
        key = "omega3" if start.spin_is_omega3 else "psi_rate"
        method, steps = ("rk4", "steps = 2") if effects else ("exact", "")
        text = INPUT.format(**vars(start), key=key, span=span, method=method, steps=steps)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "top.nml").write_text(text + effects, encoding="utf-8")
            command = [PROGRAM, "--quiet", "-o", ".", "top.nml"]
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if MISSING in run.stderr:
                self.skipTest(MISSING)
            self.assertIn(run.returncode, (0, 3), run.stderr[:2000])
            lines = (Path(folder) / "top.csv").read_text(encoding="utf-8").splitlines()
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


if __name__ == "__main__":
    unittest.main()
