"""The Euler-Poisson equations of a body with effects, for any kind of number.

They are those of `doc/effects.md`, written a second time: the program is compared with them. The
state is the quaternion (scalar first, body to space) and the angular momentum in body axes, with
that of a rotor and of the rotation of the frame. A number is a `decimal.Decimal`, or an array of
numpy in which each element belongs to a motion of its own. A vector is an array of numbers along
its first axis, and so are the rows of a matrix.
"""

from collections.abc import Callable, Mapping
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

Number = Any
Vector = Matrix = np.ndarray
NEXT, LAST = [1, 2, 0], [2, 0, 1]


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
    return (a * b).sum(0)


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return a[NEXT] * b[LAST] - a[LAST] * b[NEXT]


def times(matrix: Matrix, a: Vector) -> Vector:
    """A matrix times a vector."""
    return (matrix * a).sum(1)


def inverse(matrix: Matrix) -> Matrix:
    """The inverse of a symmetric matrix."""
    a, b, c = matrix
    rows = np.array([cross(b, c), cross(c, a), cross(a, b)])
    return rows / dot(a, rows[0])


def rotation(q: Vector) -> Matrix:
    """The matrix of a unit quaternion, body to space."""
    w, x, y, z = q
    a, b, c = x + x, y + y, z + z
    xx, yy, zz = a * x, b * y, c * z
    wx, wy, wz, xy, yz, zx = w * a, w * b, w * c, x * b, y * c, z * a
    return np.array([
        (1 - yy - zz, xy - wz, zx + wy),
        (xy + wz, 1 - zz - xx, yz - wx),
        (zx - wy, yz + wx, 1 - xx - yy),
    ])  # fmt: skip


def product(p: Vector, q: Vector) -> Vector:
    """The product of two quaternions."""
    vector = p[0] * q[1:] + q[0] * p[1:] + cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - dot(p[1:], q[1:]), *vector])


class Equations:
    """The equations of a body. `data` has its numbers by the names of the input."""

    def __init__(self, data: Mapping[str, Any], arithmetic: Arithmetic) -> None:
        """Keep the data; a `motion` of the pivot or the frame that is not given is none."""
        data = {key: np.asarray(value)[()] for key, value in data.items()}
        self.data, self.arithmetic = data, arithmetic
        self.inertia, self.centre = data["inertia"], data["centre_of_mass"]
        self.inverse = inverse(self.inertia)
        self.weight = data["mass"] * data["gravity"]
        self.none = self.frame = 0 * self.centre
        self.is_turning = "earth_rate" in data
        self.has_space_torque = any(key.startswith("torque_space") for key in data)
        if self.is_turning:
            cosine, sine = arithmetic.turn(data["latitude"])
            self.frame = data["earth_rate"] * np.array([0 * cosine, cosine, sine])

    def rotor(self, t: Number) -> Vector:
        """The momentum of the rotor, in body axes."""
        if "rotor_momentum" not in self.data:
            return self.none
        return self.data["rotor_momentum"] + t * self.data.get("rotor_torque", self.none)

    def momentum(self, q: Vector, omega: Vector, t: Number = 0) -> Vector:
        """The angular momentum in body axes."""
        frame = times(rotation(q).swapaxes(0, 1), self.frame)
        return times(self.inertia, omega + frame) + self.rotor(t)

    def turns(self, name: str, t: Number) -> tuple[Vector, Vector]:
        """Amplitude times cosine and times sine of what is harmonic."""
        angles = self.data[f"{name}_rate"] * t + self.data.get(f"{name}_phase", self.none)
        sizes = self.data[f"{name}_amplitude"]
        return tuple(sizes * np.array([self.arithmetic.turn(x) for x in angles]).swapaxes(0, 1))

    def torque(self, name: str, t: Number) -> Vector:
        """A given torque: its constant part and its harmonic one."""
        constant = self.data.get(name, self.none)
        return constant + self.turns(name, t)[0] if f"{name}_rate" in self.data else constant

    def pivot(self, t: Number) -> Vector:
        """The acceleration of the pivot, in space axes."""
        rate = self.data["vibration_rate"]
        place, across = self.turns("vibration", t)
        turning = cross(self.frame, -2 * rate * across + cross(self.frame, place))
        return -rate * rate * place + turning

    def motion(self, t: Number, state: Vector) -> tuple[Any, ...]:
        """Matrix, angular velocity (to the frame, absolute), rate of momentum, force of the air."""
        data, matrix = self.data, rotation(state[:4])
        back, momentum = matrix.swapaxes(0, 1), state[4:]
        omega = absolute = times(self.inverse, momentum - self.rotor(t))
        if self.is_turning:
            omega = absolute - times(back, self.frame)
        field = data["gravity"] * matrix[2]
        if "vibration_rate" in data:
            field = field + times(back, self.pivot(t))
        change = cross(momentum, absolute) + cross(data["mass"] * field, self.centre)
        change = change - data["damping"] * omega + self.torque("torque_body", t)
        if self.has_space_torque:
            change = change + times(back, self.torque("torque_space", t))
        if "friction_torque" in data:
            speed = self.arithmetic.or_one(self.arithmetic.sqrt(dot(omega, omega)))
            change = change - data["friction_torque"] / speed * omega
        if "drag_moment" in data:
            change = change - data["drag_moment"] * self.arithmetic.sqrt(dot(omega, omega)) * omega
        air = self.none
        if "drag_force" in data:
            velocity = cross(omega, self.centre)
            air = -data["drag_force"] * self.arithmetic.sqrt(dot(velocity, velocity)) * velocity
            change = change + cross(self.centre, air)
        return matrix, omega, absolute, change, air, field

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
        return np.array([*turning, *change])

    def numbers(self, t: Number, state: Vector) -> dict[str, Vector]:
        """What a row of the set has beside the attitude, in groups."""
        matrix, omega, absolute, change, air, field = self.motion(t, state)
        drive = self.data.get("rotor_torque", self.none)
        spinning = times(self.inverse, change - drive)
        inward = cross(absolute, cross(absolute, self.centre))
        pull = self.data["mass"] * (field + cross(spinning, self.centre) + inward)
        height = dot(matrix[2], self.centre)
        kinetic = dot(omega, times(self.inertia, omega)) / 2
        return {
            "matrix": matrix.reshape(9, *matrix.shape[2:]),
            "omega": omega,
            "omega_space": times(matrix, omega),
            "energy": np.array([kinetic + self.weight * height]),
            "momentum": times(matrix, state[4:]),
            "force": times(matrix, pull - air),
        }
