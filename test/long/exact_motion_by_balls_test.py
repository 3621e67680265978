"""The exact motion of random tops of all classes, against ball arithmetic."""

import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest
from dataclasses import astuple, replace
from pathlib import Path

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))

import balls  # noqa: E402

balls.provide()

from flint import arb  # noqa: E402

from ball_top import Answer, Start, ball, motion_at, squared  # noqa: E402
from random_tops import draw_top  # noqa: E402

PROGRAM = os.environ.get("SPINTOP_EXE", str(TESTS.parent / "build/release/spintop"))
TOPS = int(os.environ.get("SPINTOP_LONG_CASES", "10000"))
SEED = 20121
BATCH = 500
ALLOWED = 10.0
"""Of the inherent error, the printed attitude may be so many times off, and 1e-14."""

SWEEP = """\
&study
    kind = 'sweep'
/
&top
    mass = 1.0
    inertia = 1.0, 1.0, 1.0
    length = 1.0
/
&span
    t_end = 1.0
/
&sweep
    table = 'tops.csv'
/
&output
    columns = 'theta_end', 'phi_end', 'psi_end', 'inherent_error'
/
"""
SWEPT = (
    *("top.mass", "top.gravity", "top.inertia(1)", "top.inertia(2)", "top.inertia(3)"),
    *("top.length", "initial.phi", "initial.theta", "initial.psi", "initial.phi_rate"),
    *("initial.theta_rate", "initial.omega3", "span.t_end"),
)
BLOCK = 5e-13
"""Additional error bound of sweeps in closed form: relative, or rad."""

DECIDED = 1e-13
"""Relative size of b - a or b + a below which rounding decides how phi passes a pole."""

INPUT = """\
&study
    kind = 'trajectory'
/
&top
    mass = {mass!r}
    gravity = {gravity!r}
    inertia = {inertia1!r}, {inertia1!r}, {inertia3!r}
    length = {length!r}
/
&initial
    phi = {phi!r}
    theta = {theta!r}
    psi = {psi!r}
    phi_rate = {phi_rate!r}
    theta_rate = {theta_rate!r}
    {key} = {spin!r}
/
&span
    t_end = {span!r}
    samples = 3
/
&integration
    method = 'exact'
/
&output
    columns = 't', 'theta', 'phi', 'psi', 'q0', 'q1', 'q2', 'q3', 'inherent_error'
/
"""


def write_input(start: Start, span: float) -> str:
    """The input of a trajectory of three rows."""
    key = "omega3" if start.spin_is_omega3 else "psi_rate"
    return INPUT.format(**vars(start), key=key, span=span)


def above(value: arb) -> float:
    """An upper bound of the size of a ball."""
    return float(abs(value).upper()) * (1 + 1e-15)


def turn_between(row: dict[str, float], answer: Answer) -> float:
    """Upper bound of the angle between the printed attitude and the true one, rad."""
    printed = [ball(row[f"q{n}"]) for n in range(4)]
    length = sum((squared(part) for part in printed), arb(0)).sqrt()
    chords = []
    for side in (1, -1):
        parts = zip(printed, answer.quaternion, strict=True)
        chord = sum((squared(p / length - side * q) for p, q in parts), arb(0))
        chords.append(math.sqrt(above(chord)))
    return 4 * math.asin(min(min(chords) / 2, 1.0))


def faults_of(row: dict[str, float], answer: Answer, is_decided: bool) -> list[str]:
    """What of a row is further from the motion than its data allow, as so many times the bound."""
    bound = ALLOWED * row["inherent_error"] + 1e-14
    errors = {"attitude": turn_between(row, answer) / bound}
    errors["theta"] = above(ball(row["theta"]) - answer.theta) / (bound + math.ulp(row["theta"]))
    if answer.phi is not None:
        lower, upper = math.sin(row["theta"] / 2), math.cos(row["theta"] / 2)
        phi, psi = (ball(row[name]) - getattr(answer, name) for name in ("phi", "psi"))
        one, other = math.ulp(row["phi"]), math.ulp(row["psi"])
        least = min(lower, upper)
        for name, angle, size, rounding in (
            ("phi + psi", phi + psi, upper, one + other),
            ("phi - psi", phi - psi, lower, one + other),
            ("phi", phi, least, one),
            ("psi", psi, least, other),
        ):
            if bound < 0.1 * size:
                off = angle if is_decided else within_turn(angle)
                errors[name] = above(off) / (2 * bound / size + rounding)
    return [f"{name} {ratio:.3g}" for name, ratio in errors.items() if not ratio <= 1]


