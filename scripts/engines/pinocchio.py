"""Pinocchio: its forward dynamics of a spherical joint (aba); the methods are written here.

It has no integrator of its own. `Euler` is the semi-implicit step of its examples, and `RK4` the
classical method for the quaternion, which is normalised after a step. The loop is in Python.
"""

import numpy as np
import pinocchio as pin

METHODS = ("Euler", "RK4")


def prepare(motion: dict, method: str, step: float) -> tuple:
    """A body on a spherical joint; a free one on that at its centre of mass."""
    model = pin.Model()
    model.gravity.linear = np.array([0, 0, -motion["gravity"]])
    joint = model.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), "pivot")
    inertia = pin.Inertia(motion["mass"], np.array(motion["arm"]), np.diag(motion["inertia"]))
    model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    data, torque = model.createData(), np.zeros(3)
    q, v = np.roll(motion["quaternion"], -1), np.array(motion["omega"])

    def rates(q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y, z, w = q
        turn = np.array([[w, -z, y], [z, w, -x], [-y, x, w], [-x, -y, -z]]) @ v / 2
        return turn, pin.aba(model, data, q / np.linalg.norm(q), v, torque)

    def advance(n: int) -> None:
        nonlocal q, v
        for _ in range(n):
            if method == "Euler":
                v = v + step * pin.aba(model, data, q, v, torque)
                q = pin.integrate(model, q, step * v)
                continue
            p1, a1 = rates(q, v)
            p2, a2 = rates(q + step / 2 * p1, v + step / 2 * a1)
            p3, a3 = rates(q + step / 2 * p2, v + step / 2 * a2)
            p4, a4 = rates(q + step * p3, v + step * a3)
            q = pin.normalize(model, q + step / 6 * (p1 + 2 * (p2 + p3) + p4))
            v = v + step / 6 * (a1 + 2 * (a2 + a3) + a4)

    return advance, lambda: [*np.roll(q, 1), *v]
