"""Tests of scripts/report: the description of a study, and the parts of the page."""

import base64
import functools
import gzip
import hashlib
import html.parser
import http.server
import io
import json
import math
import os
import re
import tarfile
import threading
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
from PIL import Image

from conftest import ROOT, called
from plot_case import TableCase, a_precision, a_stability, a_sweep, a_trajectory
from reporting import __main__ as command
from reporting import packages, words
from reporting import page as page_module
from reporting import study as study_module
from reporting.cells import proved_texts, texts_of
from reporting.key_numbers import key_numbers
from reporting.packages import PAGE, PackageError
from reporting.page import make_page
from reporting.pictures import Picture, data_uri, pictures_of
from reporting.study import find_tables, read_study
from spintop_figures.moving.body import (
    NO_SUCH_BODY,
    SHAPES,
    Body,
    central_inertia,
    draw_body,
    read_body,
)
from spintop_figures.moving.motion import (
    GROUPS,
    find_omega,
    motion_facts,
    pack,
    refusal,
    which_rows,
)
from spintop_figures.style.page import describe_end
from spintop_figures.tables.names import raised
from spintop_figures.tables.table import Table, read_table

BODY = (
    "# body: mass 2 kg; inertia 8.25, 8.25, 0.5 kg m^2 about the pivot; centre of mass 0, 0, 2 m\n"
)
ANGLES = ["t", "phi", "theta", "psi"]
HOSTILE = "</script><script>hacked = 1</script>"
PNG = bytes(24)
"""In place of a picture."""

SCRIPT = "globalThis.moves = 1;"


class ReportCase(TableCase):
    """Has tables to make reports of; script and pictures of the page are stand-ins."""

    def setUp(self) -> None:
        super().setUp()
        self.bundle = self.stand_in(page_module, "bundle", SCRIPT)
        picture = Picture("p", "a picture", data_uri("png", PNG), data_uri("webp", PNG), (4, 3))
        self.stand_in(study_module, "pictures_of", [picture])

    def stand_in(self, module: object, name: str, result: object) -> unittest.mock.Mock:
        return self.enterContext(unittest.mock.patch.object(module, name, return_value=result))

    def table(self, text: str) -> Table:
        return read_table(self.put("table.csv", text))

    def page(self) -> str:
        return make_page(self.folder.name, *read_study(self.folder))[0]


