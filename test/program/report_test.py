"""Tests of scripts/report: what is told of a study, and how the page is put together."""

import base64
import contextlib
import hashlib
import html.parser
import http.server
import io
import json
import math
import os
import re
import sys
import tarfile
import threading
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts")]

from figures.table import Table, read_table  # noqa: E402
from plot_case import TableCase, a_precision, a_stability, a_sweep, a_trajectory  # noqa: E402
from reporting import __main__ as command  # noqa: E402
from reporting import packages  # noqa: E402
from reporting import page as page_module  # noqa: E402
from reporting import study as study_module  # noqa: E402
from reporting.body import Body, central_inertia, equivalent_solid, read_body  # noqa: E402
from reporting.errata import errata_for, numbers_named, read_errata, topics_of  # noqa: E402
from reporting.motion import find_omega, motion_data, refusal  # noqa: E402
from reporting.packages import PackageError  # noqa: E402
from reporting.page import make_page  # noqa: E402
from reporting.pictures import Picture, fit, pictures_of  # noqa: E402
from reporting.study import find_tables, read_study  # noqa: E402

BODY = (
    "# body: mass 2 kg; inertia 8.25, 8.25, 0.5 kg m^2 about the pivot; centre of mass 0, 0, 2 m\n"
)
ANGLES = ["t", "phi", "theta", "psi"]
HOSTILE = "</script><script>hacked = 1</script>"
PNG = bytes(24)
"""As much of a picture as the page looks at."""

SCRIPT = "globalThis.moves = 1;"


class ReportCase(TableCase):
    """Has tables to make reports of; script and pictures of the page are stand-ins."""

    def setUp(self) -> None:
        """Make the folder, and spare the bundler and the drawing."""
        super().setUp()
        self.bundle = self.stand_in(page_module, "bundle", SCRIPT)
        self.stand_in(
            study_module, "pictures_of", [Picture("p", "a picture", {".png": PNG}, ".png")]
        )

    def stand_in(self, module: object, name: str, result: object) -> unittest.mock.Mock:
        """A procedure that only gives this."""
        patch = unittest.mock.patch.object(module, name, return_value=result)
        self.addCleanup(patch.stop)
        return patch.start()

    def table(self, text: str) -> Table:
        """A table with this text."""
        return read_table(self.put("table.csv", text))

    def page(self) -> str:
        """The page of all tables in the folder."""
        errata = read_errata()
        sections, problems = read_study(self.folder, errata)
        return make_page(self.folder.name, sections, problems, errata)[0]


class BodyTest(ReportCase):
    """The body in a header, and the solid that is drawn for it."""

    def test_read(self) -> None:
        """Mass, inertia and centre of mass; a header without them gives no body."""
        body = read_body(self.table(BODY + a_trajectory()))
        self.assertEqual((body.mass, *body.inertia, *body.centre), (2, 8.25, 8.25, 0.5, 0, 0, 2))
        self.assertEqual(list(body.axis()), [0, 0, 1])
        self.assertIsNone(read_body(self.table(a_trajectory())))

    def test_wheel(self) -> None:
        """The cylinder of the wheel in Example 2 is that wheel, wherever its axis is."""
        mass, radius, height, length = 2.45, 0.1, 0.01, 1.0
        along, across = mass * radius**2 / 2, mass * (3 * radius**2 + height**2) / 12
        for axis in range(3):
            inertia = np.full(3, across + mass * length**2)
            inertia[axis] = along
            solid = equivalent_solid(Body(mass, inertia, length * np.eye(3)[axis]))
            self.assertEqual(solid["kind"], "cylinder")
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
        solid = equivalent_solid(Body(mass, inertia, np.zeros(3)))
        self.assertEqual(solid["kind"], "cuboid")
        np.testing.assert_allclose(sorted(solid["edges"]), edges, rtol=1e-12)
        aside = Body(mass, inertia + 1, np.array([0.1, 0.2, 0.3]))
        self.assertNotEqual(central_inertia(aside)[0, 1], 0)
        self.assertEqual(equivalent_solid(aside)["kind"], "cuboid")

    def test_impossible_body(self) -> None:
        """The author's wheel, whose inertia lacks m l^2, is drawn as it was meant to be."""
        wheel = Body(2.45, np.array([0.00614, 0.00614, 0.01225]), np.array([0.0, 0.0, 1.0]))
        self.assertAlmostEqual(equivalent_solid(wheel)["radius"], 0.1, places=3)


