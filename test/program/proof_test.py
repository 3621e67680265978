"""Bounds in tables, certified numbers, and `spintop verify`."""

import math
import sys
from decimal import Decimal
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "python")]

from program_test import ProgramCase  # noqa: E402
from spintop_figures.tables.table import read_table  # noqa: E402

TOP = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta = 0.19634954084936207, psi_rate = 1.0 /
&span t_end = 3.0, samples = 7 /
&output columns = 't', 'theta', 'phi', 'psi', 'q0', 'q1', 'q2', 'q3' /
"""
SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 30 /
&span t_end = 2.0 /
&output columns = 'theta_end', 'theta_end_bound', 'phi_end', 'psi_end', 'psi_end_bound',
                  'nutation_period', 'proof' /
&sweep parameter(1) = 'initial.psi_rate', values(1,:) = 0, 0.5, 3, 40 /
"""
BOUNDS = "t,theta,theta_bound,phi_bound,psi_bound,q0,q0_bound,orientation_bound,proof"
# A body, what acts on it, and theta at 10 to 40 s by Taylor series of these doubles in 50 digits,
# with rows of the rotation and the momentum as the state.
DRIVEN = """\
&top mass = 1, inertia = 0.9, 0.7, 0.3, centre_of_mass = 0.05, -0.02, 0.4 /
&initial theta = 0.6, omega = 0.5, -1, 2 /
&span t_end = 40, samples = 5 /
&output columns = 't', 'theta', 'theta_bound', 'proof' /
&effects {} /
"""
THETA = {
    "torque_body_amplitude = 0.5, 0, 0, torque_body_rate = 3, torque_body_phase = 0.2, 0, 0": [
        "1.4207695665561021879170685783786",
        "0.66880968277684820094092037723848",
        "1.7237574518898200442376389811842",
        "1.2102770445698153012416777933024",
    ],
    "torque_space_amplitude = 0.5, 0, 0, torque_space_rate = 3, torque_space_phase = 0.2, 0, 0": [
        "0.84955648621729324336698038313323",
        "1.332995943491202432464682744639",
        "2.4122868350365031587388875350818",
        "0.97940123911193994816379146162044",
    ],
    "earth_rate = 0.5, latitude = 0.7": [
        "1.5903865329024774509526303542972",
        "0.77334516002839887602228234456574",
        "2.6203621110271417789874276585952",
        "1.8453306295930141701847082144132",
    ],
}
# A body that turns about its axis under 0.5 cos(3 t + 1): omega3 + 0.5 (sin(4) - sin(1))/(3 I3).
AXIAL = """\
&top mass = 1, inertia = 0.9, 0.7, 0.3, length = 0 /
&initial theta = 0.6, omega3 = 0.88793 /
&span t_end = 1, samples = 2 /
&output columns = 't', 'omega3', 'omega3_bound' /
&effects torque_body_amplitude = 0, 0, 0.5, torque_body_rate = 3, torque_body_phase = 0, 0, 1 /
"""
OMEGA3 = "2.88824541765288390984435771987e-07"
# Friction by a table without a dry part slows the top down.
FRICTION = """\
&study kind = 'trajectory' /
&top mass = 1, inertia = 0.02, 0.02, 0.01, length = 0.1 /
&initial theta_deg = 20, omega3 = 100 /
&effects friction_table = 'friction.csv' /
&span t_end = 2, samples = 3 /
&integration method = 'dop853', relative_tolerance = 1e-12 /
&output columns = 't', 'theta', 'theta_bound', 'omega3', 'omega3_bound', 'proof' /
"""
MISSING = "this build has no FLINT, which certifies digits"


class WithoutFlintTest(ProgramCase):
    """A build without FLINT names what is missing, and computes everything else."""

    def test_missing(self) -> None:
        scene = self.write(TOP)
        run = self.run_program("--check", scene, "--set", f"output.columns={BOUNDS}")
        if run.returncode == 0:
            self.skipTest("this build has FLINT")
        self.assertEqual(run.returncode, 2)
        self.assertIn(f"column 'theta_bound': {MISSING}", run.stderr)
        self.assertIn("SPINTOP_FLINT=1 scripts/run", run.stderr)
        run = self.run_program("--check", scene, "--set", "output.certified=.true.")
        self.assertEqual(run.returncode, 2)
        self.assertIn(MISSING, run.stderr)
        self.compute(scene)
        run = self.run_program("verify", "output/scene.csv")
        self.assertEqual(run.returncode, 2)
        self.assertIn(MISSING, run.stderr)


