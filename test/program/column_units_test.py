"""Columns, measurements and axes in other units: the same numbers, and what says so."""

import itertools
import math
import unittest
from pathlib import Path

import numpy as np

from program_test import ProgramCase, Table

TOP = """\
&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.85 /
&initial theta = 0.6, theta_rate = 0.3, psi_rate = 14 /
"""
SPAN = "&span t_end = 3, samples = 31 /\n"
SIZES = {
    "t_ms": ("t", 1e-3, "ms"),
    "theta_deg": ("theta", math.pi / 180, "deg"),
    "psi_turns": ("psi", 2 * math.pi, "turns"),
    "omega3_rpm": ("omega3", 2 * math.pi / 60, "rpm"),
    "phi_rate_deg": ("phi_rate", math.pi / 180, "deg/s"),
    "com_z_mm": ("com_z", 1e-3, "mm"),
    "lz_mJ": ("lz", 1e-3, "mJ s"),
    "accelerometer1_g0": ("accelerometer1", 9.80665, "g0"),
}
SWEEP = "&study kind = 'sweep' /\n" + TOP.replace(", psi_rate = 14", "") + "&span t_end = 3 /\n"
AXIS = "&sweep parameter(1) = 'initial.psi_rate', from(1) = 10, to(1) = 20, count(1) = 5 /\n"
QUANTITIES = {
    "theta_max_deg": ("theta_max", math.pi / 180, "deg"),
    "nutation_period_ms": ("nutation_period", 1e-3, "ms"),
    "precession_rate_rpm": ("precession_rate", 2 * math.pi / 60, "rpm"),
    "azimuth_after_period_rad": ("azimuth_after_period_deg", 180 / math.pi, "rad"),
}


def chosen(names: object) -> str:
    """A group that names columns."""
    return "&output columns = " + ", ".join(f"'{name}'" for name in names) + " /\n"


class UnitsCase(ProgramCase):
    """Numbers in other units."""

    def check(self, table: Table, sizes: dict[str, tuple[str, float, str]]) -> None:
        """Each column is that in its own unit, divided by the size of the other one."""
        for name, (own, size, unit) in sizes.items():
            with self.subTest(name):
                self.assertTrue(any(f" {name} [{unit}]: " in line for line in table.header))
                expected = np.array(table.column(own)) / size
                np.testing.assert_array_equal(table.column(name), expected)


class ColumnsTest(UnitsCase):
    """Columns of tables."""

    def test_trajectory(self) -> None:
        """By the exact solution, by an integrator, of a table with derivatives."""
        names = [*SIZES, *(own for own, _, _ in SIZES.values())]
        key = "initial.psi_rate"
        derivatives = {f"{name}__{key}": name for name in ("theta_deg", "theta")}
        for columns, setting in itertools.product(
            (names, [*names, *derivatives]), ("exact", "rk4")
        ):
            table = self.compute(
                self.write(TOP + SPAN + chosen(columns)),
                f"integration.method={setting}",
                *(["integration.steps=300"] if setting == "rk4" else []),
            )
            self.check(table, SIZES)
        degrees, radians = (np.array(table.column(name)) for name in derivatives)
        errors = np.array(table.column(f"theta_deg__{key}_error"))
        self.assertTrue((abs(degrees - np.degrees(radians)) <= 2 * errors + 1e-12).all())
        unit = next(line for line in table.header if f"theta_deg__{key} [" in line)
        self.assertIn("[deg/(rad/s)]", unit)

    def test_events(self) -> None:
        """The level of an event, and the columns of its table."""
        table = self.compute(
            self.write(TOP + SPAN + chosen(["t_ms", "t", "theta_deg"])),
            "output.events=theta_deg = 36 rising",
            "span.stop_at=t_ms = 2500",
        )
        self.assertEqual(table.column("t_ms")[-1], 2500)
        events = self.table("scene.events")
        self.assertGreater(len(events.rows), 1)
        for theta in events.column("theta_deg"):
            self.assertAlmostEqual(theta, 36, delta=1e-9)

    def test_sweep(self) -> None:
        """Quantities, those of the list in degrees, derivatives."""
        names = [*QUANTITIES, *(own for own, _, _ in QUANTITIES.values())]
        table = self.compute(self.write(SWEEP + AXIS + chosen(names)))
        self.check(table, QUANTITIES)
        key = "initial.theta"
        names = [f"{name}__{key}" for name in ("theta_max_deg", "theta_max")]
        table = self.compute(self.write(SWEEP + AXIS + chosen(names)))
        degrees, radians = (np.array(table.column(name)) for name in names)
        np.testing.assert_allclose(degrees, np.degrees(radians), rtol=1e-8)

    def test_statistics(self) -> None:
        """With rows, without, and bins whose ends have units."""
        statistics = (
            "&statistics columns = 'theta_max_deg', 'theta_max' over = 'nutation_period_ms'"
        )
        bins = " bins = 3 from = '0.1 s' to = 900 /\n"
        columns = chosen(["theta_max", "theta_max_deg", "nutation_period_ms"])
        found = []
        for text in (columns, "&output rows = 'none' /\n"):
            self.run_program(self.write(SWEEP + AXIS + text + statistics + bins))
            table = self.table("scene.statistics")
            self.assertEqual(table.column("nutation_period_ms_from")[1:], [100, 1100 / 3, 1900 / 3])
            means = [table.column(f"{name}_mean")[0] for name in ("theta_max_deg", "theta_max")]
            self.assertAlmostEqual(means[0], math.degrees(means[1]), delta=1e-12)
            found.append([table.column(name) for name in table.names if "theta" in name])
        np.testing.assert_array_equal(*found)

    def test_beside_all(self) -> None:
        """Columns that `all` does not have may follow; what it has, or nobody, is refused."""
        names = ["all", "theta_deg", "theta__initial.psi_rate"]
        table = self.compute(self.write(TOP + SPAN + chosen(names)))
        for name in ("theta", *names[1:]):
            self.assertIn(name, table.names)
        for name, problem in (("theta", "is named twice"), ("nonsense", "there is no column")):
            scene = self.write(TOP + SPAN + chosen(["all", name]))
            self.assertIn(problem, self.refuse(scene))

    def test_proved_numbers(self) -> None:
        """Bounds and certified numbers are proved in their own units only."""
        for column, settings in (("theta_bound_deg", ()), ("theta_deg", ("output.certified=t",))):
            scene = self.write(TOP + SPAN + chosen(["t", column]))
            overrides = [part for setting in settings for part in ("--set", setting)]
            self.assertIn(
                "is proved in the unit of the column only", self.refuse(scene, *overrides)
            )


