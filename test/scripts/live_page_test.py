"""Tests of the live top in a browser."""

import base64
import math
from collections.abc import Callable

from selenium.webdriver.common.keys import Keys

from browser_case import DESKTOP, SOFTWARE_WEBGL, LiveCase, wait_for
from conftest import EXE, execute
from spintop_figures.tables.table import read_table

BYTES = 1_000_000
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
    "sleeping": "Sleeping top",
    "cone": "Sleeping top",
    "falling": "Falling top",
    "rest": "Comes to rest",
    "damped": "Damped top",
    "kapitza": "Vibrating pivot",
    "chaotic": "Body without symmetry",
}


class LiveTest(LiveCase):
    def test_small(self) -> None:
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

    def test_without_webgl(self) -> None:
        """A sentence stands in place of the top; charts and numbers are as ever."""
        hint = self.section.find_element("css selector", ".stage .hint")
        wait_for(lambda: "no WebGL" in hint.text, "the sentence")
        pane = self.part(self.section, "plot_theta")
        before = pane.screenshot_as_png
        self.choose("loop")
        self.wait_for_class("Loops")
        self.run_script("liveTop.clock.seek(2)")
        wait_for(lambda: pane.screenshot_as_png != before, "another chart")
        wait_for(lambda: self.text("t") == "2.000 s", "the time")

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
        """What is no number, or impossible, is said and not taken; the box shows what is used."""
        box, other = self.control("theta", "text"), self.control("omega3", "text")
        fault = self.section.find_element("css selector", ".control[data-name=theta] .fault")
        cases = {
            "400": "at most 180: it stays 50 °",
            "-1": "at least 0: it stays 50 °",
            "x": "not a number: it stays 50 °",
            "30 rpm": "“rpm” is no unit of this number, as ° is: it stays 50 °",
            "3 frogs": "“frogs” is no unit: it stays 50 °",
        }
        for text, words in cases.items():
            with self.subTest(text):
                self.type_into(box, text)
                other.click()
                self.assertEqual(fault.text, words)
                self.assertEqual(self.run_script("return liveTop.state.theta"), 50)
                self.assertEqual(box.get_property("value"), "50")
        self.type_into(box, "60,5\n")
        wait_for(lambda: self.run_script("return liveTop.track.start.angle[1]") > 1.05, "60.5")
        self.assertFalse(fault.is_displayed())

    def test_units(self) -> None:
        """A number may have another unit; the box then shows it in its own."""
        cases = (
            ("omega3", "300 rpm", 10 * math.pi),
            ("omega3", "5 rev/s", 10 * math.pi),
            ("theta", "0.5 rad", math.degrees(0.5)),
            ("omega3", "300 U/min", 10 * math.pi),
            ("omega3", "300 tr/min", 10 * math.pi),
            ("omega3", "300 1/min", 10 * math.pi),
            ("omega3", "300/min", 10 * math.pi),
            ("omega3", "5 rps", 10 * math.pi),
            ("theta", "20 deg", 20),
            ("theta", "21 Grad", 21),
            ("theta", "22 degrés", 22),
            ("mass", "120 g", 0.12),
            ("inertia3", "3 g cm^2", 3e-7),
            ("length", "4 cm", 0.04),
            ("gravity", "1.62 m/s^2", 1.62),
            ("damping1", "2 mm N s", 0.002),
            ("t_end", "200 ms", 0.2),
        )
        for name, text, value in cases:
            with self.subTest(text):
                box = self.control(name, "text")
                self.type_into(box, text + "\n")
                found = self.run_script("return liveTop.state[arguments[0]]", name)
                self.assertAlmostEqual(found, value, delta=1e-14 * value)
                self.assertEqual(float(box.get_property("value")), found)

    def test_thousands(self) -> None:
        """They are grouped as in the language of the page, which has its own decimal mark."""
        cases = {
            "en": {"1,500 rpm": 1500, "1.500 rpm": 1.5, "1,5 rpm": 1.5, "1,500.5 rpm": 1500.5},
            "de": {"1.500 rpm": 1500, "1,500 rpm": 1.5, "0.866 rpm": 0.866, "1.500,5 rpm": 1500.5},
            "fr": {"1.500 rpm": 1500, "1\u202f500 rpm": 1500, "\u22121,5e\u22121 rpm": -0.15},
        }
        for language, texts in cases.items():
            self.open(self.page, f"#lang={language}")
            for text, value in texts.items():
                with self.subTest(text, language=language):
                    self.type_into(self.control("omega3", "text"), text + "\n")
                    found = self.run_script("return liveTop.state.omega3")
                    self.assertAlmostEqual(found, value * math.pi / 30, delta=1e-12)
        self.open(self.page, "#lang=en")

    def test_numbers_shown(self) -> None:
        """Every box shows the very number with which the page computes, in every preset."""
        script = """
            return Object.entries(liveTop.controls).filter(([name, { box, element }]) =>
                !element.hidden && !box.disabled && Number(box.value) !== liveTop.state[name]);
        """
        for preset in self.run_script("return [...liveTop.parts.preset.options].map(o => o.value)"):
            self.choose(preset or "cusp")
            self.assertEqual(self.run_script(script), [], preset)

    def test_periods(self) -> None:
        """A pendulum has the period of its swing to both sides; the separatrix has none."""
        self.choose("pendulum")
        self.wait_for_class("Plane pendulum")
        facts = self.text("facts")
        self.assertIn("120.00° to 240.00°", facts)
        self.assertIn("Period2.164 s", facts)
        self.choose("separatrix")
        self.wait_for_class("Separatrix")
        self.assertIn("Nutation periodinfinite", self.text("facts"))

    def test_rest(self) -> None:
        """With dry friction a top sleeps, wakes, falls, and lies still."""
        self.choose("rest")
        self.wait_for_class("Comes to rest")
        stop = self.run_script("return liveTop.track.motion.stop")
        self.assertLess(stop, 16)
        script = "return liveTop.track.at(arguments[0])"
        tilts = [self.run_script(script, t)["angle"][1] for t in (0.5, 5.0, stop, stop + 1)]
        self.assertLess(tilts[0], 0.1)
        self.assertGreater(tilts[1], 1.5)
        self.assertEqual(tilts[2], tilts[3])
        self.assertEqual(self.run_script(script, stop + 1)["kinetic"], 0)

    def test_friction_or_vibration(self) -> None:
        """The page does not compute both, says so, and shows what it uses."""
        self.choose("kapitza")
        self.assertTrue(self.run_script("return liveTop.track.body.isVibrated"))
        box = self.control("friction", "text")
        self.type_into(box, "0.01\n")
        wait_for(lambda: "computes no vibration" in self.text("limits"), "a sentence")
        self.assertEqual(self.control("amplitude", "text").get_property("value"), "0")
        self.assertEqual(self.run_script("return liveTop.state.amplitude"), 0)

    def test_impossible_bodies(self) -> None:
        """A number for which there is no body changes another one, which its box shows."""
        self.open(self.page, "#shape=ring&radius=0.1&inner_radius=0.5")
        box = self.control("inner_radius", "text")
        self.assertEqual(float(box.get_property("value")), 0.099)
        self.open(self.page, "#shape=tensor&product12=0.1")
        self.type_into(self.control("product12", "text"), "3\n")
        wait_for(lambda: "No body has such products" in self.text("limits"), "a sentence")
        self.assertEqual(self.control("product12", "text").get_property("value"), "0")

    def test_all_that_is_linked(self) -> None:
        """Readings and cursors are those of the motion at the time."""
        script = """
            const [time] = arguments;
            liveTop.clock.seek(time * liveTop.track.span);
            const done = arguments[1];
            requestAnimationFrame(() => requestAnimationFrame(() => {
                const { track, clock, plots, parts } = liveTop;
                const now = track.at(clock.time);
                const isAt = ({ mark, margin, ...plot }) => {
                    const [x] = mark.style.transform.match(/[-.\\d]+/g).map(Number);
                    return Math.abs(x - (margin.left + clock.time * plot.perX)) < 0.02;
                };
                done([
                    Object.values(plots).every(isAt),
                    parts.theta.textContent, now.angle[1] * 180 / Math.PI, Number(parts.time.value),
                    track.energy.every((e) => Math.abs(e - track.energy[0]) < 1e-12 * 500),
                ]);
            }));
        """
        for preset in ("cusp", "fast", "example1", "pendulum"):
            self.choose(preset)
            for time in (0.0, 0.3, 1.0):
                with self.subTest(preset=preset, time=time):
                    found = self.browser.execute_async_script(script, time)
                    cursors, text, theta, slider, conserved = found
                    self.assertTrue(cursors and conserved, found)
                    self.assertAlmostEqual(float(text.rstrip("°")), theta, delta=0.006)
                    self.assertEqual(slider, round(1000 * time))

    def test_input(self) -> None:
        """The input that the page gives is one of the program, and has the same motion."""
        for preset in ("loop", "example2", "cone", "slow", "rest", "damped", "kapitza", "chaotic"):
            with self.subTest(preset):
                self.run_script("liveTop.parts.input.textContent = ''")
                self.choose(preset)
                self.compare_input(preset)
        for shape in ("ring", "sphere", "cylinder", "body&psi=20", "tensor&product12=0.1&psi=20"):
            with self.subTest(shape):
                self.open(self.page, f"#shape={shape}&theta=40&omega3=9&theta_rate=0.3&t_end=3")
                self.compare_input(shape.partition("&")[0])

    def compare_input(self, name: str) -> None:
        """Run the input of the page; the motion ends as it does in the page."""
        text = wait_for(lambda: self.text("input"), "the input")
        path = self.folder / f"{name}.nml"
        path.write_text(text, encoding="utf-8")
        tight = "--set=integration.relative_tolerance=1e-12"
        execute(EXE, "--quiet", "-o", self.folder, tight, path)
        rows = read_table(self.folder / f"{name}.csv").rows
        last = self.run_script("return liveTop.track.at(liveTop.track.span)")
        self.assertAlmostEqual(last["t"], rows["t"].iloc[-1], delta=1e-9 * last["t"])
        phi, theta = (rows[name].iloc[-1] for name in ("phi", "theta"))
        across = math.sin(theta)
        axis = (across * math.sin(phi), -across * math.cos(phi), math.cos(theta))
        for value, right in zip(last["axis"], axis, strict=True):
            self.assertAlmostEqual(value, right, delta=1e-6)

    def test_keys(self) -> None:
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

    def test_it_is_told(self) -> None:
        """What is seen is told in words, once it is quiet."""
        self.choose("loop")
        start = "Loops: the precession reverses in every nutation"
        wait_for(lambda: self.text("live").startswith(start), "the announcement")
        words = self.text("live")
        self.assertIn("Tilt 50.00° to 77.49°", words)

    def test_full_screen(self) -> None:
        button = self.part(self.section, "screen")
        button.click()
        wait_for(
            lambda: self.run_script("return document.fullscreenElement === liveTop.section"), "it"
        )
        wait_for(lambda: button.text == "Leave full screen", "its name")
        button.click()
        wait_for(lambda: self.run_script("return !document.fullscreenElement"), "the page")

    def test_accessibility(self) -> None:
        """axe finds nothing; light and dark, wide and narrow, at rest and moving."""
        for width, height, scheme in ((*DESKTOP, "light"), (390, 844, "dark")):
            with self.subTest(width=width, scheme=scheme):
                self.set_screen(width, height, prefers_color_scheme=scheme)
                self.open(self.page)
                self.open_details()
                self.run_script("liveTop.clock.play()")
                self.assertEqual(self.violations(), [])
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


