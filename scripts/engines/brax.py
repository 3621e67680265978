"""Brax: two of its pipelines, in single precision, compiled for this processor.

It has no ball joint. Its authors say that it is no longer maintained, and name MJX instead.
"""

from functools import partial
from importlib import import_module
from types import ModuleType

import jax
import jax.numpy as jnp
from brax.io import mjcf

from peers.quaternion import conjugate, to_space

METHODS = ("generalized", "spring")
MODEL = """\
<mujoco>
  <option timestep="{step!r}" gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint type="free"/>
      <inertial pos="0 0 0" mass="{mass!r}" diaginertia="{inertia}"/>
      <geom size="0.01" mass="0" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
</mujoco>
"""


@partial(jax.jit, static_argnums=0)
def advance_by(pipeline: ModuleType, system: object, state: object, n: int) -> object:
    """All steps in one call."""
    return jax.lax.fori_loop(0, n, lambda _, s: pipeline.step(system, s, jnp.zeros(0)), state)


def prepare(motion: dict, method: str, step: float) -> tuple:
    """The body at its start; all is compiled here."""
    if motion["is_top"]:
        raise NotImplementedError("it has no ball joint")
    pipeline = import_module(f"brax.{method}.pipeline")
    inertia = " ".join(map(repr, motion["inertia"]))
    system = mjcf.loads(MODEL.format(step=step, mass=motion["mass"], inertia=inertia))
    velocity = jnp.array([0, 0, 0, *motion["omega"]])
    now = pipeline.init(system, jnp.array([0, 0, 0, *motion["quaternion"]]), velocity)
    advance_by(pipeline, system, advance_by(pipeline, system, now, 1), 1)

    def advance(n: int) -> None:
        nonlocal now
        now = jax.block_until_ready(advance_by(pipeline, system, now, n))

    def state() -> list:
        q = [float(x) for x in now.x.rot[0]]
        return [*q, *to_space(conjugate(q), [float(x) for x in now.xd.ang[0]])]

    return advance, state
