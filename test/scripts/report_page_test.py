"""Tests of the page that scripts/report makes, in a browser."""

import csv
import json
import math
from pathlib import Path

from selenium.webdriver import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.keys import Keys

from browser_case import DESKTOP, HOSTILE, SOFTWARE_WEBGL, BrowserCase, wait_for
from conftest import EXE, ROOT, execute
from reporting.packages import bundle
from reporting.page import make_page, write_page
from reporting.study import read_study

BYTES = 8_000_000

THIN = """
    document.querySelectorAll("tbody tr:nth-child(n + 8)").forEach((part) => part.remove());
"""
"""Leaves a page with seven rows of each table."""


def rows_of(
    table: Path, names: tuple[str, ...] = ("t", "phi", "theta", "psi")
) -> list[list[float]]:
    lines = [line for line in table.read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    return [[float(row[name]) for name in names] for row in csv.DictReader(lines)]


class ReportPageTest(BrowserCase):
    def test_opens_whole(self) -> None:
        """It is small, and all of it is in the file."""
        self.assertLess(self.page.stat().st_size, BYTES)
        self.open(self.page)
        script = "return performance.getEntriesByType('navigation')[0].loadEventEnd"
        wait_for(lambda: self.run_script(script), "the page")
        script = "return performance.getEntriesByType('resource').map((one) => one.name)"
        fetched = [
            name for name in self.run_script(script) if not name.startswith(("data:", "blob:"))
        ]
        self.assertEqual(fetched, [])

    def test_network_is_forbidden(self) -> None:
        """Requests, and scripts that are not part of the page, are blocked."""
        script = """
            const done = arguments[0], stopped = [];
            document.addEventListener("securitypolicyviolation", (event) => {
                stopped.push(event.effectiveDirective);
            });
            fetch("http://localhost:9/").catch(() => {});
            const add = (name, attributes) => {
                document.body.append(Object.assign(document.createElement(name), attributes));
            };
            add("img", { src: "http://localhost:9/a.png" });
            add("script", { textContent: "globalThis.hacked = 1" });
            add("iframe", { src: "http://localhost:9/" });
            setTimeout(() => done([stopped, "hacked" in globalThis]), 500);
        """
        stopped, hacked = self.browser.execute_async_script(script)
        self.assertFalse(hacked)
        expected = {"connect-src", "img-src", "script-src-elem", "frame-src"}
        self.assertEqual(set(stopped), expected)
        messages = self.browser.get_log("browser")
        self.assertTrue(all("Content Security Policy" in m["message"] for m in messages))

    def test_hostile_title_is_text(self) -> None:
        """The page shows it character by character, and does not execute it."""
        title = HOSTILE.replace("''", "'")
        headings = self.run_script(
            "return [...document.querySelectorAll('h2')].map(h => h.textContent)"
        )
        self.assertIn(title, headings)
        section = self.top("hostile.csv")
        self.assertIn(title, self.part(section, "stage").get_attribute("aria-label"))
        images = self.run_script(
            "return [...document.images].filter(i => i.src.slice(0, 5) != 'data:').length"
        )
        self.assertEqual((images, self.run_script("return typeof hacked")), (0, "undefined"))

    def test_pictures_are_shown(self) -> None:
        """Every picture has something on it, and says what."""
        sizes = self.run_script(
            "document.querySelectorAll('.figures figure').forEach("
            "(f) => { f.style.contentVisibility = 'visible' });"
            "return Promise.all([...document.querySelectorAll('.figures img')].map((i) =>"
            "i.decode().then(() => [i.naturalWidth, i.alt])))"
        )
        self.assertGreater(len(sizes), 10)
        for width, text in sizes:
            self.assertGreater(width, 100)
            self.assertTrue(text)

    def test_contents_show_all_figures(self) -> None:
        """The first is on the first screen; every figure has a thumbnail that leads to it."""
        tops, links = self.run_script(
            "const small = [...document.querySelectorAll('.thumbnails img')];"
            "return [small.map((i) => i.naturalWidth && i.getBoundingClientRect().bottom),"
            "small.map((i) => i.closest('a').getAttribute('href').slice(1))]"
        )
        self.assertTrue(all(tops))
        self.assertLess(tops[0], DESKTOP[1])
        figures = "[...document.querySelectorAll('.figures figure')].map((f) => f.id)"
        self.assertEqual(links, self.run_script(f"return {figures}"))

    def test_a_figure_is_enlarged(self) -> None:
        """A tap on a figure fills the screen with it, wider than that; another one closes it."""
        self.set_screen(390, 844, touch=True)
        self.open(self.page)
        for place in range(2):
            label = self.browser.find_elements("css selector", ".figures .enlarge")[place]
            self.run_script("arguments[0].scrollIntoView({ behavior: 'instant' })", label)
            box = "const r = arguments[0].getBoundingClientRect(); return [r.width, r.height]"
            narrow = self.run_script(box, label)
            label.click()
            self.assertEqual(self.run_script(box, label), [390, 844])
            inside = "return arguments[0].lastElementChild.getBoundingClientRect().width"
            self.assertGreater(self.run_script(inside, label), 700)
            label.click()
            self.assertEqual(self.run_script(box, label), narrow)

    def test_accessibility(self) -> None:
        """axe finds nothing: names, contrasts, landmarks; light and dark, wide and narrow.

        It takes a millisecond and more for each of 25,000 elements: only the first screen has all
        of them. The rows of a table differ in their numbers only.
        """
        screens = [(*DESKTOP, "light"), (390, 844, "dark")]
        for width, height, scheme in screens:
            with self.subTest(width=width, scheme=scheme):
                self.set_screen(width, height, prefers_color_scheme=scheme)
                self.open(self.page)
                self.open_details()
                self.top()
                if scheme != "light":
                    self.run_script(THIN)
                self.assertEqual(self.violations(), [])

    def test_live_top(self) -> None:
        """A body that the page can compute has a live top, which opens with its scene."""
        cards = self.browser.find_elements("css selector", "section.live.closed")
        script = "return arguments[0].closest('article').querySelector('.lead code').textContent"
        by_table = {self.run_script(script, card): card for card in cards}
        self.assertIn("spinning_wheel_figure11.csv", by_table)
        self.assertIn("heavy_top_benchmark.csv", by_table)  # its axis of symmetry is body y
        card = by_table["slow_top.csv"]
        self.run_script("arguments[0].scrollIntoView({ behavior: 'instant' })", card)
        card.find_element("css selector", "button").click()
        wait_for(lambda: self.run_script("return arguments[0].top?.track?.count > 0", card), "it")
        self.assertEqual(self.part(card, "class").text, "Cusps")
        state = self.run_script("return arguments[0].top.state", card)
        expected = {"theta": 11.25, "omega3": 1, "inertia1": 0.875}
        self.assertEqual({key: state[key] for key in expected}, expected)
        self.run_script("arguments[0].top.clock.pause()", card)
        self.assertEqual(self.violations(card), [])
        self.assertEqual(self.run_script("return location.hash"), "")

    def test_proved_digits(self) -> None:
        """Where a column has bounds beside it, its proved digits are set apart, with the bound."""
        folder = self.folder.parent / "proved"
        folder.mkdir(exist_ok=True)
        lines = (self.folder / "slow_top.csv").read_text(encoding="utf-8").splitlines()
        lines = [line for line in lines if not line.startswith("# end: ")]  # of other rows
        rows = [i for i, line in enumerate(lines) if line[0] != "#"]
        for i in rows:
            lines[i] += ",theta_bound" if i == rows[0] else ",2e-9"
        (folder / "slow_top.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        page, _ = make_page("proved", *read_study(folder))
        write_page(page, folder / "report.html")
        self.open(folder / "report.html")
        self.open_details()
        shown = self.run_script(
            "const look = getComputedStyle;"
            "return [...document.querySelectorAll('td .proved')].map((b) => [b.textContent,"
            " b.parentElement.textContent, b.title, look(b).fontWeight,"
            " look(b).color != look(b.parentElement).color, b.getBoundingClientRect().width > 10])"
        )
        self.assertGreater(len(shown), 10)
        for proved, whole, *rest in shown:
            self.assertEqual(rest, ["off by 2e\N{MINUS SIGN}09 at most", "700", True, True])
            self.assertEqual(len(proved.partition(".")[2]), 8)  # half a unit is 5e-9
            self.assertEqual(whole[: len(proved)], proved)
            self.assertEqual(len(whole), len(proved) + 2)

    def test_narrow_screen(self) -> None:
        """No part is wider than the screen of a telephone."""
        self.set_screen(360, 740)
        self.open(self.page)
        self.top()
        widths = self.run_script("return [document.documentElement.scrollWidth, innerWidth]")
        self.assertEqual(*widths)

    def test_the_rest_works(self) -> None:
        """The page says so in place of the top; time, numbers and charts work as ever."""
        section, rows = self.top(), rows_of(self.folder / "slow_top.csv")
        hint = section.find_element("css selector", ".stage .hint")
        wait_for(lambda: "no WebGL" in hint.text, "the sentence")
        chart = self.part(section, "chart")
        before = chart.screenshot_as_png
        self.part(section, "play").click()
        wait_for(lambda: self.numbers(section)[0] > 0, "time to pass")
        self.part(section, "play").click()
        self.assertNotEqual(chart.screenshot_as_png, before)
        self.run_script(
            "arguments[0].value = 100; arguments[0].dispatchEvent(new Event('input'))",
            self.part(section, "time"),
        )
        self.assertEqual(self.numbers(section), rows[100])

    def test_modules(self) -> None:
        """Attitudes, the motion between rows, the clock."""
        page = self.folder / "modules.html"
        script = bundle(ROOT / "test/page" / "all.js")
        page.write_text(
            "<!DOCTYPE html><meta charset=utf-8><link rel=icon href='data:,'>"
            f"<script>{script}</script>",
            encoding="utf-8",
        )
        self.open(page)
        results = json.loads(self.run_script("return JSON.stringify(results)"))
        self.assertGreater(len(results), 12)
        for result in results:
            with self.subTest(result["name"]):
                self.assertEqual(result["failure"], "")


class TopTest(BrowserCase):
    flags = SOFTWARE_WEBGL

    def scrub(self, section: object, row: int) -> None:
        self.run_script(
            "arguments[0].value = arguments[1];"
            "arguments[0].dispatchEvent(new Event('input', { bubbles: true }))",
            self.part(section, "time"),
            row,
        )

    def set_speed(self, section: object, which: int) -> None:
        self.run_script(
            "arguments[0].selectedIndex = arguments[1];"
            "arguments[0].dispatchEvent(new Event('change'))",
            self.part(section, "speed"),
            which,
        )

    def press(self, section: object, *keys: str) -> None:
        self.part(section, "stage").send_keys("".join(keys))

    def test_plays_and_pauses(self) -> None:
        """Time goes on from the button's press to its next."""
        section = self.top()
        self.set_speed(section, 0)
        button = self.part(section, "play")
        self.assertEqual(button.get_attribute("aria-label"), "Play")
        with self.changing(section):
            button.click()
            self.assertEqual(button.get_attribute("aria-label"), "Pause")
            first = wait_for(lambda: self.numbers(section)[0], "time to pass")
            wait_for(lambda: self.numbers(section)[0] > first, "time to pass")
        button.click()
        rest = self.numbers(section)
        self.picture(section)
        self.assertEqual(self.numbers(section), rest)
        live = self.part(section, "live")
        wait_for(lambda: live.get_attribute("textContent").startswith("t "), "the announcement")

    def test_ends_and_begins_again(self) -> None:
        """At the end it stops, at the last row of the table; then it plays from the start."""
        section = self.top()
        last = rows_of(self.folder / "slow_top.csv")[-1]
        self.scrub(section, len(rows_of(self.folder / "slow_top.csv")) - 100)
        button = self.part(section, "play")
        button.click()
        wait_for(lambda: button.get_attribute("aria-label") == "Play", "the end")
        self.assertEqual(self.numbers(section), last)
        self.set_speed(section, 0)
        button.click()
        wait_for(lambda: self.numbers(section)[0] < last[0], "the start")

    def test_shows_the_rows_of_the_table(self) -> None:
        """At ten times that are rows, the bits of the table."""
        for table in ("slow_top.csv", "spinning_wheel_figure11.csv"):
            section, rows = self.top(table), rows_of(self.folder / table)
            for part in range(10):
                row = (part * (len(rows) - 1)) // 9
                self.scrub(section, row)
                self.assertEqual(self.numbers(section), rows[row], f"row {row} of {table}")
                self.assertEqual(self.part(section, "row").text, f"row {row + 1} of {len(rows)}")

    def test_angles_from_a_quaternion(self) -> None:
        """A table without angles has them computed, and the page says so."""
        section = self.top("heavy_top_benchmark.csv")
        self.assertIn("computed from the quaternion", self.part(section, "notes").text)
        lines = (self.folder / "heavy_top_benchmark.csv").read_text(encoding="utf-8").splitlines()
        rows = list(csv.DictReader(line for line in lines if line[0] != "#"))
        q = [float(rows[200][f"q{k}"]) for k in range(4)]
        self.scrub(section, 200)
        cosine = 1 - 2 * (q[1] ** 2 + q[2] ** 2)
        self.assertAlmostEqual(math.cos(self.numbers(section)[2]), cosine, places=13)

    def test_keys(self) -> None:
        section, rows = self.top(), rows_of(self.folder / "slow_top.csv")
        self.press(section, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
        self.assertEqual(self.numbers(section), rows[1])
        self.press(section, Keys.END)
        self.assertEqual(self.numbers(section), rows[-1])
        self.press(section, Keys.HOME)
        self.assertEqual(self.numbers(section), rows[0])
        self.press(section, Keys.PAGE_UP)
        self.assertEqual(self.numbers(section), rows[math.floor(len(rows) / 10 + 0.5)])
        self.press(section, Keys.PAGE_DOWN, Keys.PAGE_DOWN)
        self.assertEqual(self.numbers(section), rows[0])
        self.set_speed(section, 1)
        self.press(section, " ")
        wait_for(lambda: self.numbers(section)[0] > 0, "time to pass")
        self.press(section, " ")
        self.assertEqual(self.part(section, "play").get_attribute("aria-label"), "Play")
        speed = self.part(section, "speed")
        before = float(speed.get_property("value"))
        self.press(section, ".")
        self.assertGreater(float(speed.get_property("value")), before)
        self.press(section, ",")
        self.assertEqual(float(speed.get_property("value")), before)
        for keys in ("+", "-", "0", Keys.SHIFT + Keys.ARROW_LEFT, Keys.SHIFT + Keys.ARROW_UP):
            with self.subTest(keys=keys):
                if keys == "0":
                    self.press(section, "+", "+")
                with self.changing(section):
                    self.press(section, keys)
        slider = self.part(section, "time")
        slider.send_keys(Keys.HOME, Keys.ARROW_RIGHT)
        self.assertEqual(self.numbers(section), rows[1])
        self.assertTrue(slider.get_attribute("aria-valuetext").startswith("t = "))

    def test_focus_is_seen(self) -> None:
        """The focus has an outline, and Tab reaches all controls."""
        section = self.top()
        self.part(section, "stage").send_keys("")
        reached = []
        for _ in range(11):
            active = self.browser.switch_to.active_element
            reached.append(active.get_attribute("data-part") or active.tag_name)
            self.assertNotEqual(active.value_of_css_property("outline-style"), "none", reached[-1])
            active.send_keys(Keys.TAB)
        expected = ["stage", "trace", "force", "momentum", "omega", "peer", "summary"]
        self.assertEqual(reached, [*expected, "play", "time", "speed", "reset"])

    def test_mouse(self) -> None:
        """Dragging turns the top, the wheel takes one nearer, the chart goes to a time."""
        section = self.top()
        stage = self.part(section, "stage")
        with self.changing(section):
            ActionChains(self.browser).drag_and_drop_by_offset(stage, 90, 30).perform()
        scrolled = self.run_script("return scrollY")
        with self.changing(section):
            origin = ScrollOrigin.from_element(stage)
            ActionChains(self.browser).scroll_from_origin(origin, 0, -240).perform()
        self.assertEqual(self.run_script("return scrollY"), scrolled)
        ActionChains(self.browser).move_to_element(self.part(section, "chart")).click().perform()
        middle = self.numbers(section)[0] / rows_of(self.folder / "slow_top.csv")[-1][0]
        self.assertAlmostEqual(middle, 0.5, places=2)

    def test_wheel_scrolls_the_page_at_first(self) -> None:
        """One does not get caught in a drawing on the way down."""
        stage = self.part(self.top(), "stage")
        scrolled = self.run_script("return scrollY")
        origin = ScrollOrigin.from_element(stage)
        ActionChains(self.browser).scroll_from_origin(origin, 0, 200).perform()
        wait_for(lambda: self.run_script("return scrollY") > scrolled, "the page to scroll")

    def test_touch(self) -> None:
        """After a tap one finger turns, two take nearer; a tap plays."""
        self.set_screen(390, 844, touch=True)
        self.open(self.page)
        section = self.top()
        stage = self.part(section, "stage")
        box = self.box(stage)
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        before = self.picture(section)
        self.touch([[(x, y)], [(x + 40, y)], [(x + 80, y + 10)]])
        self.assertNotEqual(stage.get_attribute("data-held"), "yes")
        self.assertEqual(self.picture(section), before)
        canvas = self.parts(section, ".stage canvas")[0]
        self.assertEqual(canvas.value_of_css_property("touch-action"), "pan-x pan-y")
        self.touch([[(x, y)]])
        wait_for(lambda: stage.get_attribute("data-held") == "yes", "the stage to be held")
        self.assertEqual(canvas.value_of_css_property("touch-action"), "none")
        with self.changing(section):
            self.touch([[(x, y)], [(x + 40, y)], [(x + 80, y + 10)]])
        with self.changing(section):
            apart = [[(x - d, y), (x + d, y)] for d in (20, 50, 80)]
            self.touch(apart)
        box = self.box(self.part(section, "play"))
        self.touch([[(box["x"] + 20, box["y"] + 20)]])
        wait_for(lambda: self.numbers(section)[0] > 0, "time to pass")
        self.assertEqual(stage.get_attribute("data-held"), "no")

    def touch(self, places: list[list[tuple[float, float]]]) -> None:
        for kind, fingers in [("touchStart", places[0]), *(("touchMove", p) for p in places[1:])]:
            points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(fingers)]
            self.tell("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.tell("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def test_what_is_shown(self) -> None:
        """Trace and arrows come and go; what the table lacks cannot be had."""
        section = self.top()
        self.scrub(section, 700)
        for name in ("trace", "force", "momentum"):
            with self.subTest(name), self.changing(section):
                self.part(section, name).click()
        heavy = self.top("heavy_top_benchmark.csv")
        self.assertFalse(self.part(heavy, "force").is_enabled())

    def test_numbers_of_the_moment(self) -> None:
        """Rates, angular velocity and energies are those of the row."""
        section, names = self.top(), ("theta_rate", "psi_rate", "kinetic", "energy")
        self.scrub(section, 700)
        row = rows_of(self.folder / "slow_top.csv", names)[700]
        for name, value in zip(names, row, strict=True):
            self.assertAlmostEqual(self.number(section, name), value, places=3)
        omega = [self.number(section, f"omega{k}") for k in (1, 2, 3)]
        self.assertAlmostEqual(omega[2], 1.0, places=4)
        momentum = 0.875 * (omega[0] ** 2 + omega[1] ** 2) / 2 + 0.25 * omega[2] ** 2 / 2
        self.assertAlmostEqual(momentum, row[2], delta=1e-3 * row[2])

    def number(self, section: object, name: str) -> float:
        return float(self.part(section, name).text.replace("\N{MINUS SIGN}", "-"))

    def test_two_motions(self) -> None:
        """A method is compared with the exact solution of its scene, as a ghost; or with none."""
        section = self.top("slow_top_scenario2_rk4.csv")
        peer = self.part(section, "peer")
        options = [option.text for option in peer.find_elements("css selector", "option")]
        self.assertEqual(options, ["none", "Slow top of Example 1, exact solution"])
        angles = self.part(section, "angles")
        wait_for(angles.is_displayed, "the angles between the motions")
        self.scrub(section, 600)
        shown = self.part(section, "between_attitudes").text
        errors = [row[0] for row in rows_of(self.with_errors(), ("orientation_error",))]
        self.assertEqual(shown, f"{math.degrees(errors[600]):.2f}\N{DEGREE SIGN}")
        told = f"{math.degrees(max(errors)):.2f}\N{DEGREE SIGN}"
        self.assertIn(f"Largest at rows: {told}", self.part(section, "farthest").text)
        with self.changing(section):
            script = "arguments[0].value = ''; arguments[0].dispatchEvent(new Event('change'))"
            self.run_script(script, peer)
            wait_for(lambda: not angles.is_displayed(), "one motion alone")
        exact = self.top("slow_top.csv")
        self.assertFalse(self.part(exact, "angles").is_displayed())
        self.assertFalse(self.part(self.top("heavy_top_benchmark.csv"), "versus").is_displayed())

    def with_errors(self) -> Path:
        """The same motion with the column of its error, which the program measures."""
        folder, name = self.folder.parent / "errors", "slow_top_scenario2_rk4"
        setting = "--set=output.columns=t,orientation_error"
        execute(EXE, "--quiet", "-o", folder, setting, ROOT / f"input/{name}.nml")
        return folder / f"{name}.csv"

    def test_saved_table(self) -> None:
        """A table is saved as it is, to the last byte, by its own name."""
        self.top()
        script = """
            const [name, done] = arguments;
            const click = HTMLAnchorElement.prototype.click;
            HTMLAnchorElement.prototype.click = async function () {
                HTMLAnchorElement.prototype.click = click;
                done([this.download, made.size, await made.text()]);
            };
            let made = null;
            const create = URL.createObjectURL;
            URL.createObjectURL = (blob) => { made = blob; return create(blob); };
            const links = [...document.querySelectorAll("a.data")];
            const link = links.find((one) => one.dataset.name === name);
            link.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true }));
        """
        for name in ("slow_top.csv", "spinning_wheel_sweep.csv"):
            saved, size, text = self.browser.execute_async_script(script, name)
            self.assertEqual(saved, name)
            self.assertEqual(size, (self.folder / name).stat().st_size)
            self.assertEqual(text, (self.folder / name).read_text(encoding="utf-8"))

    def test_paper(self) -> None:
        """On paper every top is a still, and no control is there."""
        section = self.top()
        self.tell("Page.printToPDF", printBackground=True)
        stills = self.run_script(
            "return [...document.querySelectorAll('.still img')]"
            ".map((i) => [i.naturalWidth, i.alt, i.closest('figure').textContent])"
        )
        self.assertEqual(len(stills), 5)
        for width, text, caption in stills:
            self.assertGreater(width, 500)
            self.assertTrue(text.startswith("The top at t = "))
            self.assertIn("θ = ", caption)
        self.assertFalse(self.parts(section, ".still")[0].is_displayed())
        self.tell("Emulation.setEmulatedMedia", media="print")
        self.assertTrue(self.parts(section, ".still")[0].is_displayed())
        self.assertFalse(self.part(section, "play").is_displayed())
        self.open_details()
        cut = (
            "return [...document.querySelectorAll('.scroll, pre')].filter((s) =>"
            "s.scrollHeight > s.clientHeight + 1 || s.scrollWidth > s.clientWidth + 1)"
            ".map((s) => s.textContent.trim().slice(0, 80))"
        )
        self.assertEqual(self.run_script(cut), [])
        self.tell("Emulation.setEmulatedMedia", media="")

    def test_calm(self) -> None:
        """Nothing moves by itself, also with the preference for reduced motion."""
        self.set_screen(*DESKTOP, prefers_reduced_motion="reduce")
        self.open(self.page)
        section = self.top()
        self.assertEqual(self.numbers(section)[0], 0)
        style = "return getComputedStyle(document.documentElement).scrollBehavior"
        self.assertEqual(self.run_script(style), "auto")

    def test_account(self) -> None:
        """Pictures have descriptions in words."""
        section = self.top()
        self.assertIn("between 11.25° and 174.77°", self.part(section, "account").text)
        boxes = (
            "return [...arguments[0].querySelectorAll('.shown input')].map((i) => i.clientWidth)"
        )
        self.assertEqual(len(set(self.run_script(boxes, section))), 1)

    def test_few_drawings_at_a_time(self) -> None:
        """Only what is near the screen takes memory of the graphics card."""
        for table in ("heavy_top_benchmark.csv", "spinning_wheel_figure11.csv", "slow_top.csv"):
            self.top(table)
        count = "return document.querySelectorAll('.stage canvas').length"
        self.assertLess(
            self.run_script(count), self.run_script(count.replace(".stage canvas", ".top"))
        )
