"""Tests of scripts/film."""

import os
import shutil
import subprocess
import unittest
import unittest.mock

import numpy as np
import pytest
from matplotlib.text import Text
from PIL import Image

from conftest import EXE, ROOT, called, execute
from filming import __main__ as command
from filming import encode
from filming.picture import Camera, describe_speed
from filming.solids import surface
from filming.stage import View, project
from filming.take import FINE, FilmError, Part, compute, span_of

pytestmark = pytest.mark.slow

INPUT = ROOT / "input" / "tip_loop.nml"
SIZE = (320, 180)
QUICK = ("--seconds", "0.5", "--rate", "10", "--size", "320x180")
RAW = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-")


def film(*arguments: object, code: int = 0, **changes: str) -> str:
    """What the script complains of, which ends with this code."""
    with unittest.mock.patch.dict(os.environ, changes):
        found, _, complaints = called(command.main, "film", *arguments)
    assert found == code and "Traceback" not in complaints, complaints
    return complaints


def pixels_of(camera: Camera, picture: int) -> np.ndarray:
    camera.show(picture)
    camera.figure.canvas.draw()
    return np.asarray(camera.figure.canvas.buffer_rgba())[:, :, :3].astype(int)


@pytest.mark.usefixtures("folder")
class FilmTest(unittest.TestCase):
    def test_gif(self) -> None:
        """A GIF of so many pictures, which differ; it needs nothing but Pillow."""
        path = self.folder / "a film.gif"
        said = film(INPUT, "-o", path, *QUICK, "--arrow", "momentum", PATH="/nowhere")
        self.assertEqual(said, "")
        with Image.open(path) as image:
            self.assertEqual((image.size, image.n_frames), (SIZE, 5))
            first = np.asarray(image.convert("RGB"), int)
            image.seek(4)
            last = np.asarray(image.convert("RGB"), int)
        self.assertGreater((np.abs(first - last).max(axis=2) > 40).mean(), 0.01)

    def test_mp4_and_webm(self) -> None:
        """What ffmpeg makes has the size and the number of pictures, and shows the same."""
        if not shutil.which("ffmpeg"):
            self.skipTest("no ffmpeg")
        shown = []
        for ending in ("mp4", "webm"):
            path = self.folder / f"film.{ending}"
            self.assertEqual(film(INPUT, "-o", path, *QUICK), "")
            words = ["ffmpeg", "-loglevel", "error", "-i", path, *RAW]
            raw = subprocess.run(words, check=True, capture_output=True).stdout
            pictures = np.frombuffer(raw, np.uint8).reshape(-1, SIZE[1], SIZE[0], 3)
            self.assertEqual(len(pictures), 5)
            shown.append(pictures[-1].astype(int))
        self.assertLess(np.abs(shown[0] - shown[1]).mean(), 6)

    def test_table(self) -> None:
        """A table is filmed by the input in its header; what is no trajectory is refused."""
        execute(EXE, "--quiet", "-o", self.folder, "--set", "span.samples=5", INPUT)
        path = self.folder / "film.gif"
        self.assertEqual(film(self.folder / "tip_loop.csv", "-o", path, *QUICK), "")
        said = film(ROOT / "input" / "spinning_wheel_sweep.nml", "-o", path, *QUICK, code=2)
        self.assertIn("this is no trajectory", said)

    def test_two_motions_in_part(self) -> None:
        """Two motions at the same times, slowly, from another side; what cannot be is refused."""
        path = self.folder / "film.gif"
        second = ROOT / "input" / "slow_top_scenario2_rk4.nml"
        first = ROOT / "input" / "slow_top.nml"
        part = ("--from", "1", "--to", "1.25", "--speed", "0.5", "--rate", "10", "--azimuth", "20")
        said = film(first, second, "--ghost", "-o", path, "--size", "320x180", *part)
        self.assertEqual(said, "")
        with Image.open(path) as image:
            self.assertEqual(image.n_frames, 5)
        for arguments, words in (
            ((first, "--from", "9"), "the motion lasts from 0 to 7.1577 s"),
            ((first, "--from", "2", "--to", "1"), "no part from 2 to 1 s"),
            ((first, "--to", "1e-7"), "the part is too short"),
            ((first, "--speed", "1e-6"), "is longer than 3600 s"),
            ((first, "--speed", "fast"), "is no speed"),
            ((first, "--speed", "2", "--seconds", "3"), "not allowed with"),
            ((first, "--elevation", "91"), "is no angle from -90 to 90"),
            ((first, "--ghost"), "--ghost takes a second motion"),
            ((first, self.folder / "none.nml"), "none.nml: no such file"),
        ):
            with self.subTest(words):
                said = film(*arguments, "-o", path, "--size", "320x180", code=2)
                self.assertIn(words, said)

    def test_messages(self) -> None:
        """What is missing or wrong is said in a line or two, and no film is left."""
        path = self.folder / "film.mp4"
        said = film(INPUT, "-o", path, *QUICK, code=4, PATH="/nowhere")
        for words in ("ffmpeg is not found", "apt-get install ffmpeg", "film.gif"):
            self.assertIn(words, said)
        for arguments, code, words in (
            ((INPUT, "-o", self.folder / "film"), 2, "ends in .mp4, .webm or .gif"),
            ((INPUT, "-o", self.folder / "film.avi"), 2, "ends in .mp4, .webm or .gif"),
            ((self.folder / "none.nml", "-o", self.folder / "a.gif"), 2, "no such file"),
            ((INPUT, "-o", self.folder / "a.gif", "--size", "31x17"), 2, "is no size"),
            ((INPUT, "-o", self.folder / "a.gif", "--seconds", "0"), 2, "is no duration"),
            ((INPUT, "-o", "/dev/null/a.gif", *QUICK), 4, "cannot write"),
        ):
            with self.subTest(words):
                self.assertIn(words, film(*arguments, code=code))
        wrong = self.folder / "wrong.nml"
        wrong.write_text("&top mass = -1 /\n", encoding="utf-8")
        said = film(wrong, "-o", self.folder / "a.gif", *QUICK, code=2)
        self.assertIn("wrong.nml:1", said)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["wrong.nml"])

    def test_failure_of_ffmpeg(self) -> None:
        """What ffmpeg says is passed on, and an older film is kept."""
        if not shutil.which("ffmpeg"):
            self.skipTest("no ffmpeg")
        path = self.folder / "film.mp4"
        path.write_text("older", encoding="utf-8")
        camera = Camera([compute(INPUT, 3)], SIZE, [], dark=False)
        codec = {".mp4": ("libx264", "-no_such_option 1")}
        with (
            unittest.mock.patch.object(encode, "CODECS", codec),
            self.assertRaisesRegex(FilmError, "ffmpeg failed: .*no_such_option"),
        ):
            encode.write(path, camera, 10)
        self.assertEqual(path.read_text(encoding="utf-8"), "older")