class ShadedTest(LiveCase):
    flags = SOFTWARE_WEBGL

    def test_keys_of_the_view(self) -> None:
        """The view is turned and zoomed without a mouse."""
        stage = self.part(self.section, "stage")
        for keys in ("+", Keys.SHIFT + Keys.ARROW_LEFT, "0"):
            with self.subTest(keys=keys), self.changing(self.section):
                stage.send_keys(keys)

    def drag(self, place: str, right: int, down: int) -> None:
        """Drag a point of the stage, which is an expression of its place."""
        script = f"""
            const [x, y] = {place}, {{ element }} = liveTop.stage;
            const {{ left, top }} = element.getBoundingClientRect();
            return [left + x, top + y];
        """
        x, y = self.run_script(script)
        for kind, to_x, to_y in (
            ("mouseMoved", x, y),
            ("mousePressed", x, y),
            ("mouseMoved", x + right, y + down),
            ("mouseReleased", x + right, y + down),
        ):
            button = "none" if kind == "mouseMoved" and to_x == x else "left"
            self.tell(
                "Input.dispatchMouseEvent", type=kind, x=to_x, y=to_y, button=button, clickCount=1
            )

    def test_drag(self) -> None:
        """The tip of the axis is dragged to another tilt, the body to another spin."""
        self.choose("cusp")
        wait_for(lambda: self.run_script("return liveTop.stage.isOpen"), "the stage")
        self.run_script("liveTop.section.scrollIntoView(); liveTop.clock.seek(1.2)")
        arrow = "liveTop.stage.project(liveTop.axisNow().multiplyScalar(liveTop.picture.tip * {}))"
        self.run_script("liveTop.clock.seek(0)")
        self.drag(arrow.format("1"), 0, 60)
        script = "return liveTop.state.theta !== 50 && liveTop.state.theta"
        theta = wait_for(lambda: self.run_script(script), "another tilt")
        self.assertTrue(50 < theta < 120, theta)
        self.assertEqual(float(self.control("theta", "text").get_property("value")), theta)
        self.assertEqual(self.run_script("return liveTop.state.omega3"), 30)
        before = self.run_script("return liveTop.stage.project(liveTop.axisNow())")
        self.drag(f"{arrow.format('0.9')}.map((v) => v + 12)", 80, 0)
        wait_for(lambda: self.run_script("return liveTop.state.omega3 > 35"), "another spin")
        self.assertEqual(self.run_script("return liveTop.state.theta"), theta)
        after = self.run_script("return liveTop.stage.project(liveTop.axisNow())")
        self.assertEqual(before, after)  # the view has not turned

    def test_second_top(self) -> None:
        """A motion is kept in grey while a slider changes the other; both move, and it goes."""
        button = self.part(self.section, "keep")
        button.click()
        self.wait_for_text("kept", "the same motion")
        self.type_into(self.control("omega3", "text"), "40\n")
        wait_for(lambda: self.text("kept") == "In grey: ω₃ = 30 rad/s.", "what differs")
        self.assertEqual(self.run_script("return liveTop.second.track.start.omega[2]"), 30)
        self.assertEqual(self.run_script("return liveTop.track.start.omega[2]"), 40)
        with self.changing(self.section):
            self.run_script("liveTop.clock.seek(2.2)")
        with self.changing(self.section):
            button.click()
        self.assertEqual(self.text("kept"), "")

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

    def test_numbers_before_shaders(self) -> None:
        """The first frame has panel and charts; WebGL, which may take a second, comes after it."""
        script = """
            addEventListener("frame", () => {
                globalThis.first ??= document.querySelectorAll(".stage canvas").length;
            }, true);
        """
        command = "Page.{}ScriptToEvaluateOnNewDocument"
        added = self.tell(command.format("add"), source=script)
        self.addCleanup(self.tell, command.format("remove"), **added)
        self.open(self.page)
        shown = "return document.querySelectorAll('.stage canvas').length"
        wait_for(lambda: self.run_script(shown) == 1, "the stage")
        self.assertEqual(self.run_script("return first"), 0)

    def test_what_is_shown(self) -> None:
        """Path, body, arrows and cones come and go."""
        self.choose("loop")
        self.run_script("liveTop.clock.seek(2.3)")
        arrows = ("momentum", "omega", "force", "torque", "change")
        for name in ("body_shown", "trace", *arrows, "cones"):
            with self.subTest(name), self.changing(self.section):
                self.part(self.section, name).click()

    def test_two_tops_beside(self) -> None:
        """Two pictures, one eye, one time: all sliders are shared but the one that differs."""
        self.choose("loop")
        self.part(self.section, "keep").click()
        look = self.part(self.section, "second_look")
        with self.changing(self.section):
            look.find_element("css selector", "[value=beside]").click()
        differs = self.part(self.section, "differs")
        self.assertEqual(differs.get_property("value"), "omega3")
        differs.find_element("css selector", "[value=phi_rate]").click()
        box = self.part(self.section, "second_control").find_element("css selector", "[type=text]")
        self.type_into(box, "0.8\n")
        self.wait_for_text("second_name", "φ\N{PRIME}₀ = 0.8 rad/s: Waves")
        self.wait_for_text("first_name", "φ\N{PRIME}₀ = \N{MINUS SIGN}1.2 rad/s: Loops")
        self.type_into(self.control("theta", "text"), "40\n")
        starts = (
            "return [liveTop.track, liveTop.second.track].map((t) => [t.start.angle[1], t.phiRate])"
        )
        wait_for(lambda: self.run_script(starts)[0][0] < 0.7, "another tilt")
        (first, slow), (second, fast) = self.run_script(starts)
        self.assertEqual((first, slow, fast), (second, -1.2, 0.8))
        with self.changing(self.section):  # in both pictures
            self.run_script("liveTop.clock.seek(1.1)")
        state = "second=phi_rate:0.8&beside=yes"
        wait_for(lambda: state in self.run_script("return location.hash"), "the link")
        self.open(self.page, self.run_script("return location.hash"))
        self.wait_for_text("second_name", "φ\N{PRIME}₀ = 0.8 rad/s: Waves")
        self.set_screen(390, 844, touch=True)
        places = """
            return ["first_name", "second_name"].map((name) => {
                const { left, top } = liveTop.parts[name].getBoundingClientRect();
                return [left, top];
            });
        """
        wait_for(lambda: self.run_script(places)[0][0] == self.run_script(places)[1][0], "a stack")
        (_, upper), (_, lower) = self.run_script(places)
        self.assertLess(upper + 100, lower)

    def test_picture(self) -> None:
        """A picture is a PNG of the size of a screen."""
        script = """
            const [done] = arguments;
            HTMLAnchorElement.prototype.click = function () { done([this.download, this.href]); };
            liveTop.parts.picture.click();
        """
        name, address = self.browser.execute_async_script(script)
        data = base64.b64decode(address.partition(",")[2])
        self.assertEqual((name, data[:8]), ("spintop.png", b"\x89PNG\r\n\x1a\n"))
        size = [int.from_bytes(data[i : i + 4], "big") for i in (16, 20)]
        self.assertEqual(size, [1920, 1080])


