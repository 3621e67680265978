"""PyBullet, in double precision, without damping, sleeping and a limit of the velocity.

`multibody` is Featherstone's articulated body, of a top with a spherical joint; `rigid body` that
of `useMaximalCoordinates`, of a top on a point constraint.
"""

import numpy as np
import pybullet as bullet

from peers.quaternion import conjugate, to_space

METHODS = ("multibody", "rigid body")
bullet.connect(bullet.DIRECT)
NO_TURN = [0, 0, 0, 1]


def make_jointed(motion: dict) -> int:
    """A link on a spherical joint, whose motor is off."""
    body = bullet.createMultiBody(
        baseMass=0, linkMasses=[motion["mass"]], linkCollisionShapeIndices=[-1],
        linkVisualShapeIndices=[-1], linkPositions=[[0, 0, 0]], linkOrientations=[NO_TURN],
        linkInertialFramePositions=[motion["arm"]], linkInertialFrameOrientations=[NO_TURN],
        linkParentIndices=[0], linkJointTypes=[bullet.JOINT_SPHERICAL], linkJointAxis=[[0, 0, 1]],
    )  # fmt: skip
    motor = {"positionGain": 0, "velocityGain": 1, "force": [0, 0, 0]}
    how = bullet.POSITION_CONTROL
    bullet.setJointMotorControlMultiDof(body, 0, how, NO_TURN, [0, 0, 0], **motor)
    return body


def prepare(motion: dict, method: str, step: float) -> tuple:
    """A world of one body."""
    bullet.resetSimulation()
    bullet.setTimeStep(step)
    bullet.setGravity(0, 0, -motion["gravity"])
    q, arm = motion["quaternion"], motion["arm"]
    turned, omega, centre = [*q[1:], q[0]], to_space(q, motion["omega"]), to_space(q, arm)
    jointed = motion["is_top"] and method == "multibody"
    if jointed:
        body = make_jointed(motion)
    else:
        shape = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=0.01)
        maximal = {"useMaximalCoordinates": method != "multibody"}
        body = bullet.createMultiBody(motion["mass"], shape, -1, centre, turned, **maximal)
        bullet.resetBaseVelocity(body, np.cross(omega, centre).tolist(), omega)
        bullet.changeDynamics(body, -1, mass=motion["mass"])
    link = 0 if jointed else -1
    bullet.changeDynamics(body, link, localInertiaDiagonal=motion["inertia"])
    bullet.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0,
                          maxJointVelocity=1e9)  # fmt: skip
    if jointed:
        bullet.resetJointStateMultiDof(body, 0, turned, motion["omega"])
    elif motion["is_top"]:
        ground = bullet.createMultiBody(0)
        bullet.createConstraint(ground, -1, body, -1, bullet.JOINT_POINT2POINT, [0, 0, 0],
                                [0, 0, 0], [-x for x in arm])  # fmt: skip

    def advance(n: int) -> None:
        for _ in range(n):
            bullet.stepSimulation()

    def state() -> list:
        if jointed:
            (x, y, z, w), rate, *_ = bullet.getJointStateMultiDof(body, 0)
            return [w, x, y, z, *rate]
        _, (x, y, z, w) = bullet.getBasePositionAndOrientation(body)
        _, rate = bullet.getBaseVelocity(body)
        return [w, x, y, z, *to_space(conjugate([w, x, y, z]), rate)]

    return advance, state
