"""A motion of the reference set: computed twice, compared, with errors; as a table and as JSON."""

import json
import re
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Decimal, getcontext
from pathlib import Path
from typing import Any

import numpy as np

from referencing.answer import Answer, answer_of
from referencing.equations import ARRAYS, DECIMALS, Equations, decimal_turn, product
from referencing.extrapolation import Accuracy, integrate

VERSION = "1.2"
LICENCE = "CC0-1.0"
DIGITS = 38
"""Decimal digits of the second computation."""
FINE, COARSE = Accuracy(14, Decimal("1e-28"), 10**19), Accuracy(7, 1e-12, 10**8)
"""Of the second computation, and of the motions that are displaced for the inherent error."""
DISPLACEMENT, ROUNDING = 1e-9, 2.0**-53
"""Relative displacement of the data for the inherent error, and half a unit in the last place."""
MARGIN = Decimal("1.5")
"""Of a stated error over the largest one that was found."""
LARGEST_DISAGREEMENT = 1e-9
"""Of the program's energies, momenta and forces with those of the second computation, relative."""

ANGLES = "phi", "theta", "psi"
"""Of a start, in the order of their rotations, about body z, x, z."""
TORQUE = re.compile(r"torque_(body|space)(_amplitude)?")

QUANTITIES = {
    "attitude": ("rad", "rotation from the true attitude: quaternion and matrix"),
    "omega": ("rad/s", "angular velocity, in body and in space axes"),
    "energy": ("J", "kinetic energy relative to the frame, plus m g times the height"),
    "momentum": ("J s", "angular momentum, with that of a rotor and of the rotation of the frame"),
    "force": ("N", "support force on the body"),
}
"""What has an error: its unit, and what it is."""

COLUMNS = {
    "t": ("s", "time"),
    **{f"q{i}": ("", f"quaternion, {w}") for i, w in enumerate(("scalar", "x", "y", "z"))},
    "q4": ("", "q0 again: q0 to q3 has the scalar first, q1 to q4 has it last"),
    **{f"r{i}{j}": ("", f"rotation matrix, row {i}, column {j}") for i in "123" for j in "123"},
    **{f"omega{i}": ("rad/s", f"angular velocity, body {x}") for i, x in enumerate("xyz", 1)},
    **{f"omega_{x}": ("rad/s", f"angular velocity, space {x}") for x in "xyz"},
    "energy": ("J", QUANTITIES["energy"][1]),
    **{f"l{x}": ("J s", f"{QUANTITIES['momentum'][1]}, space {x}") for x in "xyz"},
    **{f"force_{x}": ("N", f"{QUANTITIES['force'][1]}, space {x}") for x in "xyz"},
    "inherent_error": ("rad", "error of the attitude due to rounding of the data"),
}
"""The columns of a table: unit and meaning."""
OWNERS = {"matrix": "attitude", "omega_space": "omega"}
"""The quantity with the error of a group of numbers, where it has another name."""

CONVENTIONS = {
    "axes": "right-handed; space z is up, the fixed point is the origin of space and body axes",
    "quaternion": "q0 to q3, scalar first, body to space, continuous; q1 to q4 scalar last",
    "matrix": "v_space = R v_body; the columns are the body axes in space axes",
    "omega": "omega1 to omega3 in body axes, omega_x to omega_z in space axes; q' = q (0, omega)/2",
    "start": "of the angles where there are any, which are exact: the quaternion is then rounded",
    "inertia": "about the fixed point, body axes; off the diagonal -sum m x y and the like",
    "units": "SI and rad",
}


class MotionError(Exception):
    """Two computations do not agree."""


@dataclass(frozen=True)
class Error:
    """The error of a quantity: at most `value`, proved or by the agreement of two computations."""

    value: float
    kind: str


def exact(data: Any) -> np.ndarray:
    """Numbers as decimals, without rounding."""
    return np.vectorize(Decimal, otypes=[object])(data)[()]


