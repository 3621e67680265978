"""Tests of the axes of a sweep as a user gives them: combinations, drawn values, tables."""

import math
import re
import unittest
from pathlib import Path

from program_test import GOOD, ProgramCase

SWEEP = GOOD.split("&integration")[0] + "&study kind = 'sweep' /\n"
FREE = SWEEP.replace("    psi_rate = 1.0\n", "").replace("    theta = 0.19634954084936207\n", "")
NUTATION = "&output columns = 'theta_min', 'theta_max' /\n"
DRAWN = (
    "cases = 700, parameter(1) = 'initial.theta_deg', from(1) = 10, to(1) = 170,"
    " parameter(2) = 'initial.omega3', from(2) = 1, to(2) = 100, spacing(2) = 'log',"
    " parameter(3) = 'initial.theta_rate', values(3,:) = -1, 1 /\n"
)


class CombinationTest(ProgramCase):
    """Grid, zip, and what is drawn."""

    def test_drawn_sweeps_do_not_depend_on_threads(self) -> None:
        """The same bytes on any number of threads; another seed, other values."""
        for combine in ("random", "latin_hypercube"):
            text = FREE + NUTATION + f"&sweep combine = '{combine}', {DRAWN}"
            scene = self.write(text, f"{combine}.nml")
            contents = []
            for threads in ("1", "2", "5"):
                result = self.run_program(scene, "--threads", threads, "-o", threads)
                self.assertEqual(result.returncode, 0, result.stderr)
                contents.append((self.folder / threads / f"{combine}.csv").read_bytes())
            self.assertEqual(contents[0], contents[1])
            self.assertEqual(contents[0], contents[2])
            table = self.table(combine, "1")
            self.assertEqual(len(table.rows), 700)
            thetas, spins = table.column("initial.theta_deg"), table.column("initial.omega3")
            self.assertTrue(all(10 <= theta <= 170 for theta in thetas))
            self.assertTrue(all(1 <= spin <= 100 for spin in spins))
            # The start is a turning point only without a rate: between both otherwise.
            for row in table.rows:
                theta, low, high = math.radians(float(row[1])), float(row[5]), float(row[6])
                self.assertTrue(low < theta < high)
            other = self.compute(scene, "sweep.seed=2147483646")
            self.assertFalse(set(thetas) & set(other.column("initial.theta_deg")))
            # What a table's header holds draws the same.
            again = self.compute(self.write(table.resolved(), "again.nml"))
            self.assertEqual(again.rows, table.rows)

    def test_shards_of_a_drawn_sweep_are_its_parts(self) -> None:
        """Each computes the values of its own cases; joined they are the whole, byte for byte."""
        text = FREE + NUTATION + "&sweep combine = 'latin_hypercube', " + DRAWN
        scene = self.write(text.replace("cases = 700", "cases = 3000"))
        self.compute(scene)
        parts = []
        for i in (1, 2, 3):
            result = self.run_program(scene, "--shard", f"{i}/3", "-o", "parts")
            self.assertEqual(result.returncode, 0, result.stderr)
            parts.append(self.folder / "parts" / f"scene.{i}-of-3.csv")
        result = self.run_program("merge", "whole.csv", *parts)
        self.assertEqual(result.returncode, 0, result.stderr)
        whole = (self.folder / "whole.csv").read_bytes()
        self.assertEqual(whole, (self.folder / "output/scene.csv").read_bytes())

    def test_a_latin_hypercube_of_one_case(self) -> None:
        """And of a few."""
        for cases in (1, 2, 3):
            scene = self.write(FREE + NUTATION + "&sweep combine = 'latin_hypercube', " + DRAWN)
            table = self.compute(scene, f"sweep.cases={cases}")
            strata = [int((x - 10) / 160 * cases) for x in table.column("initial.theta_deg")]
            self.assertEqual(sorted(strata), list(range(cases)))

    def test_zip(self) -> None:
        """Values side by side; of unequal numbers they are refused by name."""
        text = FREE + NUTATION + "&sweep combine = 'zip', parameter = 'initial.theta',"
        text += " 'initial.omega3', values(1,:) = 0.5, 1, 2, from(2) = 3, to(2) = 5, count(2) = 3 /"
        scene = self.write(text + "\n")
        table = self.compute(scene)
        self.assertEqual(table.column("initial.theta"), [0.5, 1, 2])
        self.assertEqual(table.column("initial.omega3"), [3, 4, 5])
        error = self.refuse(scene, "--set", "sweep.count(2)=4")
        self.assertIn("initial.theta has 3, initial.omega3 has 4", error)
        self.assertIn("scene.nml", error)

    def test_derived_quantities_vary(self) -> None:
        """Steady precession and spans in periods follow the swept parameters, case by case."""
        text = FREE.replace("&initial\n", "&initial steady_precession = 'slow', omega3 = 40\n")
        text += "&output columns = 'theta_min', 'theta_max', 'precession_rate' /\n&sweep"
        text += " parameter(1) = 'initial.theta', values(1,:) = 0.3, 1, 1.5, 2.5 /\n"
        table = self.compute(self.write(text))
        moment, axial, lever = 0.875, 0.25 * 40, 9.81 * 0.8660254037844387
        for theta, low, high, rate in zip(
            *map(table.column, ["initial.theta", "theta_min", "theta_max", "precession_rate"]),
            strict=True,
        ):
            self.assertAlmostEqual(low, theta, delta=1e-7)
            self.assertAlmostEqual(high, theta, delta=1e-7)
            steady = moment * rate**2 * math.cos(theta) - axial * rate + lever
            self.assertAlmostEqual(steady, 0, delta=1e-9)
        span = "&span\n    t_end = 0.5\n/\n"
        start = FREE.replace("&initial\n", "&initial theta = 1, omega3 = 40\n")
        self.assertIn(span, start)
        for name in ("nutations", "precessions"):
            text = start.replace(span, "&span /\n")
            text += "&output columns = 't_end', 'nutation_period', 'precession_period' /\n"
            text += f"&sweep parameter(1) = 'span.{name}', values(1,:) = 0.5, 1, 3 /\n"
            table = self.compute(self.write(text))
            period = table.column(f"{name[:-1]}_period")
            for t_end, factor, unit in zip(table.column("t_end"), (0.5, 1, 3), period, strict=True):
                self.assertAlmostEqual(t_end, factor * unit, delta=1e-14 * t_end)

    def test_method_of_the_header(self) -> None:
        """Where a tolerance is an axis, the header names that of the first case as such."""
        text = SWEEP + "&integration method = 'taylor' /\n&output columns = 'theta_end' /\n"
        text += "&sweep parameter(1) = 'integration.relative_tolerance'"
        text += "  values(1,:) = 1e-6, 1e-9 /\n"
        header = " ".join(self.compute(self.write(text)).header)
        self.assertIn(
            "relative tolerance 1e-06, absolute 1e-12, in the first case;"
            " then that of the column integration.relative_tolerance",
            header,
        )

    def test_whole_numbers(self) -> None:
        """Numbers of steps as an axis: whole, given or drawn."""
        text = SWEEP + "&integration method = 'rk4' /\n&output columns = 'evaluations' /\n"
        text += "&sweep parameter(1) = 'integration.steps', from(1) = 10, to(1) = 1000,"
        scene = self.write(text + " count(1) = 3, spacing(1) = 'log' /\n")
        table = self.compute(scene)
        self.assertEqual(table.column("integration.steps"), [10, 100, 1000])
        start_and_end = 2
        counted = [4 * steps + start_and_end for steps in (10, 100, 1000)]
        self.assertEqual(table.column("evaluations"), counted)
        error = self.refuse(scene, "--set", "sweep.count(1)=4")
        self.assertIn("integration.steps must be a whole number", error)
        scene = self.write(text + " combine = 'random', cases = 50 /\n")
        table = self.compute(scene)
        steps = table.column("integration.steps")
        self.assertTrue(all(step == int(step) for step in steps))
        counted = [4 * step + start_and_end for step in steps]
        self.assertEqual(table.column("evaluations"), counted)

    def test_distributions(self) -> None:
        """Each column has the value of its parameter, whatever the threads and the parts."""
        text = SWEEP.replace("theta = 0.19634954084936207\n", "").replace("psi_rate = 1.0\n", "")
        text += (
            "&output columns = 'theta_end', 'theta_min' /\n&sweep combine = 'COMBINE', cases = 600,"
        )
        text += " parameter = 'initial.quaternion', 'initial.omega3', 'top.mass',"
        text += " distribution = 'sphere',"
        text += " 'normal', 'lognormal', mean(2:3) = 20, 0.1, covariance(2,2) = 4,"
        text += " covariance(3,2) = -0.1, covariance(3,3) = 0.01 /\n"
        for combine in ("random", "latin_hypercube", "sobol", "saltelli"):
            with self.subTest(combine):
                scene = self.write(text.replace("COMBINE", combine), f"{combine}.nml")
                if combine == "saltelli":
                    self.assertIn("need independent axes", self.refuse(scene))
                    plain = scene.read_text(encoding="utf-8").split(", covariance(2,2)")[0]
                    scene.write_text(plain + ", deviation(2:3) = 2, 0.1 /\n", encoding="utf-8")
                table = self.compute(scene)
                parts = [f"initial.quaternion({k})" for k in (1, 2, 3, 4)]
                self.assertEqual(table.names[1:7], [*parts, "initial.omega3", "top.mass"])
                self.assertEqual(len(table.rows), 600)
                whole = (self.folder / "output" / f"{combine}.csv").read_bytes()
                result = self.run_program(scene, "--threads", "1", "--shard", "5/7", "-o", "part")
                self.assertEqual(result.returncode, 0, result.stderr)
                part = (self.folder / "part" / f"{combine}.5-of-7.csv").read_bytes()
                self.assertIn(part.split(b"notes\n")[1].partition(b"# end: ")[0], whole)
                again = self.compute(self.write(table.resolved(), "again.nml"))
                self.assertEqual(again.rows, table.rows)
                # A case by itself, with the values of its columns, moves as in the sweep.
                row = table.rows[417]
                values = [*row[1:7]]
                keys = ["initial.quaternion=" + ",".join(values[:4])]
                keys += [f"initial.omega3={values[4]}", f"top.mass={values[5]}"]
                alone = self.write(
                    text.split("&output")[0].replace("'sweep'", "'trajectory'"), "alone.nml"
                )
                single = self.compute(
                    alone, *keys, "output.columns=t,theta", "integration.method=exact"
                )
                self.assertAlmostEqual(float(single.rows[-1][1]), float(row[8]), delta=1e-9)

    def test_a_first_case_that_cannot_be_computed_is_a_failed_case(self) -> None:
        """The order of the cases does not matter, be there no such body, or no closed form."""
        infeasible = (
            ("top.inertia(3)", (2, 0.3), "top.inertia(3): no body has these moments of inertia"),
            ("top.inertia(2)", (0.7, 0.875), "integration.method: the exact solution exists only"),
        )
        for name, values, reason in infeasible:
            text = SWEEP + NUTATION + "&integration method = 'exact' /\n"
            for order in (values, values[::-1]):
                given = f"parameter = '{name}', values(1,:) = {order[0]}, {order[1]}"
                scene = self.write(text + f"&sweep {given} /\n")
                result = self.run_program(scene)
                self.assertEqual(result.returncode, 3, result.stderr)
                rows = sorted(self.table("scene").rows, key=lambda row: values.index(float(row[1])))
                self.assertEqual([row[2] for row in rows], ["bad_input", "ok"])
                self.assertIn(reason, rows[0][-1])
            self.assertIn(
                reason.split(": ")[1],
                self.refuse(scene, "--set", f"sweep.values(1,:)={values[0]},{values[0]}"),
            )

    def test_draws_out_of_range_are_failed_cases(self) -> None:
        """A normal mass may be negative: its case fails, and says why."""
        text = (
            FREE
            + NUTATION
            + "&sweep combine = 'sobol', seed = 0, cases = 64, parameter = 'top.mass',"
        )
        text += " 'initial.theta', distribution = 'normal', 'sphere', mean = 1, deviation = 0.7 /\n"
        scene = self.write(text)
        result = self.run_program(scene)
        self.assertEqual(result.returncode, 3, result.stderr)
        table = self.table("scene")
        failed = [row for row in table.rows if row[3] == "bad_input"]
        self.assertTrue(0 < len(failed) < 10)
        for row in table.rows:
            self.assertEqual(float(row[1]) <= 0, row[3] == "bad_input")
        self.assertTrue(all(row[-1] == "top.mass must be > 0" for row in failed))
        error = self.refuse(scene, "--set", "sweep.mean=-10")
        self.assertIn(
            "none of the first 64 cases can be computed, the first because top.mass must be > 0",
            error,
        )
        for setting, part in (
            ("sweep.distribution(2)=uniform", "axis 2 has no values"),
            (
                "sweep.distribution(2)=spherical",
                "expected one of: uniform, normal, lognormal, sphere",
            ),
            ("sweep.deviation=0", "deviation(1) is out of range"),
            ("sweep.cases=1e3", "a whole number is written 1000"),
            ("sweep.cases=9007199254740992", "is too large"),
            ("sweep.cases=2000000000000000", "must be in [1, 1e15]"),
            ("sweep.parameter(17)=top.mass", "parameter(16)"),
        ):
            self.assertIn(part, self.refuse(scene, "--set", setting))

    def test_sixteen_axes(self) -> None:
        """As many may be drawn, go side by side or make a grid; no key names one more."""
        keys = [f"top.damping({k})" for k in (1, 2, 3)] + [f"top.inertia({k})" for k in (1, 2, 3)]
        keys += [f"top.centre_of_mass({k})" for k in (1, 2, 3)] + ["top.mass", "top.gravity"]
        keys += [
            "initial.theta",
            "initial.phi",
            "initial.psi",
            "initial.omega3",
            "initial.theta_rate",
        ]
        text = (
            FREE
            + "&output columns = 'theta_end' /\n&sweep cases = 40, combine = 'sobol', parameter = "
        )
        text += ", ".join(f"'{key}'" for key in keys) + ", from = 16*1, to = 16*1.01 /\n"
        text = text.replace("16*1", ", ".join(["1"] * 16), 1).replace(
            "16*1.01", ", ".join(["1.01"] * 16)
        )
        text = text.replace("length", "! length")
        table = self.compute(self.write(text))
        self.assertEqual(table.names[1:17], keys)
        for k in range(1, 17):
            self.assertEqual(len({row[k] for row in table.rows}), 40)
        grid = text.replace("cases = 40, combine = 'sobol'", "count = " + ", ".join(["2"] * 16))
        result = self.run_program("--check", self.write(grid))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("65536 cases", result.stdout)

    def test_more_cases_than_32_bits_count(self) -> None:
        """The last of a million parts of three billion cases, drawn and in a grid."""
        cases = 3_000_000_000
        drawn = FREE + NUTATION + "&sweep combine = 'sobol', " + DRAWN.replace("700", str(cases))
        grid = (
            FREE
            + NUTATION
            + "&sweep parameter = 'initial.theta_deg', 'initial.omega3', 'initial.phi',"
        )
        grid += " from = 10, 1, 0, to = 170, 100, 1, count = 3000, 1000, 1000 /\n"
        for name, text in (("drawn", drawn), ("grid", grid)):
            scene = self.write(text, f"{name}.nml")
            result = self.run_program(scene, "--shard", "1000000/1000000")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"cases {cases - 2999} to {cases} of {cases}", result.stdout)
            table = self.table(f"{name}.1000000-of-1000000")
            numbers = [int(row[0]) for row in table.rows]
            self.assertEqual(numbers, list(range(cases - 2999, cases + 1)))
            if name == "grid":
                self.assertEqual(table.rows[-1][1:4], ["170", "100", "1"])
                self.assertEqual(len({row[2] for row in table.rows}), 3)
            result = self.run_program(scene, "--check")
            self.assertIn(f"{cases} cases: ", result.stdout)

    def test_check_forecasts(self) -> None:
        """The size of the table that is then written, within a tenth; memory and time are named."""
        scene = self.write(
            FREE + NUTATION + "&sweep combine = 'random', " + DRAWN.replace("700", "5000")
        )
        ballast = b"\1" * (500 << 20)  # of this process, which is not the memory of the program
        result = self.run_program(scene, "--check", "--threads", "2")
        del ballast
        self.assertEqual(result.returncode, 0, result.stderr)
        memory = re.search(r"! +memory +about (\S+) MB\n", result.stdout)
        self.assertTrue(memory, result.stdout)
        self.assertLess(float(memory[1]), 400)
        found = re.search(r"! +table +about (\S+) kB, (\S+) bytes per case", result.stdout)
        self.assertTrue(found, result.stdout)
        time = r"! +time +about \S+ \w+ on 2 threads, from (200|4608) cases in \S+ m?s\n"
        self.assertRegex(result.stdout, time)
        self.assertNotIn("a case takes", result.stdout)
        columns = "output.columns=theta_min,lyapunov_exponent,theta_max"
        dear = self.run_program(scene, "--check", "--set", columns).stdout
        self.assertRegex(dear, r"! +columns +with lyapunov_exponent a case takes \S+ times as long")
        self.compute(scene)
        size = (self.folder / "output/scene.csv").stat().st_size
        self.assertAlmostEqual(float(found[1]) * 1000, size, delta=0.1 * size)
        self.assertFalse(list(self.folder.glob("output/*.part")))
        again = self.write(result.stdout, "again.nml")
        self.assertEqual(self.run_program(again, "--check").returncode, 0)

    def test_check_tells_of_the_axes(self) -> None:
        """The number of cases, their combination, the first and the last values."""
        result = self.run_program(self.scene("random_tops"), "--check")
        self.assertIn("4000 cases: a Latin hypercube sample with seed 2012", result.stdout)
        self.assertIn("initial.theta_deg: any value from 5 to 175; first case ", result.stdout)
        result = self.run_program(self.scene("spinning_wheel_sweep"), "--check")
        self.assertIn("20 cases: all combinations", result.stdout)
        self.assertIn("20 listed values; first case 0.1, last case 10\n", result.stdout)


