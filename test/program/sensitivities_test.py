"""Sensitivities: identities of mechanics that they satisfy, their errors, what is refused."""

import math
import unittest

from program_test import ProgramCase

TOP = """\
&top mass = 1.3, inertia = 0.875, 0.875, 0.25, length = 0.85, gravity = 9.7 /
&initial phi = 0.3, theta = 0.6, psi = 0.1, phi_rate = 0.4, theta_rate = 0.2, psi_rate = 14 /
&span t_end = 6.5 /
"""
# No symmetry, damping: integrated.
BODY = """\
&top mass = 1.3, inertia = 0.9, 0.7, 0.3, centre_of_mass = 0.1, 0.05, 0.4, damping = 3*0.02 /
&initial phi = 0.3, theta = 0.6, psi = 0.1, omega = 0.5, 0.3, 4.0 /
&span t_end = 2.5 /
&integration relative_tolerance = 1e-15 /
"""
SWEEP = (
    "&study kind = 'sweep' /\n&sweep parameter = 'integration.max_steps', values(1,:) = 1000000 /\n"
)
ENDS = ("theta_end", "phi_end", "psi_end", "theta_rate_end")
DATA = {
    "top.mass": 1.3,
    "top.inertia(1)": 0.9,
    "top.inertia(2)": 0.7,
    "top.inertia(3)": 0.3,
    "top.gravity": 9.81,
    "top.damping(1)": 0.02,
    "top.damping(2)": 0.02,
    "top.damping(3)": 0.02,
    "initial.omega(1)": 0.5,
    "initial.omega(2)": 0.3,
    "initial.omega(3)": 4.0,
    "span.t_end": 2.5,
}


class SensitivityCase(ProgramCase):
    """Derivatives of the first row of a table."""

    def derivatives(
        self, text: str, columns: list[str], keys: list[str]
    ) -> dict[tuple[str, str], tuple[float, float]]:
        """Each derivative with its error."""
        names = [f"{column}__{key}" for column in columns for key in keys]
        quoted = ", ".join(f"'{name}'" for name in [*columns, *names])
        table = self.compute(self.write(text + f"&output columns = {quoted} /\n"))
        self.values = {column: table.column(column)[-1] for column in columns}
        found = {}
        for column in columns:
            for key in keys:
                pair = [table.column(f"{column}__{key}{end}")[-1] for end in ("", "_error")]
                found[column, key] = (pair[0], pair[1])
        return found

    def agree(self, first: float, second: float, error: float, what: str) -> None:
        """Both agree within the error, which is small."""
        self.assertTrue(math.isfinite(first) and math.isfinite(error), what)
        self.assertLess(error, 1e-6 * max(1, abs(second)), what)
        self.assertAlmostEqual(first, second, delta=error, msg=what)


