"""Work-precision studies: errors against costs, orders, the cheapest method and the choice."""

import dataclasses
import itertools
from collections.abc import Collection, Iterable
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from spintop_figures.kinds import figure
from spintop_figures.methods import known
from spintop_figures.style import numbers
from spintop_figures.style.axes import few_ticks, letters_of, name_axis, name_rows, wrapped
from spintop_figures.style.look import FAINT, GREY, GROUND, INK, by_width, is_slide, tint
from spintop_figures.style.page import head, is_lowest, legend_below, panel_figure
from spintop_figures.sweeps import maps
from spintop_figures.sweeps.maps import Grid
from spintop_figures.sweeps.quantities import tell_failed
from spintop_figures.tables.names import ended_well, name_of
from spintop_figures.tables.table import Table

EXACT = "exact"
"""The method that takes no steps."""

TARGET, GOAL = 1e-9, "10\u207b\u2079 rad"
"""The error by whose cost methods are compared, rad, and how it is written."""


class Curve(NamedTuple):
    """A method under a formulation: its label, and its rows from the coarsest to the finest."""

    method: str
    formulation: str
    label: str
    rows: pd.DataFrame

    def style(self) -> dict[str, object]:
        """How it is drawn, in every figure alike; the formulation fills markers if it is told."""
        return known.style_of(self.method, self.formulation if self.label != self.method else "")


def fineness(setting: str) -> float:
    """How fine a setting is: a number of steps, or one over a tolerance; 0 if it is neither."""
    word, _, value = setting.partition(" ")
    if word == "steps":
        return float(value)
    return 1 / float(value) if word == "tolerance" else 0.0


def problems_of(table: Table) -> list[str]:
    """The problems, in the order in which the table has them first."""
    return list(table.rows["problem"].unique())


def curves_of(rows: pd.DataFrame, columns: Iterable[str]) -> list[Curve]:
    """The curves of a problem, by family, of rows that went well and have these columns.

    A label names the formulation only where a method has several.
    """
    sound = ended_well(rows) & np.isfinite(rows[[*columns]].astype(float)).all(axis=1)
    several = rows.groupby("method")["formulation"].nunique() > 1
    curves = []
    for (method, formulation), part in rows[sound].groupby(["method", "formulation"], sort=False):
        label = f"{name_of(method)}, {name_of(formulation)}" if several[method] else name_of(method)
        order = part["setting"].map(fineness).sort_values(kind="stable").index
        curves.append(Curve(method, formulation, label, part.loc[order]))
    return sorted(curves, key=lambda curve: (*known.rank_of(curve.method), curve.label))


def time_to(curve: Curve, target: float = TARGET, cost: str = "time_s") -> float:
    """The least cost at which a method reaches an error, nan if it does not.

    Between two settings the logarithms of cost and error are on a line.
    """
    with np.errstate(divide="ignore"):
        time, error = (np.log(curve.rows[name].to_numpy(float)) for name in (cost, "error_max"))
    goal = np.log(target)
    times = [time[0]] if error[0] <= goal else []
    for (t0, e0), (t1, e1) in itertools.pairwise(zip(time, error, strict=True)):
        if e1 <= goal < e0:
            share = 1.0 if np.isneginf(e1) else (goal - e0) / (e1 - e0)
            times.append(t0 + share * (t1 - t0))
    return float(np.exp(min(times))) if times else float("nan")


def best_of_families(rows: pd.DataFrame, cost: str) -> list[Curve]:
    """The curve of each family that reaches the target at the least cost, in their order.

    Of a family that does not reach it, that with the least error. The exact motion is of none.
    """

    def merit(curve: Curve) -> tuple[bool, float]:
        reached = time_to(curve, cost=cost)
        missed = np.isnan(reached)
        return missed, curve.rows["error_max"].min() if missed else reached

    curves = [each for each in curves_of(rows, (cost, "error_max")) if each.method != EXACT]
    families = itertools.groupby(curves, key=lambda curve: known.known(curve.method).family)
    return [min(members, key=merit) for _, members in families]


PRECISION = {"kind": "work_precision", "words": "problem method formulation setting status"}
"""What figures of a work-precision study ask."""

LEAST_ERROR, MOST_ERROR = 1e-16, 4.0
"""Smaller errors are drawn at the first, rad; no turn is larger than the second."""

