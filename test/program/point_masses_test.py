"""A top of point masses: the motion follows from them alone, without axes of inertia.

A. A. Deriglazov, Improved equations of the Lagrange top and examples of analytical solutions,
Particles 7, 2024, derives the motion from point masses under constraints, and says that with a
diagonal inertia tensor the potential energy of the literature has to be corrected. Here the points
move in space by p_i' = omega x p_i and L' = sum p_i x m_i g, with omega from L and the inertia of
the points where they are. The textbook's equations give the same motion.
"""

import numpy as np

from mechanics import runge_kutta

MASSES = np.array([0.3, 0.3, 0.3, 0.1])
POINTS = np.array([[0.4, 0, 0.5], [-0.2, 0.12**0.5, 0.5], [-0.2, -(0.12**0.5), 0.5], [0, 0, 1.1]])
THETA, PHI, PSI = 0.7, 0.4, -1.1
RATE, SPIN, END, STEPS = 0.8, 14.0, 1.0, 500
GRAVITY = np.array([0, 0, -9.81])


def attitude():
    """The rotation matrix of the start, which is no principal one."""
    (cf, ct, cp), (sf, st, sp) = np.cos([PHI, THETA, PSI]), np.sin([PHI, THETA, PSI])
    about_z = np.array([[cf, -sf, 0], [sf, cf, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]])
    about_axis = np.array([[cp, -sp, 0], [sp, cp, 0], [0, 0, 1]])
    return about_z @ about_x @ about_axis


def inertia(points):
    """The inertia tensor of the points about the pivot."""
    squares = (MASSES[:, np.newaxis] * points**2).sum()
    return squares * np.eye(3) - (MASSES[:, np.newaxis] * points).T @ points


def slope(_, state):
    """The velocities of the points, and the torque of their weights."""
    points = state[:12].reshape(4, 3)
    omega = np.linalg.solve(inertia(points), state[12:])
    return np.append(np.cross(omega, points), np.cross(MASSES @ points, GRAVITY))


def test_points_move_as_the_top_does(spin):
    """The path of each point is that of the exact solution."""
    turn = attitude()
    points = POINTS @ turn.T
    omega = RATE * np.array([0, 0, 1.0]) + SPIN * turn[:, 2]
    momentum = inertia(points) @ omega
    points = runge_kutta(slope, np.append(points, momentum), END, STEPS)[:12].reshape(4, 3)
    moments = np.diag(inertia(POINTS))
    assert np.allclose(inertia(POINTS), np.diag(moments), atol=1e-15)
    text = f"&top mass = 1  inertia = {moments[0]}, {moments[0]}, {moments[2]}  length = 0.56 /\n"
    text += f"&initial phi = {PHI}  theta = {THETA}  psi = {PSI}  phi_rate = {RATE}\n"
    text += f"  psi_rate = {SPIN} /\n&span t_end = {END}  samples = 2 /\n"
    text += "&output columns = 'q0', 'q1', 'q2', 'q3' /\n"
    q0, *v = spin(text).rows.iloc[-1]
    found = POINTS + 2 * q0 * np.cross(v, POINTS) + 2 * np.cross(v, np.cross(v, POINTS))
    assert np.abs(found - points).max() < 1e-6
