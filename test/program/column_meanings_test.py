"""What columns of errors say is true whatever computes them."""

import unittest

from program_test import ProgramCase

TOP = "&top mass = 1.2, inertia = 0.8, 0.8, 0.3, length = 0.6 /\n"
STARTS = {
    "anywhere": "&initial theta = 0.7, phi_rate = 0.3, theta_rate = 0.4, psi_rate = 9 /\n",
    # There rates of angles do not exist, and the exact solution is followed by itself.
    "pole": "&initial theta = 0, omega = 0.8, 0.3, 9 /\n",
}
SPANS = (1.3, 2.9, 4.4, 7.1, 9.2, 12.5)
ROUNDING = 1e-15
"""Of the difference of two energies, each of about five rounded factors."""


class EnergyErrorTest(ProgramCase):
    """`energy_error_max`: the largest error at the ends of steps."""

    def test_the_exact_solution_is_one_step(self) -> None:
        """Its error is that of the end, in vector lanes and by itself."""
        spans = ", ".join(map(str, SPANS))
        for name, start in STARTS.items():
            swept = self.compute(
                self.write(
                    f"{TOP}{start}&study kind = 'sweep' /\n"
                    f"&sweep parameter = 'span.t_end', values(1,:) = {spans} /\n"
                    "&output columns = 'energy_error_max', 'theta_end' /\n"
                )
            ).column("energy_error_max")
            for span, error in zip(SPANS, swept, strict=True):
                moved = self.compute(
                    self.write(
                        f"{TOP}{start}&span t_end = {span}, samples = 2 /\n"
                        "&output columns = 'energy_error' /\n"
                    )
                ).column("energy_error")
                self.assertAlmostEqual(error, abs(moved[-1]), delta=ROUNDING, msg=f"{name} {span}")

    def test_steps_of_fixed_size(self) -> None:
        """The largest over the rows of a trajectory, which are the steps."""
        integration = "&integration method = 'splitting_2', steps = 300 /\n&span t_end = 4 /\n"
        for start in STARTS.values():
            swept = self.compute(
                self.write(
                    f"{TOP}{start}{integration}&study kind = 'sweep' /\n"
                    "&sweep parameter = 'top.gravity', values(1,:) = 9.81 /\n"
                    "&output columns = 'energy_error_max' /\n"
                )
            ).column("energy_error_max")
            moved = self.compute(
                self.write(f"{TOP}{start}{integration}&output columns = 'energy_error' /\n")
            )
            self.assertAlmostEqual(swept[0], moved.largest("energy_error"), delta=1e-14)


class LargestErrorTest(ProgramCase):
    """The largest errors of the stability study."""

    def test_every_step_counts(self) -> None:
        """They are the largest of all steps, where there are no more than a thousand."""
        scene = TOP + STARTS["anywhere"] + "&span t_end = 5 /\n"
        names = ("orientation_error", "tip_error", "energy_error")
        for method, steps in (("splitting_2", 1000), ("rk4", 800), ("gauss_4", 240)):
            study = self.compute(
                self.write(
                    f"{scene}&study kind = 'stability' /\n"
                    f"&stability cases = 'input', methods = '{method}' /\n"
                    f"&integration steps = {steps} /\n"
                )
            )
            columns = ", ".join(f"'{name}'" for name in names)
            moved = self.compute(
                self.write(
                    f"{scene}&integration method = '{method}', steps = {steps} /\n"
                    f"&output columns = {columns} /\n"
                )
            )
            for name in names:
                largest = moved.largest(name)
                self.assertAlmostEqual(
                    study.column(name)[0], largest, delta=1e-6 * largest + 1e-14, msg=method
                )


if __name__ == "__main__":
    unittest.main()
