"""The equations of motion that peers integrate, written once for all their languages.

Sums and products look the same in Python, C and C++, so the equations stand here as text.
`python_rates` makes a Python function of them (of floats, or of heyoka's expressions), `c_header` a
header for C and C++.

They have no singular attitude and end in the full attitude; `space_frame` and `rigid_body` are
those of spintop's formulations of these names. The axis and the momentum, with psi by quadrature,
are as many states as `space_frame`, and the quadrature is nearly singular where the axis passes a
pole.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from comparing.problem import Problem, product, to_space

Vector = list[float]


@dataclass(frozen=True)
class Equations:
    """y' = f(y) as text: names of constants and states, terms in common, and the rates."""

    name: str
    constants: tuple[str, ...]
    states: tuple[str, ...]
    terms: dict[str, str]
    rates: tuple[str, ...]
    symmetric: bool
    """Whether they hold for undamped symmetric tops only."""
    start: Callable[[Problem], tuple[Vector, Vector]]
    """The constants and the initial state."""
    attitude: Callable[[Problem, Sequence[float]], Vector]
    """The quaternion of a state at the end."""

    def suits(self, problem: Problem) -> bool:
        """Whether the motion obeys them."""
        return problem.is_symmetric or not self.symmetric


def with_spin(problem: Problem, p: Sequence[float]) -> Vector:
    """The attitude at the end: the axes that the equations follow lack a turn about body z."""
    i1, _, i3 = problem.inertia
    half = (i1 - i3) * problem.omega[2] / i1 * problem.t_end / 2
    return product(p, [math.cos(half), 0.0, 0.0, math.sin(half)])


def start_space_frame(problem: Problem) -> tuple[Vector, Vector]:
    """1/(2 I1), L3/(2 I1), 2 m g l; the momentum in space axes and the quaternion."""
    half = 0.5 / problem.inertia[0]
    body = [i * w for i, w in zip(problem.inertia, problem.omega, strict=True)]
    l1, l2, l3 = to_space(problem.quaternion, body)
    return [half, half * l3, 2 * problem.weight[2]], [l1, l2, *problem.quaternion]


def start_cayley_klein(problem: Problem) -> tuple[Vector, Vector]:
    """2 m g l/I1 and the offsets of both stiffnesses; the quaternion and its rate."""
    i1, _, i3 = problem.inertia
    a, b = i3 * problem.omega[2] / i1, 2 * problem.weight[2] / i1
    w1, w2, _ = problem.omega
    q0, q1, q2, q3 = problem.quaternion
    energy = w1**2 + w2**2 + b * ((q0**2 + q3**2) - (q1**2 + q2**2))
    upper, lower = (energy + b + a**2) / 4 + b / 2, b / 2 - (energy - b + a**2) / 4
    rate = product(problem.quaternion, [0.0, w1 / 2, w2 / 2, a / 2])
    return [b, upper, lower], [*problem.quaternion, *rate]


def start_rigid_body(problem: Problem) -> tuple[Vector, Vector]:
    """1/I and its differences, m g r, damping over inertia; the momentum in body axes and the
    quaternion."""
    inverse = [1 / i for i in problem.inertia]
    differences = [inverse[(i + 2) % 3] - inverse[(i + 1) % 3] for i in range(3)]
    damping = [d / i for d, i in zip(problem.damping, problem.inertia, strict=True)]
    momentum = [i * w for i, w in zip(problem.inertia, problem.omega, strict=True)]
    constants = [*inverse, *differences, *problem.weight, *damping]
    return constants, [*momentum, *problem.quaternion]


