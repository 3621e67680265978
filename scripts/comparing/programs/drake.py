"""Drake: a MultibodyPlant, discrete, or continuous with Runge-Kutta methods of one step size.

The fixed point is a BallRpyJoint, whose roll is about the axis of the top and whose yaw about the
vertical, so that it is singular only where the top is upright.
"""

from importlib.metadata import version

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BallRpyJoint, FixedOffsetFrame, SpatialInertia, UnitInertia
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator

from comparing.problem import Problem, conjugate, to_space

VERSIONS = f"Drake {version('drake')}"
STEPPERS = ("discrete", "runge_kutta3", "runge_kutta5")


def prepare(problem: Problem, method: str, step: float) -> tuple:
    """A plant of one body."""
    plant = MultibodyPlant(step if method == "discrete" else 0.0)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -problem.gravity])
    mass, arm = problem.mass, np.array(problem.arm)
    inertia = UnitInertia(*(i / mass for i in problem.inertia))
    body = plant.AddRigidBody("body", SpatialInertia(mass, arm, inertia))
    if problem.is_top:
        turned = RotationMatrix.MakeFromOneVector(arm, 0)
        spun = plant.AddFrame(FixedOffsetFrame("spun", body, RigidTransform(turned)))
        joint = plant.AddJoint(BallRpyJoint("pivot", plant.world_frame(), spun))
    plant.Finalize()
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    start, omega = RotationMatrix(Quaternion(problem.quaternion)), problem.omega
    if problem.is_top:
        joint.set_angles(context, RollPitchYaw(start @ turned).vector())
        joint.set_angular_velocity(context, start @ omega)
    else:
        plant.SetFreeBodyPose(context, body, RigidTransform(start, [0, 0, 0]))
        velocity = plant.GetVelocities(context)
        velocity[:3] = start @ omega
        plant.SetVelocities(context, velocity)
    if method != "discrete":
        ResetIntegratorFromFlags(simulator, method, step)
        simulator.get_mutable_integrator().set_fixed_step_mode(True)
    simulator.Initialize()

    def state() -> list:
        q = plant.EvalBodyPoseInWorld(context, body).rotation().ToQuaternion().wxyz()
        rate = plant.EvalBodySpatialVelocityInWorld(context, body).rotational()
        return [*q, *to_space(conjugate(q), rate)]

    return lambda n: simulator.AdvanceTo(context.get_time() + n * step), state