MOST_PROBLEMS = 6
"""Panels that fit a page."""

FAN = 0.2, 0.3
"""Width and height of the fan of orders, over those of the panel."""

NOTE = f"in colour: the cheapest of each family at an error of {GOAL}; grey: all other methods"
FLOOR = "rounding of the data: no method can be better"
"""What the inherent error is."""

ERROR = "largest error of the attitude", "rad"


def draw_precision_curves(
    axes: Axes, rows: pd.DataFrame, x: str, strong: Collection[str] | None = None
) -> None:
    """The curves of a problem on log axes: the error of each method over its cost `x`.

    `rows` have the columns of a work-precision table. The exact motion, which has no settings, is
    a point with its name; errors below what rounding of the data does lie in a grey band. If some
    curves are strong, the others are grey.
    """
    axes.set(xscale="log", yscale="log")
    for curve in curves_of(rows, (x, "error_max")):
        cost, error = (curve.rows[name].to_numpy(float) for name in (x, "error_max"))
        error = np.maximum(error, LEAST_ERROR)
        style = curve.style()
        if strong is not None:
            style |= {"linewidth": 1.6, "zorder": 3}
            if not known.known(curve.method).is_own:
                style |= {"linestyle": "-", "color": known.known(curve.method).look.colour}
            others = {"color": FAINT, "linewidth": 0.9, "zorder": 1}
            style = style if curve.label in strong else others
        if curve.method != EXACT:
            axes.plot(cost, error, **style, label=curve.label)
        elif cost[0] > 0:  # a cost that a log axis can show
            axes.plot(cost, error, **known.style_of(EXACT) | {"linestyle": "", "markersize": 8})
            place = {"va": by_width("top", "bottom"), "textcoords": "offset points"}
            words = "exact solution", (cost[0], error[0]), (6, by_width(-1, 1))
            axes.annotate(*words, **place, fontsize="small")
    if "inherent_error" in rows and np.isfinite(floor := rows["inherent_error"].max()):
        axes.axhspan(1e-30, max(floor, LEAST_ERROR), color=FAINT, linewidth=0, zorder=0)
        style = {"fontsize": "small", "va": "bottom", "ha": "right", "zorder": 5}
        style["path_effects"] = [withStroke(linewidth=3, foreground=FAINT)]
        words = wrapped(FLOOR, by_width(24 if is_slide() else 46, 16))
        axes.annotate(words, (0.99, 0.015), xycoords="axes fraction", **style)
    cost, error = (rows[name].to_numpy(float) for name in (x, "error_max"))
    shown = ended_well(rows).to_numpy() & (cost > 0) & np.isfinite(error)
    if not shown.any():
        return
    # with a little room; a method that is lost is not shown
    axes.set_xlim(cost[shown].min() / 2, cost[shown].max() * 2)
    least = max(error[shown].min(), LEAST_ERROR)
    axes.set_ylim(least / 15, min(error[shown].max() * 5, 2 * MOST_ERROR))
    few_ticks(axes.xaxis, 9)
    few_ticks(axes.yaxis, 9)
    axes.grid(alpha=0.4)


def object_to_precision(table: Table) -> str:
    """A method has to be there that takes steps, and not too many problems for panels."""
    if "program" in table.rows:
        return "compares programs"
    count = len(problems_of(table))
    if count > MOST_PROBLEMS:
        return f"has {count} problems, more than fit ({MOST_PROBLEMS})"
    return "" if stepping(table.rows).any() else "has no method that went well and takes steps"


def stepping(rows: pd.DataFrame) -> pd.Series:
    """Which rows are of methods that take steps, and went well."""
    return ended_well(rows) & (rows["method"] != EXACT)


def problem_panels(
    table: Table, title: str, rows: pd.DataFrame, above: float = 1.0, has_foot: bool = False
) -> tuple[Figure, dict[str, Axes]]:
    """A figure with a panel a problem, one below the other."""
    problems = list(rows["problem"].unique())
    shape = {"share": "", "has_foot": has_foot, "across": 1}
    figure, panels = panel_figure(table, title, len(problems), 3.4, 0, above, **shape)
    if len(problems) > 1:
        for problem, axes in zip(problems, panels, strict=True):
            head(axes, name_of(problem))
    return figure, dict(zip(problems, panels, strict=True))


