"""The Euler-Poisson equations of a body with effects, for any kind of number.

They are those of `doc/effects.md`, written a second time: the program is compared with them. The
state is the quaternion (scalar first, body to space) and the angular momentum in body axes, with
that of a rotor and of the rotation of the frame. A number is a `decimal.Decimal`, or an array of
numpy in which each element belongs to a motion of its own.
"""

from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

Number = Any
Vector = Sequence[Number]


class Arithmetic(NamedTuple):
    """What numbers can do beside sums, products and quotients."""

    sqrt: Callable[[Number], Number]
    turn: Callable[[Number], tuple[Number, Number]]
    """The cosine and the sine of an angle."""
    or_one: Callable[[Number], Number]
    """The number, or 1 in place of 0."""


def decimal_turn(angle: Decimal) -> tuple[Decimal, Decimal]:
    """The cosine and the sine: the series of exp(i angle/1024), squared ten times."""
    x, term = angle / 1024, Decimal(1)
    parts = [Decimal(0)] * 4
    for n in range(32):
        parts[n % 4] += term
        term = term * x / (n + 1)
    cosine, sine = parts[0] - parts[2], parts[1] - parts[3]
    for _ in range(10):
        cosine, sine = cosine * cosine - sine * sine, 2 * cosine * sine
    return cosine, sine


DECIMALS = Arithmetic(Decimal.sqrt, decimal_turn, lambda x: x or Decimal(1))
ARRAYS = Arithmetic(np.sqrt, lambda x: (np.cos(x), np.sin(x)), lambda x: np.where(x == 0, 1.0, x))


def dot(a: Vector, b: Vector) -> Number:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def add(a: Vector, *others: Vector) -> Vector:
    """The sum of vectors."""
    for b in others:
        a = (a[0] + b[0], a[1] + b[1], a[2] + b[2])
    return a


def scaled(factor: Number, a: Vector) -> Vector:
    """A multiple of a vector."""
    return (factor * a[0], factor * a[1], factor * a[2])


def times(matrix: Sequence[Vector], a: Vector) -> Vector:
    """A matrix times a vector."""
    return (dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a))


def transposed(matrix: Sequence[Vector]) -> Sequence[Vector]:
    """The transposed matrix."""
    return tuple(zip(*matrix, strict=True))


def inverse(matrix: Sequence[Vector]) -> Sequence[Vector]:
    """The inverse of a symmetric matrix."""
    a, b, c = matrix
    rows = cross(b, c), cross(c, a), cross(a, b)
    determinant = dot(a, rows[0])
    return tuple(tuple(x / determinant for x in row) for row in rows)


def rotation(q: Vector) -> Sequence[Vector]:
    """The matrix of a unit quaternion, body to space."""
    w, x, y, z = q
    a, b, c = x + x, y + y, z + z
    xx, yy, zz = a * x, b * y, c * z
    wx, wy, wz, xy, yz, zx = w * a, w * b, w * c, x * b, y * c, z * a
    return (
        (1 - yy - zz, xy - wz, zx + wy),
        (xy + wz, 1 - zz - xx, yz - wx),
        (zx - wy, yz + wx, 1 - xx - yy),
    )


def product(p: Vector, q: Vector) -> Vector:
    """The product of two quaternions."""
    vector = add(scaled(p[0], q[1:]), scaled(q[0], p[1:]), cross(p[1:], q[1:]))
    return (p[0] * q[0] - dot(p[1:], q[1:]), *vector)