class IdentityTest(SensitivityCase):
    """Derivatives that are known."""

    def test_the_end_of_a_symmetric_top(self) -> None:
        """Turns of the start about the vertical and the axis; the time; formulas."""
        columns = [*ENDS, "precession_period"]
        keys = ["initial.phi", "initial.psi", "span.t_end", "top.mass", "initial.psi_rate"]
        found = self.derivatives(SWEEP + TOP, columns, keys)
        for column, key, expected in [
            ("phi_end", "initial.phi", 1),
            ("theta_end", "initial.phi", 0),
            ("psi_end", "initial.psi", 1),
            ("theta_end", "initial.psi", 0),
            ("theta_end", "span.t_end", self.values["theta_rate_end"]),
            ("precession_period", "top.mass", -self.values["precession_period"] / 1.3),
            ("precession_period", "initial.psi_rate", 2 * math.pi * 0.25 / (1.3 * 9.7 * 0.85)),
        ]:
            self.agree(found[column, key][0], expected, found[column, key][1], f"{column}__{key}")

    def test_scales_of_mass_and_time(self) -> None:
        """The angles of a body do not depend on the units of mass and of time (Euler's theorem)."""
        found = self.derivatives(SWEEP + BODY, list(ENDS[:3]), list(DATA))
        mass = {key: 1 for key in DATA if key.startswith(("top.mass", "top.i", "top.d"))}
        time = {"top.gravity": -2, "span.t_end": 1}
        time |= {key: -1 for key in DATA if key.startswith(("initial.omega", "top.damping"))}
        for powers in (mass, time):
            for column in ENDS[:3]:
                terms = [power * DATA[key] * found[column, key][0] for key, power in powers.items()]
                error = sum(abs(DATA[key]) * found[column, key][1] for key in powers)
                self.assertGreater(max(map(abs, terms)), 0.1)
                self.agree(sum(terms), 0, error, column)

    def test_each_row_of_a_trajectory(self) -> None:
        """The start does not depend on the body, and the time only on the span."""
        names = ["theta__top.mass", "phi__initial.phi", "t__span.t_end", "theta__span.t_end"]
        quoted = ", ".join(f"'{name}'" for name in ["t", "theta_rate", *names])
        table = self.compute(
            self.write(
                TOP.replace("t_end = 6.5", "t_end = 6.5, samples = 14")
                + f"&output columns = {quoted} /\n"
            )
        )
        self.assertEqual(len(table.rows), 14)
        self.assertEqual(table.column(names[0])[0], 0)
        for i in range(14):
            row = {name: table.column(name)[i] for name in table.names}
            self.agree(row[names[1]], 1, row[names[1] + "_error"], names[1])
            self.agree(row[names[2]], i / 13, row[names[2] + "_error"], names[2])
            self.agree(
                row[names[3]], i / 13 * row["theta_rate"], row[names[3] + "_error"], names[3]
            )

    def test_trajectories_and_sweeps_agree(self) -> None:
        """The last row of a trajectory has the derivatives of the end."""
        keys = ["top.length", "initial.theta_rate"]
        swept = self.derivatives(SWEEP + TOP, ["theta_end"], keys)
        moved = self.derivatives(TOP, ["theta"], keys)
        for key in keys:
            error = swept["theta_end", key][1] + moved["theta", key][1]
            self.agree(swept["theta_end", key][0], moved["theta", key][0], error, key)

    def test_one_side(self) -> None:
        """A top without damping, with respect to damping: the energy changes by its power."""
        text = TOP.replace("gravity", "damping = 0, 0, 0, gravity").replace(
            "t_end = 6.5", "t_end = 1e-3"
        )
        text += "&integration relative_tolerance = 1e-14 /\n"
        found = self.derivatives(text, ["energy"], ["top.damping(3)"])
        omega3 = 14 + 0.4 * math.cos(0.6)
        value, error = found["energy", "top.damping(3)"]
        self.assertAlmostEqual(value, -(omega3**2) * 1e-3, delta=1e-3 * omega3**2 * 1e-2 + error)

    def test_swept_keys(self) -> None:
        """A key may be an axis; the rows do not depend on the number of threads."""
        text = TOP.replace(", psi_rate = 14", "") + (
            "&study kind = 'sweep' /\n"
            "&sweep parameter = 'initial.psi_rate', values(1,:) = 8, 14, 20 /\n"
            "&output columns = 'precession_period__initial.psi_rate', 'theta_end__top.mass' /\n"
        )
        scene = self.write(text)
        table = self.compute(scene)
        for value in table.column("precession_period__initial.psi_rate"):
            self.assertAlmostEqual(value, 2 * math.pi * 0.25 / (1.3 * 9.7 * 0.85), delta=1e-10)
        contents = []
        for threads in ("1", "3"):
            result = self.run_program(scene, "--threads", threads, "-o", threads)
            self.assertEqual(result.returncode, 0, result.stderr)
            contents.append((self.folder / threads / "scene.csv").read_bytes())
        self.assertEqual(*contents)


class MissingTest(SensitivityCase):
    """Where there is no derivative."""

    def test_a_kink_has_a_note(self) -> None:
        """A steady precession with a nutation rate of either sign."""
        text = SWEEP + (
            "&top mass = 1, inertia = 0.8, 0.8, 0.25, length = 0.5, gravity = 8 /\n"
            "&initial theta_deg = 90, phi_rate = 1, theta_rate = 0, omega3 = 16 /\n"
            "&span t_end = 1 /\n"
            "&output columns = 'delta_u__initial.theta_rate', 'phi_end__initial.omega3' /\n"
        )
        table = self.compute(self.write(text))
        self.assertEqual(table.texts("status"), ["ok"])
        self.assertTrue(math.isnan(table.column("delta_u__initial.theta_rate")[0]))
        self.assertTrue(math.isnan(table.column("delta_u__initial.theta_rate_error")[0]))
        self.assertTrue(math.isfinite(table.column("phi_end__initial.omega3")[0]))
        self.assertIn("a derivative does not converge", table.texts("notes")[0])

    def test_refusals(self) -> None:
        """Names that are wrong are refused with their place."""
        for name, message in [
            ("theta_ende__top.mass", "there is no column 'theta_ende'"),
            ("theta_end__top.mas", "top.mas"),
            ("theta_end__top.shape", "is not a number"),
            ("theta_end__span.samples", "span.samples"),
            ("theta_end__integration.step", "integration.step is not a property of the motion"),
            ("theta_end__top.density", "top.density has no value"),
            ("motion_class__top.mass", "column 'motion_class' has no derivatives"),
        ]:
            scene = self.write(SWEEP + TOP + f"&output columns = '{name}' /\n")
            result = self.run_program(scene)
            self.assertEqual(result.returncode, 2, name)
            self.assertIn("scene.nml:", result.stderr)
            self.assertIn(message, result.stderr)
        scene = self.write(SWEEP + TOP + "&output columns = 2*'theta_end__top.mass' /\n")
        self.assertIn("named twice", self.run_program(scene).stderr)


if __name__ == "__main__":
    unittest.main()