class ProofTest(ProgramCase):
    """With FLINT."""

    def setUp(self) -> None:
        super().setUp()
        self.top = self.write(TOP)
        check = self.run_program("--check", self.top, "--set", "output.certified=.true.")
        if MISSING in check.stderr:
            self.skipTest("this build has no FLINT")

    def verify(self, *arguments: str, code: int = 0) -> str:
        """The result of `spintop verify` on the table."""
        run = self.run_program("verify", "output/scene.csv", *arguments)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout

    def change(self, name: str, row: int, text: str) -> None:
        """Put another text in a cell of the table."""
        path = self.folder / "output/scene.csv"
        lines = path.read_text().splitlines(keepends=True)
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        cells = lines[first + row].rstrip("\n").split(",")
        cells[lines[first].rstrip("\n").split(",").index(name)] = text
        lines[first + row] = ",".join(cells) + "\n"
        path.write_text("".join(lines))

    def bounds_hold(self, name: str, true: list[str], *settings: str) -> None:
        """The numbers of a column, but for the first, are within their bounds of the true ones."""
        table = self.compute(self.folder / "scene.nml", *settings)
        cells = zip(table.texts(name)[1:], table.texts(f"{name}_bound")[1:], true, strict=True)
        for number, bound, digits in cells:
            error = abs(Decimal(float(number)) - Decimal(digits))
            self.assertLessEqual(error, Decimal(float(bound)))

    def test_phases_and_latitudes_are_data(self) -> None:
        """Their sines and cosines are not rounded before the proof."""
        for effects, digits in THETA.items():
            self.write(DRIVEN.format(effects))
            self.bounds_hold("theta", digits, "output.certified=.true.")
            self.bounds_hold("theta", digits, "integration.method=taylor_quadruple")
        self.write(AXIAL)
        self.bounds_hold("omega3", [OMEGA3], "output.certified=.true.")

    def test_friction_by_a_table_is_not_enclosed(self) -> None:
        """A motion that it slows down is not certified as one that it does not."""
        rows = "omega3,friction_torque\n0,0\n50,0.01\n200,0.05\n"
        (self.folder / "friction.csv").write_text(rows)
        scene = self.write(FRICTION)
        table = self.compute(scene, "output.certified=.true.")
        self.assertEqual(table.texts("proof"), ["unproved"] * 3)
        self.assertEqual({float(bound) for bound in table.texts("omega3_bound")}, {math.inf})
        self.assertLess(float(table.texts("omega3")[2]), 96)
        (self.folder / "output/friction.csv").write_text(rows)
        self.assertIn("0 numbers proved, 6 unproved, 0 wrong", self.verify())
        sweep = FRICTION.replace("trajectory", "sweep").replace(", samples = 3", "")
        sweep = sweep.split("&output")[0] + (
            "&output columns = 'psi_end', 'psi_end_bound', 'proof' certified = .true. /\n"
            "&sweep parameter(1) = 'initial.omega3', values(1,:) = 90, 100 /\n"
        )
        self.assertEqual(self.compute(self.write(sweep)).texts("proof"), ["unproved"] * 2)

    def test_bounds_of_the_exact_solution(self) -> None:
        table = self.compute(self.top, f"output.columns={BOUNDS}")
        self.assertEqual(set(table.texts("proof")), {"proved"})
        for name in ("theta_bound", "phi_bound", "psi_bound", "q0_bound", "orientation_bound"):
            self.assertLess(table.largest(name), 1e-14)
        rows = read_table(self.folder / "output/scene.csv").rows  # as figures see it
        self.assertEqual(set(rows["proof"]), {"proved"})

    def test_bounds_of_a_method(self) -> None:
        """The bound of the attitude is the error that the exact solution finds."""
        table = self.compute(
            self.top,
            "integration.method=dop853",
            "output.columns=t,orientation_error,orientation_bound,proof",
        )
        self.assertEqual(set(table.texts("proof")), {"proved"})
        errors, bounds = table.column("orientation_error"), table.column("orientation_bound")
        self.assertGreater(max(errors), 1e-11)
        for error, bound in zip(errors, bounds, strict=True):
            self.assertAlmostEqual(error, bound, delta=1e-14)

    def test_certified_numbers(self) -> None:
        """The numbers of a method become those of the exact motion, whatever the method."""
        names = ("theta", "phi", "q0", "omega1", "omega2")
        setting = f"output.columns=t,{','.join(f'{name},{name}_bound' for name in names)},proof"
        exact = self.compute(self.top, setting, "output.certified=.true.")
        other = self.compute(
            self.top, setting, "output.certified=.true.", "integration.method=dop853"
        )
        self.assertEqual(exact.rows, other.rows)
        for name in names:
            numbers, bounds = exact.column(name), exact.column(f"{name}_bound")
            for number, bound in zip(numbers, bounds, strict=True):
                self.assertLessEqual(bound, 0.75 * math.ulp(max(abs(number), 2.0**-52)))
        self.assertIn("certified = .true.", exact.resolved())
        self.assertIn("0 unproved, 0 wrong", self.verify("--strict"))

    def test_uncertainty(self) -> None:
        """Radii of the data widen the bounds, about in proportion while they are small."""
        columns = "output.columns=t,theta,theta_bound,orientation_bound,proof"
        narrow = self.compute(self.top, columns, "uncertainty.top.length=1e-12")
        wide = self.compute(self.top, columns, "uncertainty.top.length=1e-10")
        self.assertEqual(set(wide.texts("proof")), {"proved"})
        ratio = wide.largest("orientation_bound") / narrow.largest("orientation_bound")
        self.assertGreater(ratio, 30)
        self.assertLess(ratio, 300)
        self.assertIn("top.length = 1e-10", wide.resolved())
        both = self.compute(self.top, columns, "uncertainty.top.inertia=1e-10,2e-10,1e-10")
        self.assertEqual(set(both.texts("proof")), {"proved"})
        radii = "&uncertainty top.length = 1e-9 top.mass = 1e-9 /\n&span"
        scene = self.write(TOP.replace("&span", radii), "b.nml")
        both = self.compute(scene, columns)
        self.assertGreater(both.largest("theta_bound"), narrow.largest("theta_bound"))

    def test_uncertainty_of_any_body(self) -> None:
        """Radii of a damped body; where they are lost, the summary says when."""
        columns = "output.columns=t,q0,orientation_bound,omega1_bound,proof"
        body = (columns, "top.inertia=0.875,0.8,0.25", "top.damping=0.01,0.01,0.005")
        exact = self.compute(self.top, *body).largest("orientation_bound")
        for radii in (
            "top.damping",
            "top.inertia",
            "initial.phi",
            "top.length",
            "initial.psi_rate",
        ):
            width = "1e-9,1e-9,1e-9" if radii in ("top.damping", "top.inertia") else "1e-9"
            table = self.compute(self.top, *body, f"uncertainty.{radii}={width}")
            self.assertEqual(set(table.texts("proof")), {"proved"})
            self.assertGreater(table.largest("orientation_bound"), exact + 1e-10)
            self.assertLess(table.largest("orientation_bound"), 1e-6)
        lost = [f"--set={word}" for word in (*body, "uncertainty.top.length=1e-4", "span.t_end=60")]
        run = self.run_program(self.top, *lost)
        self.assertRegex(run.stdout, r"unproved \(.*\), the first at t = [1-9]")

    def test_wrong_uncertainty(self) -> None:
        for settings, words in (
            (("uncertainty.top.length=1e-9",), "the table has no bounds"),
            (("uncertainty.top.length=1e-9", "output.certified=.true."), "no certified digits"),
            (("uncertainty.initial.omega3=1", "output.columns=t,q0_bound"), "omega3 is not given"),
            (("uncertainty.top.spin=1", "output.columns=t,q0_bound"), "unknown key"),
            (
                ("uncertainty.initial.omega=1,1,1", "output.columns=t,q0_bound"),
                "omega is not given",
            ),
            (
                ("uncertainty.top.centre_of_mass=1,1,1", "output.columns=t,q0_bound"),
                "top.centre_of_mass is not given",
            ),
            (("uncertainty.top.mass=-1", "output.columns=t,q0_bound"), "uncertainty.top.mass"),
        ):
            overrides = [part for setting in settings for part in ("--set", setting)]
            run = self.run_program("--check", self.top, *overrides)
            self.assertEqual(run.returncode, 2, words)
            self.assertIn(words, run.stderr)

    def test_unproved_rows_say_why(self) -> None:
        run = self.run_program(
            self.top,
            "--set=effects.drag_force=0.1",
            "--set=output.columns=t,theta,theta_bound,proof",
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(set(self.table().texts("proof")), {"unproved"})
        self.assertEqual(set(self.table().texts("theta_bound")), {"inf"})
        self.assertIn("7 unproved (dry friction, drag of the air and tables", run.stdout)

    def test_any_body(self) -> None:
        """Certified digits are those of a series in quadruple precision from the same angles."""
        given = (
            "top.inertia=0.875,0.8,0.25",
            "top.damping=0.01,0.01,0.005",
            "initial.psi_rate=5",
            "span.t_end=18",
            f"output.columns={BOUNDS},phi,psi,omega1,omega1_bound",
        )
        table = self.compute(self.top, *given, "integration.method=taylor_quadruple")
        self.assertEqual(set(table.texts("proof")), {"proved"})
        self.assertLess(table.largest("orientation_bound"), 3e-16)
        self.assertLess(table.largest("psi_bound"), 1e-14)
        self.assertLess(table.largest("omega1_bound"), 1e-14)
        series = table
        self.assertIn("0 wrong", self.verify())
        table = self.compute(self.top, *given, "output.certified=.true.")
        for name in ("theta", "phi", "psi", "q0", "omega1"):
            for certified, other in zip(table.texts(name), series.texts(name), strict=True):
                self.assertAlmostEqual(float(certified), float(other), delta=1e-14)
        self.assertIn("0 unproved, 0 wrong", self.verify("--strict"))
        self.change("psi", 3, repr(float(table.texts("psi")[2]) + 2 * math.pi))
        self.assertIn("first wrong  row 3, psi", self.verify(code=3))

    def test_sweep(self) -> None:
        scene = self.write(SWEEP)
        table = self.compute(scene)
        self.assertEqual(table.texts("status"), ["ok"] * 4)
        self.assertEqual(table.texts("proof"), ["proved"] * 4)
        self.assertLess(table.largest("theta_end_bound"), 1e-12)
        self.assertLess(table.largest("psi_end_bound"), 1e-12)
        self.assertIn("0 wrong", self.verify())
        self.change("theta_end", 3, "0.7")
        self.assertIn("first wrong  row 3, theta_end = 0.7", self.verify(code=3))

    def test_bounds_of_periods_are_refused(self) -> None:
        """Proofs are of a motion at a time; the message says so."""
        for name in ("nutation_period", "precession_per_nutation", "momentum_period"):
            run = self.run_program(
                "--check", self.write(SWEEP), "--set", f"output.columns=theta_end,{name}_bound"
            )
            self.assertEqual(run.returncode, 2)
            self.assertIn(f"column '{name}_bound': proofs bound the attitude and the", run.stderr)
            self.assertIn(f"at a time, not {name}\n", run.stderr)
        self.write(TOP)
        run = self.run_program("--check", self.top, "--set", "output.columns=t,energy_bound")
        self.assertIn("at a time, not energy\n", run.stderr)

    def test_bytes_do_not_depend_on_threads(self) -> None:
        scene = self.write(SWEEP)
        first = self.compute(scene)
        self.assertEqual(self.run_program(scene, "--threads", "2").returncode, 0)
        self.assertEqual(first.rows, self.table().rows)

    def test_verify(self) -> None:
        """A wrong digit is found; the exact solution needs no bounds beside its numbers."""
        self.compute(self.top)
        self.assertIn("49 numbers proved, 0 unproved, 0 wrong", self.verify("--strict"))
        theta = self.table().texts("theta")[4]
        place = 14
        wrong = theta[:place] + str((int(theta[place]) + 5) % 10) + theta[place + 1 :]
        self.change("theta", 5, wrong)
        said = self.verify(code=3)
        self.assertIn("1 wrong", said)
        self.assertIn(f"first wrong  row 5, theta = {wrong}", said)

    def test_verify_without_claims(self) -> None:
        """A method claims nothing: its numbers are unproved, but their errors are bounded."""
        self.compute(self.top, "integration.method=rk4", "integration.steps=60")
        said = self.verify()
        self.assertIn("0 numbers proved, 49 unproved, 0 wrong", said)
        self.assertIn("largest bound  theta ", said)
        self.verify("--strict", code=3)

    def test_what_is_no_table(self) -> None:
        run = self.run_program("verify", self.top)
        self.assertEqual(run.returncode, 2)
        run = self.run_program("verify")
        self.assertIn("verify takes a table", run.stderr)
        run = self.run_program("verify", "--fast", "a.csv")
        self.assertIn("verify takes no option but --strict", run.stderr)
