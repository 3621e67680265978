"""DART: a free or a ball joint, with its semi-implicit Euler method, in double precision.

Its deactivation of bodies at rest is switched off.
"""

import dartpy as dart
import numpy as np
from scipy.spatial.transform import Rotation

METHODS = ("Euler",)


def prepare(motion: dict, method: str, step: float) -> tuple:
    """A world of one body, whose coordinates of rotation are a rotation vector."""
    world = dart.simulation.World()
    world.setTimeStep(step)
    world.setGravity([0, 0, -motion["gravity"]])
    options = world.getDeactivationOptions()
    options.mEnabled = False
    world.setDeactivationOptions(options)
    skeleton = dart.dynamics.Skeleton()
    top = motion["is_top"]
    joint, body = (
        skeleton.createBallJointAndBodyNodePair() if top
        else skeleton.createFreeJointAndBodyNodePair()
    )  # fmt: skip
    inertia = np.diag(motion["inertia"])
    body.setInertia(dart.dynamics.Inertia(motion["mass"], motion["arm"], inertia))
    turn = Rotation.from_quat(motion["quaternion"], scalar_first=True).as_rotvec()
    rest = [] if top else [0, 0, 0]
    joint.setPositions([*turn, *rest])
    joint.setVelocities([*motion["omega"], *rest])
    world.addSkeleton(skeleton)

    def advance(n: int) -> None:
        for _ in range(n):
            world.step()

    def state() -> list:
        turn = Rotation.from_matrix(body.getTransform().rotation())
        return [
            *turn.as_quat(scalar_first=True),
            *body.getAngularVelocity(dart.dynamics.Frame.World(), body),
        ]

    return advance, state
