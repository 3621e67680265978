"""The gallery: figures, their inputs and their captions."""

import shlex
from typing import NamedTuple

TITLE = "study.title="
"""The setting that does not name a table."""


class Run(NamedTuple):
    """An input of the folder input/, and settings that take the place of its own."""

    input: str
    settings: tuple[str, ...] = ()

    @property
    def table(self) -> str:
        """The name of its table: that of the input, and what the settings make of it."""
        values = [
            setting.partition("=")[2] for setting in self.settings if not setting.startswith(TITLE)
        ]
        return "_".join([self.input, *values])

    def command(self) -> str:
        """The command that makes the table."""
        words = [
            word for setting in self.table_settings() for word in ("--set", shlex.quote(setting))
        ]
        return " ".join(["scripts/run", *words, f"input/{self.input}.nml"])

    def table_settings(self) -> list[str]:
        """The settings, and a name for a table that is not the input's own."""
        return [*self.settings, *([f"output.file={self.table}"] if self.settings else [])]


class Exhibit(NamedTuple):
    """Figures of the gallery, with their runs and caption."""

    name: str
    runs: tuple[Run, ...]
    figures: tuple[str, ...]
    """Kinds of figures that scripts/plot draws; a comparison takes the tables of all runs."""
    caption: str
    documented: tuple[str, ...] = ()
    """Those that doc/figures has, too."""
    is_long: bool = False
    """Whether it is drawn only when named, or with --all."""


def one(name: str) -> tuple[Run, ...]:
    """A single run, with the settings of the input."""
    return (Run(name),)


COST, FINEST_COST = 330, 530
"""Function evaluations per nutation of the methods whose drift is compared; those of Taylor."""

COSTS = (
    f"{TITLE}A million nutations of Example 1, {COST} function evaluations per nutation;"
    f" Taylor at its finest tolerance {FINEST_COST}"
)

DRIFT = tuple(
    Run("long_drift", (f"integration.{setting}", f"integration.method={method}", COSTS))
    for method, setting in (
        ("taylor", "relative_tolerance=0"),
        ("dop853", "relative_tolerance=15e-10"),
        ("splitting_4", "steps=47195264"),
        ("splitting_6", "steps=23597632"),
    )
)
"""Settings at which the other methods cost the same; steps are whole numbers between rows."""

