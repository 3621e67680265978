"""The top in motion from Python: the page, and a notebook's frame in a browser."""

import base64
import gzip
import json
import re
import tempfile
import unittest
from pathlib import Path

import pytest

import python_library  # noqa: F401
import spintop
from browser_case import (
    BROWSER,
    HOSTILE,
    READY,
    SOFTWARE_WEBGL,
    need_packages,
    open_browser,
    wait_for,
)
from reporting.packages import esbuild_package

pytestmark = pytest.mark.slow

BODY = spintop.Body(mass=1, inertia=(0.875, 0.875, 0.25), length=0.75**0.5)
TOP = spintop.Top(BODY, theta=0.2, psi_rate=1.0)
SPAN = {"t_end": 3.0, "samples": 31}
SHOWN = """
    return Object.fromEntries([...document.querySelectorAll("[data-part]")].map(
        (part) => [part.dataset.part, part.textContent]));
"""


def lines_shown(page: str) -> list[str]:
    """The lines of the table in a page, without its date and the checksum of a file."""
    packed = re.search('data:application/gzip;base64,([^"]*)', page)[1]
    text = gzip.decompress(base64.b64decode(packed)).decode()
    return [line for line in text.splitlines() if not line.startswith(("# date: ", "# end: "))]


class AnimationTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        need_packages("three", esbuild_package())

    def test_page(self) -> None:
        """It has the facts of the motion and all rows; a title does no harm."""
        groups = {"study": {"title": HOSTILE}, **TOP.input(span=SPAN)}
        page = spintop.run(groups).animate().page
        assert "<img" not in page
        assert re.findall("@[A-Z]{4,6}@", page) == []
        facts = json.loads(re.search(r'<script type="application/json">(.*?)</script>', page)[1])
        assert (facts["title"], facts["total"], facts["exact"]) == (HOSTILE, 31, True)
        assert facts["body"]["inertia"] == [0.875, 0.875, 0.25]
        assert "(all 31 rows, all digits)" in page

    def test_a_table_in_a_file(self) -> None:
        """It is shown as the run that wrote it; the page is saved whole."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            result = spintop.run(TOP.input(span=SPAN), folder=folder)
            animation = spintop.animate(folder / "input.csv")
            assert lines_shown(animation.page) == lines_shown(result.animate().page)
            saved = animation.save(folder / "page.html")
            assert saved.read_text(encoding="utf-8") == animation.page

    def test_what_cannot_be_shown(self) -> None:
        """A sweep has no motion; a motion without an attitude has none that can be shown."""
        sweep = {"study": {"kind": "sweep"}, **TOP.input(span={"t_end": 1.0})}
        with self.assertRaisesRegex(TypeError, "the table is no trajectory"):
            spintop.sweep(sweep, {"initial.theta": [0.1, 0.2]}).animate()
        axis = {"parameter": ["initial.theta"], "values": [[0.1, 0.2]]}
        with self.assertRaisesRegex(TypeError, "the table is no trajectory"):
            spintop.run({**sweep, "sweep": axis}).animate()
        bare = TOP.input(span=SPAN, output={"columns": ["t", "theta"]})
        with self.assertRaisesRegex(TypeError, "needs the columns phi, theta, psi or q0 to q3"):
            spintop.run(bare).animate()

    def test_in_a_notebook(self) -> None:
        """The frame draws the top, with the digits of the first row, arrows and energies."""
        if not BROWSER:
            self.skipTest("no browser: scripts/test installs one, where it may")
        animation = TOP.animate(3.0, 31, method="dop853")
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            page = Path(folder) / "notebook.html"
            page.write_text(f"<!doctype html><body>{animation._repr_html_()}", encoding="utf-8")
            browser = open_browser(Path(folder) / "profile", *SOFTWARE_WEBGL)
            try:
                browser.get(page.as_uri())
                browser.switch_to.frame(browser.find_element("css selector", "iframe"))
                wait_for(lambda: browser.execute_script(READY), "the data")
                wait_for(lambda: browser.find_elements("css selector", "canvas"), "the drawing")
                shown = browser.execute_script(SHOWN)
                for name in ("force", "momentum", "omega"):
                    box = browser.find_element("css selector", f"[data-part={name}]")
                    assert box.is_enabled(), name
            finally:
                browser.quit()
        assert shown["theta"] == "0.2"
        assert shown["row"] == "row 1 of 31"
        energy = TOP.exact(0.0, ["energy"]).energy
        self.assertAlmostEqual(float(shown["energy"]), float(energy), places=3)
