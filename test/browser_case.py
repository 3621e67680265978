"""Shared by the tests of pages: a study with its report, the live top, and a browser."""

import atexit
import contextlib
import functools
import json
import os
import shutil
import tempfile
import time
import unittest
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.keys import Keys

from conftest import EXE, ROOT, execute
from reporting.packages import PackageError, esbuild_package, need
from reporting.page import make_alone, make_page, write_page
from reporting.study import read_study

BROWSER = os.environ.get("SPINTOP_BROWSER", "")
INPUTS = ("slow_top", "heavy_top_benchmark", "spinning_wheel_figure11", "spinning_wheel_sweep")

HOSTILE = "</script><img src=x onerror=hacked=1>''\"& {{ 7*7 }} <b>"
"""A title that would do harm if it were taken as HTML; quotes as in a namelist."""

FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--overscroll-history-navigation=0"),
    *("--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--hide-scrollbars"),
)
SOFTWARE_WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
NO_WEBGL = ("--disable-3d-apis",)
DESKTOP = (1000, 640)
PATIENCE = 300.0
"""Seconds until something that should happen has not."""

READY = "return document.documentElement.dataset.ready"
"""Whether all tops have their data."""

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]
"""Of axe, that a page obeys."""

DRIVERS_OWN = "GL Driver Message"
"""Messages of a software renderer about its speed."""


def new_scratch(prefix: str) -> Path:
    """A folder that is removed at the end of all tests."""
    folder = Path(tempfile.mkdtemp(prefix=prefix))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def need_packages(*names: str) -> None:
    """Skip the tests where the packages of a page cannot be had."""
    try:
        for name in names:
            need(name)
    except PackageError as error:
        raise unittest.SkipTest(str(error)) from error


@functools.cache
def make_study() -> Path:
    """Compute a few studies, one with a hostile title; return their report. Once for all tests."""
    folder = new_scratch("report test ") / "study"
    folder.mkdir()
    inputs = [ROOT / "input" / f"{name}.nml" for name in INPUTS]
    quiet = (EXE, "--quiet", "-o", folder)
    execute(*quiet, *inputs)
    columns = "t,phi,theta,psi,phi_rate,theta_rate,psi_rate,kinetic,potential,energy"
    compared = ROOT / "input/slow_top_scenario2_rk4.nml"
    execute(*quiet, f"--set=output.columns={columns}", compared)
    hostile = folder / "hostile.nml"
    text = inputs[0].read_text(encoding="utf-8")
    title = next(line for line in text.splitlines() if line.strip().startswith("title"))
    hostile.write_text(text.replace(title, f"    title = '{HOSTILE}'"), encoding="utf-8")
    few = ("--set", "span.samples=41", "--set", "output.columns=t,phi,theta,psi")
    execute(*quiet, *few, hostile)
    sections, problems = read_study(folder)
    page, lack = make_page(folder.name, sections, problems)
    if problems or lack:
        raise AssertionError([*problems, lack])
    write_page(page, folder / "report.html")
    return folder / "report.html"


@functools.cache
def make_live_page() -> Path:
    """Make the page with the live top alone. Once for all tests."""
    page = new_scratch("live ") / "pages" / "live.html"
    page.parent.mkdir()
    write_page(make_alone("--live"), page)
    return page


@functools.cache
def shared_browser(flags: tuple[str, ...]) -> object:
    """A browser for all tests with these flags; each test opens its page and sets its screen."""
    browser = open_browser(new_scratch("browser "), *flags)
    atexit.register(browser.quit)
    return browser


def open_browser(profile: Path, *flags: str) -> object:
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, *flags, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    browser.set_script_timeout(PATIENCE)
    return browser


