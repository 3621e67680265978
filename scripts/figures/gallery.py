"""The gallery: which figures are drawn of which inputs, and what they show."""

from typing import NamedTuple


class Run(NamedTuple):
    """An input of the folder input/, and settings that take the place of its own."""

    input: str
    settings: tuple[str, ...] = ()

    @property
    def table(self) -> str:
        """The name of its table: that of the input, and what the settings make of it."""
        values = [setting.partition("=")[2] for setting in self.settings]
        return "_".join([self.input, *values])

    def command(self) -> str:
        """The command that makes the table."""
        words = [word for setting in self.table_settings() for word in ("--set", setting)]
        return " ".join(["scripts/run", *words, f"input/{self.input}.nml"])

    def table_settings(self) -> list[str]:
        """The settings, and a name for a table that is not the input's own."""
        return [*self.settings, *([f"output.file={self.table}"] if self.settings else [])]


class Exhibit(NamedTuple):
    """Figures of the gallery: what they are drawn of, and what they show."""

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


LONG_STEPS = "integration.steps=32062000"  # 32 a nutation, and a whole number between rows

GALLERY = (
    Exhibit(
        "figure2",
        one("slow_top_euler_ode45"),
        ("residuals",),
        "Figure 2 of the paper: residuals of Euler's equations under ode45, Example 1. They tell"
        " nothing of the azimuth.",
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
        "Figure 7: scenario 2 under RK4. The energy residual is rounding, while the orientation"
        " is up to 4.4 degrees off.",
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
        "Figure 9: support force and energies. The vertical force is upward again at the bottom.",
    ),
    Exhibit(
        "figure11",
        one("spinning_wheel_figure11"),
        ("path",),
        "Figure 11: path of the centre of mass of the spinning wheel, with the inertia that its"
        " author used.",
    ),
    Exhibit(
        "table1",
        one("spinning_wheel_sweep"),
        ("table1", "sweep"),
        "Table 1 with the inertia about the pivot: formulas for a fast top beside the exact"
        " motion.",
    ),
    Exhibit(
        "table1_paper",
        one("spinning_wheel_paper"),
        ("table1",),
        "Table 1 with the inertia that its author used.",
    ),
    Exhibit(
        "tips",
        tuple(Run(f"tip_{name}") for name in ("loop", "cusp", "wave")),
        ("traces",),
        "The axis of a symmetric top makes loops, cusps or waves as it is let go backward, at rest"
        " or forward. Dashed: the circles of its least and its largest inclination.",
        documented=("traces",),
    ),
    Exhibit(
        "slow_top",
        one("slow_top"),
        ("trace", "potential", "portrait"),
        "Example 1, exact: its path on the sphere, the effective potential of its inclination"
        " with the turning points, and its phase portrait.",
    ),
    Exhibit(
        "separatrix",
        one("separatrix"),
        ("portrait", "potential", "support", "cones"),
        "At half the spin that a sleeping top needs, with equal momenta about the vertical and the"
        " axis, the motion from 120 degrees rises to the upright for ever. The separatrix parts"
        " the motions that turn back below the upright from those that pass through it.",
    ),
    Exhibit(
        "cones",
        one("regular_precession"),
        ("cones", "trace"),
        "Steady precession: the angular velocity draws a circle in the body and a circle in space;"
        " the body rolls, a cone on a cone.",
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
        "Where tops that are let go turning backward make loops and where waves, over spin and"
        " inclination.",
    ),
    Exhibit(
        "scatter",
        one("random_tops"),
        ("scatter",),
        "Four thousand spinning wheels drawn at random: swing and precession against spin,"
        " inclination and nutation rate at the start.",
    ),
    Exhibit(
        "precision",
        one("work_precision_slow_top"),
        ("precision_time", "precision_work"),
        "What each accuracy costs on Example 1. The exact motion takes less time than any method"
        " and is exact to rounding at any instant.",
        documented=("precision_time",),
    ),
    Exhibit(
        "precision_wheel",
        one("work_precision_wheel"),
        ("precision_time", "precision_work"),
        "What each accuracy costs on the spinning wheel of Example 2.",
    ),
    Exhibit(
        "precision_map",
        one("work_precision_map"),
        ("tolerance_map",),
        "The cheapest of the methods that take steps to an error of 1e-9 rad over spin and"
        " inclination, and by how much.",
    ),
    Exhibit(
        "orders",
        one("convergence"),
        ("orders",),
        "Error against step: each method of equal steps has the order that theory gives it.",
    ),
    Exhibit(
        "stability",
        one("stability"),
        ("verdicts", "costs"),
        "What each method is worth on hard motions: digits reached, and error against cost.",
        documented=("verdicts",),
    ),
    Exhibit(
        "drift",
        (
            Run("long_drift", ("integration.relative_tolerance=1e-12",)),
            Run(
                "long_drift", ("integration.relative_tolerance=1e-10", "integration.method=dop853")
            ),
            Run("long_drift", (LONG_STEPS, "integration.method=splitting_4")),
            Run("long_drift", (LONG_STEPS, "integration.method=splitting_6")),
        ),
        ("drift",),
        "Drift over a million nutations of Example 1. Under splitting methods the error of the"
        " energy stays where it is after the first nutation; under the others it grows with time.",
        documented=("drift",),
        is_long=True,
    ),
)
"""Names are those of exhibits on the command line; a figure's file is named after its table."""