class ReportTest(ReportCase):
    def test_read(self) -> None:
        body = read_body(self.table(BODY + a_trajectory()))
        self.assertEqual((body.mass, *body.inertia, *body.centre), (2, 8.25, 8.25, 0.5, 0, 0, 2))
        self.assertEqual(list(body.axis()), [0, 0, 1])
        self.assertIsNone(read_body(self.table(a_trajectory())))

    def drawing(self, body: Body, top: str = "") -> tuple[list[dict], str]:
        """The solids that are drawn for a body, and the label; `top` is in the resolved input."""
        text = a_trajectory().replace("#     &integration", f"{top}#     &integration")
        drawing = draw_body(self.table(text), body)
        return drawing.solids, drawing.label

    def test_wheel(self) -> None:
        """The cylinder of the wheel in Example 2 is that wheel, wherever its axis is."""
        mass, radius, height, length = 2.45, 0.1, 0.01, 1.0
        along, across = mass * radius**2 / 2, mass * (3 * radius**2 + height**2) / 12
        for axis in range(3):
            inertia = np.full(3, across + mass * length**2)
            inertia[axis] = along
            [solid], label = self.drawing(Body(mass, inertia, length * np.eye(3)[axis]))
            self.assertEqual(solid["kind"], "cylinder")
            self.assertIn("homogeneous disc with the same mass", label)
            self.assertAlmostEqual(solid["radius"], radius, places=12)
            self.assertAlmostEqual(solid["height"], height, places=8)
            own = np.reshape(solid["axes"], (3, 3))
            self.assertAlmostEqual(abs(own[2, axis]), 1, places=12)
            self.assertAlmostEqual(np.linalg.det(own), 1, places=12)

    def test_cuboid(self) -> None:
        """A cuboid comes back from its moments, also with the pivot off its axes."""
        mass, edges = 3.0, np.array([0.2, 0.5, 0.9])
        squares = edges**2
        inertia = mass * (squares.sum() - squares) / 12
        [solid], label = self.drawing(Body(mass, inertia, np.zeros(3)))
        self.assertEqual(solid["kind"], "cuboid")
        self.assertIn("homogeneous cuboid", label)
        np.testing.assert_allclose(sorted(solid["edges"]), edges, rtol=1e-12)
        aside = Body(mass, inertia + 1, np.array([0.1, 0.2, 0.3]))
        self.assertNotEqual(central_inertia(aside)[0, 1], 0)
        self.assertEqual(self.drawing(aside)[0][0]["kind"], "cuboid")

    def test_shapes(self) -> None:
        body = Body(2.0, np.array([8.25, 8.25, 0.5]), np.array([0.0, 0.0, 2.0]))
        extents = {"radius": 0.5, "inner_radius": 0.3, "thickness": 0.4, "rod_length": 2.0}
        lines = "".join(f"#         {key} = {value}\n" for key, value in extents.items())
        expected = {
            "spinning_wheel": ("cylinder", {"radius": 0.5, "height": 0.4}, "a wheel"),
            "ring": ("ring", {"radius": 0.5, "inner": 0.3, "height": 0.4}, "a ring"),
            "sphere": ("sphere", {"radius": 0.5}, "a sphere"),
            "cylinder": ("cylinder", {"radius": 0.5, "height": 0.4}, "a cylinder"),
            "cone": ("cone", {"radius": 0.5, "height": 0.4}, "a cone"),
        }
        for shape, (kind, sizes, name) in expected.items():
            top = f"#     &top\n#         shape = '{shape}'\n{lines}#     /\n"
            [solid], label = self.drawing(body, top)
            self.assertEqual({key: solid[key] for key in sizes}, sizes, shape)
            self.assertEqual((solid["kind"], solid["place"]), (kind, [0, 0, 2]))
            self.assertEqual(label, f"The body is {name}, drawn to scale.")
        thin = top.replace("thickness = 0.4", "thickness = 0.001")
        self.assertIn("but for its thickness", self.drawing(body, thin)[1])

    def test_parts(self) -> None:
        """The parts of a body are drawn where they are; a point has no extent."""
        parts = (
            {"shape": "'disc'", "radius": 0.5, "inner_radius": 0.2, "thickness": 0.1},
            {"shape": "'cone'", "radius": 0.2, "thickness": 0.4, "axis": "2, 0, 0"},
            {"shape": "'point_mass'", "place": "0, 0, 1"},
            {"shape": "'rod'", "thickness": 1.0, "place": "0, 0, 0.5"},
            {"shape": "'torus'", "radius": 0.4, "inner_radius": 0.2, "place": "0, 0, 0.3"},
        )
        lines = ("".join(f"#         {key} = {part[key]}\n" for key in part) for part in parts)
        groups = "".join(f"#     &part\n{keys}#     /\n" for keys in lines)
        body = Body(2.0, np.array([8.25, 8.25, 0.5]), np.array([0.0, 0.0, 2.0]))
        solids, label = self.drawing(body, groups)
        self.assertEqual([solid["kind"] for solid in solids], ["ring", "cone", "cylinder", "ring"])
        self.assertIn("composed of 5 parts", label)
        np.testing.assert_allclose(solids[1]["place"], [0.3, 0, 0], atol=1e-15)
        np.testing.assert_allclose(np.reshape(solids[1]["axes"], (3, 3))[2], [1, 0, 0], atol=1e-15)
        for solid in solids:
            self.assertAlmostEqual(np.linalg.det(np.reshape(solid["axes"], (3, 3))), 1)
        self.assertEqual((solids[3]["height"], solids[3]["place"]), (0.2, [0, 0, 0.3]))

    def test_products(self) -> None:
        """A body that is given in other than principal axes is drawn in its own."""
        inertia, angle = np.diag([0.2, 0.3, 0.4]), 0.4
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        tensor = turn @ inertia @ turn.T
        numbers = ", ".join(str(x) for x in np.diag(tensor))
        header = (
            f"# body: mass 2 kg; inertia {numbers} kg m^2 about the pivot; centre of mass 0, 0,"
        )
        header += f" 0 m; elements 23, 31, 12 of the inertia tensor {tensor[1, 2]}, 0, 0 kg m^2\n"
        body = read_body(self.table(header + a_trajectory()))
        np.testing.assert_allclose(central_inertia(body), tensor)
        [solid], label = self.drawing(body)
        self.assertIn("homogeneous cuboid", label)
        own = np.reshape(solid["axes"], (3, 3))
        np.testing.assert_allclose(abs(own @ turn), np.eye(3), atol=1e-12)

    def test_every_shape_of_the_program(self) -> None:
        source = (ROOT / "src/top/shapes.f90").read_text(encoding="utf-8")
        self.assertEqual(set(re.findall(r"shape_info_t\('(\w+)'", source)), set(SHAPES))

    def test_no_such_body(self) -> None:
        """The author's wheel, whose inertia lacks m l^2: the page says what the program says."""
        wheel = Body(2.45, np.array([0.00614, 0.00614, 0.01225]), np.array([0.0, 0.0, 1.0]))
        [solid], label = self.drawing(wheel)
        self.assertAlmostEqual(solid["radius"], 0.1, places=3)
        self.assertTrue(label.startswith(NO_SUCH_BODY))
        self.assertIn("about its centre of mass is drawn", label)
        source = (ROOT / "src/scenes/body_of_scene.f90").read_text(encoding="utf-8")
        words = " ".join(re.sub(r"&\s*&", "", source).split())
        self.assertIn(f"'{NO_SUCH_BODY[0].lower()}{NO_SUCH_BODY[1:-1]}'", words)

    def test_triangle(self) -> None:
        """Positive central moments that break the triangle inequality are those of no body."""
        centre = np.array([0.0, 0.0, 1.0])
        broken = Body(1.0, np.array([1.1, 1.1, 0.3]), centre)
        self.assertGreater(np.linalg.eigvalsh(central_inertia(broken))[0], 0)
        self.assertIn("No mass distribution", self.drawing(broken)[1])
        flat = Body(1.0, np.array([1.15, 1.15, 0.3]), centre)
        self.assertIn("homogeneous disc with the same mass", self.drawing(flat)[1])
        point = Body(1.0, np.array([1.0, 1.0, 0.0]), centre)
        self.assertEqual(self.drawing(point), ([], "The body is a point mass on a massless rod."))

    def facts(self, table: Table, stride: int = 1) -> dict:
        return motion_facts(table, pack(table, stride), "here")

    def test_file(self) -> None:
        """The data are the bytes of the file; of fewer rows, its lines, with a note."""
        table = self.table(BODY + a_trajectory(count=40))
        text = table.path.read_text(encoding="utf-8")
        self.assertEqual(gzip.decompress(pack(table).packed).decode(), text)
        thin = pack(table, 4)
        self.assertEqual((thin.kept, thin.total, thin.is_whole), (11, 40, False))
        lines = gzip.decompress(thin.packed).decode().splitlines()
        rows = [line for line in text.splitlines() if line[0] != "#"]
        kept = [line for line in lines if line[0] != "#"]
        self.assertEqual(kept, [rows[0], *rows[1::4], rows[-1]])
        self.assertIn("# rows: one in 4 of 40, and the last", lines)
        self.assertEqual(lines[-1], "# status: ok")
        self.assertEqual(read_table(self.put("thin.csv", "\n".join([*lines, ""]))).status, "ok")

    def test_long_sweep(self) -> None:
        """Of a sweep with more cases than are read, it is said which rows can be saved."""
        table = self.table(a_sweep(cases=25_000))
        self.assertGreater(table.stride, 1)
        data = pack(table)
        self.assertFalse(data.is_whole)
        self.assertTrue(data.which.endswith(f"of one case in {table.stride}"), data.which)
        text = gzip.decompress(data.packed).decode()
        again = read_table(self.put("again.csv", text))
        self.assertEqual(again.rows.to_numpy().tolist()[1], table.rows.to_numpy().tolist()[1])
        self.assertEqual((again.title, again.kind), (table.title, "sweep"))

    def test_facts(self) -> None:
        facts = self.facts(self.table(BODY + a_trajectory(count=40)), 4)
        columns = [*ANGLES, "force_x", "force_y", "force_z", "kinetic", "potential", "energy"]
        self.assertEqual(facts["columns"], columns)
        self.assertEqual((facts["total"], facts["stride"], facts["data"]), (40, 4, "here"))
        note = "The page has every 4th of 40 rows, and the last; ranges and longest arrows are of"
        self.assertIn(f"{note} all rows.", facts["notes"])

    def test_columns_of_the_script(self) -> None:
        script = (PAGE / "motion.js").read_text(encoding="utf-8")
        for name in {name for group in GROUPS for name in group}:
            self.assertRegex(script, rf"\b{name}\b")

    def test_scenes(self) -> None:
        """Motions of one scene are those of one body from one start, whatever computed them."""
        names = [*ANGLES, "omega1", "omega2", "omega3"]
        text = BODY + a_trajectory(names)
        scenes = [self.facts(self.table(text))["scene"]]
        for old, new in (
            ("'rk4'", "'exact'"),
            ("8.25, 8.25", "8.250000000000001, 8.25"),
            ("8.25, 8.25", "8.26, 8.26"),
            ("#     &integration", "#     &top\n#     gravity = 1.62\n#     /\n#     &integration"),
        ):
            scenes.append(self.facts(self.table(text.replace(old, new)))["scene"])
        other = BODY + a_trajectory(names, theta=0.5000001)
        scenes.append(self.facts(self.table(other))["scene"])
        self.assertEqual(len(set(scenes[:3])), 1)
        self.assertEqual(len({scenes[0], *scenes[3:]}), 4)
        slow = self.facts(self.table(BODY + a_trajectory(ANGLES)))["scene"]
        self.assertEqual(len(slow), len(scenes[0]))

    def test_omega_from_rates(self) -> None:
        """A steady precession: omega is the rate of precession and spin, seen from the body."""
        names = [*ANGLES, "phi_rate", "theta_rate", "psi_rate"]
        text = a_trajectory(names, phi_rate=1.0, theta_rate=0.0, psi_rate=9.0)
        omega = find_omega(self.table(text))
        across = math.sin(0.5)
        for i, row in enumerate(omega):
            psi = 0.9 * i
            expected = (across * math.sin(psi), across * math.cos(psi), math.cos(0.5) + 9)
            np.testing.assert_allclose(row, expected, atol=1e-14)
        self.assertIsNone(find_omega(self.table(a_trajectory(ANGLES))))

    def test_notes(self) -> None:
        notes = " ".join(self.facts(self.table(a_trajectory(ANGLES)))["notes"])
        words = ("does not give the body", "force_x, force_y, force_z", "omega1 to omega3")
        for word in (*words, "kinetic, potential, energy"):
            self.assertIn(word, notes)

    def test_refusals(self) -> None:
        reasons = {
            "is no trajectory": a_sweep(),
            "needs the column t": a_trajectory(ANGLES[1:]),
            "needs the columns phi, theta, psi or q0 to q3": a_trajectory(["t", "phi"]),
            "has one row only": a_trajectory(ANGLES, count=1),
            "": a_trajectory(ANGLES),
        }
        for reason, text in reasons.items():
            self.assertEqual(refusal(self.table(text)), reason)
        lost = a_trajectory(ANGLES, theta=math.nan)
        self.assertIn("needs the columns phi", refusal(self.table(lost)))

    def test_taken_or_drawn(self) -> None:
        """Those beside a table are taken, unless they are older."""
        table = self.table(a_trajectory([*ANGLES, "com_z"]))
        drawn = pictures_of(table)[0]
        self.assertEqual(drawn.name, "table_angles")
        self.assertNotIn("Figure", drawn.what)  # of the paper, whose run it is not
        self.assertEqual(drawn.extent, (1080, 810))
        self.assertTrue(drawn.address.startswith("data:image/"))
        self.assertEqual([path.name for path in self.folder.iterdir()], ["table.csv"])
        self.put("table_angles.svg", "<svg/>")
        address = pictures_of(table)[1].thumbnail.partition("base64,")[2]
        with Image.open(io.BytesIO(base64.b64decode(address))) as small:
            self.assertEqual(small.width, 240)
            small.save(self.folder / "table_angles.png")
        self.assertEqual(pictures_of(table)[0].address, data_uri("svg+xml", b"<svg/>"))
        os.utime(self.folder / "table_angles.png", (0, 0))
        self.assertEqual(pictures_of(table)[0].address, drawn.address)
        (self.folder / "table_angles.png").write_bytes(b"damaged")
        self.assertEqual(pictures_of(table)[0].address, drawn.address)

    def test_refused_figures_are_told(self) -> None:
        """A figure that the columns promise and the numbers forbid is not left out silently."""
        problems: list[str] = []
        lost = self.table(a_trajectory([*ANGLES, "com_z"], com_z=math.nan))
        self.assertEqual([p.name for p in pictures_of(lost, problems)], ["table_trace"])
        self.assertEqual(problems, ["has no number in column com_z: no angles figure"])

    def test_numbers(self) -> None:
        """Powers of ten, errors, counts and units as in print."""
        self.assertEqual(words.with_error(0.87499822, 4.3585e-5), "0.874998 ± 0.000044")
        self.assertEqual(words.with_error(2.0, 0.0), "2")
        self.assertEqual(words.with_error(1.5e12, 3.21e3), "1.5\N{MULTIPLICATION SIGN}10¹² ± 3,200")
        self.assertEqual(words.of_kind("fit", 2), "two tables of fits")
        self.assertEqual(words.of_kind("work_precision", 1), "one work-precision study")
        self.assertEqual(words.of_kind("own", 12), "12 tables: own")
        self.assertEqual([raised(unit) for unit in ("kg m^2", "us")], ["kg m²", "µs"])
        self.assertEqual(describe_end("at_rest at t = 116.59158323"), "at rest at t = 116.592 s")
        strides = [which_rows(stride, 1985).split(" of ")[0] for stride in (2, 3, 5, 11, 21, 112)]
        ends = [f"every {number}" for number in ("2nd", "3rd", "5th", "11th", "21st", "112th")]
        self.assertEqual(strides, ends)

    def test_key_numbers(self) -> None:
        """A fit has its values, statistics those of all cases; tables of one title differ."""
        study = a_trajectory().partition("t,")[0].replace("'trajectory'", "'fit'")
        fitted = "parameter,unit,estimate,standard_error\ntop.inertia(3),kg m^2,0.25005,0.000056\n"
        residuals = "t,theta,theta_residual\n0,1,0.01\n1,1,-0.01\n"
        self.put("a.csv", study + fitted)
        self.put("a.residuals.csv", study.replace("theta [", "theta_residual [") + residuals)
        swept = a_sweep().partition("case,")[0]
        self.put("b.csv", swept + "bin,cases,theta_max_mean,theta_max_min\n0,1200,1.5,0.2\n")
        histogram = "column,from,to,cases\ntheta_max,0,1,3\ntheta_max,1,2,9\n"
        self.put("b.histogram.csv", swept + histogram)
        sections, problems = read_study(self.folder)
        self.assertEqual(problems, [])
        found = {section.name: key_numbers(section.table) for section in sections}
        self.assertEqual(found["a.csv"], {"moment of inertia I₃": "0.250050 ± 0.000056 kg m²"})
        self.assertEqual(list(found["a.residuals.csv"]), ["rms residual of θ"])
        self.assertEqual(found["b.csv"]["cases"], "1,200")
        self.assertIn("75 % of the cases", str(found["b.histogram.csv"]))
        titles = [section.title for section in sections]
        self.assertEqual(len(set(titles)), 4)
        self.assertTrue(titles[1].endswith(": residuals"), titles)

    def test_policy(self) -> None:
        """It allows the style and the script that are there, pictures, and nothing else."""
        self.put("a.csv", BODY + a_trajectory())
        page = self.page()
        found = dict(Reader(page).elements[3][1])["content"]
        rules = dict(rule.split(" ", 1) for rule in found.split("; "))
        self.assertEqual(rules["default-src"], "'none'")
        self.assertEqual(rules["img-src"], "data:")
        digest = base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode()
        self.assertEqual(rules["script-src"], f"'sha256-{digest}'")
        self.assertIn(f"<script>{SCRIPT}</script>", page)
        for tag, attributes in Reader(page).elements:
            for name in ("src", "href", "srcset", "action", "style", "onclick"):
                value = attributes.get(name) or "#"
                self.assertTrue(value.startswith(("#", "data:")), f"{name} of {tag}")

    def test_hostile_title(self) -> None:
        harmless = "A top, trajectory: $5"
        self.put("a.csv", BODY + a_trajectory().replace(harmless, HOSTILE))
        self.put("b.csv", a_sweep().replace("A top, sweep: $5", HOSTILE))
        page = Reader(self.page())
        self.assertFalse([script for script in page.scripts if script.startswith("hacked")])
        self.assertGreaterEqual(page.text.count(HOSTILE), 4)
        data = json.loads(page.scripts[0])
        self.assertEqual(data["title"], HOSTILE)

    def test_what_is_told(self) -> None:
        """Overview, origin, input, columns, rows; failures are marked, other files named."""
        self.put("a.csv", BODY + a_trajectory(count=3, phi=1 / 3))
        self.put("b.csv", a_sweep(status="step_limit"))
        self.put("c.csv", a_stability())
        self.put("d.csv", a_precision() + "# in words: the cheapest is one, 3 times\n")
        self.put("notes.csv", "a,b\n")
        self.put("b.1-of-2.csv", a_sweep())
        page = Reader(self.page())
        for text in (
            "0123456789ab-dirty",
            "GCC version 12.2.0",
            "&study\n    kind = 'trajectory'\n    title = 'It''s a top, = trajectory'\n/",
            "support force: x",
            "3 completed, 1 too many steps",
            "2 accurate",
            "the cheapest is one, 3 times",
            "notes.csv: is no table of spintop",
            "0.3333333333",
        ):
            self.assertIn(text, page.text)
        self.assertEqual(len([path.name for path in find_tables(self.folder)]), 5)
        failed = [tag for tag, attributes in page.elements if attributes.get("class") == "failed"]
        self.assertEqual(failed, ["td", "td", "span", "span"])  # b and d, in overview and section
        captions = [tag for tag, _ in page.elements].count("caption")
        self.assertGreaterEqual(captions, 4)
        scopes = [attributes.get("scope") for tag, attributes in page.elements if tag == "th"]
        self.assertNotIn(None, scopes)

    def test_top_of_the_page(self) -> None:
        """Dates, program, counts; key numbers of every table; contents that lead somewhere."""
        dated = BODY.replace("# body", "# date: 2020-02-29T10:00:00Z\n# body")
        self.put("a.csv", dated + a_trajectory(theta=0.5))
        self.put("b.csv", a_sweep(status="step_limit"))
        self.put("c.csv", a_stability())
        page = self.page()
        reader = Reader(page)
        for text in (
            "2020-02-29",
            "spintop 0.1.0 (0123456789ab-dirty)",
            "one trajectory, one sweep, one stability study",
            "1 of 3 tables",
            "28.65\N{DEGREE SIGN} to 28.65\N{DEGREE SIGN}",
            "spin ratio 0.5 to 2",
        ):
            self.assertIn(text, reader.text)
        names = {attributes["id"] for _, attributes in reader.elements if attributes.get("id")}
        links = {attributes["href"] for tag, attributes in reader.elements if tag == "a"}
        self.assertLessEqual({link[1:] for link in links if link[0] == "#"}, names)
        self.assertIn("#table-1-top", links)
        self.assertIn("#table-3-table", links)

    def test_saved_tables(self) -> None:
        for name, text in (("a.csv", BODY + a_trajectory()), ("b.csv", a_sweep())):
            self.put(name, text)
        links = [attributes for tag, attributes in Reader(self.page()).elements if tag == "a"]
        saved = {link["download"]: link["href"] for link in links if "download" in link}
        for name in ("a.csv", "b.csv"):
            packed = base64.b64decode(saved[f"{name}.gz"].partition("base64,")[2])
            self.assertEqual(gzip.decompress(packed), (self.folder / name).read_bytes())

    def test_long_tables(self) -> None:
        """Long trajectories show some rows, other tables the first ones; the page names them."""
        self.put("a.csv", a_trajectory(count=2000))
        self.put("b.csv", a_sweep(cases=800))
        page = self.page()
        self.assertIn("every 10th of 2,000 rows, and the last", page)
        self.assertIn("the first 266 of 800 rows", page)
        self.assertIn('<tr><th scope="row">266</th>', page)
        self.assertNotIn('<tr><th scope="row">267</th>', page)

    def test_without_script(self) -> None:
        """Without three.js the page lacks only the animated top, with a message."""
        self.bundle.side_effect = PackageError("the registry is away")
        self.put("a.csv", BODY + a_trajectory())
        page = self.page()
        self.assertIn("The tops do not move in this page: the registry is away", page)
        self.assertNotIn("<script", page)
        self.assertIn("script-src &#39;none&#39;", page)
        self.assertIn("<img ", page)

    def test_without_trajectory(self) -> None:
        """Without an animation nothing is fetched."""
        self.put("a.csv", a_sweep())
        self.assertNotIn("<script", self.page())
        self.bundle.assert_not_called()

    def report(self, *arguments: str | Path, code: int = 0) -> str:
        found, _, complaints = called(command.main, "report", *arguments)
        assert found == code, complaints
        return complaints

    def test_exit_codes(self) -> None:
        """An error has a message of one line."""
        missing = self.folder / "missing"
        said = self.report(missing, code=2)
        self.assertEqual(said, f"scripts/report: {missing}: no such folder\n")
        self.assertIn("no table of spintop in it", self.report(self.folder, code=2))
        self.put("a.csv", a_sweep())
        self.put("bad.csv", "\n")
        self.assertIn("bad.csv: is no table of spintop", self.report(self.folder))
        self.assertTrue((self.folder / "report.html").is_file())
        said = self.report(self.folder, "-o", self.folder / "a.csv" / "page.html", code=4)
        self.assertIn("cannot write", said)
        self.assertFalse(list(self.folder.glob("*.part")))

    def test_inputs_are_run_first(self) -> None:
        """Into the folder, without figures; a wrong input ends it, failed cases do not."""
        table = self.put("kept.csv", a_sweep())
        study = self.folder / "new study"
        runner = self.put("run", f'#!/bin/sh\nmkdir -p "$3"; cp "{table}" "$3"; exit $CODE\n')
        runner.chmod(0o755)
        for code, made in ((0, True), (3, True), (2, False)):
            (study / "report.html").unlink(missing_ok=True)
            with (
                unittest.mock.patch.object(command, "SCRIPTS", self.folder),
                unittest.mock.patch.dict(os.environ, {"CODE": str(code)}),
            ):
                self.report(study, "top.nml", code=code)
            self.assertEqual((study / "report.html").is_file(), made)

    def test_order(self) -> None:
        """The tables of the inputs come first, in their order; then the others, by name."""
        copy = 'cp "$(dirname "$0")/table" "$3/$input.csv"\nsleep 0.05'
        runner = self.put("run", f'#!/bin/sh\nfor input in "$4" "$5"; do\n{copy}\ndone\n')
        runner.chmod(0o755)
        self.put("table", a_sweep())
        study = self.folder / "study"
        study.mkdir()
        for name in ("a", "b", "z"):
            (study / f"{name}.csv").write_text(a_sweep(), encoding="utf-8")
        with unittest.mock.patch.object(command, "SCRIPTS", self.folder):
            self.report(study, "z", "b", "--title", "My <title>")
        page = (study / "report.html").read_text(encoding="utf-8")
        leads = re.findall(r'<p class="lead">Sweep, <code>(\w+)\.csv', page)
        self.assertEqual(leads, ["z", "b", "a"])
        self.assertIn("<h1>My &lt;title&gt;</h1>", page)
        self.assertIn("<title>My &lt;title&gt; \N{EN DASH} spintop report</title>", page)

    def test_size_of_a_page(self) -> None:
        """The data of many long tables stay below their limit, and take nearly all of it."""
        for i in range(8):
            self.put(f"{i}.csv", BODY + a_trajectory(count=2000))
        sections, _ = read_study(self.folder)
        sizes = []
        for limit in (10**7, 400_000):
            with unittest.mock.patch.multiple(page_module, LARGEST=limit, PER_TABLE=0):
                page_module.pack_data(sections)
            sizes.append(sum(section.data.size for section in sections))
        self.assertGreater(sizes[0], 1.2 * limit)
        self.assertLess(sizes[1], limit)
        self.assertGreater(sizes[1], 0.6 * limit)

    def test_what_is_shown_in_part_is_told(self) -> None:
        """On the terminal and in the page."""
        self.put("a.csv", BODY + a_trajectory(count=2000))
        with unittest.mock.patch.multiple(page_module, LARGEST=30_000, PER_TABLE=0):
            message = self.report(self.folder)
        rows = r"every \d+(?:st|nd|rd|th) of 2,000 rows, and the last"
        told = re.search(rf"a\.csv: the page has ({rows})", message)
        page = (self.folder / "report.html").read_text(encoding="utf-8")
        self.assertIn(f"<li>{told[0]}</li>", page)
        self.assertIn(f"({told[1]}, all digits)", page)