class MotionTest(ReportCase):
    """What goes into the page of a trajectory."""

    def unpack(self, text: str, kind: str = "<f8") -> np.ndarray:
        """Numbers from the base64 of their bytes."""
        return np.frombuffer(base64.b64decode(text), kind)

    def test_bits(self) -> None:
        """Times and angles are the bits of the table, of all rows or of some."""
        table = self.table(BODY + a_trajectory(count=40))
        data = motion_data(table, 40)
        for name in ANGLES:
            column = table.rows[name].to_numpy()
            self.assertEqual(self.unpack(data["exact"][name]).tobytes(), column.tobytes())
        data = motion_data(table, 12)
        self.assertEqual(data["stride"], 4)
        column = table.rows["t"].to_numpy()
        expected = [*column[::4], column[-1]]
        self.assertEqual(self.unpack(data["exact"]["t"]).tolist(), expected)
        self.assertIn("One row in 4 of 40 is shown, and the last.", data["notes"])
        self.assertEqual(len(self.unpack(data["drawn"]["force"], "<f4")), 3 * len(expected))

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
        """What is lacking is told."""
        notes = " ".join(motion_data(self.table(a_trajectory(ANGLES)), 99)["notes"])
        for word in ("does not give the body", "force_x, force_y, force_z", "omega1 to omega3"):
            self.assertIn(word, notes)

    def test_refusals(self) -> None:
        """What cannot move, and why."""
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


class ErrataTest(ReportCase):
    """Which errata belong to a table."""

    def test_file(self) -> None:
        """Every erratum has a heading of its own, says something, and concerns something."""
        errata = read_errata()
        self.assertEqual(len({erratum.heading for erratum in errata}), len(errata))
        for erratum in errata:
            self.assertTrue(erratum.paragraphs[0] and erratum.concerns)
            self.assertNotIn("Concerns", " ".join(erratum.paragraphs))
        silent = self.put("errata.md", "# A\n\n## Eq 1: wrong\n\nRight.\n")
        with self.assertRaisesRegex(ValueError, "'Eq 1: wrong' does not say what it concerns"):
            read_errata(silent)

    def test_numbers(self) -> None:
        """Ranges are all their members."""
        text = "Figures 2 to 4, Eq 27m (Eqs 41-43), Table 1"
        expected = {"Figure 2", "Figure 3", "Figure 4", "Eq 27m", "Eq 41", "Eq 42", "Eq 43"}
        self.assertEqual(numbers_named(text), {*expected, "Table 1"})

    def test_choice(self) -> None:
        """By what the table is of; a table of anything else has none."""
        errata = read_errata()

        def headings(text: str) -> set[str]:
            return {
                erratum.heading.split(":")[0] for erratum in errata_for(self.table(text), errata)
            }

        plain = a_trajectory(ANGLES).replace("'lagrange'", "'rigid_body'")
        self.assertEqual(headings(plain), set())
        example = BODY.replace("8.25, 8.25, 0.5", "0.875, 0.875, 0.25")
        self.assertEqual(headings(example + plain), {"Example 1"})
        self.assertIn("Figure 9", headings(example + a_trajectory([*ANGLES, "force_z"])))
        self.assertIn("Eqs 41-45", headings(example + a_trajectory(ANGLES)))
        self.assertEqual(headings(a_trajectory([*ANGLES, "R1"])), set())
        self.assertIn("Eqs 28 and 53", headings(a_sweep()))
        self.assertNotIn("", topics_of(self.table(plain)))

    def test_each_is_reached(self) -> None:
        """Every topic of an erratum is a word that some table has."""
        known = {f"Example {i}" for i in (1, 2)} | {"Figure 11", "Table 1"}
        text = (TESTS.parent / "src" / "studies" / "columns.f90").read_text(encoding="utf-8")
        for path in ("src/studies", "src/formulations", "src/integrators"):
            for source in (TESTS.parent / path).rglob("*.f90"):
                text += source.read_text(encoding="utf-8")
        for erratum in read_errata():
            for topic in {topic for choice in erratum.concerns for topic in choice} - known:
                word = topic.removeprefix("column ")
                self.assertRegex(text, rf"\b{re.escape(word)}\b", erratum.heading)


