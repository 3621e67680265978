"""MuJoCo: a free or a ball joint; its four integrators, in double precision.

Documentation, "Computation", numerical integration: Euler is semi-implicit, with joint damping
alone implicit; `implicit` takes the derivatives of all velocity-dependent forces, Coriolis and
centripetal ones included; `implicitfast` leaves those out, and is the recommended one; RK4 is the
classical method of Runge and Kutta.
"""

import mujoco

METHODS = ("Euler", "implicitfast", "implicit", "RK4")
MODEL = """\
<mujoco>
  <option timestep="{step!r}" integrator="{method}" gravity="0 0 {gravity!r}">
    <flag contact="disable" constraint="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <body>
      <joint type="{joint}"/>
      <inertial pos="{arm}" mass="{mass!r}" diaginertia="{inertia}"/>
    </body>
  </worldbody>
</mujoco>
"""


def make_model(motion: dict, method: str, step: float) -> mujoco.MjModel:
    """A model of one body, whose coordinates end with the attitude and the omega in the body."""
    return mujoco.MjModel.from_xml_string(
        MODEL.format(
            step=step,
            method=method,
            gravity=-motion["gravity"],
            joint="ball" if motion["is_top"] else "free",
            arm=" ".join(map(repr, motion["arm"])),
            mass=motion["mass"],
            inertia=" ".join(map(repr, motion["inertia"])),
        )
    )


def prepare(motion: dict, method: str, step: float) -> tuple:
    """The body at its start."""
    model = make_model(motion, method, step)
    data = mujoco.MjData(model)
    data.qpos[-4:] = motion["quaternion"]
    data.qvel[-3:] = motion["omega"]
    return lambda n: mujoco.mj_step(model, data, n), lambda: [*data.qpos[-4:], *data.qvel[-3:]]
