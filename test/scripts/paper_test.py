"""The paper: its references, figures and commands are there."""

import re
import unittest

from conftest import ROOT

FOLDER = ROOT / "doc/paper"
TEXT = (FOLDER / "paper.md").read_text(encoding="utf-8")
MOST_WORDS, FEWEST_WORDS = 1000, 250


class PaperTest(unittest.TestCase):
    """What a journal for software expects."""

    def test_references(self) -> None:
        """Each is cited, and each citation has one with an author, a title and a year."""
        entries = re.split(r"\n(?=@)", (FOLDER / "paper.bib").read_text(encoding="utf-8"))
        known = {re.match(r"@\w+\{(\w+),", entry)[1]: entry for entry in entries}
        body = TEXT.split("---", 2)[2]
        cited = set(re.findall(r"@([A-Z]\w+)", body))
        self.assertEqual(cited, set(known))
        for name, entry in known.items():
            for field in ("author", "title", "year"):
                self.assertIn(f"  {field} = {{", entry, name)
            if name[-4:].isdigit():
                self.assertIn(f"year = {{{name[-4:]}}}", entry)
            for doi in re.findall(r"doi = \{(.*?)\}", entry):
                self.assertRegex(doi, r"^10\.\d{4,9}/\S+$")

    def test_figures_and_commands(self) -> None:
        """Figures are files, and are referred to; commands name scripts and inputs."""
        figures = re.findall(r"!\[.*?\\label\{(.*?)\}\]\((.*?)\)", TEXT)
        self.assertEqual(len(figures), 2)
        for label, path in figures:
            self.assertTrue((FOLDER / path).is_file(), path)
            self.assertIn(f"\\autoref{{{label}}}", TEXT)
        for path in re.findall(r"\b(?:scripts|input)/[\w.]+", TEXT):
            self.assertTrue((ROOT / path).is_file(), path)

    def test_parts_and_length(self) -> None:
        """The parts that are required, in the usual length."""
        for heading in ("Summary", "Statement of need", "References"):
            self.assertIn(f"\n# {heading}\n", TEXT)
        words = len(TEXT.split("---", 2)[2].split())
        self.assertLess(words, MOST_WORDS)
        self.assertGreater(words, FEWEST_WORDS)
