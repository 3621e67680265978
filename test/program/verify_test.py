"""`spintop verify` on tables of all kinds: parts of sweeps, free bodies, damaged ones."""

import math

from conftest import each, largest
from proof_test import needs_flint

pytestmark = needs_flint

SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 30 /
&span t_end = 2.0 /
&output columns = 'theta_end', 'theta_end_bound', 'phi_end', 'psi_end', 'proof' /
&sweep parameter(1) = 'initial.psi_rate', values(1,:) = 0.2, 0.5, 3, 40 /
"""
FREE = """\
&study kind = 'trajectory' /
&top mass = 1.0, gravity = 0.0, inertia = 0.9, 1.3, 1.7, centre_of_mass = 0, 0, 0 /
&initial quaternion = 0.5, 0.5, -0.5, 0.5, omega = 0.3, -0.4, 1.1 /
&span t_end = 20.0, samples = 5 /
&output columns = 't', 'theta', 'q0', 'q1', 'q2', 'q3' /
"""
ABOUT_X = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.25, 0.875, 0.875, centre_of_mass = -0.8660254037844387, 0, 0 /
&initial theta_deg = 40, phi_rate = 0.3, omega3 = 2.0 /
&span t_end = 3.0, samples = 5 /
&output columns = 't', 'theta', 'theta_bound', 'q0', 'q1', 'q2', 'q3',
                  'orientation_bound', 'proof' /
"""


def verify(spin, name, code=0):
    run = spin.call("verify", f"output/{name}.csv", code=code)
    return run.out + run.stderr


class Table:
    """The table of an input, to be edited: without its last line, as it has another checksum."""

    def __init__(self, spin, text, *settings):
        self.spin = spin
        lines = spin(text, *settings).path.read_text().splitlines(keepends=True)
        assert lines.pop().startswith("# end: ")
        first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        self.head, rest = lines[: first + 1], lines[first + 1 :]
        self.names = lines[first].strip().split(",")
        self.rows = rows_of(rest)
        self.status = rest[len(self.rows) :]

    def edited(self, row, name, cell):
        cells = self.rows[row].rstrip("\n").split(",")
        cells[self.names.index(name)] = cell
        return [*self.rows[:row], ",".join(cells) + "\n", *self.rows[row + 1 :]]

    def wrong(self, rows, words, status=None):
        status = self.status if status is None else status
        self.spin.write("".join([*self.head, *rows, *status]), "output/edited.csv")
        assert f"first wrong  {words}" in verify(self.spin, "edited", code=3)


def rows_of(lines):
    return [line for line in lines if not line.startswith("#")]


def test_parts_of_a_sweep(spin):
    spin.parts(SWEEP, 3)
    counted = [verify(spin, f"scene.{i}-of-3").split()[1] for i in (1, 2, 3)]
    spin(SWEEP)
    total = f"{sum(map(int, counted))} numbers proved, 0 unproved, 0 wrong"
    assert total in verify(spin, "scene")


@each(
    "columns, count, name, change",
    ([], 25, "q0", lambda x: -x),
    (["output.columns=t,theta,phi,psi"], 15, "phi", lambda x: x + 2 * math.pi),
)
def test_free_body(spin, columns, count, name, change):
    """The quaternion is proved with its sign; phi and psi are with their turns."""
    table = Table(spin, FREE, *columns)
    assert f"{count} numbers proved, 0 unproved, 0 wrong" in verify(spin, "scene")
    value = float(table.rows[-1].split(",")[table.names.index(name)])
    table.wrong(table.edited(4, name, str(change(value))), f"row 5, {name} = ")


def test_axis_x(spin):
    """A top about body x that hangs: bounds, and certified numbers."""
    rows = spin(ABOUT_X).rows
    assert set(rows.proof) == {"proved"}
    assert largest(rows.orientation_bound) < 1e-14
    assert "25 numbers proved" in verify(spin, "scene")
    spin(ABOUT_X, "output.certified=.true.", "integration.method=dop853")
    assert "25 numbers proved" in verify(spin, "scene")


def test_inputs(spin):
    assert largest(spin("certified_top").rows.theta_bound) < 4e-16
    assert "707 numbers proved, 0 unproved, 0 wrong" in verify(spin, "certified_top")
    assert 1e-4 < largest(spin("uncertain_top").rows.orientation_bound) < 1e-3
    assert " 0 wrong" in verify(spin, "uncertain_top")


