"""The figures of the events of a trajectory: when they happen, and sections through the motion."""

import numpy as np
from matplotlib.figure import Figure

from figures.style import LINES, MANY_POINTS, add_panels, new_figure
from figures.table import Table

LEAST_EVENTS = 20
"""Fewer events of a kind show no section."""

FLAT = 1e-6
"""Events whose inclination or nutation rate differs by less, of the largest, make no section."""

ROW_HEIGHT, PANEL_HEIGHT, LEAST_HEIGHT = 0.36, 2.5, 4.0
"""Of a kind of event, of a row of sections, and of all of them, in inches."""


def object_to_events(table: Table) -> str:
    """There may be no events."""
    return "has no events" if table.rows.empty else ""


def sections(table: Table) -> list[str]:
    """The kinds of events that happen often, at different inclinations and nutation rates."""
    names = []
    plane = table.rows[["theta", "theta_rate"]]
    least = FLAT * plane.abs().max()
    for name, rows in plane.groupby(table.rows["event"], sort=False):
        if len(rows) >= LEAST_EVENTS and (rows.max() - rows.min() > least).all():
            names.append(str(name))
    return names


def object_to_sections(table: Table) -> str:
    """A section takes many points that do not lie on a line by their definition."""
    if sections(table):
        return ""
    return f"has no event that happens {LEAST_EVENTS} times, at inclinations and rates that differ"


def draw_events(table: Table) -> Figure:
    """The instants of the events, one row per kind."""
    names = list(table.rows["event"].unique())
    figure = new_figure(table, "Events", 1.7 + ROW_HEIGHT * len(names))
    axes = figure.add_subplot()
    labels = []
    for place, name in enumerate(names):
        t = table.rows.loc[table.rows["event"] == name, "t"].to_numpy(float)
        style = {"color": LINES[place % len(LINES)]["color"], "markersize": 12}
        axes.plot(t, np.full_like(t, place), "|", rasterized=len(t) > MANY_POINTS, **style)
        labels.append(f"{name} ({len(t)})")
    axes.set_yticks(range(len(names)), labels=labels)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("time t (s)")
    return figure


def draw_sections(table: Table) -> Figure:
    """Inclination and its rate at the events of each kind that happens often."""
    names = sections(table)
    height = 1.3 + max(PANEL_HEIGHT * ((len(names) + 1) // 2), LEAST_HEIGHT)
    figure = new_figure(table, "Inclination and nutation rate at events", height)
    panels = add_panels(figure, len(names))
    for name, axes in zip(names, panels, strict=True):
        rows = table.rows[table.rows["event"] == name]
        theta, rate = np.degrees(rows["theta"]), rows["theta_rate"]
        style = {"color": LINES[0]["color"], "markersize": 2 if len(rows) > 200 else 4}
        axes.plot(theta, rate, ".", rasterized=len(rows) > MANY_POINTS, **style)
        axes.set_title(f"{name} ({len(rows)})", loc="left", fontsize=9.5, parse_math=False)
        spot = axes.get_subplotspec()
        axes.tick_params(labelleft=spot.is_first_col(), labelbottom=spot.is_last_row())
        if spot.is_first_col():
            axes.set_ylabel(r"nutation rate $\dot\theta$ (rad/s)")
        if spot.is_last_row():
            axes.set_xlabel(r"inclination $\theta$ (degrees)")
    return figure
