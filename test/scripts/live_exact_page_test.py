"""Tests of the exact solution in JavaScript, in a browser, against the program's tables."""

import csv
import json
import math
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS)]

from browser_case import BROWSER, PROGRAM, SOFTWARE_WEBGL, open_browser  # noqa: E402
from random_tops import CLASSES, draw_top  # noqa: E402
from reporting.bundle import bundle  # noqa: E402
from reporting.packages import PackageError, esbuild_package, need  # noqa: E402
from spintop_figures import read_table  # noqa: E402
from spintop_figures.moving.body import read_body  # noqa: E402

ROOT = TESTS.parent
TOPS, SEED = 1000, 77
"""Random tops of each class."""

WELL_CONDITIONED = 1e-3
"""1 - k^2 above which the period is compared; near the separatrix it depends on the last digits."""

LONGEST = 1e4
"""Span of a top at most, in natural periods. The rounding errors of double precision grow with it;
the program has its phases in extended precision."""

LEAST, FLOORS = 1e-9, 100.0
"""The attitude is right to this angle, or to so many times the inherent error."""

NOT_ALL_FINITE = 3
"""The exit code where a motion has no nutation period."""

BATCH = 2000
LIMITS = {"cusp", "steady", "separatrix"}
"""Classes that are the limit of others: rounding may decide."""

SWEPT = (
    *("top.mass", "top.gravity", "top.inertia(1)", "top.inertia(2)", "top.inertia(3)"),
    *("top.length", "initial.phi", "initial.theta", "initial.psi", "initial.phi_rate"),
    *("initial.theta_rate", "initial.omega3", "span.t_end"),
)
SWEPT_KEYS = (
    *("mass", "gravity", "inertia1", "inertia1", "inertia3", "length"),
    *("phi", "theta", "psi", "phiRate", "thetaRate", "omega3"),
)
"""The same in the page."""

SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0  inertia = 1.0, 1.0, 1.0  length = 1.0 /
&span t_end = 1.0 /
&sweep table = 'tops.csv' /
&output columns = 'theta_end', 'phi_end', 'psi_end', 'inherent_error', 'motion_class',
    'theta_min', 'theta_max', 'nutation_period' /