class PictureTest(ReportCase):
    """The pictures, their forms, and how they fit."""

    def test_taken_or_drawn(self) -> None:
        """Those beside a table are taken, unless they are older."""
        table = self.table(a_trajectory([*ANGLES, "com_z"]))
        drawn = pictures_of(table)[0]
        self.assertEqual(drawn.name, "table_angles")
        self.assertEqual(drawn.extent, (1080, 810))
        self.assertTrue(drawn.address.startswith("data:image/svg+xml;base64,"))
        self.assertEqual([path.name for path in self.folder.iterdir()], ["table.csv"])
        self.put("table_angles.svg", "<svg/>")
        (self.folder / "table_angles.png").write_bytes(drawn.forms[".png"])
        self.assertEqual(pictures_of(table)[0].forms[".svg"], b"<svg/>")
        os.utime(self.folder / "table_angles.png", (0, 0))
        self.assertEqual(pictures_of(table)[0].forms[".svg"], drawn.forms[".svg"])

    def test_fit(self) -> None:
        """The largest get smaller, and are left out only where that does not do."""
        sizes = ((90, 60), (900, 300), (600, 30))
        pictures = [
            Picture(str(i), "", {".svg": bytes(svg), ".png": bytes(png)}, ".svg")
            for i, (svg, png) in enumerate(sizes)
        ]
        fit(pictures, 5000)
        self.assertEqual([p.form for p in pictures], [".svg"] * 3)
        fit(pictures, 1400)
        self.assertEqual([p.form for p in pictures], [".svg", ".png", ".svg"])
        fit(pictures, 300)
        self.assertEqual([p.form for p in pictures], [".png", None, ".png"])
        self.assertEqual((pictures[1].size, pictures[1].address), (0, ""))


