"""A heavy top by the explicit midpoint rule with three step sizes, compared with the reference."""

import numpy as np

from check import check, order, read

data, columns = read("loop")
body, times = data["body"], columns["t"]
inertia, centre = np.array(body["inertia"]), np.array(body["centre_of_mass"])
weight = body["mass"] * body["gravity"]


def rates(state):
    """The derivatives of quaternion (scalar first, body to space) and omega (body axes)."""
    (w, x, y, z), omega = state[:4], state[4:]
    up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z])
    torque = np.cross(inertia @ omega, omega) + np.cross(weight * up, centre)
    a, b, c = omega / 2
    turning = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c]
    turning.append(w * c + x * b - y * a)
    return np.concatenate([turning, np.linalg.solve(inertia, torque)])


def trajectory(steps):
    """The states at the times of the reference, with so many steps between two of them."""
    states = [np.array(data["start"]["quaternion"] + data["start"]["omega"])]
    h = (times[1] - times[0]) / steps
    for _ in times[1:]:
        state = states[-1]
        for _ in range(steps):
            state = state + h * rates(state + h / 2 * rates(state))
        states.append(state)
    return np.array(states)


errors = []
for steps in (50, 100, 200):
    states = trajectory(steps)
    report = check(times, states[:, :4], states[:, 4:], motion="loop")
    errors.append(report["attitude_error"])
print(report)
print(f"order of convergence {order([1 / 50, 1 / 100, 1 / 200], errors):.2f}")
