"""The reference set: its files agree, its numbers are true, and its checkers find what is wrong."""

import datetime
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parent.parent
REFERENCE = TESTS.parent / "reference"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]
sys.path.append(str(REFERENCE))

from check import angles, check, order, read, turned  # noqa: E402
from program_test import IS_OPTIMISED, ProgramCase  # noqa: E402
from referencing.reference_set import main  # noqa: E402

INDEX = json.loads((REFERENCE / "index.json").read_text(encoding="utf-8"))
NAMES = sorted(INDEX["motions"])
QUICK = [
    *("bobylev_steklov", "constant_torque", "euler_equations", "free_asymmetric", "free_symmetric"),
    *("free_principal", "free_intermediate", "free_sphere", "free_small"),
    *("free_tensor", "hess", "motor", "separatrix", "slow_top", "staude", "tumbling_brick"),
]
"""Motions that are computed again in a second."""
LARGEST = 1_500_000
MISSING = "this build has no FLINT"


def slack_of(body: dict) -> float:
    """Whether a body can exist, as engines check it: relative, negative if it cannot."""
    centre = np.array(body["centre_of_mass"])
    about = centre @ centre * np.eye(3) - np.outer(centre, centre)
    moments = np.linalg.eigvalsh(np.array(body["inertia"]) - body["mass"] * about)
    return float(min(moments[0], moments[0] + moments[1] - moments[2]) / moments[2])


class ReferenceSetTest(ProgramCase):
    """The files of the set."""

    def test_files_agree(self) -> None:
        """Each input has its motion; versions, licences, starts and rotations agree."""
        for folder, ending in (("inputs", ".nml"), ("motions", ".json"), ("motions", ".csv")):
            found = sorted(path.stem for path in (REFERENCE / folder).glob(f"*{ending}"))
            self.assertEqual(found, NAMES)
        self.assertGreaterEqual(len(NAMES), 40)
        size = sum(path.stat().st_size for path in REFERENCE.rglob("*") if path.is_file())
        self.assertLess(size, LARGEST)
        for name in NAMES:
            with self.subTest(name):
                data, columns = read(name)
                self.assertEqual((data["version"], data["licence"]), (INDEX["version"], "CC0-1.0"))
                self.assertEqual(list(columns), list(data["columns"]))
                q = np.stack([columns[f"q{i}"] for i in range(4)], 1)
                omega = np.stack([columns[f"omega{i}"] for i in (1, 2, 3)], 1)
                space = np.stack([columns[f"omega_{x}"] for x in "xyz"], 1)
                matrix = np.stack([columns[f"r{i}{j}"] for i in "123" for j in "123"], 1)
                scale = 1 + np.abs(omega).max()
                self.assertLess(np.abs(np.linalg.norm(q, axis=1) - 1).max(), 1e-13)
                self.assertLess(np.abs(turned(q, omega) - space).max(), 1e-13 * scale)
                by_matrix = np.einsum("nij,nj->ni", matrix.reshape(-1, 3, 3), omega)
                self.assertLess(np.abs(by_matrix - space).max(), 1e-13 * scale)
                self.assertEqual(q[0].tolist(), data["start"]["quaternion"])
                given = (REFERENCE / "inputs" / f"{name}.nml").read_text(encoding="utf-8")
                self.assertEqual("theta" in data["start"], "theta =" in given)
                self.assertGreater(slack_of(data["body"]), -1e-14)
                self.assertTrue(np.array_equal(columns["q0"], columns["q4"]))
                self.assertLess(data["errors"]["attitude"]["value"], 1e-13)

    def test_numbers_are_true(self) -> None:
        """The program verifies every table, and proves attitudes and omega where it can."""
        tables = [REFERENCE / "motions" / f"{name}.csv" for name in NAMES]
        run = self.run_program("verify", *tables)
        if MISSING in run.stderr:
            self.skipTest(MISSING)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        for name, table in zip(NAMES, tables, strict=True):
            if INDEX["motions"][name]["attitude"]["kind"] == "proved":
                self.assertEqual(read(name)[0]["errors"]["omega"]["kind"], "proved")
                count = 7 * len(read(name)[1]["t"])
                words = f"{table}: {count} numbers proved, 0 unproved, 0 wrong"
                self.assertIn(words, run.stdout)

    def test_a_changed_digit_is_found(self) -> None:
        """By the checker, and by the program: the last digit of any number."""
        for ending in ("csv", "json"):
            shutil.copy(REFERENCE / "motions" / f"cusp.{ending}", self.folder)
        path = self.folder / "cusp.csv"
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        row = next(i for i, line in enumerate(lines) if line.startswith("t,")) + 7
        cells = lines[row].split(",")
        cells[20] = cells[20][:-1] + str((int(cells[20][-1]) + 1) % 10)
        lines[row] = ",".join(cells)
        path.write_text("".join(lines), encoding="utf-8")
        with self.assertRaisesRegex(ValueError, "was changed"):
            read(self.folder / "cusp.json")
        run = self.run_program("verify", path)
        self.assertNotEqual(run.returncode, 0)

    @unittest.skipUnless(IS_OPTIMISED, "takes long with run-time checks")
    def test_motions_come_out_again(self) -> None:
        """Two of them, others every day, with all digits."""
        check = self.run_program("--check", self.scene("certified_top"))
        if MISSING in check.stderr:
            self.skipTest(MISSING)
        day = 2 * datetime.date.today().toordinal()
        chosen = [QUICK[(day + i) % len(QUICK)] for i in (0, 1)]
        self.assertEqual(main(["--check", *chosen]), 0, chosen)
        self.assertEqual(main(["--check", "no_motion"]), 1)
        self.assertEqual(main(["--verify"]), 2)

    def test_inherent_errors(self) -> None:
        """Those of the set are those of the program, found by other displacements."""
        scene = REFERENCE / "inputs" / "slow_top.nml"
        table = self.compute(scene, "output.columns=t,inherent_error")
        own = read("slow_top")[1]["inherent_error"]
        ratio = np.array(table.column("inherent_error"))[5:] / own[5:]
        self.assertLess(np.abs(np.log(ratio)).max(), 1)