def start_of(initial: Mapping[str, Any]) -> Sequence[Decimal]:
    """The quaternion of the start, of length 1."""
    if "quaternion" in initial:
        q = exact(initial["quaternion"])
        length = sum(x * x for x in q).sqrt()
        return q / length
    q = exact([1, 0, 0, 0])
    for key, axis in zip(ANGLES, (3, 1, 3), strict=True):
        cosine, sine = decimal_turn(Decimal(initial.get(key, 0)) / 2)
        turn = exact([0] * 4)
        turn[[0, axis]] = cosine, sine
        q = product(q, turn)
    return q


def angle(p: Sequence[Any], q: Sequence[Any]) -> Decimal:
    """The rotation between two attitudes, which is small, by quaternions of nearly unit length."""
    difference = product(exact(p) * [1, -1, -1, -1], exact(q))
    return 2 * sum(x * x for x in difference[1:]).sqrt() / abs(difference[0])


def distance(a: Sequence[Any], b: Sequence[Any]) -> Decimal:
    """The length of a difference."""
    return sum((exact(a) - exact(b)) ** 2).sqrt()


def length(a: Sequence[Any]) -> Decimal:
    """The length of a vector."""
    return sum(exact(a) ** 2).sqrt()


def rounding(numbers: np.ndarray) -> Decimal:
    """How far a vector is from that of the nearest doubles."""
    return distance(numbers, numbers.astype(float))


