"""Tests of the live top, alone on its page and on the cards of a report, in a browser."""

import base64
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS)]

from browser_case import (  # noqa: E402
    BROWSER,
    DESKTOP,
    NO_WEBGL,
    PROGRAM,
    BrowserCase,
    need,
    open_browser,
    wait_for,
)
from reporting import live  # noqa: E402
from reporting.packages import PackageError, esbuild_package  # noqa: E402
from spintop_figures.tables.table import read_table  # noqa: E402

BYTES = 3_000_000
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]
THRESHOLD = 2 * math.sqrt(9.81 * 0.8660254037844387 * 0.875) / 0.25
"""Of the sleeping top of Example 1, rad/s."""

CLASSES = {
    "cusp": "Cusps",
    "loop": "Loops",
    "wave": "Waves",
    "separatrix": "Separatrix",
    "slow": "Steady precession",
    "fast": "Steady precession",
    "pendulum": "Plane pendulum",
}


def violations(case: BrowserCase) -> list:
    """What axe finds on the page."""
    axe = (need("axe-core") / "axe.min.js").read_text(encoding="utf-8")
    case.tell("Runtime.evaluate", expression=axe)
    return case.browser.execute_async_script(
        "const [rules, done] = arguments; axe.run({ runOnly: rules })"
        ".then(({ violations }) => done(violations.map((v) => "
        "[v.id, v.help, v.nodes.slice(0, 3).map((n) => n.html)])))",
        RULES,
    )


class LiveCase(BrowserCase):
    """A browser with the live top, opened anew before each test."""

    @classmethod
    def setUpClass(cls) -> None:
        """Make the page, start the browser."""
        if not BROWSER:
            raise unittest.SkipTest("no browser: scripts/test installs one, where it may")
        try:
            for name in ("three", "axe-core", esbuild_package()):
                need(name)
        except PackageError as error:
            raise unittest.SkipTest(str(error)) from error
        scratch = tempfile.TemporaryDirectory(prefix="live ", ignore_cleanup_errors=True)
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name) / "pages"
        cls.folder.mkdir()
        cls.page = cls.folder / "live.html"
        if live.main(["--live", "-o", str(cls.page)]):
            raise AssertionError("the page was not made")
        cls.browser = open_browser(Path(scratch.name) / "profile", *cls.flags)
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self) -> None:
        """Open the page on a desktop's screen; nothing moves or scrolls by itself."""
        self.set_screen(*DESKTOP, prefers_reduced_motion="reduce")
        self.open(self.page)

    def open(self, page: Path, link: str = "") -> None:
        """Open the page with a state, at rest."""
        self.browser.get("about:blank")
        self.browser.get(page.as_uri() + link)
        wait_for(lambda: self.run_script("return globalThis.liveTop?.track?.count > 0"), "the top")
        self.run_script("liveTop.pause()")

    @property
    def section(self) -> object:
        """The live top."""
        return self.browser.find_element("css selector", "section.live")

    def text(self, name: str) -> str:
        """What a part says."""
        return self.part(self.section, name).get_property("textContent")

    def choose(self, preset: str) -> None:
        """Choose a preset."""
        self.run_script(
            "const { preset } = liveTop.parts; preset.value = arguments[0];"
            "preset.dispatchEvent(new Event('change')); liveTop.pause();",
            preset,
        )

    def control(self, name: str, kind: str) -> object:
        """The slider (range) or the box (text) of a number."""
        selector = f".control[data-name={name}] input[type={kind}]"
        return self.section.find_element("css selector", selector)

    def wait_for_text(self, name: str, words: str) -> None:
        """Wait until a part says this."""
        wait_for(lambda: words in self.text(name), f"{words} instead of {self.text(name)}")

    def wait_for_class(self, name: str) -> None:
        """Wait until the motion is of this class."""
        wait_for(lambda: self.text("class") == name, f"{name} instead of {self.text('class')}")


