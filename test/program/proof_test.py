"""Bounds in tables, certified numbers, and `spintop verify`."""

import math
import re
from decimal import Decimal

import pytest

from conftest import EXE, ROOT, each, execute, largest
from spintop_figures.tables.table import read_table

MISSING = "this build has no FLINT, which certifies digits"
CHECKED = execute(EXE, "--check", ROOT / "input/certified_top.nml", code=(0, 2))
HAS_FLINT = MISSING not in CHECKED.stderr
needs_flint = pytest.mark.skipif(not HAS_FLINT, reason="this build has no FLINT")
pytestmark = needs_flint

TOP = """\
&study kind = 'trajectory' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta = 0.19634954084936207, psi_rate = 1.0 /
&span t_end = 3.0, samples = 7 /
&output columns = 't', 'theta', 'phi', 'psi', 'q0', 'q1', 'q2', 'q3' /
"""
SWEEP = """\
&study kind = 'sweep' /
&top mass = 1.0, inertia = 0.875, 0.875, 0.25, length = 0.8660254037844387 /
&initial theta_deg = 30 /
&span t_end = 2.0 /
&output columns = 'theta_end', 'theta_end_bound', 'phi_end', 'psi_end', 'psi_end_bound',
                  'nutation_period', 'proof' /
&sweep parameter(1) = 'initial.psi_rate', values(1,:) = 0, 0.5, 3, 40 /
"""
BOUNDS = "t,theta,theta_bound,phi_bound,psi_bound,q0,q0_bound,orientation_bound,proof"
# A body, what acts on it, and theta at 10 to 40 s by Taylor series of these doubles in 50 digits,
# with rows of the rotation and the momentum as the state.
DRIVEN = """\
&top mass = 1, inertia = 0.9, 0.7, 0.3, centre_of_mass = 0.05, -0.02, 0.4 /
&initial theta = 0.6, omega = 0.5, -1, 2 /
&span t_end = 40, samples = 5 /
&output columns = 't', 'theta', 'theta_bound', 'proof' /
&effects {} /
"""
THETA = {
    "torque_body_amplitude = 0.5, 0, 0, torque_body_rate = 3, torque_body_phase = 0.2, 0, 0": (
        "1.4207695665561021879170685783786 0.66880968277684820094092037723848"
        " 1.7237574518898200442376389811842 1.2102770445698153012416777933024"
    ),
    "torque_space_amplitude = 0.5, 0, 0, torque_space_rate = 3, torque_space_phase = 0.2, 0, 0": (
        "0.84955648621729324336698038313323 1.332995943491202432464682744639"
        " 2.4122868350365031587388875350818 0.97940123911193994816379146162044"
    ),
    "earth_rate = 0.5, latitude = 0.7": (
        "1.5903865329024774509526303542972 0.77334516002839887602228234456574"
        " 2.6203621110271417789874276585952 1.8453306295930141701847082144132"
    ),
}
# A body that turns about its axis under 0.5 cos(3 t + 1): omega3 + 0.5 (sin(4) - sin(1))/(3 I3).
AXIAL = """\
&top mass = 1, inertia = 0.9, 0.7, 0.3, length = 0 /
&initial theta = 0.6, omega3 = 0.88793 /
&span t_end = 1, samples = 2 /
&output columns = 't', 'omega3', 'omega3_bound' /
&effects torque_body_amplitude = 0, 0, 0.5, torque_body_rate = 3, torque_body_phase = 0, 0, 1 /
"""
OMEGA3 = "2.88824541765288390984435771987e-07"
# Friction by a table without a dry part slows the top down.
FRICTION = """\
&study kind = 'trajectory' /
&top mass = 1, inertia = 0.02, 0.02, 0.01, length = 0.1 /
&initial theta_deg = 20, omega3 = 100 /
&effects friction_table = 'friction.csv' /
&span t_end = 2, samples = 3 /
&integration method = 'dop853', relative_tolerance = 1e-12 /
&output columns = 't', 'theta', 'theta_bound', 'omega3', 'omega3_bound', 'proof' /
"""
CERTIFIED = "output.certified=.true."


def verify(spin, *words, code=0, name="scene"):
    run = spin.call("verify", f"output/{name}.csv", *words, code=code)
    return run.out + run.stderr


def change(spin, name, row, text):
    path = spin.folder / "output/scene.csv"
    lines = path.read_text().splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    cells = lines[first + row].rstrip("\n").split(",")
    cells[lines[first].rstrip("\n").split(",").index(name)] = text
    lines[first + row] = ",".join(cells) + "\n"
    path.write_text("".join(lines))


