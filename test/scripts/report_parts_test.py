"""Tests of the parts of a report: cells as texts."""

import math
import unittest

from reporting.cells import proved_texts, texts_of


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