class PictureTest(unittest.TestCase):
    def test_trajectories_of_all_kinds(self) -> None:
        """Any body, damped or not, and a motion that an event ends."""
        for name in ("damped_top", "rigid_body_chaotic", "slow_top_events", "spinning_wheel"):
            with self.subTest(name):
                take = compute(ROOT / "input" / f"{name}.nml", 3)
                camera = Camera([take], SIZE, ["momentum", "omega", "force"], dark=True)
                for picture in range(3):
                    pixels = pixels_of(camera, picture)
                    self.assertEqual(pixels.shape, (SIZE[1], SIZE[0], 3))
                    self.assertGreater(len(np.unique(pixels)), 30)

    def test_axis_and_vectors(self) -> None:
        """The last picture is the end of the motion; body z and the vectors are in space axes."""
        take = compute(INPUT, 4)
        self.assertEqual(take.rows[-1], len(take.times) - 1)
        self.assertEqual(take.rows[0], 0)
        np.testing.assert_allclose(np.cos(take.theta), take.axis[:, 2], atol=1e-14)
        momentum = take.vectors["momentum"]  # its height is constant, and so is its part along z
        np.testing.assert_allclose(momentum[:, 2], momentum[0, 2], rtol=1e-13)
        along = np.sum(momentum * take.axis, axis=1)
        np.testing.assert_allclose(along, 0.25 * 30, rtol=1e-13)

    def test_path_between_pictures(self) -> None:
        """Few pictures of a long motion: the path is as smooth as that of many."""
        for name in ("rigid_body_chaotic", "damped_top"):
            take = compute(ROOT / "input" / f"{name}.nml", 8)
            self.assertEqual(len(take.rows), 8)
            self.assertLess(take.steps().max(), FINE)
            steps = np.diff(take.times[take.rows])
            np.testing.assert_allclose(steps, take.times[-1] / 7, rtol=1e-9)

    def test_part(self) -> None:
        """A part begins and ends where it was asked for, with equal times between pictures."""
        for name in ("tip_loop", "slow_top_lagrange_rk4"):
            source = ROOT / "input" / f"{name}.nml"
            share = span_of(source) / 0.5
            take = compute(source, 6, Part(0.3, 0.8, share))
            shown = take.times[take.rows]
            np.testing.assert_allclose((shown[0], shown[-1]), (0.3, 0.8), atol=0.01)
            np.testing.assert_allclose(np.diff(shown), 0.1, atol=0.008)
            self.assertEqual((take.rows[0], take.rows[-1]), (0, len(take.times) - 1))

    def test_letters_and_translucence(self) -> None:
        """No letters are smaller than 12 pixels; texts are apart; the body hides no arrow."""
        take = compute(INPUT, 3)
        for size in ((640, 360), (1280, 720)):
            camera = Camera([take, take], size, ["momentum"], dark=False, speed=2.0)
            bare = Camera([take, take], size, [], dark=False, speed=2.0)
            pictures = [pixels_of(one, 2) for one in (camera, bare)]
            arrow = np.array([0x75, 0x50, 0xA3])
            seen = [(np.abs(picture - arrow).max(axis=2) < 12).sum() for picture in pictures]
            self.assertGreater(seen[0], seen[1] + 20)
            texts = [text for text in camera.figure.findobj(Text) if text.get_text().strip()]
            self.assertGreaterEqual(min(text.get_size() for text in texts) * 100 / 72, 11.99)
            boxes = [text.get_window_extent() for text in camera.figure.texts]
            for i, box in enumerate(boxes):
                self.assertGreaterEqual(box.x0, 0)
                self.assertLessEqual(box.x1, size[0])
                self.assertFalse(box.count_overlaps(boxes[:i]))
        self.assertEqual(describe_speed(1.001), "real time")
        self.assertEqual(describe_speed(33.3), "33.3 times faster than real time")
        self.assertEqual(describe_speed(0.25), "4 times slower than real time")

    def test_projection(self) -> None:
        """It is a rotation: lengths are kept, and the vertical stays upright."""
        points = np.array([[0.3, -0.2, 0.9], [0, 0, 1.0]])
        lengths = np.linalg.norm(project(points), axis=1)
        np.testing.assert_allclose(lengths, np.linalg.norm(points, axis=1), rtol=1e-15)
        self.assertAlmostEqual(project(points)[1, 0], 0, places=15)
        self.assertGreater(project(points)[1, 1], 0.9)
        above = project(np.eye(3), View(azimuth=-90, elevation=90))
        np.testing.assert_allclose(above, np.eye(3), atol=1e-15)  # x to the right, y upward

    def test_solids(self) -> None:
        """The polygons of every kind of solid have its extent and its place."""
        place = {"axes": [1, 0, 0, 0, 1, 0, 0, 0, 1], "place": [0, 0, 2.0]}
        for solid, low, high, girth in (
            ({"kind": "cylinder", "radius": 1, "height": 0.5}, 1.75, 2.25, 1),
            ({"kind": "ring", "radius": 1, "inner": 0.5, "height": 0.5}, 1.75, 2.25, 1),
            ({"kind": "cone", "radius": 1, "height": 2}, 0.5, 2.5, 1),
            ({"kind": "sphere", "radius": 1}, 1, 3, 1),
            ({"kind": "cuboid", "edges": [2, 1, 1]}, 1.5, 2.5, 1),
        ):
            with self.subTest(solid["kind"]):
                polygons, colours = surface(solid | place)
                self.assertEqual(len(polygons), len(colours))
                heights = polygons[:, :, 2]
                self.assertAlmostEqual(heights.min(), low)
                self.assertAlmostEqual(heights.max(), high)
                self.assertAlmostEqual(polygons[:, :, 0].max(), girth)