SPACE_FRAME = Equations(
    "space_frame",
    ("half", "w3", "pull"),
    ("l1", "l2", "p0", "p1", "p2", "p3"),
    {"w1": "half*l1", "w2": "half*l2"},
    (
        "pull*(p0*p1 - p2*p3)",
        "pull*(p1*p3 + p0*p2)",
        "-(w1*p1 + w2*p2 + w3*p3)",
        "w1*p0 + w2*p3 - w3*p2",
        "w2*p0 + w3*p1 - w1*p3",
        "w3*p0 + w1*p2 - w2*p1",
    ),
    True,
    start_space_frame,
    lambda problem, y: with_spin(problem, y[2:]),
)
"""Momentum L in space axes and quaternion p without spin: p' = (0, L) p/(2 I1)."""

CAYLEY_KLEIN = Equations(
    "cayley_klein",
    ("b", "upper", "lower"),
    ("p0", "p1", "p2", "p3", "v0", "v1", "v2", "v3"),
    {"s": "b*(p0*p0 + p3*p3) - upper", "r": "lower - b*(p1*p1 + p2*p2)"},
    ("v0", "v1", "v2", "v3", "s*p0", "r*p1", "r*p2", "s*p3"),
    True,
    start_cayley_klein,
    lambda problem, y: with_spin(problem, y[:4]),
)
"""Two separate oscillators for the Cayley-Klein parameters without spin."""

RIGID_BODY = Equations(
    "rigid_body",
    ("n1", "n2", "n3", "e1", "e2", "e3", "g1", "g2", "g3", "d1", "d2", "d3"),
    ("m1", "m2", "m3", "q0", "q1", "q2", "q3"),
    {
        "w1": "n1*m1", "w2": "n2*m2", "w3": "n3*m3",
        "u1": "2*(q1*q3 - q0*q2)", "u2": "2*(q2*q3 + q0*q1)",
        "u3": "(q0*q0 + q3*q3) - (q1*q1 + q2*q2)",
    },
    (
        "e1*(m2*m3) + (u2*g3 - u3*g2) - d1*m1",
        "e2*(m3*m1) + (u3*g1 - u1*g3) - d2*m2",
        "e3*(m1*m2) + (u1*g2 - u2*g1) - d3*m3",
        "-0.5*(q1*w1 + q2*w2 + q3*w3)",
        "0.5*(q0*w1 + q2*w3 - q3*w2)",
        "0.5*(q0*w2 + q3*w1 - q1*w3)",
        "0.5*(q0*w3 + q1*w2 - q2*w1)",
    ),
    False,
    start_rigid_body,
    lambda problem, y: list(y[3:]),
)  # fmt: skip
"""Momentum and the vertical's moment in body axes, and the quaternion: any body with damping."""

EQUATIONS = {form.name: form for form in (SPACE_FRAME, CAYLEY_KLEIN, RIGID_BODY)}


def python_rates(form: Equations, constants: Sequence, values: str = "y") -> Callable:
    """f(t, y) as a list, of whatever can be added and multiplied; `values` unpacks the state."""
    lines = [
        "def rates(t, y):",
        f"    {', '.join(form.states)} = {values}",
        *(f"    {name} = {text}" for name, text in form.terms.items()),
        f"    return [{', '.join(form.rates)}]",
    ]
    space = dict(zip(form.constants, constants, strict=True))
    exec("\n".join(lines), space)
    return space["rates"]


def c_header() -> str:
    """All equations as C functions, and FORMULATIONS(X) that lists their names and sizes."""
    lines = ["/* Made by scripts/comparing/equations.py. */"]
    for form in EQUATIONS.values():
        head = f"static inline void {form.name}(const double *c, const double *y, double *dy)"
        lines += [head, "{"]
        for array, names in (("c", form.constants), ("y", form.states)):
            lines += [f"    const double {name} = {array}[{i}];" for i, name in enumerate(names)]
        lines += [f"    const double {name} = {text};" for name, text in form.terms.items()]
        lines += [f"    dy[{i}] = {text};" for i, text in enumerate(form.rates)]
        lines += ["}"]
    entries = (f"X({f.name}, {len(f.states)}, {len(f.constants)})" for f in EQUATIONS.values())
    return "\n".join([*lines, f"#define FORMULATIONS(X) {' '.join(entries)}", ""])
