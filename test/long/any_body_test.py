"""Bodies with a closed form, proved twice: by that, and step by step."""

import math
import os
import random
import sys
import unittest
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))

from batch_case import BatchCase  # noqa: E402
from random_tops import draw_top  # noqa: E402

CASES = int(os.environ.get("SPINTOP_LONG_CASES", "1000"))
SEED = 70412
BATCH = 50
TURNS = 20
"""A motion may turn so often: the number of its steps grows with it."""
NO_FORM = "&effects torque_body = 1e-300, 0, 0 /\n"
"""A torque that changes no digit, with which a body has no closed form."""
ANGLES = ("phi", "psi")
NUMBERS = ("q0", "q1", "q2", "q3", "theta", *ANGLES, "omega1", "omega2", "omega3")

TOP = """\
&top mass = {mass!r}, gravity = {gravity!r}, length = {length!r},
     inertia = {inertia1!r}, {inertia1!r}, {inertia3!r} /
&initial phi = {phi!r}, theta = {theta!r}, psi = {psi!r},
         phi_rate = {phi_rate!r}, theta_rate = {theta_rate!r}, {key} = {spin!r} /
"""
FREE = """\
&top mass = 1, gravity = 0, length = 0, inertia = {inertia} /
&initial quaternion = {quaternion}, omega = {omega} /
"""
REST = """\
&study kind = 'trajectory' /
&span t_end = {span!r}, samples = 3 /
&integration method = {method} /
&output certified = .true.  columns = 't', 'proof', {columns} /
"""


def tops() -> Iterator[tuple[str, float]]:
    """Inputs of tops of all classes, and their spans."""
    for number in range(CASES):
        _, start, span = draw_top(number, SEED)
        pull = abs(start.mass * start.gravity * start.length / start.inertia1)
        speed = abs(start.spin) + abs(start.phi_rate) + abs(start.theta_rate) + math.sqrt(pull)
        key = "omega3" if start.spin_is_omega3 else "psi_rate"
        yield TOP.format(**vars(start), key=key), min(span, TURNS * math.tau / speed)


def free_bodies() -> Iterator[tuple[str, float]]:
    """Inputs of free bodies: of any shape, rods and discs, some next to the intermediate axis."""
    for number in range(CASES):
        draw = random.Random(SEED + number)
        sides = [draw.lognormvariate(0, 1) for _ in range(3)]
        if number % 5 == 2:
            sides[1] = sides[draw.choice([0, 2])]
        if number % 5 == 0:
            sides[draw.randrange(3)] *= draw.choice([1e-4, 1e4])
        inertia = [sum(x * x for x in sides) - side * side for side in sides]
        omega = [draw.gauss(0, 1) for _ in range(3)]
        if number % 5 == 1:
            middle = sorted(range(3), key=inertia.__getitem__)[1]
            small = 10 ** draw.uniform(-15, -1)
            omega = [draw.gauss(0, 1 if i == middle else small) for i in range(3)]
        momentum = [i * w for i, w in zip(inertia, omega, strict=True)]
        fastest = math.hypot(*momentum) / min(inertia)
        q = [draw.gauss(0, 1) for _ in range(4)]
        q = [x / math.hypot(*q) for x in q]
        numbers = {"inertia": inertia, "quaternion": q, "omega": omega}
        text = FREE.format(**{key: repr(value)[1:-1] for key, value in numbers.items()})
        yield text, TURNS * math.tau / fastest * draw.uniform(0.1, 1)


class AnyBodyTest(BatchCase):
    """Two proofs of one motion."""

    def test_tops(self) -> None:
        """Symmetric tops of all classes."""
        self.compare_all(tops())

    def test_free_bodies(self) -> None:
        """Free bodies of all shapes."""
        self.compare_all(free_bodies())

    def compare_all(self, bodies: Iterator[tuple[str, float]]) -> None:
        """Both are within 3/4 of a last place, so that they are at most two places apart."""
        outcomes: Counter[str] = Counter()
        columns = ", ".join(f"'{name}'" for name in NUMBERS)
        texts: dict[str, str] = {}
        drawn = 0
        for number, (text, span) in enumerate(bodies):
            drawn = number + 1
            for kind, method, effect in (
                ("closed", "'exact'", ""),
                ("stepped", "'dop853'", NO_FORM),
            ):
                rest = REST.format(span=span, method=method, columns=columns)
                texts[f"{kind}{number}"] = text + rest + effect
            if drawn % BATCH == 0 or drawn == CASES:
                tables = self.compute(texts, (0, 3))
                for name in [name for name in tables if name.startswith("closed")]:
                    stepped = tables[name.replace("closed", "stepped")]
                    for one, other in zip(tables[name], stepped, strict=True):
                        outcomes[other["proof"]] += 1
                        if "unproved" not in (one["proof"], other["proof"]):
                            self.compare(texts[name], one, other)
                texts = {}
        print(dict(outcomes))
        self.assertEqual(drawn, CASES)
        self.assertGreater(outcomes["proved"], 0.9 * sum(outcomes.values()))

    def compare(self, text: str, one: dict[str, str], other: dict[str, str]) -> None:
        """Compare two rows; phi and psi may differ by whole turns after a passage of a pole."""
        for name in NUMBERS:
            a, b = float(one[name]), float(other[name])
            off = abs(a - b)
            if name in ANGLES:
                off = abs(math.remainder(off, math.tau))
            self.assertLessEqual(off, 2 * math.ulp(max(abs(a), abs(b), 1e-8)), (name, a, b, text))


if __name__ == "__main__":
    unittest.main()
