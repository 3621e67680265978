"""What the page needs of a trajectory to show the top move, and the data of tables in it.

The data are the file itself, packed, or as many of its rows as fit.
"""

import base64
import gzip
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spintop_figures.moving.assumptions import acting
from spintop_figures.moving.body import Body, draw_body, read_body
from spintop_figures.tables.table import Table, cells_in, line_of, lines_of_text, printable
from spintop_figures.tables.words import say

ANGLES = ("phi", "theta", "psi")
QUATERNION = ("q0", "q1", "q2", "q3")
OMEGA = ("omega1", "omega2", "omega3")
RATES = tuple(f"{name}_rate" for name in ANGLES)
FORCE = ("force_x", "force_y", "force_z")
ENERGIES = ("kinetic", "potential", "energy")
GROUPS = (("t",), ANGLES, QUATERNION, RATES, OMEGA, FORCE, ENERGIES)
"""Columns that the page takes together, as `COLUMNS` in `motion.js`."""

SCENE_DIGITS = 9
"""Significant digits to which two scenes are the same."""


@dataclass(frozen=True)
class Data:
    """A table of texts as it can be saved from the page, and how many of its rows it has."""

    name: str
    packed: bytes
    kept: int
    total: int
    stride: int
    of_cases: int = 1
    """Of a long sweep only one case in so many was read."""

    @property
    def size(self) -> int:
        """Bytes that it takes in the page."""
        return -(-len(self.packed) // 3) * 4

    @property
    def address(self) -> str:
        """The packed file as a data URI."""
        return f"data:application/gzip;base64,{base64.b64encode(self.packed).decode()}"

    @property
    def is_whole(self) -> bool:
        """Whether it has all rows."""
        return self.kept == self.total and self.of_cases == 1

    @property
    def which(self) -> str:
        """Which rows it has, in words."""
        cases = f", of one case in {self.of_cases}" if self.of_cases > 1 else ""
        if self.kept == self.total:
            return f"all {self.total:,} rows{cases}"
        return which_rows(self.stride, self.total) + cases


def which_rows(stride: int, total: int) -> str:
    """Which rows of a table are kept, in words: every 5th of 1,985 rows, and the last."""
    ends = {1: "st", 2: "nd", 3: "rd"}
    end = "th" if stride // 10 % 10 == 1 else ends.get(stride % 10, "th")
    return f"every {stride}{end} of {total:,} rows, and the last"


def lines_of(table: Table) -> tuple[list[str], list[str], list[str]]:
    """The lines of a table before, in and after its rows; written anew where it is no small CSV."""
    path = table.path
    if table.frame:
        # The checksum is that of the lines of a file.
        lines = [line for line in table.frame.split("\n") if not line.startswith("# end: ")]
        first = next(i for i, line in enumerate(lines) if not line.startswith("#")) + 1
        names = cells_in(first, lines[first - 1])
        return lines[:first], written_rows(table, names), lines[first:]
    # not once more for its own lines
    if path.suffix != ".csv" or path.stat().st_size > 64_000_000 or table.stride > 1:
        head = [f"# {key}: {value}" for key, value in table.header.items()]
        head += ["# input:", *(f"#     {line}" for line in table.input.splitlines())]
        names = [*table.rows.columns]
        return [*head, line_of(names)], written_rows(table, names), []
    return lines_of_text(path.read_bytes())


def written_rows(table: Table, names: list[str]) -> list[str]:
    """The rows of these columns as lines, with numbers as the program writes them."""
    texts = {name: table.rows[name].astype(str) for name in names}
    cells = [
        text.str.removesuffix(".0") if table.numeric(name) else text for name, text in texts.items()
    ]
    return [line_of(row) for row in zip(*cells, strict=True)]


def rows_kept(total: int, stride: int) -> np.ndarray:
    """Which rows are kept: one in so many, and the last."""
    return np.unique(np.append(np.arange(0, total, stride), max(total - 1, 0)))[:total]


def pack(table: Table, stride: int = 1) -> Data:
    """A table packed, with one row in so many and the last."""
    head, rows, foot = lines_of(table)
    keep = rows_kept(len(rows), stride)
    if stride > 1:
        note = f"# rows: one in {stride} of {len(rows)}, and the last"
        head = [*head[:-1], note, head[-1]]
        foot = [line for line in foot if not line.startswith("# end: ")]  # of all rows
    text = "\n".join([*head, *(rows[i] for i in keep), *(foot or [""])])
    packed = gzip.compress(text.encode("utf-8"), mtime=0)
    name = printable(table.path.with_suffix(".csv").name)
    return Data(name, packed, len(keep), len(rows), stride, table.stride)


def pack_all(tables: list[Table], room: int) -> list[Data]:
    """All tables packed so that they fit: those that are too large for their share have less rows.

    What smaller tables leave of their shares the larger ones have.
    """
    whole = [pack(table) for table in tables]
    shares = dict.fromkeys(range(len(tables)), 0)
    left, waiting = room, sorted(shares, key=lambda i: whole[i].size)
    for place, i in enumerate(waiting):
        # every table has some, whatever their number
        shares[i] = max(20_000, min(whole[i].size, left // (len(waiting) - place)))
        left = max(0, left - shares[i])
    packed = []
    for table, data, share in zip(tables, whole, shares.values(), strict=True):
        fitting = data
        while fitting.size > share and fitting.kept > 2:
            stride = max(fitting.stride + 1, -(-fitting.stride * fitting.size // share))
            fitting = pack(table, stride)
        packed.append(fitting)
    return packed


def columns_of(table: Table, names: Sequence[str]) -> np.ndarray | None:
    """Columns side by side; None if a table has not all of them, with numbers in all rows."""
    if table.missing(names) or not all(map(table.numeric, names)):
        return None
    numbers = table.rows[list(names)].to_numpy(float)
    return numbers if np.isfinite(numbers).all() else None


def refusal(table: Table) -> str:
    """Why the motion of a table cannot be shown; empty if it can."""
    if table.kind != "trajectory":
        return "is no trajectory"
    if not is_whole(table, ("t",)):
        return "needs the column t"
    if not (is_whole(table, ANGLES) or is_whole(table, QUATERNION)):
        return "needs the columns phi, theta, psi or q0 to q3"
    if len(table.rows) < 2:
        return "has one row only"
    return ""


def is_whole(table: Table, names: Sequence[str]) -> bool:
    """Whether a table has these columns, with numbers in all rows."""
    return columns_of(table, names) is not None


def find_omega(table: Table) -> np.ndarray | None:
    """Angular velocity in body axes, from its columns or from the rates of the angles."""
    omega, both = columns_of(table, OMEGA), columns_of(table, ANGLES + RATES)
    if omega is not None or both is None:
        return omega
    _, theta, psi, phi_rate, theta_rate, psi_rate = both.T
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
    is_off_axis = body is not None and not np.array_equal(body.axis(), (0.0, 0.0, 1.0))
    notes = {
        "The table has no columns phi, theta, psi: the angles are computed from the quaternion, "
        "phi and psi within half a turn.": not is_whole(table, ANGLES),
        "The header of the table does not give the body, so a plain disc is shown.": body is None,
        body and draw_body(table, body).label: body is not None,
        "The centre of mass does not lie on body z, which phi, theta and psi are of; the rod and "
        "the trace are of the centre of mass.": is_off_axis,
        "No support force: it takes the columns force_x, force_y, force_z.": (
            not is_whole(table, FORCE)
        ),
        "No rates, angular velocity and angular momentum: they take omega1 to omega3, or the "
        "angles and their rates.": omega is None,
        "No energies: they take the columns kinetic, potential, energy.": (
            not is_whole(table, ENERGIES)
        ),
    }
    return [note for note, holds in notes.items() if holds]


def attitude_at_start(table: Table) -> np.ndarray:
    """The first row's unit quaternion, its largest component positive."""
    if (quaternions := columns_of(table, QUATERNION)) is not None:
        q = quaternions[0]
    else:
        phi, theta, psi = columns_of(table, ANGLES)[0]
        plus, minus = (phi + psi) / 2, (phi - psi) / 2
        c, s = np.cos(theta / 2), np.sin(theta / 2)
        q = np.array([c * np.cos(plus), s * np.cos(minus), s * np.sin(minus), c * np.sin(plus)])
    return q * np.sign(q[np.abs(q).argmax()])


def scene_of(table: Table, body: Body | None, omega: np.ndarray | None) -> str:
    """A word that motions of one scene share: body, gravity, damping, effects, and start.

    Where the table has no angular velocity, the start is that of the resolved input.
    """
    numbers = [table.rows["t"].iloc[0], *attitude_at_start(table)]
    if body is not None:
        numbers += [body.mass, *body.inertia, *body.centre, *body.products]
    words = [str(table.settings.get(f"top.{key}", "")) for key in ("gravity", "damping")]
    words += [f"{key} {table.settings[key]}" for key in acting(table, "effects.")]
    if omega is None:
        given = {key: value for key, value in table.settings.items() if key.startswith("initial.")}
        words.append(str(sorted(given.items())))
    else:
        numbers += omega[0].tolist()
    largest = max(map(abs, numbers))
    tiny = 10.0**-SCENE_DIGITS * min(1.0, largest)
    words += [f"{x if abs(x) > tiny else 0.0:.{SCENE_DIGITS}g}" for x in numbers]
    return hashlib.sha256("|".join(words).encode()).hexdigest()[:16]


def extremes_of(table: Table, body: Body | None, omega: np.ndarray | None) -> dict[str, object]:
    """The range of theta (rad), and the largest of each vector that there is; of all rows."""
    if (angles := columns_of(table, ANGLES)) is not None:
        theta = angles[:, 1]
    else:
        q0, q1, q2, q3 = columns_of(table, QUATERNION).T
        theta = 2 * np.arctan2(np.hypot(q1, q2), np.hypot(q0, q3))
    momentum = None if omega is None or body is None else omega @ body.tensor()
    vectors = {"force": columns_of(table, FORCE), "omega": omega, "momentum": momentum}
    largest = {
        name: float(np.linalg.norm(values, axis=1).max())
        for name, values in vectors.items()
        if values is not None
    }
    return {"theta": [float(theta.min()), float(theta.max())], **largest}


def motion_facts(table: Table, data: Data, anchor: str) -> dict[str, object]:
    """What the page has to know of a motion beside the columns of its rows.

    In a form that goes into JSON; `motion.js` of the page reads it. `anchor` is the element of the
    page that has the data.
    """
    body = read_body(table)
    omega = find_omega(table)
    facts: dict[str, object] = {
        "title": table.title or table.path.stem,
        "total": data.total,
        "stride": data.stride,
        "data": anchor,
        "columns": [name for group in GROUPS if is_whole(table, group) for name in group],
        "scene": scene_of(table, body, omega),
        "exact": table.header.get("method", "") == "exact",
        "notes": [*map(say, lacking(table, body, omega))],
        "extremes": extremes_of(table, body, omega),
    }
    if data.stride > 1:
        kept = which_rows(data.stride, data.total)
        facts["notes"].append(f"The page has {kept}; ranges and longest arrows are of all rows.")
    if body is not None:
        vectors = vars(body) | {"axis": body.axis()}
        facts["body"] = {key: np.array(each).tolist() for key, each in vectors.items()}
        facts["body"]["solids"] = draw_body(table, body).solids
    return facts


def facts_text(table: Table, data: Data, anchor: str) -> str:
    """The same as JSON for a script element: no text in it can end the element."""
    facts = motion_facts(table, data, anchor)
    text = json.dumps(facts, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
