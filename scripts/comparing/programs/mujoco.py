"""MuJoCo: a free or a ball joint; its four integrators, in double precision.

Documentation, "Computation", numerical integration: Euler is semi-implicit, with joint damping
alone implicit; `implicit` takes the derivatives of all velocity-dependent forces, Coriolis and
centripetal ones included; `implicitfast` leaves those out, and is the recommended one; RK4 is the
classical method of Runge and Kutta.
"""

import math

import mujoco

from comparing.answer import Answer, least_time
from comparing.problem import Problem

VERSIONS = f"MuJoCo {mujoco.__version__}"
STEPPERS = ("Euler", "implicitfast", "implicit", "RK4")
METHODS = ("RK4", "implicitfast")
FORMULATIONS = ("rigid_body",)
SETTINGS = tuple(10**i * j for i in range(2, 7) for j in (1, 3))
"""Steps."""
MODEL = """\
<mujoco>
  <option timestep="{step!r}" integrator="{method}" gravity="0 0 {gravity!r}">
    <flag contact="disable" constraint="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <body>
      <joint type="{joint}"/>
      <inertial pos="{place}" mass="{mass!r}" fullinertia="{inertia}"/>
    </body>
  </worldbody>
</mujoco>
"""


def prepare(problem: Problem, method: str, step: float) -> tuple:
    """The body at its start: its coordinates end with the attitude and the omega in the body."""
    inertia = problem.central
    entries = [inertia[i][j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    text = MODEL.format(
        step=step, method=method, gravity=-problem.gravity, mass=problem.mass,
        joint="ball" if problem.is_top else "free", place=" ".join(map(repr, problem.arm)),
        inertia=" ".join(map(repr, entries)),
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    model.dof_damping[-3:] = problem.damping
    data = mujoco.MjData(model)
    data.qpos[-4:] = problem.quaternion
    data.qvel[-3:] = problem.omega

    def advance(n: int) -> None:
        mujoco.mj_step(model, data, n)
        if any(warning.number for warning in data.warning) or not math.isfinite(data.qpos[-1]):
            raise ArithmeticError("the simulation is unstable")

    return advance, lambda: [*data.qpos[-4:], *data.qvel[-3:]]


def solve(problem: Problem, method: str, formulation: str, setting: int) -> Answer:
    """Take so many steps to the end."""
    ready: list = []

    def before() -> None:
        ready[:] = prepare(problem, method, problem.t_end / setting)

    seconds = least_time(lambda: ready[0](setting), before)
    looks = 4 if method == "RK4" else 1
    state = [float(x) for x in ready[1]()]
    return Answer([state], seconds, setting, evaluations=setting * looks)