def bounds_hold(run, name, true):
    """The numbers of a column, but for the first, are within their bounds of the true ones."""
    texts = run.texts[1:]
    for number, bound, digits in zip(texts[name], texts[f"{name}_bound"], true, strict=True):
        error = abs(Decimal(float(number)) - Decimal(digits))
        assert error <= Decimal(float(bound))


@each("setting", CERTIFIED, "integration.method=taylor_quadruple")
@each("effects", *THETA)
def test_phases_and_latitudes_are_data(spin, effects, setting):
    """Their sines and cosines are not rounded before the proof."""
    bounds_hold(spin(DRIVEN.format(effects), setting), "theta", THETA[effects].split())


def test_phases_about_an_axis(spin):
    bounds_hold(spin(AXIAL, CERTIFIED), "omega3", [OMEGA3])


def test_friction_by_a_table_is_not_enclosed(spin):
    """A motion that it slows down is not certified as one that it does not."""
    table = "omega3,friction_torque\n0,0\n50,0.01\n200,0.05\n"
    rows = spin(FRICTION, CERTIFIED, friction=table).rows
    assert list(rows.proof) == ["unproved"] * 3
    assert set(rows.omega3_bound) == {math.inf}
    assert rows.omega3[2] < 96
    spin.write(table, "output/friction.csv")
    assert "0 numbers proved, 6 unproved, 0 wrong" in verify(spin)
    sweep = FRICTION.replace("trajectory", "sweep").replace(", samples = 3", "")
    sweep = sweep.split("&output")[0] + (
        "&output columns = 'psi_end', 'psi_end_bound', 'proof' certified = .true. /\n"
        "&sweep parameter(1) = 'initial.omega3', values(1,:) = 90, 100 /\n"
    )
    assert list(spin(sweep).rows.proof) == ["unproved"] * 2


def test_bounds_of_the_exact_solution(spin):
    run = spin(TOP, f"output.columns={BOUNDS}")
    assert set(run.rows.proof) == {"proved"}
    for name in ("theta_bound", "phi_bound", "psi_bound", "q0_bound", "orientation_bound"):
        assert largest(run.rows[name]) < 1e-14
    assert set(read_table(run.path).rows["proof"]) == {"proved"}  # as figures see it


def test_bounds_of_a_method(spin):
    columns = "output.columns=t,orientation_error,orientation_bound,proof"
    rows = spin(TOP, "integration.method=dop853", columns).rows
    assert set(rows.proof) == {"proved"}
    assert rows.orientation_error.max() > 1e-11
    assert list(rows.orientation_error) == pytest.approx(list(rows.orientation_bound), abs=1e-14)


def test_certified_numbers(spin):
    names = ("theta", "phi", "q0", "omega1", "omega2")
    setting = f"output.columns=t,{','.join(f'{name},{name}_bound' for name in names)},proof"
    run = spin(TOP, setting, CERTIFIED)
    texts, rows, head = run.texts, run.rows, run.head
    assert spin(TOP, setting, CERTIFIED, "integration.method=dop853").texts.equals(texts)
    for name in names:
        for number, bound in zip(rows[name], rows[f"{name}_bound"], strict=True):
            assert bound <= 0.75 * math.ulp(max(abs(number), 2.0**-52))
    assert "certified = .true." in head
    assert "0 unproved, 0 wrong" in verify(spin, "--strict")


def test_uncertainty(spin):
    """Radii of the data widen the bounds, about in proportion while they are small."""
    columns = "output.columns=t,theta,theta_bound,orientation_bound,proof"
    narrow = spin(TOP, columns, "uncertainty.top.length=1e-12").rows
    run = spin(TOP, columns, "uncertainty.top.length=1e-10")
    wide = run.rows
    assert set(wide.proof) == {"proved"}
    assert 30 < wide.orientation_bound.max() / narrow.orientation_bound.max() < 300
    assert "top.length = 1e-10" in run.head
    both = spin(TOP, columns, "uncertainty.top.inertia=1e-10,2e-10,1e-10").rows
    assert set(both.proof) == {"proved"}
    radii = "&uncertainty top.length = 1e-9 top.mass = 1e-9 /\n&span"
    both = spin(TOP.replace("&span", radii), columns).rows
    assert both.theta_bound.max() > narrow.theta_bound.max()


ANY = ("top.inertia=0.875,0.8,0.25", "top.damping=0.01,0.01,0.005")
UNCERTAIN = (*ANY, "output.columns=t,q0,orientation_bound,omega1_bound,proof")


def test_uncertainty_of_any_body(spin):
    exact = spin(TOP, *UNCERTAIN).rows.orientation_bound.max()
    for key in ("top.damping", "top.inertia", "initial.phi", "top.length", "initial.psi_rate"):
        radius = ",".join(["1e-9"] * (3 if key in ("top.damping", "top.inertia") else 1))
        rows = spin(TOP, *UNCERTAIN, f"uncertainty.{key}={radius}").rows
        assert set(rows.proof) == {"proved"}
        assert exact + 1e-10 < largest(rows.orientation_bound) < 1e-6


