"""Tests of the motion that the live top computes, against the program's tables."""

import json
import math
import os
import random
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

from browser_case import BROWSER, need_packages, open_browser
from conftest import ROOT, Spin, execute
from random_tops import CLASSES, draw_top
from reporting.packages import bundle, esbuild_package

BODIES = int(os.environ.get("SPINTOP_LIVE_BODIES", "60"))
"""Random bodies of all kinds."""
SEED = 77
TURN = 100.0
"""The span: rotation of a body, about, in rad."""

LARGEST = 1e9
"""Numbers that the page takes."""

LEAST, FLOORS = 1e-9, 100.0
"""The attitude is right to this angle, or to so many times the inherent error."""

WELL_CONDITIONED = 1e-3
"""cos(theta) at the bounds of the nutation differs by more, where the period is compared."""

NOT_ALL_FINITE = 3
"""The exit code where a motion has no nutation period."""
LIMITS = {"cusp", "steady", "separatrix"}
"""Classes that are the limit of others: rounding may decide."""

PAIRS = {
    "mass": "top.mass",
    "gravity": "top.gravity",
    "inertia": "top.inertia",
    "centre": "top.centre_of_mass",
    "damping": "top.damping",
    "friction": "effects.friction_torque",
    "amplitude": "effects.vibration_amplitude(3)",
    "vibrationRate": "effects.vibration_rate",
    "phi": "initial.phi",
    "theta": "initial.theta",
    "psi": "initial.psi",
    "phiRate": "initial.phi_rate",
    "thetaRate": "initial.theta_rate",
    "omega3": "initial.omega3",
}
"""Keys of the page and of the program."""
STARTS = ("phi", "theta", "psi", "phiRate", "thetaRate", "omega3")

SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0  inertia = 1.0, 1.0, 1.0  centre_of_mass = 0, 0, 1 /
&initial theta = 1 /
&span t_end = 1.0 /
&integration relative_tolerance = 1e-14 /
{effects}&sweep table = 'bodies.csv' /
&output columns = 'theta_end', 'phi_end', 'psi_end'{columns} /
"""
OF_EFFECTS = ", 't_end', 't_stuck'"
OF_FREE = ", 'inherent_error'"
OF_LAGRANGE = ", 'inherent_error', 'motion_class', 'theta_min', 'theta_max', 'nutation_period'"

Body = dict[str, object]


def free(mass: float, inertia: tuple, centre: tuple, start: tuple, **others: object) -> Body:
    """A body with its start: phi, theta, psi, phi', theta', omega3."""
    body = {"mass": mass, "gravity": 9.81, "inertia": inertia, "centre": centre} | others
    return body | dict(zip(STARTS, start, strict=True))


def top_of(i1: float, i3: float, weight: float, *start: float) -> Body:
    """A top of unit mass and length, with the weight as gravity."""
    return free(1.0, (i1, i1, i3), (0, 0, 1.0), start, gravity=weight)


SPECIAL = {
    "asleep, stable": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 20), 10),
    "asleep, unstable": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 2), 1),
    "at rest upright": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 0, 0), 1),
    "hanging at rest": (top_of(1, 0.5, 9.81, 0.3, math.pi, 0.1, 0, 0, 3), 10),
    "hanging, pushed": (top_of(1, 0.5, 9.81, 0.3, math.pi, 0.1, 0, 1.5, 3), 30),
    "upright, pushed": (top_of(1, 0.5, 9.81, 0.3, 0, 0.1, 0, 1.5, 30), 10),
    "plane, through the bottom": (top_of(1, 0.5, 9.81, 0.3, 2.0, 0.1, 0, 0, 0), 30),
    "plane, over the top": (top_of(1, 0.5, 9.81, 0.3, 2.0, 0.1, 0, 9, 0), 10),
    "through the bottom": (top_of(1, 0.5, 9.81, 0.3, math.pi / 2, 0.1, -1, 0.4, 2), 30),
    "through the top": (top_of(1, 0.5, 1, 0.3, math.pi / 2, 0.1, 4, 4, 8), 30),
    "no weight": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 2, 1, 8), 30),
    "no weight, at rest": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 0, 0, 0), 100),
    "no weight, spin only": (top_of(1, 0.5, 0, 0.3, 1.0, 0.1, 0, 0, 5), 30),
    "thin rod": (top_of(1, 1e-6, 9.81, 0.3, 1.0, 0.1, 1, 0.5, 5), 30),
    "fast": (top_of(1, 0.5, 9.81, 0.3, 1.0, 0.1, 0, 0, 2e4), 0.05),
}
"""Tops and times, s."""

PENDULUM = {"mass": 1.0, "inertia": (0.9, 0.9, 0.3), "centre": (0, 0, 0.5)}
AT_REST = {
    "spin-down without weight": (
        free(1.0, (0.3, 0.3, 0.2), (0, 0, 0), (0, 0.4, 0, 0, 0, 10), friction=0.5),
        6,
    ),
    "pendulum, swings and sticks": (free(**PENDULUM, start=(0, 2.0, 0, 0, 0, 0), friction=0.3), 40),
    "held where it is": (free(**PENDULUM, start=(0, 3.0, 0, 0, 0, 0), friction=1.0), 5),
    "wakes, falls, lies still": (
        free(1.0, (0.9, 0.9, 0.3), (0, 0, 0.5), (0, 0.1, 0, 0, 0, 20), friction=0.4),
        40,
    ),
    "turned back in the middle of a step": (
        free(
            0.07267175946214807,
            (0.04405463242164997, 0.04405463242164997, 0.03636840142119085),
            (0, 0, 0.1596965019853297),
            (
                *(1.8343467747837563, 2.3647050386621564, -2.692005270160167),
                *(0.09611921667962608, 0.7107472336079876, -0.3648291012301692),
            ),
            friction=0.003980781665561717,
        ),
        30.2,
    ),
    "unbalanced": (
        free(1.0, (0.9, 0.8, 0.3), (0.1, 0.02, 0.5), (0, 1, 0.5, 0, 0, 9), friction=0.4),
        40,
    ),
}
"""Bodies that dry friction stops, within so many s."""


ONE = """\
&top mass = 1.0  inertia = 1.0, 1.0, 1.0  centre_of_mass = 0, 0, 1 /
&initial theta = 1 /
&span t_end = 1.0  samples = 101 /
&integration relative_tolerance = 1e-14 /
"""
COLUMNS = (
    *("phi", "theta", "psi", "phi_rate", "theta_rate", "psi_rate", "omega1", "omega2", "omega3"),
    *("q0", "q1", "q2", "q3", "lz", "force_x", "force_y", "force_z", "kinetic", "potential"),
)
BODY = {"mass": 1.2, "inertia": (0.9, 0.8, 0.3), "centre": (0.05, 0.02, 0.5)}
TABLES = {
    "top": (top_of(1, 0.5, 9.81, 0.3, 1.0, 0.1, -0.5, 0.4, 12), 5.0),
    "damped": (free(**BODY, start=(0.3, 0.5, 0.1, 0, 0, 20.0), damping=(0.1, 0.2, 0.01)), 5.0),
    "vibrated": (
        free(**BODY, start=(0.3, 0.1, 0.1, 0, 0, 1.0), amplitude=0.1, vibrationRate=60.0),
        2.0,
    ),
    "friction": (free(**BODY, start=(0.3, 0.5, 0.1, 0, 0, 20.0), friction=0.3), 5.0),
}


def draw_body(number: int) -> tuple[str, Body]:
    """A random body of a kind: symmetric or not, damped, with friction, on a vibrating pivot."""
    draw = random.Random(f"{SEED} {number}")
    kind = ("symmetric", "unsymmetric", "damped", "friction", "vibrated")[number % 5]
    moments = [draw.uniform(0.5, 1.0) for _ in range(3)]
    centre = [draw.uniform(-0.4, 0.4) for _ in range(3)]
    if kind == "symmetric" or draw.random() < 0.4:
        moments[1] = moments[0]
        centre = [0.0, 0.0, abs(centre[2])]
    size = 10 ** draw.uniform(-4, 1)
    start = (
        *(draw.uniform(-3, 3), draw.uniform(0.05, 3.1), draw.uniform(-3, 3)),
        *(draw.uniform(-2, 2), draw.uniform(-2, 2), draw.choice([1, 5, 20]) * draw.uniform(-1, 1)),
    )
    body = free(size, tuple(size * moment for moment in moments), tuple(centre), start)
    rate = math.sqrt(9.81 * np.linalg.norm(centre) / max(moments))
    if kind == "damped":
        body["damping"] = [size * draw.uniform(0, 0.2) for _ in range(3)]
    elif kind == "friction":
        body["friction"] = size * 10 ** draw.uniform(-1.5, 0.3)
    elif kind == "vibrated":
        body |= {"amplitude": draw.uniform(0, 0.2), "vibrationRate": rate * draw.uniform(0.5, 20)}
    return kind, body


def rate_of(body: Body) -> float:
    swing = math.hypot(body["phiRate"], body["thetaRate"], body["omega3"])
    arm = body["mass"] * body["gravity"] * np.linalg.norm(body["centre"])
    natural = math.sqrt(arm / max(body["inertia"]))
    return math.hypot(swing, 2 * natural, body.get("vibrationRate", 0) / 10) or 1.0


def symmetric_tops(count: int) -> list[tuple[str, Body, float]]:
    """Class, top and span of tops of each class."""
    tops = []
    for number in range(count * len(CLASSES)):
        kind, start, span = draw_top(number, SEED)
        omega3 = start.spin
        if not start.spin_is_omega3:
            omega3 += start.phi_rate * math.cos(start.theta)
        angles = (start.phi, start.theta, start.psi, start.phi_rate, start.theta_rate, omega3)
        inertia = (start.inertia1, start.inertia1, start.inertia3)
        top = free(start.mass, inertia, (0, 0, start.length), angles, gravity=start.gravity)
        spin = (1 + start.inertia3 / start.inertia1) * abs(omega3)
        if max(abs(omega3), start.mass, start.gravity, 1 / start.inertia3) < LARGEST:
            tops.append((kind, top, min(span, TURN / math.hypot(rate_of(top), spin))))
    return tops


def flat(key: str, value: object) -> dict[str, float]:
    """Columns of a sweep's table for a key of the page."""
    if isinstance(value, tuple | list):
        return {f"{PAIRS[key]}({k})": part for k, part in enumerate(value, 1)}
    return {PAIRS[key]: value}


