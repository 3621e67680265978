"""The figures of the events of a trajectory: when they happen, and sections through the motion."""

import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spintop_figures.style.lines import MANY_POINTS
from spintop_figures.style.look import FAINT, LINES
from spintop_figures.style.numbers import true_minus, write, write_count
from spintop_figures.style.page import add_panels, is_lowest, new_figure, panel_rows
from spintop_figures.tables.names import axis_of, name_of, sign_of
from spintop_figures.tables.own_units import converted
from spintop_figures.tables.table import Table

LEAST_EVENTS = 20
"""Fewer events of a kind show no section."""

FLAT = 1e-6
"""Events whose inclination or nutation rate differs by less, of the largest, make no section."""

MANY_EVENTS, BARS = 80, 60
"""More events of a kind are counted in so many intervals."""

ROW = 0.8
"""Height of the highest bar, over that of a row."""

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
    """The instants of the events, one row per kind; where there are many, how many per interval."""
    names = list(table.rows["event"].unique())
    figure = new_figure(table, "Events of the motion", 1.5 + ROW_HEIGHT * len(names))
    axes = figure.add_subplot()
    times = table.rows["t"].to_numpy(float)
    labels = []
    for place, name in enumerate(names):
        t = times[(table.rows["event"] == name).to_numpy()]
        label = f"{describe_event(name)} ({write_count(len(t))})"
        if len(t) > MANY_EVENTS:
            width = draw_density(axes, t, place, (times.min(), times.max()))
            label += f"\nper {write(width, 3)} s: up to {count_most(t, times, width)}"
        else:
            style = {"color": LINES[0]["color"], "markersize": 12, "zorder": 3}
            axes.plot(t, np.full_like(t, place), "|", **style)
        labels.append(label)
    axes.set_yticks(range(len(names)), labels=labels)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines["left"].set_visible(False)
    begin, end = min(0.0, times.min()), times.max()
    axes.set_xlim(begin - 0.01 * (end - begin), end + 0.01 * (end - begin))
    axes.set_xlabel("time t (s)")
    return figure


def describe_event(name: str) -> str:
    """An event in words: `theta_deg=90 rising` is \u03b8 = 90\u00b0, rising."""
    known = re.fullmatch(r"(\w+)=(\S+)((?: every turn)?) ?(rising|falling|)", name)
    if not known:
        return name_of(name)
    column, value, turns, side = known.groups()
    unit = ""
    if found := converted(column):
        column, unit = found.column, f" {found.unit}".replace(" deg", "\N{DEGREE SIGN}")
    words = [
        f"{sign_of(column)} = {true_minus(value)}{unit}",
        *filter(None, (turns.strip(), side)),
    ]
    return ", ".join(words)


def draw_density(axes: Axes, t: np.ndarray, place: int, span: tuple[float, float]) -> float:
    """How many events there are in each interval, as a row of bars; the length of an interval."""
    counts, edges = np.histogram(t, BARS, span)
    axes.bar(
        edges[:-1],
        -ROW * counts / counts.max(),
        np.diff(edges),
        place + ROW / 2,
        align="edge",
        color=LINES[0]["color"],
        linewidth=0,
    )
    return float(edges[1] - edges[0])


def count_most(t: np.ndarray, times: np.ndarray, width: float) -> int:
    """The largest number of events in an interval."""
    return int(np.histogram(t, BARS, (times.min(), times.max()))[0].max())


def draw_sections(table: Table) -> Figure:
    """Inclination and its rate at the events of each kind that happens often."""
    names = sections(table)
    height = 1.3 + max(PANEL_HEIGHT * panel_rows(len(names)), LEAST_HEIGHT)
    figure = new_figure(table, "Inclination and nutation rate at events", height)
    panels = add_panels(figure, len(names))
    for name, axes in zip(names, panels, strict=True):
        rows = table.rows[table.rows["event"] == name]
        theta, rate = np.degrees(rows["theta"]), rows["theta_rate"]
        style = {"color": LINES[0]["color"], "markersize": 2 if len(rows) > 200 else 4}
        axes.plot(theta, rate, ".", rasterized=len(rows) > MANY_POINTS, **style)
        title = f"{describe_event(name)} ({write_count(len(rows))})"
        axes.set_title(title, loc="left", fontsize=9.5, parse_math=False)
        spot = axes.get_subplotspec()
        axes.tick_params(labelleft=spot.is_first_col(), labelbottom=is_lowest(axes))
        if spot.is_first_col():
            axes.set_ylabel(axis_of("theta_rate", "rad/s"))
        if is_lowest(axes):
            axes.set_xlabel(axis_of("theta", "deg"))
    return figure
