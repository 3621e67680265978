"""What the page needs of a trajectory to show the top move."""

import base64

import numpy as np

from figures.table import Table
from reporting.body import Body, equivalent_solid, read_body

ANGLES = ("phi", "theta", "psi")
QUATERNION = ("q0", "q1", "q2", "q3")
OMEGA = ("omega1", "omega2", "omega3")
FORCE = ("force_x", "force_y", "force_z")
FEWEST_ROWS = 2
BODY_Z = (0.0, 0.0, 1.0)


def is_whole(table: Table, columns: tuple[str, ...]) -> bool:
    """Whether a table has these columns, with numbers in all rows."""
    return not table.missing(columns) and all(
        table.numeric(name) and table.finite(name).all() for name in columns
    )


def refusal(table: Table) -> str:
    """Why the motion of a table cannot be shown; empty if it can."""
    if table.kind != "trajectory":
        return "is no trajectory"
    if not is_whole(table, ("t",)):
        return "needs the column t"
    if not (is_whole(table, ANGLES) or is_whole(table, QUATERNION)):
        return "needs the columns phi, theta, psi or q0 to q3"
    if len(table.rows) < FEWEST_ROWS:
        return "has one row only"
    return ""


def pack(values: np.ndarray, kind: str) -> str:
    """Numbers as base64 of their bytes, the lowest first."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()).decode()


def columns_of(table: Table, names: tuple[str, ...]) -> np.ndarray:
    """Columns side by side."""
    return table.rows[list(names)].to_numpy(float)


def find_omega(table: Table) -> np.ndarray | None:
    """Angular velocity in body axes, from its columns or from the rates of the angles."""
    if is_whole(table, OMEGA):
        return columns_of(table, OMEGA)
    rates = tuple(f"{name}_rate" for name in ANGLES)
    if not is_whole(table, ANGLES + rates):
        return None
    _, theta, psi = columns_of(table, ANGLES).T
    phi_rate, theta_rate, psi_rate = columns_of(table, rates).T
    across = phi_rate * np.sin(theta)
    return np.column_stack(
        (
            across * np.sin(psi) + theta_rate * np.cos(psi),
            across * np.cos(psi) - theta_rate * np.sin(psi),
            phi_rate * np.cos(theta) + psi_rate,
        )
    )


def lacking(table: Table, body: Body | None, omega: np.ndarray | None) -> list[str]:
    """What the page cannot show or has to make up, in sentences."""
    notes = []
    if not is_whole(table, ANGLES):
        notes.append(
            "The table has no columns phi, theta, psi: the angles are computed from the "
            "quaternion, phi and psi within half a turn."
        )
    if body is None:
        notes.append("The header of the table does not give the body, so a plain disc is shown.")
    else:
        kind = equivalent_solid(body)["kind"]
        if kind != "none":
            notes.append(
                f"The animation shows the homogeneous {kind} with the same mass, centre of mass "
                "and moments of inertia."
            )
        if not np.array_equal(body.axis(), BODY_Z):
            notes.append(
                "The centre of mass does not lie on body z, which phi, theta and psi are of; "
                "the rod and the trace are of the centre of mass."
            )
    if not is_whole(table, FORCE):
        notes.append("No support force: it takes the columns force_x, force_y, force_z.")
    if omega is None:
        notes.append(
            "No angular momentum: it takes omega1 to omega3, or the angles and their rates."
        )
    return notes


def motion_data(table: Table, most_rows: int) -> dict[str, object]:
    """The motion in a form that goes into JSON; `top.js` and `motion.js` of the page read it.

    Angles, times and quaternions are the bits of the table; what is only drawn has single
    precision. Of a table with more rows than `most_rows` one in `stride` is kept, and the last.
    """
    total = len(table.rows)
    stride = -(-total // most_rows)
    keep = np.unique(np.append(np.arange(0, total, stride), total - 1))
    body = read_body(table)
    omega = find_omega(table)
    exact = ("t",)
    exact += ANGLES if is_whole(table, ANGLES) else ()
    exact += QUATERNION if is_whole(table, QUATERNION) else ()
    data: dict[str, object] = {
        "title": table.title or table.path.stem,
        "total": total,
        "stride": stride,
        "exact": {name: pack(table.rows[name].to_numpy(float)[keep], "f8") for name in exact},
        "drawn": {},
        "notes": lacking(table, body, omega),
    }
    if omega is not None:
        data["drawn"]["omega"] = pack(omega[keep], "f4")
    if is_whole(table, FORCE):
        data["drawn"]["force"] = pack(columns_of(table, FORCE)[keep], "f4")
    if stride > 1:
        data["notes"].append(f"One row in {stride} of {total} is shown, and the last.")
    if body is not None:
        data["body"] = {
            "mass": body.mass,
            "inertia": body.inertia.tolist(),
            "centre": body.centre.tolist(),
            "axis": body.axis().tolist(),
            "solid": equivalent_solid(body),
        }
    return data
