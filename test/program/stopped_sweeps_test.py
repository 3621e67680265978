"""What a sweep says of motions that an event ends is what it says of motions that end then."""

from pathlib import Path

import pytest

from nutation_axes_test import rows_of

SWEEP = "&study kind = 'sweep' /\n&sweep parameter = 'initial.omega3'  values(1,:) = {} /\n"
SYMMETRIC = "&top mass = 1  inertia = 0.875, 0.875, 0.25  length = 0.866 /\n"
ANY = "&top mass = 1  inertia = 0.9, 0.7, 0.25  centre_of_mass = 0.05, 0, 0.5 /\n"
STOP = "stop_at = 'turning_points'  stop_after = 3"


def rows(folder: Path, body: str, spins: str, span: str, columns: tuple, method: str = "") -> list:
    """The rows of a sweep over spins."""
    text = body + f"&initial theta_deg = 30  phi_rate = 0.5 /\n&span {span} /\n"
    if method:
        text += f"&integration {method} /\n"
    return rows_of(folder, text + SWEEP.format(spins), columns)


@pytest.mark.parametrize("body", [SYMMETRIC, ANY])
@pytest.mark.parametrize("method", ["auto", "taylor", "dop853"])
def test_growth_to_the_event(tmp_path: Path, body: str, method: str) -> None:
    """Exponents and singular values are those up to the event."""
    columns = "t_end", "largest_singular_value", "lyapunov_exponent"
    if body == SYMMETRIC:
        columns += ("inherent_error",)
    how = f"method = '{method}'"
    (stopped,) = rows(tmp_path, body, "3", f"t_end = 9  {STOP}", columns, how)
    assert float(stopped["t_end"]) < 8
    (whole,) = rows(tmp_path, body, "3", f"t_end = {stopped['t_end']}", columns, how)
    for name in columns:
        assert float(stopped[name]) == pytest.approx(float(whole[name]), rel=1e-6), name
    (alone,) = rows(tmp_path, body, "3", f"t_end = 9  {STOP}", columns[1:2], how)
    assert alone[columns[1]] == stopped[columns[1]]


def test_the_turning_point_at_the_end_counts(tmp_path: Path) -> None:
    """On whichever side of the end rounding errors put it."""
    columns = "nutation_period", "precession_per_nutation", "motion_class"
    spins = ", ".join(str(5 + 0.19 * k) for k in range(60))
    methods = (
        "relative_tolerance = 1e-9",
        "relative_tolerance = 1e-12",
        "method = 'dop853'  relative_tolerance = 1e-10",
        "method = 'dop853'  relative_tolerance = 1e-12",
    )
    tables = [rows(tmp_path, ANY, spins, f"t_end = 40  {STOP}", columns, how) for how in methods]
    for same in zip(*tables, strict=True):
        assert len({row["motion_class"] for row in same}) == 1
        for name in columns[:2]:
            values = [float(row[name]) for row in same]
            assert values == pytest.approx([values[0]] * len(values), rel=1e-5), name


@pytest.mark.parametrize("effect", ["drag_moment = 3*0.1", "torque_body = 0, 0, 5"])
@pytest.mark.parametrize("stop", ["", STOP])
def test_no_growth_with_effects(tmp_path: Path, effect: str, stop: str) -> None:
    """The equations of perturbations are those without effects."""
    columns = "largest_singular_value", "lyapunov_exponent"
    body = ANY + f"&effects {effect} /\n"
    (row,) = rows(tmp_path, body, "3", f"t_end = 3  {stop}", columns)
    assert [row[name] for name in columns] == ["nan", "nan"]
    assert "no Lyapunov exponent: it is not measured for bodies with effects" in row["notes"]
