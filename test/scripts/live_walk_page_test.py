"""A new user's five minutes with the live top: where it sleeps, a cusp that becomes a loop.

Everything is done with what is on the screen: menus, keys and buttons.
"""

from collections.abc import Callable

from browser_case import DESKTOP, LiveCase, wait_for

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
        """What one reads on the screen."""
        return self.part(self.section, name).text

    def choose_by_title(self, title: str) -> None:
        """Choose a preset from the menu."""
        menu = self.part(self.section, "preset")
        menu.find_element("xpath", f"option[. = '{title}']").click()

    def widest_tilt(self) -> float:
        """The largest tilt that the panel gives, in degrees."""
        facts = self.read("facts").splitlines()
        return float(facts[facts.index("Tilt") + 1].partition(" to ")[2].rstrip("°"))

    def press(self, name: str, key: str, until: Callable[[], bool]) -> None:
        """Press an arrow key on a slider until one sees what one wants."""
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
        from selenium.webdriver.common.keys import Keys

        self.choose_by_title("Sleeping top, too slow")
        wait_for(lambda: "it falls" in self.read("meaning"), "a top that falls")
        self.assertIn("the threshold 21.81 rad/s: upright it falls", self.read("sleep"))
        self.assertGreater(self.widest_tilt(), WIDE)
        self.part(self.section, "threshold").click()
        box = self.control("omega3", "text")
        wait_for(lambda: box.get_property("value").startswith("21.811"), "the threshold")
        self.press("omega3", Keys.ARROW_RIGHT, lambda: self.widest_tilt() < NARROW)
        self.assertIn("it sleeps", self.read("meaning"))
        spin = float(self.control("omega3", "text").get_property("value"))
        self.assertTrue(21.8119 < spin < 24, spin)

    def see_a_cusp_become_a_loop(self) -> None:
        """Released at rest, the axis makes cusps; less precession makes loops, more makes waves."""
        from selenium.webdriver.common.keys import Keys

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
        """From the open page to loops."""
        self.find_where_it_sleeps()
        self.see_a_cusp_become_a_loop()