TENSOR = TOP.replace(
    "inertia = 0.875, 0.875, 0.25",
    "inertia_tensor(1,:) = 0.875, 0.1, 0.05  inertia_tensor(2,2:3) = 0.8, 0.02"
    "  inertia_tensor(3,3) = 0.25",
)


def test_uncertainty_of_a_tensor(spin):
    """Of any of its elements; one below the diagonal is that above it."""
    assert "inertia_tensor" in TENSOR
    exact = largest(spin(TENSOR, UNCERTAIN[-1]).rows.orientation_bound)
    bounds = []
    for element in ("1,1", "1,2", "2,1", "2,3"):
        radius = f"uncertainty.top.inertia_tensor({element})=1e-9"
        rows = spin(TENSOR, UNCERTAIN[-1], radius).rows
        assert set(rows.proof) == {"proved"}
        bounds.append(largest(rows.orientation_bound))
        assert exact + 1e-10 < bounds[-1] < 1e-6
    assert bounds[1] == bounds[2]
    assert " 0 wrong" in verify(spin)
    said = spin.refuse(TENSOR, "--check", UNCERTAIN[-1], "uncertainty.top.inertia=1e-9,1e-9,1e-9")
    assert "top.inertia is not given" in said


def test_lost_bounds(spin):
    said = spin(TOP, *UNCERTAIN, "uncertainty.top.length=1e-4", "span.t_end=60").out
    assert re.search(r"unproved \(.*\), the first at t = [1-9]", said)


Q0 = "output.columns=t,q0_bound"


@each(
    "settings, words",
    (["uncertainty.top.length=1e-9"], "the table has no bounds"),
    (["uncertainty.top.length=1e-9", CERTIFIED], "no certified digits"),
    (["uncertainty.initial.omega3=1", Q0], "omega3 is not given"),
    (["uncertainty.top.spin=1", Q0], "unknown key"),
    (["uncertainty.initial.omega=1,1,1", Q0], "omega is not given"),
    (["uncertainty.top.centre_of_mass=1,1,1", Q0], "top.centre_of_mass is not given"),
    (["uncertainty.top.mass=-1", Q0], "uncertainty.top.mass"),
)
def test_wrong_uncertainty(spin, settings, words):
    assert words in spin.refuse(TOP, "--check", *settings)


def test_unproved_rows_say_why(spin):
    run = spin(TOP, "effects.drag_force=0.1", "output.columns=t,theta,theta_bound,proof")
    assert set(run.rows.proof) == {"unproved"}
    assert set(run.rows.theta_bound) == {math.inf}
    assert "7 unproved (dry friction, drag of the air and tables" in run.out


def test_any_body(spin):
    """Certified digits are those of a series in quadruple precision from the same angles."""
    columns = f"output.columns={BOUNDS},phi,psi,omega1,omega1_bound"
    given = (*ANY, "initial.psi_rate=5", "span.t_end=18", columns)
    series = spin(TOP, *given, "integration.method=taylor_quadruple").rows
    assert set(series.proof) == {"proved"}
    assert largest(series.orientation_bound) < 3e-16
    assert largest(series.psi_bound) < 1e-14
    assert largest(series.omega1_bound) < 1e-14
    assert "0 wrong" in verify(spin)
    certified = spin(TOP, *given, CERTIFIED).rows
    for name in ("theta", "phi", "psi", "q0", "omega1"):
        assert list(certified[name]) == pytest.approx(list(series[name]), abs=1e-14)
    assert "0 unproved, 0 wrong" in verify(spin, "--strict")
    change(spin, "psi", 3, repr(float(certified.psi[2]) + 2 * math.pi))
    assert "first wrong  row 3, psi" in verify(spin, code=3)


def test_sweep(spin):
    """Bounds of the cases, whose bytes do not depend on threads."""
    run = spin(SWEEP)
    texts = run.texts
    assert set(run.rows.status) == {"ok"}
    assert list(run.rows.proof) == ["proved"] * 4
    assert largest(run.rows.theta_end_bound) < 1e-12
    assert largest(run.rows.psi_end_bound) < 1e-12
    assert spin(SWEEP, "--threads=2").texts.equals(texts)
    assert "0 wrong" in verify(spin)
    change(spin, "theta_end", 3, "0.7")
    assert "first wrong  row 3, theta_end = 0.7" in verify(spin, code=3)