def faults_of_end(row: dict[str, str], answer: Answer, is_decided: bool) -> list[str]:
    """The same for the row of a sweep, which has the angles alone."""
    theta, phi, psi, floor = (
        float(row[name]) for name in ("theta_end", "phi_end", "psi_end", "inherent_error")
    )
    bound = ALLOWED * floor + BLOCK * max(1.0, abs(phi) + abs(psi))
    errors = {"theta": above(ball(theta) - answer.theta) / bound}
    if answer.phi is not None:
        least = min(math.sin(theta / 2), math.cos(theta / 2))
        for name, value, true in (("phi", phi, answer.phi), ("psi", psi, answer.psi)):
            if bound < 0.1 * least:
                off = ball(value) - true
                errors[name] = above(off if is_decided else within_turn(off)) / (2 * bound / least)
    return [f"{name} {ratio:.3g}" for name, ratio in errors.items() if not ratio <= 1]


def within_turn(angle: arb) -> arb:
    """An angle without its whole turns."""
    turns = round(float(angle.mid()) / (2 * math.pi))
    return angle - 2 * arb.pi() * turns


def is_decided(start: Start) -> bool:
    """Whether the data say on which side the axis passes each pole.

    phi turns by nearly pi there, one way or the other, as the signs of b - a and b + a are. Where
    these are of the size of rounding, phi and psi are known but for whole turns.
    """
    u, ratio = math.cos(start.theta), start.inertia3 / start.inertia1
    spin = start.spin if start.spin_is_omega3 else start.spin + start.phi_rate * u
    turn, a = start.phi_rate, ratio * spin
    size = abs(start.spin) * ratio + abs(turn)
    return min(abs((1 + u) * turn - a), abs((1 - u) * turn + a)) > DECIDED * size


class ExactMotionTest(unittest.TestCase):
    """Printed attitudes are where balls say."""

    def test_all_classes(self) -> None:
        """At three instants of each top: quaternion, theta, phi and psi."""
        faults: list[str] = []
        for first in range(0, TOPS, BATCH):
            faults += self.look_at(range(first, min(first + BATCH, TOPS)))
        if faults:
            self.fail(f"{len(faults)} rows are wrong:\n" + "\n".join(faults[:40]))

    def test_sweep(self) -> None:
        """The same tops as a sweep, by its angles at the end of the span."""
        drawn = [draw_top(number, SEED + 1) for number in range(TOPS)]
        tops = [(kind, replace(start, spin_is_omega3=True), span) for kind, start, span in drawn]
        lines = [",".join(SWEPT)]
        for _, start, span in tops:
            i1, i3, mass, gravity, length, *motion = astuple(start)[:11]
            cells = [mass, gravity, i1, i1, i3, length, *motion, span]
            lines.append(",".join(map(repr, cells)))
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "tops.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
            (folder / "a.nml").write_text(SWEEP, encoding="utf-8")
            run = subprocess.run(
                [PROGRAM, "--quiet", "-o", ".", "a.nml"],
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )
            self.assertEqual(run.returncode, 0, run.stderr[:2000])
            table = (folder / "a.csv").read_text(encoding="utf-8").splitlines()
        rows = list(csv.DictReader(line for line in table if not line.startswith("#")))
        faults = []
        for number, (row, (kind, start, span)) in enumerate(zip(rows, tops, strict=True)):
            self.assertEqual(row["status"], "ok")
            if wrong := faults_of_end(row, motion_at(start, [span])[0], is_decided(start)):
                faults.append(f"{number} ({kind}): {', '.join(wrong)}")
        if faults:
            self.fail(f"{len(faults)} rows are wrong:\n" + "\n".join(faults[:40]))

    def look_at(self, numbers: range) -> list[str]:
        """Errors for some tops."""
        drawn = {number: draw_top(number, SEED) for number in numbers}
        faults = []
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for number, (_, start, span) in drawn.items():
                (folder / f"{number}.nml").write_text(write_input(start, span), encoding="utf-8")
            inputs = [f"{number}.nml" for number in drawn]
            run = subprocess.run(
                [PROGRAM, "--quiet", "-o", ".", *inputs],
                cwd=folder,
                capture_output=True,
                text=True,
                check=False,
            )
            self.assertEqual(run.returncode, 0, run.stderr[:2000])
            for number, (kind, start, _) in drawn.items():
                lines = (folder / f"{number}.csv").read_text(encoding="utf-8").splitlines()
                texts = csv.DictReader(line for line in lines if not line.startswith("#"))
                rows = [{key: float(text) for key, text in row.items()} for row in texts]
                answers = motion_at(start, [row["t"] for row in rows])
                decided = is_decided(start)
                for row, answer in zip(rows, answers, strict=True):
                    wrong = faults_of(row, answer, decided)
                    if wrong:
                        faults.append(f"{number} ({kind}) at t = {row['t']!r}: {', '.join(wrong)}")
        return faults


if __name__ == "__main__":
    unittest.main()