@each(
    "radius, words",
    ("uncertainty.initial.theta=1e-9", "the attitude is given by a quaternion"),
    ("uncertainty.initial.phi_rate=1e-9", "the angular velocity is given by omega"),
)
def test_uncertainty_of_what_is_not_given(spin, radius, words):
    assert words in spin.refuse(FREE, "--check", radius, "output.columns=t,theta,theta_bound")


@each(
    "effect, most, proved",
    ("rotor_momentum = 0.1, 0, 0", 1e-14, 25),
    # The error of the integration; of the others nothing is claimed.
    ("rotor_momentum = 0, 0, 0.1", 1e-8, 5),
    ("friction_torque = 0.01", math.inf, 0),
)
def test_effects(spin, effect, most, proved):
    """A rotor, by the exact solution on the axis, integrated on another; no dry friction."""
    rows = spin(ABOUT_X.replace("&span", f"&effects {effect} /\n&span")).rows
    assert set(rows.proof) == {"proved" if proved else "unproved"}
    if proved:
        assert largest(rows.orientation_bound) < most
        assert f"{proved} numbers proved, {25 - proved} unp" in verify(spin, "scene")


def test_other_versions(spin):
    """A table of another version is verified as long as its input is understood."""
    text = spin(FREE).path.read_text()
    first = next(line for line in text.splitlines() if line.startswith("# program: "))
    spin.write(text.replace(first, "# program: spintop 0.0.1"), "output/older.csv")
    assert "0 wrong" in verify(spin, "older")
    spin.write(text.replace("omega = ", "spin_vector = "), "output/newer.csv")
    assert "unknown key 'spin_vector'" in verify(spin, "newer", code=2)


def test_edited_sweeps(spin):
    """Wrong: no number, bound, proof, parameter, or rows that are not those of the input."""
    table = Table(spin, SWEEP)
    for row, name, cell, words in (
        (1, "theta_end", "nan", "row 2, theta_end = nan: not a finite number"),
        (0, "theta_end", "inf", "row 1, theta_end = inf: not a"),
        (2, "theta_end_bound", "nan", "row 3, theta_end_bound is nan"),
        (0, "proof", "unproved", "row 1, proof = unproved: its bounds"),
        (0, "proof", "none", "row 1, proof = none: its bounds"),
        (3, "theta_end_bound", "inf", "row 4, proof = proved: its bounds"),
        (3, "initial.psi_rate", "7", "row 4, initial.psi_rate = 7: the case has 40"),
    ):
        table.wrong(table.edited(row, name, cell), words)
    a, b, *others = table.rows
    for rows, words in (
        ([a, b, others[0]], "3 rows, where the input has 4 cases"),
        ([a, *others], "3 rows, where the input has 4 cases"),
        ([a, a, b, *others], "5 rows, where the input has 4 cases"),
        ([b, a, *others], "row 1, case = 2: not the case 1"),
        ([a, a, *others], "row 2, case = 1: not the case 2"),
        ([], "0 rows, where the input has 4 cases"),
    ):
        table.wrong(rows, words)


def test_edited_trajectories(spin):
    """Rows are at their times, all of them, and an attitude is a number."""
    table = Table(spin, FREE)
    a, b, c, d, e = table.rows
    table.wrong(table.rows, "the table is cut short: it has no status", status=[])
    for rows, words in (
        ([a, b, d, e], "4 rows, where the input asks for 5"),
        ([], "0 rows, where the input asks for 5"),
        ([a, a, b, c, d, e], "6 rows, where the input asks for 5"),
        ([a, b, b, d, e], "row 3, t = 5: not after"),
        (table.edited(1, "t", "4"), "row 2, t = 4: not a"),
        (table.edited(4, "theta", "nan"), "row 5, theta = nan"),
    ):
        table.wrong(rows, words)
    spin(FREE.replace("samples = 5", "samples = 5, stop_at = 'theta = 1.2'"))
    assert " 0 wrong" in verify(spin, "scene")


def test_damaged_tables(spin):
    text = spin(FREE).path.read_text()
    rows = rows_of(text.splitlines(keepends=True))
    for damaged, words in (
        (text[: text.index(rows[-1]) + 30], "a row has a cell for each column"),
        (text.replace("\n0,", "\nnone,"), "is not a number"),
        ("".join(rows), "the file has no group"),
        ("", "the file has no group"),
        (text.replace("\n0,", "\n0,1,"), "more cells than"),
    ):
        spin.write(damaged, "output/damaged.csv")
        assert words in verify(spin, "damaged", code=2)