class Equations:
    """The equations of a body. `data` has its numbers by the names of the input."""

    def __init__(self, data: Mapping[str, Any], arithmetic: Arithmetic) -> None:
        """Keep the data; a `motion` of the pivot or the frame that is not given is none."""
        self.data, self.arithmetic = data, arithmetic
        self.inertia, self.centre = data["inertia"], data["centre_of_mass"]
        self.inverse = inverse(self.inertia)
        self.weight = data["mass"] * data["gravity"]
        self.zero = 0 * data["mass"]
        self.none = (self.zero,) * 3
        self.frame = self.none
        self.is_turning, self.has_rotor = "earth_rate" in data, "rotor_momentum" in data
        self.has_space_torque = any(key.startswith("torque_space") for key in data)
        if self.is_turning:
            cosine, sine = arithmetic.turn(data["latitude"])
            self.frame = (self.zero, data["earth_rate"] * cosine, data["earth_rate"] * sine)

    def rotor(self, t: Number) -> Vector:
        """The momentum of the rotor, in body axes."""
        if not self.has_rotor:
            return self.none
        drive = self.data.get("rotor_torque", self.none)
        return add(self.data["rotor_momentum"], scaled(t, drive))

    def momentum(self, q: Vector, omega: Vector, t: Number = 0) -> Vector:
        """The angular momentum in body axes."""
        frame = times(transposed(rotation(q)), self.frame)
        return add(times(self.inertia, add(omega, frame)), self.rotor(t))

    def turns(self, name: str, t: Number) -> list[tuple[Number, Number, Number]]:
        """The amplitudes of what is harmonic, each with the cosine and the sine of its angle."""
        phases = self.data.get(f"{name}_phase", self.none)
        angles = [self.data[f"{name}_rate"] * t + phase for phase in phases]
        sizes = self.data[f"{name}_amplitude"]
        return [(a, *self.arithmetic.turn(x)) for a, x in zip(sizes, angles, strict=True)]

    def torque(self, name: str, t: Number) -> Vector:
        """A given torque: its constant part and its harmonic one."""
        constant = self.data.get(name, self.none)
        if f"{name}_rate" not in self.data:
            return constant
        return add(constant, [a * cosine for a, cosine, _ in self.turns(name, t)])

    def pivot(self, t: Number) -> Vector:
        """The acceleration of the pivot, in space axes."""
        rate, turns = self.data["vibration_rate"], self.turns("vibration", t)
        place = tuple(a * cosine for a, cosine, _ in turns)
        velocity = tuple(-rate * a * sine for a, _, sine in turns)
        turning = cross(self.frame, add(scaled(2, velocity), cross(self.frame, place)))
        return add(scaled(-rate * rate, place), turning)

    def motion(self, t: Number, state: Vector) -> tuple[Any, ...]:
        """Matrix, angular velocity (to the frame, absolute), rate of momentum, force of the air."""
        data, matrix = self.data, rotation(state[:4])
        back, momentum = transposed(matrix), state[4:]
        own = add(momentum, scaled(-1, self.rotor(t))) if self.has_rotor else momentum
        omega = absolute = times(self.inverse, own)
        if self.is_turning:
            omega = add(absolute, scaled(-1, times(back, self.frame)))
        field = scaled(data["gravity"], matrix[2])
        if "vibration_rate" in data:
            field = add(field, times(back, self.pivot(t)))
        torques = [cross(momentum, absolute), cross(scaled(data["mass"], field), self.centre)]
        torques.append(tuple(-d * w for d, w in zip(data["damping"], omega, strict=True)))
        torques.append(self.torque("torque_body", t))
        if self.has_space_torque:
            torques.append(times(back, self.torque("torque_space", t)))
        if "friction_torque" in data:
            speed = self.arithmetic.or_one(self.arithmetic.sqrt(dot(omega, omega)))
            torques.append(scaled(-data["friction_torque"] / speed, omega))
        if "drag_moment" in data:
            speed = self.arithmetic.sqrt(dot(omega, omega))
            torques.append(
                tuple(-k * speed * w for k, w in zip(data["drag_moment"], omega, strict=True))
            )
        air = self.none
        if "drag_force" in data:
            velocity = cross(omega, self.centre)
            speed = self.arithmetic.sqrt(dot(velocity, velocity))
            air = scaled(-data["drag_force"] * speed, velocity)
            torques.append(cross(self.centre, air))
        return matrix, omega, absolute, add(*torques), air, field

    def rate(self, t: Number, state: Vector) -> Vector:
        """The time derivative of the state."""
        _, omega, _, change, *_ = self.motion(t, state)
        w, x, y, z = state[:4]
        a, b, c = (part / 2 for part in omega)
        turning = (
            -x * a - y * b - z * c,
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
        )
        return (*turning, *change)

    def numbers(self, t: Number, state: Vector) -> dict[str, Vector]:
        """What a row of the set has beside the attitude, in groups."""
        matrix, omega, absolute, change, air, field = self.motion(t, state)
        drive = scaled(-1, self.data.get("rotor_torque", self.none))
        spinning = times(self.inverse, add(change, drive))
        inward = cross(absolute, cross(absolute, self.centre))
        pull = scaled(self.data["mass"], add(field, cross(spinning, self.centre), inward))
        height = dot(matrix[2], self.centre)
        kinetic = dot(omega, times(self.inertia, omega)) / 2
        return {
            "matrix": sum(matrix, ()),
            "omega": omega,
            "omega_space": times(matrix, omega),
            "energy": (kinetic + self.weight * height,),
            "momentum": times(matrix, state[4:]),
            "force": times(matrix, add(pull, scaled(-1, air))),
        }