def wait_for(condition: Callable[[], object], what: str) -> object:
    """Wait until a condition holds, and give what it gave."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if result := condition():
            return result
        time.sleep(0.05)
    raise AssertionError(f"waited in vain for {what}")


@pytest.mark.slow
class BrowserCase(unittest.TestCase):
    """A browser, with the report of a study opened anew before each test.

    It has no WebGL, which in software takes three times as long as all the rest.
    """

    flags: tuple[str, ...] = NO_WEBGL

    @classmethod
    def setUpClass(cls) -> None:
        if not BROWSER:
            raise unittest.SkipTest("no browser: scripts/test installs one, where it may")
        need_packages("three", "axe-core", esbuild_package())
        cls.page = cls.make_page()
        cls.folder = cls.page.parent
        cls.browser = shared_browser(cls.flags)

    make_page = staticmethod(make_study)

    def setUp(self) -> None:
        """Open the report on a desktop's screen."""
        self.set_screen(*DESKTOP)
        self.open(self.page)

    def tearDown(self) -> None:
        """There were no messages, and no requests."""
        entries = self.browser.get_log("browser")
        bad = [e["message"] for e in entries if DRIVERS_OWN not in e["message"]]
        self.assertEqual(bad, [])
        self.assertEqual(self.fetched(), set())

    def open(self, page: Path) -> None:
        """Open a page, from which a finger that moves to the right finds no way back."""
        self.browser.get(page.as_uri())
        self.tell("Page.resetNavigationHistory")

    def set_screen(self, width: int, height: int, touch: bool = False, **media: str) -> None:
        """Have a screen of this size, with the media features given."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": touch}
        self.tell("Emulation.setDeviceMetricsOverride", **metrics)
        self.tell("Emulation.setTouchEmulationEnabled", enabled=touch)
        features = [{"name": key.replace("_", "-"), "value": value} for key, value in media.items()]
        self.tell("Emulation.setEmulatedMedia", features=features)

    def tell(self, command: str, **arguments: object) -> object:
        return self.browser.execute_cdp_cmd(command, arguments)

    def run_script(self, script: str, *arguments: object) -> object:
        return self.browser.execute_script(script, *arguments)

    def open_details(self) -> None:
        self.run_script("document.querySelectorAll('details').forEach((d) => { d.open = true })")

    def fetched(self) -> set[str]:
        """Requests other than for the pages and their parts."""
        asked, stopped = {}, set()
        for entry in self.browser.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            facts = message["params"]
            if message["method"] == "Network.requestWillBeSent":
                asked[facts["requestId"]] = facts["request"]["url"]
            elif facts.get("blockedReason") == "csp":
                stopped.add(facts["requestId"])
        own = ("data:", "blob:", self.folder.parent.as_uri(), "chrome:", "about:")
        addresses = {url for key, url in asked.items() if key not in stopped}
        return {url for url in addresses if not url.startswith(own)}

    def top(self, table: str = "slow_top.csv") -> object:
        """The moving top of a table, brought to the screen."""
        section = self.run_script(
            "const code = [...document.querySelectorAll('article .lead code')]"
            ".find((one) => one.textContent === arguments[0]);"
            "const top = code.closest('article').querySelector('section.top');"
            "top.scrollIntoView({ behavior: 'instant' }); return top;",
            table,
        )
        wait_for(lambda: self.run_script(READY), "the data")
        drawn = ".stage canvas" if self.flags == SOFTWARE_WEBGL else ".hint"
        wait_for(lambda: self.parts(section, drawn), "the drawing")
        return section

    def violations(self, section: object = None) -> list:
        """What axe finds on the page, or on a section of it."""
        axe = (need("axe-core") / "axe.min.js").read_text(encoding="utf-8")
        self.tell("Runtime.evaluate", expression=axe)
        return self.browser.execute_async_script(
            "const [section, rules, done] = arguments;"
            "axe.run(section ?? document, { runOnly: rules })"
            ".then(({ violations }) => done(violations.map((v) => "
            "[v.id, v.help, v.nodes.slice(0, 3).map((n) => n.html)])))",
            section,
            RULES,
        )

    def parts(self, section: object, selector: str) -> list:
        return section.find_elements("css selector", selector)

    def part(self, section: object, name: str) -> object:
        return section.find_element("css selector", f"[data-part={name}]")

    def box(self, part: object) -> dict[str, float]:
        return self.run_script("return arguments[0].getBoundingClientRect().toJSON()", part)

    def numbers(self, section: object) -> list[float]:
        texts = [self.part(section, name).text for name in ("t", "phi", "theta", "psi")]
        return [float(text.replace("\N{MINUS SIGN}", "-")) for text in texts]

    def picture(self, section: object) -> bytes:
        return self.part(section, "stage").screenshot_as_png

    @contextlib.contextmanager
    def changing(self, section: object) -> Iterator[None]:
        """The drawing is another one afterwards."""
        before = self.picture(section)
        yield
        wait_for(lambda: self.picture(section) != before, "another drawing")


class LiveCase(BrowserCase):
    """A browser with the live top, opened anew before each test."""

    make_page = staticmethod(make_live_page)

    def setUp(self) -> None:
        self.set_screen(*DESKTOP, prefers_reduced_motion="reduce")
        self.open(self.page)

    def open(self, page: Path, link: str = "") -> None:
        """Open the page with a state, at rest."""
        self.browser.get("about:blank")
        self.browser.get(page.as_uri() + link)
        wait_for(lambda: self.run_script("return globalThis.liveTop?.track?.count > 0"), "the top")
        self.run_script("liveTop.clock.pause()")

    @property
    def section(self) -> object:
        return self.browser.find_element("css selector", "section.live")

    def text(self, name: str) -> str:
        return self.part(self.section, name).get_property("textContent")

    def choose(self, preset: str) -> None:
        self.run_script(
            "const { preset } = liveTop.parts; preset.value = arguments[0];"
            "preset.dispatchEvent(new Event('change')); liveTop.clock.pause();",
            preset,
        )

    def control(self, name: str, kind: str) -> object:
        """The slider (range) or the box (text) of a number."""
        selector = f".control[data-name={name}] input[type={kind}]"
        return self.section.find_element("css selector", selector)

    def type_into(self, box: object, text: str) -> None:
        """Type a text in place of what a box contains."""
        box.send_keys(Keys.CONTROL + "a")
        box.send_keys(text)

    def wait_for_text(self, name: str, words: str) -> None:
        wait_for(lambda: words in self.text(name), f"{words} instead of {self.text(name)}")

    def wait_for_class(self, name: str) -> None:
        wait_for(lambda: self.text("class") == name, f"{name} instead of {self.text('class')}")