class LiveTest(LiveCase):
    """The page as one uses it."""

    def test_small(self) -> None:
        """The page is small, and needs nothing else."""
        self.assertLess(self.page.stat().st_size, BYTES)

    def test_presets(self) -> None:
        """Every preset shows the class of motion that it names."""
        presets = self.run_script("return [...liveTop.parts.preset.options].map(o => o.value)")
        self.assertLess(set(CLASSES), set(presets))
        for preset in filter(None, presets):
            with self.subTest(preset):
                self.choose(preset)
                self.wait_for_class(CLASSES.get(preset, self.text("class")))
                self.assertEqual(self.part(self.section, "preset").get_property("value"), preset)

    def test_cusp_becomes_loop(self) -> None:
        """The slider of the precession rate makes loops of cusps, to the right waves."""
        from selenium.webdriver.common.keys import Keys

        self.choose("cusp")
        self.wait_for_class("Cusps")
        slider = self.control("phi_rate", "range")
        with self.changing(self.section):
            slider.send_keys(*[Keys.ARROW_LEFT] * 60)
            self.wait_for_class("Loops")
        slider.send_keys(*[Keys.ARROW_RIGHT] * 120)
        self.wait_for_class("Waves")
        self.assertEqual(self.part(self.section, "preset").get_property("value"), "")

    def test_threshold_of_sleep(self) -> None:
        """The spin at which the top sleeps is written, marked, and can be set."""
        self.choose("falling")
        self.assertIn("upright it falls", self.text("sleep"))
        self.assertIn("21.81 rad/s", self.text("sleep"))
        tick = self.section.find_element("css selector", ".control[data-name=omega3] .tick")
        self.assertTrue(tick.is_displayed())
        widest = "return liveTop.track.nutation.thetaMax * 180 / Math.PI"
        self.assertGreater(self.run_script(widest), 40)
        self.part(self.section, "threshold").click()
        wait_for(
            lambda: abs(self.run_script("return liveTop.state.omega3") - THRESHOLD) < 1e-9,
            "the threshold",
        )
        self.assertEqual(float(self.control("omega3", "text").get_property("value")), 21.8119)
        box = self.control("omega3", "text")
        box.clear()
        box.send_keys("26")
        wait_for(lambda: "upright it sleeps" in self.text("sleep"), "sleep")
        self.assertLess(self.run_script(widest), 3)

    def test_link(self) -> None:
        """The address holds the state, and another address is another state."""
        self.choose("wave")
        wait_for(lambda: "phi_rate=0.8" in self.run_script("return location.hash"), "the link")
        link = self.run_script("return location.hash")
        self.open(self.page, link)
        self.wait_for_class("Waves")
        self.assertEqual(self.run_script("return liveTop.state.phi_rate"), 0.8)
        self.run_script("location.hash = arguments[0]", link.replace("=0.8", "=-1.2"))
        self.wait_for_class("Loops")

    def test_hostile_link(self) -> None:
        """What a link may not hold has no effect."""
        for link in (
            "#shape=constructor&mass=2",
            "#shape=inertia&mass=-1&theta=400&omega3=NaN&phi_rate=&gravity=<img>&t_end=x",
            "#%E0%A4%A&&&=",
        ):
            with self.subTest(link):
                self.open(self.page, link)
                state = self.run_script("return liveTop.state")
                self.assertEqual((state["mass"], state["theta"], state["omega3"]), (1, 50, 30))

    def test_boxes(self) -> None:
        """What is no number, or impossible, is said and not taken; what it was before is kept."""
        box, other = self.control("theta", "text"), self.control("omega3", "text")
        fault = self.section.find_element("css selector", ".control[data-name=theta] .fault")
        for text, words in (("400", "at most 180"), ("-1", "at least 0"), ("x", "not a number")):
            with self.subTest(text):
                box.clear()
                box.send_keys(text)
                other.click()
                self.assertEqual(fault.text, words)
                self.assertEqual(box.get_attribute("aria-invalid"), "true")
                self.assertTrue(0 <= self.run_script("return liveTop.state.theta") <= 180)
        box.clear()
        box.send_keys("60,5")
        wait_for(lambda: self.run_script("return liveTop.track.start.angle[1]") > 1.05, "60.5")
        self.assertFalse(fault.is_displayed())

    def test_all_that_is_linked(self) -> None:
        """Stage, readings, cursors and points are those of the exact solution at the time."""
        script = """
            const [time] = arguments;
            liveTop.seek(time * liveTop.track.span);
            const done = arguments[1];
            requestAnimationFrame(() => requestAnimationFrame(() => {
                const { track, clock, charts, parts } = liveTop;
                const now = track.exact.at(clock.time);
                const places = Object.fromEntries(Object.entries(charts.plots)
                    .map(([name, plot]) => [name, plot.mark.style.transform]));
                const at = (name, x, y) => {
                    const plot = charts.plots[name];
                    const [a, b] = places[name].match(/[-.\\d]+/g).map(Number);
                    return Math.hypot(a - plot.x(x), y === null ? 0 : b - plot.y(y)) < 0.02;
                };
                const degrees = 180 / Math.PI;
                const [theta, rate] = [now.angle[1] * degrees, now.rate[1] * degrees];
                done([
                    ["theta", "phi", "psi", "energy"].every((name) => at(name, clock.time, null)),
                    at("potential", theta, charts.level), at("portrait", theta, rate),
                    parts.theta.textContent, theta, Number(parts.time.value),
                    track.energy.every((e) => Math.abs(e - track.energy[0]) < 1e-12 * 500),
                ]);
            }));
        """
        for preset in ("cusp", "fast", "example1", "pendulum"):
            self.choose(preset)
            for time in (0.0, 0.3, 1.0):
                with self.subTest(preset=preset, time=time):
                    found = self.browser.execute_async_script(script, time)
                    cursors, point, phase, text, theta, slider, conserved = found
                    self.assertTrue(cursors and point and phase and conserved, found)
                    self.assertAlmostEqual(float(text.rstrip("°")), theta, delta=0.006)
                    self.assertEqual(slider, round(1000 * time))

    def test_input(self) -> None:
        """The input that the page gives is one of the program, and has the same motion."""
        for preset in ("loop", "example2", "cone", "slow"):
            with self.subTest(preset):
                self.run_script("liveTop.parts.input.textContent = ''")
                self.choose(preset)
                self.compare_input(preset)
        for shape in ("ring", "sphere", "cylinder"):
            with self.subTest(shape):
                self.open(self.page, f"#shape={shape}&theta=40&omega3=90&theta_rate=0.3")
                self.compare_input(shape)

    def compare_input(self, name: str) -> None:
        """Run the input of the page; the motion ends as it does in the page."""
        text = wait_for(lambda: self.text("input"), "the input")
        path = self.folder / f"{name}.nml"
        path.write_text(text, encoding="utf-8")
        command = [PROGRAM, "--quiet", "-o", self.folder, path]
        subprocess.run(command, check=True, capture_output=True)
        rows = read_table(self.folder / f"{name}.csv").rows
        last = self.run_script("return liveTop.track.at(liveTop.track.span)")
        self.assertAlmostEqual(last["t"], rows["t"].iloc[-1], delta=1e-9 * last["t"])
        self.assertAlmostEqual(last["angle"][1], rows["theta"].iloc[-1], delta=1e-7)
        self.assertAlmostEqual(last["angle"][0], rows["phi"].iloc[-1], delta=1e-6)

    def test_keys(self) -> None:
        """Everything can be done without a mouse."""
        from selenium.webdriver.common.keys import Keys

        stage = self.part(self.section, "stage")
        now, span = "return liveTop.clock.time", self.run_script("return liveTop.track.span")
        stage.send_keys(Keys.END)
        self.assertEqual(self.run_script(now), span)
        stage.send_keys(Keys.HOME, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
        self.assertAlmostEqual(self.run_script(now), span / 200)
        stage.send_keys(" ")
        self.assertEqual(self.part(self.section, "play").get_attribute("aria-label"), "Pause")
        wait_for(lambda: self.run_script(now) > span / 100, "time to pass")
        stage.send_keys(" ")
        for keys in ("+", Keys.SHIFT + Keys.ARROW_LEFT, "0"):
            with self.subTest(keys=keys), self.changing(self.section):
                stage.send_keys(keys)

    def test_it_is_told(self) -> None:
        """What is seen is told in words, once it is quiet."""
        self.choose("loop")
        start = "Loops: the precession reverses in every nutation"
        wait_for(lambda: self.text("live").startswith(start), "the announcement")
        words = self.text("live")
        self.assertIn("tilt 50.00° to 77.49°", words)

    def test_what_is_shown(self) -> None:
        """Path, body, arrows and cones come and go."""
        self.choose("loop")
        self.run_script("liveTop.seek(2.3)")
        for name in ("body_shown", "trace", "momentum", "omega", "force", "cones"):
            with self.subTest(name), self.changing(self.section):
                self.part(self.section, name).click()

    def test_accessibility(self) -> None:
        """axe finds nothing; light and dark, wide and narrow, at rest and moving."""
        for width, height, scheme in ((*DESKTOP, "light"), (390, 844, "dark")):
            with self.subTest(width=width, scheme=scheme):
                self.set_screen(width, height, prefers_color_scheme=scheme)
                self.open(self.page)
                self.run_script(
                    "document.querySelectorAll('details').forEach(d => { d.open = true });"
                    "liveTop.play();"
                )
                self.assertEqual(violations(self), [])
                widths = "return [document.documentElement.scrollWidth, innerWidth]"
                self.assertEqual(*self.run_script(widths))

    def test_calm(self) -> None:
        """Nothing moves by itself where less motion is asked for."""
        self.set_screen(*DESKTOP, prefers_reduced_motion="reduce")
        self.browser.get("about:blank")
        self.browser.get(self.page.as_uri())
        wait_for(lambda: self.run_script("return globalThis.liveTop?.track?.count > 0"), "the top")
        self.assertEqual(
            self.run_script("return [liveTop.clock.playing, liveTop.clock.time]"), [False, 0]
        )

    def test_paper(self) -> None:
        """On paper there is a still of the top, in the colours of paper."""
        self.set_screen(*DESKTOP, prefers_color_scheme="dark")
        self.open(self.page)
        pdf = base64.b64decode(self.tell("Page.printToPDF", printBackground=True)["data"])
        self.assertTrue(pdf.startswith(b"%PDF"))
        colour = self.run_script(
            "const image = liveTop.parts.still, canvas = document.createElement('canvas'),"
            "pen = canvas.getContext('2d'); pen.drawImage(image, 0, 0);"
            "return [image.naturalWidth, ...pen.getImageData(5, 5, 1, 1).data]"
        )
        self.assertEqual(colour, [1920, 255, 255, 255, 255])

    def saved(self, button: str, again: bool) -> tuple[str, bytes]:
        """Name and bytes of the file that a button saves."""
        script = """
            const [name, again, done] = arguments;
            const read = (blob) => new Promise((resolve) => {
                const reader = new FileReader();
                reader.onload = () => resolve(reader.result);
                reader.readAsDataURL(blob);
            });
            const blobs = [];
            URL.createObjectURL = (blob) => { blobs.push(blob); return "blob:kept"; };
            HTMLAnchorElement.prototype.click = function () {
                const data = blobs.length ? read(blobs[0]) : Promise.resolve(this.href);
                data.then((address) => done([this.download, address]));
            };
            liveTop.parts[name].click();
            let frames = 60;
            const wait = () => {
                if (--frames) requestAnimationFrame(wait);
                else liveTop.parts[name].click();
            };
            if (again) wait();
        """
        name, data = self.browser.execute_async_script(script, button, again)
        return name, base64.b64decode(data.partition(",")[2])

    def test_picture(self) -> None:
        """A picture is a PNG of the size of a screen."""
        name, data = self.saved("picture", again=False)
        self.assertEqual((name, data[:8]), ("spintop.png", b"\x89PNG\r\n\x1a\n"))
        size = [int.from_bytes(data[i : i + 4], "big") for i in (16, 20)]
        self.assertEqual(size, [1920, 1080])

    def test_sleep(self) -> None:
        """Almost upright, the panel says whether the top sleeps; at the threshold that changes."""
        self.choose("falling")
        self.wait_for_text("meaning", "it falls")
        slider = self.control("omega3", "range")
        self.run_script("arguments[0].value = arguments[0].max;"
                        "arguments[0].dispatchEvent(new Event('input'))", slider)  # fmt: skip
        self.wait_for_text("meaning", "it sleeps")
        self.choose("example1")
        wait_for(lambda: "Almost upright" not in self.text("meaning"), "a tilted top")

    def test_film(self) -> None:
        """A film is a WebM with something in it; the button stops it before its end."""
        name, data = self.saved("film", again=True)
        self.assertEqual((name, data[:4]), ("spintop.webm", b"\x1a\x45\xdf\xa3"))
        self.assertGreater(len(data), 1000)

    def test_recomputation(self) -> None:
        """A change is computed once a frame, however many events there are."""
        script = """
            const done = arguments[0];
            const later = (action) => requestAnimationFrame(() => requestAnimationFrame(action));
            let count = 0;
            const change = () => {
                const section = document.querySelector("section.live");
                section.addEventListener("computed", () => { count += 1; });
                const { slider } = liveTop.controls.omega3;
                for (let k = 0; k < 50; k += 1) {
                    slider.value = 400 + k;
                    slider.dispatchEvent(new Event("input"));
                }
                // in the same frame, after the page: later it computes all points, when it is quiet
                requestAnimationFrame(() => done([count, liveTop.track.start.omega[2]]));
            };
            later(change); // what the page computes when it opens does not count
        """
        count, omega3 = self.browser.execute_async_script(script)
        self.assertEqual(count, 1)
        self.assertEqual(omega3, self.run_script("return liveTop.state.omega3"))


class FlatTest(LiveCase):
    """A browser without WebGL."""

    flags = NO_WEBGL

    def test_drawn_flat(self) -> None:
        """It is drawn all the same."""
        with self.changing(self.section):
            self.choose("loop")
            self.run_script("liveTop.seek(2)")


class CardTest(BrowserCase):
    """The cards of a report."""

    def test_card(self) -> None:
        """A symmetric top without damping has one, and it opens with its scene."""
        cards = self.browser.find_elements("css selector", "section.live.closed")
        script = "return arguments[0].closest('article').querySelector('.lead code').textContent"
        by_table = {self.run_script(script, card): card for card in cards}
        self.assertIn("spinning_wheel_figure11.csv", by_table)
        self.assertNotIn("heavy_top_benchmark.csv", by_table)  # its axis of symmetry is body y
        card = by_table["slow_top.csv"]
        self.run_script("arguments[0].scrollIntoView({ behavior: 'instant' })", card)
        card.find_element("css selector", "button").click()
        wait_for(lambda: self.run_script("return arguments[0].top?.track?.count > 0", card), "it")
        self.assertEqual(self.part(card, "class").text, "Cusps")
        state = self.run_script("return arguments[0].top.state", card)
        expected = {"theta": 11.25, "omega3": 1, "inertia1": 0.875, "nutations": 3}
        self.assertEqual({key: state[key] for key in expected}, expected)
        self.run_script("arguments[0].top.pause()", card)
        self.assertEqual(violations(self), [])
        self.assertEqual(self.run_script("return location.hash"), "")


if __name__ == "__main__":
    unittest.main()