class AxesTest(UnitsCase):
    """Axes of sweeps, and overrides."""

    def test_axes(self) -> None:
        """Ends and values with units are those without, wherever the parameter is named."""
        axes = [
            "from(1) = '-60 rpm', to(1) = '600 rpm', count(1) = 12",
            "parameter(1) = 'initial.psi_rate'",
            "parameter(2) = 'initial.phi', values(2,:) = '10 deg', 0.5, '0.25 turn'",
        ]
        table = self.compute(self.write(SWEEP + f"&sweep {' '.join(axes)} /\n"))
        rates = np.linspace(-2 * math.pi, 20 * math.pi, 12)
        np.testing.assert_allclose(table.column("initial.psi_rate")[::3], rates, atol=1e-13)
        values = [math.radians(10), 0.5, math.pi / 2]
        np.testing.assert_allclose(table.column("initial.phi")[:3], values, rtol=1e-15)
        self.assertIn(f"from = {-2 * math.pi!r}", "\n".join(table.header).replace("(1)", ""))

    def test_table_of_cases(self) -> None:
        """The names of its columns may end in units."""
        lines = ["initial.psi_rate_rpm,initial.phi,top.length_cm", "60,0.1,85", "-30,0.2,90"]
        (self.folder / "cases.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        scene = self.write(SWEEP + "&sweep table = 'cases.csv' /\n")
        table = self.compute(scene)
        rates = table.column("initial.psi_rate")
        np.testing.assert_allclose(rates, [2 * math.pi, -math.pi], rtol=1e-15)
        self.assertEqual(table.column("initial.phi"), [0.1, 0.2])
        np.testing.assert_allclose(table.column("top.length"), [0.85, 0.9], rtol=1e-15)
        lines[0] = lines[0].replace("cm", "deg")
        (self.folder / "cases.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        said = " ".join(self.refuse(scene).split())
        self.assertIn("unknown parameter 'top.length_deg'", said)
        self.assertIn("top.length is in m; units are m, cm, mm", said)

    def test_overrides(self) -> None:
        """A number with its unit in an override, with quotes and without."""
        scene = self.write(TOP + SPAN)
        for setting in ("12 rpm", "'12 rpm'", " 72 deg/s ", "12rpm", "1.2e1 rpm"):
            table = self.compute(scene, f"initial.psi_rate={setting}")
            self.assertAlmostEqual(table.column("psi_rate")[0], 0.4 * math.pi, delta=1e-15)
        table = self.compute(scene, "top.inertia=8750 kg cm^2, 0.875, '2500 kg cm^2'")
        self.assertIn("inertia = 0.875, 0.875, 0.25", "\n".join(table.header))
        sweep = self.write(SWEEP + AXIS)
        table = self.compute(sweep, "sweep.from(1)=60 rpm", "sweep.to(1)=20")
        self.assertAlmostEqual(table.column("initial.psi_rate")[0], 2 * math.pi, delta=1e-15)
        # A later number has no unit again.
        table = self.compute(sweep, "sweep.from(1)=60 rpm", "sweep.from(1)=6")
        self.assertEqual(table.column("initial.psi_rate")[0], 6)


class FitTest(UnitsCase):
    """Measurements in other units."""

    FIT = (
        "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'top.inertia(1)', "
        "'initial.psi_rate', 'offset.{0}', from(2) = {1}, to(2) = 15, sigma = {2} /\n"
    )

    def measure(self, names: list[str], noise: dict[str, float]) -> Path:
        """Write measurements with these columns."""
        table = self.compute(self.write(TOP + SPAN + chosen(names), "truth.nml"))
        source = np.random.default_rng(1)
        cells = np.array([[float(cell) for cell in row] for row in table.rows])
        for i, name in enumerate(names):
            cells[:, i] += noise.get(name, 0) * source.normal(size=len(cells))
        path = self.folder / "data.csv"
        lines = [",".join(names), *(",".join(map(repr, row)) for row in cells.tolist())]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return path

    def test_same_fit(self) -> None:
        """Estimates and their errors do not depend on the units; residuals are in those."""
        sizes = (1.0, math.degrees(1))
        found, offsets, residuals = [], [], []
        for names, size, low, sigma in (
            (["t", "theta", "omega1"], sizes[0], "13", "0.001, 0.002"),
            (["t_ms", "theta_deg", "omega1_rpm"], sizes[1], "'130 rpm'", "'1 mrad', '0.002 rad/s'"),
        ):
            turns = 1 if size == 1 else 30 / math.pi
            noise = {names[1]: 1e-3 * size, names[2]: 2e-3 * turns}
            self.measure(names, noise)
            fit = self.FIT.format(names[1], low, sigma)
            if size > 1:
                fit = fit.replace(", sigma", f", columns = '{names[1]}', '{names[2]}', sigma")
            table = self.compute(self.write(TOP.replace("14", "14.1") + fit))
            self.assertEqual(table.texts("unit")[2], "rad" if size == 1 else "deg")
            numbers = np.array([table.column("estimate"), table.column("standard_error")])
            found.append(numbers[:, :2])
            offsets.append(numbers[:, 2] / size)
            rest = self.table("scene.residuals")
            self.assertEqual(rest.names[0], names[0])
            residuals.append(np.array(rest.column(f"{names[1]}_residual")) / size)
            self.assertEqual(len(rest.names), 7)
        np.testing.assert_allclose(found[1], found[0], rtol=1e-6)
        np.testing.assert_allclose(offsets[1], offsets[0], rtol=1e-4)
        np.testing.assert_allclose(residuals[1], residuals[0], atol=1e-9)

    def test_wrapped_and_deviations(self) -> None:
        """Turns of 360 degrees, and a standard deviation in each row."""
        path = self.measure(["t", "psi_deg"], {})
        lines = path.read_text(encoding="utf-8").splitlines()
        rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]
        text = "t,psi_deg,psi_deg_sigma\n"
        text += "".join(f"{t!r},{psi % 360!r},0.1\n" for t, psi in rows)
        path.write_text(text, encoding="utf-8")
        fit = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'initial.psi_rate' /\n"
        start = TOP.replace("14", "14.02") + fit
        self.assertIn("fit.wrapped = 'psi_deg'", self.refuse(self.write(start)))
        for name in ("psi", "psi_deg"):
            table = self.compute(self.write(start.replace("unk", f"wrapped = '{name}', unk")))
            self.assertAlmostEqual(table.column("estimate")[0], 14, delta=1e-8)
        path.write_text(text.replace("psi_deg_s", "psi_s"), encoding="utf-8")
        said = self.refuse(self.write(start))
        self.assertIn("the table has psi_sigma, but no column psi", said)

    def test_mounting(self) -> None:
        """The components of a rotated vector may have units of their own."""
        self.measure(["t", "omega1_deg", "omega2", "omega3_rpm"], {})
        fit = "&study kind = 'fit' /\n&fit data = 'data.csv', mounting = '1 deg', 0, 0\n"
        fit += "    unknown = 'mounting(1)', 'top.inertia(1)' /\n"
        table = self.compute(self.write(TOP.replace("0.875, 0.875", "0.87, 0.87") + fit))
        np.testing.assert_allclose(table.column("estimate"), [0, 0.875], atol=1e-8)

    def test_refusals(self) -> None:
        """Two columns of one quantity, and a unit of another one."""
        fit = "&study kind = 'fit' /\n&fit data = 'data.csv', unknown = 'initial.psi_rate' /\n"
        for head, message in (
            ("t,theta,theta_deg", "column 'theta_deg' is named twice"),
            ("t,t_ms,theta", "two columns of the table are the time"),
            ("t,theta_rpm,psi", "theta is in rad, and can have a suffix"),
            ("t_m,theta,psi", "there is no column t"),
        ):
            rows = "".join(f"{0.1 * i},{1 + 0.1 * i},1.0\n" for i in range(9))
            (self.folder / "data.csv").write_text(f"{head}\n{rows}", encoding="utf-8")
            self.assertIn(message, " ".join(self.refuse(self.write(TOP + fit)).split()))


if __name__ == "__main__":
    unittest.main()