GALLERY = (
    Exhibit(
        "figure2",
        one("slow_top_euler_ode45"),
        ("residuals",),
        "Figure 2 of the paper: residuals of Euler's equations under ode45, Example 1. They do"
        " not measure the error of the azimuth.",
    ),
    Exhibit(
        "figure3",
        one("slow_top_lagrange_ode45"),
        ("residuals",),
        "Figure 3: residuals of Lagrange's equations under ode45.",
    ),
    Exhibit(
        "figure4",
        one("slow_top_lagrange_rk4"),
        ("residuals",),
        "Figure 4: residuals of Lagrange's equations under RK4 with 992 steps.",
    ),
    Exhibit(
        "figure5",
        one("slow_top_lagrange_cn1"),
        ("residuals",),
        "Figure 5: the same under Crank-Nicolson, scheme 1 (trapezoidal rule).",
    ),
    Exhibit(
        "figure6",
        one("slow_top_lagrange_cn2"),
        ("residuals",),
        "Figure 6: the same under Crank-Nicolson, scheme 2 (implicit midpoint rule).",
    ),
    Exhibit(
        "figure7",
        one("slow_top_scenario2_rk4"),
        ("residuals", "error"),
        "Figure 7: scenario 2 under RK4. The energy residual stays at rounding, while the"
        " orientation error reaches 4.4 degrees.",
        documented=("error",),
    ),
    Exhibit(
        "figure8",
        one("slow_top_lagrange_ode45"),
        ("angles",),
        "Figure 8: Euler angles and height of the centre of mass.",
    ),
    Exhibit(
        "figure9",
        one("slow_top_lagrange_ode45"),
        ("forces",),
        "Figure 9: support force and energies. The vertical force is upward at the lowest point.",
    ),
    Exhibit(
        "figure11",
        one("spinning_wheel_figure11"),
        ("path",),
        "Figure 11: path of the centre of mass of the spinning wheel, with the inertia that the"
        " author used.",
    ),
    Exhibit(
        "table1",
        one("spinning_wheel_sweep"),
        ("table1", "sweep"),
        "Table 1 with the inertia about the pivot: fast-top formulas and the exact solution.",
    ),
    Exhibit(
        "table1_paper",
        one("spinning_wheel_paper"),
        ("table1",),
        "Table 1 with the inertia that the author used.",
    ),
    Exhibit(
        "tips",
        tuple(Run(f"tip_{name}") for name in ("loop", "cusp", "wave")),
        ("traces",),
        "The axis of a symmetric top makes loops, cusps or waves if it is released with backward"
        " precession, at rest or with forward precession. Dashed: minimum and maximum nutation"
        " angle.",
        documented=("traces",),
    ),
    Exhibit(
        "slow_top",
        one("slow_top"),
        ("trace", "potential", "portrait"),
        "Exact solution of Example 1: path of the axis tip, effective potential with the turning"
        " points, and phase portrait of the inclination.",
    ),
    Exhibit(
        "bifurcation",
        one("tip_loop"),
        ("bifurcation",),
        "Bifurcation diagram of a top that makes loops: its energy and its momenta among those of"
        " all motions with its momentum about the axis.",
        documented=("bifurcation",),
    ),
    Exhibit(
        "toy",
        one("toy_top"),
        ("angles", "trace"),
        "A toy top at 1500 revolutions per minute, released at an inclination of 20 degrees.",
        documented=("angles",),
    ),
    Exhibit(
        "toy_methods",
        one("toy_top_methods"),
        ("precision_time",),
        "The toy top by five methods: error against time.",
        documented=("precision_time",),
    ),
    Exhibit(
        "separatrix",
        one("separatrix"),
        ("portrait", "potential", "support", "cones"),
        "The separatrix: half the threshold spin of the sleeping top, equal momenta about the"
        " vertical and the axis. The axis approaches the upright position and never reaches it. The"
        " separatrix divides motions that turn back from motions that pass the upright.",
    ),
    Exhibit(
        "cones",
        one("regular_precession"),
        ("cones", "trace"),
        "Steady precession: the path of the angular velocity is a circle in the body and a circle"
        " in space; a cone rolls on a cone.",
    ),
    Exhibit(
        "events",
        one("slow_top_events"),
        ("events",),
        "Events of Example 1: turning points, turns of the azimuth, passages of the horizontal.",
    ),
    Exhibit(
        "maps",
        one("map_spin_tilt"),
        ("maps",),
        "Class of the motion (loops or waves) of tops released with backward precession, over spin"
        " and inclination.",
    ),
    Exhibit(
        "kapitza",
        one("kapitza_map"),
        ("maps",),
        "A body without spin that a vibration of its pivot holds upright: the time at which it has"
        " fallen to 30 degrees, and the growth of deviations by the Floquet multipliers of the"
        " upright body, have the same boundaries.",
        documented=("maps",),
    ),
    Exhibit(
        "rest",
        one("friction_to_rest"),
        ("account",),
        "A top with dry friction and drag from 200 rad/s to rest: it sleeps, wakes, sinks, and lies"
        " still. Its energy and what friction and drag have taken add up to that of the start.",
        documented=("account",),
    ),
    Exhibit(
        "scatter",
        one("random_tops"),
        ("scatter",),
        "A random sample of four thousand spinning wheels: range of nutation and precession against"
        " spin, inclination and nutation rate at the start.",
    ),
    Exhibit(
        "statistics",
        one("spin_tilt_statistics"),
        ("means", "distributions"),
        "Statistics of 100,000 tops whose rows are not kept: means over spin and inclination, and"
        " distributions with quantiles.",
        ("means", "distributions"),
    ),
    Exhibit(
        "indices",
        one("nutation_indices"),
        ("indices",),
        "Sobol' indices of five data of a top: the share of each in the variance of its motion.",
        ("indices",),
    ),
    Exhibit(
        "fit",
        one("fit"),
        ("fit",),
        "A fit of two moments of inertia and the spin to measured angles, and its residuals.",
    ),
    Exhibit(
        "camera",
        one("tip_camera"),
        ("fit",),
        "Residuals of a fit of the spin and the camera to pixels of the tip of a top.",
        documented=("fit",),
    ),
    Exhibit(
        "precision",
        one("work_precision_slow_top"),
        ("precision_time", "precision_work"),
        "Work-precision diagram of Example 1. The exact solution takes less time than any method,"
        " and is accurate to rounding at any instant.",
        documented=("precision_time",),
    ),
    Exhibit(
        "precision_wheel",
        one("work_precision_wheel"),
        ("precision_time", "precision_work"),
        "Work-precision diagram of the spinning wheel of Example 2.",
    ),
    Exhibit(
        "precision_map",
        one("work_precision_map"),
        ("tolerance_map",),
        "The cheapest numerical method for an error of 1e-9 rad over spin and inclination, and the"
        " ratio to the next one.",
    ),
    Exhibit(
        "orders",
        one("convergence"),
        ("orders",),
        "Error against step size: each method with a fixed step size has its theoretical order.",
    ),
    Exhibit(
        "heavy_top",
        one("heavy_top_orders"),
        ("orders",),
        "The heavy top benchmark of Bruels, Cardona and Arnold: error against step size, with the"
        " orders of methods of 2 to 6.",
        documented=("orders",),
    ),
    Exhibit(
        "stability",
        one("stability"),
        ("verdicts", "costs"),
        "Stability study: verdicts and digits on hard motions, and error against evaluations.",
        documented=("verdicts",),
    ),
    Exhibit(
        "drift",
        DRIFT,
        ("drift",),
        "Drift over a million nutations of Example 1. The energy error of"
        " splitting methods remains constant after the first nutations, that of dop853 grows with"
        " time. The Taylor series at its finest tolerance has the smallest one, which grows with"
        " the root of time, as rounding errors of either sign do.",
        documented=("drift",),
        is_long=True,
    ),
)
"""Names are those of exhibits on the command line; a figure's file is named after its table."""
