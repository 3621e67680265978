"""Tests of the parts of a report: SVG files as elements of the page, cells as texts."""

import math
import re
import sys
import unittest
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS.parent / "scripts"), str(TESTS.parent / "python")]

from reporting.cells import texts_of  # noqa: E402
from reporting.drawing import Drawing, Glyphs, NotDrawnError, shorten_path  # noqa: E402
from reporting.proved import proved_texts  # noqa: E402


class DrawingTest(unittest.TestCase):
    """SVG files as elements of the page."""

    SPACES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'

    def draw(
        self, inner: str, box: str = 'viewBox="0 0 72 36">', glyphs: Glyphs | None = None
    ) -> str:
        """The element for a file with this inside."""
        svg = f"<svg {self.SPACES} {box}{inner}</svg>".encode()
        return Drawing(svg, glyphs or Glyphs(), "a <label>").element()

    def test_taken_over(self) -> None:
        """Styles are attributes, numbers are short, lines are steps, names are of the page."""
        glyphs = Glyphs()
        inner = (
            "<title>x</title><defs>"
            '<path id="A-1" d="M 0 0 Q 3 4 5 6" style="stroke: #000000"/></defs>'
            '<g id="g1"><path id="p" d="M 1.23456 2 L 2.5 1 L 3.5 1.004 z" style="fill: none"/></g>'
            '<g transform="scale(0.015625)">'
            '<use xlink:href="#A-1" transform="translate(12.3456 0)"/></g>'
        )
        for _ in range(2):
            element = self.draw(inner, glyphs=glyphs)
            self.assertIn('aria-label="a &lt;label&gt;" viewBox="0 0 72 36" width="96"', element)
            self.assertIn('<path d="m1.23 2l1.27-1l1 0z" fill="none"/>', element)
            self.assertIn('<g transform="scale(0.015625)"><use href="#g1" x="12.35"/></g>', element)
        self.assertEqual(
            glyphs.definitions(), '<path id="g1" d="M 0 0 Q 3 4 5 6" stroke="#000000"/>'
        )

    def test_no_drift(self) -> None:
        """Rounded steps do not add up."""
        corners = [(0.1234 * i, 0.0049 * i) for i in range(1000)]
        path = "M " + " L ".join(f"{x:.6f} {y:.6f}" for x, y in corners)
        steps = re.findall(r"-?[\d.]+", shorten_path(path))
        end = [sum(float(step) for step in steps[k::2]) for k in range(2)]
        np.testing.assert_allclose(end, corners[-1], atol=0.006)

    def test_refused(self) -> None:
        """Whatever matplotlib does not draw with is not taken into the page."""
        for inner in (
            "<script>hacked = 1</script>",
            '<path onclick="hacked" d="M 0 0"/>',
            '<use xlink:href="http://somewhere/x.svg#a"/>',
            '<image xlink:href="http://somewhere/x.png"/>',
            '<path d="M 0 0" style="fill: url(http://somewhere)"/>',
            '<path d="M 0 0" clip-path="url(#missing)"/>',
            "<foreignObject/>",
            "<g",
        ):
            with self.subTest(inner), self.assertRaises(NotDrawnError):
                self.draw(inner)
        with self.assertRaises(NotDrawnError):
            self.draw("", box=">")
        with self.assertRaises(NotDrawnError):
            Drawing(b'<!DOCTYPE svg [<!ENTITY a "b">]><svg/>', Glyphs(), "")


class CellsTest(unittest.TestCase):
    """Numbers of a column as texts."""

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
        self.assertEqual(
            texts_of([1e-20, 3e-5]),
            ["1.000000000e\N{MINUS SIGN}20", "3.000000000e\N{MINUS SIGN}05"],
        )
        self.assertEqual(texts_of([math.inf, 0.25])[0], "inf")

    def test_proved_digits(self) -> None:
        """A digit is proved if the error is at most half a unit of it; two more follow."""

        def marked(number: str, bound: str) -> str:
            return f'<b class="proved" title="off by {bound} at most">{number}</b>'

        minus = "\N{MINUS SIGN}"
        self.assertEqual(
            proved_texts([1.23456789, -1.23456789], [0.4e-3, 0.6e-3]),
            [marked("1.234", "0.0004") + "57", marked(minus + "1.23", "0.0006") + "457"],
        )
        self.assertEqual(proved_texts([12.5], [0.4]), [marked("12", "0.4") + ".50"])
        unproved = proved_texts([12.5, 3.0], [math.inf, 0.7])
        self.assertEqual(unproved, ["12.500000000000000", "3.000000000000000"])
        self.assertEqual(proved_texts([0.5], [0.0]), [marked("0.5000000000000000", "0")])
        self.assertEqual(proved_texts([math.nan, "word"], [math.inf, 0.1]), ["\N{EN DASH}", "word"])


if __name__ == "__main__":
    unittest.main()
