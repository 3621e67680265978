"""Motions as files of other programs, read by those where they are installed."""

import json
import struct
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np
import pytest

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "python")]

import spintop  # noqa: E402

subprocess.run([TESTS.parent / "scripts/install", "--library"], check=True, capture_output=True)

COLUMNS = ["q0", "q1", "q2", "q3", "omega1", "omega2", "omega3", "com_x", "com_y", "com_z"]
TIMES = np.linspace(0, 2, 21)


@pytest.mark.usefixtures("folder")
class ExportsTest(unittest.TestCase):
    """One motion in each format."""

    folder: Path

    def setUp(self) -> None:
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
        self.motion = spintop.Top(body, theta_deg=50, omega3=30).exact(TIMES, COLUMNS)
        self.q = np.stack([self.motion[f"q{i}"] for i in range(4)], 1)

    def export(self, name: str) -> Path:
        """Write the motion."""
        path = spintop.export(self.motion, self.folder / name, TIMES)
        self.assertEqual(path, self.folder / name)
        return path

    def test_tum(self) -> None:
        """All digits: time, centre of mass, quaternion with the scalar last."""
        rows = np.loadtxt(self.export("top.tum"))
        place = np.stack([self.motion[f"com_{x}"] for x in "xyz"], 1)
        wanted = np.hstack([TIMES[:, None], place, np.roll(self.q, -1, axis=1)])
        self.assertTrue(np.array_equal(rows, wanted))

    def test_tum_by_evo(self) -> None:
        """evo reads it, and turns body axes into space axes by it."""
        file_interface = pytest.importorskip("evo.tools.file_interface")
        path = file_interface.read_tum_trajectory_file(str(self.export("top.tum")))
        self.assertTrue(np.array_equal(path.timestamps, TIMES))
        axis = np.array([matrix[:3, 2] for matrix in path.poses_se3])
        self.assertLess(np.abs(axis * 0.75**0.5 - path.positions_xyz).max(), 1e-14)

    def test_msopck(self) -> None:
        """The conjugate quaternion, scalar first, and omega in body axes."""
        rows = np.loadtxt(self.export("top.msopck"))
        self.assertTrue(np.array_equal(rows[:, 1:5], self.q * [1, -1, -1, -1]))
        self.assertTrue(np.array_equal(rows[:, 5], self.motion.omega1))

    def test_msopck_by_spice(self) -> None:
        """The matrix of SPICE turns space axes into body axes: the vertical is gamma."""
        spice = pytest.importorskip("spiceypy")
        rows = np.loadtxt(self.export("top.msopck"))
        for row, (w, x, y, z) in zip(rows, self.q, strict=True):
            gamma = [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]
            self.assertLess(np.abs(spice.q2m(row[1:5]) @ [0, 0, 1] - gamma).max(), 1e-14)

    def test_glb(self) -> None:
        """A node whose rotations are those of the motion, in single precision."""
        data = self.export("top.glb").read_bytes()
        magic, version, size = struct.unpack_from("<4sII", data)
        self.assertEqual((magic, version, size), (b"glTF", 2, len(data)))
        length = struct.unpack_from("<I", data, 12)[0]
        scene = json.loads(data[20 : 20 + length])
        view = scene["bufferViews"][scene["animations"][0]["samplers"][0]["output"]]
        begin = 28 + length + view["byteOffset"]
        turns = np.frombuffer(data[begin : begin + view["byteLength"]], "<f4").reshape(-1, 4)
        self.assertLess(np.abs(turns - np.roll(self.q, -1, axis=1)).max(), 1e-7)
        self.assertEqual(len(data) % 4, 0)

    def test_glb_by_pygltflib(self) -> None:
        """pygltflib reads nodes, channels and times."""
        pygltflib = pytest.importorskip("pygltflib")
        scene = pygltflib.GLTF2().load(str(self.export("top.glb")))
        channel = scene.animations[0].channels[0]
        self.assertEqual(
            (scene.nodes[channel.target.node].name, channel.target.path), ("top", "rotation")
        )
        times = scene.accessors[scene.animations[0].samplers[0].input]
        self.assertEqual((times.count, times.min, times.max), (len(TIMES), [0.0], [2.0]))

    def test_what_is_refused(self) -> None:
        """Another ending, a motion without a quaternion, or without times."""
        for name, motion, words in (
            ("top.obj", self.motion, "the ending is one of .tum, .msopck, .glb"),
            ("top.tum", {"t": TIMES, "theta": TIMES}, "an export needs the column q0"),
            ("top.tum", self.motion, "an export needs the column t"),
            ("top.tum", {**self.motion, "t": TIMES[1:]}, "a number in each column for each time"),
        ):
            with self.assertRaisesRegex(spintop.InputError, words):
                spintop.export(motion, self.folder / name)


if __name__ == "__main__":
    unittest.main()
