"""Methods of Butcher tables that a user gives in files: orders, messages, checksums."""

import math
import re

import pytest

from conftest import each, quoted
from spintop_figures import draw, read_table

TOP = (
    "&top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.866 /\n"
    "&initial theta_deg = 10, omega3 = 20 /\n&span t_end = 1 /\n"
)
STUDY = TOP + "&study kind = 'work_precision' /\n&work_precision methods = {} repeats = 1 {} /\n"
EIGHTHS = """\
# The 3/8 rule
order 4
0   |
1/3 |  1/3
2/3 | -1/3  1
1   |  1 -1  1
    | 1/8 3/8 3/8 1/8
"""
RADAU = """\
order 3
1/3 | 5/12 -1/12
1   | 3/4   1/4
    | 3/4   1/4
"""
PAIR = """\
order 3 2
0   |
1/2 | 1/2
3/4 | 0 3/4
1   | 2/9 1/3 4/9
    | 2/9 1/3 4/9 0
    | 7/24 1/4 1/3 1/8
"""
DIAGONAL = """\
order 2
0.2928932188134524756 | 0.2928932188134524756
1 | 0.7071067811865475244 0.2928932188134524756
  | 0.7071067811865475244 0.2928932188134524756
"""


FIXED = TOP + "&integration method = 'table:own.txt', steps = 9 /\n"


def test_orders(spin):
    tables = {"eighths": EIGHTHS, "pair": PAIR, "diagonal": DIAGONAL}
    for name, text in tables.items():
        spin.write(text, f"{name}.txt")
    names = quoted([*(f"table:{name}.txt" for name in tables), "table:pair.txt/rigid_body"])
    run = spin(STUDY.format(names, "steps = 800, 1600, tolerances = 1e-4, 1e-6"))
    assert set(run.rows.status) == {"ok"}
    errors = run.rows.set_index(["method", "formulation", "setting"]).orientation_error
    legend = draw(read_table(run.path), "orders").axes[0].get_legend()
    labels = [text.get_text() for text in legend.get_texts()]
    assert any(each.startswith("table:eighths: ") and each.endswith(" / 4") for each in labels)
    for name, order in (("eighths", 4), ("diagonal", 2)):
        coarse, fine = (errors[f"table:{name}", "space_frame", f"steps {n}"] for n in (800, 1600))
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.5), name
    for form in ("space_frame", "rigid_body"):
        coarse, fine = (errors["table:pair", form, f"tolerance 1e-0{digit}"] for digit in (4, 6))
        assert fine < coarse / 20
    assert re.search(r"'table:eighths\.txt@[0-9A-F]{8}'", run.head)


@each(
    "kind, words, number, case",
    ("stability", "verdict", "orientation_error", "slow_top"),
    ("benchmark", "setting", "error", "simo_wong"),
)
def test_a_table_beside_others(spin, kind, words, number, case):
    """The table of rk4, by an override without quotes and with a path, gives what rk4 does."""
    own = EIGHTHS.replace("1/3 |  1/3", "1/2 | 1/2").replace("2/3 | -1/3", "1/2 | 0 1/2")
    own = re.sub(r"1/2  1$", "1/2", own, flags=re.M).replace("1 -1  1", "0 0 1")
    spin.write(own.replace("1/8 3/8 3/8 1/8", "1/6 1/3 1/3 1/6"), "own.txt")
    scene = f"&study kind = '{kind}' /\n&{kind} cases = '{case}' /\n"
    ours, theirs = (
        spin(scene, f"--set={kind}.methods={name}/rigid_body", name=f"by_{i}").rows
        for i, name in enumerate((f"table:{spin.folder}/own.txt", "rk4"))
    )
    assert list(ours.method) == ["table:own"] * len(theirs)
    assert list(ours[words]) == list(theirs[words])
    assert list(ours[number]) == pytest.approx(list(theirs[number]), rel=1e-3)


def test_a_sweep_and_a_changed_table(spin):
    spin.write(EIGHTHS, "own.txt")
    text = TOP + "&study kind = 'sweep' /\n&output columns = 'theta_end' /\n"
    text += "&integration method = 'table:own.txt', steps = 500 /\n"
    text += "&sweep parameter = 'initial.omega3', values(1,:) = 10, 20, 30 /\n"
    run = spin(text)
    head, expected = run.head, run.texts.theta_end
    assert spin(head, name="again").texts.theta_end.equals(expected)
    spin.write(b"\xef\xbb\xbf" + EIGHTHS.replace("\n", "\r\n").encode(), "own.txt")
    assert spin(head, name="again").texts.theta_end.equals(expected)
    spin.write(EIGHTHS + "# another\n", "own.txt")
    assert "the table of coefficients has changed" in spin(head, code=2).stderr


@each(
    "old, new, message",
    ("-1/3  1", "-1/2  1", "own.txt, line 5: the coefficients of stage 3 add up to 0.5"),
    ("order 4", "order 5", "own.txt, line 2: the method does not have order 5"),
    ("1 -1  1", "1 -x  1", "own.txt, line 6: '-x' is not a number"),
    ("1/8 3/8 3/8", "3/8 3/8", "own.txt, line 7: this row has 3 weights"),
    ("order 4\n", "", "own.txt, there is no order"),
    ("order 4", "order 4 3", "own.txt, an embedded method has a second row"),
    (EIGHTHS, "hello\n", "own.txt, line 1: this is neither"),
    (EIGHTHS, PAIR.replace("3 2", "3 3"), "1: the embedded method does not have order 3"),
    (EIGHTHS, RADAU, "own.txt, line 2: stage 1 depends on a later one"),
)
def test_wrong_tables(spin, old, new, message):
    spin.write(EIGHTHS.replace(old, new), "own.txt")
    assert message in spin.refuse(FIXED)


def test_the_length_of_a_name(spin):
    """The name of a file is the name of its method: up to 42 bytes without the ending."""
    name = "kutta_1901_three_eighths_rule_" + 12 * "x"
    for path in (f"{name}.txt", f"{name}y.txt"):
        spin.write(EIGHTHS, path)
    run = spin(STUDY.format(f"'table:{name}.txt/lagrange', 'rk4'", "steps = 800"))
    assert set(run.rows.method) == {f"table:{name}", "rk4"}
    error = spin.refuse(FIXED.replace("own.txt", f"{name}y.txt"))
    assert f"the name of the file is too long for a method: '{name}y'" in error
    assert "at most 42 bytes, without its ending" in error


def test_a_formulation_with_the_method_of_a_scene(spin):
    """A study that compares methods names pairs; a scene has another key for it."""
    spin.write(EIGHTHS, "own.txt")
    error = spin.refuse(FIXED.replace("own.txt", "own.txt/lagrange"))
    assert "names a formulation as well" in error
    assert "integration.formulation = 'lagrange'" in error


def test_a_table_of_results_is_an_input(spin):
    """The input in its header runs again to the same table; files that it names are beside it."""

    def dateless(path):
        lines = path.read_text(encoding="utf-8").splitlines()
        return [line for line in lines if not line.startswith(("# date", "# end"))]

    spin.write(EIGHTHS, "own.txt")
    first = spin(FIXED)
    table = "output/scene.csv"
    said = spin.call("--check", table, code=2).err
    assert "relative to the folder of the input, or of the table that has the input" in said
    spin.write(EIGHTHS, "output/own.txt")
    again = spin.call("--output=again", table, path="again/scene.csv")
    assert dateless(again.path) == dateless(first.path)
    assert "would replace" in spin.call(table, code=2).err
