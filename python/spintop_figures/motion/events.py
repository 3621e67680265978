"""The figures of the events of a trajectory: when they happen, and sections through the motion."""

import re

import numpy as np
from matplotlib.figure import Figure

from spintop_figures.kinds import figure
from spintop_figures.style.axes import MANY_POINTS, name_axis
from spintop_figures.style.look import LINES
from spintop_figures.style.numbers import localised, write, write_count
from spintop_figures.style.page import TIME, name_outer, panel_figure
from spintop_figures.tables.names import axis_of, column_of, name_of, sign_of
from spintop_figures.tables.table import Table

COLOUR = LINES[0]["color"]


@figure("events", "t", words="event", unless={"has no events": lambda table: len(table.rows)})
def draw_events(table: Table) -> Figure:
    """Instants of the events of a trajectory.

    The instants of the events, one row per kind; where there are many, how many per interval.
    """
    names = list(table.rows["event"].unique())
    height = 0.36 * len(names)
    figure, (axes,) = panel_figure(table, "Events of the motion", 1, height, above=1.5)
    times, labels = table.column("t"), []
    begin, end = min(0.0, times.min()), times.max()
    for place, name in enumerate(names):
        t = times[(table.rows["event"] == name).to_numpy()]
        label = f"{describe_event(name)} ({write_count(len(t))})"
        if len(t) > 80:  # more are counted in intervals
            counts, edges = np.histogram(t, 60, (times.min(), end))
            heights, width = -0.8 * counts / counts.max(), edges[1] - edges[0]
            style = {"align": "edge", "color": COLOUR, "linewidth": 0}
            axes.bar(edges[:-1], heights, np.diff(edges), place + 0.8 / 2, **style)
            label += f"\nper {write(width, 3)} s: up to {counts.max()}"
        else:
            axes.plot(t, np.full_like(t, place), "|", color=COLOUR, markersize=12, zorder=3)
        labels.append(label)
    axes.set_yticks(range(len(names)), labels=labels)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y")
    axes.spines["left"].set_visible(False)
    axes.set_xlim(begin - 0.01 * (end - begin), end + 0.01 * (end - begin))
    name_axis(axes.xaxis, *TIME)
    return figure


def describe_event(name: str) -> str:
    """An event in words: `theta_deg=90 rising` is \u03b8 = 90\u00b0, rising."""
    known = re.fullmatch(r"(\w+)=(\S+)((?: every turn)?) ?(rising|falling|)", name)
    if not known:
        return name_of(name)
    column, value, turns, side = known.groups()
    column, unit = column_of(column)
    unit = f" {unit['unit']}".replace(" deg", "\N{DEGREE SIGN}") if unit else ""
    words = f"{sign_of(column)} = {localised(value)}{unit}"
    return ", ".join(filter(None, (words, turns.strip(), side)))


def sections(table: Table) -> list[str]:
    """The kinds of events that happen 20 times, at different inclinations and nutation rates."""
    names = []
    plane = table.rows[["theta", "theta_rate"]]
    least = 1e-6 * plane.abs().max()  # events that hardly differ make no section
    for name, rows in plane.groupby(table.rows["event"], sort=False):
        if len(rows) >= 20 and (rows.max() - rows.min() > least).all():
            names.append(str(name))
    return names


@figure(
    "events",
    "theta theta_rate",
    words="event",
    unless={"has no event that happens 20 times, at inclinations and rates that differ": sections},
)
def draw_sections(table: Table) -> Figure:
    """Inclination and its rate at frequent events (Poincare sections)."""
    names = sections(table)
    title = "Inclination and nutation rate at events"
    figure, panels = panel_figure(table, title, len(names), 2.5, 4.0, 1.3)
    for name, axes in zip(names, panels, strict=True):
        rows = table.rows[table.rows["event"] == name]
        size = 2 if len(rows) > 200 else 4
        style = {"color": COLOUR, "markersize": size, "rasterized": len(rows) > MANY_POINTS}
        axes.plot(np.degrees(rows["theta"]), rows["theta_rate"], ".", **style)
        axes.set_title(f"{describe_event(name)} ({write_count(len(rows))})", parse_math=False)
    name_outer(panels, (axis_of("theta"), "degrees"), (axis_of("theta_rate"), "rad/s"))
    return figure
