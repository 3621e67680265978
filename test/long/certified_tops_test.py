"""Random symmetric tops of all classes, certified by the program: none outside its claim."""

import math
import os
from collections.abc import Iterator
from dataclasses import astuple, replace

from conftest import read
from proof_test import needs_flint
from random_tops import CLASSES, Start, draw_top

pytestmark = needs_flint

TOPS = int(os.environ.get("SPINTOP_LONG_CASES", "5000"))
SEED = 20124
BATCH = 500
TURNS = 20
"""A motion is proved up to so many: a proof goes through all of it."""
ALLOWED = 10.0
"""Of the inherent error, the printed attitude may be so many times off, and 1e-14."""
DECIDED = 1e-13
"""Relative size of b - a or b + a below which rounding decides how phi passes a pole."""

INPUT = """\
&study kind = 'trajectory' /
&top mass = {mass!r}, gravity = {gravity!r}, length = {length!r},
     inertia = {inertia1!r}, {inertia1!r}, {inertia3!r} /
&initial phi = {phi!r}, theta = {theta!r}, psi = {psi!r},
         phi_rate = {phi_rate!r}, theta_rate = {theta_rate!r}, {key} = {spin!r} /
&span t_end = {span!r}, samples = 3 /
&integration method = 'exact' /
&output columns = 't', 'theta', 'theta_bound', 'phi', 'phi_bound', 'psi', 'psi_bound',
                  'omega1_bound', 'omega2_bound', 'omega3_bound', 'orientation_bound',
                  'inherent_error' /
"""
SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 1.0, 1.0, 1.0, length = 1.0 /
&span t_end = 1.0 /
&sweep table = 'tops.csv' /
&output columns = 'theta_end', 'theta_end_bound', 'phi_end', 'phi_end_bound', 'psi_end',
                  'psi_end_bound', 'inherent_error' /