class CheckerTest(unittest.TestCase):
    """The checker in Python, on trajectories whose errors are known."""

    def setUp(self) -> None:
        self.columns = read("free_asymmetric")[1]
        self.t = self.columns["t"]
        self.q = np.stack([self.columns[f"q{i}"] for i in range(4)], 1)
        self.body = np.stack([self.columns[f"omega{i}"] for i in (1, 2, 3)], 1)
        self.space = np.stack([self.columns[f"omega_{x}"] for x in "xyz"], 1)

    def test_conventions_are_found(self) -> None:
        """All of them, with signs of quaternions that jump."""
        for scalar in ("first", "last"):
            for direction in ("body to space", "space to body"):
                for frame, omega in (("body", self.body), ("space", self.space)):
                    for sign in ("plus", "minus"):
                        q = self.q * (1 if direction == "body to space" else [1, -1, -1, -1])
                        q = q if scalar == "first" else np.roll(q, -1, axis=1)
                        q = q * np.where(np.arange(len(q)) % 3, 1, -2)[:, None]
                        found = check(
                            self.t,
                            q,
                            omega * (1 if sign == "plus" else -1),
                            motion="free_asymmetric",
                        )
                        names = [found[key] for key in ("scalar", "direction", "frame", "sign")]
                        self.assertEqual(names, [scalar, direction, frame, sign])
                        self.assertLess(found["attitude_error"], 1e-14)
                        self.assertLess(found["omega_error"], 1e-13)
                        self.assertLess(found["energy_change"], 1e-14)
                        self.assertLess(found["momentum_change"], 1e-14)

    def test_errors_are_measured(self) -> None:
        """A rotation by 1e-5 rad, an angular velocity that is 1e-6 too large."""
        turn = np.array([np.cos(5e-6), 0, np.sin(5e-6), 0])
        w, x, y, z = self.q.T
        turned_by = np.stack(
            [
                w * turn[0] - y * turn[2],
                x * turn[0] - z * turn[2],
                y * turn[0] + w * turn[2],
                z * turn[0] + x * turn[2],
            ],
            1,
        )
        self.assertTrue(np.allclose(angles(turned_by, self.q), 1e-5, rtol=1e-9))
        found = check(
            self.t[::2], turned_by[::2], self.body[::2] * (1 + 1e-6), motion="free_asymmetric"
        )
        self.assertAlmostEqual(found["attitude_error"], 1e-5, delta=1e-11)
        largest = np.linalg.norm(self.body[::2], axis=1).max()
        self.assertAlmostEqual(found["omega_error"], 1e-6 * largest, delta=1e-12)
        self.assertAlmostEqual(found["energy_change"], 2e-6, delta=1e-8)
        self.assertLess(found["attitude_floor"], 1e-14)
        self.assertIn("attitude_error     1e-05", str(found))

    def test_named_conventions(self) -> None:
        """A convention that is named is taken, right or wrong."""
        found = check(self.t, self.q, motion="free_asymmetric", direction="space to body")
        self.assertEqual(found["direction"], "space to body")
        self.assertGreater(found["attitude_error"], 0.1)
        with self.assertRaisesRegex(ValueError, "'middle' is not one of"):
            check(self.t, self.q, motion="free_asymmetric", scalar="middle")

    def test_what_is_refused(self) -> None:
        """Shapes, and times that the reference does not have."""
        with self.assertRaisesRegex(ValueError, "four numbers"):
            check(self.t, self.q[:, :3], motion="free_asymmetric")
        with self.assertRaisesRegex(ValueError, "three numbers"):
            check(self.t, self.q, self.body[1:], motion="free_asymmetric")
        with self.assertRaisesRegex(ValueError, "fewer than two of the times"):
            check(self.t + 0.01, self.q, motion="free_asymmetric")

    def test_order(self) -> None:
        """The slope of a power."""
        self.assertAlmostEqual(order([0.1, 0.05, 0.025], [3e-3, 3e-3 / 16, 3e-3 / 256]), 4)


