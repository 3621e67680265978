"""Random inputs of the program, drawn with fixed seeds from what `spintop list` knows.

`plausible_input` writes inputs most of which the program accepts, with little work in each;
`wild_input` writes any key with any value; `damaged` changes bytes of an input.
"""

import json
import math
import random
import re
import subprocess
from dataclasses import dataclass
from functools import cache

PAPER = ("euler", "lagrange", "energy_rate", "lagrange_energy")
SHAPES = {
    "spinning_wheel": "radius thickness rod_length",
    "ring": "radius inner_radius thickness rod_length",
    "sphere": "radius rod_length",
    "cylinder": "radius thickness",
    "cone": "radius thickness",
}
EVENTS = (
    "turning_points", "upper_turning_points", "lower_turning_points", "azimuth_turns",
    "theta = 0.6", "phi_rate = 1.0 rising", "omega3 = 0", "psi_deg = 45 every turn",
    "axis_z_rate = 0",
)  # fmt: skip
CASES = ("slow_top", "pole_upright", "through_hanging", "sleeping_below", "near_steady")
WORDS = (
    "", "''", "'x'", "1", "-1", "0", "1e308", "-1e-320", "nan", "inf", "1d0", "1.5.2", "2*3", ",",
    "'a", "\"b\"",
    "'rk4'", "'all'", "9" * 30, "1:3", "(1,2)", "&top", "/", "!", "'\u00e9'", ".true.", "t",
    "*", "=", "0x10",
    "1e-310", "2147483648", "-0", "+5", "1,2,3,4,5,6,7", "'t', 't'", "3*'t'", "'theta = 0.5'",
    "1 2",
)  # fmt: skip


BYTES = (b"\n", b"\r\n", b"\t", b"\0", b"\xff", b"'", b'"', b"&", b"/", b"=", b"!")


@dataclass(frozen=True)
class Vocabulary:
    """Registries of the program: parameters with sizes, methods, formulations, tables, columns."""

    parameters: dict[str, int]
    choices: dict[str, list[str]]
    fixed: list[str]
    adaptive: list[str]
    tables: dict[str, list[str]]
    formulations: dict[str, list[str]]
    columns: list[str]
    quantities: list[str]


@cache
def vocabulary(program: str) -> Vocabulary:
    told = subprocess.run([program, "list", "--json"], capture_output=True, check=True)
    known = json.loads(told.stdout)
    parameters, choices = {}, {}
    for entry in known["parameters"]:
        extent = re.search(r"\((\d+)", entry["full_name"])
        parameters[entry["name"]] = int(extent[1]) if extent else 1
        if entry["choices"]:
            choices[entry["name"]] = entry["choices"]
    methods = known["methods"]
    fixed = [entry["name"] for entry in methods if entry["kind"] in ("fixed", "both")]
    adaptive = [entry["name"] for entry in methods if entry["kind"] in ("adaptive", "both")]
    tables = {entry["name"]: entry["tables"] for entry in methods if entry["tables"]}
    formulations = {entry["name"]: entry["formulations"] for entry in methods}
    columns, quantities = (
        [entry["name"] for entry in known["columns"] if entry["study"] == study]
        for study in ("trajectory", "sweep")
    )
    return Vocabulary(
        parameters, choices, fixed, adaptive, tables, formulations, columns, quantities
    )


Groups = dict[str, dict[str, str]]


