"""Exudyn: a rigid body of rotation vectors, integrated on the Lie group.

The explicit `RK44` and `RK67` take no joints, so that tops have a spherical joint and implicit
methods: `GeneralizedAlpha`, of index 3, without numerical damping (a spectral radius of one), and
`TrapezoidalIndex2`.
"""

from importlib.metadata import version

import exudyn as exu
import numpy as np
from exudyn.utilities import RigidBodyInertia
from scipy.spatial.transform import Rotation

from comparing.problem import Problem

VERSIONS = f"Exudyn {version('exudyn')}"
STEPPERS = ("RK44", "RK67", "GeneralizedAlpha", "TrapezoidalIndex2")
EXPLICIT = STEPPERS[:2]
KIND = exu.DynamicSolverType


def prepare(problem: Problem, method: str, step: float) -> tuple:
    """A system of one body, which each call solves from where it is."""
    if problem.is_top and method in EXPLICIT:
        raise NotImplementedError("explicit methods take no joints")
    container = exu.SystemContainer()
    system = container.AddSystem()
    turn = Rotation.from_quat(problem.quaternion, scalar_first=True)
    omega, arm = turn.apply(problem.omega), turn.apply(problem.arm)
    body = system.CreateRigidBody(
        inertia=RigidBodyInertia(problem.mass, np.array(problem.central)),
        nodeType=exu.NodeType.RotationRotationVector,
        referencePosition=arm, referenceRotationMatrix=turn.as_matrix(),
        initialVelocity=np.cross(omega, arm), initialAngularVelocity=omega,
        gravity=[0, 0, -problem.gravity], returnDict=True,
    )  # fmt: skip
    if problem.is_top:
        ground = system.CreateGround()
        system.CreateSphericalJoint(bodyNumbers=[ground, body["bodyNumber"]], position=[0, 0, 0])
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.6
    settings.timeIntegration.explicitIntegration.dynamicSolverType = getattr(KIND, method)
    time = 0.0

    def advance(n: int) -> None:
        nonlocal time
        settings.timeIntegration.startTime = time
        time += n * step
        settings.timeIntegration.endTime = time
        settings.timeIntegration.numberOfSteps = n
        system.SolveDynamic(settings, solverType=getattr(KIND, method), updateInitialValues=True)

    def state() -> list:
        node = body["nodeNumber"]
        matrix = system.GetNodeOutput(node, exu.OutputVariableType.RotationMatrix)
        q = Rotation.from_matrix(np.reshape(matrix, (3, 3))).as_quat(scalar_first=True)
        return [*q, *system.GetNodeOutput(node, exu.OutputVariableType.AngularVelocityLocal)]

    return advance, state