class Reader(html.parser.HTMLParser):
    """Collects the elements of a page, and what its scripts hold."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        if self.elements and self.elements[-1][0] == "script" and not self.scripts[-1]:
            self.scripts[-1] = data
        else:
            self.text += data


class PackageTest(ReportCase):
    """Packages are those of the lock file, or they are refused."""

    def setUp(self) -> None:
        super().setUp()
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w:gz") as tar:
            text = b"export const three = 3;\n"
            for name, mode in (("package/three.js", 0o644), ("package/bin/run", 0o755)):
                facts = tarfile.TarInfo(name)
                facts.size, facts.mode = len(text), mode
                tar.addfile(facts, io.BytesIO(text))
            tar.addfile(tarfile.TarInfo("package/../../outside.js"))
            link = tarfile.TarInfo("package/link.js")
            link.type, link.linkname = tarfile.SYMTYPE, "/etc/hostname"
            tar.addfile(link)
        place = self.folder / "@scope" / "three" / "-" / "three-1.2.3.tgz"
        place.parent.mkdir(parents=True)
        place.write_bytes(archive.getvalue())
        self.hash = base64.b64encode(hashlib.sha512(archive.getvalue()).digest()).decode()
        self.lock("sha512-" + self.hash)

        registry = http.server.SimpleHTTPRequestHandler
        self.enterContext(unittest.mock.patch.object(registry, "log_message"))
        handler = functools.partial(registry, directory=self.folder)
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.registry = f"http://127.0.0.1:{server.server_port}"
        self.modules = self.folder / "modules"
        settings = {"npm_config_registry": self.registry, "npm_config_userconfig": "/nowhere"}
        places = {"PAGE": self.folder, "ROOT": self.folder, "MODULES": self.modules}
        self.enterContext(unittest.mock.patch.multiple(packages, **places))
        self.enterContext(unittest.mock.patch.dict(os.environ, settings))

    def lock(self, integrity: str) -> None:
        entry = {"version": "1.2.3", "integrity": integrity}
        lock = {"packages": {"": {}, "node_modules/@scope/three": entry}}
        self.put("package-lock.json", json.dumps(lock))

    def test_fetched_once(self) -> None:
        """The file is kept; with another checksum it is fetched again."""
        folder = packages.need("@scope/three")
        self.assertEqual(folder, self.modules / "@scope" / "three")
        self.assertIn("three = 3", (folder / "three.js").read_text(encoding="utf-8"))
        programs = [path.name for path in folder.rglob("*") if path.is_file()]
        self.assertEqual(sorted(programs), [".integrity", "run", "three.js"])
        self.assertEqual([path.name for path in self.modules.iterdir()], ["@scope"])
        self.assertTrue(os.access(folder / "bin" / "run", os.X_OK))
        with unittest.mock.patch.object(packages, "fetch", side_effect=AssertionError):
            packages.need("@scope/three")
        self.lock("sha512-" + "A" * 86 + "==")
        with self.assertRaisesRegex(PackageError, "is not what the lock file means"):
            packages.need("@scope/three")
        self.assertTrue((folder / "three.js").is_file())
        self.assertEqual([path.name for path in folder.parent.iterdir()], ["three"])

    def test_python_without_filters(self) -> None:
        """That of Debian 12 unpacks files all the same, and nothing else."""
        unpack = tarfile.TarFile.extractall

        def extractall(archive: tarfile.TarFile, path: str, members: list) -> None:
            unpack(archive, path, members)

        self.enterContext(unittest.mock.patch.object(tarfile, "data_filter", None))
        self.enterContext(unittest.mock.patch.object(tarfile.TarFile, "extractall", extractall))
        self.test_fetched_once()

    def test_settings(self) -> None:
        """The environment counts more than the project, the project more than the user."""
        text = "; a comment\nregistry = http://user/npm/\ncafile=/a/ca.crt\n"
        environment = {"npm_config_userconfig": str(self.put("user.npmrc", text))}
        with unittest.mock.patch.dict(os.environ, environment):
            found = packages.tarball_of("three", "1")
            self.assertEqual(found, f"{self.registry}/three/-/three-1.tgz")
            os.environ.pop("npm_config_registry")
            self.assertEqual(packages.tarball_of("@a/b", "1"), "http://user/npm/@a/b/-/b-1.tgz")
            self.assertEqual(packages.settings()["cafile"], "/a/ca.crt")
            self.put(".npmrc", "registry=http://project\n")
            self.assertEqual(packages.tarball_of("a", "1"), "http://project/a/-/a-1.tgz")

    def test_not_to_be_had(self) -> None:
        (self.folder / "@scope" / "three" / "-" / "three-1.2.3.tgz").unlink()
        with self.assertRaisesRegex(PackageError, "gave no .*three-1.2.3.tgz: File not found"):
            packages.need("@scope/three")
        with (
            unittest.mock.patch("platform.machine", return_value="pdp11"),
            self.assertRaisesRegex(PackageError, "there is no @esbuild/linux-pdp11"),
        ):
            packages.esbuild_package()


class CellsTest(unittest.TestCase):
    def test_points_align(self) -> None:
        """All numbers of a column have as many decimals, or all a power of ten."""
        for numbers in (
            [0.5, -12.25, 100.0, math.nan],
            [1e-9, 2.5, -1e-3, 7.0],
            [1e12, 2e-3],
            [math.pi * 10.0**k for k in range(-12, 3)],
        ):
            texts = texts_of(numbers)
            behind = {len(text.partition(".")[2]) for text in texts if text != "\N{EN DASH}"}
            self.assertEqual(len(behind), 1, texts)

    def test_texts(self) -> None:
        """Zeros that no number needs are left out; whole numbers, words and gaps are themselves."""
        minus = "\N{MINUS SIGN}"
        self.assertEqual(texts_of([0.5, -12.25]), ["0.50", f"{minus}12.25"])
        self.assertEqual(texts_of([1, -20]), ["1", f"{minus}20"])
        self.assertEqual(texts_of(["ok", "a-b"]), ["ok", "a-b"])
        self.assertEqual(texts_of([math.nan, 1.0]), ["\N{EN DASH}", "1"])
        powers = [f"1.000000000e{minus}20", f"3.000000000e{minus}05"]
        self.assertEqual(texts_of([1e-20, 3e-5]), powers)
        self.assertEqual(texts_of([math.inf, 0.25])[0], "inf")

    def test_proved_digits(self) -> None:
        """A digit is proved if the error is at most half a unit of it; two more follow."""

        def marked(number: str, bound: str) -> str:
            return f'<b class="proved" title="off by {bound} at most">{number}</b>'

        minus = "\N{MINUS SIGN}"
        proved = [marked("1.234", "0.0004") + "57", marked(minus + "1.23", "0.0006") + "457"]
        self.assertEqual(proved_texts([1.23456789, -1.23456789], [0.4e-3, 0.6e-3]), proved)
        self.assertEqual(proved_texts([12.5], [0.4]), [marked("12", "0.4") + ".50"])
        unproved = proved_texts([12.5, 3.0], [math.inf, 0.7])
        self.assertEqual(unproved, ["12.500000000000000", "3.000000000000000"])
        self.assertEqual(proved_texts([0.5], [0.0]), [marked("0.5000000000000000", "0")])
        self.assertEqual(proved_texts([math.nan, "word"], [math.inf, 0.1]), ["\N{EN DASH}", "word"])