class Writer:
    """Draws one input."""

    def __init__(self, program: str, seed: int) -> None:
        self.random = random.Random(seed)
        self.words = vocabulary(program)
        self.groups: Groups = {}

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def pick(self, choices: list[str] | tuple[str, ...]) -> str:
        return self.random.choice(list(choices))

    def number(self, low: float, high: float) -> float:
        """A number of few digits."""
        return float(f"{self.random.uniform(low, high):.4g}")

    def power(self, low: float, high: float) -> float:
        """Ten to a power, of few digits."""
        return float(f"{10 ** self.random.uniform(low, high):.3g}")

    def put(self, group: str, **values: object) -> None:
        """Set keys; texts in quotes, lists by commas."""
        for key, value in values.items():
            many = value if isinstance(value, list | tuple) else [value]
            self.groups.setdefault(group, {})[key] = ", ".join(
                f"'{one}'" if isinstance(one, str) else repr(one) for one in many
            )

    def text(self) -> str:
        lines = []
        for group, values in self.groups.items():
            lines += [f"&{group}", *(f"    {key} = {value}" for key, value in values.items()), "/"]
        return "\n".join(lines) + "\n"

    def plausible(self) -> str:
        """An input that the program is likely to accept, with little work."""
        kind = self.random.choices(
            ("trajectory", "sweep", "work_precision", "stability"), (55, 35, 8, 2)
        )[0]
        self.put("study", kind=kind)
        if self.chance(0.2):
            self.put("study", title=self.pick(("A top", "It''s a top", "\u00e9t\u00e9: 1, 2")))
        self.symmetric = self.chance(0.75)
        self.damped = self.chance(0.1)
        self.general = not self.symmetric or self.damped
        self.scale = 10.0 ** self.random.choice((0, 0, 0, 0, -9, 9))
        self.body()
        self.start()
        if kind in ("trajectory", "sweep") and self.chance(0.2):
            self.effects()
        getattr(self, kind)()
        return self.text()

    def body(self) -> None:
        if self.symmetric and self.chance(0.25):
            shape = self.pick(tuple(SHAPES))
            self.put("top", shape=shape)
            self.put("top", **{self.pick(("mass", "density")): self.number(1, 10)})
            for key in SHAPES[shape].split():
                small = key in ("thickness", "inner_radius")
                self.put("top", **{key: self.number(0.01, 0.09) if small else self.number(0.1, 1)})
        else:
            one, three = self.number(0.5, 1.0), self.number(0.05, 0.9)
            two = one if self.symmetric else self.number(max(one - three, 0) + 0.02, one)
            inertia = [value * self.scale for value in (one, two, three)]
            self.put("top", mass=self.number(0.5, 3) * self.scale, inertia=inertia)
            if self.symmetric or self.chance(0.3):
                self.put("top", length=-0.3 if self.chance(0.3) else self.number(0, 0.8))
            else:
                self.put("top", centre_of_mass=[self.number(-0.3, 0.3) for _ in range(3)])
            if self.chance(0.1):
                self.put("top", inertia_about="centre_of_mass")
        if self.damped:
            self.put("top", damping=[self.power(-4, -1) * self.scale for _ in range(3)])
        if self.chance(0.15):
            self.put("top", gravity=self.random.choice([0.0, 1.62, 9.81e-6, 24.8]))

    def start(self) -> None:
        put, number = self.put, self.number
        if self.chance(0.15):
            turn = [number(-1, 1) for _ in range(4)]
            put("initial", quaternion=[part / math.hypot(*turn) for part in turn])
            put("initial", omega=[number(-3, 3), number(-3, 3), number(-20, 20)])
            return
        angle = self.random.choice(
            [number(0.05, 3.0), self.power(-9, -1), 3.14159265 - self.power(-8, -1), 0.0]
        )
        put("initial", theta=angle)
        for key in ("phi", "psi", "phi_rate", "theta_rate"):
            if self.chance(0.4):
                put("initial", **{key: number(-4, 4)})
        key = self.pick(("psi_rate", "omega3", "spin_ratio", "none"))
        if key != "none" and not (key == "spin_ratio" and not self.symmetric):
            put("initial", **{key: number(-3, 3) * self.random.choice([1, 1, 10])})

    def vector(self, size: float) -> list[float]:
        """A vector of components up to a size, some of them zero."""
        return [size * self.number(-1, 1) if self.chance(0.7) else 0.0 for _ in range(3)]

    def effects(self) -> None:
        """One to three effects; the body then has no closed form."""
        self.general = True
        number, power, vector, scale = self.number, self.power, self.vector, self.scale

        def maybe(probability: float, **keys: object) -> dict[str, object]:
            return keys if self.chance(probability) else {}

        choices = (
            {"friction_torque": power(-4, -1) * scale}
            | maybe(0.4, friction_coefficient=number(0, 0.5), friction_radius=0.002)
            | maybe(0.3, friction_smoothing=power(-3, 0)),
            {"drag_force": power(-5, -1) * scale}
            | maybe(
                0.6,
                drag_moment=[power(-6, -2) * scale for _ in range(3)],
                drag_exponent=self.random.choice([1.0, 1.5, 1.8, 2.0, 3.0]),
            ),
            {"vibration_amplitude": vector(0.05), "vibration_rate": number(0.5, 60)}
            | maybe(0.5, vibration_phase=vector(3)),
            {"earth_rate": power(-5, 0), "latitude_deg": self.random.choice([-90, 0, 48.5])},
            {"rotor_momentum": vector(3 * scale)} | maybe(0.5, rotor_torque=vector(scale)),
            {f"torque_{self.pick(('body', 'space'))}": vector(scale)},
        )
        for keys in self.random.sample(choices, self.random.choice((1, 1, 2, 3))):
            self.put("effects", **keys)

    def span(self) -> None:
        if not self.general and self.chance(0.3):
            self.put("span", nutations=self.number(0.1, 3))
        else:
            self.put("span", t_end=self.number(0.05, 3))
        if self.chance(0.2):
            self.put("span", stop_at=self.pick(EVENTS), stop_after=self.random.randint(1, 3))

    def method(self) -> tuple[str, str]:
        method = self.pick((*self.words.fixed, *self.words.adaptive, "auto", "exact"))
        allowed = self.words.formulations.get(method) or ("rigid_body", "space_frame", *PAPER)
        if self.general:
            allowed = ("rigid_body",)
        if self.general and method == "exact":
            method = "auto"
        if "effects" in self.groups and method.startswith("splitting"):
            method = "taylor"
        formulation = self.pick((*allowed, "auto"))
        if method in ("auto", "exact"):
            formulation = "auto"
        return method, formulation

    def integration(self) -> None:
        method, formulation = self.method()
        self.put("integration", method=method, formulation=formulation)
        if formulation == "auto" and method != "auto":
            del self.groups["integration"]["formulation"]
        if method in self.words.tables and self.chance(0.7):
            self.put("integration", table=self.pick(self.words.tables[method]))
        fixed = method in self.words.fixed and (
            method not in self.words.adaptive or self.chance(0.4)
        )
        if fixed:
            self.put("integration", steps=self.random.choice([1, 7, 40, 200]))
        elif method in self.words.adaptive:
            low = -26 if method == "taylor_quadruple" else -12
            if self.chance(0.7):
                self.put("integration", relative_tolerance=self.power(low, -3))
            if self.chance(0.2):
                self.put("integration", absolute_tolerance=self.power(low - 2, -6))
        self.fixed = fixed
        self.put(
            "integration", max_steps=self.random.choice([200, 3000] if fixed else [5, 300, 3000])
        )
        if method in ("crank_nicolson_1", "gauss_4", "euler_backward") and self.chance(0.3):
            self.put("integration", solver="fixed_point")
        if formulation not in PAPER and method not in ("auto", "exact") and self.chance(0.15):
            self.put("integration", project=self.pick(("none", "unit", "invariants")))

    def trajectory(self) -> None:
        self.span()
        self.integration()
        if not self.fixed:
            self.put("span", samples=self.random.choice([2, 3, 20, 101]))
        columns = [
            name for name in self.words.columns if name not in NEED_EXACT or not self.general
        ]
        if self.chance(0.7):
            chosen = self.random.sample(columns, self.random.randint(1, 8))
            kept = ["t", *(name for name in ("theta", *chosen) if name != "t")]
            if not self.general:
                kept += ["orientation_error", "inherent_error"]
            self.put("output", columns=list(dict.fromkeys(kept)))
        elif not self.general:
            self.put("output", columns="all")
        if self.chance(0.3):
            self.put("output", events=self.random.sample(EVENTS, self.random.randint(1, 3)))

    def sweep(self) -> None:
        self.span()
        self.integration()
        given = [
            f"{group}.{key}" for group in ("top", "initial", "span") for key in self.groups[group]
        ]
        wanted = ("top.mass", "span.t_end", *(key for key in given if key.startswith("initial.")))
        keys = ["top.gravity", *(key for key in given if key in wanted)]
        keys = [key for key in keys if key not in ("initial.quaternion", "initial.omega")]
        if "top.inertia" in given:
            keys.append("top.inertia(3)")
        chosen = self.random.sample(keys, min(len(keys), self.random.randint(1, 3)))
        combine = self.pick(("grid", "zip", "random", "latin_hypercube", "sobol"))
        drawn = combine not in ("grid", "zip")
        count = self.random.randint(1, 3)
        for place, key in enumerate(chosen, start=1):
            low, high = self.range_of(key)
            self.put(
                "sweep", **{f"parameter({place})": key, f"from({place})": low, f"to({place})": high}
            )
            if not drawn:
                self.put("sweep", **{f"count({place})": count if high != low else 1})
        self.put("sweep", combine=combine)
        if drawn:
            self.put("sweep", cases=count, seed=self.random.randint(1, 99))
            if self.chance(0.2):
                low, high = self.range_of(chosen[0])
                self.put("sweep", **{"distribution(1)": "normal", "mean(1)": (low + high) / 2})
                self.put("sweep", **{"deviation(1)": (high - low) / 20 or 1e-9})
                del self.groups["sweep"]["from(1)"], self.groups["sweep"]["to(1)"]
        quantities = [
            name for name in self.words.quantities if name not in LONG or self.chance(0.3)
        ]
        if self.chance(0.7):
            chosen = self.random.sample(quantities, min(len(quantities), self.random.randint(1, 6)))
            extra = ["theta_end"]
            if "effects" not in self.groups:
                extra += ["orientation_error", "inherent_error"]
            self.put("output", columns=list(dict.fromkeys([*chosen, *extra])))
            if self.chance(0.3):
                self.put("statistics", columns=list(dict.fromkeys(["theta_end", *chosen])))
                if self.chance(0.5):
                    self.put("statistics", over="theta_end", bins=3)
                    self.put("statistics", **{"from": 0.0, "to": 3.2})

    def range_of(self, key: str) -> tuple[float, float]:
        group, _, name = key.partition(".")
        if key == "top.inertia(3)":
            middle = float(self.groups["top"]["inertia"].split(", ")[2])
        else:
            middle = float(self.groups[group].get(name, "9.81"))
        low, high = sorted((middle * 0.9, middle * 1.05))
        return (low, high) if name not in ("theta",) else (max(low, 0.0), min(high, 3.14159))

    def work_precision(self) -> None:
        self.put("span", t_end=self.number(0.05, 1))
        self.put("integration", max_steps=3000)
        methods = self.random.sample([*self.words.fixed, *self.words.adaptive], 3)
        methods = [name for name in methods if name not in self.words.tables]
        allowed = "rigid_body" if self.general else "space_frame"
        self.put("work_precision", methods=[f"{name}/{allowed}" for name in methods] or "rk4")
        self.put("work_precision", tolerances=[1e-5, 1e-9], steps=[20, 80], repeats=1)

    def stability(self) -> None:
        self.put("span", t_end=self.number(0.05, 1))
        self.put("integration", max_steps=3000, steps=200)
        self.put("stability", cases=self.random.sample([*CASES, "input"], 1))
        self.put("stability", methods=self.random.sample(["rk4", "dop853", "taylor", "ode45"], 2))

    def wild(self) -> str:
        """A plausible input with keys and values of any kind put in or taken out."""
        self.plausible()
        for _ in range(self.random.choice((1, 1, 2, 5))):
            key = self.pick(tuple(self.words.parameters))
            group, _, name = key.partition(".")
            size = self.words.parameters[key]
            if size > 1 and self.chance(0.4):
                name += f"({self.random.choice([1, 2, size, size + 1, 0, -1])})"
            choices = [f"'{word}'" for word in self.words.choices.get(key, ["x"])]
            value = self.pick(
                (*WORDS, *choices, repr(self.power(-320, 308)), repr(self.number(-9, 9)))
            )
            change = self.random.randrange(4)
            values = self.groups.setdefault(group, {})
            if change == 0 and values:
                values.pop(self.pick(tuple(values)))
            elif change == 1 and values:
                values[self.pick(tuple(values))] = value
            else:
                values[name] = value
        return self.text()


NEED_EXACT = ("orientation_error", "tip_error", "inherent_error")
LONG = ("lyapunov_exponent", "orientation_error")


def plausible_input(program: str, seed: int) -> str:
    return Writer(program, seed).plausible()


def wild_input(program: str, seed: int) -> bytes:
    """An input with any keys and values; in one of two its bytes are changed, too."""
    writer = Writer(program, seed)
    data = writer.wild().encode()
    return damaged(data, writer.random) if writer.chance(0.5) else data


def damaged(data: bytes, draw: random.Random) -> bytes:
    """The bytes with some changed, left out, repeated or put in."""
    for _ in range(draw.choice((1, 1, 2, 4, 16))):
        place, length = draw.randrange(len(data) + 1), draw.choice((1, 1, 2, 10, 100))
        piece = data[place : place + length]
        change = draw.randrange(5)
        if change == 0:
            piece = bytes(draw.randrange(256) for _ in piece)
        elif change == 1:
            piece = b""
        elif change == 2:
            piece += piece
        elif change == 3:
            piece = draw.choice(WORDS).encode() + piece
        else:
            piece = draw.choice(BYTES) + piece
        data = data[:place] + piece + data[place + length :]
        if not data:
            return b"&"
    return data