"""

INPUTS = (
    *("slow_top", "tip_cusp", "tip_loop", "tip_wave", "regular_precession", "separatrix"),
    "spinning_wheel",
)
STATE = (
    *("phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate", "omega1", "omega2", "omega3"),
    *("q0", "q1", "q2", "q3"),
)


def top_of(i1: float, i3: float, weight: float, *angles_and_rates: float) -> dict[str, float]:
    """A top of unit mass, with the weight as gravity and a unit of length."""
    names = ("phi", "theta", "psi", "phiRate", "thetaRate", "omega3")
    start = dict(zip(names, angles_and_rates, strict=True))
    return {"mass": 1.0, "gravity": weight, "inertia1": i1, "inertia3": i3, "length": 1.0} | start


SPECIAL = {
    "asleep, stable": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 20), 10),
    "asleep, unstable": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 2), 1),
    "asleep at the threshold": (top_of(1, 1, 4, 0.3, 0, 0.1, 0, 0, 4), 10),
    "at rest upright": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 0), 1),
    "hanging at rest": (top_of(1, 0.5, 9.81, 0.3, math.pi, 0.1, 0, 0, 3), 10),
    "hanging, pushed": (top_of(1, 0.5, 9.81, 0.3, math.pi, 0.1, 0, 1.5, 3), 100),
    "upright, pushed": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 1.5, 30), 100),
    "separatrix itself": (top_of(1, 0.5, 2, 0.3, math.pi / 2, 0.1, 0.5, math.sqrt(3.75), 1), 20),
    "plane, through the bottom": (top_of(1, 0.5, 9.81, 0.3, 2.0, 0.1, 0, 0, 0), 100),
    "plane, over the top": (top_of(1, 0.5, 9.81, 0.3, 2.0, 0.1, 0, 9, 0), 100),
    "plane, spinning in thought": (top_of(1, 0.5, 9.81, 0.3, math.pi, 0.1, 0, 7, 0), 100),
    "through the bottom": (top_of(1, 0.5, 9.81, 0.3, math.pi / 2, 0.1, -1, 0.4, 2), 100),
    "through the top": (top_of(1, 0.5, 1, 0.3, math.pi / 2, 0.1, 4, 4, 8), 100),
    "no weight": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 2, 1, 8), 100),
    "no weight, at rest": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 0, 0, 0), 100),
    "no weight, spin only": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 0, 0, 5), 100),
    "thin rod": (top_of(1, 1e-6, 9.81, 0.3, 1.0, 0.1, 1, 0.5, 5), 100),
    "fast": (top_of(1, 0.5, 9.81, 0.3, 1.0, 0.1, 0, 0, 2e4), 50),
}
"""Tops and times, s."""


def random_tops() -> list[tuple[str, dict[str, float], float]]:
    """Class, top and span of `TOPS` tops of each class."""
    tops = []
    for number in range(TOPS * len(CLASSES)):
        kind, start, span = draw_top(number, SEED)
        top = {
            "mass": start.mass,
            "gravity": start.gravity,
            "inertia1": start.inertia1,
            "inertia3": start.inertia3,
            "length": start.length,
            "phi": start.phi,
            "theta": start.theta,
            "psi": start.psi,
            "phiRate": start.phi_rate,
            "thetaRate": start.theta_rate,
            "omega3": start.spin,
        }
        if not start.spin_is_omega3:
            top["omega3"] += start.phi_rate * math.cos(start.theta)
        tops.append((kind, top, min(span, LONGEST * natural_period(top))))
    return tops


def natural_period(top: dict[str, float]) -> float:
    """The span within which a top turns about once, s."""
    weight = 2 * top["mass"] * top["gravity"] * top["length"] / top["inertia1"]
    spin = top["inertia3"] * top["omega3"] / top["inertia1"]
    rate = math.sqrt(weight + spin**2 + top["thetaRate"] ** 2 + top["phiRate"] ** 2)
    return 2 * math.pi / rate if rate else 1.0


def by_program(folder: Path, tops: list[tuple[str, dict[str, float], float]]) -> list[dict]:
    """The rows of the program's sweep over these tops."""
    with (folder / "tops.csv").open("w", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(SWEPT)
        for _, top, span in tops:
            values = [top[key] for key in SWEPT_KEYS] + [span]
            writer.writerow([repr(float(value)) for value in values])
    (folder / "sweep.nml").write_text(SWEEP, encoding="utf-8")
    command = [PROGRAM, "--quiet", "-o", folder / "out", folder / "sweep.nml"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode not in (0, NOT_ALL_FINITE):
        raise AssertionError(done.stderr)
    return read_rows(folder / "out" / "sweep.csv")


def read_rows(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if line[0] != "#"))


def quaternion(phi: float, theta: float, psi: float) -> np.ndarray:
    """The attitude with these angles."""
    plus, minus = (phi + psi) / 2, (phi - psi) / 2
    c, s = math.cos(theta / 2), math.sin(theta / 2)
    return np.array(
        [c * math.cos(plus), s * math.cos(minus), s * math.sin(minus), c * math.sin(plus)]
    )


def turn_between(p: np.ndarray, q: np.ndarray) -> float:
    """The rotation angle between two attitudes, rad."""
    return 4 * math.asin(min(1.0, min(np.linalg.norm(p - q), np.linalg.norm(p + q)) / 2))


@unittest.skipUnless(BROWSER, "no browser: scripts/test installs one, where it may")
class ExactTest(unittest.TestCase):
    """The modules in `page/exact`, against tables of the program."""

    @classmethod
    def setUpClass(cls) -> None:
        """Start a browser with the modules."""
        try:
            for name in ("three", esbuild_package()):
                need(name)
        except PackageError as error:
            raise unittest.SkipTest(str(error)) from error
        scratch = tempfile.TemporaryDirectory(prefix="exact ", ignore_cleanup_errors=True)
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        page = cls.folder / "exact.html"
        script = bundle(TESTS / "page" / "exact_entry.js")
        page.write_text(
            "<!DOCTYPE html><meta charset=utf-8><link rel=icon href='data:,'>"
            f"<script>{script}</script>",
            encoding="utf-8",
        )
        cls.browser = open_browser(cls.folder / "profile", *SOFTWARE_WEBGL)
        cls.addClassCleanup(cls.browser.quit)
        cls.browser.get(page.as_uri())

    def in_page(self, tops: list[tuple[dict[str, float], list[float]]]) -> list[dict]:
        """Regime, nutation and states of tops at times, as the page computes them."""
        found = []
        for first in range(0, len(tops), BATCH):
            batch = [{"top": top, "times": times} for top, times in tops[first : first + BATCH]]
            text = self.browser.execute_script("return motionsOf(arguments[0])", batch)
            found += json.loads(text)
        return found

    def compare(
        self, tops: list[tuple[str, dict[str, float], float]], rows: list[dict], found: list[dict]
    ) -> Counter[tuple[str, str]]:
        """The attitude at the end and turning angles; count the classes that differ."""
        others: Counter[tuple[str, str]] = Counter()
        for (kind, top, span), row, motion in zip(tops, rows, found, strict=True):
            state, nutation = motion["states"][0], motion["nutation"]
            allowed = max(LEAST, FLOORS * float(row["inherent_error"]))
            right = quaternion(*(float(row[f"{name}_end"]) for name in ("phi", "theta", "psi")))
            for q in (np.array(state["quaternion"]), quaternion(*state["angle"])):
                self.assertLessEqual(turn_between(right, q), allowed, (kind, top, span))
            classes = (row["motion_class"], nutation["motionClass"])
            others[classes] += classes[0] != classes[1]
            for name in ("min", "max"):
                angle, right_angle = nutation[f"theta{name.title()}"], row[f"theta_{name}"]
                self.assertAlmostEqual(angle, float(right_angle), delta=2e-7, msg=(kind, top))
            if nutation["complementSquared"] > WELL_CONDITIONED:
                period = float(row["nutation_period"])
                if math.isfinite(period):
                    self.assertLess(abs(nutation["period"] - period), 1e-9 * period, (kind, top))
        return +others

    def test_random_tops(self) -> None:
        """At 1,000 random tops of each class: the attitude at the end of the span."""
        tops = random_tops()
        rows = by_program(self.folder, tops)
        found = self.in_page([(top, [span]) for _, top, span in tops])
        others = self.compare(tops, rows, found)
        self.assertLess(others.total(), len(tops) / 1000)
        for classes in others:
            self.assertTrue(LIMITS.intersection(classes), others)
        seen = {row["motion_class"] for row in rows}
        self.assertLess({"loop", "cusp", "wave", "steady", "sleeping", "separatrix"}, seen)
        self.assertEqual({"resting", "circular", "hyperbolic"}, {m["regime"] for m in found})

    def test_special_tops(self) -> None:
        """Axes at rest, plane pendulums, exact passages of poles, the separatrix, no weight."""
        tops = [(name, top, span) for name, (top, span) in SPECIAL.items()]
        rows = by_program(self.folder, tops)
        found = self.in_page([(top, [span]) for _, top, span in tops])
        self.assertEqual(self.compare(tops, rows, found), Counter())
        seen = {row["motion_class"] for row in rows}
        self.assertLess({"sleeping", "hanging", "separatrix", "libration", "circulation"}, seen)

    def test_all_times(self) -> None:
        """Angles with their turns, rates, angular velocity and quaternion along whole tables."""
        folder = self.folder / "tables"
        columns = ",".join(("t", *STATE, "inherent_error"))
        inputs = [ROOT / "input" / f"{name}.nml" for name in INPUTS]
        settings = ("--set", "span.samples=301", "--set", f"output.columns={columns}")
        exact = ("--set", "integration.method=exact")
        command = [PROGRAM, "--quiet", "-o", folder, *settings, *exact, *inputs]
        subprocess.run(command, check=True, capture_output=True)
        for name in INPUTS:
            with self.subTest(name):
                self.compare_table(folder / f"{name}.csv")

    def compare_table(self, path: Path) -> None:
        """Every column of every row of a table."""
        rows = [{k: float(v) for k, v in row.items()} for row in read_rows(path)]
        table = read_table(path)
        body, first = read_body(table), rows[0]
        top = {
            "mass": body.mass,
            "inertia1": body.inertia[0],
            "inertia3": body.inertia[2],
            "length": body.centre[2],
            "gravity": float(table.setting("top.gravity") or 9.81),
            "phi": first["phi"],
            "theta": first["theta"],
            "psi": first["psi"],
            "phiRate": first["phi_rate"],
            "thetaRate": first["theta_rate"],
            "omega3": first["omega3"],
        }
        (motion,) = self.in_page([(top, [row["t"] for row in rows])])
        for row, state in zip(rows, motion["states"], strict=True):
            scale = max(1.0, *(abs(row[key]) for key in STATE[3:9]))
            slack = max(LEAST, FLOORS * row["inherent_error"])
            values = [*state["angle"], *state["rate"], *state["omega"], *state["quaternion"]]
            for key, value in zip(STATE, values, strict=True):
                allowed = slack * (scale if key in STATE[3:9] else 1.0)
                allowed += 1e-15 * abs(row[key])
                self.assertAlmostEqual(value, row[key], delta=allowed, msg=f"{key} at {row['t']}")

    def test_steady_motion(self) -> None:
        """The threshold of the sleeping top, and the slow and the fast root by their equation."""
        top = top_of(0.9, 0.4, 9.81, 0, 1.1, 0, 0, 0, 12.0)
        script = "return steadyMotionOf(arguments[0])"
        threshold, rates, at_spin = self.browser.execute_script(script, top)
        self.assertAlmostEqual(threshold, math.sqrt(4 * 9.81 * 0.9) / 0.4, places=13)
        cosine = math.cos(1.1)
        for p in rates:
            self.assertAlmostEqual(0.9 * cosine * p**2 - 0.4 * 12 * p + 9.81, 0, places=11)
        for p in at_spin:
            omega3 = 12 + p * cosine
            self.assertAlmostEqual(0.9 * cosine * p**2 - 0.4 * omega3 * p + 9.81, 0, places=11)
        self.assertLess(rates[0], rates[1])


if __name__ == "__main__":
    unittest.main()