class TableTest(ProgramCase):
    """Cases from a CSV table."""

    SCENE = FREE + NUTATION + "&sweep table = 'data/cases.csv' /\n"

    def rows(self, text: str | bytes, folder: str = "data") -> Path:
        """Write the table; its scene stands beside its folder."""
        (self.folder / folder).mkdir(exist_ok=True)
        path = self.folder / folder / "cases.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def test_a_table_gives_the_cases(self) -> None:
        """Same results as with axes; comments, blanks, quotes and all kinds of line ends."""
        scene = self.write(
            FREE + NUTATION + "&sweep combine = 'zip', parameter = 'initial.theta',"
            " 'top.inertia(3)', values(1,:) = 0.5, 1, values(2,:) = 0.25, 3d-1 /\n"
        )
        expected = self.compute(scene).rows
        scene = self.write(self.SCENE)
        for text in (
            "initial.theta,top.inertia(3)\n0.5,0.25\n1,0.3\n",
            '# some tops\n\n initial.theta , "top.inertia(3)"\r\n\r\n .5,\t0.25\r\n#\n1, "0.3"',
            b'\xef\xbb\xbf"initial.theta",top.inertia(3)\n0.5d0 ,25e-2\n 1.0,.3 \n\n',
        ):
            self.rows(text)
            table = self.compute(scene)
            self.assertEqual(table.names[:3], ["case", "initial.theta", "top.inertia(3)"])
            self.assertEqual(table.rows, expected)

    def test_the_path_is_relative_to_the_input(self) -> None:
        """From wherever the program is called; or absolute."""
        path = self.rows("initial.theta\n0.5\n", "deep")
        self.write(FREE + NUTATION + "&sweep table = 'cases.csv' /\n", "deep/scene.nml")
        self.assertEqual(len(self.compute(Path("deep/scene.nml")).rows), 1)
        table = self.compute(self.write(self.SCENE), f"sweep.table='{path}'")
        self.assertEqual(len(table.rows), 1)

    def test_a_changed_table_is_noticed(self) -> None:
        """The resolved input holds the checksum, and refuses another table."""
        self.rows("initial.theta\n0.5\n")
        table = self.compute(self.write(self.SCENE))
        self.assertRegex(table.resolved(), r"table_checksum = '[0-9A-F]{16}'")
        again = self.write(table.resolved(), "again.nml")
        self.assertEqual(self.compute(again).rows, table.rows)
        self.rows("initial.theta\n0.6\n")
        error = self.refuse(again)
        self.assertIn("the table has changed", error)
        changed = self.compute(self.write(self.SCENE))
        self.assertNotEqual(changed.resolved(), table.resolved())

    def test_bad_tables(self) -> None:
        """Messages with place, error and hint."""
        scene = self.write(self.SCENE)
        good = "initial.theta,top.mass\n0.5,1\n"
        for text, *parts in (
            ("", "the table is empty"),
            ("# nothing\n", "the table is empty"),
            ("initial.theta\n", "cases.csv:1:1: error: the table has no rows"),
            ("initial.thata\n1\n", "cases.csv:1:1: ", "did you mean 'initial.theta'?"),
            ("initial.theta,case\n1,1\n", "cases.csv:1:15: ", "unknown parameter 'case'"),
            ("initial.theta,\n1,1\n", "cases.csv:1:15: ", "a column has no name"),
            ("initial.theta,study.kind\n1,1\n", "cases.csv:1:15: ", "is not a number"),
            ("initial.theta,sweep.seed\n1,1\n", "cases.csv:1:15: ", "cannot vary"),
            ("initial.theta,sensor.offset(1)\n1,1\n", "cases.csv:1:15: ", "cannot vary"),
            ("initial.theta,initial.theta\n1,1\n", "cases.csv:1:15: ", "two columns"),
            (
                "initial.psi,top.inertia_tensor(1,2)\n1,1\n",
                "cases.csv:1:13: ",
                "a comma parts the name",
            ),
            (good + "0.6\n", "cases.csv:3:1: ", "the row ends before top.mass"),
            (good + "0.6,1,2\n", "cases.csv:3:7: ", "more cells than the table has columns"),
            (good + "0.6,\n", "cases.csv:3:5: ", "no value for top.mass"),
            (good + "0.6,nan\n", "cases.csv:3:5: ", "not a number"),
            (good + "#\n\n0.6,  1x\n", "cases.csv:5:7: ", "not a number: 1x"),
            (good + "0.6,-1\n", "cases.csv:3:5: ", "top.mass must be > 0"),
            (good + '0.6,"1\n', "cases.csv:3:5: ", "quotes must be around the whole cell"),
            (good + '0.6,"1"2\n', "cases.csv:3:5: ", "quotes must be around the whole cell"),
            ("initial.theta\n\0\n", "NUL"),
            ("initial.theta,integration.steps\n1,1.5\n", "cases.csv:2:3: ", "whole number"),
        ):
            with self.subTest(text):
                self.rows(text)
                error = self.refuse(scene)
                for part in parts:
                    self.assertIn(part, error)
        self.rows(good + "x,1\n0.5,-1\n")
        self.assertRegex(self.refuse(scene), r"3:1: [\s\S]*4:5: [\s\S]*2 errors")

    def test_a_missing_table_and_cases_given_twice(self) -> None:
        """Shown where the input names the table."""
        scene = self.write(self.SCENE)
        error = self.refuse(scene)
        self.assertRegex(error, r"scene\.nml:\d+:16: error: cannot read .*/data/cases\.csv")
        self.rows("initial.theta\n0.5\n")
        for setting, part in (
            ("sweep.parameter(1)=top.mass", "the cases are given twice"),
            ("sweep.combine=zip", "the rows of the table are the cases"),
            ("sweep.cases=3", "the rows of the table are the cases"),
            ("study.kind=trajectory", "a trajectory has no axes"),
        ):
            self.assertIn(part, self.refuse(scene, "--set", setting))


if __name__ == "__main__":
    unittest.main()