class Reader(html.parser.HTMLParser):
    """Collects the elements of a page, and what its scripts hold."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """An element begins."""
        self.elements.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        """Text within the latest element."""
        if self.elements and self.elements[-1][0] == "script" and not self.scripts[-1]:
            self.scripts[-1] = data
        else:
            self.text += data


class PageTest(ReportCase):
    """The page as a text."""

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
        """A title is text, wherever it stands."""
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
            "3 ok, 1 step_limit",
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

    def test_long_tables(self) -> None:
        """Of a long trajectory some rows are shown, of another table the first; it says which."""
        self.put("a.csv", a_trajectory(count=2000))
        self.put("b.csv", a_sweep(cases=800))
        page = self.page()
        self.assertIn("one row in 10 of 2000, and the last", page)
        self.assertIn("the first 266 of 800 rows", page)
        self.assertIn('<tr><th scope="row">266</th>', page)
        self.assertNotIn('<tr><th scope="row">267</th>', page)

    def test_without_script(self) -> None:
        """Where three.js is not to be had the page is whole but for the moving top, and says so."""
        self.bundle.side_effect = PackageError("the registry is away")
        self.put("a.csv", BODY + a_trajectory())
        page = self.page()
        self.assertIn("The tops do not move in this page: the registry is away", page)
        self.assertNotIn("<script", page)
        self.assertIn("script-src &#39;none&#39;", page)
        self.assertIn("<img ", page)

    def test_without_trajectory(self) -> None:
        """Nothing is fetched where nothing moves."""
        self.put("a.csv", a_sweep())
        self.assertNotIn("<script", self.page())
        self.bundle.assert_not_called()


class CommandTest(ReportCase):
    """The command line."""

    def report(self, *arguments: str | Path) -> tuple[int, str]:
        """Run it here; give exit code and standard error."""
        output, complaints = io.TextIOWrapper(io.BytesIO()), io.StringIO()
        with (
            unittest.mock.patch("sys.argv", ["report", *map(str, arguments)]),
            contextlib.redirect_stdout(output),
            contextlib.redirect_stderr(complaints),
        ):
            return command.main(), complaints.getvalue()

    def test_exit_codes(self) -> None:
        """What is wrong is told in a line."""
        missing = self.folder / "missing"
        self.assertEqual(self.report(missing), (2, f"scripts/report: {missing}: no such folder\n"))
        code, message = self.report(self.folder)
        self.assertEqual(code, 2)
        self.assertIn("no table of spintop in it", message)
        self.put("a.csv", a_sweep())
        self.put("bad.csv", "\n")
        code, message = self.report(self.folder)
        self.assertEqual(code, 0)
        self.assertIn("bad.csv: is no table of spintop", message)
        self.assertTrue((self.folder / "report.html").is_file())
        code, message = self.report(self.folder, "-o", self.folder / "a.csv" / "page.html")
        self.assertEqual(code, 4)
        self.assertIn("cannot write", message)
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
                self.assertEqual(self.report(study, "top.nml")[0], code)
            self.assertEqual((study / "report.html").is_file(), made)


class Registry(http.server.SimpleHTTPRequestHandler):
    """A registry of npm on this machine."""

    def log_message(self, *_: object) -> None:
        """Say nothing."""


class PackageTest(ReportCase):
    """Packages are those of the lock file, or they are refused."""

    def setUp(self) -> None:
        """Make a package, a lock file and a registry."""
        super().setUp()
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w:gz") as tar:
            text = b"export const three = 3;\n"
            for name, mode in (("package/three.js", 0o644), ("package/bin/run", 0o755)):
                facts = tarfile.TarInfo(name)
                facts.size, facts.mode = len(text), mode
                tar.addfile(facts, io.BytesIO(text))
            tar.addfile(tarfile.TarInfo("package/../../outside.js"))
        place = self.folder / "@scope" / "three" / "-" / "three-1.2.3.tgz"
        place.parent.mkdir(parents=True)
        place.write_bytes(archive.getvalue())
        self.hash = base64.b64encode(hashlib.sha512(archive.getvalue()).digest()).decode()
        self.lock("sha512-" + self.hash)

        def handler(*arguments: object) -> Registry:
            return Registry(*arguments, directory=self.folder)

        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.registry = f"http://127.0.0.1:{server.server_port}"
        self.modules = self.folder / "modules"
        settings = {"npm_config_registry": self.registry, "npm_config_userconfig": "/nowhere"}
        for patch in (
            unittest.mock.patch.object(packages, "PAGE", self.folder),
            unittest.mock.patch.object(packages, "ROOT", self.folder),
            unittest.mock.patch.object(packages, "MODULES", self.modules),
            unittest.mock.patch.dict(os.environ, settings),
        ):
            patch.start()
            self.addCleanup(patch.stop)

    def lock(self, integrity: str) -> None:
        """Write the lock file."""
        entry = {"version": "1.2.3", "integrity": integrity}
        lock = {"packages": {"": {}, "node_modules/@scope/three": entry}}
        self.put("package-lock.json", json.dumps(lock))

    def test_fetched_once(self) -> None:
        """It is kept; another integrity has it fetched anew."""
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

    def test_settings(self) -> None:
        """The environment counts more than the project, the project more than the user."""
        user = self.put(
            "user.npmrc", "; a comment\nregistry = http://user/npm/\ncafile=/a/ca.crt\n"
        )
        environment = {"npm_config_userconfig": str(user)}
        with unittest.mock.patch.dict(os.environ, environment):
            found = packages.tarball_of("three", "1")
            self.assertEqual(found, f"{self.registry}/three/-/three-1.tgz")
            os.environ.pop("npm_config_registry")
            self.assertEqual(packages.tarball_of("@a/b", "1"), "http://user/npm/@a/b/-/b-1.tgz")
            self.assertEqual(packages.settings()["cafile"], "/a/ca.crt")
            self.put(".npmrc", "registry=http://project\n")
            self.assertEqual(packages.tarball_of("a", "1"), "http://project/a/-/a-1.tgz")

    def test_not_to_be_had(self) -> None:
        """The reason is told."""
        (self.folder / "@scope" / "three" / "-" / "three-1.2.3.tgz").unlink()
        with self.assertRaisesRegex(PackageError, "gave no .*three-1.2.3.tgz: File not found"):
            packages.need("@scope/three")
        with (
            unittest.mock.patch("platform.machine", return_value="pdp11"),
            self.assertRaisesRegex(PackageError, "there is no @esbuild/linux-pdp11"),
        ):
            packages.esbuild_package()


if __name__ == "__main__":
    unittest.main()