"""
SWEPT = (
    *("top.mass", "top.gravity", "top.inertia(1)", "top.inertia(2)", "top.inertia(3)"),
    *("top.length", "initial.phi", "initial.theta", "initial.psi", "initial.phi_rate"),
    *("initial.theta_rate", "initial.omega3", "span.t_end"),
)
BLOCK = 5e-13
"""Additional error bound of sweeps in closed form: relative, or rad."""


def shortened(kind: str, start: Start, span: float) -> tuple[str, Start, float]:
    """A top with the first part of its span."""
    pull = abs(start.mass * start.gravity * start.length / start.inertia1)
    speed = abs(start.spin) + abs(start.phi_rate) + abs(start.theta_rate) + math.sqrt(pull)
    return kind, start, min(span, TURNS * math.tau / speed)


def is_decided(start: Start) -> bool:
    """Whether the data say on which side the axis passes each pole."""
    u, ratio = math.cos(start.theta), start.inertia3 / start.inertia1
    spin = start.spin if start.spin_is_omega3 else start.spin + start.phi_rate * u
    turn, a = start.phi_rate, ratio * spin
    size = abs(start.spin) * ratio + abs(turn)
    return min(abs((1 + u) * turn - a), abs((1 - u) * turn + a)) > DECIDED * size


def speed_of(start: Start) -> float:
    """At least the angular velocity, from the energy and the smaller moment of inertia."""
    spin = start.spin
    if not start.spin_is_omega3:
        spin += start.phi_rate * math.cos(start.theta)
    turning = (start.phi_rate * math.sin(start.theta)) ** 2 + start.theta_rate**2
    weight = start.mass * start.gravity * start.length
    energy = start.inertia1 * turning + start.inertia3 * spin**2 + 4 * weight
    return math.sqrt(energy / min(start.inertia1, start.inertia3))


def ratios(row: dict[str, float], start: Start) -> Iterator[tuple[str, float]]:
    """Bounds of the numbers of a row over what is claimed."""
    claim = ALLOWED * row["inherent_error"] + 1e-14
    omega = max(row[f"omega{i}_bound"] for i in (1, 2, 3))
    yield "omega", omega / (claim * speed_of(start) or math.ulp(0))
    yield "attitude", row["orientation_bound"] / claim
    yield "theta", row["theta_bound"] / (claim + math.ulp(row["theta"]))
    least = min(math.sin(row["theta"] / 2), math.cos(row["theta"] / 2))
    if not is_decided(start) or claim >= 0.1 * least:
        return
    for name in ("phi", "psi"):
        if math.isfinite(row[f"{name}_bound"]):
            yield name, row[f"{name}_bound"] / (2 * claim / least + math.ulp(row[name]))


def test_all_classes(spin):
    """Three instants of each top; the worst of each class is listed."""
    worst = {}
    for first in range(0, TOPS, BATCH):
        look_at(spin, range(first, min(first + BATCH, TOPS)), worst)
    listed = [
        f"{kind:12s} {name:9s} {ratio:8.3f} of its claim, number {number} at t = {time!r}"
        for (kind, name), (ratio, number, time) in sorted(worst.items())
    ]
    print("\n".join(listed))
    assert {kind for kind, _ in worst} == set(CLASSES)
    faults = [line for line, key in zip(listed, sorted(worst), strict=True) if worst[key][0] > 1]
    assert not faults, "numbers outside their claims, or unproved:\n" + "\n".join(faults)


def test_too_many_steps(spin):
    """The work is bounded: far away nothing is proved, and what comes before it is."""
    _, start, _ = draw_top(0, SEED)
    text = INPUT.format(**vars(start), key="psi_rate", span=2e6).replace("'t',", "'t', 'proof',")
    assert list(spin(text).rows.proof) == ["proved", "unproved", "unproved"]


def look_at(spin, numbers, worst):
    drawn = {number: shortened(*draw_top(number, SEED)) for number in numbers}
    for number, (_, start, span) in drawn.items():
        key = "omega3" if start.spin_is_omega3 else "psi_rate"
        spin.write(INPUT.format(**vars(start), key=key, span=span), f"{number}.nml")
    spin.call("--quiet", *(f"{number}.nml" for number in drawn))
    for number, (kind, start, _) in drawn.items():
        for _, row in read(spin.folder / f"output/{number}.csv").iterrows():
            for quantity, ratio in ratios(row, start):
                if ratio > worst.get((kind, quantity), (-1.0,))[0]:
                    worst[kind, quantity] = ratio, number, row["t"]


def test_sweep(spin):
    """The same tops as a sweep, by its angles at the end of the span."""
    drawn = [shortened(*draw_top(number, SEED + 1)) for number in range(TOPS)]
    tops = [(kind, replace(start, spin_is_omega3=True), span) for kind, start, span in drawn]
    lines = [",".join(SWEPT)]
    for _, start, span in tops:
        i1, i3, mass, gravity, length, *motion = astuple(start)[:11]
        cells = [mass, gravity, i1, i1, i3, length, *motion, span]
        lines.append(",".join(map(repr, cells)))
    run = spin(SWEEP, tops="\n".join([*lines, ""]))
    assert set(run.rows.status) == {"ok"}
    faults = []
    for number, (row, (kind, start, _)) in enumerate(zip(run.rows.itertuples(), tops, strict=True)):
        size = max(1.0, abs(row.phi_end) + abs(row.psi_end))
        claim = ALLOWED * row.inherent_error + BLOCK * size
        least = min(math.sin(row.theta_end / 2), math.cos(row.theta_end / 2))
        found = {"theta": row.theta_end_bound / claim}
        if is_decided(start) and claim < 0.1 * least:
            for name in ("phi", "psi"):
                bound = getattr(row, f"{name}_end_bound")
                if math.isfinite(bound):
                    found[name] = bound / (2 * claim / least)
        faults += [f"{number} ({kind}): {name} {x:.3g}" for name, x in found.items() if not x <= 1]
    assert not faults, "\n".join(faults[:40])
