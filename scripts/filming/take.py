"""The motion of a film: computed by the program at the times of the pictures, and between them."""

import contextlib
import math
import os
import re
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spintop_figures.moving.body import Body, draw_body, read_body
from spintop_figures.moving.motion import FORCE, OMEGA, QUATERNION
from spintop_figures.tables.table import Table, TableError, read_table

PROGRAM = os.environ.get("SPINTOP_EXE", "build/release/spintop")
BETWEEN = 8
"""Rows a picture: the path of the axis has so many pieces from one picture to the next, or more."""

FINE = 0.06
"""The axis turns by no more from row to row, rad, unless that takes too many rows."""

MOST_ROWS = 30_000
"""Of what is filmed, and of the whole motion where a part of it is filmed."""

MOST_READ = 600_000
SAME = 1e-6
"""Of a row: rounding."""

FIXED = "rows of a method with a fixed step size are at its steps"
"""What the program says where it cannot have as many rows as a film asks for."""

NO_TRAJECTORY = "{}: this is no trajectory, which a film is made of"
KIND = re.compile(r"^[^!\n]*\bkind\s*=\s*(['\"])(\w+)\1", re.MULTILINE | re.IGNORECASE)
"""The kind of study that an input names."""

COLUMNS = ("t", *QUATERNION, *OMEGA, *FORCE, "theta")


class FilmError(Exception):
    """Why there is no film, in a sentence; `code` is the exit code."""

    def __init__(self, message: str, code: int = 2) -> None:
        super().__init__(message)
        self.code = code


@dataclass(frozen=True)
class Take:
    """A motion: times (s), attitudes, axis of the body and vectors in space; and its body."""

    title: str
    body: Body
    solids: list[dict[str, object]]
    times: np.ndarray
    theta: np.ndarray
    rotations: np.ndarray
    axis: np.ndarray
    vectors: dict[str, np.ndarray]
    rows: np.ndarray
    """The row of each picture."""

    def steps(self) -> np.ndarray:
        """How far the axis turns from each row to the next, rad."""
        chords = np.linalg.norm(np.diff(self.axis, axis=0), axis=1)
        return 2 * np.arcsin(np.minimum(chords / 2, 1.0))


@dataclass(frozen=True)
class Part:
    """A part of a motion, s, and how many times as long the whole of it is."""

    start: float
    end: float
    share: float


def compute(source: Path, pictures: int, part: Part | None = None) -> Take:
    """The motion of an input, or of a table by the input in its header, for so many pictures."""
    share = part.share if part else 1.0
    with prepared(source) as (file, folder):
        between, most, before = BETWEEN, max(BETWEEN, int(MOST_ROWS / pictures)), 0
        while True:
            rows = math.ceil(share * (pictures - 1) * between) + 1
            if rows > MOST_READ:
                raise FilmError(
                    f"{source}: the part is too short beside the whole motion, of which "
                    f"{rows:,} rows were needed ({MOST_READ:,} at most): film a longer part, with "
                    "fewer pictures, or shorten the motion (span.t_end)"
                )
            take = take_of(run(file, folder, rows), pictures, part)
            widest = take.steps().max(initial=0.0)
            most = min(most, int(MOST_READ / (share * pictures)))
            if widest <= FINE or between >= most or len(take.times) == before:
                return take
            before = len(take.times)
            between = min(between * max(2, math.ceil(widest / FINE)), most)


def span_of(source: Path) -> float:
    """How long the motion of an input or of a table is, s."""
    with prepared(source) as (file, folder):
        return float(run(file, folder, 2).rows["t"].iloc[-1])


@contextlib.contextmanager
def prepared(source: Path) -> Iterator[tuple[Path, Path]]:
    """An input, of a table that in its header, and a folder for tables, which is removed."""
    if not source.is_file():
        raise FilmError(f"{source}: no such file")
    with tempfile.TemporaryDirectory(prefix="film ") as name:
        folder = Path(name)
        file = source
        if source.suffix != ".nml":
            file = folder / f"{source.stem}.nml"
            file.write_text(read_trajectory(source, source).input, encoding="utf-8")
        yield file, folder