class Motion:
    """The motion of an input, computed by the program and a second time."""

    def __init__(self, path: Path, stated: Mapping[str, Mapping[str, Any]] | None = None) -> None:
        """Compute it; errors that were stated before remain if they are as large as those found."""
        getcontext().prec = DIGITS
        self.name = path.stem
        self.source = " ".join(re.findall(r"(?m)^! (.*)", path.read_text(encoding="utf-8")))
        self.answer: Answer = answer_of(path)
        data = {key: exact(value) for key, value in self.answer.data.items()}
        self.equations = Equations(data, DECIMALS)
        q, omega = start_of(self.answer.initial), exact(self.answer.initial["omega"])
        state = np.array([*q, *self.equations.momentum(q, omega)])
        self.times = [Decimal(t) for t in self.answer.columns["t"]]
        scale = max(length(state[4:]), self.size() / 100)
        scales = [Decimal(1)] * 4 + [scale] * 3
        self.states = list(integrate(self.equations.rate, state, self.times, scales, FINE))
        self.rows = [
            self.equations.numbers(*row) for row in zip(self.times, self.states, strict=True)
        ]
        self.errors = self.find_errors(stated or {})

    def size(self) -> Decimal:
        """A momentum that the weight and the torques give the body in the span."""
        data = self.answer.data
        torques = [np.linalg.norm(x) for key, x in data.items() if TORQUE.fullmatch(key)]
        weight = data["mass"] * data["gravity"] * np.linalg.norm(data["centre_of_mass"])
        return Decimal(float(weight + sum(torques))) * self.times[-1]

    def find_errors(self, stated: Mapping[str, Mapping[str, Any]]) -> dict[str, Error]:
        """The errors of all quantities."""
        columns = self.answer.columns
        bounds = {"attitude": ["orientation"], "omega": [f"omega{i}" for i in (1, 2, 3)]}
        kinds = {
            name: "proved" if all(map(self.answer.is_proved, of)) else "agreement"
            for name, of in bounds.items()
        }
        largest = dict.fromkeys(QUANTITIES, Decimal(0))
        for i, (t, state, row) in enumerate(zip(self.times, self.states, self.rows, strict=True)):
            q = [columns[f"q{k}"][i] for k in range(4)]
            omega = [columns[f"omega{k}"][i] for k in (1, 2, 3)]
            attitude = angle(state[:4], q) + angle(state[:4], state[:4].astype(float))
            turning = distance(row["omega"], omega) + rounding(row["omega"])
            if kinds["attitude"] == "proved":
                attitude += Decimal(columns["orientation_bound"][i])
            if kinds["omega"] == "proved":
                turning += length([columns[f"omega{k}_bound"][i] for k in (1, 2, 3)])
            changes = self.slopes(t, state)
            errors = {"attitude": attitude, "omega": turning}
            for name in self.rows[0]:
                by_turn, by_omega = changes[name]
                quantity = OWNERS.get(name, name)
                error = by_turn * attitude + by_omega * turning
                error += rounding(row[name])
                if name not in ("matrix", "omega"):
                    errors[quantity] = max(errors.get(quantity, 0), error)
            for name, error in errors.items():
                largest[name] = max(largest[name], error)
        self.compare_with_program()
        both = "proved" if set(kinds.values()) == {"proved"} else "agreement"
        errors = {}
        for name, error in largest.items():
            value, kind = rounded_up(error * MARGIN), kinds.get(name, both)
            old = stated.get(name, {})
            if old.get("kind") == kind and error <= Decimal(old["value"]) <= 4 * Decimal(value):
                value = old["value"]
            errors[name] = Error(value, kind)
        return errors

    def slopes(self, t: Decimal, state: Sequence[Decimal]) -> dict[str, tuple[Decimal, Decimal]]:
        """The norms of the derivatives of the numbers of a row by the attitude and by omega."""
        small = Decimal("1e-12")
        q, squares = state[:4], {name: [Decimal(0), Decimal(0)] for name in self.rows[0]}
        omega = self.equations.motion(t, state)[1]
        here = self.equations.numbers(t, state)
        for k in range(3):
            step = exact([0] * 3)
            step[k] = small
            turn = product(q, np.array([Decimal(1), *(step / 2)]))
            for j, (new, rate) in enumerate(((turn, omega), (q, omega + step))):
                momentum = self.equations.momentum(new, rate, t)
                there = self.equations.numbers(t, np.array([*new, *momentum]))
                for name in here:
                    squares[name][j] += (distance(there[name], here[name]) / small) ** 2
        return {name: (a.sqrt(), b.sqrt()) for name, (a, b) in squares.items()}

    def compare_with_program(self) -> None:
        """The program's own energy, momentum and force are those of the second computation."""
        columns, data = self.answer.columns, self.answer.data
        own = {
            "energy": [
                (kinetic + data["mass"] * data["gravity"] * height,)
                for kinetic, height in zip(columns["kinetic"], columns["com_z"], strict=True)
            ],
            "force": list(zip(*(columns[f"force_{x}"] for x in "xyz"), strict=True)),
            "momentum": [(z,) for z in columns["lz"]],
        }
        for name, rows in own.items():
            found = [row[name][-1:] if name == "momentum" else row[name] for row in self.rows]
            scale = max(map(length, (row[name] for row in self.rows))) or 1
            error = max(map(distance, rows, found)) / scale
            if error > LARGEST_DISAGREEMENT:
                raise MotionError(f"{self.name}: the program's {name} differs by {error:.1e}")

    def inherent_errors(self) -> list[float]:
        """The inherent error at each time: each datum changed by half a unit, as independent.

        Elements of the inertia that are equal remain equal.
        """
        first = [float(x) for x in self.states[0][:4]]
        data = self.answer.data | {"quaternion": first, "omega": self.answer.initial["omega"]}
        places = list(places_of(data))
        displaced = {
            key: np.repeat(np.asarray(value, dtype=float)[..., None], len(places) + 1, axis=-1)
            for key, value in data.items()
        }
        for k, (key, at) in enumerate(places, 1):
            displaced[key][(*at, k)] *= 1 + DISPLACEMENT
        q = displaced.pop("quaternion")
        q, omega = q / np.sqrt(sum(q * q)), displaced.pop("omega")
        equations = Equations(displaced, ARRAYS)
        state = np.array([*q, *equations.momentum(q, omega)])
        scale = max(float(length(state[4:])) for state in self.states)
        times = [float(t) for t in self.times]
        errors = []
        for now in integrate(equations.rate, state, times, [1] * 4 + [scale] * 3, COARSE):
            turn = product(now[:4, :1] * [[1], [-1], [-1], [-1]], now[:4])
            change = 2 * np.sqrt(sum(turn[1:] ** 2)) / DISPLACEMENT * ROUNDING
            errors.append(float(np.sqrt(np.sum(change * change))))
        return errors

    def table(self) -> str:
        """The table, which `spintop verify` reads: certified numbers, where they are proved."""
        errors = self.inherent_errors()
        names = ",".join(COLUMNS)
        lines = [names]
        attitudes = zip(*(self.answer.columns[f"q{k}"] for k in range(4)), strict=True)
        if self.errors["attitude"].kind == "proved":
            attitudes = [self.states[0][:4], *(tuple(map(Decimal, q)) for q in list(attitudes)[1:])]
        else:
            attitudes = [state[:4] for state in self.states]
        rates = zip(*(self.answer.columns[f"omega{k}"] for k in (1, 2, 3)), strict=True)
        rows = zip(self.times, attitudes, rates, self.rows, errors, strict=True)
        for t, q, omega, row, inherent in rows:
            groups = {"attitude": (*q, q[0]), **row}
            if self.errors["omega"].kind == "proved" and t > 0:
                groups["omega"] = tuple(map(Decimal, omega))
            cells = [shortest(t)]
            for name, numbers in groups.items():
                agree = numbers if t == 0 else self.digits(numbers, OWNERS.get(name, name))
                cells += map(shortest, agree)
            lines.append(",".join([*cells, f"{inherent:.1e}"]))
        body = "\n".join([*lines, "# status: ok"]) + "\n"
        head = [
            f"title: {self.answer.title}",
            f"reference set: {VERSION}, licence {LICENCE}",
            "format: 1",
            *(
                f"error of {name}: {error.value:.0e} {QUANTITIES[name][0]}, {error.kind}"
                for name, error in self.errors.items()
            ),
            "input:",
            *("    " + line for line in self.answer.given),
        ]
        end = f"# end: {len(self.rows)} rows, CRC-32 {zlib.crc32(body.encode()):08X}\n"
        return "".join(f"# {line}\n" for line in head) + body + end

    def digits(self, numbers: Sequence[Decimal], quantity: str) -> Sequence[Decimal]:
        """Numbers as far as two computations agree, where they are not proved.

        That is to a digit beyond the first that the error of the quantity reaches.
        """
        error = self.errors[quantity]
        if error.kind == "proved":
            return numbers
        place = Decimal(1).scaleb(Decimal(error.value).adjusted() - 1)
        return [number.quantize(place) for number in numbers]

    def description(self) -> dict[str, Any]:
        """The motion as JSON: data, units, conventions, errors."""
        data = dict(self.answer.data)
        body = {key: data.pop(key) for key in ("mass", "gravity", "inertia", "centre_of_mass")}
        body["damping"] = data.pop("damping")
        return {
            "name": self.name,
            "title": self.answer.title,
            "source": self.source,
            "version": VERSION,
            "licence": LICENCE,
            "body": body,
            "start": {
                **{key: self.answer.initial[key] for key in ANGLES if key in self.answer.initial},
                "quaternion": [float(x) for x in self.states[0][:4]],
                "omega": self.answer.initial["omega"],
            },
            "effects": data,
            "t_end": float(self.times[-1]),
            "errors": {
                name: {"value": error.value, "unit": QUANTITIES[name][0], "kind": error.kind}
                for name, error in self.errors.items()
            },
            "conventions": CONVENTIONS,
            "columns": {name: f"{unit}: {what}" for name, (unit, what) in COLUMNS.items()},
        }


def places_of(data: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The numbers other than 0 among the data: key and indices."""
    for key, value in data.items():
        array = np.asarray(value, dtype=float)
        if key == "inertia":
            yield from ((key, np.nonzero(array == x)) for x in np.unique(array[array != 0]))
        else:
            yield from ((key, at) for at in np.ndindex(array.shape) if array[at])


def rounded_up(error: Decimal) -> float:
    """An error with one digit, rounded up."""
    place = Decimal(1).scaleb(error.adjusted()) if error else Decimal(1)
    return float(error.quantize(place, rounding=ROUND_CEILING))


def shortest(number: Decimal) -> str:
    """The fewest digits that give the same double."""
    return repr(float(number) + 0.0).removesuffix(".0")


def as_text(description: Mapping[str, Any]) -> str:
    """JSON with a line for each member, of the first and the second level."""
    lines = []
    for key, value in description.items():
        if isinstance(value, Mapping) and value:
            inner = (f"    {json.dumps(k)}: {json.dumps(v)}" for k, v in value.items())
            text = "{\n" + ",\n".join(inner) + "\n  }"
        else:
            text = json.dumps(value)
        lines.append(f"  {json.dumps(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"