def by_program(folder: Path, bodies: list[tuple[Body, float]], columns: str) -> list[dict]:
    """The rows of the program's sweep over bodies with the same keys, and their spans."""
    rows = []
    for body, span in bodies:
        row = {"span.t_end": span}
        for key, value in body.items():
            row |= flat(key, value)
        rows.append({key: float(value) for key, value in row.items()})
    effects = "&effects vibration_amplitude = 0, 0, 1 /\n" if "amplitude" in bodies[0][0] else ""
    text = SWEEP.format(columns=columns, effects=effects)
    table = pd.DataFrame(rows).to_csv(index=False)
    run = Spin(folder)(text, "--restart", bodies=table, code=(0, NOT_ALL_FINITE))
    return run.rows.to_dict("records")


def quaternion(phi: float, theta: float, psi: float) -> np.ndarray:
    plus, minus = (phi + psi) / 2, (phi - psi) / 2
    c, s = math.cos(theta / 2), math.sin(theta / 2)
    return np.array(
        [c * math.cos(plus), s * math.cos(minus), s * math.sin(minus), c * math.sin(plus)]
    )


def turn_between(p: np.ndarray, q: np.ndarray) -> float:
    """The rotation angle between two attitudes, rad."""
    return 4 * math.asin(min(1.0, min(np.linalg.norm(p - q), np.linalg.norm(p + q)) / 2))


