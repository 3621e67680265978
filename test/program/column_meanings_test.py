"""What columns of errors say is true whatever computes them."""

import pytest

from conftest import each, largest, listed, output

TOP = "&top mass = 1.2, inertia = 0.8, 0.8, 0.3, length = 0.6 /\n"
STARTS = {
    "anywhere": "&initial theta = 0.7, phi_rate = 0.3, theta_rate = 0.4, psi_rate = 9 /\n",
    # There rates of angles do not exist, and the exact solution is followed by itself.
    "pole": "&initial theta = 0, omega = 0.8, 0.3, 9 /\n",
}
SPANS = (1.3, 2.9, 4.4, 7.1, 9.2, 12.5)
SWEEP = "&study kind = 'sweep' /\n&sweep parameter = '{}', values(1,:) = {} /\n"
ROUNDING = 1e-15
"""Of the difference of two energies, each of about five rounded factors."""


@each("start", *STARTS)
def test_the_exact_solution_is_one_step(spin, start):
    """The largest error is that of the end, in vector lanes and by itself."""
    scene = TOP + STARTS[start]
    sweep = scene + SWEEP.format("span.t_end", ", ".join(map(str, SPANS)))
    swept = spin(sweep + output("energy_error_max", "theta_end")).rows.energy_error_max
    for span, error in zip(SPANS, swept, strict=True):
        text = f"{scene}&span t_end = {span}, samples = 2 /\n" + output("energy_error")
        moved = spin(text).rows.energy_error
        assert error == pytest.approx(abs(moved.iloc[-1]), abs=ROUNDING), span


@each("start", *STARTS)
def test_steps_of_fixed_size(spin, start):
    """The largest over the rows of a trajectory, which are the steps."""
    scene = f"{TOP}{STARTS[start]}&span t_end = 4 /\n"
    scene += "&integration method = 'splitting_2', steps = 300 /\n"
    sweep = scene + SWEEP.format("top.gravity", 9.81) + output("energy_error_max")
    (swept,) = spin(sweep).rows.energy_error_max
    moved = spin(scene + output("energy_error")).rows.energy_error
    assert swept == pytest.approx(largest(moved), abs=1e-14)


@each("method, steps", ("splitting_2", 1000), ("rk4", 800), ("gauss_4", 240))
def test_every_step_counts(spin, method, steps):
    """Errors of a stability study are the largest of all steps, where they are no thousand."""
    scene = f"{TOP}{STARTS['anywhere']}&span t_end = 5 /\n"
    study = "&study kind = 'stability' /\n&stability cases = 'input', methods = "
    found = spin(f"{scene}{study}'{method}' /\n&integration steps = {steps} /\n").rows
    names = ("orientation_error", "tip_error", "energy_error")
    integration = f"&integration method = '{method}', steps = {steps} /\n"
    moved = spin(scene + integration + output(*names)).rows
    for name in names:
        most = largest(moved[name])
        assert found[name][0] == pytest.approx(most, abs=1e-6 * most + 1e-14)


# What does not exist is nan with a note: each column of a sweep alone, for every sort of body.

HEAD = "&study kind = 'sweep' /\n&initial theta = 0.9 omega = 0.3, 0.2, 9 /\n"
SYMMETRIC = "&top mass = 1 inertia = 0.9, 0.9, 0.25 length = 0.7 /\n"
REST = "&span t_end = 2.5 /\n&sweep table = 'cases.csv' /\n"
BODIES = """\
top.inertia(1),top.inertia(2),top.gravity,initial.theta
0.9,0.9,9.81,0.8
0.9,0.9,9.81,0
0.9,0.9,0,0.8
0.9,0.8,9.81,0.8
0.9,0.8,0,0.8
0.9,0.8,9.81,3.141592653589793
"""
"""Heavy, upright, free and asymmetric bodies, and one that hangs."""
SCENES = {
    "plain": "",
    "friction": "&effects friction_torque = 0.3 friction_smoothing = 0 /\n",
    "vibration": "&effects vibration_amplitude = 0, 0, 0.01 vibration_rate = 60 /\n",
}
COLUMNS = [entry["name"] for entry in listed("columns") if entry["study"] == "sweep"]


def test_the_list():
    assert len(COLUMNS) > 40


@each("scene", *SCENES)
@each("column", *COLUMNS)
def test_every_column(spin, scene, column):
    """A bound that is not proved is inf, which says so; builds without balls have none."""
    text = HEAD + SYMMETRIC + SCENES[scene] + REST
    run = spin(text, f"output.columns={column}", code=(0, 2, 3), cases=BODIES)
    if run.code == 2:
        assert "FLINT" in run.err
        return
    rows = run.texts
    assert len(rows) == 6
    for cell in rows[column][(rows.status == "ok") & (rows.notes == "")]:
        assert cell not in ("nan", "inf", "-inf") or (column.endswith("_bound") and cell == "inf")
