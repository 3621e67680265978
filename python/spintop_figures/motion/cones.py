"""The cones on which a body rolls: the angular velocity seen in the body, and seen in space."""

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from spintop_figures.motion.path import mark_ends
from spintop_figures.motion.trajectory import numbers
from spintop_figures.style.look import FAINT, GREY, LINES
from spintop_figures.style.page import new_figure
from spintop_figures.tables.table import Table

ZOOM = 0.9
"""The size of the axes in their panel, which leaves room for the labels."""

MOST_RAYS = 90
"""Lines of a cone from its apex."""


def in_space(table: Table) -> np.ndarray:
    """The angular velocity in space axes, by Rz(phi) Rx(theta) Rz(psi); components by rows."""
    x, y, z = (numbers(table, f"omega{i}") for i in (1, 2, 3))
    phi, theta, psi = (numbers(table, name) for name in ("phi", "theta", "psi"))
    x, y = x * np.cos(psi) - y * np.sin(psi), x * np.sin(psi) + y * np.cos(psi)
    y, z = y * np.cos(theta) - z * np.sin(theta), y * np.sin(theta) + z * np.cos(theta)
    return np.array([x * np.cos(phi) - y * np.sin(phi), x * np.sin(phi) + y * np.cos(phi), z])


def draw_cones(table: Table) -> Figure:
    """The tip of the angular velocity in the body (polhode) and in space (herpolhode)."""
    figure = new_figure(
        table, "Angular velocity in the body (polhode) and in space (herpolhode)", 4.2
    )
    figure.get_layout_engine().set(wspace=0.02)
    body = np.array([numbers(table, f"omega{i}") for i in (1, 2, 3)])
    for place, (omega, title, names) in enumerate(
        ((body, "in the body", "123"), (in_space(table), "in space", "xyz"))
    ):
        axes = figure.add_subplot(1, 2, place + 1, projection="3d")
        draw_cone(axes, omega)
        labels = [rf"$\omega_{name}$ (rad/s)" for name in names]
        axes.set(xlabel=labels[0], ylabel=labels[1], zlabel=labels[2])
        axes.set_title(title, y=0.97)
    axes.legend(loc="upper right", bbox_to_anchor=(1.12, 1.02), handletextpad=0.1)
    return figure


def draw_cone(axes: Axes3D, omega: np.ndarray) -> None:
    """A curve of angular velocities with lines to it from the apex of its cone."""
    rays = omega[:, np.linspace(0, omega.shape[1] - 1, MOST_RAYS).astype(int)]
    for ray in rays.T:
        axes.plot(*np.transpose([np.zeros(3), ray]), color=FAINT, linewidth=0.5)
    axes.plot(*omega, **LINES[0])
    axes.plot([0], [0], [0], "+", color=GREY)
    mark_ends(axes, *omega)
    low, high = np.minimum(np.nanmin(omega, axis=1), 0), np.maximum(np.nanmax(omega, axis=1), 0)
    side = (high - low).max() * 1.05 / 2 or 1.0
    for axis, middle in zip("xyz", (low + high) / 2, strict=True):
        getattr(axes, f"set_{axis}lim")(middle - side, middle + side)
        getattr(axes, f"{axis}axis").pane.set_visible(False)
    axes.set_aspect("equal")
    axes.set_box_aspect(None, zoom=ZOOM)
    axes.patch.set_visible(False)  # it would hide labels of the panel beside it
    axes.grid(visible=False)
    axes.locator_params(nbins=4)
