"""The figures of a trajectory, which show the motion against time or in space."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D

from figures.style import (
    FAINT,
    GREY,
    LINES,
    describe_run,
    draw_line,
    draw_sizes,
    has_wide_range,
    new_figure,
    set_degree_ticks,
    with_unit,
)
from figures.table import Table

TIME = "time t (s)"


def numbers(table: Table, column: str) -> np.ndarray:
    """A column as an array."""
    return table.rows[column].to_numpy(float)


def four_panels(table: Table, what: str) -> tuple[Figure, list[Axes]]:
    """A figure with four panels over the same time."""
    figure = new_figure(table, what, height=5.4)
    axes = figure.subplots(2, 2, sharex=True)
    for panel in axes[1]:
        panel.set_xlabel(TIME)
    for panel in axes.flat:
        panel.margins(x=0.01)
    return figure, list(axes.flat)


def draw_residuals(table: Table) -> Figure:
    """R1, R2, R3 and R4 against time (Figures 2 to 7 of the paper)."""
    figure, panels = four_panels(table, f"Residuals: {describe_run(table)}")
    t = numbers(table, "t")
    for name, axes in zip(("R1", "R2", "R3", "R4"), panels, strict=True):
        y = numbers(table, name)
        label = f"$R_{name[1]}$"
        if not np.any(y):
            draw_line(axes, t, y)
            axes.set_yticks([0])
            axes.text(0.5, 0.6, "zero throughout", transform=axes.transAxes, ha="center")
        elif has_wide_range(y):
            draw_sizes(axes, t, y)
            label = f"$|R_{name[1]}|$"
        else:
            axes.axhline(0, color=FAINT, linewidth=0.8)
            draw_line(axes, t, y)
        axes.set_ylabel(with_unit(label, table.units.get(name, "")))
    figure.align_ylabels()
    return figure


def draw_angles(table: Table) -> Figure:
    """Euler angles and height of the centre of mass against time (Figure 8)."""
    figure, panels = four_panels(table, "Euler angles and height of the centre of mass")
    t = numbers(table, "t")
    symbols = {"phi": r"precession $\phi$", "theta": r"inclination $\theta$", "psi": r"spin $\psi$"}
    for (name, symbol), axes in zip(symbols.items(), panels, strict=False):
        degrees = np.degrees(numbers(table, name))
        draw_line(axes, t, degrees)
        set_degree_ticks(axes, degrees)
        axes.set_ylabel(f"{symbol} (degrees)")
        if name == "theta":
            mark_extremes(axes, degrees, "°")
    height = numbers(table, "com_z")
    draw_line(panels[3], t, height)
    panels[3].set_ylabel("height above the pivot (m)")
    mark_extremes(panels[3], height, " m")
    figure.align_ylabels()
    return figure


def mark_extremes(axes: Axes, y: np.ndarray, unit: str) -> None:
    """Faint lines at the least and the largest value, with their numbers."""
    low, high = np.nanmin(y), np.nanmax(y)
    room = 0.16 * (high - low or 1)
    axes.set_ylim(low - room, high + room)
    decimals = 2 if unit == "°" else 5
    for value, side, shift in ((low, "top", -2), (high, "bottom", 2)):
        axes.axhline(value, color=FAINT, linewidth=0.8, zorder=0)
        axes.annotate(
            f"{value:.{decimals}f}{unit}".replace("-", "\N{MINUS SIGN}"),
            (0.99, value),
            xycoords=axes.get_yaxis_transform(),
            xytext=(0, shift),
            textcoords="offset points",
            ha="right",
            va=side,
            fontsize=9,
            color=GREY,
        )


def draw_forces(table: Table) -> Figure:
    """Support force and energies against time (Figure 9)."""
    figure, panels = four_panels(table, "Support force on the top, and its energy")
    t = numbers(table, "t")
    for name, axes in zip(("x", "y", "z"), panels, strict=False):
        axes.axhline(0, color=FAINT, linewidth=0.8)
        draw_line(axes, t, numbers(table, f"force_{name}"))
        axes.set_ylabel(f"$F_{name}$ (N)" + (", upward" if name == "z" else ""))
    for line, name in enumerate(("energy", "kinetic", "potential")):
        label = "total" if name == "energy" else name
        draw_line(panels[3], t, numbers(table, name), line, label=label)
    panels[3].set_ylabel("energy (J)")
    panels[3].legend(
        loc="lower right",
        bbox_to_anchor=(1.03, 1.0),
        ncols=3,
        handlelength=1.6,
        columnspacing=1.0,
        borderpad=0,
    )
    figure.align_ylabels()
    return figure


def draw_support(table: Table) -> Figure:
    """Support force in the plane of the axis, normal to it and upward, and its size."""
    figure, panels = four_panels(table, "Support force on the top, along and across its axis")
    t = numbers(table, "t")
    force = {name: numbers(table, f"force_{name}") for name in "rnz"}
    labels = {
        "r": "$F_r$ (N), outward",
        "n": "$F_n$ (N), along the nodes",
        "z": "$F_z$ (N), upward",
    }
    for (name, label), axes in zip(labels.items(), panels, strict=False):
        axes.axhline(0, color=FAINT, linewidth=0.8)
        draw_line(axes, t, force[name])
        axes.set_ylabel(label)
    draw_line(panels[3], t, np.sqrt(sum(part**2 for part in force.values())))
    panels[3].set_ylabel("magnitude of the force (N)")
    panels[3].set_ylim(bottom=0)
    figure.align_ylabels()
    return figure


def draw_path(table: Table) -> Figure:
    """Path of the centre of mass, in space and from above (Figure 11)."""
    figure = new_figure(table, "Path of the centre of mass", height=4.5)
    figure.get_layout_engine().set(wspace=0.14)
    x, y, z = (numbers(table, f"com_{name}") for name in "xyz")
    radius = float(np.nanmedian(np.sqrt(x**2 + y**2 + z**2)))
    room = min(1.1 * float(np.nanmax(np.hypot(x, y))), radius)
    if np.nanmin(z) < 0 < np.nanmax(z) or room == 0:
        room = radius
    space = figure.add_subplot(1, 2, 1, projection="3d")
    draw_sphere(space, radius, room, upper=np.nanmax(z) > 0)
    space.plot(x, y, z, **LINES[0])
    mark_ends(space, x, y, z)
    space.set(xlabel="x (m)", ylabel="y (m)")
    if room < radius:  # a cap may be too flat for an axis
        space.xaxis.labelpad = space.yaxis.labelpad = 9
        space.set_zticks([])
        space.set_title(f"in space, z from {np.nanmin(z):.4g} to {np.nanmax(z):.4g} m")
    else:
        space.set(zlabel="z (m)", title="in space")
    above = figure.add_subplot(1, 2, 2)
    around = np.linspace(0, 2 * np.pi, 181)
    above.plot(radius * np.cos(around), radius * np.sin(around), color=FAINT, linewidth=0.8)
    draw_line(above, x, y)
    above.plot(0, 0, "+", color=GREY)
    mark_ends(above, x, y)
    side = 1.04 * room
    above.set(xlim=(-side, side), ylim=(-side, side), aspect="equal")
    above.set(xlabel="x (m)", ylabel="y (m)")
    above.set_title("from above", loc="left")
    above.legend(
        loc="lower right", bbox_to_anchor=(1.03, 0.99), ncols=2, handletextpad=0.1, borderpad=0
    )
    return figure


def draw_sphere(axes: Axes3D, radius: float, room: float, upper: bool) -> None:
    """The sphere of the centre of mass or, if `room` is less than its radius, that cap of it."""
    down = np.linspace(0, np.arcsin(room / radius) if room < radius else np.pi, 49)
    around = np.linspace(0, 2 * np.pi, 73)
    height = radius * np.outer(np.cos(down), np.ones_like(around))
    axes.plot_wireframe(
        radius * np.outer(np.sin(down), np.cos(around)),
        radius * np.outer(np.sin(down), np.sin(around)),
        height if upper else -height,
        rstride=8,
        cstride=6,
        color=FAINT,
        linewidth=0.5,
    )
    axes.set(xlim=(-room, room), ylim=(-room, room))
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(3))
        axis.pane.set_visible(False)
    axes.grid(visible=False)


def mark_ends(axes: Axes, *path: np.ndarray) -> None:
    """Mark where the path begins and ends."""
    for place, marker, label in ((0, "o", "start"), (-1, "D", "end")):
        ends = [component[place : place + 1 or None] for component in path]
        axes.plot(*ends, marker, markersize=5, color=LINES[1]["color"], mec="white", label=label)


def draw_error(table: Table) -> Figure:
    """Orientation error against time, which the residuals do not show, and R4 below it."""
    has_energy = "R4" in table.rows and bool(table.rows["R4"].any())
    figure = new_figure(
        table, f"Orientation error: {describe_run(table)}", 5.0 if has_energy else 3.6
    )
    panels = figure.subplots(1 + has_energy, 1, sharex=True, squeeze=False)[:, 0]
    t = numbers(table, "t")
    for axes in panels:
        axes.margins(x=0.01)
    draw_sizes(panels[0], t, numbers(table, "orientation_error"))
    panels[0].set_ylabel("orientation error (rad)")
    if has_energy:
        draw_sizes(panels[1], t, numbers(table, "R4"))
        panels[1].set_ylabel(f"change of energy\n$|R_4|$ ({table.units.get('R4', 'J')})")
    panels[-1].set_xlabel(TIME)
    figure.align_ylabels()
    return figure
