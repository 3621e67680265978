"""Which figures there are, and to which tables they belong."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from matplotlib.figure import Figure

from spintop_figures.columns import draw_columns, object_to_columns
from spintop_figures.methods.benchmarks import COLUMNS as BENCHMARKS
from spintop_figures.methods.benchmarks import WORDS as BENCHMARK_WORDS
from spintop_figures.methods.benchmarks import draw_benchmarks, object_to_benchmarks
from spintop_figures.methods.choice import draw_choice, object_to_choice
from spintop_figures.methods.costs import draw_costs, object_to_costs
from spintop_figures.methods.orders import draw_orders, object_to_orders
from spintop_figures.methods.peers import draw_peers, object_to_peers
from spintop_figures.methods.precision import WORDS as PRECISION
from spintop_figures.methods.precision import (
    draw_precision_time,
    draw_precision_work,
    object_to_precision,
)
from spintop_figures.methods.tolerance_map import draw_tolerance_map, object_to_tolerance_map
from spintop_figures.methods.trials import object_to_trials
from spintop_figures.methods.verdicts import draw_verdicts
from spintop_figures.motion.account import COLUMNS as ACCOUNT
from spintop_figures.motion.account import draw_account, object_to_account
from spintop_figures.motion.bifurcation import draw_bifurcation, object_to_bifurcation
from spintop_figures.motion.cones import draw_cones
from spintop_figures.motion.drift import draw_drift, object_to_drift
from spintop_figures.motion.events import (
    draw_events,
    draw_sections,
    object_to_events,
    object_to_sections,
)
from spintop_figures.motion.fits import draw_fit, object_to_fit
from spintop_figures.motion.path import draw_path
from spintop_figures.motion.potential import draw_portrait, draw_potential
from spintop_figures.motion.reduced import COLUMNS as REDUCED
from spintop_figures.motion.reduced import object_to_reduced
from spintop_figures.motion.residuals import draw_error, draw_residuals, object_to_residuals
from spintop_figures.motion.trace import draw_trace, draw_traces, object_to_trace
from spintop_figures.motion.trajectory import draw_angles, draw_forces, draw_support
from spintop_figures.moving.assumptions import CONSERVED, LAGRANGE, Assumption, broken
from spintop_figures.style.look import the_look
from spintop_figures.style.options import DEFAULT, Options
from spintop_figures.style.page import finish
from spintop_figures.sweeps import table1
from spintop_figures.sweeps.curves import draw_curves, object_to_curves
from spintop_figures.sweeps.indices import draw_indices, object_to_indices
from spintop_figures.sweeps.maps import draw_maps, object_to_maps
from spintop_figures.sweeps.scatter import draw_scatter, object_to_scatter
from spintop_figures.sweeps.statistics import (
    draw_distributions,
    draw_statistics,
    object_to_bins,
    object_to_distributions,
)
from spintop_figures.sweeps.sweep import draw_sweep, formula_columns, good_rows, sweep_columns
from spintop_figures.tables.own_units import in_own_units
from spintop_figures.tables.table import Table, TableError

TRIALS = ("case", "method", "formulation", "verdict", "status", "reference", "reason")
"""The categorical columns of a stability study."""


class FigureKind(NamedTuple):
    """A figure: the study and the columns it is made of, and what else it asks of a table."""

    name: str
    what: str
    kind: str
    """Of the study; empty is any."""
    columns: tuple[str, ...]
    make: Callable[[Table], Figure] | Callable[[Sequence[Table]], Figure]
    """Draws it from the table, or from all tables that are compared."""
    objection: Callable[[Table], str] = lambda table: ""
    """Why a table with these columns has no such figure; empty if it has."""
    sparse: bool = False
    """Whether some of the columns may have no numbers."""
    words: tuple[str, ...] = ()
    """The categorical columns that it needs."""
    assumes: tuple[Assumption, ...] = ()
    """What holds for the scenes that it is true for."""

    def draw(self, tables: Table | Sequence[Table], options: Options = DEFAULT) -> Figure:
        """Draw the figure of a table, or of all tables that are compared, in the look of all."""
        with the_look(options):
            alone = isinstance(tables, Table)
            figure = self.make(in_own_units(tables) if alone else [*map(in_own_units, tables)])
            try:
                return finish(figure, options)
            except TableError as error:
                raise TableError(f"{error}: no {self.name} figure") from None

    def refusal(self, table: Table) -> str:
        """Why the figure does not belong to a table; empty if it does."""
        table = in_own_units(table)
        if self.kind and table.kind != self.kind:
            return f"is no table of the kind {self.kind}"
        if missing := table.missing(self.words + self.columns):
            return f"has no column {', '.join(missing)}"
        if wordless := [name for name in self.words if not table.has_words(name)]:
            return f"has no word in column {', '.join(wordless)}"
        empty = table.empty(self.columns)
        if empty and not (self.sparse and len(empty) < len(self.columns)):
            return f"has no number in column {', '.join(empty)}"
        return broken(self.assumes, table) or self.objection(table)

    def is_expected(self, table: Table) -> bool:
        """Whether the table has all columns, so that it is an error if they hold no number."""
        return (
            table.kind == self.kind
            and not table.missing(self.words + self.columns)
            and not (broken(self.assumes, table) or self.objection(table))
        )


def object_to_error(table: Table) -> str:
    """An error is drawn on a log axis."""
    if not (table.rows["orientation_error"] > 0).any():
        return "has no error above zero in column orientation_error"
    return ""


def object_to_sweep(table: Table) -> str:
    """The curves are over one parameter, through the cases that succeeded."""
    if len(table.axes()) != 1:
        return "is a sweep over more than one parameter"
    if good_rows(table).empty:
        return "has no case that succeeded"
    if table.empty(formula_columns()) == formula_columns():
        return "has no formula for a fast top"
    return ""


def object_to_table1(table: Table) -> str:
    """The page is for a sweep over the spin ratio that fits on it."""
    if table.axes() != ["initial.spin_ratio"]:
        return "is not a sweep over initial.spin_ratio alone"
    if len(table.rows) > table1.MOST_ROWS:
        return f"has more rows than fit on a page ({table1.MOST_ROWS})"
    return ""


FIGURES = (
    FigureKind(
        "angles",
        "angles and height of the centre of mass against time (Figure 8)",
        "trajectory",
        ("t", "phi", "theta", "psi", "com_z"),
        draw_angles,
    ),
    FigureKind(
        "forces",
        "support force and energies against time (Figure 9)",
        "trajectory",
        ("t", "force_x", "force_y", "force_z", "energy", "kinetic", "potential"),
        draw_forces,
    ),
    FigureKind(
        "path",
        "path of the centre of mass in space and from above (Figure 11)",
        "trajectory",
        ("com_x", "com_y", "com_z"),
        draw_path,
    ),
    FigureKind(
        "error",
        "orientation error against time",
        "trajectory",
        ("t", "orientation_error"),
        draw_error,
        object_to_error,
    ),
    FigureKind(
        "trace",
        "path of the axis tip on the unit sphere",
        "trajectory",
        ("theta", "phi"),
        draw_trace,
        object_to_trace,
    ),
    FigureKind(
        "potential",
        "effective potential of a symmetric top, with the turning points",
        "trajectory",
        REDUCED,
        draw_potential,
        object_to_reduced,
        assumes=LAGRANGE,
    ),
    FigureKind(
        "portrait",
        "phase portrait of the inclination of a symmetric top",
        "trajectory",
        REDUCED,
        draw_portrait,
        object_to_reduced,
        assumes=LAGRANGE,
    ),
    FigureKind(
        "bifurcation",
        "bifurcation diagram of a symmetric top: its momenta and energy among all motions",
        "trajectory",
        REDUCED,
        draw_bifurcation,
        object_to_bifurcation,
        assumes=LAGRANGE,
    ),
    FigureKind(
        "support",
        "support force in the plane of the axis and normal to it, against time",
        "trajectory",
        ("t", "force_r", "force_n", "force_z"),
        draw_support,
    ),
    FigureKind(
        "cones",
        "angular velocity in the body and in space (polhode and herpolhode)",
        "trajectory",
        ("phi", "theta", "psi", "omega1", "omega2", "omega3"),
        draw_cones,
    ),
    FigureKind(
        "account",
        "inclination, spin, and account of energy under effects, against time",
        "trajectory",
        ACCOUNT,
        draw_account,
        object_to_account,
    ),
    FigureKind(
        "residuals",
        "residuals R1 to R4 against time (Figures 2 to 7)",
        "trajectory",
        ("t", "R1", "R2", "R3", "R4"),
        draw_residuals,
        object_to_residuals,
        assumes=CONSERVED,
    ),
    FigureKind(
        "fit",
        "residuals of a fit against time",
        "fit",
        ("t",),
        draw_fit,
        object_to_fit,
    ),
    FigureKind(
        "sweep",
        "formulas for a fast top and exact values against the swept parameter",
        "sweep",
        tuple(sweep_columns()),
        draw_sweep,
        object_to_sweep,
        sparse=True,
        assumes=LAGRANGE,
    ),
    FigureKind(
        "table1",
        "the same as a page, where the spin ratio is swept (Table 1)",
        "sweep",
        tuple(column.column for column in table1.COLUMNS),
        table1.draw_table1,
        object_to_table1,
        sparse=True,
        assumes=LAGRANGE,
    ),
    FigureKind(
        "events",
        "instants of the events of a trajectory",
        "events",
        ("t",),
        draw_events,
        object_to_events,
        words=("event",),
    ),
    FigureKind(
        "sections",
        "inclination and its rate at frequent events (Poincare sections)",
        "events",
        ("theta", "theta_rate"),
        draw_sections,
        object_to_sections,
        words=("event",),
    ),
    FigureKind(
        "curves",
        "quantities of a sweep over one parameter",
        "sweep",
        (),
        draw_curves,
        object_to_curves,
    ),
    FigureKind(
        "maps",
        "maps of the quantities of a sweep over a grid of two parameters",
        "sweep",
        (),
        draw_maps,
        object_to_maps,
    ),
    FigureKind(
        "scatter",
        "points of a sweep over several parameters that is not a grid of two",
        "sweep",
        (),
        draw_scatter,
        object_to_scatter,
    ),
    FigureKind(
        "means",
        "means of a sweep over its bins, and the number of cases",
        "statistics",
        ("cases",),
        draw_statistics,
        object_to_bins,
    ),
    FigureKind(
        "distributions",
        "histograms of a sweep over all cases, with quantiles",
        "statistics",
        ("cases",),
        draw_distributions,
        object_to_distributions,
    ),
    FigureKind(
        "indices",
        "first-order and total Sobol' indices of a sweep with their intervals",
        "statistics",
        ("cases",),
        draw_indices,
        object_to_indices,
    ),
    FigureKind(
        "verdicts",
        "verdict and digits of each method on each hard case",
        "stability",
        ("orientation_error",),
        draw_verdicts,
        object_to_trials,
        words=TRIALS,
    ),
    FigureKind(
        "costs",
        "cost and error of the methods, a line per method and a dot per hard case",
        "stability",
        ("orientation_error", "evaluations", "inherent_error"),
        draw_costs,
        object_to_costs,
        words=TRIALS,
    ),
    FigureKind(
        "precision_time",
        "work-precision diagram: error against time, one panel per problem",
        "work_precision",
        ("error_max", "time_s"),
        draw_precision_time,
        object_to_precision,
        words=PRECISION,
    ),
    FigureKind(
        "precision_work",
        "work-precision diagram: error against evaluations, one panel per problem",
        "work_precision",
        ("error_max", "evaluations"),
        draw_precision_work,
        object_to_precision,
        words=PRECISION,
    ),
    FigureKind(
        "orders",
        "error against step size of the fixed-step methods, with measured orders",
        "work_precision",
        ("error_max",),
        draw_orders,
        object_to_orders,
        words=PRECISION,
    ),
    FigureKind(
        "tolerance_map",
        "the cheapest method for a given error, over two swept parameters",
        "work_precision",
        ("error_max", "time_s"),
        draw_tolerance_map,
        object_to_tolerance_map,
        words=PRECISION,
    ),
    FigureKind(
        "choice",
        "time of the automatic choice of a method over that of the cheapest one",
        "work_precision",
        ("orientation_error", "time_s"),
        draw_choice,
        object_to_choice,
        words=(*PRECISION, "auto"),
    ),
    FigureKind(
        "benchmarks",
        "errors of published numbers and of spintop",
        "benchmark",
        BENCHMARKS,
        draw_benchmarks,
        object_to_benchmarks,
        sparse=True,
        words=BENCHMARK_WORDS,
    ),
    FigureKind(
        "peers",
        "error against time of spintop and of other programs (scripts/compare_peers)",
        "work_precision",
        ("orientation_error", "time_s", "inherent_error"),
        draw_peers,
        object_to_peers,
        sparse=True,
        words=("problem", "program", "method", "status"),
    ),
)

COMPARISONS = (
    FigureKind(
        "traces",
        "paths of the axis tip on the unit sphere, side by side",
        "trajectory",
        ("theta", "phi"),
        draw_traces,
        object_to_trace,
    ),
    FigureKind(
        "drift",
        "drift of the first integrals and of the quaternion norm in long runs of several methods",
        "trajectory",
        ("t", "energy_error"),
        draw_drift,
        object_to_drift,
        assumes=CONSERVED,
    ),
)
"""Figures that are drawn of several tables together, of each of which they ask the same."""


def choose_figures(
    table: Table, names: list[str] | None = None
) -> tuple[list[FigureKind], list[str]]:
    """The figures to draw from a table, and what is wrong with those that should be drawn too."""
    table = in_own_units(table)
    if unknown := set(names or ()) - {kind.name for kind in FIGURES}:
        known = ", ".join(kind.name for kind in FIGURES)
        return [], [f"there is no figure {min(unknown)}; there are {known}"]
    wanted = [
        kind for kind in FIGURES if (kind.name in names if names else kind.is_expected(table))
    ]
    refusals = {kind: kind.refusal(table) for kind in wanted}
    good = [kind for kind in wanted if not refusals[kind]]
    return good, [f"{refusals[kind]}: no {kind.name} figure" for kind in wanted if refusals[kind]]


def columns_kind(options: Options) -> FigureKind:
    """The figure of the columns that a user chose."""
    return FigureKind(
        "columns",
        "columns of choice, of all tables together",
        "",
        (options.x, *options.y),
        lambda tables: draw_columns(tables, options),
        lambda table: object_to_columns(table, options),
    )


def draw(tables: Table | Sequence[Table], name: str = "", **options: object) -> Figure:
    """Draw the figure of this name of a table, or one of several tables, such as `traces`.

    Without a name, the columns `y` of the tables over their column `x` (time). The other options
    are those of `style.options.Options`: width, title, dark, style, font_size, decimal_comma; of
    chosen columns log and range. Raises a TableError that says why there is no such figure, and a
    ValueError or a TypeError where an option is wrong.
    """
    asked = Options(**options)
    alone = isinstance(tables, Table)
    if asked.y and name:
        raise ValueError("a figure has a name or columns y, not both")
    if asked.y:
        kind, tables = columns_kind(asked), [tables] if alone else list(tables)
    else:
        kinds = FIGURES if alone else COMPARISONS
        kind = next((kind for kind in kinds if kind.name == name), None)
        if kind is None:
            known = ", ".join(kind.name for kind in kinds)
            raise TableError(f"there is no figure {name}; there are {known}")
    for table in [tables] if alone and not asked.y else tables:
        if refusal := kind.refusal(table):
            raise TableError(f"{refusal}: no {kind.name} figure")
    return kind.draw(tables, asked)
