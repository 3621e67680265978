"""Mechanics that tests compare the program with: products of quaternions, Runge-Kutta steps."""

from collections.abc import Callable

import numpy as np


def rotation(p: np.ndarray) -> np.ndarray:
    """The matrix of v -> p v conj(p)."""
    w, x, y, z = p
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[a[0] * b[0] - a[1:] @ b[1:]], vector])


def runge_kutta(slope: Callable, start: np.ndarray, end: float, steps: int) -> np.ndarray:
    """The solution of y' = slope(t, y) at the end, by the classical method of order 4."""
    y, h = np.asarray(start, dtype=float), end / steps
    for n in range(steps):
        k1 = slope(n * h, y)
        k2 = slope((n + 0.5) * h, y + h / 2 * k1)
        k3 = slope((n + 0.5) * h, y + h / 2 * k2)
        k4 = slope((n + 1) * h, y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return y
