"""Tests of the figures of the motion: what they show is what the program computes."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]

from plot_case import TRAJECTORY, TableCase, a_sweep, a_trajectory  # noqa: E402
from spintop_figures.motion.cones import in_space  # noqa: E402
from spintop_figures.motion.drift import CONSTANTS, method_of, running_maximum  # noqa: E402
from spintop_figures.motion.fits import draw_fit  # noqa: E402
from spintop_figures.motion.potential import draw_portrait, draw_potential  # noqa: E402
from spintop_figures.motion.reduced import find_reduced  # noqa: E402
from spintop_figures.motion.trace import draw_trace, on_sphere, project  # noqa: E402
from spintop_figures.moving.motion import refusal as motion_refusal  # noqa: E402
from spintop_figures.registry import COMPARISONS, FIGURES, choose_figures, draw  # noqa: E402
from spintop_figures.tables.own_units import in_own_units  # noqa: E402
from spintop_figures.tables.table import Table, read_table  # noqa: E402

EXE = os.environ["SPINTOP_EXE"]
INPUTS = TESTS.parent / "input"


class MotionCase(TableCase):
    """Runs the program on the inputs of the gallery."""

    def compute(self, name: str, *settings: str) -> Table:
        """The table of an input."""
        words = [word for setting in settings for word in ("--set", setting)]
        command = [EXE, "--quiet", "-o", self.folder, *words, INPUTS / f"{name}.nml"]
        subprocess.run(command, check=True, capture_output=True)
        return read_table(self.folder / f"{name}.csv")

    def refusal(self, name: str, table: Table) -> str:
        """Why a table has no figure of this name."""
        return next(kind for kind in FIGURES if kind.name == name).refusal(table)


class ReducedTest(MotionCase):
    """The effective potential is found from the columns of a table."""

    def test_turning_points(self) -> None:
        """They are the least and the largest inclination, which these rows have among them."""
        for name in ("tip_loop", "tip_cusp", "tip_wave", "slow_top"):
            with self.subTest(name):
                settings = ["span.samples=1981"] if name == "slow_top" else []
                table = self.compute(name, *settings)
                theta = table.rows["theta"]
                turns = find_reduced(table).turning_points()
                np.testing.assert_allclose(turns, (theta.min(), theta.max()), atol=1e-7)

    def test_body(self) -> None:
        """The moments are those of the body, of whatever shape."""
        reduced = find_reduced(self.compute("spinning_wheel"))
        mass = 7800 * np.pi * 0.1**2 * 0.01
        self.assertAlmostEqual(reduced.inertia, mass * (3 * 0.1**2 + 0.01**2) / 12 + mass, 8)
        self.assertAlmostEqual(reduced.weight, mass * 9.81, 8)
        table = self.compute("tip_loop", "output.columns=all")
        reduced = find_reduced(table)
        for column in ("lz", "l3"):
            self.assertAlmostEqual(getattr(reduced, column), table.rows[column][0], 10)
        rate = reduced.inertia * table.rows["theta_rate"] ** 2 / 2
        total = rate + reduced.potential(table.rows["theta"].to_numpy())
        np.testing.assert_allclose(total, reduced.energy, rtol=1e-10)

    def test_separatrix(self) -> None:
        """It has the energy of the top at rest upright, and is there below the sleeping spin."""
        reduced = find_reduced(self.compute("separatrix"))
        upright = 9.81 * 0.8660254037844387
        self.assertAlmostEqual(reduced.separatrix(), upright, 10)
        self.assertAlmostEqual(float(reduced.potential(0.0)), upright, 10)
        self.assertAlmostEqual(reduced.energy, upright, 10)
        self.assertGreater(upright, reduced.potential(0.01))
        sleeping = reduced._replace(lz=2.01 * reduced.lz, l3=2.01 * reduced.l3)
        self.assertIsNone(sleeping.separatrix())
        self.assertGreater(sleeping.potential(0.01), sleeping.potential(0.0))
        self.assertIsNone(find_reduced(self.compute("slow_top")).separatrix())
        hanging = reduced._replace(weight=-reduced.weight, lz=-reduced.lz)
        self.assertEqual(hanging.separatrix(), reduced.separatrix())
        self.assertAlmostEqual(float(hanging.potential(np.pi)), upright, 10)
        self.assertIsNone(hanging._replace(lz=reduced.lz).separatrix())

    def test_refusals(self) -> None:
        """Only an undamped symmetric top has an effective potential, and only if it nutates."""
        every = "output.columns=all"
        damped = self.compute("damped_top", every)
        self.assertIn("is of a damped body", self.refusal("potential", damped))
        body = self.compute("rigid_body_chaotic", every)
        self.assertIn("not symmetric about body z", self.refusal("portrait", body))
        steady = self.compute("regular_precession")
        self.assertIn("too steady", self.refusal("potential", steady))
        self.assertIn(
            "has no column theta, theta_rate",
            self.refusal("potential", self.compute("long_drift", "span.nutations=3")),
        )


class DrawnTest(MotionCase):
    """Curves are drawn at the right places."""

    def test_portrait(self) -> None:
        """The motion and the separatrix lie on one curve; their ends are the turning points."""
        table = self.compute("separatrix")
        axes = draw_portrait(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        theta, rate = lines["separatrix, to the upright"].get_data()
        order = np.argsort(table.rows["theta"])
        moving = np.interp(
            theta, np.degrees(table.rows["theta"])[order], -table.rows["theta_rate"][order]
        )
        inside = (theta > 1) & (theta < 119)
        np.testing.assert_allclose(rate[inside], moving[inside], atol=2e-3)
        axes = draw_potential(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        np.testing.assert_allclose(lines["turning points"].get_xdata(), (0, 120), atol=1e-4)

    def test_trace(self) -> None:
        """Points of the sphere are seen at their distance; the path is all drawn, in two parts."""
        points = on_sphere(np.linspace(0, 3, 50), np.linspace(0, 9, 50))
        seen = project(*points)
        np.testing.assert_allclose(sum(part**2 for part in seen), 1)
        front = project(*on_sphere(np.array([np.pi / 2]), np.array([0.0])))
        self.assertGreater(front[2][0], 0)
        table = self.compute("tip_wave")
        theta, phi = (table.rows[name].to_numpy() for name in ("theta", "phi"))
        x, _, _ = project(*on_sphere(theta, phi))
        whole = [
            line for line in draw_trace(table).axes[0].lines if len(line.get_xdata()) == len(x)
        ]
        drawn = np.array([line.get_xdata() for line in whole])
        self.assertEqual(len(whole), 2)
        np.testing.assert_array_equal(np.nanmax(drawn, axis=0), x)

    def test_cones(self) -> None:
        """In steady precession the angular velocity turns about the vertical with the axis."""
        table = self.compute("regular_precession")
        rows = table.rows
        x, y, z = in_space(table)
        np.testing.assert_allclose(z, rows["phi_rate"] + rows["psi_rate"] * np.cos(rows["theta"]))
        np.testing.assert_allclose(np.hypot(x, y), rows["psi_rate"][0] * np.sin(rows["theta"][0]))
        np.testing.assert_allclose(
            np.arctan2(x, -y), np.arctan2(np.sin(rows["phi"]), np.cos(rows["phi"])), atol=1e-9
        )


class TogetherTest(MotionCase):
    """Figures of several tables."""

    def test_drift(self) -> None:
        """The running maximum rises, and ends at the largest error."""
        settings = ["span.nutations=40", "span.samples=41"]
        table = self.compute("long_drift", *settings)
        self.assertEqual(method_of(table), ("taylor", "space_frame"))
        t, off = running_maximum(table, CONSTANTS[0])
        self.assertTrue((np.diff(off) >= 0).all())
        self.assertEqual((len(t), off[-1]), (40, table.rows["energy_error"].abs().max()))
        _, off = running_maximum(table, CONSTANTS[1])
        self.assertEqual(off[-1], (table.rows["lz"] - table.rows["lz"][0]).abs().max())

    def test_script(self) -> None:
        """They are files of their own; each table has to have what they ask for."""
        paths = []
        for method in ("taylor", "dop853"):
            table = self.compute(
                "long_drift", "span.nutations=9", "span.samples=10", f"integration.method={method}"
            )
            paths.append(table.path.rename(self.folder / f"{method}.csv"))
        motion = self.put("motion.csv", a_trajectory())
        for name, tables in (("drift", paths), ("traces", [motion, motion])):
            folder = self.folder / name
            self.assertEqual(self.call("--together", name, "-o", folder, *tables), (0, ""))
            self.check_pictures(folder, {name})
        sweep = self.put("sweep.csv", a_sweep())
        code, complaint = self.call("--together", "traces", motion, sweep)
        self.assertEqual(code, 2)
        self.assertIn("sweep.csv: is no table of the kind trajectory: no traces", complaint)
        code, complaint = self.call("--together", "drift", motion)
        self.assertEqual((code, "no column energy_error" in complaint), (2, True))
        exact = self.put("exact.csv", a_trajectory([*TRAJECTORY, "energy_error"], energy_error=0.0))
        code, complaint = self.call("--together", "drift", exact)
        self.assertEqual((code, "no error of the energy above zero" in complaint), (2, True))
        code, complaint = self.call("--together", "traces", self.folder / "none.csv")
        self.assertEqual((code, "no such file" in complaint), (2, True))

    def test_names(self) -> None:
        """No comparison has the name of a figure."""
        names = [kind.name for kind in (*FIGURES, *COMPARISONS)]
        self.assertEqual(len(names), len(set(names)))


class UnitsTest(MotionCase):
    """Tables in other units than those of the columns."""

    def test_own_units(self) -> None:
        """They have the figures of others, which are the same."""
        own = ("t", "phi", "theta", "psi", "com_z")
        other = ("t_ms", "phi_deg", "theta_turns", "psi_mrad", "com_z_mm")
        tables = [
            self.compute("slow_top", f"output.columns={','.join(names)}") for names in (own, other)
        ]
        self.assertEqual(list(tables[1].rows), list(other))
        self.assertEqual(tables[1].units["theta_turns"], "turns")
        drawn = []
        for table in tables:
            kinds, problems = choose_figures(table)
            self.assertEqual(problems, [])
            self.assertIn("angles", [kind.name for kind in kinds])
            lines = draw(table, "angles").axes[0].lines
            drawn.append(np.concatenate([line.get_xydata() for line in lines]))
        np.testing.assert_allclose(drawn[1], drawn[0], rtol=1e-12, atol=1e-12)
        shown = in_own_units(tables[1])
        self.assertEqual(shown.units["theta"], "rad")
        self.assertIs(in_own_units(tables[0]), tables[0])
        self.assertIs(in_own_units(shown), shown)
        self.assertEqual(motion_refusal(shown), "")


class FitTest(MotionCase):
    """The residuals of a fit."""

    def test_degrees(self) -> None:
        """Residuals of angles are drawn in degrees, with symbols; the band is twice their size."""
        self.compute("fit")
        table = read_table(self.folder / "fit.residuals.csv")
        panels = draw_fit(table).axes
        labels = [axes.get_ylabel() for axes in panels]
        self.assertEqual(labels, [f"{symbol} (degrees)" for symbol in "φθψ"])
        for axes, name in zip(panels, ("phi", "theta", "psi"), strict=True):
            residuals = np.degrees(table.rows[f"{name}_residual"])
            np.testing.assert_allclose(axes.lines[-1].get_ydata(), residuals, rtol=1e-14)
            size = np.sqrt(np.mean(residuals**2))
            band = axes.patches[0].get_extents().transformed(axes.transData.inverted())
            np.testing.assert_allclose(band.y1, 2 * size, rtol=1e-9)
            self.assertIn(f"root mean square {size:.2g}", axes.get_title("right"))


if __name__ == "__main__":
    unittest.main()