def draw_over(
    table: Table, cost: str, less: str, words: str, unit: str
) -> tuple[Figure, dict[str, Axes]]:
    """Error against a cost, one panel per problem: the best of each family, the others grey."""
    title = f"Error against {words.partition(' (')[0]}{tell_lead(table, cost, less)}"
    figure, panels = problem_panels(table, title, table.rows, by_width(1.6, 2.1), has_foot=True)
    named: dict[str, tuple[tuple, Artist]] = {}
    for problem, axes in panels.items():
        rows = table.rows[table.rows["problem"] == problem]
        own = [
            each for each in curves_of(rows, (cost, "error_max")) if known.known(each.method).is_own
        ]
        named_ones = [*best_of_families(rows, cost), *own]
        best = {curve.label: known.rank_of(curve.method) for curve in named_ones}
        draw_precision_curves(axes, rows, cost, best)
        lines = {line.get_label(): line for line in axes.lines}
        named |= {label: (rank, lines[label]) for label, rank in best.items()}
        name_axis(axes.yaxis, *ERROR)
        name_axis(axes.xaxis, words if is_lowest(axes) else "", unit if is_lowest(axes) else "")
    handles = [line for _, line in sorted(named.values(), key=lambda pair: pair[0])]
    legend_below(list(panels.values()), handles, by_width(4, 2), NOTE)
    return figure, panels


def tell_lead(table: Table, cost: str, less: str) -> str:
    """Which family needs the least for the goal on a single problem, and how much less it is."""
    if len(problems_of(table)) > 1:
        return ""
    costs = [(time_to(curve, cost=cost), curve) for curve in best_of_families(table.rows, cost)]
    reached = sorted(((x, c.label) for x, c in costs if np.isfinite(x)), key=lambda pair: pair[0])
    if len(reached) < 2 or reached[1][0] < 1.05 * reached[0][0]:  # no lead worth a word
        return ""
    (least, first), (more, second) = reached[:2]
    ratio = more / least
    told = numbers.write(ratio, 2) if ratio < 100 else numbers.write_count(ratio)
    return f": {first} {less.format(ratio=told, other=second)} at {GOAL}"


@figure(needs="error_max time_s", objection=object_to_precision, **PRECISION)
def draw_precision_time(table: Table) -> Figure:
    """Work-precision diagram: error against time, one panel per problem."""
    less = "is {ratio} times as fast as {other}"
    return draw_over(table, "time_s", less, "computing time", "s")[0]


@figure(needs="error_max evaluations", objection=object_to_precision, **PRECISION)
def draw_precision_work(table: Table) -> Figure:
    """Work-precision diagram: error against evaluations, one panel per problem."""
    less = "takes {ratio} times fewer than {other}"
    words = "function evaluations (a Taylor series of order p counts as p)"
    figure, panels = draw_over(table, "evaluations", less, words, "")
    for problem, rows in table.rows.groupby("problem", sort=False):
        methods = rows.loc[stepping(rows) & rows["setting"].str.startswith("steps "), "method"]
        orders = {order for name in methods.unique() if (order := order_in(table, name))}
        draw_slopes(panels[problem], sorted(orders))
    return figure


def draw_slopes(axes: Axes, orders: list[int]) -> None:
    """A fan at the lower left, above the band of rounding, whose slopes are these orders."""
    if not orders:
        return
    (left, right), (low, high) = (np.log10(limits) for limits in (axes.get_xlim(), axes.get_ylim()))
    floor = max((np.log10(patch.get_corners()[:, 1].max()) for patch in axes.patches), default=low)
    ratio = (right - left) / (high - low)
    wide, tall = np.multiply(FAN, 1.4 if is_slide() else 1.0)
    x, y = 0.03, (max(floor, low) - low) / (high - low) + 0.06 + tall
    style = {"fontsize": "small", "color": GREY}
    for order in orders:
        run = 1 / np.hypot(1 / wide, order * ratio / tall)
        across, up = np.array([x, x + run]), np.array([y, y - order * ratio * run])
        line = 10 ** (left + across * (right - left)), 10 ** (low + up * (high - low))
        axes.plot(*line, color=GREY, linewidth=0.9, zorder=1)
        end = line[0][1], line[1][1]
        axes.annotate(f"{order}", end, (1, 2), textcoords="offset points", va="top", **style)
    axes.text(x, y + 0.01, "order", transform=axes.transAxes, va="bottom", **style)


