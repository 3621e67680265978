"""The registries that `spintop list` prints: as text, and as JSON for scripts."""

import json
import math
import re

import pytest

from conftest import ROOT, each

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
BESIDE = {"events": {"event_grammar"}, "columns": {"other_words", "column_units"}}
"""What is listed beside the objects of a topic."""


def no_constant(word):
    """Refuse NaN and Infinity, which are no JSON though Python reads them."""
    raise ValueError(word)


def listed(spin, *topic):
    run = spin.call("list", *topic, "--json")
    assert run.stderr == ""
    assert run.out.isascii()
    return json.loads(run.out, parse_constant=no_constant)


def test_document(spin):
    whole = listed(spin)
    assert whole["format"] == 1
    version = re.escape(whole["version"])
    assert re.match(rf"spintop {version} ", spin.call("--version").out)
    assert set(whole) == {"format", "version", *set().union(*BESIDE.values()), *TOPICS}
    shown = re.search(r"(?s)^topics: (.*?)\n\n", spin.call("--help").out, re.MULTILINE)
    assert re.split(r",\s+", shown[1]) == list(TOPICS)


@each("topic", *TOPICS)
def test_topic(spin, topic):
    """A document of one topic is part of the whole, with the members that scripts know.

    Text and JSON name the same things with the same words, in the same order.
    """
    part = listed(spin, topic)
    assert part[topic] == listed(spin)[topic]
    assert set(part) == {"format", "version", topic} | BESIDE.get(topic, set())
    assert len(part[topic]) > 3
    for entry in part[topic]:
        assert " ".join(entry) == TOPICS[topic]
    text = spin.call("list", topic).out
    if topic == "parameters":
        names = re.findall(r"(?m)^(\w+\.\S+)", text)
        expected = [entry["full_name"] for entry in part[topic]]
    else:
        names = re.findall(r"(?m)^  (\w+) (?!=)", text)
        expected = [str(entry.get("name", entry.get("code"))) for entry in part[topic]]
    if topic in ("methods", "formulations"):
        assert names.pop(0) == "auto"
    assert names == expected
    for entry in part[topic]:
        assert entry["description"] in text or (topic == "shapes" and entry["name"] == "inertia")


def test_units_of_columns(spin):
    """Each unit of a column that can have another one, with the sizes of those."""
    units = listed(spin, "columns")["column_units"]
    sizes = {(unit["of"], unit["suffix"]): (unit["unit"], unit["size"]) for unit in units}
    assert sizes["rad", "deg"] == ("deg", math.pi / 180)
    assert sizes["rad/s", "deg"] == ("deg/s", math.pi / 180)
    assert sizes["rad/s", "rpm"] == ("rpm", 2 * math.pi / 60)
    assert sizes["J s", "mJ"] == ("mJ s", 0.001)
    assert sizes["s", "s"] == ("s", 1)
    assert ("rad", "rpm") not in sizes
    assert "\n    N: N, mN, kN\n" in spin.call("list", "columns").out
    assert len(units) < 100


@each("topic", "columns", "methods", "statuses")
def test_copies(spin, topic):
    path = ROOT / f"python/spintop_figures/tables/{topic}.json"
    assert path.read_text(encoding="utf-8") == spin.call("list", topic, "--json").out


def test_methods(spin):
    methods = {entry["name"]: entry for entry in spin.listed("methods")}
    kinds = {name: (entry["order"], entry["kind"]) for name, entry in methods.items()}
    assert kinds["exact"] == (None, "exact")
    assert kinds["rk4"] == (4, "fixed")
    assert kinds["dop853"] == (8, "both")
    assert kinds["taylor"] == (None, "adaptive")
    assert {kind for _, kind in kinds.values()} == {"exact", "fixed", "adaptive", "both"}
    assert "" not in {entry["family"] for entry in methods.values()}
    assert methods["gauss_8"]["family"] == "Gauss-Legendre"
    assert methods["arkode_erk"]["family"] == methods["dop853"]["family"]
    assert methods["exact"]["formulations"] == []
    assert methods["taylor"]["formulations"] == ["rigid_body", "space_frame"]
    assert "lagrange" in methods["ode45"]["formulations"]
    assert "dormand_prince" in methods["ode45"]["aliases"]
    for name in ("arkode_erk", "arkode_dirk"):
        assert len(methods[name]["tables"]) > 10
    assert sum(entry["tables"] is not None for entry in methods.values()) == 2


def test_parameters(spin):
    found = {entry["name"]: entry for entry in spin.listed("parameters")}
    theta = {"group": "initial", "key": "theta", "type": "real", "unit": "rad", "range": "[0, pi]"}
    theta |= {"default": None, "lower": 0, "lower_open": False}
    assert theta.items() <= found["initial.theta"].items()
    assert found["initial.theta"]["upper"] == pytest.approx(3.141592653589793, abs=5e-16)
    mass = {"lower": 0, "lower_open": True, "upper": None, "upper_open": None, "default": None}
    assert mass.items() <= found["top.mass"].items()
    assert found["top.gravity"]["default"] == "9.81"
    assert found["top.inertia"]["full_name"] == "top.inertia(3)"
    assert found["output.format"]["choices"] == ["csv", "netcdf"]
    assert found["sweep.count"]["type"] == "integer"


def test_columns(spin):
    columns = spin.listed("columns")
    owners = {entry["study"] for entry in columns}
    assert owners == {entry["name"] for entry in spin.listed("studies")}
    groups = {(entry["study"], entry["name"]): entry["group"] for entry in columns}
    assert "" not in groups.values()
    assert groups["trajectory", "R1"] == "residuals"
    assert groups["stability", "tip_error"] == "errors"
    units = {(entry["study"], entry["name"]): entry["unit"] for entry in columns}
    assert units["trajectory", "force_z"] == "N"
    assert units["sweep", "delta_u"] == ""


@each(
    "words, said",
    (["methdos"], "did you mean 'methods'?"),
    (["methdos", "--json"], "did you mean 'methods'?"),
    (["methods", "cases"], "one topic"),
    (["--json", "methods", "cases"], "one topic"),
    (["methods", "--jsno"], "--json"),
)
def test_wrong_requests(spin, words, said):
    run = spin.call("list", *words, code=2)
    assert run.out == ""
    assert said in run.stderr


def test_a_misspelt_command(spin):
    assert "did you mean 'verify'?" in spin.call("verfy", "scene.csv", code=2).stderr


def test_no_topic(spin):
    spin.call("list", "--json", "cases")
    alone = spin.call("list")
    assert alone.stderr == ""
    assert re.findall(r"^  (\w+) {2,}\w", alone.out, re.MULTILINE) == list(TOPICS)