def read_trajectory(path: Path, source: Path) -> Table:
    """A table, which a film can be made of."""
    try:
        table = read_table(path)
    except (TableError, OSError) as error:
        raise FilmError(str(error)) from error
    if table.kind != "trajectory":
        raise FilmError(NO_TRAJECTORY.format(source))
    return table


def run(file: Path, folder: Path, rows: int) -> Table:
    """Run the program on an input, with so many rows and with what a film needs."""
    kind = KIND.search(file.read_text(encoding="utf-8", errors="replace"))
    if kind and kind[2].lower() != "trajectory":
        raise FilmError(NO_TRAJECTORY.format(file))
    table = folder / f"{file.stem}.csv"
    table.unlink(missing_ok=True)
    given = ("--set", f"output.columns={','.join(COLUMNS)}", "--set", "output.format=csv")
    # Rows of some methods are at steps: those that the input asks for.
    for more in (("--set", f"span.samples={rows}"), ()):
        command = [PROGRAM, "--quiet", "-o", str(folder), *more, *given, "--", str(file)]
        try:
            done = subprocess.run(command, check=False, capture_output=True, text=True)
        except OSError as error:
            raise FilmError(f"cannot run {PROGRAM}: {error.strerror}") from error
        if FIXED not in done.stderr:
            break
    if not table.exists():
        said = (done.stderr or done.stdout).strip()
        raise FilmError(said or f"{file}: no table was made", done.returncode or 2)
    return read_trajectory(table, file)


def take_of(table: Table, pictures: int, part: Part | None = None) -> Take:
    """What is to be seen of a trajectory, or of a part of it."""
    body = read_body(table)
    values = {name: table.rows[name].to_numpy(float) for name in COLUMNS if name in table.rows}
    good = np.all([np.isfinite(values[name]) for name in ("t", *QUATERNION)], axis=0)
    if body is None or good.sum() < 2:
        raise FilmError(f"{table.path.stem}: there is no motion to be filmed")
    values = {name: column[good] for name, column in values.items()}
    if part:
        kept = slice(*rows_within(values["t"], pictures, part))
        values = {name: column[kept] for name, column in values.items()}
    q = np.column_stack([values[name] for name in QUATERNION])
    rotations = matrices(q / np.linalg.norm(q, axis=1, keepdims=True))
    omega = np.column_stack([values[name] for name in OMEGA])
    vectors = {
        "momentum": np.einsum("nij,nj->ni", rotations, omega @ body.tensor()),
        "omega": np.einsum("nij,nj->ni", rotations, omega),
        "force": np.column_stack([values[name] for name in FORCE]),
    }
    times = values["t"]
    moments = np.linspace(times[0], times[-1], pictures)
    moments -= 1e-9 * (times[-1] - times[0])
    rows = np.clip(np.searchsorted(times, moments), 0, len(times) - 1)
    return Take(
        table.title or table.path.stem, body, draw_body(table, body).solids, times,
        values["theta"], rotations, np.einsum("nij,j->ni", rotations, body.axis()), vectors, rows,
    )  # fmt: skip


def rows_within(times: np.ndarray, pictures: int, part: Part) -> tuple[int, int]:
    """The first row of a part, and the one behind its last.

    There is a whole number of rows per picture, unless the rows are at steps of a fixed size.
    """
    step, last = times[1] - times[0], len(times) - 1
    first = min(round(part.start / step), last - 1)
    rows = (part.end - part.start) / step
    whole = int(rows / (pictures - 1) + SAME) * (pictures - 1)
    count = whole if rows - whole < 1 else round(rows)
    return first, min(first + max(1, count), last) + 1


def matrices(q: np.ndarray) -> np.ndarray:
    """The rotations of unit quaternions, body to space."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