STEP = "step"
"""The column with the step size over the time span."""

ALIKE = 0.1
"""Slopes that differ by less, over their size, are those of a power: the steps are small enough
for the order to show, and the errors are not of rounding yet."""


def equal_steps(table: Table) -> pd.DataFrame:
    """The rows with a fixed step size, with the step size over the time span."""
    rows = table.rows[table.rows["setting"].str.startswith("steps ")].copy()
    rows[STEP] = 1 / rows["setting"].str.split().str[1].astype(float)
    return rows


def object_to_orders(table: Table) -> str:
    """A method needs rows with several fixed step sizes."""
    if objection := object_to_precision(table):
        return objection
    curves = curves_of(equal_steps(table), (STEP, "error_max"))
    several = any(len(curve.rows) > 1 for curve in curves)
    return "" if several else "has no method with several fixed step sizes"


def measured_order(rows: pd.DataFrame) -> float:
    """The slope of the logarithm of the error over that of the step; nan if it cannot be told.

    It is that of the finest three steps over which it hardly changes; of rows with one step
    the first counts.
    """
    rows = rows.drop_duplicates(STEP)
    error, step = (np.log(rows[name].to_numpy(float)) for name in ("error_max", STEP))
    slopes = np.diff(error) / np.diff(step)
    for one, other in itertools.pairwise(slopes[::-1]):
        # errors of rounding fall by less
        if min(one, other) > 0.5 and abs(one - other) < ALIKE * max(one, other):
            return float((one + other) / 2)
    return float("nan")


def order_in(table: Table, method: str) -> int | None:
    """The order of a method: of the registry, or that which the file of a user's table declares."""
    told = table.header.get(method.replace(":", " ").lower(), "").removeprefix("order ")
    return known.known(method).order or (int(told) if told.isdigit() else None)


def with_order(curve: Curve, table: Table) -> str:
    """The label of a curve with its measured order and, after a slash, that of the method."""
    order = measured_order(curve.rows)
    measured = numbers.write_fixed(order, 2) if np.isfinite(order) else numbers.DASH
    return f"{curve.label}: {measured} / {order_in(table, curve.method) or numbers.DASH}"


@figure(needs="error_max", objection=object_to_orders, **PRECISION)
def draw_orders(table: Table) -> Figure:
    """Error against step size of the fixed-step methods, with measured orders."""
    rows = equal_steps(table)
    title = "Convergence of the fixed-step methods, with measured / theoretical order"
    figure, panels = problem_panels(table, title, rows, by_width(1.0, 1.4))
    words = "step size over the time span"
    for problem, axes in panels.items():
        part = rows[rows["problem"] == problem]
        draw_precision_curves(axes, part, STEP)
        curves = curves_of(part, (STEP, "error_max"))
        curves.sort(key=lambda curve: -curve.rows["error_max"].iloc[0])  # as they end at the right
        labels = {curve.label: with_order(curve, table) for curve in curves}
        lines = {line.get_label(): line for line in axes.lines}
        inks = [known.ink_of(known.known(curve.method).look) for curve in curves]
        place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.02), "labelcolor": inks}
        axes.legend(map(lines.get, labels), labels.values(), **place)
        name_axis(axes.yaxis, *ERROR)
        if any(numbers.DASH in label for label in labels.values()) and "\n" not in words:
            words += f"\n{numbers.DASH}: no order is seen, for rounding or for too large steps"
        name_axis(axes.xaxis, "")
    name_axis(axes.xaxis, words, letters=by_width(0, 22))
    return figure


NONE = "none"
"""In place of a method where none reaches the error."""


def table_of_problems(table: Table) -> Table:
    """The study as the table of a sweep: per problem the cheapest method and its time."""
    axes, rows = [name for name in table.rows if "." in name], []  # swept ones have a point
    for number, problem in enumerate(problems_of(table), start=1):
        part = table.rows[table.rows["problem"] == problem]
        curves = [c for c in curves_of(part, ("time_s", "error_max")) if c.method != EXACT]
        times = [(time_to(curve), curve.label) for curve in curves]
        good = sorted((time, label) for time, label in times if np.isfinite(time))
        (time, method), (later, other) = [*good, (np.nan, NONE), (np.nan, NONE)][:2]
        status = "ok" if np.isfinite(time) else "not reached"
        rows.append([number, *part[axes].iloc[0], status, time, method, later / time, other])
    columns = ["case", *axes, "status", "time_s", "method", "ratio", "next"]
    return dataclasses.replace(table, rows=pd.DataFrame(rows, columns=columns))