class Page:
    """The modules of the page, run by node, or by a browser where there is none."""

    def __init__(self, folder: Path, script: str) -> None:
        self.node, self.script, self.browser = shutil.which("node"), script, None
        if not self.node:
            page = folder / "motion.html"
            text = f"<!DOCTYPE html><meta charset=utf-8><script>{script}</script>"
            page.write_text(text, encoding="utf-8")
            self.browser = open_browser(folder / "profile")
            self.browser.get(page.as_uri())

    def call(self, name: str, argument: object) -> list:
        """What a function of the entry gives, which is JSON."""
        words = json.dumps(argument)
        if self.browser:
            return json.loads(self.browser.execute_script(f"return {name}({words})"))
        program = f"{self.script};process.stdout.write({name}({words}))"
        return json.loads(execute(self.node, "-", input=program).stdout)

    def motions(self, bodies: list[tuple[Body, list[float]]]) -> list[dict]:
        """Nutation and states of bodies at times, as the page computes them."""
        given = [
            {
                "body": {key: value for key, value in body.items() if key not in STARTS},
                "start": {key: body[key] for key in STARTS},
                "times": times,
            }
            for body, times in bodies
        ]
        return self.call("motionsOf", given)


@unittest.skipUnless(BROWSER or shutil.which("node"), "neither node nor a browser")
class MotionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        need_packages("three", esbuild_package())
        scratch = tempfile.TemporaryDirectory(prefix="motion ", ignore_cleanup_errors=True)
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        cls.page = Page(cls.folder, bundle(ROOT / "test/page" / "motion_entry.js"))
        if cls.page.browser:
            cls.addClassCleanup(cls.page.browser.quit)

    def compare(self, bodies: list[tuple[str, Body, float]], columns: str) -> list[tuple]:
        """The attitude at the end of each span; returns rows and motions."""
        rows = by_program(self.folder, [(body, span) for _, body, span in bodies], columns)
        found = self.page.motions([(body, [span]) for _, body, span in bodies])
        for (kind, body, span), row, motion in zip(bodies, rows, found, strict=True):
            state = motion["states"][0]
            allowed = max(LEAST, FLOORS * float(row.get("inherent_error", 0)))
            right = quaternion(*(float(row[f"{name}_end"]) for name in ("phi", "theta", "psi")))
            for q in (np.array(state["quaternion"]), quaternion(*state["angle"])):
                self.assertLessEqual(turn_between(right, q), allowed, (kind, body, span))
        return list(zip(rows, found, strict=True))

    def compare_nutation(self, tops: list[tuple[str, Body, float]]) -> None:
        """Turning angles, class and period of tops as well."""
        for row, motion in self.compare(tops, OF_LAGRANGE):
            nutation = motion["nutation"]
            classes = {row["motion_class"], nutation["motionClass"]}
            self.assertTrue(len(classes) == 1 or classes & LIMITS, (row, nutation))
            cosines = []
            for name in ("min", "max"):
                angle = nutation[f"theta{name.title()}"]
                self.assertAlmostEqual(angle, float(row[f"theta_{name}"]), delta=3e-7, msg=row)
                cosines.append(math.cos(angle))
            period, ours = float(row["nutation_period"]), float(nutation["period"])
            periods = 2 if row["motion_class"] == "libration" else 1
            if row["motion_class"] == "separatrix" or nutation["motionClass"] == "separatrix":
                continue
            if math.isfinite(period) and cosines[0] - cosines[1] > WELL_CONDITIONED:
                self.assertLess(abs(ours - periods * period), 1e-6 * ours, (row, nutation))

    def test_symmetric_tops(self) -> None:
        """Tops of each class: the attitude at the end, the class, the period."""
        self.compare_nutation(symmetric_tops(max(3, BODIES // 12)))

    def test_special_tops(self) -> None:
        """Axes at rest, plane pendulums, exact passages of poles, no weight."""
        self.compare_nutation([(name, top, span) for name, (top, span) in SPECIAL.items()])

    def test_separatrix(self) -> None:
        """Its period is infinite."""
        sleeping = {"omega3": 1, "phiRate": 0.5, "thetaRate": math.sqrt(3.75)}
        top = top_of(1, 0.5, 2, 0, math.pi / 2, 0, *(sleeping[key] for key in STARTS[3:]))
        (motion,) = self.page.motions([(top, [5])])
        self.assertEqual(motion["nutation"]["motionClass"], "separatrix")
        self.assertEqual(motion["nutation"]["period"], "Infinity")
        self.assertLess(motion["states"][0]["angle"][1], 0.1)

    def test_bodies(self) -> None:
        """Bodies without symmetry, damped, with dry friction, on a vibrating pivot."""
        kinds: dict[str, list] = {}
        for number in range(BODIES):
            kind, body = draw_body(number)
            kinds.setdefault(kind, []).append((kind, body, TURN / rate_of(body)))
        for kind, bodies in kinds.items():
            free_of_effects = kind in {"symmetric", "unsymmetric"}
            with self.subTest(kind):
                self.compare(bodies, OF_FREE if free_of_effects else OF_EFFECTS)

    def test_rest(self) -> None:
        bodies = [(name, body, span) for name, (body, span) in AT_REST.items()]
        for row, motion in self.compare(bodies, OF_EFFECTS):
            self.assertAlmostEqual(motion["stop"], float(row["t_stuck"]), delta=2e-8)
            self.assertEqual(motion["states"][0]["kinetic"], 0)

    def test_all_columns(self) -> None:
        """Angles with their turns, rates, energies, momentum and force along whole tables."""
        for name, (body, t_end) in TABLES.items():
            with self.subTest(name):
                self.compare_table(body, t_end)

    def compare_table(self, body: Body, t_end: float) -> None:
        settings = [f"span.t_end={t_end!r}", f"output.columns=t,{','.join(COLUMNS)}"]
        for key, value in body.items():
            values = value if isinstance(value, tuple) else (value,)
            if key == "amplitude":
                values = (0, 0, value)
            settings.append(f"{PAIRS[key].replace('(3)', '')}={','.join(map(repr, values))}")
        rows = Spin(self.folder)(ONE, *settings, "--restart").rows.to_dict("records")
        (motion,) = self.page.motions([(body, [row["t"] for row in rows])])
        sizes = {name: max(1.0, *(abs(float(row[name])) for row in rows)) for name in COLUMNS}
        for row, state in zip(rows, motion["states"], strict=True):
            values = [*state["angle"], *state["rate"], *state["omega"], *state["quaternion"]]
            values += [*state["momentum"][2:], *state["force"]]
            values += [state["kinetic"], state["potential"]]
            for name, value in zip(COLUMNS, values, strict=True):
                error = abs(value - float(row[name]))
                self.assertLess(error, LEAST * sizes[name], f"{name} at {row['t']}")

    def test_steady_motion(self) -> None:
        """The threshold of the sleeping top, and the slow and the fast root by their equation."""
        body = {"mass": 1, "inertia": [0.9, 0.9, 0.4], "centre": [0, 0, 1]}
        given = {"body": body, "theta": 1.1, "omega3": 12.0}
        threshold, rates = self.page.call("steadyMotionOf", given)
        self.assertAlmostEqual(threshold, math.sqrt(4 * 9.81 * 0.9) / 0.4, places=13)
        for p in rates:
            self.assertAlmostEqual(0.9 * math.cos(1.1) * p**2 - 0.4 * 12 * p + 9.81, 0, places=11)
        self.assertLess(rates[0], rates[1])
