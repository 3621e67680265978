"""What does not exist is nan with a note: each column of a sweep alone, for every sort of body."""

from conftest import each, listed

HEAD = "&study kind = 'sweep' /\n&initial theta = 0.9 omega = 0.3, 0.2, 9 /\n"
TOP = "&top mass = 1 inertia = 0.9, 0.9, 0.25 length = 0.7 /\n"
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
    text = HEAD + TOP + SCENES[scene] + REST
    run = spin(text, f"output.columns={column}", code=(0, 2, 3), cases=BODIES)
    if run.code == 2:
        assert "FLINT" in run.err
        return
    rows = run.texts
    assert len(rows) == 6
    for cell in rows[column][(rows.status == "ok") & (rows.notes == "")]:
        assert cell not in ("nan", "inf", "-inf") or (column.endswith("_bound") and cell == "inf")