class OtherLanguagesTest(ProgramCase):
    """The checkers in C++ and JavaScript find what that in Python finds."""

    def numbers_of(self, *command: str) -> dict[str, str]:
        """What a command prints: a name and a value per line."""
        run = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = run.stdout.replace("order of convergence", "order").splitlines()
        return {line.split()[0]: " ".join(line.split()[1:]) for line in lines if line}

    def compare(self, found: dict[str, str]) -> None:
        """The lines of the example, which differ by rounding errors only."""
        for name, value in self.numbers_of(sys.executable, str(REFERENCE / "example.py")).items():
            if name == "motion":
                continue
            with self.subTest(name):
                if value[0].isdigit():
                    self.assertAlmostEqual(float(found[name]) / float(value), 1, delta=0.05)
                else:
                    self.assertEqual(found[name], value)

    @unittest.skipUnless(IS_OPTIMISED, "does not use the program under test")
    @unittest.skipUnless(shutil.which("g++"), "no g++")
    def test_cpp(self) -> None:
        """Compiled without a warning."""
        example = str(REFERENCE / "example.cpp")
        warnings = ["-std=c++11", "-Wall", "-Wextra", "-pedantic", "-Werror"]
        subprocess.run(
            ["g++", *warnings, "-O1", "-o", self.folder / "example", example], check=True
        )
        self.compare(self.numbers_of(str(self.folder / "example"), str(REFERENCE / "motions")))

    @unittest.skipUnless(IS_OPTIMISED, "does not use the program under test")
    @unittest.skipUnless(shutil.which("node"), "no node")
    def test_javascript(self) -> None:
        self.compare(self.numbers_of("node", str(REFERENCE / "example.mjs")))


if __name__ == "__main__":
    unittest.main()
