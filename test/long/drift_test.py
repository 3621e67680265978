"""Constants of long motions by Taylor series: errors as those of a random walk (Brouwer)."""

import math
import os
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from conftest import Spin

TOPS, PERIOD, STEPS_A_NUTATION = 32, 1.5, 11
USUAL = 30_000
NUTATIONS = int(os.environ.get("SPINTOP_NUTATIONS", USUAL))
SIZES = {"energy": 1.0, "Lz": 3.0, "norm": 1.0, "energy_max": 1.0}
"""Largest errors in 1e-16 times the root of the number of steps."""
LARGEST_POWER = 0.65
"""Of time, between a hundredth of the span and its end; 32 random walks scatter by 0.05."""
LARGEST_NORM = 2e-14
"""Of the error of the norm, over the usual span."""
SAMPLES, EARLY, LATE = 401, slice(2, 7), slice(361, 401)
ROTOR = "&effects rotor_momentum = 0, 0, 0.3 /"


def start_of(k: int, symmetric: bool) -> dict[str, float]:
    """The k-th top: inclinations from 0.15 to 2.7 rad, loops, cusps and waves."""
    first = 0.875 + 0.005 * k
    return {
        "top.inertia(1)": first,
        "top.inertia(2)": first if symmetric or k % 2 == 0 else first - 0.175,
        "initial.theta": 0.15 + 2.55 * k / (TOPS - 1),
        "initial.phi_rate": 0.3 * (k % 3),
        "initial.psi_rate": 1 + 4.5 * (7 * k % TOPS) / TOPS,
    }


def scene(start: dict[str, float], formulation: str, span: str, more: str = "") -> str:
    """An input whose motion has this start, without its study and its columns."""
    groups = {"top": "mass = 1  inertia(3) = 0.25  length = 0.8660254037844387", "initial": ""}
    for name, value in start.items():
        group, key = name.split(".")
        groups[group] += f"  {key} = {value!r}"
    return (
        "\n".join(f"&{group} {text} /" for group, text in groups.items())
        + f"""
{more}
&span {span} /
&integration formulation = '{formulation}'  method = 'taylor'  relative_tolerance = 0
             max_steps = 200000000 /
"""
    )


def run(folder: Path, name: str, text: str) -> dict[str, list[float]]:
    words = ("--quiet", "--threads=1", "--output=.")
    rows = Spin(folder)(text, *words, name=name).rows
    return {column: rows[column].to_list() for column in rows}


def root_mean_square(errors: list[float]) -> float:
    return math.sqrt(sum(error**2 for error in errors) / len(errors))


@pytest.mark.usefixtures("folder")
class DriftTest(unittest.TestCase):
    """Root mean squares over an ensemble, early in the span and at its end."""

    def check(self, kind: str, sizes: dict[str, tuple[float, float]], growth: float) -> None:
        """The errors grow with the root of time, and remain within the rounding of the state."""
        for name, (early, late) in sizes.items():
            power = math.log(late / early) / math.log(growth)
            print(f"{kind:14} {name:10} {early:.1e} {late:.1e} {power:.2f}", file=sys.stderr)
            with self.subTest(kind=kind, constant=name):
                steps = NUTATIONS * STEPS_A_NUTATION
                self.assertLess(late, SIZES[name] * 1e-16 * math.sqrt(steps))
                self.assertLess(power, LARGEST_POWER)
                if name == "norm" and NUTATIONS <= USUAL:
                    self.assertLess(late, LARGEST_NORM)

    def follow(self, kind: str, formulation: str, more: str, symmetric: bool) -> None:
        def errors_of(k: int) -> dict[str, list[float]]:
            span = f"t_end = {NUTATIONS * PERIOD}  samples = {SAMPLES}"
            text = scene(start_of(k, symmetric), formulation, span, more)
            text += "&output columns = 't', 'energy_error', 'lz', 'norm_error' /\n"
            rows = run(self.folder, str(k), "&study kind = 'trajectory' /\n" + text)
            lz = rows["lz"]
            change = [(value - lz[0]) / max(abs(lz[0]), 0.5) for value in lz]
            return {"energy": rows["energy_error"], "Lz": change, "norm": rows["norm_error"]}

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            errors = list(pool.map(errors_of, range(TOPS)))

        def size(name: str, rows: slice) -> float:
            return root_mean_square([error for top in errors for error in top[name][rows]])

        sizes = {name: (size(name, EARLY), size(name, LATE)) for name in errors[0]}
        self.check(kind, sizes, (LATE.start + LATE.stop - 1) / (EARLY.start + EARLY.stop - 1))

    def test_motions(self) -> None:
        """Symmetric tops, of which over 1e5 nutations the power of Lz is 0.71, and others."""
        self.follow("space_frame", "space_frame", "", True)
        self.follow("rigid_body", "rigid_body", "", False)
        self.follow("rotor", "rigid_body", ROTOR, False)

    def test_lanes(self) -> None:
        """The largest error of a motion, of all bodies at once."""
        growth = 64
        starts = [start_of(k, symmetric=False) for k in range(TOPS)]
        keys = [key for key in starts[0] if key != "top.inertia(2)"]
        lists = "".join(
            f"  values({i},:) = {', '.join(repr(start[key]) for start in starts)}\n"
            for i, key in enumerate(keys, 1)
        )
        names = ", ".join(f"'{key}'" for key in keys)
        sizes = []
        for nutations in (NUTATIONS / growth, NUTATIONS):
            top = starts[0] | {"top.inertia(2)": 0.85}
            text = scene(top, "rigid_body", f"t_end = {nutations * PERIOD}")
            text += f"&sweep parameter = {names}  combine = 'zip'\n{lists} /\n"
            text += "&output columns = 'energy_error_max' /\n"
            rows = run(self.folder, "lanes", "&study kind = 'sweep' /\n" + text)
            sizes.append(root_mean_square(rows["energy_error_max"]))
        self.check("lanes", {"energy_max": (sizes[0], sizes[1])}, growth)