def object_to_tolerance_map(table: Table) -> str:
    """The maps are over two swept parameters, all of whose values are combined."""
    if sum("." in name for name in table.rows) != 2:
        return "is no study over two parameters"
    problems = table_of_problems(table)
    reached = ended_well(problems.rows).any()
    reason = "" if reached else f"has no method that reaches an error of {GOAL}"
    return maps.object_to_grid(problems) or reason


@figure(needs="error_max time_s", objection=object_to_tolerance_map, **PRECISION)
def draw_tolerance_map(table: Table) -> Figure:
    """The cheapest method for a given error, over two swept parameters.

    The cheapest method and the next one for the target as colours, and numbers in the cells.
    """
    problems = table_of_problems(table)
    grid = maps.make_grid(problems)
    failed = ~ended_well(problems.rows).to_numpy()
    title = f"The cheapest method for an error of {GOAL} in attitude{tell_failed(problems)}"
    figure, panels = panel_figure(table, title, 2, 2.9, above=0.9, across=1)
    colours = colours_of_methods(problems.rows)
    times, ratios = problems.column("time_s"), problems.column("ratio")
    unit, factor = unit_of(times)
    shown = (
        ("method", factor * times, f"the cheapest method, and its time in {unit}"),
        ("next", ratios, "the next method, and how many times longer it takes"),
    )
    for (method, values, heading), axes in zip(shown, panels, strict=True):
        head(axes, heading)
        there = {name: c for name, c in colours.items() if (problems.rows[method] == name).any()}
        look = {"edgecolor": GROUND, "linewidth": 0.5, "rasterized": False}
        maps.draw_classes(axes, grid, problems.rows[method], there, **look)
        maps.cross(axes, grid, failed)
        write_numbers(axes, grid, values)
    maps.label_axes(problems, grid, panels)
    return figure


def unit_of(seconds: np.ndarray) -> tuple[str, float]:
    """The unit that suits times, and the factor to it: that in which the median is above one."""
    units, median = (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9)), np.nanmedian(seconds)
    return next((pair for pair in units if median * pair[1] >= 1), units[-1])


def colours_of_methods(rows: pd.DataFrame) -> dict[str, tuple[float, ...]]:
    """A pale colour for each method: that of its family, paler for further members."""
    counts = pd.concat([rows["method"], rows["next"]]).value_counts()
    own = {name_of(method): method for method in known.known_methods()}
    members: dict[str, int] = {}
    colours = {}
    for label in counts.index.drop(NONE, errors="ignore"):
        name = label.partition(", ")[0]
        method = known.known(own.get(name, name))
        pale = 1 - 0.38 * 0.55 ** members.get(method.family, 0)
        members[method.family] = members.get(method.family, 0) + 1
        colours[label] = tint(method.look.colour, pale)
    return colours


def write_numbers(axes: Axes, grid: Grid, values: np.ndarray) -> None:
    """The number of each cell in it, if the cells are large enough."""
    texts = [tell(value) for value in values]
    across, up = (0.6 * letters_of(axes, side) for side in "xy")  # a line is as high as two letters
    if grid.x.size * max(map(len, texts)) > across or 2 * grid.y.size > up:
        return
    column, line = np.divmod(grid.place, grid.y.size)
    style = {"ha": "center", "va": "center_baseline", "fontsize": "small", "in_layout": False}
    for x, y, text in zip(grid.x[column], grid.y[line], texts, strict=True):
        axes.text(x, y, text, **style)


def tell(value: float) -> str:
    """Two digits of a number; empty if there is none."""
    return numbers.localised(f"{value:.{0 if value >= 10 else 1}f}") if np.isfinite(value) else ""


TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
"""The errors for which methods are compared, rad, as in the summary of the program."""

NEAR = 2.0
"""A choice that takes no more than so many times as long is near the cheapest."""


class Choice(NamedTuple):
    """The choice on a problem for a target: its time over the least, and who has the least.

    The ratio is infinite where the choice is not accurate enough.
    """

    target: float
    ratio: float
    cheapest: str


