"""The registries that `spintop list` prints: as text, and as JSON for scripts."""

import json
import math
import os
import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EXE = os.environ["SPINTOP_EXE"]

TOPICS = {
    "methods": "name family order kind implicit symmetric description formulations aliases tables",
    "formulations": "name states symmetric_only singular_at_poles description",
    "columns": "study name group unit words description",
    "events": "name in_table description",
    "shapes": "name needs description",
    "parts": "name needs takes description",
    "parameters": "name group key type full_name unit default range lower lower_open upper"
    " upper_open choices description",
    "cases": "name is_long description",
    "benchmarks": "name description source",
    "studies": "name takes_axes takes_columns has_parts has_netcdf has_events description",
    "statuses": "name number good description",
    "exit_codes": "code description",
}
"""Each topic, and the members of its objects, which scripts depend on."""


def program(*arguments: str) -> subprocess.CompletedProcess:
    """Run the program."""
    return subprocess.run([EXE, *arguments], capture_output=True, text=True)


def no_constant(word: str) -> None:
    """Refuse NaN and Infinity, which are no JSON though Python reads them."""
    raise ValueError(word)


class ListingTest(unittest.TestCase):
    """The lists for scripts agree with the lists for readers."""

    def listed(self, *topic: str) -> dict:
        """A document."""
        result = program("list", *topic, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue(result.stdout.isascii())
        return json.loads(result.stdout, parse_constant=no_constant)

    def test_document(self) -> None:
        """All topics, each with its members; a document of one topic is part of that."""
        whole = self.listed()
        self.assertEqual(whole["format"], 1)
        self.assertRegex(program("--version").stdout, rf"^spintop {re.escape(whole['version'])} ")
        beside = {"events": {"event_grammar"}, "columns": {"other_words", "column_units"}}
        others = set().union(*beside.values())
        self.assertEqual(set(whole), {"format", "version", *others, *TOPICS})
        shown = re.search(r"(?s)^topics: (.*?)\n\n", program("--help").stdout, re.MULTILINE)
        self.assertEqual(re.split(r",\s+", shown[1]), list(TOPICS))
        for topic, members in TOPICS.items():
            with self.subTest(topic):
                part = self.listed(topic)
                self.assertEqual(part[topic], whole[topic])
                own = {"format", "version", topic} | beside.get(topic, set())
                self.assertEqual(set(part), own)
                self.assertGreater(len(part[topic]), 3)
                for entry in part[topic]:
                    self.assertEqual(" ".join(entry), members)

    def test_same_as_text(self) -> None:
        """Text and JSON name the same things with the same words, in the same order."""
        whole = self.listed()
        for topic in TOPICS:
            with self.subTest(topic):
                text = program("list", topic).stdout
                if topic == "parameters":
                    names = re.findall(r"(?m)^(\w+\.\S+)", text)
                    expected = [entry["full_name"] for entry in whole[topic]]
                else:
                    names = re.findall(r"(?m)^  (\w+) (?!=)", text)
                    expected = [str(entry.get("name", entry.get("code"))) for entry in whole[topic]]
                if topic in ("methods", "formulations"):
                    self.assertEqual(names.pop(0), "auto")
                self.assertEqual(names, expected)
                for entry in whole[topic]:
                    if entry["description"] != "given by its mass properties":
                        self.assertIn(entry["description"], text)

    def test_units_of_columns(self) -> None:
        """Each unit of a column that can have another one, with the sizes of those."""
        units = self.listed("columns")["column_units"]
        sizes = {(unit["of"], unit["suffix"]): (unit["unit"], unit["size"]) for unit in units}
        self.assertEqual(sizes["rad", "deg"], ("deg", math.pi / 180))
        self.assertEqual(sizes["rad/s", "deg"], ("deg/s", math.pi / 180))
        self.assertEqual(sizes["rad/s", "rpm"], ("rpm", 2 * math.pi / 60))
        self.assertEqual(sizes["J s", "mJ"], ("mJ s", 0.001))
        self.assertEqual(sizes["s", "s"], ("s", 1))
        self.assertNotIn(("rad", "rpm"), sizes)
        text = program("list", "columns").stdout
        self.assertIn("\n    N: N, mN, kN\n", text)
        self.assertLess(len(units), 100)

    def test_copies(self) -> None:
        """The copies that the figures read are what the program prints."""
        for path in (ROOT / "python/spintop_figures/tables").glob("*.json"):
            with self.subTest(path.name):
                printed = program("list", path.stem, "--json").stdout
                self.assertEqual(path.read_text(encoding="utf-8"), printed)

    def test_methods(self) -> None:
        """Family, order, kind, formulations, aliases and tables."""
        methods = {entry["name"]: entry for entry in self.listed("methods")["methods"]}
        kinds = {name: (entry["order"], entry["kind"]) for name, entry in methods.items()}
        self.assertEqual(kinds["exact"], (None, "exact"))
        self.assertEqual(kinds["rk4"], (4, "fixed"))
        self.assertEqual(kinds["dop853"], (8, "both"))
        self.assertEqual(kinds["taylor"], (None, "adaptive"))
        self.assertEqual(
            {entry["kind"] for entry in methods.values()}, {"exact", "fixed", "adaptive", "both"}
        )
        families = {entry["family"] for entry in methods.values()}
        self.assertNotIn("", families)
        self.assertEqual(methods["gauss_8"]["family"], "Gauss-Legendre")
        self.assertEqual(methods["arkode_erk"]["family"], methods["dop853"]["family"])
        self.assertEqual(methods["exact"]["formulations"], [])
        self.assertEqual(methods["taylor"]["formulations"], ["rigid_body", "space_frame"])
        self.assertIn("lagrange", methods["ode45"]["formulations"])
        self.assertIn("dormand_prince", methods["ode45"]["aliases"])
        for name in ("arkode_erk", "arkode_dirk"):
            self.assertGreater(len(methods[name]["tables"]), 10)
        self.assertEqual(sum(entry["tables"] is not None for entry in methods.values()), 2)

    def test_parameters(self) -> None:
        """Units, ranges, choices and defaults."""
        found = {entry["name"]: entry for entry in self.listed("parameters")["parameters"]}
        theta = found["initial.theta"]
        self.assertEqual(
            (theta["group"], theta["key"], theta["type"]), ("initial", "theta", "real")
        )
        self.assertEqual(
            (theta["unit"], theta["range"], theta["default"]), ("rad", "[0, pi]", None)
        )
        self.assertEqual((theta["lower"], theta["lower_open"]), (0, False))
        self.assertAlmostEqual(theta["upper"], 3.141592653589793, 15)
        mass = found["top.mass"]
        self.assertEqual((mass["lower"], mass["lower_open"]), (0, True))
        self.assertEqual((mass["upper"], mass["upper_open"], mass["default"]), (None, None, None))
        self.assertEqual(found["top.gravity"]["default"], "9.81")
        self.assertEqual(found["top.inertia"]["full_name"], "top.inertia(3)")
        self.assertEqual(found["output.format"]["choices"], ["csv", "netcdf"])
        self.assertEqual(found["sweep.count"]["type"], "integer")

    def test_columns(self) -> None:
        """Each belongs to a study, and has a unit or none."""
        whole = self.listed()
        owners = {entry["study"] for entry in whole["columns"]}
        self.assertEqual(owners, {entry["name"] for entry in whole["studies"]})
        groups = {(entry["study"], entry["name"]): entry["group"] for entry in whole["columns"]}
        self.assertNotIn("", groups.values())
        self.assertEqual(groups["trajectory", "R1"], "residuals")
        self.assertEqual(groups["stability", "tip_error"], "errors")
        units = {(entry["study"], entry["name"]): entry["unit"] for entry in whole["columns"]}
        self.assertEqual(units["trajectory", "force_z"], "N")
        self.assertEqual(units["sweep", "delta_u"], "")

    def test_wrong_requests(self) -> None:
        """A topic that there is not, two, and other options are refused; none lists the topics."""
        for arguments, words in (
            (["methdos", "--json"], "did you mean 'methods'?"),
            (["methods", "cases"], "one topic"),
            (["--json", "methods", "cases"], "one topic"),
            (["methods", "--jsno"], "--json"),
        ):
            result = program("list", *arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn(words, result.stderr)
        self.assertEqual(program("list", "--json", "cases").returncode, 0)
        alone = re.findall(r"^  (\w+) ", program("list").stdout, re.MULTILINE)
        self.assertEqual(alone, list(TOPICS))


if __name__ == "__main__":
    unittest.main()