def test_bounds_of_periods_and_energies_are_refused(spin):
    """Proofs are of the attitude and the velocity at a time; the message says so."""
    for name in ("nutation_period", "precession_per_nutation", "momentum_period", "energy"):
        text, column = (TOP, "t") if name == "energy" else (SWEEP, "theta_end")
        error = spin.refuse(text, "--check", f"output.columns={column},{name}_bound")
        assert f"column '{name}_bound': proofs bound the attitude and the" in error
        assert f"at a time, not {name}\n" in error


def test_verify(spin):
    """A wrong digit is found; the exact solution needs no bounds beside its numbers."""
    theta = spin(TOP).texts.theta[4]
    assert "49 numbers proved, 0 unproved, 0 wrong" in verify(spin, "--strict")
    place = 14
    wrong = theta[:place] + str((int(theta[place]) + 5) % 10) + theta[place + 1 :]
    change(spin, "theta", 5, wrong)
    said = verify(spin, code=3)
    assert "1 wrong" in said
    assert f"first wrong  row 5, theta = {wrong}" in said


def test_verify_without_claims(spin):
    """A method claims nothing: its numbers are unproved, but their errors are bounded."""
    spin(TOP, "integration.method=rk4", "integration.steps=60")
    said = verify(spin)
    assert "0 numbers proved, 49 unproved, 0 wrong" in said
    assert "largest bound  theta " in said
    verify(spin, "--strict", code=3)


def test_what_is_no_table(spin):
    spin.call("verify", spin.write(TOP), code=2)
    assert "verify takes a table" in spin.call("verify", code=2).stderr
    said = spin.call("verify", "--fast", "a.csv", code=2).stderr
    assert "verify takes no option but --strict" in said


# `spintop verify` on tables of all kinds: parts of sweeps, free bodies, damaged ones.

CASES = """\
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
        assert f"first wrong  {words}" in verify(self.spin, name="edited", code=3)


def rows_of(lines):
    return [line for line in lines if not line.startswith("#")]


def test_parts_of_a_sweep(spin):
    spin.parts(CASES, 3)
    counted = [verify(spin, name=f"scene.{i}-of-3").split()[1] for i in (1, 2, 3)]
    spin(CASES)
    total = f"{sum(map(int, counted))} numbers proved, 0 unproved, 0 wrong"
    assert total in verify(spin)


@each(
    "columns, count, name, change",
    ([], 25, "q0", lambda x: -x),
    (["output.columns=t,theta,phi,psi"], 15, "phi", lambda x: x + 2 * math.pi),
)
def test_free_body(spin, columns, count, name, change):
    """The quaternion is proved with its sign; phi and psi are with their turns."""
    table = Table(spin, FREE, *columns)
    assert f"{count} numbers proved, 0 unproved, 0 wrong" in verify(spin)
    value = float(table.rows[-1].split(",")[table.names.index(name)])
    table.wrong(table.edited(4, name, str(change(value))), f"row 5, {name} = ")


def test_axis_x(spin):
    """A top about body x that hangs: bounds, and certified numbers."""
    rows = spin(ABOUT_X).rows
    assert set(rows.proof) == {"proved"}
    assert largest(rows.orientation_bound) < 1e-14
    assert "25 numbers proved" in verify(spin)
    spin(ABOUT_X, "output.certified=.true.", "integration.method=dop853")
    assert "25 numbers proved" in verify(spin)


def test_inputs(spin):
    assert largest(spin("certified_top").rows.theta_bound) < 4e-16
    assert "707 numbers proved, 0 unproved, 0 wrong" in verify(spin, name="certified_top")
    assert 1e-4 < largest(spin("uncertain_top").rows.orientation_bound) < 1e-3
    assert " 0 wrong" in verify(spin, name="uncertain_top")


@each(
    "radius, words",
    ("uncertainty.initial.theta=1e-9", "the attitude is given by a quaternion"),
    ("uncertainty.initial.phi_rate=1e-9", "the angular velocity is given by omega"),
    ("uncertainty.top.inertia_tensor(1,2)=1e-9", "top.inertia_tensor is not given"),
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
        assert f"{proved} numbers proved, {25 - proved} unp" in verify(spin)


def test_other_versions(spin):
    """A table of another version is verified as long as its input is understood."""
    text = spin(FREE).path.read_text()
    first = next(line for line in text.splitlines() if line.startswith("# program: "))
    spin.write(text.replace(first, "# program: spintop 0.0.1"), "output/older.csv")
    assert "0 wrong" in verify(spin, name="older")
    spin.write(text.replace("omega = ", "spin_vector = "), "output/newer.csv")
    assert "unknown key 'spin_vector'" in verify(spin, name="newer", code=2)


def test_edited_sweeps(spin):
    """Wrong: no number, bound, proof, parameter, or rows that are not those of the input."""
    table = Table(spin, CASES)
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
    assert " 0 wrong" in verify(spin)


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
        assert words in verify(spin, name="damaged", code=2)
