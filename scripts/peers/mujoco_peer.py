"""MuJoCo: the body on a ball joint, at fixed time steps; it needs no equations from elsewhere."""

import math

from peers.answer import Answer, least_time
from peers.problem import Problem

try:
    import mujoco
except ImportError:
    mujoco = None

NAME = "MuJoCo"
METHODS = ("mujoco_rk4", "mujoco_implicitfast")
FORMULATIONS = ("rigid_body",)
DEBIAN: tuple[str, ...] = ()
SETTING = "steps"
SETTINGS = tuple(10**i * j for i in range(2, 7) for j in (1, 3))
SCHEMES = {"mujoco_rk4": ("RK4", 4), "mujoco_implicitfast": ("implicitfast", 1)}
"""Its name for a method, and how often that looks at the forces in a step."""

SMALL = 0.01
"""Mass times distance squared over the least moment of inertia."""

MODEL = """\
<mujoco>
  <option timestep="{step!r}" integrator="{scheme}" gravity="0 0 -1">
    <flag contact="disable" constraint="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <body>
      <joint type="ball"/>
      <inertial pos="{place}" mass="{mass!r}" fullinertia="{inertia}"/>
    </body>
  </worldbody>
</mujoco>
"""


def absence() -> str:
    """Why it cannot be had."""
    return "" if mujoco else "the Python package mujoco is not installed"


def versions() -> str:
    """What is used."""
    return f"MuJoCo {mujoco.__version__}"


def as_text(numbers: list[float]) -> str:
    """An attribute of several numbers."""
    return " ".join(map(repr, numbers))


def build(problem: Problem, scheme: str, steps: int) -> object:
    """The body, whose inertia MuJoCo wants about the centre of mass.

    The motion depends on m g r alone, so under unit gravity the mass may be as large, and the
    centre of mass as near to the fixed point, as one likes: then the inertia is that of a body.
    """
    pull = math.hypot(*problem.weight)
    mass = pull**2 / (SMALL * min(problem.inertia)) or 1.0
    place = [part / mass for part in problem.weight]
    square = sum(x * x for x in place)
    about = [i - mass * (square - x * x) for i, x in zip(problem.inertia, place, strict=True)]
    mixed = [mass * place[i] * place[j] for i, j in ((0, 1), (0, 2), (1, 2))]
    text = MODEL.format(
        step=problem.t_end / steps,
        scheme=scheme,
        place=as_text(place),
        mass=mass,
        inertia=as_text([*about, *mixed]),
    )
    model = mujoco.MjModel.from_xml_string(text)
    model.dof_damping[:] = problem.damping
    return model


def solve(problem: Problem, method: str, formulation: str, setting: int) -> Answer:
    """Take so many steps."""
    scheme, looks = SCHEMES[method]
    model = build(problem, scheme, setting)
    data = mujoco.MjData(model)

    def before() -> None:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = problem.quaternion
        data.qvel[:] = problem.omega

    seconds = least_time(lambda: mujoco.mj_step(model, data, setting), before)
    if any(warning.number for warning in data.warning) or not all(map(math.isfinite, data.qpos)):
        raise ArithmeticError("the simulation is unstable")
    return Answer(data.qpos.tolist(), seconds, setting, 0, setting * looks)
