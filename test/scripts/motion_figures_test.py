"""Tests of the figures of the motion: what they show is what the program computes."""

import numpy as np
import pandas as pd

from plot_case import TRAJECTORY, TableCase, a_sweep, a_trajectory
from spintop_figures.motion import sphere
from spintop_figures.motion.fits import draw_fit, tell_values
from spintop_figures.motion.reduced import (
    Constants,
    Reduced,
    draw_portrait,
    draw_potential,
    find_reduced,
)
from spintop_figures.motion.residuals import method_of, running_maximum
from spintop_figures.motion.trajectory import draw_account, draw_angles
from spintop_figures.moving.motion import refusal as motion_refusal
from spintop_figures.registry import COMPARISONS, FIGURES, choose_figures, draw
from spintop_figures.style.look import GROUND
from spintop_figures.style.page import lay_out
from spintop_figures.tables.table import in_own_units, read_table


class MotionFiguresTest(TableCase):
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
        assert upright > reduced.potential(0.01)
        sleeping = reduced._replace(lz=2.01 * reduced.lz, l3=2.01 * reduced.l3)
        assert sleeping.separatrix() is None
        assert sleeping.potential(0.01) > sleeping.potential(0.0)
        assert find_reduced(self.compute("slow_top")).separatrix() is None
        hanging = reduced._replace(weight=-reduced.weight, lz=-reduced.lz)
        assert hanging.separatrix() == reduced.separatrix()
        self.assertAlmostEqual(float(hanging.potential(np.pi)), upright, 10)
        assert hanging._replace(lz=reduced.lz).separatrix() is None

    def test_refusals(self) -> None:
        """Only an undamped symmetric top has an effective potential, and only if it nutates."""
        every = "output.columns=all"
        damped = self.compute("damped_top", every)
        assert "is of a damped body" in self.refusal("potential", damped)
        body = self.compute("rigid_body_chaotic", every)
        assert "not symmetric about body z" in self.refusal("portrait", body)
        steady = self.compute("regular_precession")
        assert "too steady" in self.refusal("potential", steady)
        drift = self.compute("long_drift", "span.nutations=3")
        assert "has no column theta, theta_rate" in self.refusal("potential", drift)

    def test_classes(self) -> None:
        """Loops lie above the cusps, waves below; a top that falls is near the upright point."""
        for name, sign in (("tip_loop", 1), ("tip_cusp", 0), ("tip_wave", -1)):
            constants = Constants(find_reduced(self.compute(name)))
            assert np.sign(np.round(constants.excess, 12)) == sign
            ratio, energy = constants.steady()
            assert constants.excess > np.interp(constants.ratio, ratio, energy)
            assert constants.strength >= 2
        assert Constants(find_reduced(self.compute("slow_top"))).strength < 2

    def test_least_energies(self) -> None:
        """The curve is the least effective potential for each ratio of the momenta."""
        theta = np.linspace(1e-6, np.pi - 1e-6, 40_001)
        for weight in (0.6, -0.6):
            for l3 in (0.3, 0.9, -2.5):
                reduced = Reduced(inertia=0.7, weight=weight, lz=0, l3=l3, energy=0)
                ratio, energy = Constants(reduced).steady()
                order = np.argsort(ratio)
                for x in (-2.2, -1.2, -0.7, 0.1, 0.8, 0.95, 1.3, 3.0):
                    least = reduced._replace(lz=x * l3).potential(theta).min() / abs(weight)
                    least -= np.sign(weight) * x
                    found = np.interp(x, ratio[order], energy[order])
                    self.assertAlmostEqual(found, least, delta=1e-3 * (1 + abs(least)))

    def test_drawn(self) -> None:
        """The motion is in the picture; a top without spin has none."""
        table = self.compute("tip_wave")
        (axes,) = draw(table, "bifurcation").axes
        (motion,) = [line for line in axes.lines if line.get_label() == "the motion"]
        constants = Constants(find_reduced(table))
        assert motion.get_xydata().tolist() == [[constants.ratio, constants.excess]]
        assert {text.get_text() for text in axes.texts} == {"loops", "waves", "no motion"}
        spinless = self.compute("tip_wave", "initial.omega3=0")
        assert "without a momentum about its axis" in self.refusal("bifurcation", spinless)

    def test_portrait(self) -> None:
        """The motion and the separatrix lie on one curve; their ends are the turning points."""
        table = self.compute("separatrix")
        axes = draw_portrait(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        theta, rate = lines["separatrix, to the upright"].get_data()
        order = np.argsort(table.rows["theta"])
        thetas, rates = np.degrees(table.rows["theta"]), table.rows["theta_rate"]
        moving = np.interp(theta, thetas[order], -rates[order])
        inside = (theta > 1) & (theta < 119)
        np.testing.assert_allclose(rate[inside], moving[inside], atol=2e-3)
        axes = draw_potential(table).axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        dots = [line for line in axes.lines if line.get_marker() == "o" and len(line.get_xdata())]
        ends = {line.get_xdata()[0]: line for line in dots}
        np.testing.assert_allclose(sorted(ends), (0, 120), atol=1e-4)
        assert ends[0.0].get_markerfacecolor() == GROUND  # it approaches this one
        words = [text.get_text() for text in axes.texts]
        assert sorted(words) == ["0°, never reached", "120.00°"]

    def test_barrier(self) -> None:
        """The barrier at a pole that a motion cannot reach leaves the panel at the top."""
        axes = draw_potential(self.compute("slow_top")).axes[0]
        (curve,) = (line for line in axes.lines if line.get_label() == "effective potential")
        heights = curve.get_ydata()
        assert heights[np.isfinite(heights)][:9].max() > axes.get_ylim()[1]

    def test_windows(self) -> None:
        """A path that keeps to a cap is seen from above it, all of it, and large."""
        for name, theta in (("kapitza", 0.0), ("composed_top", 0.0), ("spinning_wheel", 22.3)):
            table = self.compute(name)
            tip = sphere.on_sphere(*(table.rows[angle].to_numpy() for angle in ("theta", "phi")))
            view = sphere.view_of(tip)
            self.assertAlmostEqual(np.degrees(np.arccos(view.towards[2])), theta, 0)
            basis = np.array([view.right, view.up, view.towards])
            np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=1e-14)
            seen = np.hypot(*sphere.project(*tip, view)[:2]).max() / view.window
            assert 0.85 < seen < 1, (name, seen)
        around = sphere.on_sphere(np.linspace(0, 3, 50), np.linspace(0, 9, 50))
        assert sphere.view_of(around) is sphere.WHOLE

    def test_turns(self) -> None:
        """Azimuths are in degrees, many of them in turns."""
        told = [sphere.tell_turn(degrees) for degrees in (312.5, -12.25, 14131.92, 0.0)]
        assert told == ["+312.5°", "\N{MINUS SIGN}12.25°", "+39.26 turns", "0°"]

    def test_poles(self) -> None:
        """Where the axis passes a pole, azimuth and spin jump: no line joins them."""
        panels = draw_angles(self.compute("kapitza")).axes
        for axes in (panels[0], panels[2]):
            degrees = axes.lines[0].get_ydata()
            assert np.nanmax(degrees) - np.nanmin(degrees) > 170
            assert np.nanmax(np.abs(np.diff(degrees))) < 45
        turning = draw_angles(self.compute("slow_top")).axes[0].lines[0].get_ydata()
        assert np.isfinite(turning).all()

    def test_trace(self) -> None:
        """Points of the sphere are seen at their distance; the path is all drawn, in two parts."""
        points = sphere.on_sphere(np.linspace(0, 3, 50), np.linspace(0, 9, 50))
        seen = sphere.project(*points)
        np.testing.assert_allclose(sum(part**2 for part in seen), 1)
        front = sphere.project(*sphere.on_sphere(np.array([np.pi / 2]), np.array([0.0])))
        assert front[2][0] > 0
        table = self.compute("tip_wave")
        theta, phi = (table.rows[name].to_numpy() for name in ("theta", "phi"))
        x, _, _ = sphere.project(*sphere.on_sphere(theta, phi))
        lines = sphere.draw_trace(table).axes[0].lines
        whole = [line for line in lines if len(line.get_xdata()) == len(x)]
        drawn = np.array([line.get_xdata() for line in whole])
        assert len(whole) == 2
        np.testing.assert_array_equal(np.nanmax(drawn, axis=0), x)

    def test_cones(self) -> None:
        """In steady precession the angular velocity turns about the vertical with the axis."""
        table = self.compute("regular_precession")
        rows = table.rows
        _, (x, y, z), _ = sphere.in_body_and_space(table)
        np.testing.assert_allclose(z, rows["phi_rate"] + rows["psi_rate"] * np.cos(rows["theta"]))
        np.testing.assert_allclose(np.hypot(x, y), rows["psi_rate"][0] * np.sin(rows["theta"][0]))
        phi = np.arctan2(np.sin(rows["phi"]), np.cos(rows["phi"]))
        np.testing.assert_allclose(np.arctan2(x, -y), phi, atol=1e-9)

    def test_rolling(self) -> None:
        """The cones touch at the start, and roll: their curves have one speed there."""
        table = self.compute("separatrix")
        body, space, at_start = sphere.in_body_and_space(table)
        np.testing.assert_allclose(at_start[:, 0], space[:, 0], atol=1e-12)
        paths = (sphere.directions(omega)[:, :20] for omega in (body, space))
        lengths = [np.linalg.norm(np.diff(path, axis=1), axis=0).sum() for path in paths]
        self.assertAlmostEqual(lengths[0] / lengths[1], 1, 2)
        assert len(sphere.draw_cones(table).axes) == 4

    def test_drift(self) -> None:
        """The running maximum rises, and ends at the largest error."""
        settings = ["span.nutations=40", "span.samples=41"]
        table = self.compute("long_drift", *settings)
        assert method_of(table) == ("taylor", "space_frame")
        t, off = running_maximum(table, "energy_error")
        assert (np.diff(off) >= 0).all()
        assert (len(t), off[-1]) == (40, table.rows["energy_error"].abs().max())
        _, off = running_maximum(table, "lz")
        assert off[-1] == (table.rows["lz"] - table.rows["lz"][0]).abs().max()

    def test_script(self) -> None:
        """They are files of their own; each table has to have what they ask for."""
        paths = []
        for method in ("taylor", "dop853"):
            few = ("span.nutations=9", "span.samples=10")
            table = self.compute("long_drift", *few, f"integration.method={method}")
            paths.append(table.path.rename(self.folder / f"{method}.csv"))
        motion = self.put("motion.csv", a_trajectory())
        for name, tables in (("drift", paths), ("traces", [motion, motion])):
            folder = self.folder / name
            assert self.call("--together", name, "-o", folder, *tables) == ""
            self.check_pictures(folder, {name})
        sweep = self.put("sweep.csv", a_sweep())
        exact = self.put("exact.csv", a_trajectory([*TRAJECTORY, "energy_error"], energy_error=0.0))
        for name, tables, reason in (
            ("traces", (motion, sweep), "sweep.csv: is no table of the kind trajectory: no traces"),
            ("drift", (motion,), "no column energy_error"),
            ("drift", (exact,), "no error of the energy above zero"),
            ("traces", (self.folder / "none.csv",), "no such file"),
        ):
            assert reason in self.call("--together", name, *tables, code=2)

    def test_names(self) -> None:
        names = [kind.name for kind in (*FIGURES, *COMPARISONS)]
        assert len(names) == len(set(names))

    def test_own_units(self) -> None:
        """They have the figures of others, which are the same."""
        own = ("t", "phi", "theta", "psi", "com_z")
        other = ("t_ms", "phi_deg", "theta_turns", "psi_mrad", "com_z_mm")
        columns = (f"output.columns={','.join(names)}" for names in (own, other))
        tables = [self.compute("slow_top", setting) for setting in columns]
        assert list(tables[1].rows) == list(other)
        assert tables[1].units["theta_turns"] == "turns"
        drawn = []
        for table in tables:
            kinds, problems = choose_figures(table)
            assert problems == []
            assert "angles" in [kind.name for kind in kinds]
            lines = draw(table, "angles").axes[0].lines
            drawn.append(np.concatenate([line.get_xydata() for line in lines]))
        np.testing.assert_allclose(drawn[1], drawn[0], rtol=1e-12, atol=1e-12)
        shown = in_own_units(tables[1])
        assert shown.units["theta"] == "rad"
        assert in_own_units(tables[0]) is tables[0]
        assert in_own_units(shown) is shown
        assert motion_refusal(shown) == ""

    def test_degrees(self) -> None:
        """Angles are in degrees; the band is twice the size; values have their intervals."""
        self.compute("fit")
        table = read_table(self.folder / "fit.residuals.csv")
        *panels, side = draw_fit(table).axes
        for place, name in enumerate(("phi", "theta", "psi")):
            above, below = panels[2 * place : 2 * place + 2]
            assert "(degrees)" in above.get_title("left")
            assert below.get_ylabel() == "residual"
            fitted, measured = (line.get_ydata() for line in above.lines)
            np.testing.assert_array_equal(fitted, np.degrees(table.rows[f"{name}_fit"]))
            np.testing.assert_array_equal(measured, np.degrees(table.rows[name]))
            residuals = np.degrees(table.rows[f"{name}_residual"])
            np.testing.assert_allclose(below.lines[-1].get_ydata(), residuals, rtol=1e-14)
            size = np.sqrt(np.mean(residuals**2))
            band = below.patches[0].get_extents().transformed(below.transData.inverted())
            np.testing.assert_allclose(band.y1, 2 * size, rtol=1e-9)
            assert f"root mean square {size:.2g}" in below.get_title("right")
        words = [text.get_text() for text in side.texts]
        values = read_table(self.folder / "fit.csv").rows.set_index("parameter")
        row = values.loc["initial.psi_rate"]
        assert f"{row.estimate:.4f} rad/s" in words
        assert f"95 %: {row.lower:.4f} to {row.upper:.4f}" in words

    def test_units(self) -> None:
        """Powers of units are raised, in headings too."""
        self.compute("mounted_sensor")
        table = read_table(self.folder / "mounted_sensor.residuals.csv")
        figure = draw_fit(table)
        assert "m/s²" in figure.axes[-2].get_title("right")
        self.assert_good_look(table, "fit")
        lay_out(figure)
        edges = [axes.get_position().x0 for axes in figure.axes[:-1]]
        assert len({round(edge, 6) for edge in edges}) == (2 if len(edges) >= 8 else 1)

    def test_alone(self) -> None:
        """Without the table of the parameters there are no values, and the rest is drawn."""
        self.compute("fit")
        table = read_table((self.folder / "fit.residuals.csv").rename(self.folder / "other.csv"))
        assert list(draw_fit(table).axes[-1].texts) == []

    def test_outliers(self) -> None:
        """Few wrong readings are marked at the edge, and do not set the scale."""
        self.compute("inclinometer")
        below = draw_fit(read_table(self.folder / "inclinometer.residuals.csv")).axes[1]
        assert "without 3 outliers" in below.get_title("right")
        assert below.get_ylim()[1] < 3
        values = pd.DataFrame(
            {"parameter": ["top.damping(3)"], "unit": ["N m s"], "estimate": [3.002e-6],
             "lower": [2.99e-6], "upper": [3.014e-6]}
        )  # fmt: skip
        words = [line for line, _ in tell_values(values)]
        assert words[1:3] == ["3.002\N{MULTIPLICATION SIGN}10⁻⁶ N m s", "95 %: 2.990 to 3.014"]

    def test_motion(self) -> None:
        """It sleeps, wakes, sinks below the pivot and comes to rest, with a balanced account."""
        table = self.compute("friction_to_rest")
        rows = table.rows
        assert "account" in [kind.name for kind in choose_figures(table)[0]]
        assert rows["energy_error"].abs().max() < 1e-9
        early, late = rows[rows["t"] < 10], rows[rows["t"] > 120]
        assert early["theta"].max() < np.radians(5)
        assert rows["theta"].max() > np.radians(150)
        assert late["kinetic"].abs().max() == 0
        assert late["omega3"].abs().max() == 0
        spent = rows["energy"].iloc[0] - rows["energy"].iloc[-1]
        self.assertAlmostEqual(-rows["work"].iloc[-1] / spent, 1, 10)

    def test_lines(self) -> None:
        """The panels show the columns; energy and what was taken add up to that of the start."""
        settings = ("span.samples=601", "output.columns=all", "effects.drag_force=0")
        table = self.compute("friction_to_rest", *settings)
        theta, spin, energy, error = draw_account(table).axes
        words = [text.get_text() for text in energy.get_legend().get_texts()]
        for name in ("taken by friction", "taken by drag"):
            assert name in words
        assert "taken by vibration" not in words
        top = max(area.get_paths()[0].vertices[:, 1].max() for area in energy.collections)
        self.assertAlmostEqual(top, table.rows["energy"].iloc[0], 9)
        lowest = energy.collections[-1].get_paths()[0].vertices[:, 1].min()
        assert lowest > table.rows["energy"].iloc[-1]
        np.testing.assert_allclose(theta.lines[0].get_ydata(), np.degrees(table.rows["theta"]))
        np.testing.assert_array_equal(spin.lines[-1].get_ydata(), table.rows["omega3"])
        shown = {line.get_label(): line.get_ydata() for line in energy.lines}
        np.testing.assert_array_equal(shown["energy"], table.rows["energy"])
        np.testing.assert_array_equal(shown["potential energy"], table.rows["potential"])
        largest = max(np.nanmax(line.get_ydata()) for line in error.lines[:1])
        assert largest == table.rows["energy_error"].abs().max()

    def test_works(self) -> None:
        """Where an effect gives energy, works are lines that differ, with a legend above."""
        effects = ("effects.torque_body=0,0,0.05", "effects.drag_moment=1e-6,1e-6,1e-6")
        table = self.compute("damped_top", *effects, "span.samples=101", "output.columns=all")
        energy = draw_account(table).axes[2]
        shown = {line.get_label(): line for line in energy.lines}
        for name in ("torques", "damping", "drag"):
            work = shown[f"work of {name}"].get_ydata()
            np.testing.assert_array_equal(work, table.rows[f"work_{name.removesuffix('s')}"])
        np.testing.assert_array_equal(shown["energy"].get_ydata(), table.rows["energy"])
        named = [shown[text.get_text()] for text in energy.get_legend().get_texts()]
        assert len({(line.get_color(), line.get_linestyle()) for line in named}) == 5
        self.assert_good_look(table, "account")

    def test_other_tables(self) -> None:
        kind = next(kind for kind in FIGURES if kind.name == "account")
        assert "has no column" in kind.refusal(self.read(a_trajectory()))
