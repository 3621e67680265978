"""MJX: MuJoCo's model in JAX, compiled for this processor.

It computes in double precision, which JAX has to be told to use.
"""

import jax
import numpy as np
from mujoco import mjx

from engines.mujoco import make_model

METHODS = ("Euler", "RK4")
jax.config.update("jax_enable_x64", True)


@jax.jit
def advance_by(model: mjx.Model, data: mjx.Data, n: int) -> mjx.Data:
    """All steps in one call."""
    return jax.lax.fori_loop(0, n, lambda _, data: mjx.step(model, data), data)


def prepare(motion: dict, method: str, step: float) -> tuple:
    """The body at its start; all is compiled here."""
    model = mjx.put_model(make_model(motion, method, step))
    data = mjx.make_data(model)
    qpos, qvel = np.array(data.qpos), np.array(data.qvel)
    qpos[-4:], qvel[-3:] = motion["quaternion"], motion["omega"]
    data = data.replace(qpos=jax.numpy.array(qpos), qvel=jax.numpy.array(qvel))
    advance_by(model, advance_by(model, data, 1), 1)

    def advance(n: int) -> None:
        nonlocal data
        data = jax.block_until_ready(advance_by(model, data, n))

    return advance, lambda: [*data.qpos[-4:], *data.qvel[-3:]]
