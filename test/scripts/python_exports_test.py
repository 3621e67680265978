"""Motions as files of other programs."""

import itertools
import json
import struct
import unittest
from pathlib import Path

import numpy as np
import pytest

import python_library  # noqa: F401
import spintop

COLUMNS = ["q0", "q1", "q2", "q3", "omega1", "omega2", "omega3", "com_x", "com_y", "com_z"]
TIMES = np.linspace(0, 2, 21)


@pytest.mark.usefixtures("folder")
class ExportsTest(unittest.TestCase):
    def setUp(self) -> None:
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
        self.motion = spintop.Top(body, theta_deg=50, omega3=30).exact(TIMES, COLUMNS)
        self.q = np.stack([self.motion[f"q{i}"] for i in range(4)], 1)

    def export(self, name: str) -> Path:
        path = spintop.export(self.motion, self.folder / name, TIMES)
        assert path == self.folder / name
        return path

    def test_tum(self) -> None:
        """All digits: time, centre of mass, quaternion with the scalar last."""
        rows = np.loadtxt(self.export("top.tum"))
        place = np.stack([self.motion[f"com_{x}"] for x in "xyz"], 1)
        wanted = np.hstack([TIMES[:, None], place, np.roll(self.q, -1, axis=1)])
        assert np.array_equal(rows, wanted)

    def test_msopck(self) -> None:
        """The conjugate quaternion, scalar first, and omega in body axes."""
        rows = np.loadtxt(self.export("top.msopck"))
        assert np.array_equal(rows[:, 1:5], self.q * [1, -1, -1, -1])
        assert np.array_equal(rows[:, 5], self.motion.omega1)

    def test_glb(self) -> None:
        """A node whose rotations are those of the motion, in single precision."""
        data = self.export("top.glb").read_bytes()
        magic, version, size = struct.unpack_from("<4sII", data)
        assert (magic, version, size) == (b"glTF", 2, len(data))
        length = struct.unpack_from("<I", data, 12)[0]
        scene = json.loads(data[20 : 20 + length])
        (animation,) = scene["animations"]
        target, sampler = animation["channels"][0]["target"], animation["samplers"][0]
        assert (scene["nodes"][target["node"]]["name"], target["path"]) == ("top", "rotation")
        times = scene["accessors"][sampler["input"]]
        assert (times["count"], times["min"], times["max"]) == (len(TIMES), [0.0], [2.0])
        view = scene["bufferViews"][sampler["output"]]
        begin = 28 + length + view["byteOffset"]
        turns = np.frombuffer(data[begin : begin + view["byteLength"]], "<f4").reshape(-1, 4)
        assert np.abs(turns - np.roll(self.q, -1, axis=1)).max() < 1e-7
        assert len(data) % 4 == 0

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

    def test_rows_that_are_refused(self) -> None:
        """Times that do not increase, numbers that are none, half of a vector: in every format."""
        known = {"t": TIMES, **self.motion}
        bad = np.where(np.arange(len(TIMES)) == 3, np.nan, self.motion["q1"])
        rest = {name: values for name, values in known.items() if name != "com_y"}
        for name, (change, words) in itertools.product(
            ("a.tum", "a.msopck", "a.glb"),
            (
                ({**known, "t": TIMES[::-1]}, "row 2: its time is not after"),
                ({**known, "t": np.floor(TIMES * 5)}, "row 2: its time is not after"),
                ({**known, "t": np.where(TIMES > 1, np.nan, TIMES)}, "finite numbers"),
                ({**known, "q1": bad}, "finite numbers"),
                ({**known, **{f"q{i}": 0 * TIMES for i in range(4)}}, "row 1: q0 to q3 are 0"),
                (rest, "needs the column com_y"),
                ({key: values[:0] for key, values in known.items()}, "needs rows"),
            ),
        ):
            with self.subTest(name=name, words=words):
                with self.assertRaisesRegex(spintop.InputError, words):
                    spintop.export(change, self.folder / name)
                assert not (self.folder / name).exists()

    def test_rows_of_a_scene(self) -> None:
        """They are close enough for the turn of the body, and begin at 0 whatever the clock."""
        q = {name: self.motion[name] for name in COLUMNS[:4]}
        path = self.folder / "a.glb"
        with self.assertRaisesRegex(spintop.InputError, "row 2: too far .* columns omega1"):
            spintop.export(q, path, TIMES)
        with self.assertRaisesRegex(spintop.InputError, "row 2: too far .*more rows$"):
            spintop.export(self.motion, path, 2 * TIMES)
        plain = spintop.export(self.motion, path, TIMES).read_bytes()
        assert spintop.export(self.motion, path, TIMES + 2.0**20).read_bytes() == plain
        with self.assertRaisesRegex(spintop.InputError, "row 2: .* in single precision"):
            still = {name: np.full(3, float(name == "q0")) for name in q}
            spintop.export(still, path, [0.0, 1e-60, 1.0])

    def test_sources(self) -> None:
        """A table in a file, a result and columns in other units give the same file."""
        body = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
        span, output = {"t_end": 2.0, "samples": 21}, {"columns": ["t", *COLUMNS]}
        groups = spintop.Top(body, theta_deg=50, omega3=30).input(span=span, output=output)
        result = spintop.run(groups, folder=self.folder)
        other = {"t_ms": 1e3 * result["t"], "com_x_mm": 1e3 * result["com_x"]}
        other |= {name: result[name] for name in COLUMNS if name != "com_x"}
        table = spintop.read(self.folder / "input.csv")
        path = self.folder / "a.tum"
        motions = (result.rows, result, table, other)
        files = [np.loadtxt(spintop.export(motion, path)) for motion in motions]
        for file in files[1:]:
            np.testing.assert_allclose(file, files[0], rtol=1e-15, atol=1e-16)
