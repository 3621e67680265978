"""The motion of a symmetric top as that of its inclination alone, in an effective potential."""

from typing import NamedTuple

import numpy as np

from spintop_figures.tables.table import Table

COLUMNS = ("theta", "theta_rate", "phi_rate", "psi_rate", "kinetic", "potential")
"""What the reduced motion is found from."""

SAME = 1e-6
"""Deviations from the motion of a symmetric top, over the size, that an integrator may make."""

STEADY = 1e-10
"""A smaller relative change of the kinetic energy does not determine the moments of inertia."""

HUGE, LEAST_ROWS = 1e100, 4
"""Numbers of this size are of a run that is lost; what is fitted to fewer rows is not checked."""

ROUNDING = 1e-12
"""Momenta that differ by less, over their size, are equal."""


class Reduced(NamedTuple):
    """I1 theta'^2/2 + V(theta) = energy, with V(theta) = (lz - l3 u)^2/(2 I1 (1 - u^2)) + m g l u.

    u is cos(theta). `energy` is that of the start less the constant part of the spin, l3^2/(2 I3).
    """

    inertia: float
    weight: float
    """m g l, J."""
    lz: float
    l3: float
    energy: float

    def potential(self, theta: np.ndarray) -> np.ndarray:
        """V at inclinations, J; infinite at a pole that the motion cannot reach."""
        half = np.asarray(theta, float) / 2
        with np.errstate(divide="ignore", invalid="ignore"):
            # (lz - l3 u)/sin(theta), as two terms of which each is singular at one pole
            turning = (self.lz - self.l3) / 2 / np.tan(half) + (self.lz + self.l3) / 2 * np.tan(
                half
            )
            turning = np.where((half == 0) & (self.lz == self.l3), 0.0, turning)
        return turning**2 / (2 * self.inertia) + self.weight * np.cos(2 * half)

    def turning_points(self) -> tuple[float, float]:
        """The least and the largest inclination, rad.

        They are roots of (1 - u^2) (alpha - beta u) - (b - a u)^2 in [-1, 1]; the third root lies
        beyond the pole that the weight pulls away from.
        """
        alpha, beta = 2 * self.energy / self.inertia, 2 * self.weight / self.inertia
        a, b = self.l3 / self.inertia, self.lz / self.inertia
        cubic = [beta, -(alpha + a * a), 2 * a * b - beta, alpha - b * b]
        roots = np.sort(np.roots(cubic).real)
        between = roots[1:] if beta < 0 else roots[:2]
        least, largest = np.arccos(np.clip(between, -1, 1))[::-1]
        return float(least), float(largest)

    def resting_point(self) -> float:
        """The inclination at which V is least: that of the steady precession, rad.

        It lies between the turning points.
        """
        theta = np.linspace(*self.turning_points(), 20_001)
        return float(theta[np.argmin(self.potential(theta))])

    def separatrix(self) -> float | None:
        """The energy of the top upright at rest, where it is unstable there; else none.

        Only with equal momenta does a motion reach the upright, the pole that the weight pulls
        away from; below the spin at which the top sleeps, V has its local maximum there.
        """
        upright = np.copysign(1.0, self.weight)
        height = abs(self.weight)
        if self.lz != upright * self.l3 or self.l3**2 >= 4 * height * self.inertia:
            return None
        return height


def find_reduced(table: Table) -> Reduced | str:
    """The reduced motion of a trajectory, or why it is not that of an undamped symmetric top.

    The table's own columns tell the body, whatever shape it was made of: the kinetic energy is
    linear in I1, the potential one in m g l, and omega3 is constant.
    """
    rows = table.rows[list(COLUMNS)].astype(float)
    rows = rows[(rows.abs() < HUGE).all(axis=1)]
    if len(rows) < LEAST_ROWS:
        return f"has fewer than {LEAST_ROWS} rows to find the moments of inertia from"
    cosine = np.cos(rows["theta"].to_numpy())
    omega3 = (rows["phi_rate"] * cosine + rows["psi_rate"]).to_numpy()
    turning = rows["phi_rate"] * np.sin(rows["theta"])
    transverse = ((rows["theta_rate"] ** 2 + turning**2) / 2).to_numpy()
    kinetic, potential = rows["kinetic"].to_numpy(), rows["potential"].to_numpy()
    largest = kinetic.max(initial=0.0)
    if not np.ptp(kinetic) > STEADY * largest:
        return "is too steady to determine the moments of inertia"
    inertia, spin_energy = np.polyfit(transverse, kinetic, 1)
    weight = float(potential @ cosine / (cosine @ cosine))
    deviations = [
        np.abs(kinetic - inertia * transverse - spin_energy).max() / largest,
        np.abs(potential - weight * cosine).max() / max(np.abs(potential).max(), 1e-300),
        np.ptp(omega3) ** 2 / max(np.max(omega3**2), transverse.max()),
    ]
    if not np.max(deviations) <= SAME:
        return "is no motion of an undamped symmetric top about its axis, body z"
    spin = float(omega3.mean())
    l3 = 2 * spin_energy / spin if spin**2 > ROUNDING * transverse.max() else 0.0
    lz = inertia * turning.iloc[0] * np.sin(rows["theta"].iloc[0]) + l3 * cosine[0]
    if abs(abs(lz) - abs(l3)) <= ROUNDING * abs(l3):
        lz = float(np.copysign(l3, lz))
    energy = kinetic[0] - spin_energy + potential[0]
    return Reduced(float(inertia), weight, float(lz), float(l3), float(energy))


def object_to_reduced(table: Table) -> str:
    """Only a symmetric top moves in an effective potential."""
    reduced = find_reduced(table)
    return reduced if isinstance(reduced, str) else ""
