"""Bodies that are composed of parts, or given by an inertia tensor, in runs of the program."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]
TOP = ROOT / "input" / "composed_top.nml"


class PartsTest(unittest.TestCase):
    """Trajectories and sweeps of composed bodies."""

    def setUp(self) -> None:
        """Make a folder for inputs and results."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, path: Path, *settings: str) -> subprocess.CompletedProcess:
        """Run the program on an input with settings."""
        options = [f"--set={setting}" for setting in settings]
        return subprocess.run(
            [EXE, path, *options, "-o", self.folder], capture_output=True, text=True, timeout=600
        )

    def rows(self, path: Path, *settings: str) -> list[dict[str, str]]:
        """The rows of the table of an input."""
        result = self.run_program(path, *settings)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = (self.folder / f"{path.stem}.csv").read_text().splitlines()
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def write(self, text: str, name: str = "case") -> Path:
        """An input with this text."""
        path = self.folder / f"{name}.nml"
        path.write_text(text)
        return path

    def test_results_are_in_the_axes_of_the_parts(self) -> None:
        """Euler's equations hold in these axes, in which the body has a product of inertia."""
        columns = "R1,R2,energy,lz,com_x,com_y,com_z,omega1,omega2,omega3"
        rows = self.rows(TOP, f"output.columns={columns}")
        first = {name: float(cell) for name, cell in rows[0].items()}
        for row in rows:
            now = {name: float(cell) for name, cell in row.items()}
            self.assertLess(max(abs(now["R1"]), abs(now["R2"])), 1e-12)
            self.assertAlmostEqual(now["energy"] / first["energy"], 1, places=9)
            self.assertAlmostEqual(now["lz"] / first["lz"], 1, places=9)
            distance = sum(now[f"com_{axis}"] ** 2 for axis in "xyz") ** 0.5
            self.assertAlmostEqual(distance, 0.049776039, places=8)
        self.assertEqual(first["omega3"], 200)

    def test_the_header_is_the_input(self) -> None:
        """The resolved input repeats the groups; run again, it gives the same rows."""
        expected = self.rows(TOP, "span.samples=11")
        head = (self.folder / "composed_top.csv").read_text().splitlines()
        begin = head.index("# input:") + 1
        end = next(i for i in range(begin, len(head)) if not head[i].startswith("#     "))
        text = "\n".join(line[6:] for line in head[begin:end]) + "\n"
        self.assertEqual(text.count("&part"), 4)
        self.assertEqual(self.rows(self.write(text)), expected)

    def test_an_inclined_top_is_exact(self) -> None:
        """A top whose parts are inclined in the body axes has the motion of the upright one."""
        start = (
            "&initial quaternion = 0.6, 0.8, 0, 0  omega = 1, 2, {} /\n"
            "&span t_end = 3 samples = 31 /\n"
            "&output columns = 't', 'com_x', 'com_y', 'com_z', 'lz', 'energy', 'inherent_error' /\n"
        )
        part = (
            "&part shape = 'disc' mass = 2 radius = 0.1 thickness = 0.02 place = {} axis = {} /\n"
        )
        # The axes of the second body are turned about x; vectors and start turn with them.
        upright = self.rows(self.write(part.format("0, 0, 0.5", "0, 0, 1") + start.format(30)))
        text = part.format("0, 0.3, 0.4", "0, 3, 4")
        self.assertIn(
            "principal axes",
            self.run_program(self.write(text + start.format(30)), "span.t_end=0.1").stdout,
        )
        # q = p conj(turn): the turn about x by the angle whose sine is 0.6.
        half_sine, half_cosine = 0.1**0.5, 0.9**0.5
        scalar = 0.6 * half_cosine - 0.8 * half_sine
        vector = 0.8 * half_cosine + 0.6 * half_sine
        omega = f"1, {2 * 0.8 + 30 * 0.6}, {-2 * 0.6 + 30 * 0.8}"
        start = start.replace("0.6, 0.8, 0, 0", f"{scalar}, {vector}, 0, 0").replace(
            "1, 2, {}", omega
        )
        inclined = self.rows(self.write(text + start))
        for one, other in zip(upright, inclined, strict=True):
            for name in one:
                self.assertAlmostEqual(float(one[name]), float(other[name]), places=11, msg=name)

    def test_parts_are_swept(self) -> None:
        """A number of a part is an axis, by its place in the list of parts."""
        text = TOP.read_text().replace("kind = 'trajectory'", "kind = 'sweep'")
        text = text.replace("samples = 2001", "")
        text += (
            "&sweep parameter(1) = 'part.mass(4)' from(1) = 0.001 to(1) = 0.004 count(1) = 4 /\n"
        )
        rows = self.rows(self.write(text))
        self.assertEqual([row["status"] for row in rows], ["ok"] * 4)
        self.assertEqual(len({row["theta_end"] for row in rows}), 4)
        alone = self.rows(TOP, "part.mass(4)=0.002", "output.columns=theta")
        self.assertAlmostEqual(float(rows[1]["theta_end"]), float(alone[-1]["theta"]), places=9)

    def test_messages(self) -> None:
        """A wrong part is reported where it is given."""
        text = TOP.read_text()
        for wrong, said in (
            (text.replace("'rod'", "'rode'"), "did you mean 'rod'?"),
            (text.replace("density = 2700", ""), "neither mass nor density of the part is given"),
            (text.replace("thickness = 0.02", ""), "part.thickness(4) is not given"),
            (text.replace("gravity = 9.81", "mass = 1"), "top.mass is not for a body of parts"),
            (text.replace("axis = 1, 0, 0", "axis = 0, 0, 0"), "has no direction"),
        ):
            path = self.write(wrong)
            result = self.run_program(path)
            self.assertEqual(result.returncode, 2)
            self.assertIn(said, result.stderr)
            self.assertRegex(result.stderr, rf"{path}:\d+:\d+: error: ")


if __name__ == "__main__":
    unittest.main()