def choices_of(table: Table) -> list[Choice]:
    """The comparisons of the automatic choice with the cheapest method."""
    found = []
    for _, rows in table.rows.groupby("problem", sort=False):
        sound = rows[ended_well(rows)]
        for target in TARGETS if (rows["auto"] == "yes").any() else ():
            good = sound[sound["orientation_error"] <= target].sort_values("time_s", kind="stable")
            if len(good) and (least := good["time_s"].iloc[0]) > 0:
                own = good.loc[good["auto"] == "yes", "time_s"].min() / least
                ratio = float(np.nan_to_num(own, nan=np.inf))
                found.append(Choice(target, ratio, str(good["method"].iloc[0])))
    return found


@figure(
    PRECISION["kind"],
    "orientation_error time_s",
    words=f"{PRECISION['words']} auto",
    unless={
        "has no row of the automatic choice": lambda table: (table.rows["auto"] == "yes").any(),
        "has fewer than 5 problems to judge a choice by": lambda table: len(problems_of(table)) > 4,
        "has no method that is accurate enough": choices_of,
    },
)
def draw_choice(table: Table) -> Figure:
    """Time of the automatic choice of a method over that of the cheapest one.

    How many times longer the choice takes than the cheapest method, a dot a problem.
    """
    choices = choices_of(table)
    ratios = np.array([choice.ratio for choice in choices])
    worst = ratios[np.isfinite(ratios)].max(initial=1.0)
    within = np.count_nonzero(ratios <= NEAR)
    title = "The automatic choice takes "
    if within == len(choices):
        title += f"at most {numbers.write_fixed(worst, 2)} times as long as the cheapest method"
    else:
        title += f"no more than {numbers.write(NEAR)} times as long as the cheapest method in "
        title += f"{within} of {len(choices)} comparisons"
    targets = [target for target in TARGETS if any(c.target == target for c in choices)]
    figure, (axes,) = panel_figure(table, title, 1, 0.75 * len(targets), above=1.4)
    axes.axvspan(1, NEAR, color=FAINT, alpha=0.4, linewidth=0)
    axes.axvline(1, color=GREY, linewidth=0.8)
    edge = max(1.15 * worst, 1.15 * NEAR)
    for place, target in enumerate(targets):
        draw_target(axes, place, [c for c in choices if c.target == target], edge)
    alone = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0), "title": "cheapest method"}
    axes.legend(alone.values(), map(name_of, alone), **place)
    axes.set_xscale("log")
    words = "time of the automatic choice over that of the cheapest method"
    name_axis(axes.xaxis, words, letters=by_width(70, 25))
    shown = (1, 1.2, 1.5, 2, 3) if edge < 5 else (1, 2, 5, 10, 20, 50, 100)  # with room between
    axes.set_xticks(shown, labels=map(numbers.write, shown))
    axes.set_xticks([], minor=True)
    axes.set_xlim(1 / 1.04, edge)
    powers = (round(np.log10(target)) for target in targets)
    name_rows(axes, [f"{numbers.with_power('1', power)} rad" for power in powers])
    axes.set_ylabel("error")
    return figure


def draw_target(axes: Axes, place: int, choices: list[Choice], edge: float) -> None:
    """The comparisons for a target; those in which the choice misses it are at the right edge."""
    heights = place + 0.3 * (2 * ((5**0.5 - 1) / 2 * np.arange(len(choices)) % 1) - 1)
    for choice, height in zip(choices, heights, strict=True):
        look = known.known(choice.cheapest).look
        style = {"color": look.colour, "marker": look.marker, "markersize": 6 * look.size}
        style |= {"linestyle": "", "markeredgewidth": 0.5, "label": choice.cheapest}
        style["markeredgecolor"] = GROUND if np.isfinite(choice.ratio) else INK
        axes.plot(min(choice.ratio, edge / 1.03), height, **style)
    near = sum(choice.ratio <= NEAR for choice in choices)
    missed = sum(not np.isfinite(choice.ratio) for choice in choices)
    words = f"{near} of {len(choices)} within {numbers.write(NEAR)}"
    words += f", {missed} missed" if missed else ""
    style = {"xycoords": axes.get_yaxis_transform(), "fontsize": "small", "color": GREY}
    axes.annotate(words, (0.99, place - 0.3), ha="right", **style)