# A new user's five minutes with the live top: where it sleeps, a cusp that becomes a loop.

WIDE, NARROW = 40, 10
"""Largest tilts of a top that falls, and of one that sleeps, in degrees."""


class WalkTest(LiveCase):
    """One walk, in one page that is opened once."""

    def setUp(self) -> None:
        """Open the page; the top stands: in motion a slow machine takes seconds for a key."""
        self.set_screen(*DESKTOP, prefers_reduced_motion="reduce")
        self.browser.get(self.page.as_uri())
        wait_for(lambda: self.read("class"), "the top")

    def read(self, name: str) -> str:
        return self.part(self.section, name).text

    def choose_by_title(self, title: str) -> None:
        menu = self.part(self.section, "preset")
        menu.find_element("xpath", f"option[. = '{title}']").click()

    def widest_tilt(self) -> float:
        """The largest tilt that the panel gives, in degrees."""
        facts = self.read("facts").splitlines()
        return float(facts[facts.index("Tilt") + 1].partition(" to ")[2].rstrip("°"))

    def press(self, name: str, key: str, until: Callable[[], bool]) -> None:
        slider = self.control(name, "range")
        for _ in range(40):
            if until():
                return
            slider.send_keys(key * 5)
            self.next_picture()
        self.fail(f"{self.read('class')} and {self.read('sleep')} to the end of the slider")

    def next_picture(self) -> None:
        """Wait for the picture that has what was changed."""
        self.browser.execute_async_script(
            "const [done] = arguments; requestAnimationFrame(() => requestAnimationFrame(done));"
        )

    def find_where_it_sleeps(self) -> None:
        """A top that is too slow falls; its spin is set to the threshold, and raised: it sleeps."""
        self.choose_by_title("Sleeping top, too slow")
        wait_for(lambda: "it falls" in self.read("meaning"), "a top that falls")
        self.assertIn("the threshold 21.81 rad/s: upright it falls", self.read("sleep"))
        tick = self.section.find_element("css selector", ".control[data-name=omega3] .tick")
        self.assertTrue(tick.is_displayed())
        self.assertGreater(self.widest_tilt(), WIDE)
        self.part(self.section, "threshold").click()
        box, omega3 = self.control("omega3", "text"), "return liveTop.state.omega3"
        wait_for(lambda: abs(self.run_script(omega3) - THRESHOLD) < 1e-9, "the threshold")
        self.assertEqual(float(box.get_property("value")), self.run_script(omega3))
        self.press("omega3", Keys.ARROW_RIGHT, lambda: self.widest_tilt() < NARROW)
        self.assertIn("it sleeps", self.read("meaning"))
        self.assertIn("upright it sleeps", self.read("sleep"))
        spin = float(box.get_property("value"))
        self.assertTrue(21.8119 < spin < 24, spin)
        self.choose("example1")
        wait_for(lambda: "upright it" not in self.read("meaning"), "a tilted top")

    def see_a_cusp_become_a_loop(self) -> None:
        """Released at rest, the axis makes cusps; less precession makes loops, more makes waves."""
        self.choose_by_title("Cusps")
        wait_for(lambda: self.read("class") == "Cusps", "cusps")
        self.assertEqual(self.control("phi_rate", "text").get_property("value"), "0")
        self.press("phi_rate", Keys.ARROW_LEFT, lambda: self.read("class") == "Loops")
        self.assertIn("reverses in every nutation", self.read("meaning"))
        self.assertLess(float(self.control("phi_rate", "text").get_property("value")), 0)
        self.press("phi_rate", Keys.ARROW_RIGHT, lambda: self.read("class") == "Waves")
        self.assertGreater(float(self.control("phi_rate", "text").get_property("value")), 0)
        self.assertEqual(self.part(self.section, "preset").get_property("value"), "")
        self.press("phi_rate", Keys.ARROW_LEFT, lambda: self.read("class") == "Loops")

    def test_walk(self) -> None:
        self.find_where_it_sleeps()
        self.see_a_cusp_become_a_loop()
